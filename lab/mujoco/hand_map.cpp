#include "lab/mujoco/hand_map.hpp"

#include "lab/mujoco/model_text.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace wholehand::mujoco {

HandMap::HandMap(const HandModel& hand, const mjModel& model) : hand_(&hand), synergy_(hand) {
  for (int j = 0; j < hand.joint_count; ++j) {
    const int id = mj_name2id(&model, mjOBJ_JOINT, jointName(j).c_str());
    position_[j] = model.jnt_qposadr[id];
    dof_[j] = model.jnt_dofadr[id];
  }
  for (int a = 0; a < hand.axis_count; ++a) alone_.push_back(leadingJoint(hand, a));
  const Eigen::MatrixXd g = hand.synergy;
  back_ = (g.transpose() * g).ldlt().solve(g.transpose());
}

Diagnostics HandMap::refuse() const {
  Diagnostics errors;
  for (int a = 0; a < hand_->axis_count; ++a) {
    if (alone_[a] >= 0) continue;
    errors.push_back({"", 0, "synergy." + hand_->axis_names[a], "",
                      "drives no joint alone, and the engine mujoco has inertia on joints only",
                      "use --engine bullet, or let the axis drive a joint of its own"});
  }
  return errors;
}

void HandMap::put(mjData& data, const AxisPosition& q_s, const AxisVelocity& qd_s) const noexcept {
  JointPosition theta;
  JointVelocity theta_dot(hand_->joint_count);
  synergy_.expand(q_s, theta);
  synergy_.expandRate(qd_s.data(), theta_dot.data());
  for (int j = 0; j < hand_->joint_count; ++j) {
    data.qpos[position_[j]] = theta[j];
    data.qvel[dof(j)] = theta_dot[j];
  }
}

double HandMap::take(const mjData& data, AxisPosition& q_s, AxisVelocity& qd_s) const noexcept {
  q_s = AxisPosition(hand_->axis_count);
  qd_s = AxisVelocity(hand_->axis_count);
  for (int j = 0; j < hand_->joint_count; ++j) {
    const double turned = data.qpos[position_[j]] - hand_->theta0[j];
    const double rate = data.qvel[dof(j)];
    for (int a = 0; a < hand_->axis_count; ++a) {
      q_s[a] += back_(a, j) * turned;
      qd_s[a] += back_(a, j) * rate;
    }
  }
  JointPosition theta;
  synergy_.expand(q_s, theta);
  double error_rad = 0.0;
  for (int j = 0; j < hand_->joint_count; ++j) {
    error_rad = std::max(error_rad, std::abs(data.qpos[position_[j]] - theta[j]));
  }
  return error_rad;
}

void HandMap::drive(mjModel& model, mjData& data, const HandDrive& drive) const noexcept {
  for (int j = 0; j < hand_->joint_count; ++j) data.qfrc_applied[dof(j)] = drive.torque[j];
  for (int a = 0; a < drive.armature.size(); ++a) {
    const int joint = alone_[a];
    const double ratio = hand_->synergy(joint, a);
    model.dof_armature[dof(joint)] = drive.armature[a] / (ratio * ratio);
    data.qfrc_applied[dof(joint)] += drive.armature_effort[a] / ratio;
  }
}

}  // namespace wholehand::mujoco
