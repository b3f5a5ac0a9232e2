#include "picture/skin_field.hpp"

#include "dynamics/articulated_body.hpp"
#include "model/device_model.hpp"
#include "model/hand_file.hpp"
#include "picture/sleeve.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace wholehand {
namespace {

using Eigen::Vector3d;

constexpr double kMm = 1e-3;
constexpr double kDegree = std::numbers::pi / 180.0;

HandModel shippedHand() {
  const std::string config = std::string(WHOLEHAND_SOURCE_DIR) + "/config/";
  const auto file = loadHandFile(config + "hands/adult-median-right.toml");
  const auto device = loadDeviceFile(config + "devices/lambda-pride.toml");
  if (!file.ok() || !device.ok()) throw std::runtime_error("the shipped files do not load");
  return assembleHand(*file, *device).value();
}

/// The hand with its fingers and its thumb bent.
std::vector<Pose> posed(const HandModel& hand, double fingers_deg, double turn_deg,
                        double thumb_deg) {
  AxisPosition q(hand.axis_count);
  for (int i = 0; i < hand.axis_count; ++i) {
    const std::string& name = hand.axis_names[static_cast<std::size_t>(i)];
    if (name == "finger_flexion") q[i] = fingers_deg * kDegree;
    if (name == "thumb_circumduction") q[i] = turn_deg * kDegree;
    if (name == "thumb_flexion") q[i] = thumb_deg * kDegree;
  }
  JointPosition theta(hand.joint_count);
  theta.vec() = hand.theta0.vec() + hand.synergy * q.vec();
  ArticulatedBody body(hand);
  body.updateKinematics(theta);
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < hand.links.size(); ++i) {
    poses.push_back(body.linkPose(static_cast<int>(i)));
  }
  return poses;
}

/// Distance to the colliders, straight from the model: segment distance less radius.
double toColliders(const HandModel& hand, const std::vector<Pose>& poses, const Vector3d& p) {
  double least = std::numeric_limits<double>::infinity();
  for (const Capsule& c : hand.capsules) {
    const Pose& pose = poses[static_cast<std::size_t>(c.link)];
    const Vector3d a = pose * c.a_m, ab = pose * c.b_m - a;
    const double t = std::clamp((p - a).dot(ab) / std::max(ab.squaredNorm(), 1e-18), 0.0, 1.0);
    least = std::min(least, (p - a - t * ab).norm() - c.radius_m);
  }
  return least;
}

HandModel twoRods(HandPart first, HandPart second, double gap_m) {
  HandModel hand;
  hand.links.resize(1);
  const double y = 0.008 + 0.5 * gap_m;
  hand.capsules = {{"a", first, 0, {0, y, 0}, {0.04, y, 0}, 0.008},
                   {"b", second, 0, {0, -y, 0}, {0.04, -y, 0}, 0.008}};
  return hand;
}

class SkinOfPosture : public testing::TestWithParam<std::array<double, 3>> {};

// The recipe's promise: what is drawn is what collides, within 0.45 mm out or in (and the rounding
// of that limit), nails included.
TEST_P(SkinOfPosture, SurfacePoints_StayWithinHalfAMillimetreOfTheColliders) {
  const HandModel hand = shippedHand();
  const auto [fingers, turn, thumb] = GetParam();
  const std::vector<Pose> poses = posed(hand, fingers, turn, thumb);
  const SkinField skin(hand, poses);
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::uniform_int_distribution<std::size_t> which(0, hand.capsules.size() - 1);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  double farthest_out = 0.0, farthest_in = 0.0;
  for (int i = 0; i < 6000; ++i) {
    // From a point on a capsule's axis, which is inside, outwards to the skin.
    const Capsule& c = hand.capsules[which(random)];
    const Vector3d axis =
        poses[static_cast<std::size_t>(c.link)] * (c.a_m + unit(random) * (c.b_m - c.a_m));
    const Vector3d way = Vector3d(normal(random), normal(random), normal(random)).normalized();
    double inside = 0.0, outside = 0.3;
    ASSERT_LT(skin.skin(axis), 0.0);
    for (int k = 0; k < 50; ++k) {
      const double middle = 0.5 * (inside + outside);
      (skin.skin(axis + middle * way) < 0.0 ? inside : outside) = middle;
    }
    const double d = toColliders(hand, poses, axis + outside * way);
    farthest_out = std::max(farthest_out, d);
    farthest_in = std::max(farthest_in, -d);
  }
  EXPECT_LE(farthest_out, 0.5 * kMm);
  EXPECT_LE(farthest_in, 0.5 * kMm);
  // And it does use that freedom: a skin that were the bare capsules would show every joint.
  EXPECT_GT(farthest_out, 0.3 * kMm);
}

INSTANTIATE_TEST_SUITE_P(OpenGraspFist, SkinOfPosture,
                         testing::Values(std::array{15.0, 20.0, 0.0}, std::array{130.0, 65.0, 20.0},
                                         std::array{180.0, 80.0, 60.0}));

// Rays step by this distance: were it ever too large, they would jump through a finger. The skin
// itself may lie half a millimetre inside the colliders.
TEST(SkinField, AnywhereAroundTheHand_IsABoundOfTheDistanceToTheSkin) {
  const HandModel hand = shippedHand();
  const std::vector<Pose> poses = posed(hand, 60.0, 40.0, 20.0);
  const SkinField skin(hand, poses);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(-1.0, 1.0);
  for (int i = 0; i < 40000; ++i) {
    const Vector3d p = skin.center() + 0.15 * Vector3d(place(random), place(random), place(random));
    const double truth = toColliders(hand, poses, p);
    if (truth < 0.0) continue;
    ASSERT_LE(skin.skin(p), truth + 0.5 * kMm) << p.transpose();
    ASSERT_GE(skin.skin(p), truth - 3.0 * kMm) << p.transpose();  // and hardly wastes a step
  }
}

TEST(SkinField, RodsOfTwoDigits_StayApart_OfOnePalm_GrowTogether) {
  const Vector3d between(0.02, 0.0, 0.0);
  const std::vector<Pose> here(1);
  const SkinField fingers(twoRods(HandPart::kIndex, HandPart::kMiddle, 0.6 * kMm), here);
  const SkinField palm(twoRods(HandPart::kPalm, HandPart::kPalm, 0.6 * kMm), here);
  // Half the gap, 0.3 mm, closed form; 1.3 micrometres come from the rounding of the limit.
  EXPECT_NEAR(fingers.skin(between), 0.3 * kMm, 0.002 * kMm);
  EXPECT_LT(palm.skin(between), 0.0);  // 0.3 mm is less than the 0.45 mm that skin may fill
}

TEST(SkinField, OneRod_HasTheNormalOfACylinder) {
  HandModel hand = twoRods(HandPart::kIndex, HandPart::kIndex, 0.0);
  hand.capsules.resize(1);
  hand.capsules[0].a_m.y() = hand.capsules[0].b_m.y() = 0.0;
  const SkinField skin(hand, std::vector<Pose>(1));
  const Vector3d radial = Vector3d(0.0, 0.6, 0.8);
  const Vector3d n = skin.lightNormal(Vector3d(0.02, 0.0, 0.0) + 0.008 * radial);
  EXPECT_LT((n - radial).norm(), 0.01);  // half a degree: the field is sampled over 2 mm
}

TEST(Sleeve, OfTheShippedHand_HidesItsEndAndSparesItsSkin) {
  const HandModel hand = shippedHand();
  const std::vector<Pose> poses = posed(hand, 15.0, 20.0, 0.0);
  const Pose& palm = poses[static_cast<std::size_t>(hand.palm_link)];
  const Sleeve sleeve(hand, palm);
  ASSERT_FALSE(sleeve.empty());
  double proximal = std::numeric_limits<double>::infinity();
  for (const Capsule& c : hand.capsules) {
    if (c.link != hand.palm_link) continue;
    proximal = std::min({proximal, c.a_m.x() - c.radius_m, c.b_m.x() - c.radius_m});
    for (double t : {0.0, 0.25, 0.5, 0.75, 1.0}) {
      for (int i = 0; i < 24; ++i) {  // rings around the palm's capsules
        const Vector3d axis = (c.b_m - c.a_m).normalized(), u = axis.unitOrthogonal();
        const double angle = i * 15.0 * kDegree;
        const Vector3d ring = std::cos(angle) * u + std::sin(angle) * axis.cross(u);
        const Vector3d p = palm * (c.a_m + t * (c.b_m - c.a_m) + c.radius_m * ring);
        EXPECT_GT(sleeve.cuff(p), 0.0) << c.name;
      }
    }
  }
  EXPECT_LT(sleeve.cloth(palm * Vector3d(proximal, 0.0, 0.0)), 0.0);
}

}  // namespace
}  // namespace wholehand
