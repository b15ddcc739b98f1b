// slamgc-replay: plays a recorded SLAM session under each way to own a map's objects, and says what is freed and what it costs.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <fstream>
#include <string>
#include <vector>

#include "child.hpp"
#include "default_session.hpp"
#include "report_json.hpp"
#include "state.hpp"
#include "tables.hpp"

namespace {

// "recorded", "max", or a factor such as "4x". Throws CLI::ValidationError.
double speed_of(const std::string& text) {
  if (text == "recorded") return 1;
  if (text == "max") return 0;
  std::size_t used = 0;
  double factor = 0;
  try {
    factor = std::stod(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  if (used == 0 || text.substr(used) != "x" || !(factor >= 0.01 && factor <= 10000))
    throw CLI::ValidationError(
        "--speed",
        "'" + text + "' is neither 'recorded' nor 'max' nor a factor from 0.01x to 10000x");
  return factor;
}

std::vector<const replay::scheme_entry*> chosen(const std::vector<std::string>& names) {
  std::vector<const replay::scheme_entry*> all;
  for (const auto& scheme : replay::all_schemes())
    if (names.empty() || std::find(names.begin(), names.end(), scheme.name) != names.end())
      all.push_back(&scheme);
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Plays a recorded SLAM session under each way to own the map's objects: what is freed, and "
      "what it costs.",
      "slamgc-replay"};
  std::string file, final_file, json, csv, speed = "max", reclaimer = "thread";
  std::vector<std::string> names;
  int repeat = 1;
  double patience = 60;
  bool in_order = false, list = false, quiet = false, flat = false;
  replay::play_options options;
  std::vector<std::string> known;
  for (const auto& scheme : replay::all_schemes()) known.emplace_back(scheme.name);
  app.add_option("trace", file,
                 "a trace or a graph (docs/trace-format.md), compressed or not; - is the standard "
                 "input. Without it: the session in the program");
  app.add_option("--schemes", names, "which schemes (all)")
      ->delimiter(',')
      ->check(CLI::IsMember(known));
  app.add_flag("--in-order", in_order,
               "one thread does everything in the order of the trace: for comparisons");
  app.add_option("--speed", speed, "recorded, a factor such as 4x, or max")->capture_default_str();
  app.add_option("--laps", options.laps, "how often, with a reset of the map in between")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_option("--minutes", options.minutes, "begin no lap later than that, whatever --laps says")
      ->check(CLI::Range(0.01, 10080.0));
  app.add_flag("--must-be-flat", flat, "fail if memory grows from lap to lap under deferred");
  app.add_flag("--viewer", options.viewer, "with a viewer thread");
  app.add_option(
         "--reclaimer", reclaimer,
         "who reclaims under deferred: a thread of its own, or local mapping at the end of culling")
      ->check(CLI::IsMember({"thread", "mapping"}))
      ->capture_default_str();
  app.add_option("--repeat", repeat,
                 "how often all schemes are run, in turn; tables show the run of median duration")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--patience", patience,
                 "seconds without progress after which a scheme is given up")
      ->check(CLI::Range(1.0, 86400.0))
      ->capture_default_str();
  app.add_option("--final", final_file,
                 "what the recorded system had in memory at the end: is it the same here?")
      ->check(CLI::ExistingFile);
  app.add_option("--json", json, "write all results to this file");
  app.add_option("--csv", csv, "write memory and deaths over time to this file");
  app.add_flag("--list", list, "the schemes, and nothing else");
  app.add_flag("--quiet", quiet, "no progress");
  try {
    app.parse(argc, argv);
    options.speed = speed_of(speed);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  if (list) {
    for (const auto& scheme : replay::all_schemes())
      fmt::print("{:<16} {}\n", scheme.name, scheme.about);
    return 0;
  }
  if (options.minutes > 0) options.laps = 100000;
  options.threads = !in_order;
  options.background = reclaimer == "thread";

  try {
    for (const std::string& path : {json, csv})
      if (!path.empty() && !std::ofstream(path, std::ios::app))
        throw std::runtime_error(path + ": cannot be written");
    const replay::session session = replay::make_session(
        file.empty() ? replay::read_trace("fr1_rpy (in the program)", replay::default_session())
                     : replay::read_trace(file));
    replay::map_state final_state;
    if (!final_file.empty()) final_state = replay::read_final_state(final_file, session);
    const auto steps =
        options.threads ? replay::schedule(session) : std::vector<std::vector<replay::step>>{};

    replay::report report;
    report.of = &session;
    report.options = options;
    for (int i = 0; i != argc; ++i) report.command += std::string(i == 0 ? "" : " ") + argv[i];
    fmt::print("{}\n", replay::heading(report));

    replay::run_request request;
    request.of = &session;
    request.steps = &steps;
    request.final_state = final_file.empty() ? nullptr : &final_state;
    request.options = options;
    const bool terminal = isatty(STDOUT_FILENO) != 0;
    const long all_frames = long{session.frames} * options.laps;
    for (int i = 0; i != repeat; ++i)
      for (const auto* scheme : chosen(names)) {
        const auto show = [&](const replay::child_progress& p) {
          if (quiet || !terminal) return;
          fmt::print(
              "\r{:<16} {:>6.1f} s  frame {} of {}  {:.1f} MB live  keyframes freed {} of {}  "
              "points {} of {}   ",
              scheme->name, p.seconds, p.frames, all_frames,
              static_cast<double>(p.live_bytes) / 1e6, p.freed[0], p.marked[0], p.freed[1],
              p.marked[1]);
          std::fflush(stdout);
        };
        request.options.count_faults = false;
        report.runs.push_back(replay::run_in_child(*scheme, request, patience, show));
        if (!report.runs.back().finished && scheme->is_unsafe) {
          if (!quiet)
            fmt::print("{}{:<16} {}; again, counting such uses\n", terminal ? "\r\x1b[K" : "",
                       scheme->name, report.runs.back().explanation);
          request.options.count_faults = true;
          report.runs.push_back(replay::run_in_child(*scheme, request, patience, show));
        }
        const auto& r = report.runs.back();
        if (!quiet)
          fmt::print(
              "{}{:<16} {:>6.1f} s  {:.1f} MB live at the end, {} of {} keyframes and {} of {} "
              "points freed{}\n",
              terminal ? "\r\x1b[K" : "", r.scheme, r.seconds,
              static_cast<double>(r.final_live) / 1e6, r.freed[0], r.marked[0], r.freed[1],
              r.marked[1], r.finished ? "" : ": " + r.explanation);
        std::fflush(stdout);
      }
    fmt::print("\n{}", replay::tables(report));
    if (!json.empty()) replay::write_json(json, report);
    if (!csv.empty()) replay::write_csv(csv, report);
    for (const auto& r : report.runs) {
      if (r.scheme != "deferred") continue;
      if (!r.finished) return 1;
      if (!flat) continue;
      const double growth = static_cast<double>(replay::growth_of(r)) / 1e6,
                   peak = static_cast<double>(r.peak_live) / 1e6;
      fmt::print(
          "deferred: after {} laps memory is {:+.2f} MB of what it was after the second; at most "
          "{:.1f} MB\n",
          r.lap_live.size(), growth, peak);
      if (r.lap_live.size() < 3)
        throw std::runtime_error("too few laps to say whether memory grows");
      if (growth > 0.01 * peak) throw std::runtime_error("memory grows");
    }
    return 0;
  } catch (const std::exception& e) {
    fmt::print(stderr, "slamgc-replay: {}\n", e.what());
    return 1;
  }
}
