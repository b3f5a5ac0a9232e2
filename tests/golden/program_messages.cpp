#include "golden/program_messages.hpp"

#include "support/crank_hand.hpp"

#include <memory>
#include <span>

namespace wholehand::golden {

namespace {

SceneFacts smallScene() {
  SceneFacts facts;
  facts.session = 3;
  facts.program_version = "9.8.7";
  facts.hand = test::crankHand();
  facts.patient_name = "Jüri";
  facts.exercise_name = "cocktail-bar";
  facts.exercise_json = R"({"levels": [{"name": "a \"quoted\" one"}]})";
  facts.level = 2;
  facts.levels = 5;
  facts.value_names = {"stage", "flow_l_s"};
  facts.event_names = {"picked", "poured"};
  facts.parameters = {{"lead_in_m", LiveParameterGroup::kExercise, "m", 0.0, 0.02, 0.005, 0.01}};
  facts.exercises = {"cocktail-bar", "free-grasping"};
  facts.hands = {"adult"};
  facts.recording = "night shift.h5";
  SceneBody body;
  body.name = "glass";
  body.com_m = {0.0, 0.0, 0.05};
  body.shapes.resize(1);
  body.shapes[0].in_body.translation_m = {0.0, 0.0, 0.058};
  facts.scene.bodies = {body};
  return facts;
}

TickRecord someRecord() {
  TickRecord r;
  r.tick = 123456789012;
  r.time_s = 123456.789;
  r.faults = Fault::kLateTick;
  r.q_m = r.intention = r.q_s = AxisPosition(2, 0.25);
  r.qd_s = AxisVelocity(2, -0.75);
  r.theta = JointPosition(2, 0.0);
  r.coupling = r.damping = r.sent = r.exercise.effort = AxisEffort(2, -1.5);
  r.phi = AxisRatio(2, 0.75);
  r.authority = 0.5;
  r.exercise.alpha = 0.25;
  r.exercise.value_count = 2;
  r.exercise.values[0] = 0.1;
  r.exercise.values[1] = 1e-7;
  r.palm_body = 0;
  r.palm_target_distance_m = -0.125;
  r.body_count = 1;
  r.bodies[0].position_m = {0.3, -0.1, 0.05};
  r.contact_count = 2;
  for (int i = 0; i < r.contact_count; ++i) {
    r.contacts[i].capsule = i;
    r.contacts[i].body = 0;
    r.contacts[i].force_n = {0.0, 0.0, 2.0};
  }
  return r;
}

LoopStatus someStatus() {
  LoopStatus s;
  s.session = 3;
  s.endings = 5;
  s.run_state = RunState::kFaulted;
  s.steering = Steering::kPerson;
  s.latched = Fault::kDeviceRead;
  s.fault_axis = 1;
  s.fault_value = 1.625;
  s.fault_limit = 1.5;
  s.ticks = 7;
  s.missed_deadlines = 8;
  s.dropped_records = 9;
  s.cpu_p999_us = 42.5;
  s.recording_bytes = 1ULL << 40U;
  s.help = Help::kNone;
  s.parameters = {0.5};
  return s;
}

/// A ball in slot 3, which is the one of number 1002; three more beyond the slots.
wire::Bytes bodiesBeyondSlots() {
  GameShapes ball;
  ball.id = 11;
  ball.com_m = {0.0, 0.0, 0.01};
  ball.pieces.resize(1);
  ball.pieces[0].type = ShapeType::kSphere;
  ball.pieces[0].radius_m = 0.03;
  const auto shapes = std::make_shared<const GameShapes>(ball);
  const auto at = [](double x_m) { return BodyPose{{x_m, 0.5, -0.25}, {0.6, 0.0, 0.0, 0.8}}; };
  return wire::gameBodiesMessage(
      4, {{3, 1 << 23, SlotState::kGhost, shapes}}, {shapes},
      {{{1000, 5, 0, -1, Whereabouts::kOutOfReach, at(3.0)}, shapes},
       {{1001, 1, 0, -1, Whereabouts::kLeftOut, at(0.1)}, shapes},
       {{1002, 7, 0, 3, Whereabouts::kInSlot, at(0.2)}, shapes},
       {{32767, 2, 0, -1, Whereabouts::kOutOfReach, at(0.3)}, nullptr}});  // registered no more
}

CommissioningFacts failedStep() {
  CommissioningFacts facts;
  facts.device = "rail";
  facts.operator_name = "Ω";
  facts.steps.push_back({"signs",
                         CommissioningFacts::StepState::kFailed,
                         {{"x", "mass", "kg", 0.98, 1.02}},
                         "x is too heavy",
                         "balance it"});
  facts.question = 7;
  facts.asked = CommissioningFacts::Asked::kKnownForce;
  facts.motion_state = CommissioningFacts::MotionState::kAwaitsKey;
  return facts;
}

}  // namespace

std::vector<std::pair<std::string, wire::Bytes>> programMessages() {
  const auto facts = std::make_shared<SceneFacts>(smallScene());
  wire::StateEncoder encoder(facts);
  const auto state = [&](const LoopStatus& status, wire::Detail detail) {
    const std::span<const std::uint8_t> bytes = encoder.encode(someRecord(), status, detail, 555);
    return wire::Bytes(bytes.begin(), bytes.end());
  };
  LoopStatus real = someStatus();
  real.device = DeviceStatus{true, true, false, 41.5, 0.002, true, 0.001, ReleaseReason::kNot};
  const std::vector<wire::NumberedEvent> events = {{41, {1, 2, 0.25}}, {42, {0, -1, -1.0}}};
  return {
      {"program_welcome", wire::welcomeMessage(7, true, "9.8.7", {8091, 0xFEDCBA9876543210})},
      {"program_scene", wire::sceneMessage(*facts)},
      {"program_state", state(someStatus(), wire::Detail::kFull)},
      {"program_state_real_device", state(real, wire::Detail::kFull)},
      {"program_state_compact", state(someStatus(), wire::Detail::kCompact)},
      {"program_state_recorded", state(someStatus(), wire::Detail::kRecorded)},
      {"program_events", wire::eventsMessage(events)},
      {"program_game_bodies_beyond_slots", bodiesBeyondSlots()},
      {"program_controls",
       wire::controlsMessage({true, true, Role::kTherapist, Role::kTherapist, true})},
      {"program_reply", wire::replyMessage(7, {true, "", Refusal::kNone})},
      {"program_reply_refused",
       wire::replyMessage(8, refused(Refusal::kStopNotSeen, "a stop came since"))},
      {"program_commissioning", wire::commissioningMessage(failedStep())},
  };
}

}  // namespace wholehand::golden
