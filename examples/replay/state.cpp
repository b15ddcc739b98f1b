#include "state.hpp"

#include <algorithm>
#include <cstdlib>
#include <initializer_list>
#include <iterator>

#include "line_source.hpp"
#include "trace.hpp"

namespace replay {

void map_state::sort() {
  for (auto& k : kinds) std::sort(k.second.begin(), k.second.end());
}

map_state read_final_state(const std::string& path, const session& of) {
  line_source lines = line_source::of_file(path);
  map_state s;
  int frame = 0;
  for (std::string line; lines.next(line);) {
    if (line.size() < 3 || line[1] != ' ')
      throw bad_trace(lines.name(), lines.number(), "no line of a final state");
    std::vector<int> v;
    const char* at = line.c_str() + 1;
    while (*at != '\0') {
      char* end = nullptr;
      const long n = std::strtol(at, &end, 10);
      if (end == at) throw bad_trace(lines.name(), lines.number(), "a field is no number");
      v.push_back(static_cast<int>(n));
      at = end;
      while (*at == ' ') ++at;
    }
    const auto need = [&](std::size_t n) {
      if (v.size() < n) throw bad_trace(lines.name(), lines.number(), "fields are missing");
      if (v[0] < 0) throw bad_trace(lines.name(), lines.number(), "the id is negative");
    };
    // Which fields are keyframes and points, so that none is out of range.
    const auto check = [&](std::initializer_list<std::size_t> keyframes,
                           std::initializer_list<std::size_t> points) {
      for (const std::size_t i : keyframes)
        if (v[i] < -1 || v[i] >= of.keyframes)
          throw bad_trace(lines.name(), lines.number(), "a keyframe that the session has not");
      for (const std::size_t i : points)
        if (v[i] < -1 || v[i] >= of.points)
          throw bad_trace(lines.name(), lines.number(), "a point that the session has not");
    };
    switch (line[0]) {
      case 'k':
        need(5);
        check({0, 2, 3, 4}, {});
        s.add('k', v[0], v[1]);
        if (v[2] >= 0) s.add('T', v[0], v[2]);
        if (v[3] >= 0 || v[4] >= 0) s.add('N', v[0], v[3], v[4]);
        break;
      case 'p':
        need(3);
        check({}, {0, 2});
        s.add('p', v[0], v[1]);
        if (v[2] >= 0) s.add('R', v[0], v[2]);
        break;
      case 'C':
        need(3);
        check({0, 1}, {});
        s.add('C', v[0], v[1], v[2]);
        break;
      case 's':
        need(3);
        check({0}, {2});
        s.add('s', v[0], v[1], v[2]);
        break;
      case 'O':
        need(3);
        check({0}, {1});
        s.add('O', v[0], v[1], v[2]);
        break;
      case 'H':
      case 'G':
        need(2);
        check({0, 1}, {});
        s.add(line[0], v[0], v[1]);
        break;
      case 'Q':
      case 'K':
        need(1);
        check({0}, {});
        s.add(line[0], v[0]);
        break;
      case 'P':
        need(1);
        check({}, {0});
        s.add('P', v[0]);
        break;
      case 'r':
        need(1);
        check({0}, {});
        s.add('r', frame++, v[0]);
        break;
      default:
        break;  // what traces do not record
    }
  }
  s.sort();
  return s;
}

map_state live_part(const map_state& all, const session& of) {
  const auto dead_kf = [&](int id) { return of.is_marked[static_cast<std::size_t>(id)] != 0; };
  const auto dead_mp = [&](int id) {
    return of.is_marked_point[static_cast<std::size_t>(id)] != 0;
  };
  std::map<int, map_state::entry> links;
  if (all.kinds.count('N') != 0)
    for (const auto& e : all.kinds.at('N')) links[e[0]] = e;
  const auto follow = [&](int kf, std::size_t which) {
    while (kf >= 0 && dead_kf(kf)) kf = links.count(kf) != 0 ? links[kf][which] : -1;
    return kf;
  };

  map_state live;
  for (const auto& of_kind : all.kinds)
    for (const auto& e : of_kind.second) {
      bool dead = false;
      switch (of_kind.first) {
        case 'k':
        case 'K':
        case 'Q':
          dead = dead_kf(e[0]);
          break;
        case 'p':
        case 'P':
          dead = dead_mp(e[0]);
          break;
        case 'R':
        case 'N':
          dead = true;
          break;  // only what is marked was replaced
        case 'C':
        case 'H':
        case 'G':
        case 'T':
          dead = dead_kf(e[0]) || dead_kf(e[1]);
          break;
        case 's':
          dead = dead_kf(e[0]) || dead_mp(e[2]);
          break;
        case 'O':
          dead = dead_kf(e[0]) || dead_mp(e[1]);
          break;
        default:
          break;
      }
      if (!dead) live.kinds[of_kind.first].push_back(e);
    }
  // A recorded final state has the links as they were.
  if (all.kinds.count('n') == 0 && all.kinds.count('k') != 0)
    for (const auto& e : all.kinds.at('k')) {
      if (dead_kf(e[0])) continue;
      const auto link = links.count(e[0]) != 0 ? links[e[0]] : map_state::entry{e[0], -1, -1};
      live.add('n', e[0], follow(link[1], 1), follow(link[2], 2));
    }
  live.sort();
  return live;
}

std::vector<std::string> differences(const map_state& a, const map_state& b) {
  static const std::map<char, const char*> names = {{'k', "keyframes"},
                                                    {'p', "points"},
                                                    {'R', "replaced points"},
                                                    {'T', "parents"},
                                                    {'N', "links in time"},
                                                    {'n', "links in time between live keyframes"},
                                                    {'C', "covisibility"},
                                                    {'s', "slots"},
                                                    {'O', "observations"},
                                                    {'H', "children"},
                                                    {'G', "loop edges"},
                                                    {'Q', "database"},
                                                    {'K', "keyframes in the map"},
                                                    {'P', "points in the map"},
                                                    {'r', "references of frames"}};
  std::vector<std::string> all;
  for (const auto& name : names) {
    if (name.first == 'n' && (a.kinds.count('n') == 0 || b.kinds.count('n') == 0))
      continue;  // derived
    const auto of = [&](const map_state& s) {
      const auto found = s.kinds.find(name.first);
      return found == s.kinds.end() ? std::vector<map_state::entry>{} : found->second;
    };
    const auto x = of(a), y = of(b);
    if (x == y) continue;
    std::vector<map_state::entry> only_x, only_y;
    std::set_difference(x.begin(), x.end(), y.begin(), y.end(), std::back_inserter(only_x));
    std::set_difference(y.begin(), y.end(), x.begin(), x.end(), std::back_inserter(only_y));
    std::string line = std::string(name.second) + ": " + std::to_string(only_x.size()) +
                       " only in the first, " + std::to_string(only_y.size()) +
                       " only in the second";
    for (const auto* only : {&only_x, &only_y})
      if (!only->empty())
        line += " (" + std::to_string((*only)[0][0]) + " " + std::to_string((*only)[0][1]) + " " +
                std::to_string((*only)[0][2]) + ")";
    all.push_back(line);
  }
  return all;
}

}  // namespace replay
