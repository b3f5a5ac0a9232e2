// The meshes of one scene or URDF have a limit of time together. A clock of the test's own advances
// by 4 s at every second look, so that every mesh takes 4 s.
#include "model/mesh/mesh_load_time.hpp"

#include "model/mesh/mesh_surface.hpp"
#include "model/mesh_samples.hpp"
#include "model/scene/scene_model.hpp"
#include "model/urdf/urdf.hpp"
#include "support/folder.hpp"

#include <gtest/gtest.h>

#include <chrono>

namespace wholehand::test {
namespace {

using namespace std::chrono_literals;

/// Begins at 0 s; a measurement takes 4 s.
MeshLoadTime::Clock slowClock() {
  return [looks = 0]() mutable {
    const auto now = std::chrono::steady_clock::time_point(4s * ((looks + 1) / 2));
    ++looks;
    return now;
  };
}

void writeMesh(const Folder& folder, const std::string& name) {
  for (const auto& [ending, bytes] : meshSamples()) {
    if (ending == "obj") folder.write(name + ".obj", bytes);
  }
}

/// A scene of `count` meshes "mesh0.obj" .., which do not touch each other.
std::string sceneOf(const Folder& folder, int count) {
  std::string text =
      "kind = \"scene\"\nversion = 1\nname = \"t\"\ngravity_m_s2 = [0.0, 0.0, 0.0]\n";
  for (int i = 0; i < count; ++i) {
    const std::string name = "mesh" + std::to_string(i);
    writeMesh(folder, name);
    text += "[[bodies]]\nname = \"" + name + "\"\nshape = \"mesh\"\nfile = \"" + name +
            ".obj\"\nmass_kg = 0.1\nposition_m = [" + std::to_string(i) + ".0, 0.0, 0.0]\n";
  }
  return folder.write("scene.toml", text);
}

TEST(MeshLoadTime, SceneBeyondIt_NamesTheFirstMeshTooMuchAndTheSlowest) {
  const Folder folder;
  const std::string path = sceneOf(folder, 6);
  MeshLoadTime time(15s, slowClock());  // three meshes fit, the fourth ends at 16 s
  const Expected<SceneModel> scene = loadSceneFile(path, time);
  ASSERT_FALSE(scene);
  ASSERT_EQ(scene.errors().size(), 1U) << format(scene.errors());  // later meshes are not read
  const Diagnostic& fault = scene.errors().front();
  EXPECT_EQ(fault.file, path);
  EXPECT_EQ(fault.key, "bodies[mesh3].file");
  EXPECT_EQ(fault.problem,
            "the meshes up to this one took longer than 15 s to load "
            "(mesh0.obj 4.0 s, mesh1.obj 4.0 s, mesh2.obj 4.0 s, 1 more 4.0 s)");
  EXPECT_EQ(fault.remedy, "simplify the meshes that took longest, or name fewer meshes");
}

TEST(MeshLoadTime, SceneWithinIt_Loads) {
  const Folder folder;
  MeshLoadTime time(25s, slowClock());
  const Expected<SceneModel> scene = loadSceneFile(sceneOf(folder, 6), time);
  ASSERT_TRUE(scene) << format(scene.errors());
  EXPECT_EQ(time.left(), 1s);
}

TEST(MeshLoadTime, UrdfBeyondIt_NamesTheElement) {
  const Folder folder;
  std::string links = "<robot name=\"r\"><link name=\"a\">";
  for (int i = 0; i < 4; ++i) {
    const std::string name = "mesh" + std::to_string(i);
    writeMesh(folder, name);
    links += "<collision><geometry><mesh filename=\"" + name + ".obj\"/></geometry></collision>";
  }
  const std::string path = folder.write("r.urdf", links + "</link></robot>");
  MeshLoadTime time(6s, slowClock());
  const Expected<UrdfBody> body = loadUrdf(path, time);
  ASSERT_FALSE(body);
  ASSERT_EQ(body.errors().size(), 1U) << format(body.errors());
  EXPECT_EQ(body.errors().front().file, path);
  EXPECT_EQ(body.errors().front().key, "link[a].collision[1].mesh.filename");
  EXPECT_EQ(body.errors().front().problem,
            "the meshes up to this one took longer than 6 s to load "
            "(mesh0.obj 4.0 s, mesh1.obj 4.0 s)");
}

TEST(MeshLoadTime, UrdfsOfAScene_ShareIt) {
  const Folder folder;
  std::string text =
      "kind = \"scene\"\nversion = 1\nname = \"t\"\ngravity_m_s2 = [0.0, 0.0, 0.0]\n";
  writeMesh(folder, "mesh");
  folder.write(
      "r.urdf",
      "<robot name=\"r\"><link name=\"a\"><collision><geometry><mesh filename=\"mesh.obj\"/>"
      "</geometry></collision></link></robot>");
  for (int i = 0; i < 3; ++i) {
    const std::string n = std::to_string(i);
    text += "[[bodies]]\nname = \"u" + n +
            "\"\nshape = \"urdf\"\nfile = \"r.urdf\"\nmass_kg = 0.1\nposition_m = [" + n +
            ".0, 0.0, 0.0]\n";
  }
  const std::string path = folder.write("scene.toml", text);
  MeshLoadTime enough(13s, slowClock()), scarce(10s, slowClock());
  EXPECT_TRUE(loadSceneFile(path, enough));
  const Expected<SceneModel> scene = loadSceneFile(path, scarce);
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.errors().size(), 1U) << format(scene.errors());
}

TEST(MeshLoadTime, ReaderThatDoesNotEnd_IsEndedAtItsLimit) {
  const Folder folder;
  const std::string reader = folder.write("reader", "#!/bin/sh\nexec sleep 60\n");
  std::filesystem::permissions(reader, std::filesystem::perms::owner_all);
  const Expected<MeshSurface> mesh = readMeshInChild(reader, "a/mug.dae", 50ms);
  ASSERT_FALSE(mesh);
  EXPECT_EQ(mesh.errors().front().problem,
            "the mesh file a/mug.dae takes longer than 0.05 s to read");
}

}  // namespace
}  // namespace wholehand::test
