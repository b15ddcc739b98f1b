#include "tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "thesis.hpp"

namespace replay {
namespace {

constexpr double mega = 1e6;

const thread_result* thread_of(const run_result& r, role which) {
  for (const auto& t : r.threads)
    if (t.name == name_of(which)) return &t;
  return nullptr;
}

// Of each scheme the run of median duration; one that stopped only if all did.
std::vector<const run_result*> middle_runs(const report& what) {
  std::vector<const run_result*> all;
  for (const scheme_entry& scheme : all_schemes()) {
    std::vector<const run_result*> of;
    for (const run_result& r : what.runs)
      if (r.scheme == scheme.name) of.push_back(&r);
    if (of.empty()) continue;
    const auto stopped = [](const run_result* r) { return !r->finished; };
    if (!std::all_of(of.begin(), of.end(), stopped))
      of.erase(std::remove_if(of.begin(), of.end(), stopped), of.end());
    std::sort(of.begin(), of.end(),
              [](const run_result* a, const run_result* b) { return a->seconds < b->seconds; });
    all.push_back(of[of.size() / 2]);
  }
  return all;
}

std::string percent(std::uint64_t part, std::uint64_t of) {
  return of == 0
             ? "-"
             : fmt::format("{:.1f} %", 100.0 * static_cast<double>(part) / static_cast<double>(of));
}
std::string megabytes(std::int64_t bytes) {
  return fmt::format("{:.1f}", static_cast<double>(bytes) / mega);
}
std::string more_than(double value, double base) {
  return base <= 0 ? "-" : fmt::format("{:+.1f} %", 100 * (value / base - 1));
}
std::string known(double value, const char* format) {
  return value < 0 ? "-" : fmt::format(fmt::runtime(format), value);
}
std::string number(int value) { return value < 0 ? "-" : fmt::format("{}", value); }

const thesis_row* published(const std::string& scheme) {
  for (const thesis_row& t : thesis_rows())
    if (scheme == t.scheme) return &t;
  return nullptr;
}

class table {
 public:
  explicit table(std::vector<std::string> head) { add(std::move(head)); }
  void add(std::vector<std::string> row) {
    widths_.resize(std::max(widths_.size(), row.size()));
    for (std::size_t i = 0; i != row.size(); ++i) widths_[i] = std::max(widths_[i], row[i].size());
    rows_.push_back(std::move(row));
  }
  std::string text() const {
    std::string out;
    for (std::size_t r = 0; r != rows_.size(); ++r) {
      std::string line;
      for (std::size_t i = 0; i != rows_[r].size(); ++i)
        line += i == 0 ? fmt::format("{:<{}}", rows_[r][i], widths_[i])
                       : fmt::format("  {:>{}}", rows_[r][i], widths_[i]);
      out += line + "\n";
      if (r == 0) out += std::string(line.size(), '-') + "\n";
    }
    return out;
  }

 private:
  std::vector<std::vector<std::string>> rows_;
  std::vector<std::size_t> widths_;
};

std::string deletion(const std::vector<const run_result*>& runs, std::size_t k, const char* title) {
  table t({title, "marked", "freed", "percent", "MB freed as the thesis counts", "thesis: marked",
           "freed", "percent", "MB freed"});
  for (const run_result* r : runs) {
    const thesis_row* const p = published(r->scheme);
    const double raw = static_cast<double>(r->freed[k]) * thesis_bytes[k] / mega;
    t.add({r->scheme, fmt::format("{}", r->marked[k]), fmt::format("{}", r->freed[k]),
           percent(r->freed[k], r->marked[k]), fmt::format("{:.2f}", raw),
           p != nullptr ? number(p->marked[k]) : "", p != nullptr ? number(p->freed[k]) : "",
           p == nullptr ? "" : known(p->percent[k], "{:.0f} %"),
           p == nullptr ? "" : known(p->raw_freed_mb[k], "{:.2f}")});
  }
  return t.text();
}

std::string times(const std::vector<const run_result*>& runs, role which, const char* title) {
  table t({title, "mean ms", "of leak", "p50", "p99", "max", "cpu p50", "of leak",
           "thesis: mean ms", "of leak"});
  const thread_result* base = nullptr;
  for (const run_result* r : runs)
    if (r->scheme == "leak") base = thread_of(*r, which);
  for (const run_result* r : runs) {
    const thread_result* const x = thread_of(*r, which);
    if (x == nullptr || !r->finished) continue;
    const thesis_row* const p = published(r->scheme);
    const double theirs = p == nullptr              ? -1
                          : which == role::tracking ? p->tracking_ms
                                                    : p->mapping_ms;
    const thesis_row& vanilla = thesis_rows().front();
    const double plain = which == role::tracking ? vanilla.tracking_ms : vanilla.mapping_ms;
    t.add({r->scheme, fmt::format("{:.2f}", x->wall.mean),
           base != nullptr ? more_than(x->wall.mean, base->wall.mean) : "-",
           fmt::format("{:.2f}", x->wall.median), fmt::format("{:.2f}", x->wall.p99),
           fmt::format("{:.2f}", x->wall.max), fmt::format("{:.2f}", x->cpu.median),
           base != nullptr ? more_than(x->cpu.median, base->cpu.median) : "-",
           known(theirs, "{:.2f}"), theirs < 0 ? "-" : more_than(theirs, plain)});
  }
  return t.text();
}

std::string processing(const std::vector<const run_result*>& runs) {
  table t({"processed", "seconds", "frames", "keyframes", "points", "thesis: seconds", "keyframes",
           "points"});
  for (const run_result* r : runs) {
    const thesis_row* const p = published(r->scheme);
    t.add({r->scheme, fmt::format("{:.1f}", r->seconds), fmt::format("{}", r->frames),
           fmt::format("{}", r->inserted[0]), fmt::format("{}", r->inserted[1]),
           p == nullptr ? "" : known(p->seconds, "{:.0f}"),
           p == nullptr ? "" : number(p->processed[0]),
           p == nullptr ? "" : number(p->processed[1])});
  }
  return t.text();
}

std::string memory(const std::vector<const run_result*>& runs) {
  table t({"memory, MB", "peak live", "live at the end", "after a reset", "peak resident",
           "mark to free: p50 ms", "max ms", "longest pause ms", "destructors on tracking"});
  for (const run_result* r : runs) {
    if (!r->finished || r->counted) continue;
    std::uint64_t on_tracking = 0;
    if (const thread_result* const x = thread_of(*r, role::tracking))
      on_tracking = x->destroyed[0] + x->destroyed[1];
    double pause = 0;
    for (const auto& x : r->threads) pause = std::max(pause, x.longest_pause);
    const bool freed = r->death_delay.count != 0;
    t.add({r->scheme, megabytes(r->peak_live), megabytes(r->final_live), megabytes(r->reset_live),
           megabytes(r->peak_resident), freed ? fmt::format("{:.1f}", r->death_delay.median) : "-",
           freed ? fmt::format("{:.0f}", r->death_delay.max) : "-", fmt::format("{:.2f}", pause),
           fmt::format("{}", on_tracking)});
  }
  return t.text();
}

// What is seen, from the data.
std::string words(const report& what, const std::vector<const run_result*>& runs) {
  std::string out;
  const run_result* base = nullptr;
  for (const run_result* r : runs)
    if (r->scheme == "leak") base = r;
  for (const run_result& r : what.runs)
    if (!r.finished)
      out += fmt::format("{}: stopped after {} of {} frames; {}.\n", r.scheme, r.frames,
                         long{what.of->frames} * what.options.laps, r.explanation);
  for (const run_result* r : runs) {
    if (r->counted)
      out += fmt::format("{}: had it gone on, it would have used deleted objects {} times.\n",
                         r->scheme, r->faults);
    if (!r->finished) continue;
    const char* const what_of_it = r->scheme == "leak" ? "the map" : "what lives of the map";
    if (r->compared && r->differences.empty())
      out += fmt::format("{}: {} is as recorded, kind by kind.\n", r->scheme, what_of_it);
    if (r->compared && !r->differences.empty())
      out += fmt::format("{}: {} is not as recorded in {} kinds; {}\n", r->scheme, what_of_it,
                         r->differences.size(), r->differences.front());
    if (base != nullptr && base->finished && r->map_digest != base->map_digest)
      out += fmt::format("{}: its live map is not that of leak.\n", r->scheme);
    static const char* const kinds[] = {"keyframes", "points"};
    for (std::size_t k = 0; k != 2; ++k)
      if (r->scheme != "leak" && r->freed[k] < r->marked[k])
        out += fmt::format("{}: {} of {} marked {} are never freed: references to them are left.\n",
                           r->scheme, r->marked[k] - r->freed[k], r->marked[k], kinds[k]);
    if (const thread_result* const t = thread_of(*r, role::tracking))
      if (const std::uint64_t n = t->destroyed[0] + t->destroyed[1]; n != 0 && !r->counted)
        out += fmt::format("{}: {} objects were destroyed by the tracking thread.\n", r->scheme, n);
  }
  return out;
}

}  // namespace

std::string heading(const report& what) {
  const session& s = *what.of;
  const footprints f = measured_footprints(s);
  return fmt::format(
      "{}\n{} frames in {:.1f} s; {} keyframes made, {} of them culled; {} points made, {} of them "
      "removed\n"
      "A keyframe of {} features takes {:.0f} kB here (sizeof {}; ORB-SLAM3: 308 to 354 kB), a "
      "point without its observations {:.2f} kB (sizeof {}; ORB-SLAM3: 0.91 "
      "kB).\nThe thesis counts {} and {} bytes, which is sizeof alone.\n",
      s.about, s.frames, static_cast<double>(s.duration) / 1e6, s.keyframes, s.marked_keyframes,
      s.points, s.marked_points, f.features, static_cast<double>(f.bytes[0]) / 1e3,
      f.object_size[0], static_cast<double>(f.bytes[1]) / 1e3, f.object_size[1], thesis_bytes[0],
      thesis_bytes[1]);
}

std::string tables(const report& what) {
  const auto runs = middle_runs(what);
  return fmt::format("{}\n{}\n{}\n{}\n{}\n{}\n{}", deletion(runs, 0, "keyframes"),
                     deletion(runs, 1, "points"),
                     times(runs, role::tracking, "tracking, per frame"),
                     times(runs, role::mapping, "local mapping, per keyframe"), processing(runs),
                     memory(runs), words(what, runs));
}

}  // namespace replay
