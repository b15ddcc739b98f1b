// All references as std::shared_ptr, as in the forks that were ported to it; or those from points to keyframes as std::weak_ptr.
#pragma once

#include <memory>

#include "schemes.hpp"

namespace replay {

// A shared_ptr that is written and read like a plain pointer.
template <class T>
class shared_pointer {
 public:
  shared_pointer() = default;
  shared_pointer(T* p) : p_(p != nullptr ? p->shared_from_this() : nullptr) {}
  shared_pointer(std::shared_ptr<T> p) : p_(std::move(p)) {}
  operator T*() const { return p_.get(); }
  const std::shared_ptr<T>& shared() const { return p_; }

 private:
  std::shared_ptr<T> p_;
};

template <class T>
class weak_pointer {
 public:
  weak_pointer() = default;
  weak_pointer(T* p) {
    if (p != nullptr) p_ = p->weak_from_this();
  }
  std::shared_ptr<T> shared() const { return p_.lock(); }

 private:
  std::weak_ptr<T> p_;
};

// A map with weak keys, written like one with plain ones.
template <class T, class Mapped>
class weak_map {
  using content = std::map<std::weak_ptr<T>, Mapped, std::owner_less<>>;

 public:
  using const_iterator = typename content::const_iterator;
  Mapped& operator[](T* p) { return map_[p->weak_from_this()]; }
  std::size_t erase(T* p) { return map_.erase(p->weak_from_this()); }
  bool empty() const { return map_.empty(); }
  std::size_t size() const { return map_.size(); }
  const_iterator begin() const { return map_.begin(); }
  const_iterator end() const { return map_.end(); }

 private:
  content map_;
};

template <bool Weak>
struct shared_pointers : no_threads {
  static constexpr bool keeps_all = false;

  template <class T>
  using object = std::enable_shared_from_this<T>;
  template <class T, class Record>
  struct leaves_record {};
  template <class T>
  using pointer = shared_pointer<T>;
  template <class T>
  using up_pointer = std::conditional_t<Weak, weak_pointer<T>, shared_pointer<T>>;
  template <class T>
  using vector = std::vector<shared_pointer<T>>;
  template <class T>
  using frame_vector = vector<T>;
  template <class Vector>
  static void end_frame(Vector&) {}
  template <class T>
  using chosen_vector = vector<T>;
  template <class T>
  using list = std::list<shared_pointer<T>>;
  template <class T>
  using set = std::set<shared_pointer<T>, std::less<T*>>;
  template <class T, class Mapped>
  using chosen_map = std::map<shared_pointer<T>, Mapped, std::less<T*>>;
  template <class T>
  using observations =
      std::conditional_t<Weak, weak_map<T, std::size_t>, chosen_map<T, std::size_t>>;
  template <class Container>
  using registry = Container;
  template <class T, class Record>
  using reference = std::shared_ptr<T>;
  template <class T>
  using local = std::shared_ptr<T>;
  template <class T>
  using handle = std::shared_ptr<T>;

  template <class T>
  static std::shared_ptr<T> local_of(const shared_pointer<T>& p) {
    return p.shared();
  }
  template <class T>
  static std::shared_ptr<T> local_of(const weak_pointer<T>& p) {
    return p.shared();
  }
  template <class T>
  static std::shared_ptr<T> local_of(const std::weak_ptr<T>& p) {
    return p.lock();
  }
  template <class T>
  static std::shared_ptr<T> local_of(T* p) {
    return p->shared_from_this();
  }
  template <class T>
  static T* raw(const std::shared_ptr<T>& p) {
    return p.get();
  }
  template <class T>
  static T* plain(const shared_pointer<T>& p) {
    return p;
  }
  // For those who know that it is kept by others, or only compare.
  template <class T>
  static T* plain(const weak_pointer<T>& p) {
    return p.shared().get();
  }
  template <class T>
  static T* plain(const std::weak_ptr<T>& p) {
    return p.lock().get();
  }
  template <class T>
  static void assign(vector<T>& to, const std::vector<std::shared_ptr<T>>& from) {
    to.assign(from.begin(), from.end());
  }
  template <class T, class Record>
  static std::shared_ptr<T> reference_to(T* p) {
    return p != nullptr ? p->shared_from_this() : nullptr;
  }
  template <class T>
  static long id_of(const std::shared_ptr<T>& reference) {
    return reference->mnId;
  }
  template <class T>
  static std::shared_ptr<T> hold(const std::shared_ptr<T>& p) {
    return p;
  }
  template <class T>
  static void release(std::shared_ptr<T>& p) {
    p.reset();
  }
  template <class T>
  static void drop_all(std::vector<std::shared_ptr<T>>& handles) {
    handles.clear();
  }

  struct program {
    explicit program(bool /*background*/) {}
    template <class T, class... Args>
    std::shared_ptr<T> make(Args&&... args) {
      return std::make_shared<T>(std::forward<Args>(args)...);
    }
    template <class T>
    void retire(T*) {}
    void collect() {}
    void finish() {}
    template <class Described>
    struct root {
      root(program&, const char*, Described&) {}
    };
  };
  using thread = no_threads::thread_without_duty<program>;
};

struct shared_ptr_scheme : shared_pointers<false> {
  static constexpr const char* name = "shared_ptr";
};
struct shared_ptr_weak_scheme : shared_pointers<true> {
  static constexpr const char* name = "shared_ptr_weak";
};

}  // namespace replay
