#include "lab/bullet_paper/paper_hand.hpp"

#include "loop/physics/bullet/bullet_types.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace wholehand::bullet_paper {
namespace {

using bullet::toBt;

/// Bullet requires a link's frame at its centre of mass, along the principal axes of its inertia.
struct PrincipalAxes {
  Eigen::Matrix3d in_link = Eigen::Matrix3d::Identity();
  Eigen::Vector3d moments = Eigen::Vector3d::Zero();
};

PrincipalAxes principalAxes(const HandLink& link) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(link.inertia_kg_m2);
  PrincipalAxes out{solver.eigenvectors(), solver.eigenvalues()};
  if (out.in_link.determinant() < 0.0) out.in_link.col(2) = -out.in_link.col(2);
  return out;
}

btVector3 turned(const Eigen::Matrix3d& axes, const Eigen::Vector3d& v) {
  return toBt(Eigen::Vector3d(axes.transpose() * v));
}

void addLink(btMultiBody& body, const HandModel& hand, int index) {
  const HandLink& link = hand.links[index];
  const PrincipalAxes own = principalAxes(link);
  Eigen::Matrix3d parent_axes = Eigen::Matrix3d::Identity();
  Eigen::Vector3d parent_com = Eigen::Vector3d::Zero();
  if (link.parent >= 0) {
    const HandLink& parent = hand.links[link.parent];
    parent_axes = principalAxes(parent).in_link;
    parent_com = parent.com_m;
  }
  const Eigen::Matrix3d in_parent =
      parent_axes.transpose() * link.parent_to_link.rotation * own.in_link;
  const btQuaternion from_parent = bullet::toBtQuaternion(in_parent.transpose());
  const btVector3 pivot = turned(parent_axes, link.parent_to_link.translation_m - parent_com);
  const btVector3 com = turned(own.in_link, link.com_m), axis = turned(own.in_link, link.axis);
  const btVector3 moments = toBt(own.moments);
  if (link.joint < 0 || link.type == JointType::kFixed) {
    body.setupFixed(index, link.mass_kg, moments, link.parent, from_parent, pivot, com, true);
  } else if (link.type == JointType::kRevolute) {
    body.setupRevolute(index, link.mass_kg, moments, link.parent, from_parent, axis, pivot, com,
                       true);
  } else {
    body.setupPrismatic(index, link.mass_kg, moments, link.parent, from_parent, axis, pivot, com,
                        true);
  }
}

std::unique_ptr<btMultiBody> makeBody(const HandModel& hand) {
  const int links = static_cast<int>(hand.links.size());
  auto body = std::make_unique<btMultiBody>(links, 0.0, btVector3(0, 0, 0), true, false);
  for (int i = 0; i < links; ++i) addLink(*body, hand, i);
  body->finalizeMultiDof();
  body->setLinearDamping(0.0);  // the only setting that the paper changed
  body->setAngularDamping(0.0);
  body->setMaxCoordinateVelocity(1e4);  // the stock limit of 100 rad/s would clip a fast finger
  body->setHasSelfCollision(false);
  return body;
}

}  // namespace

PaperHand::PaperHand(const HandModel& hand, double friction, PaperCoupling coupling)
    : hand_(&hand), coupling_(coupling), synergy_(hand), kinematics_(hand), body_(makeBody(hand)) {
  for (int i = 0; i < static_cast<int>(hand.links.size()); ++i) {
    const int joint = hand.links[i].joint;
    if (joint >= 0) link_of_joint_[joint] = i;
  }
  for (int a = 0; a < hand.axis_count; ++a) {
    leading_[a] = leadingJoint(hand, a);
  }
  coupling == PaperCoupling::kGears ? addGears() : addMotors();
  addCapsules(friction);
}

bool PaperHand::leads(int joint) const {
  const auto end = leading_.begin() + hand_->axis_count;
  return std::find(leading_.begin(), end, joint) != end;
}

void PaperHand::addGears() {
  constexpr double kErp = 1.0;  // share of the world's m_erp2
  const btVector3 origin(0.0, 0.0, 0.0);
  const btMatrix3x3 unit = btMatrix3x3::getIdentity();
  for (int j = 0; j < hand_->joint_count; ++j) {
    if (leads(j)) continue;
    for (int a = 0; a < hand_->axis_count; ++a) {
      const int lead = leading_[a];
      const double ratio = hand_->synergy(j, a) / hand_->synergy(lead, a);
      if (ratio == 0.0) continue;
      auto& gear = *gears_.emplace_back(std::make_unique<btMultiBodyGearConstraint>(
          body_.get(), link_of_joint_[j], body_.get(), link_of_joint_[lead], origin, origin, unit,
          unit));
      gear.setGearRatio(-ratio);
      gear.setErp(kErp);
      gear.setRelativePositionTarget(hand_->theta0[j] - ratio * hand_->theta0[lead]);
      gear.finalizeMultiDof();
    }
  }
}

std::vector<btMultiBodyConstraint*> PaperHand::constraints() const {
  std::vector<btMultiBodyConstraint*> out;
  for (const auto& motor : motors_) out.push_back(motor.get());
  for (const auto& gear : gears_) out.push_back(gear.get());
  return out;
}

void PaperHand::addMotors() {
  constexpr double kServersImpulse_nms = 1.0;  // PhysicsServerCommandProcessor::createJointMotors
  for (int j = 0; j < hand_->joint_count; ++j) {
    if (leads(j)) continue;
    following_.push_back(j);
    motors_.push_back(std::make_unique<btMultiBodyJointMotor>(body_.get(), link_of_joint_[j], 0.0,
                                                              kServersImpulse_nms));
    motors_.back()->finalizeMultiDof();
  }
}

Diagnostics PaperHand::refuse(const HandModel& hand, PaperCoupling coupling) {
  Diagnostics errors;
  for (int j = 0; coupling == PaperCoupling::kGears && j < hand.joint_count; ++j) {
    int followed = 0;
    for (int a = 0; a < hand.axis_count; ++a) followed += hand.synergy(j, a) != 0.0 ? 1 : 0;
    if (followed <= 1) continue;
    errors.push_back(
        {"", 0, "synergy", "",
         "moves a joint by two axes, and a gear of bullet-paper-gears joins two joints",
         "use --engine bullet-paper"});
  }
  for (int a = 0; a < hand.axis_count; ++a) {
    if (leadingJoint(hand, a) >= 0) continue;
    errors.push_back({"", 0, "synergy." + hand.axis_names[a], "",
                      "drives no joint alone, and the engine bullet-paper lets such a joint lead",
                      "use --engine bullet, or let the axis drive a joint of its own"});
  }
  return errors;
}

void PaperHand::addCapsules(double friction) {
  tags_.reserve(hand_->capsules.size());  // Bullet keeps pointers to the tags
  for (const Capsule& capsule : hand_->capsules) {
    const Eigen::Vector3d along = capsule.b_m - capsule.a_m;
    Pose at;
    at.translation_m = 0.5 * (capsule.a_m + capsule.b_m);
    if (along.norm() > 0.0) {
      at.rotation =
          Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), along).toRotationMatrix();
    }
    capsule_in_link_.push_back(at);
    tags_.push_back({static_cast<int>(tags_.size()), capsule.link, -1, nullptr, nullptr});
    shapes_.push_back(std::make_unique<btCapsuleShapeZ>(capsule.radius_m, along.norm()));
    auto& collider = *capsules_.emplace_back(
        std::make_unique<btMultiBodyLinkCollider>(body_.get(), capsule.link));
    collider.setCollisionShape(shapes_.back().get());
    collider.setUserPointer(&tags_.back());
    collider.setFriction(std::sqrt(friction));  // Bullet multiplies the friction of both bodies
    collider.setActivationState(DISABLE_DEACTIVATION);
  }
  // Bullet ignores the motor of a link without a collider, so every link gets a collider. put()
  // sets the colliders' final poses.
  for (int i = 0; i < body_->getNumLinks(); ++i) {
    body_->getLink(i).m_collider = capsules_.front().get();
  }
  for (const auto& capsule : capsules_) body_->getLink(capsule->m_link).m_collider = capsule.get();
}

bool PaperHand::isPalm(int capsule) const {
  return hand_->capsules[capsule].part == HandPart::kPalm;
}

void PaperHand::put(const AxisPosition& q_s, const AxisVelocity& qd_s) noexcept {
  JointPosition theta;
  JointVelocity theta_dot(hand_->joint_count);
  synergy_.expand(q_s, theta);
  synergy_.expandRate(qd_s.data(), theta_dot.data());
  for (int j = 0; j < hand_->joint_count; ++j) {
    const int link = link_of_joint_[j];
    body_->setJointPos(link, theta[j]);
    body_->setJointVel(link, theta_dot[j]);
  }
  placeCapsules(theta);
}

void PaperHand::settle(const AxisPosition& q_s, const AxisVelocity& qd_s) noexcept {
  if (coupling_ == PaperCoupling::kResets) {
    put(q_s, qd_s);
    return;
  }
  JointPosition theta;
  JointVelocity theta_dot;
  readJoints(theta, theta_dot);
  placeCapsules(theta);
}

void PaperHand::readJoints(JointPosition& theta, JointVelocity& theta_dot) const noexcept {
  theta = JointPosition(hand_->joint_count);
  theta_dot = JointVelocity(hand_->joint_count);
  for (int j = 0; j < hand_->joint_count; ++j) {
    theta[j] = body_->getJointPos(link_of_joint_[j]);
    theta_dot[j] = body_->getJointVel(link_of_joint_[j]);
  }
}

void PaperHand::placeCapsules(const JointPosition& theta) noexcept {
  kinematics_.updateKinematics(theta);
  for (std::size_t i = 0; i < capsules_.size(); ++i) {
    const btTransform at = toBt(kinematics_.linkPose(tags_[i].link) * capsule_in_link_[i]);
    capsules_[i]->setWorldTransform(at);
    capsules_[i]->setInterpolationWorldTransform(at);
  }
}

double PaperHand::take(AxisPosition& q_s, AxisVelocity& qd_s) const noexcept {
  q_s = AxisPosition(hand_->axis_count);
  qd_s = AxisVelocity(hand_->axis_count);
  for (int a = 0; a < hand_->axis_count; ++a) {
    const int joint = leading_[a];
    const int link = link_of_joint_[joint];
    const double ratio = hand_->synergy(joint, a);
    q_s[a] = (body_->getJointPos(link) - hand_->theta0[joint]) / ratio;
    qd_s[a] = body_->getJointVel(link) / ratio;
  }
  JointPosition theta;
  synergy_.expand(q_s, theta);
  double error_rad = 0.0;
  for (int j = 0; j < hand_->joint_count; ++j) {
    const int link = link_of_joint_[j];
    error_rad = std::max(error_rad, std::abs(body_->getJointPos(link) - theta[j]));
  }
  return error_rad;
}

void PaperHand::drive(const JointEffort& torque, const AxisVelocity& qd_s) noexcept {
  for (int j = 0; j < hand_->joint_count; ++j) {
    body_->addJointTorque(link_of_joint_[j], torque[j]);
  }
  JointVelocity theta_dot(hand_->joint_count);
  synergy_.expandRate(qd_s.data(), theta_dot.data());
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    motors_[i]->setVelocityTarget(theta_dot[following_[i]]);
  }
}

}  // namespace wholehand::bullet_paper
