#include "assembly/sampled_inertia.hpp"

#include "dynamics/articulated_body.hpp"
#include "dynamics/synergy.hpp"

namespace wholehand {
namespace {

AxisMatrix reducedInertiaAt(const HandModel& hand, ArticulatedBody& body, const AxisPosition& q_s) {
  JointPosition theta;
  Synergy(hand).expand(q_s, theta);
  [[maybe_unused]] const bool definite =
      body.update(theta, JointVelocity(hand.joint_count), Eigen::Vector3d::Zero());
  return body.reducedInertia();
}

}  // namespace

SampledInertia sampleInertia(const HandModel& hand, const DeviceModel& device) {
  ArticulatedBody body(hand);
  SampledInertia out;
  out.at_reference = reducedInertiaAt(hand, body, hand.reference);
  std::vector<int> moving;
  for (int a = 0; a < device.axisCount(); ++a) {
    if (device.axes[static_cast<std::size_t>(a)].kind == AxisKind::kRotation) moving.push_back(a);
  }
  int count = 1;
  for (std::size_t i = 0; i < moving.size(); ++i) count *= 3;
  for (int index = 0; index < count; ++index) {
    AxisPosition q_s(device.axisCount());
    int digits = index;
    for (int a : moving) {
      const DeviceAxis& axis = device.axes[static_cast<std::size_t>(a)];
      q_s[a] = axis.lower + 0.5 * (digits % 3) * (axis.upper - axis.lower);
      digits /= 3;
    }
    out.samples.push_back(reducedInertiaAt(hand, body, q_s));
  }
  return out;
}

CertificateInput certificateInput(const Models& models, double period_s) {
  SampledInertia inertia = sampleInertia(models.hand, models.device);
  return {models.device, models.rendering, inertia.at_reference, std::move(inertia.samples),
          period_s};
}

}  // namespace wholehand
