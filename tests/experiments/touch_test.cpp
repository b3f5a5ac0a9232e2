// Every joint of a drawn object moves through its range by a touch, and the touch says what held
// one that does not.
#include "experiments/touch_trial.hpp"
#include "files/scene/scene_file.hpp"
#include "rig/engines.hpp"
#include "support/figure.hpp"
#include "support/folder.hpp"
#include "support/seed.hpp"
#include "support/shipped.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace wholehand::test::touches {
namespace {

std::string box(const std::string& name, double x, double y, double z, double at_x = 0.0,
                double at_y = 0.0, double at_z = 0.0) {
  return fmt::format(
      "<link name=\"{}\"><collision><origin xyz=\"{} {} {}\"/><geometry><box size=\"{} {} {}\"/>"
      "</geometry></collision></link>\n",
      name, at_x, at_y, at_z, x, y, z);
}
std::string joint(const std::string& type, const std::string& parent, const std::string& child,
                  const std::string& axis, const std::string& at, double least, double most,
                  double friction = 0.5, const std::string& more = "") {
  return fmt::format(
      "<joint name=\"{}_joint\" type=\"{}\"><parent link=\"{}\"/><child link=\"{}\"/>"
      "<origin xyz=\"{}\"/><axis xyz=\"{}\"/><limit lower=\"{}\" upper=\"{}\"/>"
      "<dynamics friction=\"{}\"/>{}</joint>\n",
      child, type, parent, child, at, axis, least, most, friction, more);
}

std::vector<TouchedJoint> touched(const std::string& links) {
  const Folder folder;
  const auto scene =
      loadSceneFile(folder.write("o.urdf", "<robot name=\"o\">\n" + links + "</robot>\n"));
  EXPECT_TRUE(scene) << (scene ? "" : format(scene.errors()));
  if (!scene) return {};
  auto joints = touchJoints(*scene, defaultEngine());
  EXPECT_TRUE(joints) << (joints ? "" : format(joints.errors()));
  return joints ? *joints : std::vector<TouchedJoint>{};
}

/// A cabinet of thin walls, open in front (-x).
std::string shell(double depth, double wide, double high) {
  return fmt::format(
      "<link name=\"case\"><collision><origin xyz=\"{} 0 0\"/><geometry><box size=\"0.01 {} {}\"/>"
      "</geometry></collision></link>\n",
      0.5 * depth, wide, high);
}

TEST(Touch, DrawnFurniture_MovesThroughItsRange) {
  std::mt19937_64 random(seed() + 162);
  int joints = 0, helped = 0;
  for (int i = 0; i < (kReducedCounts ? 3 : 12); ++i) {
    const double wide = uniform(random, 0.2, 0.8), high = uniform(random, 0.2, 0.8),
                 depth = uniform(random, 0.2, 0.6), opens = uniform(random, 0.4, 1.8);
    std::string text = shell(depth, wide, high);
    switch (i % 4) {
      case 0: {  // a door and a handle that turns in it
        const double side = random() % 2 == 0 ? 0.5 : -0.5;
        text += box("door", 0.02, wide, high, 0.0, -side * wide, 0.0) +
                joint("revolute", "case", "door", side > 0 ? "0 0 1" : "0 0 -1",
                      fmt::format("{} {} 0", -0.5 * depth, side * wide), 0.0, opens) +
                box("handle", 0.02, 0.1, 0.02, -0.03, 0.04, 0.0) +
                joint("revolute", "door", "handle", "1 0 0",
                      fmt::format("0 {} 0", -1.6 * side * wide), -0.5, 0.5, 0.1);
        break;
      }
      case 1:  // a drawer with a bar before its front
        text += box("drawer", depth, 0.9 * wide, 0.9 * high) + box("bar", 0.02, 0.1, 0.02) +
                "<joint name=\"b\" type=\"fixed\"><parent link=\"drawer\"/><child link=\"bar\"/>" +
                fmt::format("<origin xyz=\"{} 0 0\"/></joint>", -0.5 * depth - 0.05) +
                joint("prismatic", "case", "drawer", "-1 0 0", "0 0 0", 0.0, 0.8 * depth);
        break;
      case 2:  // a lid under gravity
        text += box("lid", depth, wide, 0.02, 0.5 * depth) +
                joint("revolute", "case", "lid", "0 -1 0",
                      fmt::format("{} 0 {}", -0.5 * depth, 0.6 * high), 0.0, opens);
        break;
      default:  // a knob, which is turned by friction alone, and a pointer that follows it
        text +=
            "<link name=\"knob\"><collision><geometry><cylinder radius=\"0.03\" "
            "length=\"0.03\"/></geometry></collision></link>" +
            joint("continuous", "case", "knob", "0 0 1", fmt::format("{} 0 0", -0.5 * depth - 0.1),
                  -1.0, 1.0, 0.05) +
            box("pointer", 0.05, 0.01, 0.01, 0.05) +
            joint("revolute", "case", "pointer", "0 0 1",
                  fmt::format("{} 0 0.3", -0.5 * depth - 0.1), -7.0, 7.0, 0.0,
                  "<mimic joint=\"knob_joint\" multiplier=\"0.5\"/>");
    }
    for (const TouchedJoint& joint : touched(text)) {
      ++joints;
      helped += joint.help != TouchHelp::kNone ? 1 : 0;
      EXPECT_TRUE(joint.moves()) << i << ": " << joint.body << " " << joint.reached_least << " .. "
                                 << joint.reached_most << " of " << joint.least << " .. "
                                 << joint.most << ", " << joint.in_the_way;
    }
  }
  figure("joints of drawn furniture", joints, "");
  figure("of them moved only with others held or cleared", helped, "");
}

// Every joint of every scene that ships, in the scene as it is.
TEST(Touch, JointsOfTheShippedScenes_MoveThroughTheirRanges) {
  int joints = 0;
  for (const std::string& name : shipped("scenes")) {
    const auto scene = loadSceneFile(WHOLEHAND_SOURCE_DIR "/config/scenes/" + name + ".toml");
    ASSERT_TRUE(scene) << format(scene.errors());
    if (scene->recordedJoints().empty()) continue;
    const auto touched = touchJoints(*scene, defaultEngine());
    ASSERT_TRUE(touched) << format(touched.errors());
    for (const TouchedJoint& joint : *touched) {
      ++joints;
      EXPECT_TRUE(joint.moves()) << name << ": " << joint.body;
      EXPECT_EQ(joint.help, TouchHelp::kNone) << name << ": " << joint.body;
    }
  }
  EXPECT_GE(joints, 6);
}

// The finger pushes with 100 N at most: dry friction below moves, above holds.
TEST(Touch, DryFrictionOfASlide_HoldsBeyondTheForceOfTheFinger) {
  for (const double friction_n : {90.0, 110.0}) {
    const auto slides =
        touched(shell(0.4, 0.4, 0.4) + box("drawer", 0.3, 0.3, 0.1) +
                joint("prismatic", "case", "drawer", "-1 0 0", "-0.5 0 0", 0.0, 0.2, friction_n));
    ASSERT_EQ(slides.size(), 1U);
    EXPECT_EQ(slides[0].moves(), friction_n < 100.0);
    EXPECT_EQ(slides[0].cannotMove(), friction_n > 100.0);
    EXPECT_NEAR(slides[0].most_effort, 100.0, 1e-9);
    EXPECT_LE(slides[0].force_n, 100.0 + 1e-9);
    if (friction_n > 100.0) EXPECT_LT(slides[0].reached_most, 1e-4);
  }
}

// A wheel without friction has no surface that a force can push round its axis: its effort is 0.
// With friction µ at the rim a force of F has µ F r / √(1 + µ²) at most.
TEST(Touch, WheelWithoutFriction_CannotBeTurned) {
  const double radius_m = 0.03;
  for (const double friction : {0.0, 0.5}) {
    const auto wheels = touched(
        shell(0.4, 0.4, 0.4) + "<link name=\"wheel\">" +
        fmt::format("<contact><lateral_friction value=\"{}\"/></contact>", friction) +
        fmt::format("<collision><geometry><cylinder radius=\"{}\" length=\"0.02\"/></geometry>"
                    "</collision></link>",
                    radius_m) +
        joint("continuous", "case", "wheel", "0 0 1", "-0.5 0 0", -1.0, 1.0, 0.001));
    ASSERT_EQ(wheels.size(), 1U);
    EXPECT_EQ(wheels[0].moves(), friction > 0.0);
    EXPECT_EQ(wheels[0].cannotMove(), friction == 0.0);
    const double between = std::sqrt(0.8 * friction);  // of hand and wheel
    EXPECT_NEAR(wheels[0].most_effort, 100.0 * radius_m * between / std::hypot(1.0, between), 1e-9);
  }
}

// What lies within another part moves only without that part, which passes it but not the finger.
TEST(Touch, HiddenDrawer_MovesOnceTheOtherPartsAreTakenAway) {
  const auto hidden = touched(box("case", 0.6, 0.6, 0.6) + box("drawer", 0.1, 0.3, 0.1) +
                              joint("prismatic", "case", "drawer", "-1 0 0", "0 0 0", 0.0, 0.1));
  ASSERT_EQ(hidden.size(), 1U);
  EXPECT_TRUE(hidden[0].moves());
  EXPECT_EQ(hidden[0].help, TouchHelp::kCleared);
}

}  // namespace
}  // namespace wholehand::test::touches
