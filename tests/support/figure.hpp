#pragma once

#include "loop/core/expected.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <utility>

/// Helpers for any test.
namespace wholehand::test {

/// Prints "figure: <name> = <value> <unit>" and keeps it in the test's report.
inline void figure(const std::string& name, double value, const char* unit) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.4g %s", value, unit);
  std::printf("figure: %s = %s\n", name.c_str(), text.data());
  ::testing::Test::RecordProperty(name, text.data());
}

/// The value, or an exception with every reason why there is none.
template <class T>
T orThrow(Expected<T> expected) {
  if (!expected) throw std::runtime_error(format(expected.errors()));
  return std::move(expected).value();
}

}  // namespace wholehand::test
