// What is left when a domain ends: objects, mutators, references.
#include <slamgc/domain.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <slamgc/slamgc.hpp>
#include <string>
#include <thread>

#include "support/instances.hpp"

namespace {

using slamgc::domain;
using slamgc::intrusive_rc;
using slamgc::make_rc;
using slamgc::mutator;

struct left_type
    : slamgc::rc_object<left_type, slamgc::fetch_add_counter, slamgc::reclaim_deferred>,
      support::instances<left_type> {
  explicit left_type(int v) : value(v) {}
  int value;
  slamgc::rc_slot<left_type> next;
};
struct other_left_type
    : slamgc::rc_object<other_left_type, slamgc::fetch_add_counter, slamgc::reclaim_retired> {};

// Whoever refers to an object keeps what stays behind from being a leak: the state of its domain, which
// the object names.
const void* reachable[8];

class DomainEnd : public ::testing::Test {
 protected:
  DomainEnd() : domain_(std::make_unique<domain>()) {}

  // Ends the domain and returns what it prints.
  std::string end() {
    ::testing::internal::CaptureStderr();
    domain_.reset();
    return ::testing::internal::GetCapturedStderr();
  }
  void keep_reachable() {
    static int n = 0;
    reachable[n++] = &slamgc::detail::domain_access::state_of(*domain_);
  }

  std::unique_ptr<domain> domain_;
};

TEST_F(DomainEnd, ReclaimsWhatNobodyCanSee) {
  {
    const mutator m(*domain_, "m");
    auto head = make_rc<left_type>(0);
    head->next = new left_type(1);
    slamgc::retire(new left_type(2));
  }
  EXPECT_EQ(end(), "");
  EXPECT_EQ(left_type::live(), 0);
}

TEST_F(DomainEnd, OneThatWasInTheMiddleOfACollectionEndsIt) {
  {
    const mutator m(*domain_, "m");
    for (int i = 0; i != 100; ++i) slamgc::retire(new left_type(i));
  }
  (void)domain_->collect(slamgc::budget{130});
  EXPECT_EQ(left_type::live(), 70);
  EXPECT_EQ(end(), "");
  EXPECT_EQ(left_type::live(), 0);
}

TEST_F(DomainEnd, ObjectsThatAreLeftAreNamedAndStayUsable) {
  intrusive_rc<left_type> a;
  other_left_type* b = nullptr;
  {
    const mutator m(*domain_, "m");
    a = make_rc<left_type>(1);
    a->next = new left_type(2);
    b = new other_left_type;
  }
  keep_reachable();
  const std::string said = end();
  EXPECT_NE(said.find("slamgc: a domain ends while 2 objects of type "), std::string::npos) << said;
  EXPECT_NE(said.find("left_type exist\n"), std::string::npos) << said;
  EXPECT_NE(said.find("a domain ends while 1 objects of type "), std::string::npos) << said;
  EXPECT_NE(said.find("other_left_type exist\n"), std::string::npos) << said;
  EXPECT_EQ(a->value + a->next->value, 3);
  left_type* const rest = a->next;
  const auto copy = a;
  a.reset();
  EXPECT_EQ(copy->use_count(), 1u);
  copy->next = nullptr;  // it waits for ever
  EXPECT_TRUE(rest->state().is_queued());
  EXPECT_EQ(rest->value, 2);
  delete b;
}

TEST_F(DomainEnd, ALaterReleaseDoesNotCrash) {
  intrusive_rc<left_type> p;
  {
    const mutator m(*domain_, "m");
    p = make_rc<left_type>(1);
  }
  keep_reachable();
  EXPECT_NE(end(), "");
  const int before = left_type::live();
  std::thread([&] {
    domain other;
    const mutator m(other, "of another domain");
    p.reset();
    slamgc::retire(new left_type(2));
  }).join();
  EXPECT_EQ(left_type::live(), before);
}

TEST_F(DomainEnd, AMutatorMayOutliveIt) {
  mutator m(*domain_, "m");
  EXPECT_EQ(end(), "");
  m.quiescent();
  const mutator::offline_scope offline(m);
  const mutator::online_scope online(m);
  left_type* const n = new left_type(1);  // still of that domain, whose tables exist
  delete n;
}

TEST_F(DomainEnd, AMutatorMayEndOnAnotherThreadLater) {
  std::atomic<bool> online{false};
  std::atomic<bool> ended{false};
  std::thread tracking([&] {
    mutator m(*domain_, "m");
    online = true;
    while (!ended) std::this_thread::yield();
    m.quiescent();
    delete new left_type(1);
  });
  while (!online) std::this_thread::yield();
  EXPECT_EQ(end(), "");
  ended = true;
  tracking.join();
}

TEST_F(DomainEnd, WhatAnOnlineMutatorMaySeeStays) {
  left_type* seen = nullptr;
  {
    const mutator m(*domain_, "m");
    seen = new left_type(7);
    slamgc::retire(seen);
    keep_reachable();
    EXPECT_NE(end(), "");
    EXPECT_EQ(seen->value, 7);
  }
  EXPECT_EQ(seen->value, 7);
}

}  // namespace
