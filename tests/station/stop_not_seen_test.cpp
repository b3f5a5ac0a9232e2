// An order to arm names the ending that its person was shown: after a later one it starts nothing.
#include "station/station_bench.hpp"

namespace wholehand::test {
namespace {

class StopNotSeen : public Bar {
 protected:
  std::uint32_t endings() { return station_->status().endings; }
  static Order arm(std::uint32_t seen) { return {orders::Arm{seen}}; }
  static Order load(int level) { return {orders::LoadExercise{.level = level}}; }
};

TEST_F(StopNotSeen, ArmThatNamesNone_IsRefusedWithTheRemedy) {
  run(false);
  const OrderReply reply = ask(arm(0));
  EXPECT_FALSE(reply.accepted);
  EXPECT_EQ(reply.refusal, Refusal::kOtherVersion);
  EXPECT_NE(reply.reason.find("Arm.endings_seen"), std::string::npos) << reply.reason;
  EXPECT_EQ(station_->status().run_state, RunState::kDisarmed);
  EXPECT_EQ(endings(), 1U) << "nothing has ended";
  EXPECT_TRUE(ask(arm(1)).accepted);
}

// A person presses Stop before anything renders: the robot is about to start.
TEST_F(StopNotSeen, StopWhileNothingRenders_IsShownAndUndoesWhatWasPressedBefore) {
  for (const orders::Any& stop : kStops) {
    if (!thread_.joinable()) run(false);
    const std::uint32_t shown = endings();
    ASSERT_TRUE(ask(stop).accepted);
    EXPECT_EQ(station_->status().run_state, RunState::kStopped);
    EXPECT_EQ(endings(), shown + 1);
    const OrderReply reply = ask(arm(shown));
    EXPECT_FALSE(reply.accepted);
    EXPECT_EQ(reply.refusal, Refusal::kStopNotSeen);
    EXPECT_NE(reply.reason, "");
  }
  EXPECT_EQ(records_, 0U) << kAlways;
  EXPECT_TRUE(ask(orders::Arm{}).accepted) << "who has seen it may arm";
  EXPECT_TRUE(rendersOn());
}

// The game's Start with another level: load, stop, and only then the arm of that press.
TEST_F(StopNotSeen, StopBetweenLoadAndArmOfOnePress_StartsNothing) {
  run(false);
  const std::uint32_t shown = endings();
  auto loaded = askLater(load(2));
  ASSERT_TRUE(ask(orders::EmergencyStop{}).accepted);
  ASSERT_TRUE(loaded.get().accepted);
  EXPECT_EQ(ask(arm(shown)).refusal, Refusal::kStopNotSeen);
  staysAt(RunState::kStopped);
  EXPECT_EQ(records_, 0U) << kAlways;
}

TEST_F(StopNotSeen, ArmAtEachStop_NamesAnEndingBeforeItAndIsRefused) {
  run(true);
  ASSERT_TRUE(rendersOn());
  const std::uint32_t shown = endings();
  ASSERT_TRUE(ask(orders::EmergencyStop{}).accepted);
  // Until it is at neutral, and then: 237 ms after the stop a click has started the next session.
  for (int i = 0; i < 100; ++i) {
    EXPECT_FALSE(ask(arm(shown)).accepted) << kAlways;
    std::this_thread::sleep_for(5ms);
  }
  staysAt(RunState::kStopped);
  EXPECT_EQ(station_->status().session, 1U);
}

TEST_F(StopNotSeen, LoadThatGoesOn_IsNoEndingAndStopDuringItIs) {
  run(true);
  ASSERT_TRUE(rendersOn());
  const std::uint32_t shown = endings();
  ASSERT_TRUE(ask(load(2)).accepted);
  EXPECT_EQ(endings(), shown);
  EXPECT_EQ(station_->status().session, 2U);
  ASSERT_TRUE(rendersOn());
  auto loaded = askLater(load(1));
  ASSERT_TRUE(ask(orders::Stop{}).accepted);
  (void)loaded.get();
  EXPECT_GT(endings(), shown);
  EXPECT_EQ(ask(arm(shown)).refusal, Refusal::kStopNotSeen);
  staysAt(RunState::kStopped);
}

// The station's thread is busy when what renders faults; a load ends that session, and behind it
// waits an order to arm that was pressed before the fault.
TEST_F(StopNotSeen, FaultWhileAnArmWaits_UndoesIt) {
  StationConfig config = barConfig();
  config.files.exercise = kRoot + "/config/exercises/free-grasping.toml";
  std::promise<void> faulted;
  std::shared_future<void> released = faulted.get_future().share();
  const auto busy = std::make_shared<std::atomic<bool>>(false);
  const auto may = std::make_shared<std::atomic<bool>>(false);
  config.now = [] { return Clock::time_point(); };  // it waits for no time at all
  config.make_player = [may](const Models& models) {
    return std::make_unique<Startled>(models.device.axisCount(), may);
  };
  config.status = [released, busy](RunState, const TickSummary&) {
    *busy = true;
    released.wait();
  };
  Bar::load(config);
  run(true);
  const std::uint32_t shown = endings();
  ASSERT_TRUE(becomes([&] { return busy->load(); }));
  ASSERT_EQ(station_->status().run_state, RunState::kRendering);
  auto loaded = askLater(load(1));
  auto armed = askLater(arm(shown));
  *may = true;
  EXPECT_TRUE(becomes([&] { return any(station_->status().latched & Fault::kSpeedLimit); }));
  faulted.set_value();
  EXPECT_TRUE(loaded.get().accepted);
  const OrderReply reply = armed.get();
  EXPECT_FALSE(reply.accepted);
  EXPECT_EQ(reply.refusal, Refusal::kStopNotSeen) << reply.reason;
  EXPECT_EQ(station_->status().run_state, RunState::kFaulted);
  EXPECT_EQ(station_->status().session, 1U);
}

}  // namespace
}  // namespace wholehand::test
