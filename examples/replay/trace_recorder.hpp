// Writes traces that slamgc-replay reads (docs/trace-format.md, version 2). Needs nothing but the standard library: copy this
// file into a SLAM system, and call one function where something happens to its map.
//
//   std::ofstream file("session.trace");
//   trace_recorder recorder(file, "my system, this sequence");
//   recorder.observation(trace_recorder::local_mapping, pKF->mnId, pMP->mnId, idx, octave);   // in AddObservation
//
// The order of the lines is the order in which things happened. So call it where the object's own lock is held.
//
// Thread-safety: all functions by any thread. One lock and one formatted line each.
#pragma once

#include <chrono>
#include <initializer_list>
#include <mutex>
#include <ostream>
#include <string>
#include <vector>

class trace_recorder {
 public:
  using id = long;
  enum thread { tracking = 0, local_mapping = 1, loop_closing = 2, global_adjustment = 3 };

  trace_recorder(std::ostream& out, const std::string& about) : out_(out) {
    std::string line = about;  // of one line
    for (char& c : line)
      if (c == '\n' || c == '\r') c = ' ';
    out_ << "# slamtrace 2 " << line << '\n';
  }
  trace_recorder(const trace_recorder&) = delete;
  trace_recorder& operator=(const trace_recorder&) = delete;

  // ---- iterations

  void frame_begins(id frame) { write('F', tracking, {frame}); }
  void frame_ends(id frame) { write('E', tracking, {frame}); }  // tracking holds no pointer now
  void iteration_begins(thread t) { write('S', t, {}); }
  void iteration_ends(thread t) { write('Z', t, {}); }  // the thread holds no pointer now

  // ---- keyframes and points

  void keyframe_made(thread t, id kf, id frame, id features) {
    write('k', t, {kf, frame, features});
  }
  void keyframe_inserted(thread t, id kf) { write('K', t, {kf}); }
  void keyframe_bad(thread t, id kf) { write('D', t, {kf}); }
  void point_made(thread t, id p) { write('p', t, {p}); }
  void point_inserted(thread t, id p) { write('P', t, {p}); }
  void point_bad(thread t, id p) { write('B', t, {p}); }
  void point_replaced(thread t, id p, id by) { write('R', t, {p, by}); }  // it is bad then, too

  // ---- references

  void observation(thread t, id kf, id p, id index, id octave) {
    write('O', t, {kf, p, index, octave});
  }
  void observation_erased(thread t, id kf, id p) { write('X', t, {kf, p}); }
  void slot_set(thread t, id kf, id index, id p) { write('s', t, {kf, index, p}); }
  void slot_cleared(thread t, id kf, id index) { write('z', t, {kf, index}); }
  void covisibility(thread t, id kf, id other, id weight) { write('C', t, {kf, other, weight}); }
  void covisibility_erased(thread t, id kf, id other) { write('c', t, {kf, other}); }
  void parent(thread t, id kf, id of) { write('T', t, {kf, of}); }  // -1: none
  void child(thread t, id kf, id of) { write('H', t, {kf, of}); }
  void child_erased(thread t, id kf, id of) { write('h', t, {kf, of}); }
  void loop_edge(thread t, id kf, id other) { write('G', t, {kf, other}); }
  void merge_edge(thread t, id kf, id other) { write('g', t, {kf, other}); }
  void temporal(thread t, id kf, id previous, id next) {
    write('N', t, {kf, previous, next});
  }  // -1: none
  void database_add(thread t, id kf) { write('Q', t, {kf}); }
  void database_erase(thread t, id kf) { write('q', t, {kf}); }
  void loop_corrected(thread t, id kf, id with) { write('L', t, {kf, with}); }

  // ---- what a frame uses

  void matched(id frame, const std::vector<id>& points) { write('m', tracking, {frame}, &points); }
  void local_map(id frame, const std::vector<id>& keyframes, id points) {
    write('l', tracking, {frame}, &keyframes, points);
  }
  void reference(id frame, id kf) { write('r', tracking, {frame, kf}); }

 private:
  void write(char letter, thread t, std::initializer_list<id> numbers,
             const std::vector<id>* list = nullptr, id last = -1) {
    std::string rest;
    for (const id n : numbers) add(rest, n);
    if (list != nullptr) {
      add(rest, static_cast<id>(list->size()));
      for (const id n : *list) add(rest, n);
      if (last >= 0) add(rest, last);
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto now = std::chrono::steady_clock::now() - begin_;
    out_ << letter << ' ' << std::chrono::duration_cast<std::chrono::microseconds>(now).count()
         << ' ' << static_cast<int>(t) << rest << '\n';
  }
  static void add(std::string& line, id n) { (line += ' ') += std::to_string(n); }

  std::mutex mutex_;
  std::ostream& out_;
  const std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};
