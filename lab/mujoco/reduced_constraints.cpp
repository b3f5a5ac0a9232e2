#include "lab/mujoco/reduced_constraints.hpp"

#include "loop/dynamics/articulated_body.hpp"

#include <algorithm>
#include <array>

namespace wholehand::mujoco {
namespace {

/// Least inverse effective mass for rescaling a row; below it the row keeps MuJoCo's own weight
/// [1/kg].
constexpr double kLeastInverseMass = 1e-9;

bool isEnd(const mjData& data, int row) {
  return data.efc_type[row] == mjCNSTR_LIMIT_JOINT;
}

}  // namespace

ReducedConstraints::ReducedConstraints(const HandMap& map, const mjModel& model,
                                       const SolverSettings& settings)
    : map_(&map),
      settings_(settings),
      dofs_(model.nv),
      column_(model.nv),
      momentum_(model.nv),
      half_(model.nv) {}

/// Computes M G M_r⁻¹ from MuJoCo's own M, armature included. Returns false when M_r is singular.
bool ReducedConstraints::reduceInertia(const mjModel& model, mjData& data) noexcept {
  const HandModel& hand = map_->hand();
  const int axes = hand.axis_count, joints = hand.joint_count;
  JointAxisMatrix moved(joints, axes);
  for (int a = 0; a < axes; ++a) {
    std::fill(column_.begin(), column_.end(), 0.0);
    for (int j = 0; j < joints; ++j) {
      column_[map_->dof(j)] = hand.synergy(j, a);
    }
    mj_mulM(&model, &data, momentum_.data(), column_.data());
    for (int j = 0; j < joints; ++j) {
      moved(j, a) = momentum_[map_->dof(j)];
    }
  }
  AxisMatrix inertia(axes, axes);
  inertia.noalias() = hand.synergy.transpose() * moved;
  if (!invertPositiveDefinite(inertia, inverse_)) return false;
  projected_.resize(joints, axes);
  projected_.noalias() = moved * inverse_;
  return true;
}

void ReducedConstraints::projectRow(double* row) const noexcept {
  const HandModel& hand = map_->hand();
  std::array<double, kMaxAxes> reduced{};
  bool moves = false;
  for (int j = 0; j < hand.joint_count; ++j) {
    const double here = row[map_->dof(j)];
    if (here == 0.0) continue;
    moves = true;
    for (int a = 0; a < hand.axis_count; ++a) {
      reduced[a] += here * hand.synergy(j, a);
    }
  }
  if (!moves) return;
  for (int j = 0; j < hand.joint_count; ++j) {
    double sum = 0.0;
    for (int a = 0; a < hand.axis_count; ++a) {
      sum += projected_(j, a) * reduced[a];
    }
    row[map_->dof(j)] = sum;
  }
}

/// Rescales the softness of constraint rows. MuJoCo softens a row by a share of the effective mass
/// of the unreduced joints; this uses the same share of the row's actual effective mass. One factor
/// for all rows of a contact preserves its friction cone.
void ReducedConstraints::weigh(const mjModel& model, mjData& data, int row, int rows) noexcept {
  mj_solveM2(&model, &data, half_.data(), data.efc_J + static_cast<std::ptrdiff_t>(row) * dofs_, 1);
  double inverse_mass = 0.0;
  for (const double x : half_) inverse_mass += x * x;
  if (!(inverse_mass > kLeastInverseMass)) return;
  const double factor = inverse_mass / data.efc_diagApprox[row];
  for (int k = row; k < row + rows; ++k) {
    data.efc_diagApprox[k] *= factor;
    data.efc_R[k] *= factor;
    data.efc_D[k] /= factor;
  }
}

bool ReducedConstraints::project(const mjModel& model, mjData& data) noexcept {
  if (data.nefc == 0) return true;
  if (!reduceInertia(model, data)) return false;
  for (int i = 0; i < data.nefc; ++i) {
    projectRow(data.efc_J + static_cast<std::ptrdiff_t>(i) * dofs_);
  }
  for (int i = 0; i < data.nefc; ++i) {
    if (isEnd(data, i)) weigh(model, data, i, 1);
  }
  for (int i = 0; i < data.ncon; ++i) {
    const mjContact& contact = data.contact[i];
    if (contact.efc_address >= 0) weigh(model, data, contact.efc_address, contact.dim);
  }
  return true;
}

double ReducedConstraints::goal(double apart, double period_s) const noexcept {
  return apart > 0.0 ? -apart / period_s : -settings_.recovery * apart / period_s;
}

void ReducedConstraints::aim(mjData& data, const double* surface_velocity,
                             double period_s) noexcept {
  for (int i = 0; i < data.nefc; ++i) {
    if (!isEnd(data, i)) continue;
    data.efc_aref[i] = (goal(data.efc_pos[i], period_s) - data.efc_vel[i]) / period_s;
  }
  for (int i = 0; i < data.ncon; ++i) {
    const mjContact& contact = data.contact[i];
    if (contact.efc_address < 0) continue;
    for (int k = 0; k < contact.dim; ++k) {
      const int row = contact.efc_address + k;
      double speed = data.efc_vel[row];
      for (int x = 0; k < 3 && x < 3; ++x) {
        speed += contact.frame[3 * k + x] * surface_velocity[3 * i + x];
      }
      const double wanted = k == 0 ? goal(contact.dist, period_s) : 0.0;
      data.efc_aref[row] = (wanted - speed) / period_s;
    }
  }
}

/// The effort follows from Gᵀ Pᵀ jᵀ f = Gᵀ jᵀ f.
AxisEffort ReducedConstraints::endEffort(const mjData& data) const noexcept {
  const HandModel& hand = map_->hand();
  AxisEffort sum(hand.axis_count);
  for (int i = 0; i < data.nefc; ++i) {
    if (!isEnd(data, i) || data.efc_force[i] == 0.0) continue;
    const double* row = data.efc_J + static_cast<std::ptrdiff_t>(i) * dofs_;
    for (int j = 0; j < hand.joint_count; ++j) {
      for (int a = 0; a < hand.axis_count; ++a) {
        sum[a] += hand.synergy(j, a) * row[map_->dof(j)] * data.efc_force[i];
      }
    }
  }
  return sum;
}

}  // namespace wholehand::mujoco
