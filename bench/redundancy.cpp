// What it costs to know which keyframes are redundant: by recomputing it, by connection sets, by level histograms.
//
// Under Google Benchmark. On synthetic maps: the time of a culling pass and of a change, against covisible keyframes,
// points per keyframe and observers per point. On recorded sessions (--data=FOLDER): the time of the whole session, of
// one pass over 30 keyframes, memory, and how often the thesis's pseudo code answers otherwise than the rule.
//
// bench_redundancy --data=FOLDER --benchmark_repetitions=11 --benchmark_enable_random_interleaving=true
#include <benchmark/benchmark.h>
#include <malloc.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <random>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "orb_map.hpp"

namespace {

// Bytes in use, as the allocator rounds them.
std::size_t bytes_in_use() { return mallinfo2().uordblks; }

namespace red = slamgc::redundancy;

// ---- ORB-SLAM3 as it is: it copies the slots, and the observations of each point

template <class View>
class recompute_with_copies : public no_index<View> {
 public:
  recompute_with_copies(const View& view, const red::rule& rule)
      : no_index<View>(view, rule), map_(view), rule_(rule) {}
  template <class KeyFrame>
  red::verdict check(KeyFrame* pKF) const {
    red::verdict v;
    auto slots = locked_copy(pKF->mMutexFeatures, pKF->mvpMapPoints);
    for (std::size_t i = 0; i != slots.size(); ++i) {
      auto* const pMP = slots[i];
      if (pMP == nullptr || locked_copy(pMP->mMutexFeatures, pMP->mbBad)) continue;
      ++v.eligible_slots;
      if (static_cast<int>(locked_size(pMP)) < rule_.others) continue;
      const int level = pKF->mvKeysUn[i].octave;
      const auto observations = locked_copy(pMP->mMutexFeatures, pMP->mObservations);
      int n = 0;
      for (const auto& o : observations) {
        if (o.first == pKF || map_.level(o.first, o.second.first) > level + rule_.slack) continue;
        if (++n == rule_.others) break;
      }
      v.redundant_slots += n >= rule_.others;
    }
    v.redundant = rule_.exceeded(v.redundant_slots, v.eligible_slots);
    return v;
  }

 private:
  template <class Mutex, class T>
  static T locked_copy(Mutex& m, const T& t) {
    const std::lock_guard<Mutex> lock(m);
    return t;
  }
  template <class MapPoint>
  static std::size_t locked_size(MapPoint* pMP) {
    const std::lock_guard<std::mutex> lock(pMP->mMutexFeatures);
    return pMP->mObservations.size();
  }
  View map_;
  red::rule rule_;
};

// ---- schemes

struct map_alone {
  static constexpr const char* name = "map alone";
  using states = no_states;
  template <class V>
  using index = no_index<V>;
};
struct copying {
  static constexpr const char* name = "recompute, copying";
  using states = no_states;
  template <class V>
  using index = recompute_with_copies<V>;
};
struct recompute {
  static constexpr const char* name = "recompute";
  using states = recompute_states;
  template <class V>
  using index = red::recompute<V>;
};
struct connection_sets {
  static constexpr const char* name = "connection_sets";
  using states = connection_sets_states;
  template <class V>
  using index = red::connection_sets<V>;
};
struct level_histogram {
  static constexpr const char* name = "level_histogram";
  using states = level_histogram_states;
  template <class V>
  using index = red::level_histogram<V>;
};
struct published {
  static constexpr const char* name = "connection_sets_as_published";
  using states = published_states;
  template <class V>
  using index = red::connection_sets_as_published<V>;
};

template <class Scheme>
using map_of = orb_map<typename Scheme::states, Scheme::template index>;

template <class Map, class KeyFrames>
int redundant_among(const Map& map, const KeyFrames& keyframes) {
  int n = 0;
  for (auto* pKF : keyframes) n += map.index.check(pKF).redundant;
  return n;
}

// ---- synthetic maps: each of `keyframes` sees a window of points, so that each point has `observers`

struct shape {
  int keyframes, slots, observers;
};

recorded_session synthetic(const shape& s) {
  recorded_session session;
  std::mt19937 random(1);
  session.points = s.keyframes * s.slots / s.observers;
  for (int k = 0; k != s.keyframes; ++k) {
    session.events.push_back({recorded_event::new_keyframe, k});
    session.levels.emplace_back();
    for (int i = 0; i != s.slots; ++i) {
      // Few features at coarse levels, as in an image pyramid with factor 1.2.
      session.levels.back().push_back(
          std::min(7, static_cast<int>(random() % 256 * (random() % 256) / 8192)));
      const int p =
          static_cast<int>((std::int64_t{k} * s.slots / s.observers + i) % session.points);
      session.events.push_back({recorded_event::observe, k, p, i});
      session.events.push_back({recorded_event::set_slot, k, p, i});
    }
  }
  return session;
}

template <class Scheme>
struct synthetic_map {
  explicit synthetic_map(const shape& s) : session(synthetic(s)), map(session, red::orb_slam3) {
    for (const recorded_event& e : session.events) map.replay(e);
  }
  recorded_session session;
  map_of<Scheme> map;
};

template <class Scheme>
void pass(benchmark::State& state, const shape& s) {
  const synthetic_map<Scheme> m(s);
  std::vector<typename map_of<Scheme>::KeyFrame*> keyframes;
  for (int k = 0; k != s.keyframes; ++k)
    keyframes.push_back(const_cast<synthetic_map<Scheme>&>(m).map.keyframe(k));
  for (auto _ : state) benchmark::DoNotOptimize(redundant_among(m.map, keyframes));
}

// One observation goes, with its slot, and another one comes in its place: four events.
template <class Scheme>
void change(benchmark::State& state, const shape& s) {
  synthetic_map<Scheme> m(s);
  std::mt19937 random(2);
  std::vector<std::pair<int, int>> places(4096);
  for (auto& p : places)
    p = {static_cast<int>(random() % static_cast<unsigned>(s.keyframes)),
         static_cast<int>(random() % static_cast<unsigned>(s.slots))};
  std::size_t next = 0;
  for (auto _ : state) {
    const auto& place = places[next++ % places.size()];
    const int point =
        m.map.keyframe(place.first)->mvpMapPoints[static_cast<std::size_t>(place.second)]->mnId;
    m.map.replay({recorded_event::unobserve, place.first, point});
    m.map.replay({recorded_event::clear_slot, place.first, -1, place.second});
    m.map.replay({recorded_event::observe, place.first, point, place.second});
    m.map.replay({recorded_event::set_slot, place.first, point, place.second});
  }
}

// ---- recorded sessions

struct session_file {
  std::string name;
  recorded_session session;
  std::vector<std::vector<int>> candidates;  // of each pass
  std::int64_t points_of_candidates = 0;
  explicit session_file(std::string n) : name(std::move(n)) {}

  // What ORB-SLAM3 would look at, in every pass; known beforehand, since it costs all schemes the same.
  void find_candidates() {
    map_of<map_alone> map(session, red::orb_slam3);
    for (const recorded_event& e : session.events) {
      map.replay(e);
      if (e.what != recorded_event::pass) continue;
      candidates.emplace_back();
      for (const auto* pKF : map.GetBestCovisibilityKeyFrames(map.keyframe(e.keyframe)))
        candidates.back().push_back(pKF->mnId);
      for (const int k : candidates.back())
        for (const auto* pMP : map.keyframe(k)->mvpMapPoints)
          points_of_candidates += pMP != nullptr && !pMP->mbBad;
    }
  }
};

// f(map, pass) at each pass.
template <class Map, class F>
void replay(const session_file& file, Map& map, F f) {
  std::size_t pass = 0;
  for (const recorded_event& e : file.session.events) {
    if (e.what == recorded_event::pass)
      f(map, pass++);
    else
      map.replay(e);
  }
}

template <class Scheme>
void session(benchmark::State& state, const session_file& file) {
  for (auto _ : state) {
    state.PauseTiming();
    auto map = std::make_unique<map_of<Scheme>>(file.session, red::orb_slam3);
    state.ResumeTiming();
    int redundant = 0;
    replay(file, *map, [&](map_of<Scheme>& m, std::size_t pass) {
      if constexpr (!std::is_same_v<Scheme, map_alone>)
        for (const int k : file.candidates[pass])
          redundant += m.index.check(m.keyframe(k)).redundant;
    });
    benchmark::DoNotOptimize(redundant);
    state.PauseTiming();
    map.reset();
    state.ResumeTiming();
  }
}

// The pass with most candidates of all, as the map was then.
template <class Scheme>
void pass_of_30(benchmark::State& state, const session_file& file) {
  std::size_t largest = 0;
  for (std::size_t i = 0; i != file.candidates.size(); ++i)
    if (file.candidates[i].size() > file.candidates[largest].size()) largest = i;
  map_of<Scheme> map(file.session, red::orb_slam3);
  std::size_t pass = 0;
  for (const recorded_event& e : file.session.events) {
    if (e.what == recorded_event::pass && pass++ == largest) break;
    map.replay(e);
  }
  std::vector<typename map_of<Scheme>::KeyFrame*> keyframes;
  for (const int k : file.candidates[largest])
    if (keyframes.size() < 30) keyframes.push_back(map.keyframe(k));
  for (auto _ : state) benchmark::DoNotOptimize(redundant_among(map, keyframes));
  state.counters["keyframes"] = static_cast<double>(keyframes.size());
}

// Bytes over the map itself: in the objects, and besides at the end of a session.
template <class Scheme>
std::size_t heap_at_end(const session_file& file) {
  const std::size_t before = bytes_in_use();
  map_of<Scheme> map(file.session, red::orb_slam3);
  replay(file, map, [](map_of<Scheme>&, std::size_t) {});
  const std::size_t whole = bytes_in_use() - before;
  map.forget_index();
  return whole - (bytes_in_use() - before);
}
template <class Scheme>
void memory(benchmark::State& state, const session_file& file) {
  for (auto _ : state) {
    state.counters["keyframe_bytes"] =
        static_cast<double>(sizeof(std::declval<typename map_of<Scheme>::KeyFrame>().redundancy));
    state.counters["point_bytes"] =
        static_cast<double>(sizeof(std::declval<typename map_of<Scheme>::MapPoint>().redundancy));
    state.counters["heap_bytes"] = static_cast<double>(heap_at_end<Scheme>(file));
  }
}

// The thesis's pseudo code against the rule that it is meant to follow.
void disagreement(benchmark::State& state, const session_file& file) {
  for (auto _ : state) {
    map_of<published> ours(file.session, red::orb_slam2);
    map_of<recompute> exact(file.session, red::orb_slam2);
    std::size_t pass = 0;
    std::int64_t asked = 0, redundant = 0, wrong = 0, wrongly_redundant = 0, counts_differ = 0;
    for (const recorded_event& e : file.session.events) {
      ours.replay(e);
      exact.replay(e);
      if (e.what != recorded_event::pass) continue;
      for (const int k : file.candidates[pass]) {
        const red::verdict a = ours.index.check(ours.keyframe(k)),
                           b = exact.index.check(exact.keyframe(k));
        ++asked;
        redundant += b.redundant;
        wrong += a.redundant != b.redundant;
        wrongly_redundant += a.redundant && !b.redundant;
        counts_differ += a.redundant_slots != b.redundant_slots;
      }
      ++pass;
    }
    state.counters["asked"] = static_cast<double>(asked);
    state.counters["redundant"] = static_cast<double>(redundant);
    state.counters["wrong"] = static_cast<double>(wrong);
    state.counters["wrongly_redundant"] = static_cast<double>(wrongly_redundant);
    state.counters["counts_differ"] = static_cast<double>(counts_differ);
  }
}

// The numbers of the thesis's estimate, for this session.
void workload(benchmark::State& state, const session_file& file) {
  for (auto _ : state) {
    std::int64_t candidates = 0, changes = 0, keyframes = 0;
    for (const auto& c : file.candidates) candidates += static_cast<std::int64_t>(c.size());
    for (const recorded_event& e : file.session.events) {
      changes += e.what != recorded_event::pass;
      keyframes += e.what == recorded_event::new_keyframe;
    }
    state.counters["passes"] = static_cast<double>(file.candidates.size());
    state.counters["candidates"] = static_cast<double>(candidates);
    state.counters["changes"] = static_cast<double>(changes);
    state.counters["keyframes"] = static_cast<double>(keyframes);
    state.counters["points"] = static_cast<double>(file.session.points);
    state.counters["slots"] =
        static_cast<double>(file.points_of_candidates) / static_cast<double>(candidates);
  }
}

// ---- registration

template <class F>
benchmark::internal::Benchmark* add(const std::string& name, F f) {
  return benchmark::RegisterBenchmark(name.c_str(), f);
}
// What does not vary, or takes long.
template <class F>
void add_once(const std::string& name, F f) {
  add(name, f)->Iterations(1)->Repetitions(1);
}

template <class Scheme>
void add_synthetic(const std::string& axis, int value, const shape& s) {
  const std::string where = "/" + axis + "/" + std::to_string(value) + "/" + Scheme::name;
  add("pass" + where, [s](benchmark::State& state) { pass<Scheme>(state, s); });
  add("change" + where, [s](benchmark::State& state) { change<Scheme>(state, s); });
}
// With a fixed number of iterations, or the map would be made anew for each attempt to find one.
template <class Scheme>
void add_session(const session_file& f) {
  constexpr bool keeps = !std::is_same_v<Scheme, copying> && !std::is_same_v<Scheme, recompute>;
  const std::string where = "/" + f.name + "/" + Scheme::name;
  auto* const whole =
      add("session" + where, [&f](benchmark::State& state) { session<Scheme>(state, f); });
  whole->Iterations(f.session.events.size() > 1000000 ? 1 : 3);
  if (std::is_same_v<Scheme, copying>) whole->Iterations(1)->Repetitions(1);
  if constexpr (!std::is_same_v<Scheme, map_alone>) {
    auto* const p =
        add("pass30" + where, [&f](benchmark::State& state) { pass_of_30<Scheme>(state, f); });
    p->Iterations(keeps ? 100000 : 50);
    if (std::is_same_v<Scheme, copying>) p->Iterations(5)->Repetitions(1);
    if constexpr (keeps)
      add_once("memory" + where, [&f](benchmark::State& state) { memory<Scheme>(state, f); });
  }
}

const char* const files[] = {
    "keble_college.txt",      "libmv_01.txt",        "libmv_02.txt",
    "libmv_03.txt",           "orbslam2_aims.trace", "orbslam2_rpy.trace",
    "orbslam2_rpyloop.trace", "orbslam3_std.trace",  "orbslam3_std35.trace"};

}  // namespace

int main(int argc, char** argv) {
  std::string folder;
  for (int i = 1; i < argc; ++i) {
    if (std::string(argv[i]).rfind("--data=", 0) != 0) continue;
    folder = argv[i] + 7;
    std::rotate(argv + i, argv + i + 1, argv + argc);
    --argc;
    break;
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;

  const auto add_shape = [](const std::string& axis, int value, const shape& s) {
    add_synthetic<recompute>(axis, value, s);
    add_synthetic<connection_sets>(axis, value, s);
    add_synthetic<level_histogram>(axis, value, s);
    add("change/" + axis + "/" + std::to_string(value) + "/" + map_alone::name,
        [s](benchmark::State& state) { change<map_alone>(state, s); });
  };
  for (const int n : {10, 30, 100, 300}) add_shape("covisible keyframes", n, {n, 300, 8});
  for (const int n : {30, 100, 300, 1000}) add_shape("points per keyframe", n, {30, n, 8});
  for (const int n : {3, 10, 30, 100}) add_shape("observers per point", n, {100, 300, n});

  std::vector<std::unique_ptr<session_file>> sessions;
  if (!folder.empty()) {
    for (const char* name : files) {
      auto f = std::make_unique<session_file>(name);
      if (!f->session.load(folder + "/" + name + ".gz") && !f->session.load(folder + "/" + name)) {
        std::fprintf(stderr, "not found, or not readable: %s\n", name);
        continue;
      }
      f->find_candidates();
      f->name = f->name.substr(0, f->name.find('.'));
      add_session<map_alone>(*f);
      add_session<copying>(*f);
      add_session<recompute>(*f);
      add_session<connection_sets>(*f);
      add_session<level_histogram>(*f);
      add_once("published/" + f->name,
               [&g = *f](benchmark::State& state) { disagreement(state, g); });
      add_once("workload/" + f->name, [&g = *f](benchmark::State& state) { workload(state, g); });
      sessions.push_back(std::move(f));
    }
  }
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
