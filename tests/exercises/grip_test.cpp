// Decides which contacts on a dispenser are a grip. Postures and normals come from grasps of
// virtual patients at the bar; a left hand has the mirror image in y.
#include "loop/exercise/grip.hpp"

#include "exercises/bar_table.hpp"
#include "files/hand/hand_file.hpp"
#include "support/constants.hpp"
#include "support/tolerance.hpp"

namespace wholehand::test {
namespace {

const HandModel& hand(Side side) {
  static const HandModel left =
      assembleHand(loadHandFile(config("hands/adult-median-left.toml")).value(), shippedDevice())
          .value();
  return side == Side::kLeft ? left : shippedHand();
}

/// A hand in a posture.
struct PosedHand {
  explicit PosedHand(const HandModel& model) : body(model), posture(model) {}
  void pose(const AxisPosition& q_s) {
    body.updateKinematics(postureOf(body.hand(), q_s));
    posture.update(&body);
  }
  ArticulatedBody body;
  HandPosture posture;
};

struct Touch {
  std::string capsule;
  Vec3 normal;  ///< from the dispenser to the hand
  double force_n = 0.0;
};

double grip_n(Side side, double fingers_rad, double turn_rad, double thumb_rad,
              const std::vector<Touch>& touches) {
  PosedHand posed(hand(side));
  AxisPosition q_s(6);
  q_s[3] = fingers_rad, q_s[4] = turn_rad, q_s[5] = thumb_rad;
  posed.pose(q_s);
  TickRecord record;
  for (const Touch& t : touches) {
    Contact& c = record.contacts[record.contact_count++];
    c.body = 3;
    c.capsule = BarTable::capsuleOf(t.capsule);
    const double flip = side == Side::kLeft ? -1.0 : 1.0;
    const Eigen::Vector3d n =
        Eigen::Vector3d(t.normal.x, flip * t.normal.y, t.normal.z).normalized();
    c.normal = Vec3::from(n);
    c.force_n =
        Vec3::from(t.force_n * n + 0.3 * Eigen::Vector3d::UnitZ().cross(n));  // includes friction
  }
  EXPECT_EQ(gripForce_n(record, 2, posed.posture), 0.0);  // another body
  return gripForce_n(record, 3, posed.posture);
}

class Grip : public testing::TestWithParam<Side> {};

TEST_P(Grip, FingersThumbAndPalm_GiveTheSumOfNormalForces) {
  const std::vector<Touch> touches = {{"thumb_proximal", {-0.92, 0.10, 0.37}, 1.7},
                                      {"hypothenar_edge", {-0.11, -0.99, 0.01}, 3.0},
                                      {"little_distal", {0.75, 0.65, -0.11}, 3.2},
                                      {"index_distal", {0.81, 0.57, -0.12}, 1.9}};
  EXPECT_NEAR(grip_n(GetParam(), 2.28, 20.0 * kDeg, 0.44, touches), 9.8, tolerance(1e-12));
}

TEST_P(Grip, FingersAgainstThePalmAlone_GiveTheSumOfNormalForces) {
  const std::vector<Touch> touches = {{"hypothenar_edge", {-0.11, -0.99, 0.01}, 5.0},
                                      {"little_distal", {0.75, 0.65, -0.11}, 3.2},
                                      {"index_distal", {0.81, 0.57, -0.12}, 1.9}};
  EXPECT_NEAR(grip_n(GetParam(), 2.28, 0.0, 0.0, touches), 10.1, tolerance(1e-12));
}

TEST_P(Grip, PinchOfThumbAndOneFinger_GivesTheSumOfNormalForces) {
  const std::vector<Touch> pinch = {{"thumb_proximal", {-0.92, -0.28, 0.28}, 3.5},
                                    {"index_distal", {0.94, 0.18, -0.28}, 3.9}};
  EXPECT_NEAR(grip_n(GetParam(), 2.28, 20.0 * kDeg, 0.0, pinch), 7.4, tolerance(1e-12));
}

TEST_P(Grip, FlatHandThatLeans_IsNoGrip) {
  const std::vector<Touch> touches = {{"hollow", {0.0, -1.0, 0.0}, 8.0},
                                      {"pad_ulnar", {0.5, -0.87, 0.0}, 4.0},
                                      {"middle_proximal", {-0.5, -0.87, 0.0}, 4.0}};
  EXPECT_EQ(grip_n(GetParam(), 0.0, 0.0, 0.0, touches), 0.0);
}

TEST_P(Grip, BackOfHandAgainstBackOfFingers_IsNoGrip) {
  // The two face each other, but neither faces the palm.
  const std::vector<Touch> touches = {{"metacarpal_3", {0.0, 1.0, 0.0}, 8.0},
                                      {"middle_distal", {0.0, -1.0, 0.0}, 8.0}};
  EXPECT_EQ(grip_n(GetParam(), 3.14, 0.0, 0.0, touches), 0.0);
}

TEST_P(Grip, SidesOfAFinger_AreNoGrip) {
  const std::vector<Touch> touches = {{"index_middle", {0.0, 0.0, 1.0}, 8.0},
                                      {"index_middle", {0.0, 0.0, -1.0}, 8.0}};
  for (const double fingers_rad : {0.0, 1.0, 2.0, 3.0}) {
    EXPECT_EQ(grip_n(GetParam(), fingers_rad, 0.0, 0.0, touches), 0.0);
  }
}

TEST_P(Grip, ArmThatPushesOnALightFinger_CountsFiveTimesTheFingersForce) {
  const std::vector<Touch> touches = {{"hollow", {0.0, -1.0, 0.0}, 30.0},
                                      {"middle_distal", {0.0, 1.0, 0.0}, 0.4}};
  EXPECT_NEAR(grip_n(GetParam(), 3.14, 0.0, 0.0, touches), 5 * 0.4, tolerance(1e-12));
}

TEST_P(Grip, UnknownPosture_IsNoGrip) {
  HandPosture posture(hand(GetParam()));
  TickRecord record;
  record.contact_count = 2;
  for (std::size_t i = 0; i < 2; ++i) {
    record.contacts[i].body = 3;
    record.contacts[i].capsule = static_cast<std::int32_t>(i);
    record.contacts[i].normal = {0.0, i == 0 ? 1.0 : -1.0, 0.0};
    record.contacts[i].force_n = record.contacts[i].normal;
  }
  EXPECT_EQ(gripForce_n(record, 3, posture), 0.0);
  EXPECT_EQ(posture.clearance_m({1.0, 1.0, 1.0}, 0.02, 0.1), 0.0);
}
INSTANTIATE_TEST_SUITE_P(Hands, Grip, testing::Values(Side::kRight, Side::kLeft));

/// -∂(f·x)/∂q of a material point of a capsule's link: the effort of f on the axis, by a central
/// difference of the kinematics.
double heldBack(const HandModel& model, const AxisPosition& q_s, int axis, const Contact& c) {
  constexpr double kStep = 1e-5;
  const auto work = [&](double step) {
    ArticulatedBody at(model), moved(model);
    AxisPosition q = q_s;
    q[axis] += step;
    at.updateKinematics(postureOf(model, q_s));
    moved.updateKinematics(postureOf(model, q));
    const int link = model.capsules[c.capsule].link;
    const Eigen::Vector3d local = at.linkPose(link).inverse() * c.point_m.eigen();
    return c.force_n.eigen().dot(moved.linkPose(link) * local);
  };
  return -(work(kStep) - work(-kStep)) / (2.0 * kStep);
}

FingerWallConfig wallsOf(const DeviceModel& device) {
  FingerWallConfig walls;
  walls.axes = device.axisCount();
  walls.lever_arm_m = AxisLength(walls.axes, 1.0);
  walls.stiffness = AxisStiffness(walls.axes);
  for (const int a : {3, 5}) walls.stiffness[a] = 0.64, walls.lever_arm_m[a] = 0.08;
  return walls;
}

/// Fingertips press a bottle against the palm: contacts, and a wall on the fingers' axis.
struct HeldBottle {
  AxisPosition q_s{6};
  TickRecord record;
  FeltBody felt;
  PosedHand posed{shippedHand()};
  AxisEffort limit{6, 0.8};

  HeldBottle() {
    q_s[3] = 2.28, q_s[4] = 20.0 * kDeg;
    posed.pose(q_s);
    add("middle_distal", {0.78, 0.61, -0.12}, 3.0);
    add("hypothenar_edge", {-0.11, -0.99, 0.01}, 2.5);
    felt.body = 3;
  }
  void add(const std::string& capsule, const Eigen::Vector3d& normal, double force_n) {
    ArticulatedBody at(shippedHand());
    at.updateKinematics(postureOf(shippedHand(), q_s));
    Contact& c = record.contacts[record.contact_count++];
    c.body = 3;
    c.capsule = BarTable::capsuleOf(capsule);
    const Capsule& its = shippedHand().capsules[c.capsule];
    c.point_m = Vec3::from(at.linkPose(its.link) * its.b_m);
    c.normal = Vec3::from(normal.normalized());
    c.force_n = Vec3::from(force_n * normal.normalized() + Eigen::Vector3d(0.0, 0.0, 0.4));
  }
  void wall(double tip_n, const Eigen::Vector3d& normal) {
    felt.wall = AxisEffort(6);
    felt.wall[3] = -0.08 * tip_n;
    felt.touches[3] = {true, 0.004, normal.normalized()};
  }
  [[nodiscard]] double squeeze_n() const {
    return feltSqueeze_n(record, felt, posed.posture, wallsOf(shippedDevice()), limit);
  }
};

TEST(FeltSqueeze, Contacts_GiveTheirVirtualWorkAtTheFingertip) {
  const HeldBottle held;
  const double tip_n = heldBack(shippedHand(), held.q_s, 3, held.record.contacts[0]) / 0.08;
  EXPECT_GT(tip_n, 0.5);
  EXPECT_NEAR(held.squeeze_n(), tip_n, 1e-6);
}

TEST(FeltSqueeze, LiquidAlone_GivesTheWallsEffortAtTheFingertip) {
  HeldBottle held;
  held.record.contacts[0].body = 2;  // the core is not touched
  EXPECT_EQ(held.squeeze_n(), 0.0);
  held.wall(1.7, {0.78, 0.61, -0.12});
  EXPECT_NEAR(held.squeeze_n(), 1.7, tolerance(1e-12));
  held.limit[3] = 0.08;  // the device can give 1 N at the tip
  EXPECT_NEAR(held.squeeze_n(), 1.0, tolerance(1e-12));
}

TEST(FeltSqueeze, WallAndContacts_AreAdded) {
  HeldBottle held;
  const double contact_n = held.squeeze_n();
  held.wall(1.7, {0.78, 0.61, -0.12});
  EXPECT_NEAR(held.squeeze_n(), 1.7 + contact_n, 1e-9);
}

TEST(FeltSqueeze, DigitWithoutCounterforce_GivesNone) {
  HeldBottle held;
  held.record.contact_count = 0;
  held.wall(5.0, {0.78, 0.61, -0.12});
  EXPECT_EQ(held.squeeze_n(), 0.0);
}

TEST(FeltSqueeze, FlatFingersOnThePalmsSide_GiveNone) {
  HeldBottle held;
  held.record.contacts[0].body = 2;
  held.wall(5.0, {-0.5, -0.87, 0.0});
  EXPECT_EQ(held.squeeze_n(), 0.0);
}

TEST(FeltSqueeze, DigitThatTouchesWithItsBack_GivesNone) {
  HeldBottle held;
  held.record.contacts[0].body = 2;
  held.wall(5.0, {0.78, 0.61, -0.12});
  held.felt.touches[3].palmar_depth_m = 0.0;
  EXPECT_EQ(held.squeeze_n(), 0.0);
}

TEST(SoftTouches, HandAroundACylinder_HasThoseThatPressByClosing) {
  const HandModel& model = shippedHand();
  PosedHand posed(model);
  AxisPosition q(6);
  BodyState body;
  body.position_m = {0.049, 0.041, 0.004};
  const auto touches = [&](double fingers_rad) {
    q[3] = fingers_rad;
    posed.pose(q);
    return posed.posture.softTouches(body, 0.025, 0.2);
  };
  EXPECT_FALSE(touches(0.2)[3].presses);
  bool pressed = false;
  for (double fingers_rad = 0.2; fingers_rad < 2.4; fingers_rad += 0.02) {
    const SoftTouch touch = touches(fingers_rad)[3];
    pressed = pressed || touch.presses;
    EXPECT_EQ(touch.palmar_depth_m > 0.0, touch.presses) << fingers_rad;
    if (touch.presses) {
      EXPECT_NEAR(touch.palmar_normal.norm(), 1.0, 1e-9);
      EXPECT_NEAR(touch.palmar_normal.z(), 0.0, 1e-9);  // from the side
    }
  }
  EXPECT_TRUE(pressed);
  // The back of a straight finger: opening would press, closing moves away.
  body.position_m = {0.12, -0.03, 0.004};
  EXPECT_FALSE(touches(0.0)[3].presses);
}

/// Compared with random points on the surfaces of the capsules and the cylinder.
TEST(HandClearance, Dispenser_IsNeverFartherThanTheDistanceOfAnyTwoPoints) {
  const HandModel& model = hand(Side::kRight);
  PosedHand posed(model);
  posed.pose(AxisPosition(6));
  const ArticulatedBody& body = posed.body;
  for (int i = 0; i < 200; ++i) {
    const double angle = 0.7 * i;
    const Eigen::Vector3d center(0.15 * std::cos(angle), 0.15 * std::sin(angle), 1e-3 * (i - 100));
    double least_m = 1e3;
    for (const Capsule& c : model.capsules) {
      for (int u = 0; u <= 20; ++u) {
        const Eigen::Vector3d at =
            body.linkPose(c.link) * Eigen::Vector3d(c.a_m + 0.05 * u * (c.b_m - c.a_m)) - center;
        const double z = std::clamp(at.z(), -0.06, 0.06);
        least_m = std::min(least_m, (at - Eigen::Vector3d(0, 0, z)).norm() - c.radius_m - 0.025);
      }
    }
    const double clear_m = posed.posture.clearance_m(center, 0.025, 0.12);
    EXPECT_LE(clear_m, least_m + 1e-12);
    EXPECT_GE(clear_m, least_m - 1.5e-3);  // 20 steps along a capsule of 60 mm
  }
}

}  // namespace
}  // namespace wholehand::test
