#include "device/simulated/linked_person.hpp"

#include <algorithm>

namespace wholehand {
namespace {

std::vector<int> linkedAxes(const PatientLinks& links) {
  std::vector<int> out;
  for (Eigen::Index i = 0; i < links.mass.rows(); ++i) {
    const bool linked = !links.mass.row(i).isZero(0.0) || !links.damping.row(i).isZero(0.0) ||
                        !links.stiffness.row(i).isZero(0.0);
    if (linked) out.push_back(static_cast<int>(i));
  }
  return out;
}

LinkedPlant plantOf(const DeviceModel& device, const PatientConfig& patient,
                    const std::vector<int>& axes) {
  const auto n = static_cast<int>(axes.size());
  LinkedPlant plant{AxisMatrix(n, n), AxisMatrix(n, n), AxisMatrix(n, n),
                    AxisEffort(n),    AxisPosition(n),  AxisPosition(n)};
  for (int i = 0; i < n; ++i) {
    const int at = axes[i];
    for (int k = 0; k < n; ++k) {
      const int other = axes[k];
      plant.mass(i, k) = patient.links.mass(at, other);
      plant.damping(i, k) = patient.links.damping(at, other);
      plant.stiffness(i, k) = patient.links.stiffness(at, other);
    }
    const DeviceAxis& axis = device.axes[at];
    const PatientAxis& person = patient.axes[at];
    plant.mass(i, i) = axis.mass + person.mass;
    plant.damping(i, i) = axis.damping + person.damping;
    plant.stiffness(i, i) = person.stiffness;
    plant.coulomb[i] = axis.coulomb;
    plant.lower[i] = axis.lower;
    plant.upper[i] = axis.upper;
  }
  return plant;
}

}  // namespace

LinkedPerson::LinkedPerson(const DeviceModel& device, const PatientConfig& patient, double period_s,
                           int slam_axis) {
  std::vector<int> axes = linkedAxes(patient.links);
  if (axes.empty()) return;
  groups_.push_back({axes, LinkedDynamics(plantOf(device, patient, axes), period_s)});
  if (std::erase(axes, slam_axis) == 0 || axes.empty()) return;
  groups_.push_back({axes, LinkedDynamics(plantOf(device, patient, axes), period_s)});
}

void LinkedPerson::enter(int group, const AxisPosition& q, const AxisVelocity& qd) noexcept {
  now_ = group;
  moved_.fill(false);
  if (group < 0) return;
  Group& g = groups_[group];
  const auto n = static_cast<int>(g.axes.size());
  AxisPosition position(n);
  AxisVelocity velocity(n);
  for (int i = 0; i < n; ++i) {
    const int axis = g.axes[i];
    moved_[axis] = true;
    position[i] = q[axis];
    velocity[i] = qd[axis];
  }
  g.dynamics.place(position, velocity);
}

void LinkedPerson::place(const AxisPosition& q, const AxisVelocity& qd) noexcept {
  enter(groups_.empty() ? -1 : 0, q, qd);
}

void LinkedPerson::hold(const std::array<bool, kMaxAxes>& held, const AxisPosition& q,
                        const AxisVelocity& qd) noexcept {
  const auto all_held = [&](const Group& group) {
    return std::all_of(group.axes.begin(), group.axes.end(), [&](int axis) { return held[axis]; });
  };
  const auto found = std::find_if(groups_.begin(), groups_.end(), all_held);
  const int group = found == groups_.end() ? -1 : static_cast<int>(found - groups_.begin());
  if (group != now_) enter(group, q, qd);
}

void LinkedPerson::advance(const AxisEffort& begin, const AxisEffort& end, AxisPosition& q,
                           AxisVelocity& qd) noexcept {
  if (now_ < 0) return;
  Group& g = groups_[now_];
  const auto n = static_cast<int>(g.axes.size());
  AxisEffort first(n), last(n);
  for (int i = 0; i < n; ++i) {
    first[i] = begin[g.axes[i]];
    last[i] = end[g.axes[i]];
  }
  g.dynamics.advance(first, last);
  for (int i = 0; i < n; ++i) {
    const int axis = g.axes[i];
    q[axis] = g.dynamics.position(i);
    qd[axis] = g.dynamics.velocity(i);
  }
}

}  // namespace wholehand
