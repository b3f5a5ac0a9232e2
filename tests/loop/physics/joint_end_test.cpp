// Joint ends: a joint of the hand file stays within its range, and the force of its end is
// rendered.
#include "loop/physics/physics_world.hpp"
#include "support/rig_tools.hpp"
#include "support/tolerance.hpp"

#include <cmath>

namespace wholehand::test {
namespace {

struct End {
  int axis;
  double at;      ///< end of the joint's range, on the axis [rad]
  double beyond;  ///< the person's target beyond it, within the device's margin [rad]
};
// lambda-pride with the median hand: fingers and circumduction begin, and circumduction ends, where
// their joints do (0 and π/2 in both files). The other joints end beyond the device's travel.
constexpr std::array<End, 3> kEnds{{{3, 0.0, -0.02}, {4, 0.0, -0.02}, {4, 1.5708, 1.5908}}};

TEST(JointEnd, PressedAgainst_HoldsAndRendersTheSpring) {
  double off_rad = 0.0, off_share = 0.0;
  for (const End& end : kEnds) {
    SCOPED_TRACE(testing::Message() << "axis " << end.axis << " at " << end.at);
    Models m = load(shippedFiles());
    m.scene.gravity_m_s2.setZero();
    const auto rig = buildScripted(std::move(m), [&](int read) {
      const double u = std::min(1.0, read / 300.0);
      AxisPosition q(6);
      q[3] = 0.4, q[4] = 0.5, q[5] = 0.3;
      q[end.axis] += u * (end.beyond - q[end.axis]);
      return q;
    });
    ASSERT_TRUE(rig->renderer->arm());
    const auto last = runTicks(*rig->renderer, 2000);
    EXPECT_EQ(last->faults & kStoppingFaults, Fault::kNone);
    const double k_pm = rig->gains.k_pm[end.axis];
    const double felt = k_pm * (end.at - end.beyond);  // K_pm e
    off_rad = std::max(off_rad, std::abs(last->q_s[end.axis] - end.at));
    off_share = std::max(off_share, std::abs(last->coupling[end.axis] - felt) / std::abs(felt));
    SelfForces forces;
    rig->world->selfForces(forces);
    EXPECT_NEAR(forces.joint_ends[end.axis], felt, tolerance(1e-3) * std::abs(felt));
    for (int a = 0; a < 6; ++a) {
      if (a == end.axis) continue;
      EXPECT_NEAR(last->coupling[a], 0.0, tolerance(1e-6));
    }
  }
  figure("pressed against a joint's end: off the end", off_rad, "rad");
  figure("pressed against a joint's end: felt over K_pm e, less 1", off_share, "");
  EXPECT_LE(off_rad, tolerance(1e-4));
  EXPECT_LE(off_share, tolerance(1e-3));
}

TEST(JointEnd, BallThatPressesAFingerAgainstIt_IsCarriedAndHoldsTheArm) {
  // A fixed ball in front of the tip of the stretched middle finger; the arm presses 8 mm into it.
  Models m = load(shippedFiles());
  m.scene.gravity_m_s2.setZero();
  AxisPosition open(6);
  open[4] = 0.5;
  const Capsule& tip = *std::find_if(m.hand.capsules.begin(), m.hand.capsules.end(),
                                     [](const Capsule& c) { return c.name == "middle_distal"; });
  const Eigen::Vector3d at_m = handAt(m.hand, open).linkPose(tip.link) * tip.b_m;
  m.scene.bodies = {ball(at_m + Eigen::Vector3d(0.0, tip.radius_m + 0.022, 0.0), 0.02, 0.0)};
  const auto rig = buildScripted(std::move(m), [&](int read) {
    AxisPosition q = open;
    q[1] = 0.010 * std::min(1.0, read / 500.0);
    return q;
  });
  ASSERT_TRUE(rig->renderer->arm());
  const auto last = runTicks(*rig->renderer, 3000);
  SelfForces forces;
  rig->world->selfForces(forces);
  EXPECT_GT(forces.joint_ends[3], 0.01) << "the fingers' ends bear something";
  EXPECT_NEAR(last->q_s[3], 0.0, tolerance(1e-4));
  EXPECT_LT(last->coupling[1], -1.0) << "the arm is held";
  // The rendered effort of every axis is the virtual work of the ball and the joint ends together.
  const ArticulatedBody body = handAt(rig->models.hand, last->q_s);
  double worst = 0.0;
  std::array<double, kMaxAxes> acted{};
  for (int i = 0; i < last->contact_count; ++i) {
    const Contact& c = last->contacts[i];
    std::array<double, kMaxAxes> force{}, torque{};
    body.reducedPointRow(c.link, c.point_m.eigen(), c.force_n.eigen(), force.data());
    body.reducedAngularRow(c.link, c.torque_nm.eigen(), torque.data());
    for (int a = 0; a < 6; ++a) acted[a] += force[a] + torque[a];
  }
  for (int a = 0; a < 6; ++a) {
    const double lever_m = a < 3 ? 1.0 : 0.08;  // in newtons at the fingertip
    const double off = last->coupling[a] - acted[a] - forces.joint_ends[a];
    worst = std::max(worst, std::abs(off) / lever_m / std::abs(last->coupling[1]));
  }
  figure("finger pressed against its end: felt against virtual work, share", worst, "");
  EXPECT_LE(worst, tolerance(0.02));
}

TEST(JointEnd, NearestOfSeveralJoints_StopsTheirAxis) {
  // The MCP of the index may only reach 0.3 rad: 0.375 of the fingers' axis, so 0.8 rad of the
  // axis.
  Models m = load(shippedFiles());
  m.scene.gravity_m_s2.setZero();
  for (HandLink& link : m.hand.links) {
    if (link.name == "index_mcp_flexion") link.upper = 0.3;
  }
  const auto rig = buildScripted(std::move(m), [](int read) {
    AxisPosition q(6);
    q[3] = 0.9 * std::min(1.0, read / 300.0);
    return q;
  });
  ASSERT_TRUE(rig->renderer->arm());
  EXPECT_NEAR(runTicks(*rig->renderer, 2000)->q_s[3], 0.3 / 0.375, tolerance(1e-4));
}

TEST(BaseEnd, BarThatTurnsTheHandAgainstIt_KeepsItInTheCertifiedRange) {
  // A fixed bar is under the stretched little finger's tip, 0.15 m in front of the wrist; the arm
  // comes down by 0.16 m. A spring of 0.8 N·m/rad alone would let the hand turn far beyond its
  // range.
  Models m = load(shippedFiles("wrist-9axis"));
  m.scene.gravity_m_s2.setZero();
  const int pitch = m.device.axisIndex("pitch"), z = m.device.axisIndex("z");
  AxisPosition open(m.device.axisCount());
  open[m.device.axisIndex("thumb_circumduction")] = 0.5;
  open[z] = 0.08;
  const Capsule& tip = *std::find_if(m.hand.capsules.begin(), m.hand.capsules.end(),
                                     [](const Capsule& c) { return c.name == "little_distal"; });
  const Eigen::Vector3d at_m = handAt(m.hand, open).linkPose(tip.link) * tip.b_m;
  m.scene.bodies = {
      fixedBox(at_m - Eigen::Vector3d(0.0, 0.0, tip.radius_m + 0.022), {0.04, 1.0, 0.04})};
  const double lower = m.device.axes[pitch].lower;
  const double upper = m.device.axes[pitch].upper;
  const auto rig = buildScripted(std::move(m), [&](int read) {
    AxisPosition q = open;
    q[z] = 0.08 - 0.16 * std::min(1.0, read / 800.0);
    return q;
  });
  const auto armed = rig->renderer->arm();
  ASSERT_TRUE(armed) << format(armed.errors());
  double furthest = 0.0, fastest_late = 0.0;
  runTicks(*rig->renderer, 3000, [&](const TickRecord& r) {
    ASSERT_EQ(r.faults & kStoppingFaults, Fault::kNone) << r.tick;
    furthest = std::max({furthest, r.q_s[pitch] - upper, lower - r.q_s[pitch]});
    if (r.tick > 2500) fastest_late = std::max(fastest_late, std::abs(r.qd_s[pitch]));
  });
  figure("wrist turned by a bar: beyond the device's range", furthest, "rad");
  // kBeyondRange_rad of hand_rows.cpp.
  EXPECT_LE(furthest, 0.1 + tolerance(1e-3));
  EXPECT_GT(furthest, 0.05) << "it was not turned that far";
  EXPECT_LT(fastest_late, 0.01) << "it does not come to rest";
}

}  // namespace
}  // namespace wholehand::test
