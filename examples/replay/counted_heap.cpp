// operator new and delete that know how many bytes are in use. Each thread counts for itself.
#include <malloc.h>

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

#include "ledger.hpp"

namespace {

struct alignas(128) counter {
  std::atomic<long long> bytes{0};
};
constexpr unsigned counters = 64;
counter all[counters];
std::atomic<unsigned> next{0};

void add(long long bytes) {
  thread_local counter* const mine = &all[next.fetch_add(1, std::memory_order_relaxed) % counters];
  mine->bytes.fetch_add(bytes, std::memory_order_relaxed);
}

void* allocate(std::size_t size, std::size_t alignment) noexcept {
  if (size == 0) size = 1;
  void* const p =
      alignment <= alignof(std::max_align_t)
          ? std::malloc(size)
          : std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
  if (p != nullptr) add(static_cast<long long>(malloc_usable_size(p)));
  return p;
}
void* allocate_or_throw(std::size_t size, std::size_t alignment) {
  void* const p = allocate(size, alignment);
  if (p == nullptr) throw std::bad_alloc();
  return p;
}
void release(void* p) noexcept {
  if (p == nullptr) return;
  add(-static_cast<long long>(malloc_usable_size(p)));
  std::free(p);
}

}  // namespace

std::int64_t replay::live_bytes() {
  long long sum = 0;
  for (const counter& c : all) sum += c.bytes.load(std::memory_order_relaxed);
  return sum;
}
void replay::count_bytes(std::int64_t more) { add(more); }

void* operator new(std::size_t n) { return allocate_or_throw(n, 1); }
void* operator new[](std::size_t n) { return allocate_or_throw(n, 1); }
void* operator new(std::size_t n, std::align_val_t a) {
  return allocate_or_throw(n, static_cast<std::size_t>(a));
}
void* operator new[](std::size_t n, std::align_val_t a) {
  return allocate_or_throw(n, static_cast<std::size_t>(a));
}
void* operator new(std::size_t n, const std::nothrow_t&) noexcept { return allocate(n, 1); }
void* operator new[](std::size_t n, const std::nothrow_t&) noexcept { return allocate(n, 1); }
void operator delete(void* p) noexcept { release(p); }
void operator delete[](void* p) noexcept { release(p); }
void operator delete(void* p, std::size_t) noexcept { release(p); }
void operator delete[](void* p, std::size_t) noexcept { release(p); }
void operator delete(void* p, std::align_val_t) noexcept { release(p); }
void operator delete[](void* p, std::align_val_t) noexcept { release(p); }
void operator delete(void* p, std::size_t, std::align_val_t) noexcept { release(p); }
void operator delete[](void* p, std::size_t, std::align_val_t) noexcept { release(p); }
void operator delete(void* p, const std::nothrow_t&) noexcept { release(p); }
void operator delete[](void* p, const std::nothrow_t&) noexcept { release(p); }
