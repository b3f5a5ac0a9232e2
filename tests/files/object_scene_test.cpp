// A URDF given in place of a scene: the object stands before the hand, and the scene that was made
// of it is a scene file that reads back as the same scene.
#include "files/scene/object_scene.hpp"

#include "files/scene/scene_file.hpp"
#include "loop/model/scene_model.hpp"
#include "support/contains.hpp"
#include "support/folder.hpp"
#include "support/seed.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <string>

namespace wholehand::test::objects {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

std::string place(const Vector3d& xyz) {
  return fmt::format("<origin xyz=\"{} {} {}\"/>", xyz.x(), xyz.y(), xyz.z());
}
std::string link(const std::string& name, const Vector3d& size_m, const Vector3d& at_m) {
  return fmt::format(
      "<link name=\"{}\"><collision>{}<geometry><box size=\"{} {} {}\"/></geometry></collision>"
      "</link>",
      name, place(at_m), size_m.x(), size_m.y(), size_m.z());
}
std::string joint(const std::string& type, const std::string& child, const std::string& axis,
                  const Vector3d& at_m, double upper) {
  return fmt::format(
      "<joint name=\"{0}_j\" type=\"{1}\"><parent link=\"base\"/><child link=\"{0}\"/>{2}"
      "<axis xyz=\"{3}\"/><limit lower=\"0\" upper=\"{4}\"/></joint>",
      child, type, place(at_m), axis, upper);
}
std::string robot(const std::string& content) {
  return "<robot name=\"r\">" + content + "</robot>";
}

AlignedBox3d boxOf(const SceneBody& body) {
  AlignedBox3d box;
  for (const Shape& shape : body.shapes) {
    for (const Vector3d& p : boundingPoints(shape)) box.extend(body.pose * p);
  }
  return box;
}
SceneModel loaded(const std::string& path) {
  auto scene = loadSceneFile(path);
  EXPECT_TRUE(scene) << (scene ? "" : format(scene.errors()));
  return scene ? *scene : SceneModel{};
}

void expectSame(const SceneModel& a, const SceneModel& b) {
  ASSERT_EQ(a.bodies.size(), b.bodies.size());
  EXPECT_EQ(a.gravity_m_s2, b.gravity_m_s2);
  for (std::size_t i = 0; i < a.bodies.size(); ++i) {
    const SceneBody &one = a.bodies[i], &two = b.bodies[i];
    EXPECT_EQ(one.name, two.name);
    EXPECT_EQ(one.fixed, two.fixed);
    EXPECT_EQ(one.mass_kg, two.mass_kg);
    EXPECT_EQ(one.com_m, two.com_m);
    EXPECT_EQ(one.inertia_kg_m2, two.inertia_kg_m2);
    EXPECT_EQ(one.pose.translation_m, two.pose.translation_m);
    EXPECT_EQ(one.pose.rotation, two.pose.rotation);
    EXPECT_EQ(one.shapes.size(), two.shapes.size());
    EXPECT_EQ(one.joint.has_value(), two.joint.has_value());
  }
}

// A recording holds the made scene, and runs again from it: to the bit the same.
TEST(ObjectScene, SceneMadeOfADrawnUrdf_ReadsBackAndStandsBeforeTheHand) {
  std::mt19937_64 random(seed() + 62);
  const Folder folder;
  for (int i = 0; i < 60; ++i) {
    const auto any = [&](double low, double high) {
      return Vector3d(uniform(random, low, high), uniform(random, low, high),
                      uniform(random, low, high));
    };
    const int kind = static_cast<int>(random() % 3);  // free, a drawer, a door
    std::string text = link("base", any(0.02, 0.6), any(-0.4, 0.4));
    if (kind > 0) text += link("moves", any(0.02, 0.3), any(-0.2, 0.2));
    const std::string axis = random() % 2 == 0 ? "1 0 0" : "0 -1 0";
    if (kind == 1) text += joint("prismatic", "moves", axis, any(-0.3, 0.3), 0.3);
    if (kind == 2) text += joint("revolute", "moves", "0 0 1", any(-0.3, 0.3), 1.4);
    const std::string path = folder.write(fmt::format("thing {}.urdf", i), robot(text));
    const SceneModel scene = loaded(path);
    ASSERT_FALSE(scene.bodies.empty());
    EXPECT_EQ(scene.path, path);
    ASSERT_FALSE(scene.notices.empty());
    EXPECT_TRUE(contains(scene.notices.front().problem, "is a URDF: the scene was made of it"));

    AlignedBox3d whole;
    for (const SceneBody& body : scene.bodies) {
      if (body.name != "table") whole.extend(boxOf(body));
    }
    EXPECT_NEAR(whole.min().x(), 0.16, 1e-5);
    EXPECT_EQ(scene.bodyIndex("table") >= 0, kind == 0);
    if (kind == 0) EXPECT_NEAR(whole.min().z(), -0.1, 1e-5);
    if (kind > 0) EXPECT_NEAR(boxOf(scene.bodies.back()).center().tail<2>().norm(), 0.0, 2e-5);

    const std::string made = madeScenePath(path);
    folder.write(std::filesystem::path(made).filename().string(), scene.made_text);
    const SceneModel again = loaded(made);
    EXPECT_TRUE(again.made_text.empty());
    expectSame(scene, again);
  }
}

// A cabinet's drawer opens towards the person, whichever way the file has it.
TEST(ObjectScene, DrawerOfAnyOrientation_OpensTowardsTheHand) {
  const Folder folder;
  for (const char* axis : {"1 0 0", "-1 0 0", "0 1 0", "0 -1 0"}) {
    const SceneModel scene =
        loaded(folder.write("c.urdf", robot(link("base", {0.4, 0.4, 0.4}, {0, 0, 0}) +
                                            link("drawer", {0.3, 0.3, 0.1}, {0, 0, 0}) +
                                            joint("prismatic", "drawer", axis, {0, 0, 0.1}, 0.3))));
    const SceneBody& drawer = scene.bodies.back();
    ASSERT_TRUE(drawer.joint) << axis;
    const Vector3d opens = drawer.pose.rotation * drawer.joint->axis;
    EXPECT_NEAR((opens - Vector3d(-1, 0, 0)).norm(), 0.0, 1e-12) << axis;
  }
}

TEST(ObjectScene, FaultOfAUrdf_IsNamedInTheUrdf) {
  const Folder folder;
  const auto fault = [&](const std::string& name, const std::string& text) {
    const auto scene = loadSceneFile(folder.write(name, text));
    EXPECT_FALSE(scene) << name;
    return scene ? Diagnostic{} : scene.errors().front();
  };
  EXPECT_TRUE(contains(fault("none.urdf", robot("<link name=\"a\"/>")).problem, "no collider"));
  EXPECT_TRUE(contains(fault("empty.urdf", "").problem, "is empty"));
  const Diagnostic heavy = fault(
      "heavy.urdf", robot("<link name=\"a\"><inertial><mass value=\"5000\"/><inertia ixx=\"9e2\" "
                          "iyy=\"9e2\" izz=\"9e2\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>"
                          "<collision><geometry><box size=\"1 1 1\"/></geometry></collision>"
                          "</link>"));
  EXPECT_EQ(heavy.file, folder.file("heavy.urdf"));
  EXPECT_TRUE(contains(heavy.problem, "5000"));
  EXPECT_TRUE(contains(fault("a\x01.urdf", robot(link("a", {1, 1, 1}, {0, 0, 0}))).problem,
                       "has a name with control characters"));
}

// What decides is the content: a scene may have any name, and a URDF, too.
TEST(ObjectScene, UrdfUnderAnotherName_IsAUrdf) {
  const Folder folder;
  const std::string box = robot(link("base", {0.1, 0.1, 0.1}, {0, 0, 0}));
  EXPECT_TRUE(isUrdf(folder.write("thing.xml", "<?xml version=\"1.0\"?>\n" + box)));
  EXPECT_TRUE(isUrdf(folder.write("thing.urdf", "")));
  EXPECT_FALSE(isUrdf(folder.write("scene.toml", "kind = \"scene\"\n")));
  EXPECT_FALSE(isUrdf(folder.write("m.urdf", "<mujoco model=\"m\"/>")));
  EXPECT_EQ(loaded(folder.file("thing.xml")).bodies.size(), 2U);
}

}  // namespace
}  // namespace wholehand::test::objects
