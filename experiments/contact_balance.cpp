#include "experiments/contact_balance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace wholehand {
namespace {

void add(AxisEffort& sum, const std::array<double, kMaxAxes>& row, double sign = 1.0) {
  for (int a = 0; a < sum.size(); ++a) sum[a] += sign * row[a];
}

}  // namespace

ContactBalance::ContactBalance(const Rig& rig)
    : rig_(rig),
      acted_(rig.models.device.axisCount()),
      driving_(acted_.size()),
      felt_(acted_.size()) {}

void ContactBalance::add(const TickRecord& r, const ArticulatedBody& kinematics) {
  const AxisEffort now = acted(r, kinematics);
  for (int a = 0; a < now.size(); ++a) {
    acted_[a] += now[a];
    driving_[a] += r.f_s[a];
    felt_[a] += r.coupling[a];
  }
  count_ += 1.0;
}

AxisEffort ContactBalance::acted(const TickRecord& r, const ArticulatedBody& kinematics) const {
  AxisEffort sum(acted_.size());
  std::array<double, kMaxAxes> row{};
  for (int i = 0; i < r.contact_count; ++i) {
    const Contact& c = r.contacts[i];
    kinematics.reducedPointRow(c.link, c.point_m.eigen(), c.force_n.eigen(), row.data());
    wholehand::add(sum, row);
    kinematics.reducedAngularRow(c.link, c.torque_nm.eigen(), row.data());
    wholehand::add(sum, row);
  }
  addSelfForces(kinematics, sum);
  return sum;
}

// Adds the forces of self contacts and of joints at the end of their range, which carry a share of
// the load.
void ContactBalance::addSelfForces(const ArticulatedBody& kinematics, AxisEffort& sum) const {
  SelfForces own;
  rig_.world->selfForces(own);
  std::array<double, kMaxAxes> row{};
  for (int i = 0; i < own.count; ++i) {
    const SelfForce& touch = own.touches[i];
    for (const auto& [capsule, sign] : {std::pair{touch.capsule_a, 1.0}, {touch.capsule_b, -1.0}}) {
      const int link = rig_.models.hand.capsules[capsule].link;
      kinematics.reducedPointRow(link, touch.point_m.eigen(), touch.force_n.eigen(), row.data());
      wholehand::add(sum, row, sign);
    }
  }
  for (int a = 0; a < own.joint_ends.size(); ++a) sum[a] += own.joint_ends[a];
}

double ContactBalance::driveError() const {
  AxisEffort unbalanced = acted_;
  for (int a = 0; a < unbalanced.size(); ++a) unbalanced[a] += driving_[a];
  return share(unbalanced, driving_);
}

double ContactBalance::feltError() const {
  AxisEffort unbalanced = acted_;
  for (int a = 0; a < unbalanced.size(); ++a) unbalanced[a] -= felt_[a];
  return share(unbalanced, felt_);
}

double ContactBalance::share(const AxisEffort& unbalanced, const AxisEffort& reference) const {
  if (count_ == 0.0) return 1.0;
  double worst = 0.0;
  for (int a = 0; a < unbalanced.size(); ++a) {
    const double scale = std::max(std::abs(reference[a]) / count_, leastScale(a, reference));
    worst = std::max(worst, std::abs(unbalanced[a]) / count_ / scale);
  }
  return worst;
}

// Lower bound of the reference effort of an axis. An axis with little load is compared with the
// load of axes of its kind.
double ContactBalance::leastScale(int axis, const AxisEffort& reference) const {
  const auto& axes = rig_.models.device.axes;
  const AxisKind kind = axes[axis].kind;
  double largest = 0.0;
  for (int b = 0; b < reference.size(); ++b) {
    if (axes[b].kind != kind) continue;
    largest = std::max(largest, std::abs(reference[b]) / count_);
  }
  return std::max(0.1 * largest, kind == AxisKind::kTranslation ? 0.1 : 0.01);
}

}  // namespace wholehand
