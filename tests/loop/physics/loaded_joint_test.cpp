// Loaded bodies on joints against light free things: what loads a contact is force, not mass alone.
// Nothing is pressed into the table or into each other, and everything comes to rest.
#include "loop/physics/body_yard.hpp"
#include "support/figure.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand::test {
namespace {

using Eigen::Vector3d;

constexpr double kThing_m = 0.03, kThingHigh_m = 0.02;

/// What presses on the things.
enum class Press { kWeight, kSpring, kLid, kDoor, kDrawer };

struct Loading {
  Press press = Press::kWeight;
  bool round = false;
  double load_n = 40.0, thing_kg = 0.005, rate_hz = 1000.0;
  int things = 1;  ///< side by side, under a press from above
};

struct LoadedCourse {
  double sunk_m = 0.0;       ///< most that a thing's middle was lower than it should
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

/// A drawer whose spring presses the thing against the wall.
SceneBody drawerOf(const Loading& d) {
  SceneBody drawer = bodyOf(boxShape({0.2, 0.2, 0.1}), {kThing_m + 0.1, 0, 0.06}, 0.8, 0.5);
  drawer.joint.emplace();
  drawer.joint->type = SceneJoint::Type::kSlide;
  drawer.joint->axis = -Vector3d::UnitX();
  drawer.joint->least = -0.1, drawer.joint->most = 0.1;
  drawer.joint->spring_rest = 0.05;
  drawer.joint->spring_stiffness = d.load_n / 0.05;
  return drawer;
}

SceneBody pressOf(const Loading& d) {
  if (d.press == Press::kDoor) return doorOf(d);
  if (d.press == Press::kDrawer) return drawerOf(d);
  const double top_m = kThingHigh_m;
  const bool sprung = d.press == Press::kSpring;
  const double deep_m = d.things > 3 ? 0.14 : 0.1;
  SceneBody press = bodyOf(boxShape({0.16, deep_m, 0.04}), {0, 0, top_m + 0.02},
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
  const bool aside = d.press == Press::kDoor || d.press == Press::kDrawer;
  std::vector<SceneBody> bodies{ground(0.5), pressOf(d)};
  for (int i = 0; i < d.things; ++i) {
    const Vector3d at_m(aside           ? 0.5 * kThing_m
                        : d.things == 1 ? 0.0
                                        : 0.05 * (i % 3 - 1),
                        d.things > 3 ? 0.05 * (i / 3 - 0.5) : 0.0, 0.5 * kThingHigh_m);
    bodies.push_back(bodyOf(shape, at_m, d.thing_kg, 0.5));
  }
  if (aside) bodies.push_back(bodyOf(boxShape({0.04, 0.4, 0.2}), {-0.02, 0, 0.1}, 0.0, 0.5));
  Yard yard("bullet", bodies, {0, 0, -kGravity_m_s2}, d.rate_hz, turn, false);
  // Way of the press, and of the things, into what is behind them.
  const Vector3d into = aside ? Vector3d(-1, 0, 0) : Vector3d(0, 0, -1);
  const int last = 1 + d.things;
  std::vector<Vector3d> from_m;
  for (int i = 1; i <= last; ++i) from_m.push_back(yard.at(i));
  LoadedCourse course;
  const int steps = static_cast<int>(seconds * d.rate_hz);
  const auto late = static_cast<int>(2.0 * d.rate_hz);
  for (int k = 0; k < steps; ++k) {
    yard.step();
    for (int i = 1; i <= last; ++i) {
      double& deepest_m = i == 1 ? course.pressed_m : course.sunk_m;
      deepest_m = std::max(deepest_m, into.dot(yard.at(i) - from_m[i - 1]));
      if (k < late) continue;
      course.fastest_m_s =
          std::max({course.fastest_m_s, yard.velocity(i).norm(), 0.02 * yard.spin(i).norm()});
    }
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

TEST_F(LoadedJoint, LidOnSeveralLightDiscs_ComesToRest) {
  for (int i = 0; i < cases(10); ++i) {
    const Loading d{Press::kLid,
                    true,
                    uniform(random_, 0.3, 1.0) * kGravity_m_s2,
                    uniform(random_, 0.002, 0.01),
                    logUniform(random_, 500.0, kReducedCounts ? 1000.0 : 4000.0),
                    2 + static_cast<int>(random_() % 5)};
    expectStands(d, ("lid on " + std::to_string(d.things) + " discs").c_str());
  }
}

TEST_F(LoadedJoint, AnyLoadOnAnyThing_StandsAndRests) {
  LoadedCourse worst;
  int bad = 0;
  const int wanted = kReducedCounts ? 2 : cases(10);
  const auto first = static_cast<int>(random_() % 5);
  for (int i = 0; i < wanted; ++i) {
    Loading d;
    d.press = static_cast<Press>((i + first) % 5);
    if (d.press < Press::kDoor) d.things = 1 + static_cast<int>(random_() % 6);
    d.round = random_() % 2 == 0;
    d.load_n = logUniform(random_, 1.0, 200.0);
    d.thing_kg = logUniform(random_, 0.0005, 2.0);
    d.rate_hz = logUniform(random_, 500.0, 8000.0);
    const LoadedCourse course = runLoaded(d, anyTurn(random_), 2.1);
    const bool stands =
        course.sunk_m <= 1e-4 && course.pressed_m <= 1e-4 && course.fastest_m_s <= 1e-4;
    EXPECT_TRUE(stands) << "press " << static_cast<int>(d.press) << ", " << d.things
                        << (d.round ? " discs" : " boxes") << ", " << d.load_n << " N on "
                        << d.thing_kg << " kg at " << d.rate_hz << " Hz: sunk " << course.sunk_m
                        << " and " << course.pressed_m << " m, then " << course.fastest_m_s
                        << " m/s";
    bad += stands ? 0 : 1;
    worst.sunk_m = std::max({worst.sunk_m, course.sunk_m, course.pressed_m});
    worst.fastest_m_s = std::max(worst.fastest_m_s, course.fastest_m_s);
  }
  figure("loaded joints drawn", wanted, "");
  figure("of them that sink or move", bad, "");
  figure("loaded joints, sunk at most", 1e3 * worst.sunk_m, "mm");
  figure("loaded joints, fastest after 2 s", worst.fastest_m_s, "m/s");
}

}  // namespace
}  // namespace wholehand::test
