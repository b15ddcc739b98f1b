// The allocations that a collection makes ask for null in place of an exception: one of them may fail.
#include <cstddef>
#include <new>

#include "graph_program.hpp"

// NOLINTNEXTLINE(misc-new-delete-overloads): memory is that of the ordinary operator
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  if (fuzz::failing_allocation != 0 && --fuzz::failing_allocation == 0) return nullptr;
  try {
    return ::operator new(size);
  } catch (...) {
    return nullptr;
  }
}
