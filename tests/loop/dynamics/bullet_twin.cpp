#include "bullet_twin.hpp"

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <vector>

namespace wholehand::test {

namespace {

btVector3 bt(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}
btQuaternion btTurn(const Eigen::Matrix3d& r) {
  const Eigen::Quaterniond q(r);
  return {q.x(), q.y(), q.z(), q.w()};
}

/// Bullet's link frame: at the centre of mass, along the principal axes.
struct PrincipalFrame {
  Eigen::Matrix3d in_link = Eigen::Matrix3d::Identity();
  Eigen::Vector3d moments = Eigen::Vector3d::Zero();
};

PrincipalFrame principal(const HandLink& link) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(link.inertia_kg_m2);
  PrincipalFrame f{solver.eigenvectors(), solver.eigenvalues()};
  if (f.in_link.determinant() < 0.0) f.in_link.col(0) *= -1.0;
  return f;
}

}  // namespace

BulletTwin::BulletTwin(const HandModel& hand) : hand_(&hand) {
  const int n = static_cast<int>(hand.links.size());
  body_ = std::make_unique<btMultiBody>(n, 1.0, btVector3(1, 1, 1), true, false);
  body_->setLinearDamping(0.0);
  body_->setAngularDamping(0.0);
  body_->setUseGyroTerm(true);
  body_->setMaxCoordinateVelocity(1e30);
  std::vector<PrincipalFrame> frame(n);
  for (int i = 0; i < n; ++i) {
    const HandLink& l = hand.links[i];
    frame[i] = principal(l);
    Eigen::Matrix3d parent_frame = Eigen::Matrix3d::Identity();
    Eigen::Vector3d parent_com = Eigen::Vector3d::Zero();
    if (l.parent >= 0) {
      parent_frame = frame[l.parent].in_link;
      parent_com = hand.links[l.parent].com_m;
    }
    const Eigen::Matrix3d turn =
        (parent_frame.transpose() * l.parent_to_link.rotation * frame[i].in_link).transpose();
    const btVector3 pivot =
        bt(parent_frame.transpose() * (l.parent_to_link.translation_m - parent_com));
    const btVector3 com = bt(frame[i].in_link.transpose() * l.com_m);
    const btVector3 axis = bt(frame[i].in_link.transpose() * l.axis);
    const btVector3 moments = bt(frame[i].moments);
    if (l.type == JointType::kFixed || l.joint < 0) {
      body_->setupFixed(i, l.mass_kg, moments, l.parent, btTurn(turn), pivot, com);
    } else if (l.type == JointType::kRevolute) {
      body_->setupRevolute(i, l.mass_kg, moments, l.parent, btTurn(turn), axis, pivot, com, true);
    } else {
      body_->setupPrismatic(i, l.mass_kg, moments, l.parent, btTurn(turn), axis, pivot, com, true);
    }
  }
  body_->finalizeMultiDof();
}

BulletTwin::~BulletTwin() = default;

void BulletTwin::setState(const JointPosition& theta, const JointVelocity& theta_dot) {
  for (int i = 0; i < body_->getNumLinks(); ++i) {
    const int joint = hand_->links[i].joint;
    if (body_->getLink(i).m_dofCount == 0) continue;
    body_->setJointPos(i, theta[joint]);
    body_->setJointVel(i, theta_dot[joint]);
  }
  btAlignedObjectArray<btQuaternion> rotations;
  btAlignedObjectArray<btVector3> origins;
  body_->forwardKinematics(rotations, origins);
}

Eigen::VectorXd BulletTwin::acceleration(const JointEffort& torque,
                                         const Eigen::Vector3d& gravity_m_s2) {
  body_->clearForcesAndTorques();
  Eigen::VectorXd before(hand_->joint_count);
  for (int i = 0; i < body_->getNumLinks(); ++i) {
    body_->addLinkForce(i, bt(gravity_m_s2) * body_->getLinkMass(i));
    if (body_->getLink(i).m_dofCount == 0) continue;
    body_->addJointTorque(i, torque[hand_->links[i].joint]);
    before[hand_->links[i].joint] = body_->getJointVel(i);
  }
  btAlignedObjectArray<btScalar> reals;
  btAlignedObjectArray<btVector3> vectors;
  btAlignedObjectArray<btMatrix3x3> matrices;
  // A "step" of 1 s adds the acceleration to the velocities, which are restored afterwards.
  body_->computeAccelerationsArticulatedBodyAlgorithmMultiDof(1.0, reals, vectors, matrices, false,
                                                              false, false);
  Eigen::VectorXd out(hand_->joint_count);
  for (int i = 0; i < body_->getNumLinks(); ++i) {
    if (body_->getLink(i).m_dofCount == 0) continue;
    const int joint = hand_->links[i].joint;
    out[joint] = body_->getJointVel(i) - before[joint];
    body_->setJointVel(i, before[joint]);
  }
  return out;
}

Eigen::VectorXd BulletTwin::inverseInertiaColumn(int joint) {
  // This call uses only what the articulated-body pass has cached, so the pass must have run in
  // this posture.
  (void)acceleration(JointEffort(hand_->joint_count), Eigen::Vector3d::Zero());
  std::vector<double> force(6 + body_->getNumDofs(), 0.0), output(6 + body_->getNumDofs(), 0.0);
  for (int i = 0; i < body_->getNumLinks(); ++i) {
    if (body_->getLink(i).m_dofCount == 1 && hand_->links[i].joint == joint) {
      force[6 + body_->getLink(i).m_dofOffset] = 1.0;
    }
  }
  btAlignedObjectArray<btScalar> reals;
  btAlignedObjectArray<btVector3> vectors;
  body_->calcAccelerationDeltasMultiDof(force.data(), output.data(), reals, vectors);
  Eigen::VectorXd out(hand_->joint_count);
  for (int i = 0; i < body_->getNumLinks(); ++i) {
    if (body_->getLink(i).m_dofCount == 0) continue;
    out[hand_->links[i].joint] = output[6 + body_->getLink(i).m_dofOffset];
  }
  return out;
}

Eigen::Vector3d BulletTwin::linkCom(int link) const {
  const btVector3 p = body_->localPosToWorld(link, btVector3(0, 0, 0));
  return {p.x(), p.y(), p.z()};
}

}  // namespace wholehand::test
