// Meshes are read in a process of their own (docs/adr/0027-untrusted-files-in-child-processes.md).
#include "files/mesh/convex_mesh.hpp"
#include "files/mesh/mesh_file.hpp"
#include "files/mesh_samples.hpp"
#include "files/scene/scene_file.hpp"
#include "files/urdf/urdf.hpp"
#include "loop/model/scene_model.hpp"
#include "support/contains.hpp"
#include "support/folder.hpp"
#include "support/mutation.hpp"
#include "support/seed.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <regex>

namespace wholehand::test {
namespace {

/// A shell script in place of the mesh reader.
std::string shellReader(const Folder& folder, const std::string& text) {
  const std::string path = folder.write("reader", "#!/bin/sh\n" + text + "\n");
  std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  return path;
}

std::string problemOf(const std::string& reader, const std::string& path) {
  const Expected<MeshFile> mesh = readMeshInChild(reader, path);
  return mesh ? "" : mesh.errors().front().problem;
}

TEST(MeshReader, EveryKindOfFile_GivesTheSameSurfaceAsReadingHere) {
  const Folder folder;
  const std::string reader = meshReaderProgram();
  ASSERT_FALSE(reader.empty()) << "wholehand-read-mesh is not beside this test";
  for (const auto& [ending, bytes] : meshSamples()) {
    const std::string path = folder.write("mesh." + ending, bytes);
    const Expected<MeshFile> mesh = readMeshInChild(reader, path), here = readMeshHere(path);
    ASSERT_TRUE(mesh && here) << ending << format(mesh.errors());
    EXPECT_FALSE(mesh->surface.triangles.empty());
    EXPECT_EQ(mesh->surface.points, here->surface.points) << ending;
    EXPECT_EQ(mesh->surface.triangles, here->surface.triangles) << ending;
    EXPECT_EQ(mesh->part, here->part) << ending;
    EXPECT_EQ(mesh->notices, here->notices) << ending;
  }
}

TEST(MeshReader, FileWithoutAMesh_IsRefusedWithTheSameMessageAsHere) {
  const Folder folder;
  const std::string path = folder.write("broken.stl", "solid nothing\n");
  const Expected<MeshFile> mesh = readMeshInChild(meshReaderProgram(), path);
  ASSERT_FALSE(mesh);
  EXPECT_EQ(format(mesh.errors()), format(readMeshHere(path).errors()));
}

TEST(MeshReader, ReaderThatDies_IsAnErrorWithTheFileName) {
  const Folder folder;
  EXPECT_EQ(problemOf(shellReader(folder, "kill -SEGV $$"), "a/mug.dae"),
            "the mesh file a/mug.dae crashed its reader: Segmentation fault");
  EXPECT_EQ(problemOf(shellReader(folder, "kill -ABRT $$"), "a/mug.dae"),
            "the mesh file a/mug.dae crashed its reader: Aborted");
  EXPECT_EQ(problemOf(shellReader(folder, "exit 1"), "a/mug.dae"),
            "the mesh file a/mug.dae made its reader fail, which may use 1 GB of memory");
  EXPECT_EQ(problemOf("/nowhere/reader", "a/mug.dae"),
            "the mesh file a/mug.dae was not read: its reader could not be started: "
            "No such file or directory");
}

TEST(MeshReader, InvalidResultOfTheReader_IsRefused) {
  const Folder folder;
  EXPECT_EQ(problemOf(shellReader(folder, "echo nonsense"), "a.stl"),
            "the result of the mesh reader is damaged");
}

TEST(MeshHandOver, IndexOutOfRange_IsRefused) {
  MeshFile mesh;
  mesh.surface.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.part = {0};
  for (const int corner : {-1, 3}) {
    mesh.surface.triangles = {{0, 1, corner}};
    EXPECT_FALSE(decodeMesh(encodeMesh(mesh))) << corner;
  }
  mesh.surface.triangles = {{0, 1, 2}};
  EXPECT_TRUE(decodeMesh(encodeMesh(mesh)));
}

// Found by damage under UBSan: without triangles the array of their parts has no memory to copy to.
TEST(MeshHandOver, MeshWithoutTriangles_IsHandedOver) {
  const auto handed_over = decodeMesh(encodeMesh(MeshFile{}));
  ASSERT_TRUE(handed_over);
  EXPECT_TRUE(handed_over->surface.triangles.empty());
  EXPECT_TRUE(handed_over->part.empty());
}

/// Damages each sample `times` times and checks that it is read or refused and that the reader
/// never dies.
void expectDamageIsReadOrRefused(int times) {
  auto random = seededRandom(272);
  const Folder folder;
  int read = 0, died = 0;
  for (const auto& [ending, bytes] : meshSamples()) {
    for (int i = 0; i < times; ++i) {
      const std::string path = folder.write("mesh." + ending, mutated(bytes, random));
      const Expected<MeshCollider> mesh = loadMeshCollider(path, Eigen::Vector3d::Ones());
      if (mesh) {
        ++read;
        for (const Shape& shape : mesh->shapes) EXPECT_GT(moments(shape).volume_m3, 0.0);
        continue;
      }
      const Diagnostic& why = mesh.errors().front();
      EXPECT_TRUE(contains(why.problem, path));
      EXPECT_FALSE(why.remedy.empty());
      if (why.problem.find(" its reader") != std::string::npos) {
        ++died;
        std::printf("%s: %s\n", ending.c_str(), why.problem.c_str());
      }
    }
  }
  EXPECT_EQ(died, 0);
  std::printf("figure: %d read, readers that died: %d\n", read, died);
}

TEST(MeshFile, RandomDamage_IsReadOrRefusedWithoutACrash) {
  expectDamageIsReadOrRefused(kReducedCounts ? 10 : 100);
}

TEST(MeshFile, RandomDamage_IsReadOrRefusedWithoutACrash_slow) {
  expectDamageIsReadOrRefused(1000);
}

TEST(ConvexMesh, UnusedCorners_AreLimited) {
  // All corners have the same x: welding would compare each with each.
  const std::vector<Eigen::Vector3d> points(1'000'000, Eigen::Vector3d::Zero());
  const Expected<Shape> mesh = convexMesh(points, {{0, 1, 2}});
  ASSERT_FALSE(mesh);
  EXPECT_EQ(mesh.errors().front().problem, "has 1000000 corners");
}

// The meshes of one scene or URDF share a time limit. The test's own clock advances by 4 s at every
// second reading, so that every mesh takes 4 s.

using namespace std::chrono_literals;

/// The readers' own processor time makes one mesh or the other the slowest.
std::string withoutNumbers(const std::string& text) {
  return std::regex_replace(text, std::regex("[0-9]+(\\.[0-9]+)?"), "#");
}

/// A clock that starts at 0 s; a measurement takes 4 s.
MeshLoadTime::Clock slowClock() {
  return [looks = 0]() mutable {
    const std::chrono::nanoseconds now = 4s * ((looks + 1) / 2);
    ++looks;
    return now;
  };
}

void writeMesh(const Folder& folder, const std::string& name) {
  for (const auto& [ending, bytes] : meshSamples()) {
    if (ending == "obj") folder.write(name + ".obj", bytes);
  }
}

/// A scene of `count` meshes "mesh0.obj" .. that do not touch each other.
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

TEST(MeshLoadTime, SceneBeyondTheLimit_NamesTheFirstExcessMeshAndTheSlowest) {
  const Folder folder;
  const std::string path = sceneOf(folder, 6);
  MeshLoadTime time(15s, slowClock());  // three meshes fit, the fourth ends at 16 s
  const Expected<SceneModel> scene = loadSceneFile(path, time);
  ASSERT_FALSE(scene);
  ASSERT_EQ(scene.errors().size(), 1U) << format(scene.errors());  // later meshes are not read
  const Diagnostic& fault = scene.errors().front();
  EXPECT_EQ(fault.file, path);
  EXPECT_EQ(fault.key, "bodies[mesh3].file");
  EXPECT_EQ(withoutNumbers(fault.problem),
            "the meshes up to this one took more than # s of processor time "
            "(mesh#.obj # s, mesh#.obj # s, mesh#.obj # s, # more # s)");
  EXPECT_EQ(fault.remedy, "simplify the meshes that took longest, or name fewer meshes");
}

TEST(MeshLoadTime, SceneWithinTheLimit_Loads) {
  const Folder folder;
  MeshLoadTime time(25s, slowClock());
  const Expected<SceneModel> scene = loadSceneFile(sceneOf(folder, 6), time);
  ASSERT_TRUE(scene) << format(scene.errors());
  EXPECT_LE(time.left(), 1s);  // less the processor time of six readers
  EXPECT_GT(time.left(), 0s);
}

TEST(MeshLoadTime, UrdfBeyondTheLimit_NamesTheElement) {
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
  EXPECT_EQ(withoutNumbers(body.errors().front().problem),
            "the meshes up to this one took more than # s of processor time "
            "(mesh#.obj # s, mesh#.obj # s)");
}

TEST(MeshLoadTime, UrdfsOfAScene_ShareTheLimit) {
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

// A machine that does much else reads a mesh later, and reads it.
TEST(MeshLoadTime, ReaderThatWaits_IsNotLate) {
  const Folder folder;
  const auto spent_by = [&](const std::string& script) {
    std::chrono::milliseconds spent{0};
    const Expected<MeshFile> mesh =
        readMeshInChild(shellReader(folder, script), "a/mug.dae", 200ms, &spent);
    EXPECT_FALSE(mesh);
    return std::pair(mesh.errors().front().problem, spent);
  };
  const auto [waits, few] = spent_by("sleep 1; echo nonsense");
  EXPECT_EQ(waits, "the result of the mesh reader is damaged");
  EXPECT_LT(few, 200ms);
  const auto [computes, many] = spent_by("while :; do :; done");
  EXPECT_EQ(computes, "the mesh file a/mug.dae takes more than 0.2 s of processor time to read");
  EXPECT_GT(many, 200ms);
}

TEST(MeshLoadTime, ReaderThatDoesNotEnd_IsEnded) {
  const Folder folder;
  const Expected<MeshFile> mesh = readMeshInChild(shellReader(folder, "exec sleep 60"), "a/mug.dae",
                                                  kLongestMeshRead, nullptr, 50ms);
  ASSERT_FALSE(mesh);
  EXPECT_EQ(mesh.errors().front().problem, "the mesh file a/mug.dae was not read within 0.05 s");
}

// What a scene's meshes took counts their readers' processor time, too.
TEST(MeshLoadTime, ProcessorTimeOfOtherProcesses_Counts) {
  MeshLoadTime time(10s, [] { return std::chrono::nanoseconds{0}; });
  (void)time.measure("a.obj", [](std::chrono::milliseconds* elsewhere) {
    *elsewhere += 4s;
    return 0;
  });
  EXPECT_EQ(time.left(), 6s);
}

}  // namespace
}  // namespace wholehand::test
