// Loaded bodies on joints against light free things: what loads a contact is force, not mass alone.
// Nothing is pressed into the table or into each other, and everything comes to rest.
#include "loop/physics/body_yard.hpp"
#include "loop/physics/still_hand.hpp"
#include "support/figure.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand::test {
namespace {

using Eigen::Vector3d;

constexpr double kThing_m = 0.03, kThingHigh_m = 0.02;

/// What presses on the thing.
enum class Press { kWeight, kSpring, kLid, kDoor };

struct Loading {
  Press press = Press::kWeight;
  bool round = false;
  double load_n = 40.0, thing_kg = 0.005, rate_hz = 1000.0;
};

struct LoadedCourse {
  double sunk_m = 0.0;       ///< most that the thing's middle was lower than it should
  double pressed_m = 0.0;    ///< most that the press was lower than it should
  double fastest_m_s = 0.0;  ///< of all bodies, after 2 s
};

/// A door on a hinge at y = -0.25 m, whose spring presses the thing against the wall.
SceneBody doorOf(const Loading& d) {
  SceneBody door = bodyOf(boxShape({0.02, 0.3, 0.2}), {kThing_m + 0.01, -0.1, 0.1}, 1.5, 0.5);
  door.joint.emplace();
  door.joint->axis = Vector3d::UnitZ();  // at +q it comes towards the wall
  door.joint->point_m = {0.0, -0.15, 0.0};
  door.joint->least = -1.0, door.joint->most = 1.0;
  door.joint->spring_rest = 0.5;
  door.joint->spring_stiffness = 0.25 * d.load_n / 0.5;
  return door;
}

SceneBody pressOf(const Loading& d) {
  if (d.press == Press::kDoor) return doorOf(d);
  const double top_m = kThingHigh_m;
  const bool sprung = d.press == Press::kSpring;
  SceneBody press = bodyOf(boxShape({0.1, 0.1, 0.04}), {0, 0, top_m + 0.02},
                           sprung ? 0.5 : d.load_n / kGravity_m_s2, 0.5);
  SceneJoint joint;
  if (d.press == Press::kLid) {
    // Hinged 0.2 m beside the thing.
    joint.axis = Vector3d::UnitY();
    joint.point_m = {-0.2, 0.0, -0.02};
    joint.least = -0.5, joint.most = 1.0;
  } else {
    joint.type = SceneJoint::Type::kSlide;
    joint.axis = -Vector3d::UnitZ();
    joint.least = 0.0, joint.most = 0.1;
  }
  if (sprung) {
    joint.spring_stiffness = 1000.0;
    joint.spring_rest = (d.load_n - 0.5 * kGravity_m_s2) / 1000.0;
    joint.least = -0.1;
  }
  press.joint = joint;
  return press;
}

LoadedCourse runLoaded(const Loading& d, const Eigen::Matrix3d& turn, double seconds) {
  const Shape shape = d.round ? roundShape(ShapeType::kCylinder, 0.5 * kThing_m, kThingHigh_m)
                              : boxShape({kThing_m, kThing_m, kThingHigh_m});
  const bool door = d.press == Press::kDoor;
  std::vector<SceneBody> bodies{
      ground(0.5),
      bodyOf(shape, {door ? 0.5 * kThing_m : 0.0, 0, 0.5 * kThingHigh_m}, d.thing_kg, 0.5),
      pressOf(d)};
  if (door) bodies.push_back(bodyOf(boxShape({0.04, 0.4, 0.2}), {-0.02, 0, 0.1}, 0.0, 0.5));
  Yard yard("bullet", bodies, {0, 0, -kGravity_m_s2}, d.rate_hz, turn, false);
  // Way of body 1, and of body 2, into what is behind it.
  const Vector3d into = door ? Vector3d(-1, 0, 0) : Vector3d(0, 0, -1);
  const Vector3d thing_m = yard.at(1), press_m = yard.at(2);
  LoadedCourse course;
  const int steps = static_cast<int>(seconds * d.rate_hz);
  const auto late = static_cast<int>(2.0 * d.rate_hz);
  for (int k = 0; k < steps; ++k) {
    yard.step();
    course.sunk_m = std::max(course.sunk_m, into.dot(yard.at(1) - thing_m));
    course.pressed_m = std::max(course.pressed_m, into.dot(yard.at(2) - press_m));
    if (k < late) continue;
    course.fastest_m_s = std::max({course.fastest_m_s, yard.velocity(1).norm(),
                                   0.02 * yard.spin(1).norm(), yard.velocity(2).norm()});
  }
  return course;
}

class LoadedJoint : public ::testing::Test {
 protected:
  void expectStands(const Loading& d, const char* name) {
    const LoadedCourse course = runLoaded(d, anyTurn(random_), 2.2);
    figure(std::string(name) + ": sunk", 1e3 * course.sunk_m, "mm");
    figure(std::string(name) + ": press sunk", 1e3 * course.pressed_m, "mm");
    figure(std::string(name) + ": fastest after 2 s", course.fastest_m_s, "m/s");
    EXPECT_LE(course.sunk_m, 1e-4) << name;
    EXPECT_LE(course.pressed_m, 1e-4) << name;
    EXPECT_LE(course.fastest_m_s, 1e-4) << name;
  }
  std::mt19937_64 random_{seed()};
};

TEST_F(LoadedJoint, PressOnALightDisc_DoesNotPushItThroughTheTable) {
  expectStands({Press::kWeight, true, 40.0, 0.005, 1000.0}, "40 N on a disc of 5 g");
  expectStands({Press::kSpring, true, 40.0, 0.005, 1000.0}, "spring of 40 N on a disc of 5 g");
  expectStands({Press::kSpring, true, 10.0, 0.0005, 1000.0}, "spring of 10 N on a disc of 0.5 g");
}

TEST_F(LoadedJoint, DoorOnASmallBox_DoesNotPressItThroughTheWall) {
  expectStands({Press::kDoor, false, 20.0, 0.002, 1000.0}, "door of 20 N on a box of 2 g");
  expectStands({Press::kDoor, true, 40.0, 0.005, 1000.0}, "door of 40 N on a disc of 5 g");
}

TEST_F(LoadedJoint, LidOnLightDiscs_ComesToRest) {
  expectStands({Press::kLid, true, 0.3 * kGravity_m_s2, 0.002, 1000.0}, "lid of 0.3 kg on 2 g");
  expectStands({Press::kLid, true, 1.0 * kGravity_m_s2, 0.01, 1000.0}, "lid of 1 kg on 10 g");
}

TEST_F(LoadedJoint, AnyLoadOnAnyThing_StandsAndRests) {
  LoadedCourse worst;
  int bad = 0;
  const int wanted = cases(4);
  for (int i = 0; i < wanted; ++i) {
    Loading d;
    d.press = static_cast<Press>(i % 4);
    d.round = random_() % 2 == 0;
    d.load_n = logUniform(random_, 1.0, 200.0);
    d.thing_kg = logUniform(random_, 0.0005, 2.0);
    d.rate_hz = logUniform(random_, 500.0, 8000.0);
    const LoadedCourse course = runLoaded(d, anyTurn(random_), 2.1);
    const bool stands =
        course.sunk_m <= 1e-4 && course.pressed_m <= 1e-4 && course.fastest_m_s <= 1e-4;
    EXPECT_TRUE(stands) << "press " << i % 4 << (d.round ? ", disc" : ", box") << ", " << d.load_n
                        << " N on " << d.thing_kg << " kg at " << d.rate_hz << " Hz: sunk "
                        << course.sunk_m << " and " << course.pressed_m << " m, then "
                        << course.fastest_m_s << " m/s";
    bad += stands ? 0 : 1;
    worst.sunk_m = std::max({worst.sunk_m, course.sunk_m, course.pressed_m});
    worst.fastest_m_s = std::max(worst.fastest_m_s, course.fastest_m_s);
  }
  figure("loaded joints drawn", wanted, "");
  figure("of them that sink or move", bad, "");
  figure("loaded joints, sunk at most", 1e3 * worst.sunk_m, "mm");
  figure("loaded joints, fastest after 2 s", worst.fastest_m_s, "m/s");
}

/// A wall beside the hand on a joint whose end keeps it from giving way outwards.
SceneBody jaw(const Vector3d& along, double face_m, bool hinge, double mass_kg) {
  SceneBody body = wall(along, face_m);
  body.fixed = false;
  body.mass_kg = mass_kg;
  const ShapeMoments about = moments(body.shapes[0]);
  body.inertia_kg_m2 = mass_kg / about.volume_m3 * about.inertia_m5;
  SceneJoint joint;
  joint.axis = hinge ? Vector3d(0, 0, along.y()) : -along;
  if (hinge) joint.point_m = {-0.4, 0.0, 0.0};  // at +q the jaw comes towards the hand
  if (hinge) joint.axis = -joint.axis;
  if (!hinge) joint.type = SceneJoint::Type::kSlide;
  joint.least = 0.0, joint.most = 0.05;
  body.joint = joint;
  return body;
}

// A joint at its end is a wall: jaws that are too near press the hand by the depth of each contact,
// 2.5 N/µm beyond the 10 µm at which contacts rest.
TEST(JawsAtTheirEnds, WedgeTheHandAsWallsDo) {
  std::mt19937_64 random(seed());
  const HandModel& model = hand();
  const double left_m = reach(model, AxisPosition(6), Vector3d::UnitY());
  const double right_m = reach(model, AxisPosition(6), -Vector3d::UnitY());
  double worst = 0.0;
  for (int i = 0; i < cases(4); ++i) {
    const double depth_m = uniform(random, 2e-5, 4e-5);
    const auto any_jaw = [&](const Vector3d& along, double reach_m) {
      return i == 0
                 ? wall(along, reach_m - depth_m)
                 : jaw(along, reach_m - depth_m, random() % 2 == 0, logUniform(random, 0.1, 5.0));
    };
    Bench bench("bullet", weightless({any_jaw(Vector3d::UnitY(), left_m),
                                      any_jaw(-Vector3d::UnitY(), right_m)}));
    ASSERT_TRUE(bench.world->placeHand(AxisPosition(6)));
    int pressed = 0;
    double off = 0.0, most_n = 0.0;
    for (int k = 0; k < 1500; ++k) {
      ASSERT_NO_FATAL_FAILURE(bench.step(AxisPosition(6), AxisVelocity(6)));
      if (k < 1400) continue;
      for (int c = 0; c < bench.touching.count; ++c) {
        const Contact& contact = bench.touching.points[c];
        const double depth_n = 2.5e6 * std::max(0.0, -contact.distance_m - 1e-5);
        if (depth_n < 2.0) continue;
        ++pressed;
        most_n = std::max(most_n, contact.force_n.eigen().norm());
        off = std::max(
            off, std::abs(contact.normal.eigen().dot(contact.force_n.eigen()) / depth_n - 1.0));
      }
    }
    ASSERT_GT(pressed, 100) << "jaws " << i;
    EXPECT_LE(off, tolerance(0.08)) << "jaws " << i << ", " << most_n << " N";
    worst = std::max(worst, off);
  }
  figure("hand between jaws at their ends, force against depth, worst", 100.0 * worst, "%");
}

}  // namespace
}  // namespace wholehand::test
