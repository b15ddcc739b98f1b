// The same contenders under Google Benchmark, for its reports, its filters and its comparisons: an
// alternative to harness.cc, which also checks that threads overlapped and were not preempted.
#include <benchmark/benchmark.h>

#include <future>
#include <thread>

#include "harness.hpp"

namespace bench {

int run(int argc, char** argv, const std::vector<group>& groups) {
  for (const group& g : groups) {
    for (const contender& c : g.contenders) {
      const std::string name = g.operation + "/" + g.shape + "/" + c.name;
      const auto operations = static_cast<std::int64_t>(g.operations);
      for (unsigned threads : {1U, 2U, 4U, 8U}) {
        if (threads != 1 && c.one_thread_only) continue;
        benchmark::RegisterBenchmark(name.c_str(), [&c, operations](benchmark::State& state) {
          constexpr std::int64_t batch = 256;
          std::int64_t done = 0;
          while (state.KeepRunningBatch(batch)) {
            c.run(static_cast<unsigned>(state.thread_index()), batch, 0);
            done += batch;
          }
          state.SetItemsProcessed(done * operations);
        })->Threads(static_cast<int>(threads));
      }
    }
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  // libstdc++ leaves atomics out of std::shared_ptr while a program has one thread.
  std::promise<void> over;
  std::thread second([&over] { over.get_future().wait(); });
  benchmark::RunSpecifiedBenchmarks();
  over.set_value();
  second.join();
  benchmark::Shutdown();
  return 0;
}

}  // namespace bench
