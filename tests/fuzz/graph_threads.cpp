// Random programs of several threads over one graph. Between rounds nobody moves: the oracle is built anew from the members as they
// are then, and judges what drain() does.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "graph_program.hpp"

namespace {

using fuzz::kind;
using fuzz::vertex;

// Which objects exist. Nothing that a thread can see may be missing here.
class registrar final : public fuzz::observer {
 public:
  void begins(vertex& v) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (v.type != kind::board) existing_.insert(&v);
  }
  void ends(vertex& v) noexcept override {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (v.canary != vertex::intact || existing_.erase(&v) != 1) std::abort();
  }
  std::vector<vertex*> existing() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return {existing_.begin(), existing_.end()};
  }

 private:
  std::mutex mutex_;
  std::unordered_set<vertex*> existing_;
};

struct shared_world {
  registrar objects;
  slamgc::domain domain;
  std::array<std::unique_ptr<fuzz::board>, 3> boards;
  std::array<std::optional<slamgc::root>, 3> roots;

  shared_world() {
    const slamgc::mutator maker(domain, "maker");  // the registries belong to this domain
    for (std::size_t b = 0; b != boards.size(); ++b) {
      boards[b] = std::make_unique<fuzz::board>(objects);
      if (b != 2) roots[b].emplace(domain, "board", *boards[b]);
    }
  }
};

// A thread that does what its seed says.
class walker {
 public:
  walker(shared_world& world, std::uint64_t seed) : world_(world), state_(seed) {}

  void run(unsigned operations) {
    slamgc::mutator me(world_.domain, "walker");
    for (unsigned i = 0; i != operations; ++i) step(me);
    borrowed_.clear();
  }

 private:
  // Marsaglia 2003.
  unsigned random(unsigned below) {
    state_ ^= state_ << 13;
    state_ ^= state_ >> 7;
    state_ ^= state_ << 17;
    return static_cast<unsigned>(state_ >> 33) % below;
  }
  void borrow(vertex& v) {
    check(v);
    if (borrowed_.size() < 16)
      borrowed_.push_back(&v);
    else
      borrowed_[random(16)] = &v;
  }
  static void check(const vertex& v) {
    if (v.canary != vertex::intact) {
      std::fprintf(stderr, "graph_threads: a borrowed object was destroyed\n");
      std::abort();
    }
  }
  vertex& owner() {
    if (borrowed_.empty() || random(4) == 0) return *world_.boards[random(3)];
    return *borrowed_[random(static_cast<unsigned>(borrowed_.size()))];
  }
  std::size_t member(vertex& v) {
    return random(static_cast<unsigned>(fuzz::members_of(v).size()));
  }
  template <class T>
  void make() {
    borrow(*new T(world_.objects));
  }

  void step(slamgc::mutator& me) {
    const unsigned what = random(100);
    if (what < 12) {
      const unsigned type = random(16);
      if (type < 8)
        make<fuzz::keyframe>();
      else if (type < 13)
        make<fuzz::point>();
      else if (type < 14)
        make<fuzz::map>();
      else
        make<fuzz::frame>();
    } else if (what < 45) {
      link();
    } else if (what < 60) {
      unlink();
    } else if (what < 80) {
      look();
    } else if (what < 88) {
      if (!borrowed_.empty())
        fuzz::with_object(*borrowed_[random(static_cast<unsigned>(borrowed_.size()))],
                          [](auto& object) { (void)slamgc::retire(&object); });
    } else if (what < 93) {
      for (const vertex* v : borrowed_) check(*v);
      borrowed_.clear();
      me.quiescent();
    } else if (what < 94) {
      borrowed_.clear();
      const slamgc::mutator::offline_scope offline(me);
      std::this_thread::yield();
    } else if (what < 95) {
      // The board's root may be looked for cycles at any time.
      world_.roots[random(2)]->collect_cycles();
    } else {
      slamgc::budget limit;
      limit.objects = 1 + random(8);
      (void)world_.domain.collect(limit);
    }
  }
  void link() {
    vertex& from = owner();
    const std::size_t i = member(from);
    const kind wanted = fuzz::members_of(from)[i].target;
    const unsigned how = random(256);
    for (vertex* target : borrowed_) {
      if (target->type != wanted) continue;
      fuzz::with_member(from, i, [&](auto& m, const auto& companions) {
        using member_type = std::decay_t<decltype(m)>;
        using target_type = typename fuzz::traits<member_type>::target;
        fuzz::link(m, companions, static_cast<target_type*>(target), how, 1);
      });
      return;
    }
  }
  void unlink() {
    vertex& from = owner();
    const std::size_t i = member(from);
    const unsigned which = random(256);
    std::vector<fuzz::reference> content;
    fuzz::with_member(from, i, [&](auto& m, const auto& companions) {
      (void)fuzz::read(m, companions, content);
      if (content.empty()) return;
      if (which > 250)
        fuzz::clear(m, companions);
      else
        fuzz::unlink(m, companions, content[which % content.size()], which % content.size());
    });
  }
  void look() {
    vertex& from = owner();
    const std::size_t i = member(from);
    const unsigned which = random(256);
    std::vector<fuzz::reference> content;
    fuzz::with_member(from, i, [&](auto& m, const auto& companions) {
      (void)fuzz::read(m, companions, content);
    });
    if (content.empty()) return;
    if (vertex* const v = content[which % content.size()].target) borrow(*v);
  }

  shared_world& world_;
  std::uint64_t state_;
  std::vector<vertex*> borrowed_;
};

// The graph as it stands, while nobody moves.
struct snapshot {
  std::unordered_map<vertex*, unsigned> references;
  std::unordered_map<vertex*, std::vector<vertex*>> edges;

  explicit snapshot(shared_world& world) {
    std::vector<vertex*> all = world.objects.existing();
    for (vertex* v : all) references[v];
    for (auto& b : world.boards) all.push_back(b.get());
    std::vector<fuzz::reference> content;
    for (vertex* v : all)
      for (std::size_t i = 0; i != fuzz::members_of(*v).size(); ++i) {
        fuzz::with_member(*v, i,
                          [&](auto& m, const auto& how) { (void)fuzz::read(m, how, content); });
        for (const fuzz::reference& r : content) {
          if (r.target == nullptr) continue;
          edges[v].push_back(r.target);
          ++references[r.target];
        }
      }
  }
  std::unordered_set<vertex*> reached_from(std::vector<vertex*> pending) const {
    std::unordered_set<vertex*> reached(pending.begin(), pending.end());
    while (!pending.empty()) {
      const auto at = edges.find(pending.back());
      pending.pop_back();
      if (at == edges.end()) continue;
      for (vertex* v : at->second)
        if (reached.insert(v).second) pending.push_back(v);
    }
    return reached;
  }
};
struct word_of {
  bool retired = false;
  std::uint32_t count = 0;

  explicit word_of(vertex& v) {
    fuzz::with_object(v, [&](auto& object) {
      retired = object.state().is_retired();
      count = object.use_count();
    });
  }
};

// Nobody moves: all that must go is gone, the rest is as it should be.
void check(shared_world& world) {
  ASSERT_EQ(world.domain.drain(), slamgc::waited::done);
  const snapshot after(world);
  std::vector<vertex*> sources;
  for (auto& b : world.boards) sources.push_back(b.get());
  for (const auto& [v, references] : after.references) {
    const word_of word(*v);
    ASSERT_EQ(word.count, references) << name_of(v->type);
    if (!word.retired || v->type == kind::frame) sources.push_back(v);  // frames may be rings
  }
  const auto reached = after.reached_from(sources);
  for (const auto& [v, references] : after.references)
    ASSERT_TRUE(reached.count(v) == 1) << name_of(v->type) << " was retired and is out of reach";
}

TEST(GraphThreads, RandomProgramsAgreeWithReachability) {
  const char* const wish = std::getenv("SLAMGC_STRESS_ROUNDS");
  const long rounds = wish != nullptr ? std::max(1L, std::atol(wish) / 10) : 100;
  const char* const replay = std::getenv("SLAMGC_SEED");
  const std::uint64_t seed = replay != nullptr ? std::strtoull(replay, nullptr, 0) : 1;
  std::printf("SLAMGC_SEED=%llu\n", static_cast<unsigned long long>(seed));
  for (long round = 0; round != rounds && !HasFatalFailure(); ++round) {
    shared_world world;
    for (int part = 0; part != 4 && !HasFatalFailure(); ++part) {
      std::vector<std::thread> threads;
      for (unsigned t = 0; t != 3; ++t)
        threads.emplace_back([&world, seed, round, part, t] {
          walker(world, seed * 1000003 + static_cast<std::uint64_t>(round * 64 + part * 8) + t + 1)
              .run(800);
        });
      for (std::thread& t : threads) t.join();
      check(world);
    }
    // The end: nothing is left but what nobody retired, and that is retired now.
    for (auto& b : world.boards)
      for (std::size_t i = 0; i != fuzz::members_of(*b).size(); ++i)
        fuzz::with_member(*b, i, [](auto& m, const auto& how) { fuzz::clear(m, how); });
    ASSERT_EQ(world.domain.drain(), slamgc::waited::done);
    {
      const slamgc::mutator me(world.domain, "end");
      for (vertex* v : world.objects.existing()) {
        if (v->type == kind::frame)
          fuzz::with_member(*v, 2, [](auto& m, const auto& how) { fuzz::clear(m, how); });
        fuzz::with_object(*v, [](auto& object) { (void)slamgc::retire(&object); });
      }
    }
    ASSERT_EQ(world.domain.drain(), slamgc::waited::done);
    ASSERT_TRUE(world.objects.existing().empty());
    for (auto& root : world.roots) root.reset();
  }
}

}  // namespace
