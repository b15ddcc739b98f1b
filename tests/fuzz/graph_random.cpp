// Random programs against the oracle, and those of the corpus.
//
// A failing one prints its seed, its bytes and its words. SLAMGC_SEED=... runs the program of that seed alone;
// SLAMGC_FUZZ_WORDS=1 says the words as it goes, for one that ends in a crash.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "graph_program.hpp"

extern "C" __attribute__((weak)) void __sanitizer_set_death_callback(void (*)());

namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr std::size_t slowness = 50;
#elif !defined(__OPTIMIZE__)
constexpr std::size_t slowness = 20;
#else
constexpr std::size_t slowness = 1;
#endif

// SLAMGC_STRESS_ROUNDS, of which there are 1000 else.
std::size_t operations_to_run() {
  const char* const wish = std::getenv("SLAMGC_STRESS_ROUNDS");
  const long rounds = wish != nullptr ? std::atol(wish) : 0;
  return static_cast<std::size_t>(rounds > 0 ? rounds : 1000) * 10500 / slowness;
}
bool in_words() { return std::getenv("SLAMGC_FUZZ_WORDS") != nullptr; }

std::string now_running;
void name_the_program() { std::fprintf(stderr, "graph_random: it was %s\n", now_running.c_str()); }
void name_it_at_signal(int signal) {
  name_the_program();
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}
void name_it_at_the_end() {
  if (__sanitizer_set_death_callback != nullptr) __sanitizer_set_death_callback(&name_the_program);
  std::signal(SIGABRT, &name_it_at_signal);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  std::signal(SIGSEGV, &name_it_at_signal);
#endif
}

// Steele, Lea and Flood 2014.
class splitmix64 {
 public:
  explicit splitmix64(std::uint64_t seed) : state_(seed) {}
  std::uint64_t operator()() {
    std::uint64_t z = (state_ += UINT64_C(0x9e3779b97f4a7c15));
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
  }

 private:
  std::uint64_t state_;
};

// Long ones build large graphs, and short ones begin anew more often.
std::vector<std::uint8_t> program_of(std::uint64_t seed) {
  splitmix64 random(seed);
  std::vector<std::uint8_t> bytes(std::size_t{64} << random() % 7);
  for (std::uint8_t& b : bytes) b = static_cast<std::uint8_t>(random() >> 40);
  return bytes;
}
std::size_t run(const std::vector<std::uint8_t>& bytes, const std::string& name) {
  now_running = name;
  fuzz::program program(bytes.data(), bytes.size(), in_words());
  return program.run();
}

TEST(GraphPrograms, RandomOnesAgreeWithTheOracle) {
  name_it_at_the_end();
  const char* const only = std::getenv("SLAMGC_SEED");
  std::uint64_t seed = only != nullptr ? std::strtoull(only, nullptr, 0) : 1;
  const std::size_t wanted = only != nullptr ? 1 : operations_to_run();
  std::size_t operations = 0;
  std::size_t programs = 0;
  for (; operations < wanted; ++seed, ++programs) {
    operations += run(program_of(seed), "SLAMGC_SEED=" + std::to_string(seed));
    if (only != nullptr) break;
  }
  RecordProperty("operations", std::to_string(operations));
  std::printf("%zu operations in %zu programs\n", operations, programs);
  EXPECT_GT(operations, 0U);
}

TEST(GraphPrograms, ThoseOfTheCorpusAgreeWithTheOracle) {
  name_it_at_the_end();
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(SLAMGC_CORPUS))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    std::ifstream in(file, std::ios::binary);
    const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(in),
                                          std::istreambuf_iterator<char>()};
    (void)run(bytes, file.string());
  }
  EXPECT_FALSE(files.empty());
}

}  // namespace
