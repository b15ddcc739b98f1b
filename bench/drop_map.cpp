// Dropping a map of 500 keyframes and 50,000 points that are as large, and in as many pieces, as those of
// ORB-SLAM3 (about 320 kB and 2,000 blocks per keyframe): what the caller waits for, how long each slice of collecting
// takes, and what all of it costs compared with deleting at once.
//
// What a keyframe refers to is counted where it leads from the map to the keyframes and on to their points. What
// would close a cycle (a point's observations, covisibility) is raw.
#include <slamgc/deferred.hpp>
#include <slamgc/mutator.hpp>
#include <slamgc/slamgc.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <map>
#include <memory>
#include <set>
#include <tuple>
#include <type_traits>
#include <vector>

namespace {

std::size_t keyframes = 500;
std::size_t points = 50000;
constexpr std::size_t slots = 1000;             // features of a keyframe
constexpr std::size_t observers = 6;            // keyframes that see a point
constexpr std::size_t columns = 64, rows = 48;  // of the grid of features

/// What a keyframe owns beside its edges.
struct features {
  struct key {
    std::array<float, 7> data{};
  };
  std::vector<key> keys{slots}, undistorted{slots}, right{slots};
  std::vector<float> u_right = std::vector<float>(slots), depth = u_right;
  std::vector<unsigned char> descriptors = std::vector<unsigned char>(slots * 32),
                             right_descriptors = descriptors;
  std::vector<std::vector<std::vector<std::size_t>>> grid{
      columns, std::vector<std::vector<std::size_t>>(rows)};
  std::map<unsigned, double> words;
  std::map<unsigned, std::vector<unsigned>> nodes;

  explicit features(std::size_t id) {
    std::uint32_t random = static_cast<std::uint32_t>(id) * 2654435761u + 1;
    for (unsigned i = 0; i != slots; ++i) {
      random = random * 1664525u + 1013904223u;
      grid[(random >> 8) % columns][(random >> 16) % rows].push_back(i);
      words[(random >> 8) % 10000] += 1;
      nodes[(random >> 20) % 100].push_back(i);
    }
  }
};

/// With counted edges, or raw as in ORB-SLAM3.
template <bool Counted>
struct world {
  struct none {};
  template <class T>
  using base = std::conditional_t<
      Counted, slamgc::rc_object<T, slamgc::fetch_add_counter, slamgc::reclaim_deferred>, none>;
  template <class T>
  using vector = std::conditional_t<Counted, slamgc::rc_vector<T>, std::vector<T*>>;
  template <class T>
  using set = std::conditional_t<Counted, slamgc::rc_set<T>, std::set<T*>>;

  struct keyframe;
  struct point : base<point> {
    std::map<keyframe*, std::tuple<int, int>> observations;
    std::unique_ptr<unsigned char[]> descriptor{new unsigned char[32]};
    unsigned char rest[600];
  };
  struct keyframe : base<keyframe> {
    explicit keyframe(std::size_t id) : own(id) {}
    features own;
    vector<point> matches = vector<point>(slots);
    std::map<keyframe*, int> covisible;
    unsigned char rest[4000];
  };
  /// `registry`: the map itself refers to each point, too.
  struct map : base<map> {
    vector<keyframe> all_keyframes;
    set<point> all_points;
  };

  static map* build(bool registry) {
    map* const m = new map;
    std::vector<keyframe*> ks;
    for (std::size_t i = 0; i != keyframes; ++i) ks.push_back(new keyframe(i));
    for (keyframe* k : ks) m->all_keyframes.push_back(k);
    std::vector<std::size_t> used(keyframes);
    for (std::size_t i = 0; i != points; ++i) {
      point* const p = new point;
      if (registry || !Counted) m->all_points.insert(p);
      // Consecutive keyframes see it.
      const std::size_t first = i * keyframes / points;
      for (std::size_t j = 0; j != observers; ++j) {
        const std::size_t k = (first + j) % keyframes;
        if (used[k] == slots) continue;
        p->observations[ks[k]] = {static_cast<int>(used[k]), -1};
        ks[k]->matches[used[k]++] = p;
      }
    }
    for (std::size_t i = 0; i != keyframes; ++i)
      for (std::size_t j = 1; j != 100 && j != keyframes; ++j)
        ks[i]->covisible[ks[(i + j) % keyframes]] = 15;
    return m;
  }
};

double cpu() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}
double wall() {
  return std::chrono::duration<double, std::milli>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

void delete_inline(unsigned round) {
  auto* const m = world<false>::build(true);
  const double begin = cpu();
  for (auto* k : m->all_keyframes) delete k;
  for (auto* p : m->all_points) delete p;
  delete m;
  std::printf("{\"how\": \"delete\", \"round\": %u, \"cpu_ms\": %.4f}\n", round, cpu() - begin);
}

void drop(unsigned round, bool registry) {
  using world = ::world<true>;
  slamgc::domain domain;
  slamgc::mutator me(domain, "main");
  slamgc::intrusive_rc<typename world::map> map(world::build(registry));
  std::vector<std::pair<double, double>> slices;
  me.quiescent();
  domain.collect();

  const double begin = cpu(), wall_begin = wall();
  map.reset();
  // Its own time, if it was interrupted.
  const double call = std::min(wall() - wall_begin, cpu() - begin);
  for (;;) {
    me.quiescent();
    const double from = wall(), cpu_from = cpu();
    const auto did = domain.collect({static_cast<std::size_t>(-1), std::chrono::milliseconds(2)});
    slices.emplace_back(wall() - from, cpu() - cpu_from);
    if (did.result == slamgc::collected::outcome::done) break;
  }
  const double all = cpu() - begin;
  std::printf(
      "{\"how\": \"%s\", \"round\": %u, \"cpu_ms\": %.4f, \"call_ms\": %.5f, \"slices_ms\": [",
      registry ? "registry" : "keyframes", round, all, call);
  for (const auto& s : slices)
    std::printf("%s%.3f", &s == slices.data() ? "" : ", ", std::min(s.first, s.second));
  std::printf("]}\n");
  for (const auto& type : domain.stats().types)
    if (type.live != 0) {
      std::fprintf(stderr, "objects of type %s are left\n", type.type);
      std::exit(1);
    }
}

}  // namespace

int main(int argc, char** argv) {
  unsigned rounds = 11;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--smoke") == 0) {
      keyframes = 8;
      points = 500;
      rounds = 1;
    } else if (std::strncmp(argv[i], "--rounds=", 9) == 0) {
      rounds = static_cast<unsigned>(std::strtoul(argv[i] + 9, nullptr, 10));
    } else {
      std::fprintf(stderr, "usage: %s [--smoke] [--rounds=N]\n", argv[0]);
      return 2;
    }
  }
  for (unsigned round = 0; round != rounds; ++round) {
    // In another order each round: what comes later finds a used heap.
    for (unsigned i = 0; i != 3; ++i) switch ((round + i) % 3) {
        case 0:
          delete_inline(round);
          break;
        case 1:
          drop(round, false);
          break;
        default:
          drop(round, true);
      }
  }
}
