#pragma once

#include "loop/core/expected.hpp"

#include <gtest/gtest.h>

#include <string>

namespace wholehand::test {

/// Whether a text has this in it; a failure shows the text.
inline testing::AssertionResult says(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "\"" << part << "\" is not in: " << text;
}

/// Whether there is no value, and the reasons have this in them.
template <class T>
testing::AssertionResult refusedWith(const Expected<T>& refused, const std::string& part) {
  if (refused) return testing::AssertionFailure() << "is not refused; expected: " << part;
  return says(format(refused.errors()), part);
}

}  // namespace wholehand::test
