// Damaged inputs to every fuzz target: each ends in a value or in a refusal with a remedy. With
// WHOLEHAND_FULL=1 each target gets `FuzzTarget::full` inputs, of which each may take at most a
// second of processor time.
#include "fuzz_targets.hpp"

#include "support/cpu_time.hpp"
#include "support/mutation.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace wholehand::test {
namespace {

class EveryFuzzTarget : public testing::TestWithParam<FuzzTarget> {};

TEST_P(EveryFuzzTarget, ValidInput_IsAcceptedWithoutFault) {
  ASSERT_FALSE(GetParam().good.empty());
  for (const std::string& bytes : GetParam().good) EXPECT_EQ(GetParam().enter(bytes), "");
}

TEST_P(EveryFuzzTarget, RandomDamage_IsAcceptedOrRefusedWithinASecond) {
  const FuzzTarget& target = GetParam();
  auto random = seededRandom(901);
  const bool full = fullCounts() && !WHOLEHAND_SANITIZED;
  const int count = full ? target.full : std::max(10, cases(target.sampled));
  double longest_s = 0.0;
  for (int i = 0; i < count; ++i) {
    const std::string bytes =
        mutated(target.good[static_cast<std::size_t>(i) % target.good.size()], random);
    const double before_s = cpu_s();
    ASSERT_EQ(target.enter(bytes), "") << "input " << i;
    longest_s = std::max(longest_s, cpu_s() - before_s);
  }
  if (full) {
    EXPECT_LE(longest_s, 1.0);
  }
  std::printf("figure: %s: %d inputs, at most %.3f s\n", target.name.c_str(), count, longest_s);
}

INSTANTIATE_TEST_SUITE_P(All, EveryFuzzTarget, testing::ValuesIn(allTargets()),
                         [](const auto& tested) {
                           std::string name = tested.param.name;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace wholehand::test
