#include "server/wire.hpp"
#include "server/wire_common.hpp"

namespace wholehand::wire {

namespace {

using Facts = CommissioningFacts;

static_assert(static_cast<int>(Facts::StepState::kFailed) == static_cast<int>(fb::StepState::MAX));
static_assert(static_cast<int>(Facts::Asked::kNextStep) == static_cast<int>(fb::Asked::MAX));
static_assert(static_cast<int>(Facts::Motion::kEmergencyStop) ==
              static_cast<int>(fb::MotionKind::MAX));
static_assert(static_cast<int>(Facts::MotionState::kOver) ==
              static_cast<int>(fb::MotionState::MAX));

Offset<fb::Finding> findingToWire(Builder& b, const Facts::Finding& f) {
  return fb::CreateFindingDirect(b, f.axis.c_str(), f.quantity.c_str(), f.unit.c_str(), f.lower,
                                 f.upper);
}

Offset<fb::CommissioningStep> stepToWire(Builder& b, const Facts::Step& step) {
  std::vector<Offset<fb::Finding>> findings;
  for (const Facts::Finding& f : step.findings) findings.push_back(findingToWire(b, f));
  return fb::CreateCommissioningStepDirect(b, step.name.c_str(),
                                           static_cast<fb::StepState>(step.state), &findings,
                                           step.problem.c_str(), step.remedy.c_str());
}

}  // namespace

Bytes commissioningMessage(const CommissioningFacts& f) {
  Builder b;
  std::vector<Offset<fb::CommissioningStep>> steps;
  for (const Facts::Step& step : f.steps) steps.push_back(stepToWire(b, step));
  const auto message = fb::CreateCommissioningDirect(
      b, f.device.c_str(), f.driver.c_str(), f.serial.c_str(), f.firmware.c_str(),
      f.operator_name.c_str(), &steps, f.question, static_cast<fb::Asked>(f.asked), f.axis.c_str(),
      f.unit.c_str(), f.lower, f.upper, f.next.c_str(), f.note.c_str(),
      static_cast<fb::MotionKind>(f.motion), static_cast<fb::MotionState>(f.motion_state),
      static_cast<float>(f.motion_s), f.passport.c_str(), f.recording.c_str(), f.daily);
  finish(b, message, kSchemaVersion);
  return {b.GetBufferPointer(), b.GetBufferPointer() + b.GetSize()};
}

}  // namespace wholehand::wire
