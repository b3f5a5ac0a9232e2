// Ends of joints as public URDFs write them: what says "no end" is read so and said in one line,
// what may be another unit is refused.
#include "files/scene/scene_file.hpp"
#include "files/scene_text.hpp"
#include "loop/model/scene_model.hpp"
#include "support/contains.hpp"
#include "support/figure.hpp"
#include "support/folder.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace wholehand::test::urdf_limits {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
const std::string kBox =
    "<collision><geometry><box size=\"0.1 0.1 0.1\"/></geometry></collision></link>\n";

class UrdfLimits : public ::testing::Test {
 protected:
  Expected<SceneModel> loadText(const std::string& text) {
    folder_.write("r.urdf", "<robot name=\"r\">\n" + text + "</robot>");
    return loadSceneFile(
        folder_.write("s.toml", kSceneHead + fileBody("u", "urdf", "r.urdf", 0.5)));
  }
  /// A stand, and a lid on a joint with this content.
  Expected<SceneModel> load(const std::string& type, const std::string& content,
                            const std::string& of_lid = "") {
    return loadText("<link name=\"stand\">" + kBox + "<link name=\"lid\">" + of_lid + kBox +
                    "<joint name=\"j\" type=\"" + type +
                    "\"><parent link=\"stand\"/><child link=\"lid\"/>" + content + "</joint>\n");
  }
  Folder folder_;
};

TEST_F(UrdfLimits, PlaceholdersOfNoEnd_AreReadAndNamed) {
  const struct {
    std::string type, limit;
    double least, most;
    std::string said;
  } cases[] = {
      {"revolute", "", -kInfinity, kInfinity, "joint[j].limit: has no ends: it turns without end"},
      {"revolute", "<limit effort=\"9\" velocity=\"9\"/>", -kInfinity, kInfinity, "has no ends"},
      {"revolute", "<limit lower=\"1\" upper=\"0\"/>", -kInfinity, kInfinity,
       "joint[j].limit = 1 .. 0: has no ends: 1 .. 0 says so to Bullet: it turns without end"},
      {"revolute", "<limit lower=\"1\" upper=\"-1\"/>", -kInfinity, kInfinity, "says so to Bullet"},
      {"revolute", "<limit lower=\"-1e+16\" upper=\"1e+16\"/>", -kInfinity, kInfinity,
       "is no limit where it is beyond 1000 rad: it turns on"},
      {"revolute", "<limit lower=\"-0.5\" upper=\"3.4e38\"/>", -0.5, kInfinity, "it turns on"},
      {"revolute", "<limit lower=\"-inf\" upper=\" inf \"/>", -kInfinity, kInfinity, "it turns on"},
      {"prismatic", "", -10.0, 10.0, "joint[j].limit: has no ends: it slides 10 m both ways"},
      {"prismatic", "<limit lower=\"-15\" upper=\"15\"/>", -10.0, 10.0,
       "joint[j].limit = -15 .. 15: is no limit where it is beyond 10 m: it ends there"},
      {"prismatic", "<limit lower=\"-1000\" upper=\"1000\"/>", -10.0, 10.0, "it ends there"},
      {"prismatic", "<limit lower=\"0\" upper=\"1e16\"/>", 0.0, 10.0, "it ends there"},
      {"prismatic", "<limit lower=\"-Infinity\" upper=\"0.2\"/>", -10.0, 0.2, "it ends there"},
  };
  for (const auto& c : cases) {
    const Expected<SceneModel> scene = load(c.type, c.limit);
    ASSERT_TRUE(scene) << c.limit << format(scene.errors());
    ASSERT_EQ(scene->bodies.size(), 2U) << c.limit;
    EXPECT_EQ(scene->bodies[1].joint->least, c.least) << c.limit;
    EXPECT_EQ(scene->bodies[1].joint->most, c.most) << c.limit;
    EXPECT_TRUE(contains(format(scene->notices), c.said));
  }
}

TEST_F(UrdfLimits, OrdinaryRanges_AreNotRemarked) {
  for (const char* limit : {"lower=\"-12.5\" upper=\"12.5\"", "lower=\"0\" upper=\"1\"",
                            "lower=\"-1\" upper=\"0\"", "upper=\"1\""}) {
    const SceneModel scene = orThrow(load("revolute", std::string("<limit ") + limit + "/>"));
    EXPECT_FALSE(contains(format(scene.notices), "limit")) << format(scene.notices);
  }
}

// 100 N at the lid's edge, 70.7 mm from the axis, are 7.07 N·m.
TEST_F(UrdfLimits, DryFrictionThatNoHandOvercomes_IsNamed) {
  const auto said = [&](const std::string& type, double friction) {
    return format(orThrow(load(type, "<limit lower=\"0\" upper=\"1\"/><dynamics friction=\"" +
                                         std::to_string(friction) + "\"/>"))
                      .notices);
  };
  EXPECT_FALSE(contains(said("revolute", 7.0), "is held by"));
  EXPECT_FALSE(contains(said("prismatic", 99.0), "is held by"));
  EXPECT_TRUE(contains(said("revolute", 7.1), "link[lid]: is held by a dry friction of 7.1 N·m"));
  EXPECT_TRUE(contains(said("prismatic", 100.0), "link[lid]: is held by a dry friction of 100 N:"));
}

// An exporter writes 0 .. 0 for a joint that its author did not fill: it holds, as the file says.
TEST_F(UrdfLimits, RangeOfOnePlace_HoldsTheLink) {
  for (const char* limit : {"lower=\"0\" upper=\"0\"", "lower=\"0.3\" upper=\"0.3\""}) {
    const SceneModel scene =
        orThrow(load("revolute", std::string("<limit ") + limit + "/>",
                     "<inertial><mass value=\"1\"/><inertia ixx=\"0.01\" iyy=\"0.01\" "
                     "izz=\"0.01\"/></inertial>"));
    ASSERT_EQ(scene.bodies.size(), 1U);
    EXPECT_EQ(scene.bodies[0].shapes.size(), 2U);
    EXPECT_FALSE(scene.bodies[0].fixed);
    EXPECT_TRUE(contains(format(scene.notices), "is one place: the joint does not move"));
  }
}

// A second <limit> that gives an effort only says nothing about the ends.
TEST_F(UrdfLimits, SecondLimitWithoutEnds_LeavesThoseOfTheFirst) {
  for (const char* limits : {"<limit lower=\"-0.05\" upper=\"0\"/><limit effort=\"1\"/>",
                             "<limit effort=\"1\"/><limit lower=\"-0.05\" upper=\"0\"/>"}) {
    const SceneModel scene = orThrow(load("prismatic", limits));
    EXPECT_EQ(scene.bodies[1].joint->least, -0.05);
    EXPECT_EQ(scene.bodies[1].joint->most, 0.0);
  }
}

// Bullet reads a mass of 0 of a link on a joint as any mass; here its colliders give it one.
TEST_F(UrdfLimits, LinkOfNoMassOnAJoint_IsWeighedByItsColliders) {
  const SceneModel scene = orThrow(
      load("revolute", "<limit lower=\"0\" upper=\"1\"/>",
           "<inertial><mass value=\".0\"/><inertia ixx=\"0\" iyy=\"0\" izz=\"0\"/></inertial>"));
  EXPECT_NEAR(scene.bodies[1].mass_kg, 0.6, 1e-12);  // 1000 cm³ at 600 kg/m³
  const std::string notices = format(scene.notices);
  EXPECT_TRUE(contains(notices, "link[lid].inertial.mass.value = 0: is no mass: it is not used"));
  EXPECT_TRUE(contains(notices, "has no <inertial>: 0.6 kg, at 600 kg/m³"));
}

TEST_F(UrdfLimits, WorldThatTheFileDoesNotHold_HoldsItsChildren) {
  const SceneModel scene = orThrow(
      loadText("<link name=\"lid\">" + kBox +
               "<joint name=\"j\" type=\"revolute\"><origin xyz=\"0 0 0.2\"/><parent "
               "link=\"world\"/><child link=\"lid\"/><axis xyz=\"0 0 1\"/><limit lower=\"0\" "
               "upper=\"1\"/></joint>\n"));
  const int lid = scene.bodyIndex("u/lid");
  ASSERT_GE(lid, 0);
  EXPECT_NEAR(scene.bodies[lid].pose.translation_m.z(), 0.2, 1e-12);
  // A name that is no link, and is not that of the world, is a fault.
  EXPECT_TRUE(
      contains(format(loadText("<link name=\"lid\">" + kBox +
                               "<joint name=\"j\" type=\"fixed\"><parent link=\"wordl\"/><child "
                               "link=\"lid\"/></joint>\n")
                          .errors()),
               "there is no link of that name"));
}

TEST_F(UrdfLimits, CommasBetweenNumbers_AreBlanks) {
  const SceneModel scene = orThrow(load(
      "revolute", "<origin xyz=\"0.1, 0,\t0.3\"/><axis xyz=\"0, 1, 0\"/><limit upper=\"1\"/>"));
  EXPECT_NEAR(scene.bodies[1].pose.translation_m.z(), 0.3, 1e-12);
  EXPECT_EQ(scene.bodies[1].joint->axis.y(), 1.0);
}

// A hammer of which only the handle has a collider: its head is seen, and has most of its mass. The
// head is 200 g within 5 cm of a place 12 cm beside the handle's middle.
TEST_F(UrdfLimits, MassWhereABodyIsOnlySeen_IsPossible) {
  const std::string inertial =
      "<inertial><origin xyz=\"0.12 0 0\"/><mass value=\"0.2\"/><inertia ixx=\"8e-5\" "
      "iyy=\"8e-5\" izz=\"8e-5\"/></inertial>";
  const std::string handle =
      "<collision><geometry><box size=\"0.1 0.02 0.02\"/></geometry></collision>";
  const auto load = [&](const std::string& visual) {
    return loadText("<link name=\"hammer\">" + inertial + handle + visual + "</link>\n");
  };
  folder_.write("head.obj",
                "v -50 -50 -50\nv 50 -50 -50\nv -50 50 -50\nv -50 -50 50\nv 50 50 50\n"
                "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 5\nf 2 5 4\nf 3 4 5\n");
  const std::string at = "<visual><origin xyz=\"0.12 0 0\"/><geometry>";
  const struct {
    std::string visual;
    bool possible;
    std::size_t assets;
  } cases[] = {
      {"", false, 1},
      {at + "<box size=\"0.1 0.1 0.1\"/></geometry></visual>", true, 1},
      {at + "<sphere radius=\"0.05\"/></geometry></visual>", true, 1},
      {at + "<cylinder radius=\"0.05\" length=\"0.1\"/></geometry></visual>", true, 1},
      {at + "<mesh filename=\"head.obj\" scale=\"0.001 0.001 0.001\"/></geometry></visual>", true,
       2},
      // Seen in millimetres of millimetres, elsewhere, or not at all.
      {at + "<mesh filename=\"head.obj\" scale=\"1e-6 1e-6 1e-6\"/></geometry></visual>", false, 2},
      {"<visual><geometry><box size=\"0.1 0.1 0.1\"/></geometry></visual>", false, 1},
      {at + "<mesh filename=\"gone.obj\"/></geometry></visual>", false, 1},
      {at + "<box size=\"wide\"/></geometry></visual><visual/>", false, 1},
  };
  for (const auto& c : cases) {
    const SceneModel scene = orThrow(load(c.visual));
    EXPECT_EQ(scene.bodies[0].inertia_kg_m2(0, 0) == 8e-5, c.possible) << c.visual;
    EXPECT_EQ(contains(format(scene.notices), "no such body has"), !c.possible) << c.visual;
    // A replay needs what decided.
    EXPECT_EQ(scene.assets.size(), c.assets) << c.visual;
  }
}

}  // namespace
}  // namespace wholehand::test::urdf_limits
