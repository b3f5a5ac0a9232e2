// The loop as clients see it: armed, commanded, stopped, reloaded and recorded. In real time.
#include "record/recording.hpp"
#include "station/station_bench.hpp"

#include <set>

namespace wholehand::test {
namespace {

TEST_F(Bar, ArmStopArm_NothingPushesInBetween) {
  run(false);
  EXPECT_EQ(station_->status().run_state, RunState::kDisarmed);
  std::this_thread::sleep_for(50ms);
  EXPECT_EQ(records_, 0U);

  ASSERT_TRUE(ask(orders::Arm{}).accepted);
  ASSERT_TRUE(squeezes());
  EXPECT_EQ(station_->status().run_state, RunState::kRendering);
  const OrderReply twice = ask(orders::Arm{});
  EXPECT_FALSE(twice.accepted);
  EXPECT_NE(twice.reason, "");
  EXPECT_EQ(twice.refusal, Refusal::kArmedAlready);

  ASSERT_TRUE(ask(orders::Stop{}).accepted);
  ASSERT_TRUE(becomes(RunState::kStopped));
  TickRecord record;
  ASSERT_TRUE(station_->latest(record));
  EXPECT_EQ(largest(record.sent), 0.0) << kAlways;  // the neutral effort of this device
  EXPECT_EQ(record.authority, 0.0) << kAlways;
  const std::uint64_t at_rest = records_;
  std::this_thread::sleep_for(100ms);
  EXPECT_EQ(records_, at_rest) << kAlways;

  EXPECT_EQ(station_->scene()->session, 1U);
  ASSERT_TRUE(ask(orders::Arm{}).accepted);
  EXPECT_EQ(station_->scene()->session, 2U);
  EXPECT_TRUE(rendersOn());
}

TEST_F(Bar, EmergencyStop_IsAtNeutralWithinItsRamp) {
  run(true);
  ASSERT_TRUE(squeezes());
  ASSERT_TRUE(ask(orders::EmergencyStop{}).accepted);
  const std::uint64_t asked_at = last_;
  ASSERT_TRUE(becomes(RunState::kStopped));
  // The ramp takes 80 ms; the rest is the time that the stop waited in the queue.
  EXPECT_LE(last_ - asked_at, 80U + 60U);
  expectNeutral();
}

TEST_F(Bar, Parameter_RampsOrIsRefusedWithItsRange) {
  run(true);
  ASSERT_TRUE(rendersOn());
  orders::SetParameter order{"effort_limit_arm_n", 8.0};
  ASSERT_TRUE(ask(order).accepted);
  const auto index = [&] {
    const auto scene = station_->scene();
    const auto& all = scene->parameters;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all[i].name == order.name) return i;
    }
    return all.size();
  }();
  ASSERT_LT(index, station_->scene()->parameters.size());
  // It falls from 20 N, the device's limit, by 18 N/s: the whole range, 2 to 20 N, in 1 s.
  EXPECT_TRUE(becomes([&] { return station_->status().parameters[index] == 8.0; }));
  TickRecord record;
  ASSERT_TRUE(station_->latest(record));
  EXPECT_EQ(record.effort_limit[0], 8.0);

  order.value = 25.0;
  const OrderReply above = ask(order);
  EXPECT_FALSE(above.accepted);
  EXPECT_NE(above.reason.find("2 to 20 N"), std::string::npos) << above.reason;
  EXPECT_EQ(above.refusal, Refusal::kOutOfRange);
  order.value = std::nan("");
  EXPECT_FALSE(ask(order).accepted);
  order.name = "effort_limit";
  EXPECT_EQ(ask(order).refusal, Refusal::kUnknownParameter);
  std::this_thread::sleep_for(50ms);
  EXPECT_EQ(station_->status().parameters[index], 8.0);
}

TEST_F(Bar, AimOfAPerson_IsFollowedByTheDevice) {
  run(true);
  ASSERT_TRUE(rendersOn());
  ASSERT_TRUE(ask(orders::Steer{Steering::kPerson}).accepted);
  TickRecord record;
  ASSERT_TRUE(station_->latest(record));
  orders::Aim aim{record.q_m, Help::kSome};
  aim.q[0] = -0.06;  // drawn back, where no body is in the way
  aim.q[2] = 0.03;
  ASSERT_TRUE(ask(aim).accepted);
  EXPECT_TRUE(becomes([&] {
    return station_->latest(record) && std::abs(record.q_m[0] + 0.06) < 0.005 &&
           std::abs(record.q_m[2] - 0.03) < 0.005;
  })) << record.q_m[0]
      << " " << record.q_m[2];
  EXPECT_EQ(record.moved_by, Mover::kPerson);
  EXPECT_EQ(record.help, Help::kSome);
  aim.q[1] = 1e9;
  const OrderReply far = ask(aim);
  EXPECT_EQ(far.refusal, Refusal::kNotAPosture);
  EXPECT_TRUE(far.reason.find("y = 1e+09 m: is far beyond the range") != std::string::npos)
      << far.reason;
  aim.q = AxisPosition(2);
  EXPECT_FALSE(ask(aim).accepted);
}

TEST_F(Bar, LoadWhileRendering_ContinuesWithTheNewLevel) {
  run(true);
  ASSERT_TRUE(rendersOn());
  orders::LoadExercise order{.exercise = "no-such-exercise"};
  EXPECT_FALSE(ask(order).accepted);
  order.exercise = "../cocktail-bar";
  EXPECT_FALSE(ask(order).accepted);
  order.exercise = "cocktail-bar";
  order.level = 999;
  EXPECT_FALSE(ask(order).accepted);
  order.level = 1;
  order.hand = "no-such-hand";
  EXPECT_EQ(ask(order).refusal, Refusal::kUnknownHand);
  EXPECT_EQ(station_->status().run_state, RunState::kRendering);
  EXPECT_EQ(station_->status().session, 1U);
  EXPECT_TRUE(rendersOn());

  order.hand = "woman-p05-right";
  order.level = 2;
  const OrderReply loaded = ask(order);
  ASSERT_TRUE(loaded.accepted) << loaded.reason;
  EXPECT_EQ(station_->scene()->level, 2);
  EXPECT_EQ(station_->scene()->hand.name, "woman-p05-right");
  EXPECT_EQ(station_->status().session, 2U);
  EXPECT_TRUE(rendersOn());
}

TEST_F(Bar, SessionsThatClientsArm_AreRecordedAndListed) {
  run(false);
  ASSERT_TRUE(ask(orders::Arm{}).accepted);
  ASSERT_TRUE(rendersOn());
  const std::string name = station_->scene()->recording;
  ASSERT_NE(name, "");
  ASSERT_EQ(station_->recordings().size(), 1U);
  EXPECT_EQ(station_->recordings().front().name, name);
  EXPECT_TRUE(station_->recordings().front().being_written);
  std::string why;
  EXPECT_EQ(station_->reportFolder(name, why), "");
  EXPECT_EQ(why, "it is still being recorded");
  ASSERT_TRUE(ask(orders::Stop{}).accepted);
  ASSERT_TRUE(becomes(RunState::kStopped));
  ASSERT_TRUE(becomes([&] { return !station_->recordings().front().being_written; }));
  const RecordingEntry entry = station_->recordings().front();
  EXPECT_EQ(entry.name, name);
  EXPECT_GT(entry.bytes, 1000U);
  EXPECT_GT(entry.duration_s, 0.4);  // 100 ticks plus the fade of 0.35 s
  auto recording = RecordingReader::open(station_->recordingPath(name));
  ASSERT_TRUE(recording) << format(recording.errors());
  EXPECT_EQ((*recording)->meta().exercise, "cocktail-bar");
  EXPECT_NEAR(static_cast<double>((*recording)->size()) * 1e-3, entry.duration_s, 0.3);
  fs::create_symlink("/etc/passwd", folder_ + "/recordings/link.h5");
  EXPECT_EQ(station_->recordings().size(), 1U) << "what cannot be had is not shown";
  EXPECT_EQ(station_->recordingPath("link.h5"), "");
  for (const char* bad : {"", ".", "..", "../x.h5", "/etc/passwd", "a/b.h5", "note.json"}) {
    EXPECT_EQ(station_->recordingPath(bad), "") << bad;
  }
}

TEST_F(Bar, SilentHolder_FadesOnlyTheExercise) {
  run(true);
  ASSERT_TRUE(squeezes());
  TickRecord record;
  ASSERT_TRUE(station_->latest(record));
  const std::uint64_t asked_at = record.tick;
  ASSERT_TRUE(ask(orders::HolderAlive{false}).accepted);
  ASSERT_TRUE(becomes([&] { return station_->latest(record) && record.exercise.alpha == 0.0; }));
  EXPECT_LE(record.tick - asked_at, 300U + 60U);  // T_off plus the time that the order waited
  EXPECT_EQ(largest(record.exercise.effort), 0.0);
  EXPECT_EQ(station_->status().run_state, RunState::kRendering);
  EXPECT_TRUE(rendersOn());
}

TEST_F(Bar, StopWhileArming_NothingPushes) {
  for (const orders::Any& stop : kStops) {
    if (!thread_.joinable()) run(false);
    auto answer = askLater(of(orders::Arm{}));
    std::this_thread::sleep_for(30ms);
    ASSERT_TRUE(ask(stop).accepted);
    EXPECT_FALSE(answer.get().accepted) << kAlways << "the person must hear that nothing was armed";
    std::this_thread::sleep_for(1500ms);
    EXPECT_NE(station_->status().run_state, RunState::kRendering) << kAlways;
    expectNeutral();
  }
  ASSERT_TRUE(ask(orders::Arm{}).accepted);  // a client arms again
  EXPECT_TRUE(rendersOn());
}

// After a stop during the building of the world, the station shows "stopped" at once and no other
// state after it.
TEST_F(Bar, StopWhileArming_IsShownAtOnceAndKept) {
  run(false);
  for (const orders::Any& stop : kStops) {
    const std::uint32_t session = station_->status().session;
    auto answer = askLater(of(orders::Arm{}));
    ASSERT_TRUE(becomes([&] { return station_->status().session > session; })) << "being built";
    ASSERT_TRUE(ask(stop).accepted);
    std::set<RunState> shown;
    while (answer.wait_for(1ms) != std::future_status::ready) {
      shown.insert(station_->status().run_state);
    }
    EXPECT_EQ(answer.get().refusal, Refusal::kStopCame);
    for (int i = 0; i < 300; ++i, std::this_thread::sleep_for(1ms)) {
      shown.insert(station_->status().run_state);
    }
    EXPECT_EQ(shown, std::set<RunState>{RunState::kStopped}) << kAlways;
    EXPECT_TRUE(fs::is_empty(folder_ + "/recordings")) << "nothing was recorded";
  }
  ASSERT_TRUE(ask(orders::Arm{}).accepted);
  EXPECT_TRUE(rendersOn());
}

TEST_F(Bar, LoadAfterAStop_StaysStopped) {
  run(true);
  ASSERT_TRUE(rendersOn());
  ASSERT_TRUE(ask(orders::Stop{}).accepted);
  later(kLoadLevel2);  // during the fade
  staysAt(RunState::kStopped);
  EXPECT_EQ(station_->scene()->level, 2);
}

TEST_F(Bar, EmergencyStopWhileLoading_StaysStopped) {
  run(true);
  ASSERT_TRUE(rendersOn());
  later(kLoadLevel2);
  ASSERT_TRUE(ask(orders::EmergencyStop{}).accepted);
  staysAt(RunState::kStopped);
  later(kLoadLevel2);  // picking a level does not arm
  staysAt(RunState::kStopped);
}

TEST_F(Bar, EmergencyStopThenArmDuringItsRamp_RendersOnlyInANewSession) {
  run(true);
  ASSERT_TRUE(rendersOn());
  later(orders::EmergencyStop{});
  later(orders::Arm{});  // during the ramp: refused, or armed on purpose
  ASSERT_TRUE(becomes([&] { return station_->status().run_state != RunState::kStopping; }));
  if (station_->status().run_state != RunState::kStopped) return;
  later(kLoadLevel2);
  staysAt(RunState::kStopped);
}

TEST_F(Bar, LimitSetWhileDisarmed_AppliesFromTheFirstTick) {
  run(false);
  ASSERT_TRUE(ask(orders::SetParameter{"effort_limit_arm_n", 4.0}).accepted)
      << "also before anything is armed";
  ASSERT_TRUE(ask(orders::Arm{}).accepted);
  TickRecord record;
  ASSERT_TRUE(becomes([&] { return station_->latest(record); }));
  EXPECT_EQ(record.effort_limit[0], 4.0);
  later(kLoadLevel2);
  ASSERT_TRUE(becomes([&] { return station_->status().session == 2U; }));
  ASSERT_TRUE(becomes([&] { return station_->latest(record); }));
  EXPECT_EQ(record.effort_limit[0], 4.0);
  EXPECT_EQ(station_->status().parameters.size(), station_->scene()->parameters.size());
}

}  // namespace
}  // namespace wholehand::test
