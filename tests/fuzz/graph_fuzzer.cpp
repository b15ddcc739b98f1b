// The target for libFuzzer. A failing input is explained in words; SLAMGC_FUZZ_WORDS=1 says them as it goes, for one that ends
// in a crash: SLAMGC_FUZZ_WORDS=1 graph_fuzzer crash-0123
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "graph_program.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size);
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const bool in_words = std::getenv("SLAMGC_FUZZ_WORDS") != nullptr;
  fuzz::program program(bytes, size, in_words);
  (void)program.run();
  return 0;
}
