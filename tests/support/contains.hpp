#pragma once

#include "loop/core/expected.hpp"

#include <gtest/gtest.h>

#include <string>

namespace wholehand::test {

/// Checks that a text contains this part; a failure shows the text.
inline testing::AssertionResult contains(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "\"" << part << "\" is not in: " << text;
}

/// Checks that there is no value and that the reasons contain this part.
template <class T>
testing::AssertionResult refusedWith(const Expected<T>& refused, const std::string& part) {
  if (refused) return testing::AssertionFailure() << "is not refused; expected: " << part;
  return contains(format(refused.errors()), part);
}

}  // namespace wholehand::test
