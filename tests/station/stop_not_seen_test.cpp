// An order to arm names the newest ending that its person was shown; after a later ending it is
// refused.
#include "station/station_bench.hpp"

namespace wholehand::test {
namespace {

class StopNotSeen : public Bar {
 protected:
  std::uint32_t endings() { return station_->status().endings; }
  Order arm(std::uint32_t seen) { return {orders::Arm{seen, station_->status().basis}}; }
  static Order load(int level) { return {orders::LoadExercise{.level = level}}; }
};

TEST_F(StopNotSeen, ArmThatNamesNoEnding_IsRefusedAndTheAnswerSaysWhatToDo) {
  run(false);
  const OrderReply reply = ask(arm(0));
  EXPECT_FALSE(reply.accepted);
  EXPECT_EQ(reply.refusal, Refusal::kOtherVersion);
  EXPECT_NE(reply.reason.find("Arm.endings_seen"), std::string::npos) << reply.reason;
  EXPECT_EQ(station_->status().run_state, RunState::kDisarmed);
  EXPECT_EQ(endings(), 1U) << "nothing has ended";
  EXPECT_TRUE(ask(arm(1)).accepted);
}

// A person presses Stop before anything renders, because the robot is about to start.
TEST_F(StopNotSeen, StopWhileNothingRenders_IsShownAndRefusesEarlierArms) {
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

// The game's Start with another level sends a load and an arm; a stop comes between them.
TEST_F(StopNotSeen, StopBetweenTheLoadAndTheArmOfOnePress_RefusesTheArm) {
  run(false);
  const std::uint32_t shown = endings();
  auto loaded = askLater(load(2));
  ASSERT_TRUE(ask(orders::EmergencyStop{}).accepted);
  ASSERT_TRUE(loaded.get().accepted);
  EXPECT_EQ(ask(arm(shown)).refusal, Refusal::kStopNotSeen);
  staysAt(RunState::kStopped);
  EXPECT_EQ(records_, 0U) << kAlways;
}

TEST_F(StopNotSeen, ArmsAfterAStopThatNameAnEarlierEnding_AreRefused) {
  run(true);
  ASSERT_TRUE(rendersOn());
  const std::uint32_t shown = endings();
  ASSERT_TRUE(ask(orders::EmergencyStop{}).accepted);
  // Checks during the ramp to neutral and after it. Before this rule, a click started a session 237
  // ms after the stop.
  for (int i = 0; i < 100; ++i) {
    EXPECT_FALSE(ask(arm(shown)).accepted) << kAlways;
    std::this_thread::sleep_for(5ms);
  }
  staysAt(RunState::kStopped);
  EXPECT_EQ(station_->status().session, 1U);
}

TEST_F(StopNotSeen, LoadWhileRendering_IsNoEndingButAStopDuringItIs) {
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

// The station's thread is busy while the running session faults. A load waits, and behind it an
// order to arm from before the fault.
TEST_F(StopNotSeen, FaultWhileAnArmWaits_RefusesTheArm) {
  StationConfig config = barConfig();
  config.files.exercise = kRoot + "/config/exercises/free-grasping.toml";
  std::promise<void> faulted;
  std::shared_future<void> released = faulted.get_future().share();
  const auto busy = std::make_shared<std::atomic<bool>>(false);
  const auto may = std::make_shared<std::atomic<bool>>(false);
  config.now = [] { return Clock::time_point(); };  // no time passes
  config.make_player = [may](const Models& models) {
    return std::make_unique<FastPlayer>(models.device.axisCount(), may);
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
