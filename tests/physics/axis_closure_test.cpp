// First touch of a hand axis, against the exact separation of shapes and against closed forms.
#include "physics/axis_closure.hpp"

#include "dynamics/articulated_body.hpp"
#include "dynamics/synergy.hpp"
#include "model/device_model.hpp"
#include "model/hand_file.hpp"
#include "model/separation.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace wholehand::test {
namespace {

HandModel shippedHand() {
  const std::string config = std::string(WHOLEHAND_SOURCE_DIR) + "/config/";
  const auto device = loadDeviceFile(config + "devices/lambda-pride.toml");
  const auto file = loadHandFile(config + "hands/adult-median-right.toml");
  return assembleHand(file.value(), device.value()).value();
}
const HandModel& hand() {
  static const HandModel hand = shippedHand();
  return hand;
}
constexpr int kFingers = 3, kCircumduction = 4, kThumb = 5;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

SceneModel sceneOf(const Shape& shape) {
  SceneModel scene;
  SceneBody& body = scene.bodies.emplace_back();
  body.name = "body";
  body.fixed = true;
  body.com_m = {0.003, -0.002, 0.001};
  body.shapes.push_back(shape);
  return scene;
}

BodyState stateOf(const SceneBody& body, const Pose& pose) {
  BodyState state;
  state.position_m = Vec3::from(pose * body.com_m);
  state.orientation_xyzw = QuatXyzw::from(Eigen::Quaterniond(pose.rotation));
  return state;
}

/// The parts of the hand that an axis is said to move. Webs are skin between the fingers.
bool movedBy(int axis, const Capsule& capsule) {
  const HandPart part = capsule.part;
  if (axis == kFingers && capsule.name.starts_with("web")) return true;
  if (axis == kFingers) return part != HandPart::kPalm && part != HandPart::kThumb;
  return part == HandPart::kThumb;
}

/// A hand that stays, and a body.
struct Still {
  HandModel model = hand();
  SceneModel scene;
  Pose body_pose;
  AxisPosition q{6};
  AxisClosure closure{model, scene};
  ArticulatedBody body{model};
  Synergy synergy{model};

  explicit Still(SceneModel scene_in) : scene(std::move(scene_in)), closure(model, scene) {}

  AxisPosition tick(int target = 0) {
    JointPosition theta;
    synergy.expand(q, theta);
    body.updateKinematics(theta);
    const BodyState state = stateOf(scene.bodies[0], body_pose);
    AxisPosition touch;
    closure.update(&body.linkPose(0), theta, q, target, &state, touch);
    return touch;
  }

  /// The least separation of what `axis` moves from the body, with the axis at `value`.
  double separationAt(int axis, double value) {
    AxisPosition there = q;
    there[axis] = value;
    JointPosition theta;
    synergy.expand(there, theta);
    body.updateKinematics(theta);
    double least_m = kInfinity;
    for (const Capsule& c : model.capsules) {
      // The metacarpal of the thumb may be the palm's: what moves is what another position moves.
      if (!moves_[axis].empty() && !moves_[axis][&c - model.capsules.data()]) continue;
      const Shape form = capsuleShape(c.a_m, c.b_m, c.radius_m);
      for (const Shape& shape : scene.bodies[0].shapes) {
        least_m = std::min(least_m, separation(form, body.linkPose(c.link), shape, body_pose));
      }
    }
    return least_m;
  }

  /// By moving it: which capsules an axis moves.
  void findMoved() {
    for (int axis = kFingers; axis <= kThumb; ++axis) {
      std::vector<bool> moved;
      JointPosition open, closed;
      AxisPosition one(6), other(6);
      other[axis] = 0.5;
      synergy.expand(one, open);
      synergy.expand(other, closed);
      ArticulatedBody a(model), b(model);
      a.updateKinematics(open);
      b.updateKinematics(closed);
      for (const Capsule& c : model.capsules) {
        moved.push_back((a.linkPose(c.link) * c.b_m - b.linkPose(c.link) * c.b_m).norm() > 1e-6);
        EXPECT_TRUE(!moved.back() || movedBy(axis, c)) << c.name;
      }
      moves_[axis] = moved;
    }
  }
  std::array<std::vector<bool>, 6> moves_;
};

Shape cylinder(double radius_m, double length_m) {
  Shape s;
  s.type = ShapeType::kCylinder;
  s.radius_m = radius_m;
  s.length_m = length_m;
  return s;
}
Shape sphere(double radius_m) {
  Shape s;
  s.type = ShapeType::kSphere;
  s.radius_m = radius_m;
  return s;
}
Shape box(const Eigen::Vector3d& half_m) {
  Shape s;
  s.half_extents_m = half_m;
  return s;
}
Shape mesh(const Eigen::Vector3d& half_m) {
  Shape s;
  s.type = ShapeType::kConvexMesh;
  for (int i = 0; i < 8; ++i) {
    s.points_m.emplace_back((i & 1 ? 1 : -1) * half_m.x(), (i & 2 ? 1 : -1) * half_m.y(),
                            (i & 4 ? 0.7 : -1) * half_m.z());
  }
  s.points_m.emplace_back(0.0, 0.0, 1.3 * half_m.z());
  return s;
}

struct Named {
  const char* name;
  Shape shape;
};
void PrintTo(const Named& n, std::ostream* out) {
  *out << n.name;
}

class FirstTouch : public testing::TestWithParam<Named> {};

TEST_P(FirstTouch, OfAHandThatStays_IsFoundWithin50TicksAndIsTheFirst) {
  Still still(sceneOf(GetParam().shape));
  still.scene.bodies[0].shapes[0].in_body.translation_m = {0.01, 0.0, 0.0};
  still.closure = AxisClosure(still.model, still.scene);
  still.findMoved();
  std::mt19937_64 random = seededRandom(31);
  const auto draw = [&](double from, double to) {
    return from + (to - from) * static_cast<double>(random() >> 11U) * 0x1.0p-53;
  };
  int touches = 0, misses = 0, open_ends = 0, slowest = 0;
  double worst_gap_m = 0.0;
  for (int n = 0; n < 50; ++n) {
    // The body anywhere about the palm's hollow, upright or not; the hand anywhere, half closed.
    still.q[0] = draw(-0.08, 0.08), still.q[1] = draw(-0.1, 0.1), still.q[2] = draw(-0.1, 0.1);
    still.q[kFingers] = draw(0.0, 2.5), still.q[kCircumduction] = draw(0.0, 1.5);
    still.q[kThumb] = draw(0.0, 1.3);
    still.body_pose.rotation =
        Eigen::Quaterniond(draw(-1, 1), draw(-1, 1), draw(-1, 1), draw(-1, 1))
            .normalized()
            .toRotationMatrix();
    if (n % 2 == 0) still.body_pose.rotation.setIdentity();
    still.body_pose.translation_m =
        Eigen::Vector3d(still.q[0] + draw(0.02, 0.16), still.q[1] + draw(-0.02, 0.1),
                        still.q[2] + draw(-0.06, 0.08));
    still.closure.reset();
    AxisPosition at50 = still.tick();
    for (int k = 1; k < 50; ++k) at50 = still.tick();
    AxisPosition last = at50;
    for (int k = 0; k < 100; ++k) last = still.tick();
    still.closure.reset();
    for (int k = 1; k <= 50; ++k) {
      const AxisPosition now = still.tick();
      for (int a = kFingers; a <= kThumb; ++a) {
        if (!(std::abs(now[a] - last[a]) < 1e-4 || (std::isnan(now[a]) && std::isnan(last[a]))))
          slowest = std::max(slowest, k);
      }
    }
    for (int a = kFingers; a <= kThumb; ++a) {
      SCOPED_TRACE(still.model.axis_names[a] + ", case " + std::to_string(n));
      const double touch = at50[a];
      EXPECT_EQ(std::isnan(touch), std::isnan(last[a]));
      // 0.1 mm of path, at the lever arm of 8 cm.
      EXPECT_TRUE(std::isnan(touch) || std::abs(touch - last[a]) < 1.25e-3) << touch - last[a];
      const double lower = still.model.axis_lower[a], upper = still.model.axis_upper[a];
      // Nothing overlaps before ...
      const double end = std::isnan(touch) ? upper : touch;
      for (double v = lower; v < end - 1e-5; v += 0.01) {
        ASSERT_GT(still.separationAt(a, v), 0.0) << "at " << v << ", said " << touch;
      }
      // ... and there they meet.
      if (std::isnan(touch)) {
        ++misses;
      } else if (touch == lower) {
        ++open_ends;
        EXPECT_LE(still.separationAt(a, lower), 1e-6);
      } else {
        ++touches;
        const double gap_m = std::abs(still.separationAt(a, touch));
        worst_gap_m = std::max(worst_gap_m, gap_m);
        EXPECT_LE(gap_m, tolerance(2e-6));
      }
    }
  }
  std::printf(
      "figure: %s: %d touches, %d never, %d open ends; slowest %d ticks, worst gap %.2g um\n",
      GetParam().name, touches, misses, open_ends, slowest, worst_gap_m * 1e6);
  EXPECT_GT(touches, 15);
  EXPECT_GT(misses, 5);
  EXPECT_GT(open_ends, 0);
}
INSTANTIATE_TEST_SUITE_P(Shapes, FirstTouch,
                         testing::Values(Named{"bottle", cylinder(0.025, 0.2)},
                                         Named{"disk", cylinder(0.04, 0.02)},
                                         Named{"box", box({0.02, 0.03, 0.04})},
                                         Named{"sphere", sphere(0.03)},
                                         Named{"mesh", mesh({0.03, 0.025, 0.035})}));

/// A palm with one finger of one bone, 8 cm long and 1 cm thick, that turns about z from 0 on.
HandModel oneFinger() {
  HandModel model;
  model.links.resize(2);
  model.links[0].name = "palm";
  model.links[1].name = "finger";
  model.links[1].parent = 0;
  model.links[1].type = JointType::kRevolute;
  model.links[1].axis = Eigen::Vector3d::UnitZ();
  model.links[1].joint = 0;
  model.capsules.push_back({"finger", HandPart::kIndex, 1, {0, 0, 0}, {0.08, 0, 0}, 0.005});
  model.joint_count = model.axis_count = 1;
  model.theta0 = JointPosition(1);
  model.synergy = JointAxisMatrix::Constant(1, 1, 0.5);  // half a radian per radian of the axis
  model.axis_lower = AxisPosition(1, -0.2);
  model.axis_upper = AxisPosition(1, 6.0);
  return model;
}

double touchOfOneFinger(const Eigen::Vector3d& ball_m, double radius_m) {
  const HandModel model = oneFinger();
  SceneModel scene = sceneOf(sphere(radius_m));
  scene.bodies[0].com_m.setZero();
  AxisClosure closure(model, scene);
  const std::array<Pose, 2> links{};
  BodyState state;
  state.position_m = Vec3::from(ball_m);
  AxisPosition touch;
  // The axis stands somewhere; where it is kinematically closed does not depend on that.
  for (int k = 0; k < 50; ++k) {
    closure.update(links.data(), JointPosition(1, 0.35), AxisPosition(1, 0.7), 0, &state, touch);
  }
  return touch[0];
}

TEST(FirstTouchOfOneFinger, WithABall_IsTheClosedForm) {
  const auto at = [](double distance_m, double angle_rad) {
    return Eigen::Vector3d(distance_m * std::cos(angle_rad), distance_m * std::sin(angle_rad), 0.0);
  };
  // Beside the bone: at the angle under which the sum of the radii is seen from the joint.
  const double beside = 1.5 - std::asin((0.02 + 0.005) / 0.06);
  EXPECT_NEAR(touchOfOneFinger(at(0.06, 1.5), 0.02), 2.0 * beside, tolerance(1e-6));
  // Before the tip: the triangle of joint, tip and ball has the sides 0.08, 0.1 and 0.025.
  const double tip = std::acos((0.08 * 0.08 + 0.1 * 0.1 - 0.025 * 0.025) / (2.0 * 0.08 * 0.1));
  EXPECT_NEAR(touchOfOneFinger(at(0.1, 1.5), 0.02), 2.0 * (1.5 - tip), tolerance(1e-6));
  // It passes by 1 µm before the tip, and takes 1 µm away from it.
  EXPECT_TRUE(std::isnan(touchOfOneFinger(at(0.08 + 0.025 + 1e-6, 1.5), 0.02)));
  EXPECT_NEAR(touchOfOneFinger(at(0.08 + 0.025 - 1e-6, 1.5), 0.02), 3.0, tolerance(0.05));
  // Beyond the end of travel, and where the open end overlaps.
  EXPECT_TRUE(std::isnan(touchOfOneFinger(at(0.06, 3.0 + 0.43), 0.02)));
  EXPECT_EQ(touchOfOneFinger(at(0.06, 0.2), 0.02), -0.2);
}

/// The hand glides past a bottle at 0.15 m/s; `look` hears of every tick.
void glide(Still& still, int ticks, const std::function<void(const AxisPosition&)>& look) {
  still.body_pose.translation_m = {0.049, 0.041, 0.004};
  still.q[kFingers] = 1.1, still.q[kCircumduction] = 0.35;
  for (int k = 0; k < ticks; ++k) {
    const double turn = 5.0 * k * 1e-3;
    still.q[0] = 0.03 * std::sin(turn) - 0.02;
    still.q[1] = 0.03 * std::cos(turn) - 0.04;
    look(still.tick());
  }
}

TEST(FirstTouchOfAMovingHand, IsFollowedToAFractionOfAMillimetre) {
  Still moving(sceneOf(cylinder(0.025, 0.2)));
  int ticks = 0, known = 0, right = 0;
  double worst_m = 0.0;
  glide(moving, 2500, [&](const AxisPosition& touch) {
    if (++ticks % 5 != 0) return;
    Still here(moving.scene);
    here.body_pose = moving.body_pose;
    here.q = moving.q;
    AxisPosition truth;
    for (int k = 0; k < 50; ++k) truth = here.tick();  // shown to be exact above
    for (int a = kFingers; a <= kThumb; ++a) {
      ++known;
      if (std::isnan(truth[a]) && std::isnan(touch[a])) ++right;
      if (std::isnan(truth[a]) || std::isnan(touch[a])) continue;
      const double off_m = std::abs(touch[a] - truth[a]) * 0.08;  // of path, at the lever arm
      right += off_m < 3e-4 ? 1 : 0;
      worst_m = std::max(worst_m, off_m);
    }
  });
  // Where another finger becomes the first, the truth jumps, and a search later so does what is
  // said.
  const double share = static_cast<double>(right) / known;
  std::printf("figure: moving hand: %.2f %% right to 0.3 mm of path, worst %.2g mm\n",
              100.0 * share, worst_m * 1e3);
  EXPECT_GT(share, 0.95);
}

TEST(FirstTouch, CalledAgainAfterReset_GivesTheSameBits) {
  Still still(sceneOf(cylinder(0.025, 0.2)));
  std::vector<AxisPosition> first, second;
  glide(still, 300, [&](const AxisPosition& touch) { first.push_back(touch); });
  still.closure.reset();
  glide(still, 300, [&](const AxisPosition& touch) { second.push_back(touch); });
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t k = 0; k < first.size(); ++k) {
    ASSERT_EQ(0, std::memcmp(first[k].data(), second[k].data(), 6 * sizeof(double))) << k;
  }
}

TEST(FirstTouch, OfBaseAxesAndWhereNothingIsAsked_IsNaN) {
  Still still(sceneOf(cylinder(0.025, 0.2)));
  still.body_pose.translation_m = {0.049, 0.06, 0.004};
  AxisPosition touch;
  for (int k = 0; k < 50; ++k) touch = still.tick();
  for (int a = 0; a < kFingers; ++a) EXPECT_TRUE(std::isnan(touch[a]));
  EXPECT_FALSE(std::isnan(touch[kFingers]));
  for (const int nothing : {-1, 1, 32}) {
    touch = still.tick(nothing);
    ASSERT_EQ(touch.size(), 6);
    for (const double t : touch) EXPECT_TRUE(std::isnan(t));
  }
}

TEST(FirstTouch, AfterTheBodyWasPutElsewhere_IsFoundAnew) {
  Still still(sceneOf(cylinder(0.025, 0.2)));
  still.q[kCircumduction] = 0.35;
  for (const double y : {0.06, 0.045, 0.07, 0.4, 0.05}) {
    still.body_pose.translation_m = {0.049, y, 0.004};
    AxisPosition touch;
    for (int k = 0; k < 50; ++k) touch = still.tick();
    Still anew(still.scene);
    anew.body_pose = still.body_pose;
    anew.q = still.q;
    AxisPosition expected;
    for (int k = 0; k < 50; ++k) expected = anew.tick();
    EXPECT_EQ(std::isnan(touch[kFingers]), y == 0.4);
    for (int a = kFingers; a <= kThumb; ++a) {
      EXPECT_TRUE(std::abs(touch[a] - expected[a]) < 1e-5 ||
                  (std::isnan(touch[a]) && std::isnan(expected[a])))
          << y << ": " << touch[a] << " and not " << expected[a];
    }
  }
}

}  // namespace
}  // namespace wholehand::test
