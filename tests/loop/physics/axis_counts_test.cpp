// Devices of one to sixteen axes: the solver has a width for up to eight axes and one for more.
#include "loop/physics/body_yard.hpp"
#include "support/figure.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

namespace wholehand::test {
namespace {

using Eigen::Vector3d;

/// The shipped hand on a device of so many axes: its first axes; with more than six, each axis
/// but the first three moves one joint of a digit by itself. Without self-contacts and ends, whose
/// impulses contacts do not show.
HandModel handOfAxes(int axes, std::mt19937_64& random) {
  HandModel model = handNamed();
  model.self_contacts.clear();
  for (HandLink& link : model.links) link.lower = -10.0, link.upper = 10.0;
  std::vector<int> joints;
  for (int i = model.palm_link + 1; i < static_cast<int>(model.links.size()); ++i) {
    if (model.links[i].joint >= 0) joints.push_back(model.links[i].joint);
  }
  std::shuffle(joints.begin(), joints.end(), random);
  const JointAxisMatrix shipped = model.synergy;
  const int known = axes <= model.axis_count ? axes : 3;
  model.synergy = JointAxisMatrix::Zero(model.joint_count, axes);
  const AxisPosition lower = model.axis_lower, upper = model.axis_upper;
  model.axis_count = axes;
  model.axis_names.resize(axes, "further");
  model.reference = model.axis_lower = model.axis_upper = AxisPosition(axes);
  for (int a = 0; a < axes; ++a) {
    if (a < known) {
      model.synergy.col(a) = shipped.col(a);
    } else {
      model.synergy(joints[a - known], a) = 1.0;
    }
    model.axis_lower[a] = a < known ? lower[a] : -1.0;
    model.axis_upper[a] = a < known ? upper[a] : 1.0;
  }
  return model;
}

/// A hand that pushes what stands before its fingers, by an effort on each axis.
/// @return largest miss of q̇' − q̇ = T M_r⁻¹ (f_s + virtual work of the contacts), of the largest
/// change
double missOfPush(int axes, std::mt19937_64& random, int& touched) {
  const HandModel model = handOfAxes(axes, random);
  const Vector3d along = Vector3d::UnitX();
  const double radius_m = uniform(random, 0.02, 0.1);
  const double at_m = reach(model, AxisPosition(axes), along) + radius_m + 1e-4;
  SceneModel scene = weightless({bodyOf(roundShape(ShapeType::kSphere, radius_m, 0.0), at_m * along,
                                        logUniform(random, 0.02, 2.0), 0.5)});
  const auto world = orThrow(buildWorld("bullet", model, scene));
  EXPECT_TRUE(world->placeHand(AxisPosition(axes)));
  ArticulatedBody body(model);
  auto record = std::make_unique<TickRecord>();
  double off = 0.0, most = 0.0;
  for (int k = 0; k < 60; ++k) {
    const PhysicsState before = look(*world);
    if (!body.update(before.theta, before.theta_dot, scene.gravity_m_s2)) return kInfinity;
    AxisEffort f_s(axes);
    for (int a = 0; a < axes; ++a) {
      f_s[a] = body.reducedInertia()(a, a) * (a == 0 ? 5.0 : uniform(random, -0.5, 0.5));
    }
    HandDrive drive;
    drive.effort = f_s;
    body.distribute(f_s, drive.torque);
    drive.reduced_inertia_inverse = &body.reducedInertiaInverse();
    EXPECT_EQ(world->step(drive, kPeriod_s) & kStoppingFaults, Fault::kNone);
    ContactList touching;
    world->contacts(touching);
    record->contact_count = touching.count;
    std::copy_n(touching.points.begin(), touching.count, record->contacts.begin());
    const AxisEffort work = virtualWork(model, before.q_s, *record);
    const Eigen::VectorXd gained =
        kPeriod_s * body.reducedInertiaInverse() * (f_s.vec() + work.vec());
    const Eigen::VectorXd changed = look(*world).qd_s.vec() - before.qd_s.vec();
    off = std::max(off, (changed - gained).cwiseAbs().maxCoeff());
    most = std::max(most, changed.cwiseAbs().maxCoeff());
    touched += work.vec().norm() > 0.01 ? 1 : 0;
  }
  return off / most;
}

TEST(AxisCounts, HandsOfOneToSixteenAxes_MoveByTheVirtualWorkOfTheirContacts) {
  std::mt19937_64 random(seed());
  double worst = 0.0;
  for (int i = 0; i < std::max(3, cases(30)); ++i) {
    const int axes = i == 0 ? 1 : i == 1 ? kMaxAxes : 1 + static_cast<int>(random() % kMaxAxes);
    int touched = 0;
    const double off = missOfPush(axes, random, touched);
    EXPECT_GT(touched, 0) << axes << " axes";
    EXPECT_LE(off, tolerance(1e-6)) << axes << " axes";
    worst = std::max(worst, off);
  }
  figure("hands of 1 to 16 axes, change of velocity off its virtual work, worst", worst, "");
}

}  // namespace
}  // namespace wholehand::test
