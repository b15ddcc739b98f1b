// Stress tests run as the library ships, and with a yield or a stall before each atomic operation.
#pragma once

#include <gtest/gtest.h>

#include <slamgc/env.hpp>
#include <string>
#include <type_traits>

#include "support/yield_env.hpp"

namespace support {

using environments = ::testing::Types<slamgc::std_env, yield_env>;

struct environment_names {
  template <class Env>
  static std::string GetName(int) {
    return std::is_same<Env, yield_env>::value ? "yield_env" : "std_env";
  }
};

}  // namespace support
