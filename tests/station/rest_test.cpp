// A rest: a gentle stop that says of itself that nothing else has ended.
#include "station/station_bench.hpp"

namespace wholehand::test {
namespace {

class RestOfAPlayer : public Bar {
 protected:
  Order rest() const {
    Order order = of(OrderType::kStop);
    order.rest = true;
    return order;
  }
  bool rested() { return station_->status().rested; }
};

TEST_F(RestOfAPlayer, OfWhatRenders_IsOneUntilItIsArmedAgain) {
  run(true);
  ASSERT_TRUE(rendersOn());
  EXPECT_FALSE(rested());
  ASSERT_TRUE(ask(rest()).accepted);
  staysAt(RunState::kStopped);
  EXPECT_TRUE(rested()) << "the end of the session belongs to it";
  ASSERT_TRUE(ask(rest()).accepted);
  EXPECT_TRUE(rested()) << "pressed twice";
  ASSERT_TRUE(ask(OrderType::kArm).accepted);
  ASSERT_TRUE(rendersOn());
  EXPECT_FALSE(rested());
}

TEST_F(RestOfAPlayer, FollowedByAStop_IsNoneAnyMore) {
  for (const OrderType stop : {OrderType::kStop, OrderType::kEmergencyStop}) {
    if (!thread_.joinable()) run(true);
    ASSERT_TRUE(rendersOn());
    ASSERT_TRUE(ask(rest()).accepted);
    ASSERT_TRUE(ask(stop).accepted);
    EXPECT_FALSE(rested());
    staysAt(RunState::kStopped);
    EXPECT_FALSE(rested());
    ASSERT_TRUE(ask(rest()).accepted);
    EXPECT_FALSE(rested()) << "a rest that comes after a stop does not undo it";
    ASSERT_TRUE(ask(OrderType::kArm).accepted);
  }
}

TEST_F(RestOfAPlayer, WhileNothingWasEverArmed_IsAStop) {
  run(false);
  ASSERT_TRUE(ask(rest()).accepted);
  EXPECT_EQ(station_->status().run_state, RunState::kStopped);
  EXPECT_FALSE(rested());
}

// The console shows the limit that the next session begins with, not the last one's.
TEST_F(RestOfAPlayer, LimitSetMeanwhile_IsShownAndHoldsInTheNextSession) {
  run(true);
  ASSERT_TRUE(rendersOn());
  ASSERT_TRUE(ask(rest()).accepted);
  ASSERT_TRUE(becomes([&] { return station_->status().run_state == RunState::kStopped; }));
  Order limit = of(OrderType::kSetParameter);
  limit.name = station_->scene()->parameters.front().name;
  limit.value = station_->scene()->parameters.front().lower;
  ASSERT_TRUE(ask(limit).accepted);
  EXPECT_EQ(station_->status().parameters.front(), limit.value);
  ASSERT_TRUE(ask(OrderType::kArm).accepted);
  ASSERT_TRUE(rendersOn());
  EXPECT_EQ(station_->status().parameters.front(), limit.value);
}

class RestInALevel : public RestOfAPlayer {
 protected:
  double value(const std::string& name) {
    const auto scene = station_->scene();
    const auto& names = scene->value_names;
    const auto found = std::find(names.begin(), names.end(), name);
    TickRecord record;
    if (found == names.end() || !station_->latest(record)) return std::nan("");
    return record.exercise.values[found - names.begin()];
  }
  /// Level 2 has two drinks; the virtual patient is in its second one.
  void playToTheSecondDrink() {
    StationConfig config = barConfig();
    config.files.level = 2;
    load(config);
    run(true);
    ASSERT_TRUE(becomes([&] { return value("drink") == 1.0; }, 180s));
  }
};

TEST_F(RestInALevel, ArmedAgain_GoesOnWithTheDrinkThatWasBegun) {
  playToTheSecondDrink();
  ASSERT_TRUE(ask(rest()).accepted);
  ASSERT_TRUE(becomes(RunState::kStopped));
  ASSERT_TRUE(ask(OrderType::kArm).accepted);
  ASSERT_TRUE(rendersOn());
  EXPECT_EQ(value("drink"), 1.0);
  EXPECT_EQ(value("step"), 0.0);
  ASSERT_TRUE(ask(OrderType::kStop).accepted);
  ASSERT_TRUE(becomes(RunState::kStopped));
  ASSERT_TRUE(ask(OrderType::kArm).accepted);
  ASSERT_TRUE(rendersOn());
  EXPECT_EQ(value("drink"), 0.0) << "after a stop a level begins at its start";
}

}  // namespace
}  // namespace wholehand::test
