// Laws of mechanics for bodies on the default engine, for every shape, in any rotation of the whole
// scene, at 1 to 8 kHz, from 1 g to 50 kg. Expected values are closed forms.
#include "loop/physics/body_yard.hpp"
#include "support/tolerance.hpp"

#include <cmath>

namespace wholehand::test {
namespace {

using Eigen::Vector3d;

constexpr double kGravity = 9.81;
const char* const kEngine = "bullet";

/// Number of random draws per law; ./check runs a tenth.
int draws() {
  return fullCounts() ? 200 : 20;
}

double anyRate(std::mt19937_64& random) {
  const std::array rates{1000.0, 2000.0, 4000.0, 8000.0};
  return rates[random() % rates.size()];
}
/// A random value, uniform over the decades.
double anyBetween(std::mt19937_64& random, double low, double high) {
  return std::exp(uniform(random, std::log(low), std::log(high)));
}
double anyMass(std::mt19937_64& random) {
  return anyBetween(random, 1e-3, 50.0);
}
/// Gravity tilted by a slope along x.
Vector3d leant(double slope_rad) {
  return kGravity * Vector3d(std::sin(slope_rad), 0.0, -std::cos(slope_rad));
}
Eigen::Matrix3d about(const Vector3d& axis, double angle_rad) {
  return Eigen::AngleAxisd(angle_rad, axis).toRotationMatrix();
}

/// A round body that rolls along x on z = 0.
struct Round {
  std::string name;
  SceneBody body;
  double radius_m = 0.0;
  double k = 0.0;  ///< moment of inertia about the rolling axis, divided by m r²
};

Round anyRound(std::mt19937_64& random, double start_m) {
  const double r = anyBetween(random, 3e-3, 0.05), m = anyMass(random);
  const double length = uniform(random, 2.5, 5.0) * r;
  const Vector3d at(start_m, 0.0, r);
  const Eigen::Matrix3d lying = about(Vector3d::UnitX(), kPi / 2.0);
  switch (random() % 3) {
    case 0:
      return {"sphere", bodyOf(roundShape(ShapeType::kSphere, r, 0.0), at, m, 0.8, anyTurn(random)),
              r, 2.0 / 5.0};
    case 1:
      return {"cylinder", bodyOf(roundShape(ShapeType::kCylinder, r, length), at, m, 0.8, lying), r,
              1.0 / 2.0};
    default: {
      // Moments of inertia of a cylinder and two half balls about their common axis.
      const double ends = 4.0 / 3.0 * r, both = length + ends;
      return {"capsule", bodyOf(roundShape(ShapeType::kCapsule, r, length), at, m, 0.8, lying), r,
              (length * 0.5 + ends * 0.4) / both};
    }
  }
}

/// A body that lies with a face on z = 0. @param half_m half of its height
SceneBody anyFlat(std::mt19937_64& random, double half_m, double friction, double mass_kg,
                  std::string& name) {
  const double width = uniform(random, 1.5, 3.0) * half_m;
  const Vector3d at(-3.0, 0.0, half_m), size(2.0 * width, 1.7 * width, 2.0 * half_m);
  const Eigen::Matrix3d turn = about(Vector3d::UnitZ(), uniform(random, -kPi, kPi));
  switch (random() % 3) {
    case 0:
      name = "box";
      return bodyOf(boxShape(size), at, mass_kg, friction, turn);
    case 1:
      name = "cylinder";
      return bodyOf(roundShape(ShapeType::kCylinder, width, 2.0 * half_m), at, mass_kg, friction,
                    turn);
    default:
      name = "mesh";
      return bodyOf(meshShape(size), at, mass_kg, friction, turn);
  }
}

TEST(BodyLaws, RollingOnALevel_KeepsItsSpeedAndGainsNoEnergy) {
  auto random = seededRandom(3601);
  double worst = 0.0, gained = 0.0;
  for (int i = 0; i < draws(); ++i) {
    const Round round = anyRound(random, -3.0);
    const double rate = anyRate(random), v = anyBetween(random, 1e-3, 0.5);
    SCOPED_TRACE(round.name + " r " + std::to_string(round.radius_m) + " m, " +
                 std::to_string(rate) + " Hz, thrown at " + std::to_string(v) + " m/s");
    Yard yard(kEngine, {ground(0.8), round.body}, leant(0.0), rate, anyTurn(random));
    yard.throwBody(1, Vector3d(v, 0.0, 0.0));
    yard.run(0.5);
    const double energy = yard.energy(1);
    yard.run(i % 5 == 0 ? 10.0 : 2.0);
    // Sliding ends when the ground has spun the body up; its angular momentum about the contact
    // stays.
    const double expected = v / (1.0 + round.k);
    worst = std::max(worst, std::abs(yard.velocity(1).x() / expected - 1.0));
    gained = std::max(gained, (yard.energy(1) - energy) / (0.5 * round.body.mass_kg * v * v));
    EXPECT_NEAR(yard.velocity(1).x(), expected, 0.01 * expected);
    EXPECT_LE(std::abs(yard.velocity(1).y()), 0.01 * expected);
    EXPECT_LE(yard.energy(1) - energy, 1e-3 * 0.5 * round.body.mass_kg * v * v);
  }
  figure("rolling on a level, worst speed against the law", worst, "");
  figure("rolling on a level, most energy gained over what it had", gained, "");
}

TEST(BodyLaws, RollingDownASlope_AcceleratesByItsMoment) {
  auto random = seededRandom(3602);
  double worst = 0.0;
  for (int i = 0; i < draws(); ++i) {
    const Round round = anyRound(random, -3.0);
    const double rate = anyRate(random), slope = uniform(random, 0.02, 0.3);
    SCOPED_TRACE(round.name + ", " + std::to_string(rate) + " Hz, slope " + std::to_string(slope));
    Yard yard(kEngine, {ground(0.8), round.body}, leant(slope), rate, anyTurn(random));
    yard.run(0.1);
    const double before = yard.velocity(1).x();
    yard.run(1.0);
    const double expected = kGravity * std::sin(slope) / (1.0 + round.k);
    worst = std::max(worst, std::abs((yard.velocity(1).x() - before) / expected - 1.0));
    EXPECT_NEAR(yard.velocity(1).x() - before, expected, 0.01 * expected);
    EXPECT_LE(std::abs(yard.at(1).y()), 5e-4);
  }
  figure("rolling down, worst acceleration against the law", worst, "");
}

TEST(BodyLaws, SlidingDownASlope_AcceleratesByCoulombsLawAndStraight) {
  auto random = seededRandom(3603);
  double worst = 0.0, aside_m = 0.0;
  for (int i = 0; i < draws(); ++i) {
    std::string name;
    const double friction = uniform(random, 0.1, 0.6), rate = anyRate(random);
    const double slope = std::atan(friction * uniform(random, 1.2, 2.0));
    const SceneBody body =
        anyFlat(random, uniform(random, 0.005, 0.03), friction, anyMass(random), name);
    SCOPED_TRACE(name + ", " + std::to_string(rate) + " Hz, friction " + std::to_string(friction));
    Yard yard(kEngine, {ground(friction), body}, leant(slope), rate, anyTurn(random));
    yard.throwBody(1, Vector3d::Zero());
    yard.run(0.1);
    const double before = yard.velocity(1).x();
    yard.run(1.0);
    const double expected = kGravity * (std::sin(slope) - friction * std::cos(slope));
    worst = std::max(worst, std::abs((yard.velocity(1).x() - before) / expected - 1.0));
    aside_m = std::max(aside_m, std::abs(yard.at(1).y()));
    EXPECT_NEAR(yard.velocity(1).x() - before, expected, 0.01 * expected);
    EXPECT_LE(std::abs(yard.at(1).y()), 5e-4);
  }
  figure("sliding down, worst acceleration against the law", worst, "");
  figure("sliding down, farthest aside", 1e3 * aside_m, "mm");
}

TEST(BodyLaws, StandingOnASlopeBelowItsFriction_Stays) {
  auto random = seededRandom(3604);
  double farthest_m = 0.0;
  for (int i = 0; i < draws(); ++i) {
    std::string name;
    const double friction = uniform(random, 0.2, 0.6), half_m = uniform(random, 0.005, 0.03);
    const SceneBody body = anyFlat(random, half_m, friction, anyMass(random), name);
    SCOPED_TRACE(name);
    Yard yard(kEngine, {ground(friction), body}, leant(std::atan(0.95 * friction)), anyRate(random),
              anyTurn(random));
    yard.throwBody(1, Vector3d::Zero());
    const Vector3d before = yard.at(1);
    yard.run(1.5);
    farthest_m = std::max(farthest_m, (yard.at(1) - before).norm());
    EXPECT_LE((yard.at(1) - before).norm(), 2e-4);
  }
  figure("standing on a slope, farthest moved in 1.5 s", 1e3 * farthest_m, "mm");
}

/// Mesh of an upright prism or pyramid with its centre of mass at the origin. @param turn_rad angle
/// of the base's first corner
Shape polygonShape(int sides, double radius_m, double height_m, bool pyramid, double turn_rad) {
  Shape shape;
  shape.type = ShapeType::kConvexMesh;
  const auto ring = [&](double z) {
    for (int i = 0; i < sides; ++i) {
      const double angle = turn_rad + 2.0 * kPi * i / sides;
      shape.points_m.emplace_back(radius_m * std::cos(angle), radius_m * std::sin(angle), z);
    }
  };
  ring(0.0);
  if (pyramid) shape.points_m.emplace_back(0.0, 0.0, height_m);
  if (!pyramid) ring(height_m);
  for (int i = 0; i < sides; ++i) {
    const int j = (i + 1) % sides, above_i = pyramid ? sides : sides + i,
              above_j = pyramid ? sides : sides + j;
    shape.triangles.emplace_back(i, j, above_j);
    if (!pyramid) shape.triangles.emplace_back(i, above_j, above_i);
    if (i == 0 || j == 0) continue;
    shape.triangles.emplace_back(0, j, i);
    if (!pyramid) shape.triangles.emplace_back(sides, above_i, above_j);
  }
  const Vector3d center_m = moments(shape).center_m;
  for (Vector3d& point_m : shape.points_m) point_m -= center_m;
  return shape;
}

/// Cylinders, boxes, prisms and pyramids of 3 to 12 sides, rotated about their axis.
TEST(BodyLaws, LeaningBody_FallsWhenItsWeightLeavesItsBase) {
  auto random = seededRandom(3605);
  for (int i = 0; i < 2 * draws(); ++i) {
    const bool falls = random() % 2 == 0;
    const std::size_t kind = random() % 6;
    const bool round = kind == 0, box = kind == 1, pyramid = kind > 3;
    const int sides = box ? 4 : 3 + static_cast<int>(random() % 10);
    const double r = uniform(random, 0.015, 0.04), height_m = r * uniform(random, 3.0, 6.0);
    const double yaw = uniform(random, -kPi, kPi), sector = 2.0 * kPi / sides;
    const Shape shape = round ? roundShape(ShapeType::kCylinder, r, height_m)
                        : box ? boxShape({std::sqrt(2.0) * r, std::sqrt(2.0) * r, height_m})
                              : polygonShape(sides, r, height_m, pyramid, yaw);
    const double turn_rad = round || box ? yaw : 0.0;
    // Distance from the axis to the base's edge along x, down the slope: to the line of the nearest
    // edge.
    const double first = box ? yaw + kPi / 4.0 : yaw;
    const double off = std::remainder(first + 0.5 * sector, sector);
    const double foot_m = round ? r : r * std::cos(0.5 * sector) / std::cos(off);
    const double middle_m = pyramid ? 0.25 * height_m : 0.5 * height_m;
    // A cylinder touches at a few points of its rim, so its margin is larger.
    const double margin = round ? 0.02 : 0.01, share = falls ? 1.0 + margin : 1.0 - margin;
    SCOPED_TRACE((round     ? "cylinder"
                  : box     ? "box"
                  : pyramid ? "pyramid of "
                            : "prism of ") +
                 (round || box ? "" : std::to_string(sides)) + ", r " + std::to_string(r) +
                 ", height " + std::to_string(height_m) + ", yaw " + std::to_string(yaw));
    const SceneBody body = bodyOf(shape, {0.0, 0.0, middle_m}, anyMass(random), 2.0,
                                  about(Vector3d::UnitZ(), turn_rad));
    Yard yard(kEngine, {ground(2.0), body}, leant(std::atan(share * foot_m / middle_m)), 1000.0,
              anyTurn(random));
    // Holds the body while it settles: a fall by the slop, 10 µm, would give it enough energy to
    // tip.
    for (int k = 0; k < 10; ++k) {
      yard.throwBody(1, Vector3d::Zero());
      yard.step();
    }
    bool fell = false;
    for (int k = 0; k < 50 && !fell; ++k) {
      yard.run(0.1);
      fell = yard.axes(1)(2, 2) < 0.9;
    }
    EXPECT_EQ(fell, falls) << "leans by " << share << " of what its foot bears";
  }
}

class FreeSpin : public testing::TestWithParam<std::string> {};

TEST_P(FreeSpin, KeepsItsAngularMomentumAndEnergy) {
  auto random = seededRandom(3606);
  double momentum = 0.0, energy = 0.0;
  for (int i = 0; i < draws() / 4; ++i) {
    const Vector3d size(uniform(random, 0.05, 0.2), uniform(random, 0.05, 0.2),
                        uniform(random, 0.01, 0.2));
    // A ball hits the body off its centre.
    Yard yard(GetParam(),
              {bodyOf(boxShape(size), Vector3d::Zero(), 0.1, 0.5, anyTurn(random)),
               bodyOf(roundShape(ShapeType::kSphere, 0.02, 0.0),
                      {0.3 * size.x(), 0.3 * size.y(), 0.3}, 0.5, 0.5)},
              Vector3d::Zero(), anyRate(random), anyTurn(random));
    yard.throwBody(1, {0.0, 0.0, -uniform(random, 1.0, 4.0)});
    yard.run(0.4);
    const Vector3d before = yard.angularMomentum(0);
    const double had = yard.energy(0);
    if (yard.spin(0).norm() < 1.0) continue;  // the ball missed it
    yard.run(i == 0 ? 60.0 : 5.0);
    momentum = std::max(momentum, (yard.angularMomentum(0) - before).norm() / before.norm());
    energy = std::max(energy, std::abs(yard.energy(0) / had - 1.0));
  }
  figure(GetParam() + ": free spin, angular momentum lost", momentum, "");
  figure(GetParam() + ": free spin, energy changed", energy, "");
  EXPECT_GT(momentum, 0.0);
  EXPECT_LE(momentum, 1e-6);
  EXPECT_LE(energy, 1e-3);
}
INSTANTIATE_TEST_SUITE_P(Engines, FreeSpin, testing::ValuesIn(builtEngines(true)),
                         [](const auto& tested) { return tested.param; });

TEST(BodyLaws, SlidingOverFlushPlanks_IsNotDisturbedBySeams) {
  auto random = seededRandom(3607);
  for (int i = 0; i < draws() / 4; ++i) {
    std::string name;
    const double friction = 0.3, slope = std::atan(0.45), half_m = uniform(random, 0.015, 0.03);
    SceneBody body = anyFlat(random, half_m, friction, 0.1, name);
    const double start_m = 0.2;
    body.pose.translation_m = {start_m, 0.0, half_m};
    std::vector<SceneBody> bodies;
    for (int k = 0; k < 40; ++k) {
      bodies.push_back(bodyOf(boxShape({0.05, 1.2, 0.04}), {0.05 * k, 0.0, -0.02}, 0.0, friction));
    }
    bodies.push_back(body);
    SCOPED_TRACE(name);
    Yard yard(kEngine, bodies, leant(slope), 1000.0, anyTurn(random));
    yard.throwBody(40, Vector3d::Zero());
    const double seconds = 0.95;
    yard.run(seconds);
    const double way_m =
        0.5 * kGravity * (std::sin(slope) - friction * std::cos(slope)) * seconds * seconds;
    EXPECT_NEAR(yard.at(40).x() - start_m, way_m, 0.02 * way_m);
  }
}

/// The middle of a floor: planks, or pieces of one body.
std::vector<SceneBody> flushFloor(std::mt19937_64& random, double friction) {
  const double width_m = uniform(random, 0.04, 0.1);
  const bool one_body = random() % 2 == 0, meshes = random() % 2 == 0;
  const Vector3d size_m(width_m, 2.0, 0.04);
  const Shape piece = meshes ? meshShape(size_m) : boxShape(size_m);
  SceneBody whole = bodyOf(piece, {0.0, 0.0, -0.02}, 0.0, friction);
  whole.shapes.clear();
  std::vector<SceneBody> planks;
  for (double at_m = -0.4; at_m < 2.4; at_m += width_m) {
    whole.shapes.push_back(piece);
    whole.shapes.back().in_body.translation_m.x() = at_m;
    planks.push_back(bodyOf(piece, {at_m, 0.0, -0.02}, 0.0, friction));
  }
  if (one_body) planks = {whole};
  return planks;
}

TEST(BodyLaws, RollingOverFlushPlanks_IsNotDisturbedBySeams) {
  auto random = seededRandom(3615);
  double worst = 0.0, gained = 0.0;
  for (int i = 0; i < draws(); ++i) {
    const Round round = anyRound(random, 0.0);
    const double rate = anyRate(random), v = anyBetween(random, 5e-3, 0.5);
    SCOPED_TRACE(round.name + " r " + std::to_string(round.radius_m) + " m, " +
                 std::to_string(rate) + " Hz, thrown at " + std::to_string(v) + " m/s");
    std::vector<SceneBody> bodies = flushFloor(random, 0.8);
    const int rolls = static_cast<int>(bodies.size());
    bodies.push_back(round.body);
    Yard yard(kEngine, bodies, leant(0.0), rate, anyTurn(random));
    yard.throwBody(rolls, Vector3d(v, 0.0, 0.0));
    yard.run(0.5);
    const double energy = yard.energy(rolls);
    yard.run(std::min(4.0, 1.0 / v));
    const double expected = v / (1.0 + round.k), had = 0.5 * round.body.mass_kg * v * v;
    worst = std::max(worst, std::abs(yard.velocity(rolls).x() / expected - 1.0));
    gained = std::max(gained, (yard.energy(rolls) - energy) / had);
    EXPECT_NEAR(yard.velocity(rolls).x(), expected, 0.01 * expected);
    EXPECT_LE(std::abs(yard.velocity(rolls).y()), 0.01 * expected);
  }
  figure("rolling over flush planks, worst speed against the law", worst, "");
  figure("rolling over flush planks, most energy gained over what it had", gained, "");
  EXPECT_LE(gained, 0.01);
}

/// Two bodies of every shape collide without gravity: no impact makes energy, and linear and
/// angular momentum are kept.
TEST(BodyLaws, CollisionInFlight_KeepsMomentaAndGainsNoEnergy) {
  auto random = seededRandom(3616);
  double gained = 0.0, lost = 0.0, turned = 0.0;
  int struck = 0;
  for (int i = 0; i < 3 * draws(); ++i) {
    std::vector<SceneBody> bodies;
    for (const double at_m : {0.0, 0.12}) {
      const double r = anyBetween(random, 0.01, 0.03), off_m = uniform(random, -0.01, 0.01);
      const std::array<Shape, 5> shapes{
          roundShape(ShapeType::kSphere, r, 0.0), roundShape(ShapeType::kCylinder, r, 2.0 * r),
          roundShape(ShapeType::kCapsule, 0.5 * r, r), boxShape(r * Vector3d(2.0, 1.5, 1.0)),
          meshShape(r * Vector3d(1.0, 2.0, 1.3))};
      bodies.push_back(bodyOf(shapes[random() % shapes.size()], {at_m, off_m, 0.0},
                              anyBetween(random, 1e-2, 1.0), 0.5, anyTurn(random)));
    }
    const double rate = anyRate(random), v = uniform(random, 0.5, 3.0);
    SCOPED_TRACE(std::to_string(static_cast<int>(bodies[0].shapes[0].type)) + " at " +
                 std::to_string(static_cast<int>(bodies[1].shapes[0].type)) + ", " +
                 std::to_string(rate) + " Hz");
    Yard yard(kEngine, bodies, Vector3d::Zero(), rate, anyTurn(random));
    yard.throwBody(0, Vector3d(v, 0.0, 0.0));
    const double had = yard.energy(0), pushed = bodies[0].mass_kg * v;
    const auto momentum = [&] {
      return Vector3d(bodies[0].mass_kg * yard.velocity(0) + bodies[1].mass_kg * yard.velocity(1));
    };
    const auto about_origin = [&] {
      Vector3d sum = Vector3d::Zero();
      for (int k = 0; k < 2; ++k) {
        sum += bodies[k].mass_kg * yard.at(k).cross(yard.velocity(k)) + yard.angularMomentum(k);
      }
      return sum;
    };
    const Vector3d before = momentum(), turning = about_origin();
    double least = had;
    for (double t_s = 0.0; t_s < 0.5; t_s += 0.005) {
      yard.run(0.005);
      const double now = yard.energy(0) + yard.energy(1);
      gained = std::max(gained, (now - least) / had);
      EXPECT_LE(now - least, 0.01 * had);
      least = std::min(least, now);
    }
    struck += yard.velocity(1).norm() > 0.0 ? 1 : 0;
    lost = std::max(lost, (momentum() - before).norm() / pushed);
    const double turning_lost = (about_origin() - turning).norm();
    turned = std::max(turned, turning_lost / (0.03 * pushed));
    // Friction acts at each body's own contact point. Where a contact is made in advance, the two
    // points are up to one step's motion apart.
    EXPECT_LE(turning_lost, 0.5 * pushed * v / rate);
  }
  figure("struck in flight, most energy gained over what there was", gained, "");
  figure("struck in flight, momentum lost", lost, "");
  figure("struck in flight, angular momentum lost, of 30 mm of the push", turned, "");
  EXPECT_LE(lost, 1e-9);
  EXPECT_GT(struck, draws());
}

/// Planks of 1 to 5 kg lie on the ground and are free to move. A body slides over them as over one
/// plate, and they stay.
TEST(BodyLaws, SlidingOverMovablePlanks_IsNotDisturbedBySeams) {
  auto random = seededRandom(3614);
  constexpr int kPlanks = 24;
  double worst = 0.0, moved_m = 0.0;
  for (int i = 0; i < draws() / 10; ++i) {
    std::string name;
    // The friction of a pair is the root of the product.
    const double friction = 0.3, rough = 0.9, slope = std::atan(0.45);
    const double half_m = uniform(random, 0.015, 0.03), start_m = 0.1, width_m = 0.05;
    SceneBody body = anyFlat(random, half_m, friction * friction / rough, 0.1, name);
    body.pose.translation_m = {start_m, 0.0, half_m};
    std::vector<SceneBody> bodies{ground(rough)};
    bodies[0].pose.translation_m.z() -= 0.02;
    for (int k = 0; k < kPlanks; ++k) {
      bodies.push_back(bodyOf(boxShape({width_m, 0.6, 0.02}), {width_m * k, 0.0, -0.01},
                              uniform(random, 1.0, 5.0), rough));
    }
    bodies.push_back(body);
    const double rate_hz = anyRate(random);
    SCOPED_TRACE(name + ", " + std::to_string(rate_hz) + " Hz");
    Yard yard(kEngine, bodies, leant(slope), rate_hz, anyTurn(random));
    const int slider = kPlanks + 1;
    yard.throwBody(slider, Vector3d::Zero());
    const double seconds = 0.8;
    yard.run(seconds);
    const double way_m =
        0.5 * kGravity * (std::sin(slope) - friction * std::cos(slope)) * seconds * seconds;
    worst = std::max(worst, std::abs((yard.at(slider).x() - start_m) / way_m - 1.0));
    EXPECT_NEAR(yard.at(slider).x() - start_m, way_m, 0.02 * way_m);
    for (int k = 0; k < kPlanks; ++k) {
      const Vector3d off_m = yard.at(k + 1) - Vector3d(width_m * k, 0.0, -0.01);
      moved_m = std::max(moved_m, off_m.norm());
    }
  }
  figure("sliding over planks that may move, worst way against the law", worst, "");
  figure("the same, farthest that a plank moved", 1e3 * moved_m, "mm");
  EXPECT_LE(moved_m, 1e-4);
}

TEST(BodyLaws, FlyingAtAThinPlate_StopsOnIt) {
  auto random = seededRandom(3608);
  for (int i = 0; i < draws(); ++i) {
    const std::size_t which = random() % 3;
    // A body that hits with a corner starts to rotate; only a ball stops at any speed.
    const double r = anyBetween(random, 2e-3, 0.02),
                 v = uniform(random, 1.0, which == 0 ? 15.0 : 2.0);
    const std::array<Shape, 3> shapes{roundShape(ShapeType::kSphere, r, 0.0),
                                      boxShape(Vector3d(r, r, r)), meshShape(Vector3d(r, r, r))};
    SCOPED_TRACE("shape " + std::to_string(which) + " of " + std::to_string(r) + " m at " +
                 std::to_string(v) + " m/s");
    Yard yard(
        kEngine,
        {bodyOf(boxShape({0.4, 0.4, 0.001}), Vector3d::Zero(), 0.0, 0.5),
         bodyOf(shapes[which], {0.0, 0.0, uniform(random, 0.1, 0.2)}, 0.01, 0.5, anyTurn(random))},
        Vector3d::Zero(), anyRate(random), anyTurn(random));
    yard.throwBody(1, {uniform(random, -0.3, 0.3) * v, 0.0, -v});
    yard.run(0.2);
    EXPECT_GT(yard.at(1).z(), 0.0);
  }
}

// Each contact yields by the slop, 10 µm; the tests allow a third more.
constexpr double kGives_m = 1.33e-5;

TEST(BodyLaws, HeavyBodyOnALightOne_RestsAtItsSurface) {
  auto random = seededRandom(3609);
  double deepest_m = 0.0;
  for (int i = 0; i < draws() / 2; ++i) {
    const double light = anyBetween(random, 2e-4, 0.1), ratio = anyBetween(random, 1.0, 1e4);
    // From a card of half a millimetre to a cube; the heavy body falls on it from up to 1 mm.
    const double thick_m = anyBetween(random, 5e-4, 0.05), fall_m = uniform(random, 0.0, 1e-3);
    SCOPED_TRACE(std::to_string(light) + " kg, " + std::to_string(thick_m) + " m below " +
                 std::to_string(light * ratio) + " kg from " + std::to_string(fall_m) + " m");
    Yard yard(kEngine,
              {ground(0.8),
               bodyOf(boxShape({0.05, 0.05, thick_m}), {0.0, 0.0, 0.5 * thick_m}, light, 0.8),
               bodyOf(boxShape({0.08, 0.08, 0.06}), {0.0, 0.0, thick_m + 0.03 + fall_m},
                      light * ratio, 0.8)},
              leant(0.0), anyRate(random), anyTurn(random));
    yard.throwBody(2, Vector3d::Zero());
    yard.run(1.0);
    const double sunk_m = thick_m + 0.03 - yard.at(2).z();
    deepest_m = std::max(deepest_m, sunk_m);
    EXPECT_LE(sunk_m, 2 * kGives_m);
    EXPECT_LE(std::hypot(yard.at(2).x(), yard.at(2).y()), 1e-4);
  }
  figure("heavy on light to a ratio of 10,000, deepest", 1e3 * deepest_m, "mm");
}

TEST(BodyLaws, TowerOfEight_StandsForTenMinutes) {
  auto random = seededRandom(3611);
  double deepest_m = 0.0, widest_m = 0.0;
  for (int i = 0; i < std::max(1, draws() / 10); ++i) {
    // Cubes of 4 cm and 20 g. In the first draw the top one weighs 2 kg, in later draws any one of
    // them.
    const int heavy = i == 0 ? 8 : 1 + static_cast<int>(random() % 8);
    const double rate_hz = anyRate(random);
    SCOPED_TRACE("2 kg are number " + std::to_string(heavy) + ", " + std::to_string(rate_hz) +
                 " Hz");
    std::vector<SceneBody> bodies{ground(0.8)};
    for (int k = 1; k <= 8; ++k) {
      bodies.push_back(bodyOf(boxShape({0.04, 0.04, 0.04}), {0.0, 0.0, 0.04 * k - 0.02},
                              k == heavy ? 2.0 : 0.02, 0.8));
    }
    Yard yard(kEngine, bodies, leant(0.0), rate_hz, anyTurn(random));
    yard.throwBody(8, Vector3d::Zero());
    yard.run(i == 0 ? 600.0 : 10.0);
    double aside_m = 0.0;
    for (int k = 1; k <= 8; ++k) {
      deepest_m = std::max(deepest_m, 0.04 * k - 0.02 - yard.at(k).z());
      aside_m = std::max(aside_m, std::hypot(yard.at(k).x(), yard.at(k).y()));
    }
    // With the heavy cube further down, three of a hundred towers shifted by up to 2.5 mm before
    // they rested, and one of some hundreds by 16 mm. A tower stands up to a shift of half a cube.
    EXPECT_LE(aside_m, i == 0 ? 1e-4 : 0.02);
    if (i == 0) widest_m = aside_m;
  }
  figure("tower of eight cubes, one a hundred times as heavy, deepest", 1e3 * deepest_m, "mm");
  figure("the same on top, furthest aside in ten minutes", 1e3 * widest_m, "mm");
  EXPECT_LE(deepest_m, 8 * kGives_m);
}

/// Forty cubes under a ton: more bodies than the direct solver takes, and too heavy for sweeps to
/// converge. Twelve cubes stand.
TEST(BodyLaws, UnsettledContacts_AreReported) {
  for (const double top_kg : {0.02, 1000.0}) {
    const int count = top_kg > 1.0 ? 40 : 12;
    std::vector<SceneBody> bodies{ground(0.8)};
    for (int k = 1; k <= count; ++k) {
      bodies.push_back(bodyOf(boxShape({0.04, 0.04, 0.04}), {0.0, 0.0, 0.04 * k - 0.02},
                              k == count ? top_kg : 0.02, 0.8));
    }
    Yard yard(kEngine, bodies, leant(0.0), 1000.0, Eigen::Matrix3d::Identity());
    yard.throwBody(count, {0.0, 0.0, -0.01});
    yard.run(0.5);
    const bool sank = yard.at(count).z() < 0.04 * count - 0.02 - count * kGives_m;
    EXPECT_EQ(sank, top_kg > 1.0);
    EXPECT_EQ(yard.unsettled() > 0, top_kg > 1.0) << top_kg << " kg: " << yard.unsettled();
  }
}

/// Kinetic energy plus potential energy above the ground, of the bodies from `first` on [J].
double energyOver(const Yard& yard, const std::vector<SceneBody>& bodies, std::size_t first) {
  double sum = 0.0;
  for (std::size_t k = first; k < bodies.size(); ++k) {
    const int body = static_cast<int>(k);
    const double m = bodies[k].mass_kg;
    sum += 0.5 * m * yard.velocity(body).squaredNorm() +
           0.5 * yard.spin(body).dot(yard.angularMomentum(body)) + m * kGravity * yard.at(body).z();
  }
  return sum;
}

/// The ground and four walls around it, open at the top.
std::vector<SceneBody> openBox(double half_m) {
  std::vector<SceneBody> bodies{ground(0.5)};
  for (const Vector3d& side : {Vector3d::UnitX().eval(), Vector3d::UnitY().eval()}) {
    for (const double sign : {-1.0, 1.0}) {
      const Vector3d size = Vector3d(1.0, 1.0, 4.0) - 0.8 * side;
      bodies.push_back(bodyOf(boxShape(size), sign * (half_m + 0.1) * side, 0.0, 0.5));
    }
  }
  return bodies;
}

/// Shares of the bodies' initial energy: the largest regain and the lowest level.
struct EnergyShares {
  double gained = 0.0, least = 1.0;
};

/// Throws the bodies from `first` on at up to 1 m/s along each axis and follows their energy for
/// `duration_s`.
EnergyShares throwAndWatch(Yard& yard, const std::vector<SceneBody>& bodies, std::size_t first,
                           std::mt19937_64& random, double duration_s) {
  for (std::size_t k = first; k < bodies.size(); ++k) {
    yard.throwBody(static_cast<int>(k),
                   Vector3d::NullaryExpr([&] { return uniform(random, -1.0, 1.0); }));
  }
  constexpr double kLook_s = 0.005;
  const double begin_j = energyOver(yard, bodies, first);
  EnergyShares shares;
  for (int k = 0; k < static_cast<int>(std::round(duration_s / kLook_s)); ++k) {
    yard.run(kLook_s);
    const double share = energyOver(yard, bodies, first) / begin_j;
    EXPECT_TRUE(std::isfinite(share));
    shares.gained = std::max(shares.gained, share - shares.least);
    shares.least = std::min(shares.least, share);
  }
  return shares;
}

/// Twenty bodies of every shape, of 1 g to 1 kg, are thrown into a box. Their total energy never
/// rises. (Rolling bodies do not stop, since there is no rolling friction here.)
TEST(BodyLaws, TwentyBodiesInABox_OnlyLoseEnergy) {
  auto random = seededRandom(3612);
  double most = 0.0;
  for (int i = 0; i < std::max(1, draws() / 20); ++i) {
    std::vector<SceneBody> bodies = openBox(0.25);
    const std::size_t first = bodies.size();
    for (int k = 0; k < 20; ++k) {
      const double r = anyBetween(random, 0.01, 0.035);
      const std::array<Shape, 5> shapes{
          roundShape(ShapeType::kSphere, r, 0.0), roundShape(ShapeType::kCylinder, r, r),
          roundShape(ShapeType::kCapsule, 0.5 * r, r), boxShape(r * Vector3d(1.6, 1.2, 0.8)),
          meshShape(r * Vector3d(1.2, 1.2, 1.2))};
      const Vector3d at(0.15 * (k % 2) - 0.08, 0.15 * (k / 2 % 2) - 0.08, 0.05 + 0.09 * (k / 4));
      bodies.push_back(bodyOf(shapes[random() % shapes.size()], at, anyBetween(random, 1e-3, 1.0),
                              0.5, anyTurn(random)));
    }
    Yard yard(kEngine, bodies, leant(0.0), 1000.0, anyTurn(random));
    most = std::max(most, throwAndWatch(yard, bodies, first, random, 60.0).gained);
  }
  figure("twenty bodies in a box, most energy gained again, of what they had", most, "");
  // The largest regain in 27 draws was 0.44 %: a heavy body spinning on a light one, where the
  // direct solver found no solution.
  EXPECT_LE(most, 0.02);
}

/// A light mug: six wall pieces, each the mesh of a wedge, and a bottom; no two pieces overlap.
SceneBody mug(double radius_m, double mass_kg, const Vector3d& at_m, const Eigen::Matrix3d& turn) {
  constexpr int kPieces = 6;
  const double half_m = 1.1 * radius_m, wall_m = 0.12 * radius_m;
  const auto piece = [](double inner_m, double outer_m, int place, double low_m, double high_m) {
    Shape shape = meshShape({1.0, 1.0, 1.0});
    for (Vector3d& corner : shape.points_m) {
      const double r = corner.x() > 0.0 ? outer_m : inner_m, z = corner.z() > 0.0 ? high_m : low_m;
      const double angle = 2.0 * kPi / kPieces * (place + (corner.y() > 0.0 ? 1 : 0));
      corner = {r * std::cos(angle), r * std::sin(angle), z};
    }
    return shape;
  };
  SceneBody body = bodyOf(boxShape({1.0, 1.0, 1.0}), at_m, mass_kg, 0.5, turn);
  body.shapes.clear();
  for (int i = 0; i < kPieces; ++i) {
    body.shapes.push_back(piece(radius_m - wall_m, radius_m, i, -half_m, half_m));
  }
  body.shapes.push_back(boxShape({radius_m, radius_m, wall_m}));
  body.shapes.back().in_body.translation_m.z() = 0.5 * wall_m - half_m;
  double volume_m3 = 0.0;
  for (const Shape& shape : body.shapes) {
    const ShapeMoments of = moments(shape);
    volume_m3 += of.volume_m3;
    body.com_m += of.volume_m3 * of.center_m;
  }
  body.com_m /= volume_m3;
  body.inertia_kg_m2.setZero();
  for (const Shape& shape : body.shapes) {
    const ShapeMoments of = moments(shape);
    const Vector3d off_m = of.center_m - body.com_m;
    body.inertia_kg_m2 +=
        of.inertia_m5 + of.volume_m3 * (off_m.squaredNorm() * Eigen::Matrix3d::Identity() -
                                        off_m * off_m.transpose());
  }
  body.inertia_kg_m2 *= mass_kg / volume_m3;
  return body;
}

/// Four mugs of 1 to 50 g and two bodies of up to 1 kg fall down a shaft and wedge the mugs between
/// its walls. An impulse that one impact needed must not be applied again in the next step.
TEST(BodyLaws, LightMugsWedgedBetweenHeavyBodies_OnlyLoseEnergy) {
  auto random = seededRandom(3617);
  double most = 0.0;
  int piles = 0, gained = 0;
  for (int i = 0; i < draws() / 2; ++i) {
    std::vector<SceneBody> bodies = openBox(0.06);
    const std::size_t first = bodies.size();
    for (int k = 0; k < 6; ++k) {
      const double r = anyBetween(random, 0.015, 0.035);
      const Vector3d at(0.0, 0.0, 0.06 + 0.1 * k);
      const Eigen::Matrix3d turn = anyTurn(random);
      const Shape heavy =
          k == 3 ? roundShape(ShapeType::kSphere, r, 0.0) : roundShape(ShapeType::kCylinder, r, r);
      bodies.push_back(k % 2 == 1 && k > 1
                           ? bodyOf(heavy, at, anyBetween(random, 0.3, 1.0), 0.5, turn)
                           : mug(r, anyBetween(random, 1e-3, 0.05), at, turn));
    }
    Yard yard(kEngine, bodies, leant(0.0), 1000.0, anyTurn(random));
    const EnergyShares energy = throwAndWatch(yard, bodies, first, random, 1.0);
    most = std::max(most, energy.gained);
    ++piles;
    gained += energy.gained > 0.01 ? 1 : 0;
    EXPECT_LT(energy.least, 0.5);
  }
  figure("mugs wedged between heavy bodies, most energy gained again, of what they had", most, "");
  figure("share of these piles that gained over 1 %", static_cast<double>(gained) / piles, "1");
  // With this error, impacts threw 60 of 163 piles with a gain of over 1 %, the worst by 40 times
  // its energy. A heavy ball that sank into a mug is pushed out slowly and regains that energy.
  EXPECT_LE(gained, 1 + piles / 8);
  EXPECT_LE(most, 0.2);
}

// ---- the hand ----

TEST(HandFriction, SteadySlip_IsOpposedAlongItsDirection) {
  auto random = seededRandom(3610);
  double worst_rad = 0.0;
  int judged = 0;
  for (int i = 0; i < draws(); ++i) {
    // A wall of random orientation; the fingers slide along it in a random direction of its face.
    const Eigen::Matrix3d turn = about(Vector3d::UnitX(), uniform(random, -0.4, 0.4)) *
                                 about(Vector3d::UnitY(), uniform(random, -0.4, 0.4));
    const Vector3d normal = -turn.col(2);  // from the hand into the wall
    AxisPosition posture(6);
    posture[3] = uniform(random, 0.3, 1.2), posture[4] = 0.6, posture[5] = 0.3;
    const HandModel hand = load(shippedFiles()).hand;
    const double face_m = reach(hand, posture, normal);
    SceneBody slab = fixedBox(Vector3d::Zero(), {1.0, 1.0, 0.04});
    slab.pose = {turn, (face_m + 0.02) * normal};
    Bench bench(kEngine, weightless({slab}));
    ASSERT_TRUE(bench.world->placeHand(posture));
    const double angle = uniform(random, -kPi, kPi), speed = anyBetween(random, 5e-3, 0.2);
    const Vector3d slip = turn * Vector3d(std::cos(angle), std::sin(angle), 0.0);
    AxisVelocity rate(6);
    for (int k = 0; k < 300; ++k) {
      const double pressed_m = 2e-3 * std::min(1.0, k / 100.0);
      AxisPosition q = posture;
      for (int a = 0; a < 3; ++a) {
        q[a] += pressed_m * normal[a] + speed * k * kPeriod_s * slip[a];
        rate[a] = speed * slip[a];
      }
      ASSERT_NO_FATAL_FAILURE(bench.step(q, rate));
    }
    for (int c = 0; c < bench.touching.count; ++c) {
      const Contact& contact = bench.touching.points[c];
      const Vector3d n = contact.normal.eigen();
      Vector3d slip_m_s;
      for (int k = 0; k < 3; ++k) {
        std::array<double, kMaxAxes> row{};
        bench.body.reducedPointRow(contact.link, contact.point_m.eigen(), Vector3d::Unit(k),
                                   row.data());
        slip_m_s[k] = 0.0;
        for (int a = 0; a < 6; ++a) slip_m_s[k] += row[a] * bench.after.qd_s[a];
      }
      slip_m_s -= slip_m_s.dot(n) * n;
      const Vector3d force = contact.force_n.eigen();
      const Vector3d rub = force - force.dot(n) * n;
      if (slip_m_s.norm() < 1e-3 || force.dot(n) < 0.01) continue;
      ++judged;
      const double off = std::atan2(rub.cross(slip_m_s).norm(), -rub.dot(slip_m_s));
      worst_rad = std::max(worst_rad, off);
      EXPECT_LE(off, 1.0 * kDeg) << "posture " << posture[3] << ", angle " << angle;
    }
  }
  EXPECT_GT(judged, draws() / 2);
  figure("friction of a sliding hand off the slip, worst", worst_rad / kDeg, "deg");
}

/// The farthest point of the hand's surface along a direction [m].
Vector3d farthest(const HandModel& hand, const AxisPosition& q_s, const Vector3d& along) {
  const ArticulatedBody body = handAt(hand, q_s);
  Vector3d out = Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  double most_m = -std::numeric_limits<double>::infinity();
  for (const Capsule& c : hand.capsules) {
    for (const Vector3d& end : {c.a_m, c.b_m}) {
      const Vector3d at = body.linkPose(c.link) * end + c.radius_m * along;
      if (along.dot(at) <= most_m) continue;
      most_m = along.dot(at);
      out = at;
    }
  }
  return out;
}

/// A heavy cube on a lighter one on the ground, in a random rotation, and a hand that presses one
/// of them.
struct PressedStack {
  enum class At { kTop, kLight, kHeavy };
  static constexpr double kSide_m = 0.04, kGap_m = 2e-4;

  PressedStack(At at, double light_kg, double heavy_kg, double rate_hz, std::mt19937_64& random)
      : turn(anyTurn(random)),
        along(at == At::kTop ? Vector3d(-turn.col(2)) : Vector3d(turn.col(0))),
        posture(6),
        rate(6),
        period_s(1.0 / rate_hz) {
    posture[3] = uniform(random, 0.0, 1.2), posture[4] = 0.3, posture[5] = 0.3;
    const HandModel hand = load(shippedFiles()).hand;
    const double high_m = at == At::kTop     ? 2.0 * kSide_m
                          : at == At::kLight ? 0.5 * kSide_m
                                             : 1.5 * kSide_m;
    const Vector3d foot =
        at == At::kTop ? Vector3d(0.0, 0.0, high_m) : Vector3d(-0.5 * kSide_m, 0.0, high_m);
    const Vector3d origin = farthest(hand, posture, along) + kGap_m * along - turn * foot;
    // The whole stack is beyond the hand's farthest point.
    const double wide_m = at == At::kTop ? 0.0 : 0.5 - 0.5 * kSide_m;
    const Vector3d cube = Vector3d::Constant(kSide_m);
    SceneModel scene;
    scene.gravity_m_s2 = -kGravity * turn.col(2);
    scene.bodies = {bodyOf(boxShape({1.0, 1.0, 0.04}), {wide_m, 0.0, -0.02}, 0.0, 0.8),
                    bodyOf(boxShape(cube), {0.0, 0.0, 0.5 * kSide_m}, light_kg, 0.8),
                    bodyOf(boxShape(cube), {0.0, 0.0, 1.5 * kSide_m}, heavy_kg, 0.8)};
    for (SceneBody& body : scene.bodies) body.pose = Pose{turn, origin} * body.pose;
    foot_m = origin;
    bench = std::make_unique<Bench>(kEngine, scene);
    bench->period_s = period_s;
  }

  /// Presses with a force that grows within 0.1 s.
  void press(double force_n, double seconds) {
    ASSERT_TRUE(bench->world->placeHand(posture));
    ASSERT_NO_FATAL_FAILURE(bench->step(posture, rate));
    for (int k = 1; k * period_s < seconds; ++k) {
      AxisPosition q = posture;
      for (int a = 0; a < 3; ++a) {
        const double stiffness_n_m = 4e3 * bench->body.reducedInertia()(a, a);
        q[a] += std::min(1.0, k * period_s / 0.1) * force_n * along[a] / stiffness_n_m +
                kGap_m * along[a];
      }
      ASSERT_NO_FATAL_FAILURE(bench->step(q, rate));
      touched += bench->touching.count > 0 ? 1 : 0;
      ++steps;
    }
  }
  [[nodiscard]] Vector3d at(int body) const {
    return turn.transpose() * (bench->after.bodies[body].position_m.eigen() - foot_m);
  }
  /// How far the heavy cube is below its resting height [m].
  [[nodiscard]] double sunk_m() const { return 1.5 * kSide_m - at(2).z(); }

  Eigen::Matrix3d turn;
  Vector3d along, foot_m;
  AxisPosition posture;
  AxisVelocity rate;
  double period_s;
  std::unique_ptr<Bench> bench;
  int touched = 0, steps = 0;
};

TEST(HandAtAStack, HeavyOnLight_RestsAtItsSurface) {
  auto random = seededRandom(3613);
  for (const double most : {100.0, 1000.0}) {
    std::array<double, 3> deepest_m{};
    for (int i = 0; i < 3 * draws() / 10; ++i) {
      const auto where = static_cast<PressedStack::At>(i % 3);
      const double rate_hz = anyRate(random);
      const double heavy_kg = anyBetween(random, 0.2, 3.0);
      const double light_kg = heavy_kg / anyBetween(random, 0.1 * most, most);
      PressedStack stack(where, light_kg, heavy_kg, rate_hz, random);
      const double weight_n = kGravity * heavy_kg;
      const double force_n = where == PressedStack::At::kTop
                                 ? uniform(random, 1.0, 10.0)
                                 : uniform(random, 0.05, 0.2) * weight_n;
      SCOPED_TRACE(std::to_string(light_kg) + " kg below " + std::to_string(heavy_kg) + " kg, at " +
                   std::to_string(i % 3) + " with " + std::to_string(force_n) + " N, " +
                   std::to_string(rate_hz) + " Hz");
      ASSERT_NO_FATAL_FAILURE(stack.press(force_n, 0.5));
      EXPECT_GT(stack.touched, 0);
      EXPECT_LE(stack.sunk_m(), most > 100.0 ? 3e-4 : 1e-4);
      deepest_m[i % 3] = std::max(deepest_m[i % 3], stack.sunk_m());
    }
    const std::string to = "to a ratio of " + std::to_string(static_cast<int>(most));
    figure("heavy on light " + to + ", pressed from above, deepest", 1e3 * deepest_m[0], "mm");
    figure("the same, the light one pushed, deepest", 1e3 * deepest_m[1], "mm");
    figure("the same, the heavy one pushed, deepest", 1e3 * deepest_m[2], "mm");
  }
}

TEST(HandOnRollers, HeldByAPerson_ComesToRest) {
  auto random = seededRandom(3611);
  double worst_m = 0.0;
  for (int i = 0; i < draws() / 4; ++i) {
    const double r = uniform(random, 0.003, 0.02);
    Models models = load(shippedFiles());
    AxisPosition flat(6);
    const double low_m = -reach(models.hand, flat, -Vector3d::UnitZ());
    const double top_m = low_m - 1e-3, plate_m = 0.02;
    SceneModel& scene = models.scene;
    scene.bodies.clear();
    const double ground_m = top_m - plate_m - 2.0 * r;
    scene.bodies.push_back(
        bodyOf(boxShape({2.0, 2.0, 0.04}), {0.0, 0.0, ground_m - 0.02}, 0.0, 0.8));
    const Eigen::Matrix3d lying = about(Vector3d::UnitX(), kPi / 2.0);
    for (const double x : {0.0, 0.12}) {
      scene.bodies.push_back(bodyOf(roundShape(ShapeType::kCylinder, r, 0.2),
                                    {x, 0.0, ground_m + r}, 0.1, 0.8, lying));
    }
    scene.bodies.push_back(
        bodyOf(boxShape({0.3, 0.2, plate_m}), {0.06, 0.0, top_m - 0.5 * plate_m}, 2.0, 0.8));
    AxisPosition above = flat, pressed = flat, aside = flat;
    pressed[2] = aside[2] = -uniform(random, 5e-3, 0.02);
    aside[0] = uniform(random, 5e-3, 0.02);
    const auto rig = orThrow(buildRig(
        std::move(models),
        Intention::throughWaypoints({{0.0, above}, {0.5, pressed}, {1.0, pressed}, {1.2, aside}}),
        {}));
    ASSERT_TRUE(rig->renderer->arm());
    double low = 1e9, high = -1e9, rolled_m = 0.0;
    int touching = 0;
    runTicks(*rig->renderer, 10'000, [&](const TickRecord& record) {
      ASSERT_EQ(record.faults & kStoppingFaults, Fault::kNone);
      rolled_m = std::max(rolled_m, std::abs(record.bodies[3].position_m.x - 0.06));
      if (record.tick < 8'000) return;
      touching += record.contact_count > 0 ? 1 : 0;
      low = std::min(low, record.q_m[0]);
      high = std::max(high, record.q_m[0]);
    });
    SCOPED_TRACE("rollers of " + std::to_string(r) + " m");
    EXPECT_GT(touching, 1'900);
    EXPECT_GT(rolled_m, 2e-3);
    EXPECT_LE(high - low, 1e-4);
    worst_m = std::max(worst_m, high - low);
  }
  figure("a hand on a plate on rollers, swing of the device after 8 s", 1e3 * worst_m, "mm");
}

}  // namespace
}  // namespace wholehand::test
