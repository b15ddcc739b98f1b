#include "child.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <system_error>

#include "report_json.hpp"

#if defined(__has_feature)
#define REPLAY_HAS_FEATURE(x) __has_feature(x)
#else
#define REPLAY_HAS_FEATURE(x) 0
#endif

namespace replay {
namespace {

constexpr int exit_fault = 42;
#if defined(__SANITIZE_ADDRESS__) || REPLAY_HAS_FEATURE(address_sanitizer)
constexpr bool sanitizer_catches = true;
#else
constexpr bool sanitizer_catches = false;
#endif

// In memory that both processes see.
struct blackboard {
  std::atomic<long> frames{0};
  std::atomic<long long> live{0};
  std::atomic<unsigned long long> marked[2] = {}, freed[2] = {};
  std::atomic<bool> has_fault{false};
  char fault[256] = {};
};
blackboard* shared = nullptr;

void note_counts() {
  for (int k = 0; k != 2; ++k) {
    shared->marked[k] = ledger::now().marked[k].load(std::memory_order_relaxed);
    shared->freed[k] = ledger::now().freed[k].load(std::memory_order_relaxed);
  }
}

// The first one tells; also called from signal handlers.
[[noreturn]] void tell(const char* what) {
  note_counts();
  if (!shared->has_fault.exchange(true))
    std::snprintf(shared->fault, sizeof shared->fault, "%s: by %s, in its iteration %ld", what,
                  name_of(current_role()), current_iteration());
  _exit(exit_fault);
}
void on_signal(int signal) {
  tell(signal == SIGSEGV  ? "segmentation fault"
       : signal == SIGBUS ? "bus error"
       : signal == SIGFPE ? "arithmetic error"
                          : "the C library found the heap damaged (abort)");
}

[[noreturn]] void be_the_child(const scheme_entry& scheme, run_request request, int out) {
  on_fault([](const char* what) { tell(what); });
  if (!sanitizer_catches)
    for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGABRT}) std::signal(signal, on_signal);
  request.progress = [](long frames) {
    shared->frames = frames;
    shared->live = live_bytes();
    note_counts();
  };
  int status = 0;
  try {
    const std::string text = to_text(scheme.run(request));
    for (std::size_t done = 0; done != text.size();) {
      const ssize_t n = write(out, text.data() + done, text.size() - done);
      if (n < 0) _exit(1);
      done += static_cast<std::size_t>(n);
    }
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    status = 1;
  }
  _exit(status);
}

std::string first_line_with(const std::string& text, const char* what) {
  const std::size_t at = text.find(what);
  return at == std::string::npos ? "" : text.substr(at, text.find('\n', at) - at);
}

std::string contents_of(int file) {
  std::string all;
  char piece[4096];
  lseek(file, 0, SEEK_SET);
  for (ssize_t n; (n = read(file, piece, sizeof piece)) > 0;)
    all.append(piece, static_cast<std::size_t>(n));
  return all;
}

}  // namespace

run_result run_in_child(const scheme_entry& scheme, const run_request& request, double patience,
                        const std::function<void(const child_progress&)>& show) {
  void* const memory =
      mmap(nullptr, sizeof(blackboard), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  int ends[2];
  std::FILE* const errors = std::tmpfile();
  if (memory == MAP_FAILED || errors == nullptr || pipe(ends) != 0)
    throw std::system_error(errno, std::generic_category(), "a child process cannot be prepared");
  shared = new (memory) blackboard;
  std::fflush(nullptr);
  const std::int64_t start = nanoseconds_now(), live_before = live_bytes();
  const pid_t child = fork();
  if (child < 0) throw std::system_error(errno, std::generic_category(), "fork");
  if (child == 0) {
    close(ends[0]);
    dup2(fileno(errors), STDERR_FILENO);
    be_the_child(scheme, request, ends[1]);
  }
  close(ends[1]);

  const auto seen = [&] {
    child_progress p;
    p.frames = shared->frames;
    p.seconds = static_cast<double>(nanoseconds_now() - start) / 1e9;
    p.live_bytes = std::max<std::int64_t>(0, shared->live - live_before);
    for (int k = 0; k != 2; ++k) p.marked[k] = shared->marked[k], p.freed[k] = shared->freed[k];
    return p;
  };
  std::string text;
  long last_frames = -1;
  double last_change = 0;
  bool gave_up = false;
  for (bool open = true; open;) {
    pollfd wanted{ends[0], POLLIN, 0};
    const int ready = poll(&wanted, 1, 200);
    const child_progress p = seen();
    if (ready > 0) {
      char piece[65536];
      const ssize_t n = read(ends[0], piece, sizeof piece);
      if (n > 0) text.append(piece, static_cast<std::size_t>(n));
      open = n > 0;
    } else if (p.frames != last_frames) {
      last_frames = p.frames;
      last_change = p.seconds;
      show(p);
    } else if (p.seconds - last_change > patience) {
      gave_up = true;
      kill(child, SIGKILL);
      open = false;
    }
  }
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);

  run_result r;
  const std::string complaint = contents_of(fileno(errors));
  std::fclose(errors);
  const bool fine = WIFEXITED(status) && WEXITSTATUS(status) == 0 && !gave_up && from_text(text, r);
  if (!fine) {
    const child_progress p = seen();
    r = run_result{};
    r.scheme = scheme.name;
    r.seconds = p.seconds;
    r.frames = p.frames;
    r.final_live = r.peak_live = p.live_bytes;
    for (int k = 0; k != 2; ++k) r.marked[k] = p.marked[k], r.freed[k] = p.freed[k];
    const std::string sanitizer = first_line_with(complaint, "Sanitizer:");
    if (gave_up)
      r.explanation = "made no progress any more, and was ended";
    else if (shared->has_fault)
      r.explanation = shared->fault;
    else if (!sanitizer.empty())
      r.explanation = sanitizer;
    else if (WIFSIGNALED(status))
      r.explanation = std::string("ended by ") + strsignal(WTERMSIG(status));
    else
      r.explanation =
          complaint.empty() ? "ended without a result" : complaint.substr(0, complaint.find('\n'));
  }
  if (!complaint.empty()) r.complaint = complaint;
  shared->~blackboard();
  munmap(memory, sizeof(blackboard));
  return r;
}

}  // namespace replay
