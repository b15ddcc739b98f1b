// Compiled once for each library, see CMakeLists.txt.
#include "library.hpp"

#include <chrono>
#include <cstdint>

#define JOIN(a, b) a##b
#define EXPAND(a, b) JOIN(a, b)
#define NAMED(function) EXPAND(LIBRARY, function)

namespace {
until_the_end kept;
}  // namespace

node* NAMED(_make)(int& destroyed) { return slamgc::make_rc<node>(destroyed).detach(); }
void NAMED(_drop)(node* p) { slamgc::intrusive_rc<node>::adopt(p).reset(); }
bool NAMED(_retire)(node* p) { return slamgc::retire(p); }
bool NAMED(_is_online)() {
  return slamgc::default_domain().synchronize(std::chrono::nanoseconds(0)) ==
         slamgc::waited::refused;
}
std::uint64_t NAMED(_live)() {
  return slamgc::default_domain().stats().total(&slamgc::type_stats::live);
}
std::uint64_t NAMED(_collect)() { return slamgc::default_domain().collect().reclaimed; }
void NAMED(_keep)(node* p) { kept.slot = p; }
