#pragma once

#include "station/server/wire.hpp"
#include "support/crank_hand.hpp"

#include <utility>
#include <vector>

/// Sample content for messages: a small scene, a record, a status, a failed commissioning step and
/// a ball. The golden files (tests/golden) are made from it: it must not change.
namespace wholehand::test {

inline SceneFacts sampleScene() {
  SceneFacts facts;
  facts.session = 3;
  facts.hand = crankHand();
  facts.exercise_name = "cocktail-bar";
  facts.value_names = {"stage", "flow_l_s"};
  facts.parameters = {{"lead_in_m", ParameterGroup::kExercise, "m", 0.0, 0.02, 0.005, 0.01, false}};
  SceneBody body;
  body.name = "glass";
  body.com_m = {0.0, 0.0, 0.05};
  body.shapes.resize(1);
  body.shapes[0].in_body.translation_m = {0.0, 0.0, 0.058};
  facts.scene.bodies = {body};
  return facts;
}

/// A record with so many axes and joints, each with a contact between its capsule and `body`.
inline TickRecord sampleRecord(int axes, int joints, int contacts, int body) {
  TickRecord r;
  r.tick = 123456789012;
  r.time_s = 123456.789;
  r.faults = Fault::kLateTick;
  r.q_m = r.intention = r.q_s = AxisPosition(axes, 0.25);
  r.qd_s = AxisVelocity(axes, -0.75);
  r.theta = JointPosition(joints, 0.0);
  r.coupling = r.damping = r.sent = r.exercise.effort = AxisEffort(axes, -1.5);
  r.phi = AxisRatio(axes, 0.75);
  r.authority = 0.5;
  r.exercise.alpha = 0.25;
  r.palm_body = body;
  r.contact_count = contacts;
  for (int i = 0; i < contacts; ++i) {
    r.contacts[i].capsule = i;
    r.contacts[i].body = body;
    r.contacts[i].force_n = {0.0, 0.0, 2.0};
  }
  return r;
}

inline LoopStatus sampleStatus(std::vector<double> parameters) {
  LoopStatus s;
  s.session = 3;
  s.endings = 5;
  s.basis = 8;
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
  s.parameters = std::move(parameters);
  return s;
}

inline CommissioningFacts sampleFailedStep() {
  CommissioningFacts facts;
  facts.device = "rail";
  facts.steps.push_back({"signs",
                         StepState::kFailed,
                         {{"x", "mass", "kg", 0.98, 1.02}},
                         "x is too heavy",
                         "balance it"});
  facts.question = 7;
  facts.asked = QuestionKind::kKnownForce;
  facts.motion_state = MotionState::kAwaitsKey;
  return facts;
}

/// A ball of 3 cm, its centre of mass 1 cm above the body's frame.
inline GameShapes sampleBall() {
  GameShapes ball;
  ball.id = 11;
  ball.com_m = {0.0, 0.0, 0.01};
  ball.pieces.resize(1);
  ball.pieces[0].type = ShapeType::kSphere;
  ball.pieces[0].radius_m = 0.03;
  return ball;
}

}  // namespace wholehand::test
