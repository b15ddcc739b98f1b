#include "report_json.hpp"

#include <sys/utsname.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <slamgc/version.hpp>
#include <stdexcept>
#include <thread>

#include "footprint.hpp"
#include "model.hpp"
#include "schemes.hpp"
#include "thesis.hpp"

namespace replay {

using json = nlohmann::json;

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(distribution, count, mean, median, p90, p99, max)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(sample, seconds, frames, live_bytes, resident_bytes, marked,
                                   freed)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(thread_result, name, wall, cpu, destroyed, longest_pause,
                                   reclaiming)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(run_result, scheme, finished, explanation, complaint, counted,
                                   faults, seconds, frames, made, inserted, marked, freed,
                                   peak_live, final_live, reset_live, peak_resident, final_resident,
                                   lap_live, threads, death_delay, map_digest, compared,
                                   differences, samples)

namespace {

// Also on the way to a pipe: what a child wrote need not be UTF-8.
std::string dumped(const json& j, int indent) {
  return j.dump(indent, ' ', false, json::error_handler_t::replace);
}

std::string cpu_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.compare(0, 10, "model name") == 0) return line.substr(line.find(':') + 2);
  return "unknown";
}

json machine() {
  utsname system{};
  uname(&system);
  return {{"cpu", cpu_name()},
          {"threads", std::thread::hardware_concurrency()},
          {"system", std::string(system.sysname) + " " + system.release}};
}

json program() {
#if defined(NDEBUG)
  const bool optimized = true;
#else
  const bool optimized = false;
#endif
  return {
      {"slamgc", std::to_string(SLAMGC_VERSION_MAJOR) + "." + std::to_string(SLAMGC_VERSION_MINOR) +
                     "." + std::to_string(SLAMGC_VERSION_PATCH)},
      {"compiler", __VERSION__},
      {"release_build", optimized}};
}

json session_json(const session& s) {
  json keyframes = json::array();
  for (std::size_t i = 0; i != s.has_pose.size(); ++i)
    if (s.has_pose[i])
      keyframes.push_back({{"id", i},
                           {"position", {s.poses[i][0], s.poses[i][1], s.poses[i][2]}},
                           {"culled", s.is_marked[i] != 0}});
  json points = json::array();
  std::string points_culled;  // a digit for each
  const auto millimetres = [](float metres) { return std::round(double{metres} * 1e3) / 1e3; };
  for (std::size_t i = 0; i != s.positions.size(); ++i) {
    const auto& p = s.positions[i];
    points.push_back({millimetres(p[0]), millimetres(p[1]), millimetres(p[2])});
    points_culled += s.is_marked_point[i] != 0 ? '1' : '0';
  }
  return {{"name", s.name},
          {"about", s.about},
          {"frames", s.frames},
          {"seconds", static_cast<double>(s.duration) / 1e6},
          {"steps", s.steps.size()},
          {"inserted", {s.inserted_keyframes, s.inserted_points}},
          {"marked", {s.marked_keyframes, s.marked_points}},
          {"keyframes", keyframes},
          {"points", points},
          {"points_culled", points_culled}};
}

json thesis_json() {
  json rows = json::array();
  for (const thesis_row& t : thesis_rows())
    rows.push_back({{"scheme", t.scheme},
                    {"name", t.name},
                    {"source", t.source},
                    {"outcome", t.outcome},
                    {"marked", t.marked},
                    {"freed", t.freed},
                    {"percent", t.percent},
                    {"raw_marked_mb", t.raw_marked_mb},
                    {"raw_freed_mb", t.raw_freed_mb},
                    {"seconds", t.seconds},
                    {"mapping_ms", t.mapping_ms},
                    {"tracking_ms", t.tracking_ms},
                    {"processed", t.processed}});
  return rows;
}

}  // namespace

footprints measured_footprints(const session& s) {
  footprints f;
  std::size_t features = 0;
  for (const auto& octaves : s.octaves) features += octaves.size();
  f.features =
      s.keyframes == 0 ? 0 : static_cast<int>(features / static_cast<std::size_t>(s.keyframes));
  f.object_size[0] = sizeof(KeyFrame<leak>);
  f.object_size[1] = sizeof(MapPoint<leak>);
  const std::vector<std::uint8_t> octaves(static_cast<std::size_t>(f.features));
  ledger::now();  // has memory of its own
  const std::int64_t before = live_bytes();
  const auto keyframe = std::make_unique<KeyFrame<leak>>(0, octaves);
  const std::int64_t with_keyframe = live_bytes();
  const auto point = std::make_unique<MapPoint<leak>>(0);
  f.bytes[0] = with_keyframe - before;
  f.bytes[1] = live_bytes() - with_keyframe;
  return f;
}

std::string to_text(const run_result& r) { return dumped(json(r), -1); }

bool from_text(const std::string& text, run_result& r) {
  try {
    r = json::parse(text).get<run_result>();
    return true;
  } catch (const json::exception&) {
    return false;
  }
}

void write_json(const std::string& path, const report& what) {
  const footprints f = measured_footprints(*what.of);
  const json j = {{"schema", "slamgc-replay 1"},
                  {"command", what.command},
                  {"program", program()},
                  {"machine", machine()},
                  {"session", session_json(*what.of)},
                  {"options",
                   {{"threads", what.options.threads},
                    {"speed", what.options.speed},
                    {"laps", what.options.laps},
                    {"viewer", what.options.viewer},
                    {"reclaimer", what.options.background ? "thread" : "mapping"}}},
                  {"footprint",
                   {{"features", f.features},
                    {"sizeof", f.object_size},
                    {"bytes", f.bytes},
                    {"thesis_sizeof", thesis_bytes}}},
                  {"thesis", thesis_json()},
                  {"runs", what.runs}};
  std::ofstream file(path);
  file << dumped(j, 1) << '\n';
  file.close();
  if (!file) throw std::runtime_error(path + ": cannot be written");
}

void write_csv(const std::string& path, const report& what) {
  std::ofstream file(path);
  file << "run,scheme,seconds,frames,live_bytes,resident_bytes,marked_keyframes,marked_points,"
          "freed_keyframes,freed_points\n";
  for (std::size_t i = 0; i != what.runs.size(); ++i)
    for (const sample& s : what.runs[i].samples)
      file << i << ',' << what.runs[i].scheme << ',' << s.seconds << ',' << s.frames << ','
           << s.live_bytes << ',' << s.resident_bytes << ',' << s.marked[0] << ',' << s.marked[1]
           << ',' << s.freed[0] << ',' << s.freed[1] << '\n';
  file.close();
  if (!file) throw std::runtime_error(path + ": cannot be written");
}

}  // namespace replay
