#include "assembly/resting_player.hpp"

#include "patient/scripted_player.hpp"

namespace wholehand {

AxisPosition restPose(const Models& models) {
  AxisPosition rest(models.device.axisCount());
  for (int a = 0; a < rest.size(); ++a) {
    const DeviceAxis& axis = models.device.axes[a];
    const bool centered = axis.kind == AxisKind::kTranslation || axis.lower < 0.0;
    rest[a] = centered ? 0.5 * (axis.lower + axis.upper) : models.hand.reference[a];
  }
  return rest;
}

Intention intentionOf(const Models& models, std::vector<std::string>* sentences) {
  const AxisPosition rest = restPose(models);
  if (!models.motion) return Intention::throughWaypoints({{0.0, rest}});
  return Intention::fromMotion(*models.motion, models.patient.motion, models.device, rest,
                               sentences);
}

std::unique_ptr<Player> makeMotionPlayer(const Models& models) {
  return std::make_unique<ScriptedPlayer>(intentionOf(models, nullptr),
                                          models.motion ? Mover::kMotion : Mover::kNobody);
}

}  // namespace wholehand
