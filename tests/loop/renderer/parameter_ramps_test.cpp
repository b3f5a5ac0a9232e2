// A parameter moves to a requested value at its slope, and only valid requests count.
#include "loop/renderer/live_settings.hpp"
#include "support/constants.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace wholehand::test {
namespace {

// These numbers are exact binary fractions, so nothing is rounded: 4 /s at 1024 Hz.
constexpr double kRampPeriod_s = 1.0 / 1024.0;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

ParameterRamps twoRamps() {
  return ParameterRamps({{"first", "N", 1.0, 8.0, 2.0, 4.0}, {"second", "s", -1.0, 1.0, 0.0, 0.5}});
}

TEST(ParameterRamps, RequestedValue_IsReachedAtItsSlopeAndKept) {
  ParameterRamps ramps = twoRamps();
  ramps.ask(0, 6.0);
  ramps.ask(1, -1.0);
  for (int tick = 1; tick <= 3000; ++tick) {
    ramps.advance(1, kRampPeriod_s);
    // Straight lines: 2 + 4 t up to 6 after a second, −t/2 down to −1 after two seconds.
    const double t_s = tick * kRampPeriod_s;
    ASSERT_EQ(ramps.values()[0], std::min(6.0, 2.0 + 4.0 * t_s)) << "tick " << tick;
    ASSERT_EQ(ramps.values()[1], std::max(-1.0, -0.5 * t_s)) << "tick " << tick;
  }
}

TEST(ParameterRamps, ParameterWithoutRequest_StaysAtItsStart) {
  ParameterRamps ramps = twoRamps();
  ramps.ask(0, 6.0);
  for (int tick = 0; tick < 100; ++tick) ramps.advance(1, kRampPeriod_s);
  EXPECT_EQ(ramps.values()[1], 0.0);
}

TEST(ParameterRamps, NewRequestMidway_TurnsWithoutAJump) {
  ParameterRamps ramps = twoRamps();
  ramps.ask(0, 8.0);
  ramps.advance(512, kRampPeriod_s);  // half a second: 2 + 2
  ASSERT_EQ(ramps.values()[0], 4.0);
  ramps.ask(0, 1.0);
  EXPECT_EQ(ramps.values()[0], 4.0);
  ramps.advance(1, kRampPeriod_s);
  EXPECT_EQ(ramps.values()[0], 4.0 - 4.0 / 1024.0);
}

TEST(ParameterRamps, SetValue_HoldsAtOnceAndOnlyWithinTheRange) {
  ParameterRamps ramps = twoRamps();
  ramps.ask(0, 8.0);
  ramps.set(0, 1.5);
  for (const double value : {0.999, 8.001, kNaN}) ramps.set(0, value);
  ramps.set(-1, 1.0);
  ramps.set(2, 1.0);
  ramps.advance(512, kRampPeriod_s);
  EXPECT_EQ(ramps.values()[0], 1.5);
  EXPECT_EQ(ramps.values()[1], 0.0);
}

TEST(ParameterRamps, SkippedPeriods_CountAsIfEachHadRun) {
  ParameterRamps one_by_one = twoRamps();
  ParameterRamps stalled = twoRamps();
  for (ParameterRamps* ramps : {&one_by_one, &stalled}) ramps->ask(0, 6.0);
  for (int tick = 0; tick < 7; ++tick) one_by_one.advance(1, kRampPeriod_s);
  stalled.advance(7, kRampPeriod_s);
  EXPECT_EQ(stalled.values()[0], 2.0 + 7.0 * 4.0 / 1024.0);
  EXPECT_EQ(stalled.values()[0], one_by_one.values()[0]);
  stalled.advance(1'000'000, kRampPeriod_s);  // never beyond the requested value
  EXPECT_EQ(stalled.values()[0], 6.0);
}

TEST(ParameterRamps, EndsOfTheRange_MayBeRequested) {
  ParameterRamps ramps = twoRamps();
  for (const double end : {8.0, 1.0}) {
    ramps.ask(0, end);
    ramps.advance(100'000, kRampPeriod_s);
    EXPECT_EQ(ramps.values()[0], end);
  }
}

TEST(ParameterRamps, InvalidRequest_ChangesNothing) {
  ParameterRamps ramps = twoRamps();
  ramps.ask(0, 6.0);
  for (const double value : {0.999, 8.001, -6.0, kNaN, kInfinity, -kInfinity}) ramps.ask(0, value);
  for (const int index : {-1, 2, kMaxLiveParameters, std::numeric_limits<int>::min(),
                          std::numeric_limits<int>::max()}) {
    ramps.ask(index, 0.5);
  }
  ramps.advance(100'000, kRampPeriod_s);
  EXPECT_EQ(ramps.values()[0], 6.0);  // the earlier request still holds
  EXPECT_EQ(ramps.values()[1], 0.0);
  EXPECT_EQ(ramps.values()[2], 0.0);
}

TEST(ParameterRamps, Reset_RestoresTheStartAtOnceAndDropsRequests) {
  ParameterRamps ramps = twoRamps();
  ramps.ask(0, 6.0);
  ramps.advance(100, kRampPeriod_s);
  ramps.reset();
  EXPECT_EQ(ramps.values()[0], 2.0);
  ramps.advance(100, kRampPeriod_s);
  EXPECT_EQ(ramps.values()[0], 2.0);
}

TEST(ParameterRamps, OtherStart_AppliesAfterReset) {
  ParameterRamps ramps = twoRamps();
  ramps.startAt(0, 5.0);
  for (const double value : {0.999, 8.001, kNaN, kInfinity}) ramps.startAt(0, value);
  for (const int index : {-1, 2, kMaxLiveParameters}) ramps.startAt(index, 0.5);
  EXPECT_EQ(ramps.values()[0], 2.0);  // no jump before the reset
  ramps.reset();
  EXPECT_EQ(ramps.values()[0], 5.0);
  EXPECT_EQ(ramps.values()[1], 0.0);
  EXPECT_EQ(ramps.atStart()[0], 5.0);
  ramps.advance(100, kRampPeriod_s);
  EXPECT_EQ(ramps.values()[0], 5.0);  // and it keeps this value
}

TEST(ParameterRamps, MoreParametersThanRoom_KeepsTheFirstOnesWorking) {
  std::vector<LiveParameter> many;
  for (int i = 0; i < kMaxLiveParameters + 6; ++i) {
    many.push_back({"p" + std::to_string(i), "1", 0.0, 100.0, static_cast<double>(i), 1.0});
  }
  ParameterRamps ramps(many);
  ASSERT_EQ(ramps.count(), kMaxLiveParameters);
  for (int i = 0; i < kMaxLiveParameters + 6; ++i) ramps.ask(i, 100.0);
  ramps.advance(1024, kRampPeriod_s);  // one second
  for (int i = 0; i < kMaxLiveParameters; ++i) EXPECT_EQ(ramps.values()[i], i + 1.0);
  EXPECT_EQ(ParameterRamps({}).count(), 0);
}

}  // namespace
}  // namespace wholehand::test
