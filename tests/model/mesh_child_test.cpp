// Meshes are read in a process of their own (docs/adr/0027-children-read-strangers-files.md).
#include "model/mesh/convex_mesh.hpp"
#include "model/mesh/mesh_surface.hpp"
#include "model/mesh_samples.hpp"
#include "support/folder.hpp"
#include "support/mutation.hpp"
#include "support/says.hpp"
#include "support/seed.hpp"

#include <gtest/gtest.h>

namespace wholehand::test {
namespace {

/// A reader of meshes, played by a shell script.
std::string shellReader(const Folder& folder, const std::string& text) {
  const std::string path = folder.write("reader", "#!/bin/sh\n" + text + "\n");
  std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  return path;
}

std::string problemOf(const std::string& reader, const std::string& path) {
  const Expected<MeshSurface> mesh = readMeshInChild(reader, path);
  return mesh ? "" : mesh.errors().front().problem;
}

TEST(MeshReader, EveryKind_GivesTheSurfaceThatIsReadInThisProcess) {
  const Folder folder;
  const std::string reader = meshReaderProgram();
  ASSERT_FALSE(reader.empty()) << "wholehand-read-mesh is not beside this test";
  for (const auto& [ending, bytes] : meshSamples()) {
    const std::string path = folder.write("mesh." + ending, bytes);
    const Expected<MeshSurface> mesh = readMeshInChild(reader, path), here = readMeshHere(path);
    ASSERT_TRUE(mesh && here) << ending << format(mesh.errors());
    EXPECT_FALSE(mesh->triangles.empty());
    EXPECT_EQ(mesh->points, here->points) << ending;
    EXPECT_EQ(mesh->triangles, here->triangles) << ending;
  }
}

TEST(MeshReader, FileThatHoldsNone_IsRefusedInTheWordsOfThisProcess) {
  const Folder folder;
  const std::string path = folder.write("broken.stl", "solid nothing\n");
  const Expected<MeshSurface> mesh = readMeshInChild(meshReaderProgram(), path);
  ASSERT_FALSE(mesh);
  EXPECT_EQ(format(mesh.errors()), format(readMeshHere(path).errors()));
}

TEST(MeshReader, ThatDies_IsAnErrorWithTheFilesName) {
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

TEST(MeshReader, ThatHandsOverNonsense_IsRefused) {
  const Folder folder;
  EXPECT_EQ(problemOf(shellReader(folder, "echo nonsense"), "a.stl"),
            "the result of the mesh reader is damaged");
}

TEST(MeshHandOver, IndexOfNoPoint_IsRefused) {
  MeshSurface mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  for (const int corner : {-1, 3}) {
    mesh.triangles = {{0, 1, corner}};
    EXPECT_FALSE(decodeMesh(encodeMesh(mesh))) << corner;
  }
  mesh.triangles = {{0, 1, 2}};
  EXPECT_TRUE(decodeMesh(encodeMesh(mesh)));
}

TEST(MeshFile, RandomDamage_IsReadOrRefusedAndEndsNothing) {
  auto random = seededRandom(272);
  const Folder folder;
  const bool full = std::getenv("WHOLEHAND_FULL") != nullptr;
  int read = 0, died = 0;
  const auto samples = meshSamples();
  for (int i = 0; i < (full ? 10000 : 60); ++i) {
    const auto& [ending, bytes] = samples[static_cast<std::size_t>(i) % samples.size()];
    const std::string path = folder.write("mesh." + ending, mutated(bytes, random));
    const Expected<MeshCollider> mesh = loadMeshCollider(path, Eigen::Vector3d::Ones());
    if (mesh) {
      ++read;
      continue;
    }
    const Diagnostic& why = mesh.errors().front();
    EXPECT_TRUE(says(why.problem, path));
    EXPECT_FALSE(why.remedy.empty());
    if (why.problem.find(" its reader") != std::string::npos) {
      ++died;
      std::printf("%s: %s\n", ending.c_str(), why.problem.c_str());
    }
  }
  std::printf("figure: %d read, readers that died: %d\n", read, died);
}

TEST(ConvexMesh, CornersOfNoFace_AreBounded) {
  // All at one x: welding would compare each with each.
  const std::vector<Eigen::Vector3d> points(1'000'000, Eigen::Vector3d::Zero());
  const Expected<Shape> mesh = convexMesh(points, {{0, 1, 2}});
  ASSERT_FALSE(mesh);
  EXPECT_EQ(mesh.errors().front().problem, "has 1000000 corners");
}

}  // namespace
}  // namespace wholehand::test
