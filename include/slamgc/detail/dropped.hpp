/// @file
/// What cleared registries held, on its way to the collector.
#pragma once

#include <cstddef>

#include "../env.hpp"
#include "../fwd.hpp"
#include "table_base.hpp"

namespace slamgc {
namespace runtime SLAMGC_SHARED {

/// The content of a registry that was cleared. Its references are still counted: clearing is an unlinking that the
/// collector completes.
template <class Env>
class dropped_base {
 public:
  virtual ~dropped_base() = default;
  /// Retires and drops the objects one by one. By the collector; false if the limit came first.
  virtual bool drop(work_limit<Env>& limit) noexcept = 0;

 private:
  template <class>
  friend class dropped_list;
  dropped_base* next_ = nullptr;
};

/// Filled by any thread, emptied by the collector. Lock-free.
template <class Env>
class dropped_list {
 public:
  dropped_list() noexcept = default;
  ~dropped_list() {
    take();
    while (taken_ != nullptr) delete_first();
  }
  dropped_list(const dropped_list&) = delete;
  dropped_list& operator=(const dropped_list&) = delete;

  void push(dropped_base<Env>& content) noexcept {
    dropped_base<Env>* below = first_.load(std::memory_order_relaxed);  // (32) a guess.
    do {
      content.next_ = below;
      // (32) release: publishes the content to take().
    } while (!first_.compare_exchange_weak(below, &content, std::memory_order_release,
                                           std::memory_order_relaxed));  // (32)
  }
  /// What waits, in registries that were cleared. By whoever excludes collectors.
  std::size_t waiting() const noexcept {
    std::size_t n = 0;
    for (const auto* p = taken_; p != nullptr; p = p->next_) ++n;
    for (auto* p = first_.load(std::memory_order_seq_cst); p != nullptr; p = p->next_) ++n;
    return n;
  }
  /// Drops all that was pushed before. By the collector; false if the limit came first.
  bool drop_all(work_limit<Env>& limit) noexcept {
    for (;;) {
      if (taken_ == nullptr) take();
      if (taken_ == nullptr) return true;
      if (!taken_->drop(limit)) return false;
      delete_first();
    }
  }

 private:
  void take() noexcept {
    // (32) relaxed: whether there is something, which the grace period orders where it matters.
    if (first_.load(std::memory_order_relaxed) == nullptr) return;
    taken_ = first_.exchange(nullptr, std::memory_order_acquire);  // (32) sees the content.
  }
  void delete_first() noexcept {
    dropped_base<Env>* const next = taken_->next_;
    delete taken_;
    taken_ = next;
  }

  typename Env::template atomic<dropped_base<Env>*> first_{nullptr};
  dropped_base<Env>* taken_ = nullptr;  // the collector's
};

}  // namespace SLAMGC_SHARED
}  // namespace slamgc
