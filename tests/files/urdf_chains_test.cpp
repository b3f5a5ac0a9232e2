// URDFs whose joints move each other: trees with at most three coordinates load at the first try,
// the others are refused by the joint's name.
#include "files/scene/scene_file.hpp"
#include "files/scene_text.hpp"
#include "loop/model/scene_model.hpp"
#include "support/contains.hpp"
#include "support/folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace wholehand::test::urdf_trees {
namespace {

using Eigen::Vector3d;

std::string link(const std::string& name, const std::string& size = "0.1 0.02 0.2") {
  return "<link name=\"" + name + "\"><collision><geometry><box size=\"" + size +
         "\"/></geometry></collision></link>\n";
}
std::string joint(const std::string& name, const std::string& parent, const std::string& child,
                  const std::string& rest, const std::string& type = "revolute") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent +
         "\"/><child link=\"" + child + "\"/>" + rest + "</joint>\n";
}
const std::string kRange = "<axis xyz=\"0 0 1\"/><limit lower=\"0\" upper=\"1.5\"/>";
std::string at(const std::string& xyz) {
  return "<origin xyz=\"" + xyz + "\"/>";
}
std::string follow(const std::string& name, const std::string& more = "") {
  return "<axis xyz=\"0 0 1\"/><mimic joint=\"" + name + "\" " + more + "/>";
}

class UrdfChains : public ::testing::Test {
 protected:
  Expected<SceneModel> load(const std::string& text) {
    folder_.write("r.urdf", "<robot name=\"r\">\n" + text + "</robot>");
    return loadSceneFile(
        folder_.write("s.toml", kSceneHead + fileBody("u", "urdf", "r.urdf", 0.5)));
  }
  /// Loads, and fails the test with the faults if it cannot.
  SceneModel loaded(const std::string& text) {
    Expected<SceneModel> scene = load(text);
    EXPECT_TRUE(scene) << (scene ? "" : format(scene.errors()));
    return scene ? *scene : SceneModel{};
  }
  Folder folder_;
};

TEST_F(UrdfChains, HandleThatTurnsOnADoor_MovesWithTheDoor) {
  const SceneModel scene = loaded(
      link("case", "0.4 0.3 0.6") + link("door") + link("handle", "0.1 0.02 0.02") +
      joint("hinge", "case", "door", at("0.2 0 0") + kRange) +
      joint("turns", "door", "handle",
            at("0.05 -0.04 0") + "<axis xyz=\"0 1 0\"/><limit lower=\"-0.5\" upper=\"0.5\"/>"));
  const int door = scene.bodyIndex("u/door"), handle = scene.bodyIndex("u/handle");
  ASSERT_GE(door, 0);
  ASSERT_GE(handle, 0);
  EXPECT_EQ(scene.bodies[handle].joint->parent, door);
  EXPECT_EQ(scene.bodies[door].joint->parent, -1);
  EXPECT_LT((scene.bodies[handle].pose.translation_m - Vector3d(0.75, -0.04, 0.0)).norm(), 1e-12);
  const auto chains = jointChains(scene.bodies);
  ASSERT_EQ(chains.size(), 1U);
  EXPECT_EQ(chains[0], (std::vector<int>{door, handle}));
  EXPECT_TRUE(contains(format(scene.notices), "links of one object do not meet each other"));
}

// Two doors of one cabinet have nothing to do with each other.
TEST_F(UrdfChains, DoorsOfACabinet_MoveOnTheirOwn) {
  const SceneModel scene =
      loaded(link("case", "0.4 0.3 0.6") + link("left") + link("right") +
             joint("l", "case", "left", kRange) + joint("r", "case", "right", kRange));
  EXPECT_GE(scene.bodyIndex("u/left"), 0);
  EXPECT_GE(scene.bodyIndex("u/right"), 0);
  EXPECT_TRUE(jointChains(scene.bodies).empty());
}

// A joint that starts at the end of its range carries its children there.
TEST_F(UrdfChains, CarrierThatStartsElsewhere_TakesItsLinksAlong) {
  const SceneModel scene =
      loaded(link("stand") + link("arm") + link("tip") +
             joint("slides", "stand", "arm",
                   "<axis xyz=\"1 0 0\"/><limit lower=\"0.2\" upper=\"0.4\"/>", "prismatic") +
             joint("turns", "arm", "tip", at("0 0 0.3") + kRange));
  const int tip = scene.bodyIndex("u/tip");
  ASSERT_GE(tip, 0);
  EXPECT_LT((scene.bodies[tip].pose.translation_m - Vector3d(0.7, 0.0, 0.3)).norm(), 1e-12);
}

TEST_F(UrdfChains, Pliers_OpenByOneCoordinate) {
  const SceneModel scene =
      loaded(link("stand") + link("one") + link("two") + joint("a", "stand", "one", kRange) +
             joint("b", "stand", "two", follow("a", "multiplier=\"-0.5\" offset=\"0.1\"")));
  const int one = scene.bodyIndex("u/one"), two = scene.bodyIndex("u/two");
  ASSERT_GE(two, 0);
  const SceneJoint& follower = *scene.bodies[two].joint;
  EXPECT_EQ(follower.follows, one);
  EXPECT_EQ(follower.ratio, -0.5);
  // Its own q counts from where it starts: 0.1 rad, and it goes 0.75 rad back.
  EXPECT_NEAR(follower.least, -0.75, 1e-12);
  EXPECT_NEAR(follower.most, 0.0, 1e-12);
  EXPECT_NEAR(scene.bodies[two].pose.rotation(1, 0), std::sin(0.1), 1e-12);
}

TEST_F(UrdfChains, JointThatFollowsAFollower_GoesByBothRatios) {
  const SceneModel scene = loaded(link("stand") + link("one") + link("two") + link("three") +
                                  joint("c", "stand", "three", follow("b", "multiplier=\"3\"")) +
                                  joint("b", "stand", "two", follow("a", "multiplier=\"0.5\"")) +
                                  joint("a", "stand", "one", kRange));
  const int one = scene.bodyIndex("u/one"), three = scene.bodyIndex("u/three");
  ASSERT_GE(three, 0);
  EXPECT_EQ(scene.bodies[three].joint->follows, one);
  EXPECT_EQ(scene.bodies[three].joint->ratio, 1.5);
}

TEST_F(UrdfChains, FollowerThatEndsEarlier_EndsTheLeader) {
  const SceneModel scene =
      loaded(link("stand") + link("one") + link("two") + joint("a", "stand", "one", kRange) +
             joint("b", "stand", "two",
                   follow("a", "multiplier=\"-1\"") + "<limit lower=\"-0.6\" upper=\"0\"/>"));
  const int one = scene.bodyIndex("u/one");
  ASSERT_GE(one, 0);
  EXPECT_NEAR(scene.bodies[one].joint->most, 0.6, 1e-12);
  EXPECT_TRUE(contains(format(scene.notices), "joint[b]"));
  EXPECT_TRUE(contains(format(scene.notices), "ends the range of 'a', which it follows: 0 .. 0.6"));
}

// Helper links between two joints have neither collider nor mass.
TEST_F(UrdfChains, BareLinkBetweenJoints_CarriesTheNextOne) {
  const SceneModel scene =
      loaded(link("stand") + "<link name=\"bare\"/>" + link("knob") +
             joint("slides", "stand", "bare",
                   "<axis xyz=\"0 0 1\"/><limit lower=\"0\" upper=\"0.02\"/>", "prismatic") +
             joint("turns", "bare", "knob", "<axis xyz=\"0 0 1\"/>", "continuous"));
  const int bare = scene.bodyIndex("u/bare"), knob = scene.bodyIndex("u/knob");
  ASSERT_GE(bare, 0);
  ASSERT_GE(knob, 0);
  EXPECT_TRUE(scene.bodies[bare].shapes.empty());
  EXPECT_GT(scene.bodies[bare].mass_kg, 0.0);
  EXPECT_EQ(scene.bodies[knob].joint->parent, bare);
  EXPECT_TRUE(contains(format(scene.notices), "link[bare]: moves others and has neither"));
}

// The two fingers of a gripper: the second one turns the other way, and its range has the sign of
// the first one's.
TEST_F(UrdfChains, RangeOfAFollowerOnTheOtherSide_IsNotApplied) {
  const SceneModel scene =
      loaded(link("stand") + link("one") + link("two") + joint("a", "stand", "one", kRange) +
             joint("b", "stand", "two",
                   follow("a", "multiplier=\"-1\"") + "<limit lower=\"0\" upper=\"1.5\"/>"));
  const int one = scene.bodyIndex("u/one"), two = scene.bodyIndex("u/two");
  ASSERT_GE(two, 0);
  EXPECT_EQ(scene.bodies[one].joint->least, 0.0);
  EXPECT_EQ(scene.bodies[one].joint->most, 1.5);
  EXPECT_EQ(scene.bodies[two].joint->least, -1.5);
  EXPECT_EQ(scene.bodies[two].joint->most, 0.0);
  EXPECT_TRUE(contains(format(scene.notices),
                       "joint[b] = 0 .. 1.5: is not applied: it has no place in common with 'a'"));
}

}  // namespace
}  // namespace wholehand::test::urdf_trees
