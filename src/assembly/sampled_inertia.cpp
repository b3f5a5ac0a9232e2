#include "assembly/sampled_inertia.hpp"

#include "dynamics/articulated_body.hpp"
#include "dynamics/synergy.hpp"

#include <random>
#include <vector>

namespace wholehand {
namespace {

AxisMatrix reducedInertiaAt(const HandModel& hand, ArticulatedBody& body, const AxisPosition& q_s) {
  JointPosition theta;
  Synergy(hand).expand(q_s, theta);
  [[maybe_unused]] const bool definite =
      body.update(theta, JointVelocity(hand.joint_count), Eigen::Vector3d::Zero());
  return body.reducedInertia();
}

// A posture: lower end, middle or upper end on every axis.
using Places = std::vector<int>;

// All combinations for few axes. For more, as many as for six axes, drawn at random but the same
// each time.
std::vector<Places> choosePlaces(std::size_t axes) {
  constexpr std::size_t kFew = 6;
  constexpr int kMost = 729;  // 3^6
  std::vector<Places> chosen;
  if (axes <= kFew) {
    int count = 1;
    for (std::size_t i = 0; i < axes; ++i) count *= 3;
    for (int index = 0; index < count; ++index) {
      Places places;
      for (int digits = index; places.size() < axes; digits /= 3) places.push_back(digits % 3);
      chosen.push_back(places);
    }
    return chosen;
  }
  for (int place = 0; place < 3; ++place) chosen.emplace_back(axes, place);
  std::mt19937_64 random(1);  // same postures in every run
  while (chosen.size() < kMost) {
    Places places;
    while (places.size() < axes) places.push_back(static_cast<int>(random() % 3));
    chosen.push_back(places);
  }
  return chosen;
}

}  // namespace

SampledInertia sampleInertia(const HandModel& hand, const DeviceModel& device) {
  ArticulatedBody body(hand);
  SampledInertia out;
  out.at_reference = reducedInertiaAt(hand, body, hand.reference);
  std::vector<int> moving;
  for (int a = 0; a < device.axisCount(); ++a) {
    if (device.axes[a].kind == AxisKind::kRotation) moving.push_back(a);
  }
  for (const Places& places : choosePlaces(moving.size())) {
    AxisPosition q_s(device.axisCount());
    for (std::size_t i = 0; i < moving.size(); ++i) {
      const DeviceAxis& axis = device.axes[moving[i]];
      q_s[moving[i]] = axis.lower + 0.5 * places[i] * (axis.upper - axis.lower);
    }
    out.samples.push_back(reducedInertiaAt(hand, body, q_s));
  }
  return out;
}

CertificateInput certificateInput(const Models& models, double period_s) {
  SampledInertia inertia = sampleInertia(models.hand, models.device);
  CertificateInput input;
  input.device = models.device;
  input.rendering = models.rendering;
  input.inertia_at_reference = inertia.at_reference;
  input.inertias = std::move(inertia.samples);
  input.period_s = period_s;
  for (const ExerciseWall& wall : models.exercise_walls) {
    input.walls.push_back({wall.axis, {wall.stiffness, wall.damping, wall.resistance}});
  }
  input.hand = models.hand.name;
  if (models.exercise) {
    const ExerciseDescription& exercise = models.exercise->description();
    input.exercise = exercise.name;
    input.level = exercise.levels > 1 ? exercise.level : 0;
  }
  return input;
}

}  // namespace wholehand
