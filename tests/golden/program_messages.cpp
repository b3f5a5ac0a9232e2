#include "golden/program_messages.hpp"

#include "station/server/sample_facts.hpp"

#include <memory>
#include <span>

namespace wholehand::golden {

namespace {

SceneFacts smallScene() {
  SceneFacts facts = test::sampleScene();
  facts.program_version = "9.8.7";
  facts.patient_name = "Jüri";
  facts.exercise_json = R"({"levels": [{"name": "a \"quoted\" one"}]})";
  facts.level = 2;
  facts.levels = 5;
  facts.event_names = {"picked", "poured"};
  facts.exercises = {"cocktail-bar", "free-grasping"};
  facts.hands = {"adult"};
  facts.recording = "night shift.h5";
  return facts;
}

TickRecord someRecord() {
  TickRecord r = test::sampleRecord(2, 2, 2, 0);
  r.exercise.value_count = 2;
  r.exercise.values[0] = 0.1;
  r.exercise.values[1] = 1e-7;
  r.palm_target_distance_m = -0.125;
  r.body_count = 1;
  r.bodies[0].position_m = {0.3, -0.1, 0.05};
  return r;
}

LoopStatus someStatus() {
  return test::sampleStatus({0.5});
}

/// A ball in slot 3, which has number 1002, and three more bodies beyond the slots.
wire::Bytes bodiesBeyondSlots() {
  const auto shapes = std::make_shared<const GameShapes>(test::sampleBall());
  const auto at = [](double x_m) { return BodyPose{{x_m, 0.5, -0.25}, {0.6, 0.0, 0.0, 0.8}}; };
  return wire::gameBodiesMessage(
      4, {{3, 1 << 23, SlotState::kGhost, shapes}}, {shapes},
      {{1000, 5, -1, Whereabouts::kOutOfReach, at(3.0), shapes},
       {1001, 1, -1, Whereabouts::kLeftOut, at(0.1), shapes},
       {1002, 7, 3, Whereabouts::kInSlot, at(0.2), shapes},
       {32767, 2, -1, Whereabouts::kOutOfReach, at(0.3), nullptr}});  // no longer registered
}

CommissioningFacts failedStep() {
  CommissioningFacts facts = test::sampleFailedStep();
  facts.operator_name = "Ω";
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
  real.device = DeviceStatus{true, true, false, 41.5, 0.002, true, 0.001, ReleaseReason::kNone};
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
