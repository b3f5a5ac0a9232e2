// The safety states as clients see them: refused arming, stops, faults, and their reports.
#include "station/station_bench.hpp"

#include <fstream>

namespace wholehand::test {
namespace {

/// The bar's station with a free scene instead of an exercise.
class SafetyStates : public Bar {
 protected:
  StationConfig grasping() {
    StationConfig config = barConfig();
    config.files.exercise = kRoot + "/config/exercises/free-grasping.toml";
    return config;
  }
  void expectUntouched() {
    EXPECT_EQ(station_->status().run_state, RunState::kDisarmed);
    EXPECT_EQ(station_->status().safety_state, SafetyState::kDisarmed);
    EXPECT_EQ(station_->status().session, 0U);
    EXPECT_EQ(station_->scene()->session, 0U);
    EXPECT_EQ(station_->scene()->recording, "");
    EXPECT_EQ(records_, 0U) << kAlways;
  }
};

TEST_F(SafetyStates, RehearsalThatFails_RefusesToArmAndChangesNothing) {
  StationConfig config = grasping();
  config.rehearsal.allowed_period_share = 1e-6;  // 1 ns
  load(config);
  run(false);
  const OrderReply reply = ask(orders::Arm{});
  ASSERT_FALSE(reply.accepted);
  EXPECT_NE(reply.reason.find("rehearsal"), std::string::npos) << reply.reason;
  EXPECT_NE(reply.reason.find("most of it"), std::string::npos) << reply.reason;
  EXPECT_EQ(reply.refusal, Refusal::kRehearsalFailed);
  expectUntouched();
}

TEST_F(SafetyStates, HandInsideABody_RefusesToArmAndChangesNothing) {
  StationConfig config = grasping();
  config.rehearse = false;
  config.make_player = [](const Models& models) {
    const SceneBody& body = models.scene.bodies.front();
    AxisPosition inside(models.device.axisCount());
    for (int i = 0; i < 3; ++i) inside[i] = body.pose.translation_m[i];
    inside[0] -= 0.05;  // the centre of the palm is 5 cm ahead of its base
    return std::make_unique<ScriptedPlayer>(Intention::throughWaypoints({{0.0, inside}}));
  };
  load(config);
  run(false);
  const OrderReply reply = ask(orders::Arm{});
  ASSERT_FALSE(reply.accepted);
  EXPECT_NE(reply.reason.find("inside the hand"), std::string::npos) << reply.reason;
  EXPECT_EQ(reply.refusal, Refusal::kCannotStart);
  expectUntouched();
}

// Nothing moves after the stop, whenever it comes; an order to arm that the stop overtakes is
// refused. On a fast machine the rehearsal may end before the latest of these stops.
TEST_F(SafetyStates, EmergencyStopWhileRehearsing_RefusesToArmPromptly) {
  load(barConfig());
  run(false);
  int overtaken = 0;
  for (const auto after : {0ms, 5ms, 20ms, 60ms, 120ms}) {
    auto answer = askLater(of(orders::Arm{}));
    std::this_thread::sleep_for(after);
    ASSERT_TRUE(ask(orders::EmergencyStop{}).accepted);
    ASSERT_EQ(answer.wait_for(kHang), std::future_status::ready);
    const OrderReply reply = answer.get();
    if (!reply.accepted) {
      ++overtaken;
      EXPECT_EQ(reply.refusal, Refusal::kStopCame) << reply.reason;
    }
    ASSERT_TRUE(becomes([&] { return station_->status().run_state != RunState::kStopping; }));
    EXPECT_NE(station_->status().run_state, RunState::kRendering) << kAlways;
    expectNeutral();
  }
  EXPECT_GT(overtaken, 0);
  ASSERT_TRUE(ask(orders::Arm{}).accepted) << "when somebody wants it anew";
  EXPECT_TRUE(rendersOn());
}

TEST_F(SafetyStates, RearmingOnTheWayToNeutral_IsRefusedAndChangesNothing) {
  run(true);
  ASSERT_TRUE(rendersOn());
  ASSERT_TRUE(ask(orders::Stop{}).accepted);  // the exercise fades out first: 0.35 s
  const OrderReply reply = ask(orders::Arm{});
  ASSERT_FALSE(reply.accepted);
  EXPECT_EQ(reply.refusal, Refusal::kStillStopping) << reply.reason;
  ASSERT_TRUE(becomes(RunState::kStopped));
  EXPECT_EQ(station_->status().session, 1U);
}

// The record stream shows disarmed, armed, rendering and disarmed, and who asked for it.
TEST_F(SafetyStates, EmergencyStop_IsReportedAsEmergencyStop) {
  run(true);
  ASSERT_TRUE(becomes([&] { return station_->status().safety_state == SafetyState::kRendering; }));
  ASSERT_TRUE(ask(orders::EmergencyStop{}).accepted);
  ASSERT_TRUE(becomes(RunState::kStopped));
  EXPECT_EQ(station_->status().safety_state, SafetyState::kDisarmed);
  EXPECT_GT(station_->status().fault_ticks[11], 0U) << "Fault::kEmergencyStop";
  EXPECT_TRUE(logContains("disarmed -> armed")) << log();
  EXPECT_TRUE(logContains("armed -> rendering")) << log();
  EXPECT_TRUE(logContains("rendering -> disarmed: emergency stop at")) << log();
  const StationOutcome& outcome = quit();
  ASSERT_EQ(outcome.last->transitions.size(), 3U);
  EXPECT_EQ(outcome.last->transitions[0].tick, 0U);
  EXPECT_EQ(outcome.last->transitions[2].to, SafetyState::kDisarmed);
  EXPECT_TRUE(any(outcome.last->transitions[2].faults & Fault::kEmergencyStop));
  ASSERT_TRUE(outcome.last->rehearsal.has_value());
  EXPECT_TRUE(logContains("rehearsal"));
}

TEST_F(SafetyStates, Fault_IsReportedWithAxisAndValueAndNothingPushesUntilArmed) {
  StationConfig config = grasping();
  config.make_player = [](const Models& models) {
    return std::make_unique<FastPlayer>(models.device.axisCount());
  };
  load(config);
  run(true);
  ASSERT_TRUE(becomes(RunState::kFaulted));
  const LoopStatus status = station_->status();
  EXPECT_EQ(status.safety_state, SafetyState::kFaulted);
  EXPECT_TRUE(any(status.latched & Fault::kSpeedLimit));
  EXPECT_EQ(status.fault_axis, 0);
  EXPECT_EQ(status.fault_limit, 1.5);  // the limit in the device file
  EXPECT_GT(status.fault_value, 1.5);
  EXPECT_LT(status.fault_value, 3.0);
  EXPECT_TRUE(logContains("rendering -> faulted: speed limit exceeded on x, 1.5")) << log();
  const std::uint64_t at_rest = records_;
  std::this_thread::sleep_for(200ms);
  EXPECT_EQ(records_, at_rest) << kAlways << "nothing ticks, nothing pushes";
  expectNeutral();

  ASSERT_TRUE(ask(orders::Arm{}).accepted);
  const LoopStatus anew = station_->status();  // its first record may not have come yet
  EXPECT_EQ(anew.run_state, RunState::kRendering);
  EXPECT_EQ(anew.latched, Fault::kNone) << "what latched was the session before";
  EXPECT_EQ(anew.fault_axis, -1);
  ASSERT_TRUE(becomes([&] { return station_->status().safety_state != SafetyState::kFaulted; }));
  EXPECT_EQ(station_->status().session, 2U);
  EXPECT_TRUE(logContains("faulted -> armed")) << log();
}

// A body of 3000 boxes: the new exercise is refused, the running one continues.
TEST_F(SafetyStates, LoadOfATooHeavyScene_IsRefusedAndTheRunningOneContinues) {
  StationConfig config = grasping();
  config.config_folder = folder_ + "/config";
  fs::create_directories(config.config_folder + "/exercises");
  fs::create_directories(config.config_folder + "/hands");
  std::ofstream urdf(folder_ + "/pile.urdf");
  urdf << "<robot name=\"pile\"><link name=\"body\"><inertial><mass value=\"1\"/><inertia "
          "ixx=\"1e-3\" iyy=\"1e-3\" izz=\"1e-3\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>";
  for (int i = 0; i < 1000; ++i) {
    urdf << "<collision><origin xyz=\"0 0 " << 1e-5 * i
         << "\"/><geometry><box size=\"0.05 0.05 0.05\"/></geometry></collision>";
  }
  urdf << "</link></robot>";
  urdf.close();
  std::ofstream(folder_ + "/pile.toml")
      << "kind = \"scene\"\nversion = 1\nname = \"Pile\"\ngravity_m_s2 = [0.0, 0.0, 0.0]\n"
         "[[bodies]]\nname = \"pile\"\nshape = \"urdf\"\nfile = \"pile.urdf\"\n"
         "position_m = [0.05, 0.1, 0.0]\n";
  std::ofstream(config.config_folder + "/exercises/pile.toml")
      << "kind = \"exercise\"\nversion = 1\nexercise = \"free_grasping\"\nname = \"pile\"\n"
         "scene = \"../../pile.toml\"\n";
  config.rehearsal.allowed_period_share = 2.0;  // the bodies of free-grasping need a tenth of this
  load(config);
  run(true);
  ASSERT_TRUE(rendersOn());
  const OrderReply reply = ask(orders::LoadExercise{.exercise = "pile"});
  ASSERT_FALSE(reply.accepted);
  EXPECT_NE(reply.reason.find("\"pile\""), std::string::npos) << reply.reason;
  EXPECT_NE(reply.reason.find("fewer than 1000 shapes"), std::string::npos) << reply.reason;
  EXPECT_EQ(reply.refusal, Refusal::kRehearsalFailed);
  EXPECT_EQ(station_->scene()->exercise_name, "free-grasping");
  EXPECT_EQ(station_->status().session, 1U);
  EXPECT_TRUE(rendersOn());
}

TEST_F(SafetyStates, ImpossibleOrders_AreRefused) {
  run(true);
  ASSERT_TRUE(rendersOn());
  orders::Aim aim{AxisPosition(6)};
  aim.q[2] = std::nan("");
  EXPECT_FALSE(ask(aim).accepted);
  EXPECT_FALSE(ask(orders::SetParameter{"effort_limit_arm_n", -1.0}).accepted);
  EXPECT_EQ(station_->status().run_state, RunState::kRendering);
}

}  // namespace
}  // namespace wholehand::test
