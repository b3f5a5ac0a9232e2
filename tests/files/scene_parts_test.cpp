#include "files/mesh/convex_mesh.hpp"
#include "files/mesh/mesh_file.hpp"
#include "files/mesh_samples.hpp"
#include "files/scene/scene_file.hpp"
#include "files/scene_text.hpp"
#include "files/urdf/urdf.hpp"
#include "loop/model/scene_model.hpp"
#include "support/contains.hpp"
#include "support/figure.hpp"
#include "support/folder.hpp"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wholehand::test {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

/// A cube of 20 mm as OBJ with the given faces; corners 1 .. 8 count x first, then y, then z.
std::string cubeObj(const std::string& faces) {
  return "v 0 0 0\nv 0.02 0 0\nv 0 0.02 0\nv 0.02 0.02 0\n"
         "v 0 0 0.02\nv 0.02 0 0.02\nv 0 0.02 0.02\nv 0.02 0.02 0.02\n" +
         faces;
}
const std::string kCubeFaces =
    "f 1 2 4 3\nf 5 6 8 7\nf 1 2 6 5\nf 3 4 8 7\nf 1 3 7 5\nf 2 4 8 6\n";  // mixed winding

/// Problem of the only fault of a mesh file; "" if it has none.
std::string problemOf(const std::string& path) {
  const Expected<MeshCollider> mesh = loadMeshCollider(path, Vector3d::Ones());
  if (mesh) return {};
  EXPECT_FALSE(mesh.errors().front().remedy.empty());
  return mesh.errors().front().problem;
}

TEST(ConvexMesh, MixedWinding_BecomesOutward) {
  const Folder folder;
  const MeshCollider mesh = orThrow(
      loadMeshCollider(folder.write("cube.obj", cubeObj(kCubeFaces)), Vector3d(1.0, 1.0, 2.0)));
  EXPECT_EQ(mesh.shapes[0].points_m.size(), 8U);
  EXPECT_NEAR(moments(mesh.shapes[0]).volume_m3, 1.6e-5,
              1e-17);  // 20 x 20 x 40 mm
  EXPECT_NEAR(signedDistance(mesh.shapes[0], {0.01, 0.01, 0.02}), -0.01, 1e-8);
  EXPECT_NEAR(signedDistance(mesh.shapes[0], {0.01, 0.01, 0.05}), 0.01, 1e-8);
}

TEST(ConvexMesh, StlWithSeparateCornersPerFacet_IsWelded) {
  const double s = 0.02;
  const std::vector<Vector3d> p{{0, 0, 0}, {s, 0, 0}, {0, s, 0}, {0, 0, s}};
  const int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  std::string stl = "solid t\n";
  for (const auto& face : faces) {
    stl += "facet normal 0 0 0\nouter loop\n";
    for (const int i : face) {
      stl += "vertex " + std::to_string(p[i].x()) + " " + std::to_string(p[i].y()) + " " +
             std::to_string(p[i].z()) + "\n";
    }
    stl += "endloop\nendfacet\n";
  }
  const Folder folder;
  const MeshCollider mesh =
      orThrow(loadMeshCollider(folder.write("t.stl", stl + "endsolid t\n"), Vector3d::Ones()));
  EXPECT_EQ(mesh.shapes[0].points_m.size(), 4U);
  EXPECT_NEAR(moments(mesh.shapes[0]).volume_m3, s * s * s / 6.0, 1e-12);
  EXPECT_LT((moments(mesh.shapes[0]).center_m - Vector3d::Constant(s / 4.0)).norm(), 1e-8);
}

// A tetrahedron has its centre at the mean of its corners and a sixth of the box's volume.
TEST(ConvexMesh, EveryKindOfFile_KeepsAxesAndUnits) {
  const Folder folder;
  for (const auto& [ending, bytes] : meshSamples()) {
    const MeshCollider mesh =
        orThrow(loadMeshCollider(folder.write("t." + ending, bytes), Vector3d::Ones()));
    ASSERT_EQ(mesh.shapes.size(), 1U) << ending;
    const ShapeMoments m = moments(mesh.shapes[0]);
    EXPECT_LT((m.center_m - Vector3d(0.005, 0.005, 0.01)).norm(), 1e-9) << ending;
    EXPECT_NEAR(m.volume_m3, 0.02 * 0.02 * 0.04 / 6.0, 1e-12) << ending;
  }
}

TEST(ConvexMesh, SubdividedFaces_AreConvex) {
  // A corner in the middle of an edge and one in the middle of a face, exactly in their planes.
  const std::string faces =
      "f 1 9 4\nf 9 2 4\nf 1 4 3\nf 5 6 10\nf 6 8 10\nf 8 7 10\nf 7 5 10\n"
      "f 1 9 5\nf 9 2 6\nf 9 6 5\nf 3 4 8 7\nf 1 3 7 5\nf 2 4 8 6\n";
  const Folder folder;
  const std::string obj = cubeObj("v 0.01 0 0\nv 0.01 0.01 0.02\n" + faces);
  EXPECT_EQ(problemOf(folder.write("cube.obj", obj)), "");
}

TEST(ConvexMesh, FaultyMeshes_AreReportedWithTheReason) {
  const Folder folder;
  const struct {
    const char *name, *text, *problem;
  } cases[] = {
      {"flat.obj", "f 1 2 4 3\nf 3 4 2 1\n", "is flat"},
      {"nofaces.obj", "# corners only\n", ""},
  };
  for (const auto& c : cases) {
    const std::string path = folder.write(c.name, cubeObj(c.text));
    const std::string problem = problemOf(path);
    ASSERT_FALSE(problem.empty()) << c.name;
    EXPECT_TRUE(contains(problem, path));
    EXPECT_TRUE(contains(problem, c.problem));
  }
  EXPECT_TRUE(contains(problemOf(folder.file("none.stl")), "there is no such"));
  EXPECT_TRUE(contains(problemOf(folder.write("empty.stl", "")), "is empty"));
  EXPECT_TRUE(contains(problemOf(folder.write("cup.xyz", "0 0 0\n")),
                       "not of a supported format: its name ends in .xyz"));
  // A valid cube in an unsupported kind of file, under its own ending and another one.
  const std::string off =
      "OFF\n4 4 0\n0 0 0\n0.02 0 0\n0 0.02 0\n0 0 0.02\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  EXPECT_TRUE(contains(problemOf(folder.write("cup.off", off)), "is a mesh (OFF)"));
  EXPECT_FALSE(problemOf(folder.write("cup.obj", off)).empty());
  EXPECT_TRUE(contains(problemOf(folder.write("noise.stl", "not a mesh")),
                       "holds no surface that can be read"));
  const std::string millimetres =
      "v 0 0 0\nv 20 0 0\nv 0 20 0\nv 0 0 20\nf 1 2 3\nf 1 2 4\n"
      "f 1 3 4\nf 2 3 4\n";
  EXPECT_TRUE(contains(problemOf(folder.write("mm.obj", millimetres)), "m across"));
}

TEST(ConvexMesh, TooManyFaces_AreRefused) {
  std::vector<Eigen::Vector3i> triangles(2 * kMaxMeshPoints + 1, Eigen::Vector3i(0, 1, 2));
  const Expected<Shape> mesh =
      convexMesh({{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 0.1}}, triangles);
  ASSERT_FALSE(mesh.ok());
  EXPECT_TRUE(contains(mesh.errors().front().problem, "2049 triangles"));
}

TEST(MassProperties, TwoHalvesOfABox_EqualTheBox) {
  Shape whole, left, right;
  whole.half_extents_m = {0.06, 0.02, 0.03};
  left.half_extents_m = right.half_extents_m = {0.03, 0.02, 0.03};
  left.in_body.translation_m.x() = -0.03;
  right.in_body.translation_m.x() = 0.03;
  const MassProperties a = uniformDensity({whole}, 0.3), b = uniformDensity({left, right}, 0.3);
  EXPECT_LT((a.inertia_kg_m2 - b.inertia_kg_m2).norm(), 1e-15);
  EXPECT_LT(b.com_m.norm(), 1e-15);
  EXPECT_NEAR(a.inertia_kg_m2(2, 2), 0.3 * (0.12 * 0.12 + 0.04 * 0.04) / 12.0,
              1e-16);  // textbook value
}

TEST(MassProperties, ImpossibleInertias_AreReported) {
  EXPECT_EQ(inertiaFault(Vector3d(1.0, 1.0, 2.0).asDiagonal()), "");  // a flat plate
  EXPECT_TRUE(contains(inertiaFault(Vector3d(1.0, 1.0, 2.1).asDiagonal()), "triangle"));
  EXPECT_TRUE(contains(inertiaFault(Vector3d(1.0, 1.0, 0.0).asDiagonal()), "definite"));
  Eigen::Matrix3d skew = Eigen::Matrix3d::Identity();
  skew(0, 1) = skew(1, 0) = 1.5;  // positive diagonal, negative principal moment
  EXPECT_TRUE(contains(inertiaFault(skew), "definite"));
}

const std::string kBall = "<collision><geometry><sphere radius=\"0.02\"/></geometry></collision>";

TEST(Urdf, EveryColliderOfEveryLink_IsKeptInPlace) {
  const Folder folder;
  folder.write("meshes/cube.obj", cubeObj(kCubeFaces));
  const UrdfBody body = orThrow(loadUrdf(folder.write("thing.urdf", R"(<robot name="thing">
    <link name="a">
      <collision><origin xyz="0.1 0 0" rpy="0 1.5707963267948966 0"/>
        <geometry><capsule radius="0.01" length="0.06"/></geometry></collision>
      <collision><geometry><box size="0.02 0.04 0.06"/></geometry></collision>
    </link>
    <link name="b">
      <collision><geometry><cylinder radius="0.02" length="0.1"/></geometry></collision>
      <collision><geometry><mesh filename="meshes/cube.obj" scale="2 2 2"/></geometry></collision>
    </link>
    <link name="c">)" + kBall + R"(</link>
    <joint name="ab" type="fixed"><parent link="a"/><child link="b"/>
      <origin xyz="0 0 0.2" rpy="0 0 1.5707963267948966"/></joint>
    <joint name="bc" type="fixed"><parent link="b"/><child link="c"/>
      <origin xyz="0.05 0 0"/></joint>
  </robot>)")));
  ASSERT_EQ(body.shapes.size(), 5U);
  const Shape& capsule = body.shapes[0];  // the one that urdfdom loses
  EXPECT_EQ(capsule.type, ShapeType::kCapsule);
  EXPECT_NEAR(signedDistance(capsule, {0.13, 0.0, 0.0}), -0.01, 1e-12);  // the centre of its cap
  EXPECT_NEAR(signedDistance(capsule, {0.14, 0.0, 0.0}), 0.0, 1e-12);    // its tip, along x
  EXPECT_EQ(body.shapes[1].type, ShapeType::kBox);
  EXPECT_NEAR(signedDistance(body.shapes[2], {0.0, 0.0, 0.25}), 0.0, 1e-12);
  EXPECT_NEAR(moments(body.shapes[3]).volume_m3, 6.4e-5, 1e-11);  // 40 mm cube
  EXPECT_LT((body.shapes[4].in_body.translation_m - Vector3d(0.0, 0.05, 0.2)).norm(), 1e-12);
  EXPECT_EQ(body.mesh_files, std::vector<std::string>{folder.file("meshes/cube.obj")});
  EXPECT_FALSE(body.inertial.has_value());
}

TEST(Urdf, Inertials_AreAddedByTheParallelAxisTheorem) {
  // Two thin rods of 1 kg and 1 m end to end along x, the second rotated about z in its own frame.
  // Together they are a rod of 2 kg and 2 m: I = m L² / 12 across, 2e-6 along.
  const std::string rod = R"(<inertial><origin xyz="0.5 0 0"/><mass value="1"/>
    <inertia ixx="1e-6" iyy="0.0833333333333333" izz="0.0833333333333333"/></inertial>)";
  const std::string turned = R"(<inertial><origin xyz="0.5 0 0" rpy="0 0 1.5707963267948966"/>
    <mass value="1"/><inertia ixx="0.0833333333333333" iyy="1e-6" izz="0.0833333333333333"/>
    </inertial>)";
  const Folder folder;
  const UrdfBody body = orThrow(loadUrdf(
      folder.write("rods.urdf", "<robot name=\"r\"><link name=\"a\">" + rod + kBall +
                                    "</link><link name=\"b\">" + turned + kBall +
                                    R"(</link><joint name="j" type="fixed"><parent link="a"/>
      <child link="b"/><origin xyz="1 0 0"/></joint></robot>)")));
  const MassProperties& m = body.inertial->sum;
  EXPECT_NEAR(m.mass_kg, 2.0, 1e-12);
  EXPECT_LT((m.com_m - Vector3d(1.0, 0.0, 0.0)).norm(), 1e-12);
  EXPECT_NEAR(m.inertia_kg_m2(0, 0), 2e-6, 1e-12);
  EXPECT_NEAR(m.inertia_kg_m2(1, 1), 2.0 * 4.0 / 12.0, 1e-12);
  EXPECT_NEAR(m.inertia_kg_m2(2, 2), 2.0 * 4.0 / 12.0, 1e-12);
  EXPECT_LT(std::abs(m.inertia_kg_m2(0, 1)), 1e-12);
}

TEST(Urdf, PackageNames_AreFoundAboveTheFile) {
  const Folder folder;
  folder.write("my_cups/meshes/cube.obj", cubeObj(kCubeFaces));
  const std::string urdf = R"(<robot name="r"><link name="a"><collision><geometry>
    <mesh filename="package://my_cups/meshes/cube.obj"/></geometry></collision></link></robot>)";
  EXPECT_TRUE(loadUrdf(folder.write("my_cups/urdf/cup.urdf", urdf)).ok());   // in the package
  EXPECT_TRUE(loadUrdf(folder.write("others/robots/cup.urdf", urdf)).ok());  // beside the package
  const Expected<UrdfBody> lost = loadUrdf(folder.write("lost.urdf", R"(<robot name="r">
    <link name="a"><collision><geometry><mesh filename="package://no_cups/cube.obj"/></geometry>
    </collision></link></robot>)"));
  EXPECT_TRUE(refusedWith(lost, "no_cups/cube.obj"));
}

/// A standing cabinet, a drawer whose range does not contain 0, and a door with a handle fixed to
/// it and without inertial.
TEST(Urdf, HingesAndSlidesAtTheRoot_BecomeBodiesOnJoints) {
  const Folder folder;
  folder.write(
      "cabinet.urdf",
      "<robot name=\"cabinet\"><link name=\"base\"><collision><geometry>"
      "<box size=\"0.4 0.4 0.4\"/></geometry></collision></link>"
      "<link name=\"tray\"><inertial><origin xyz=\"0.01 0 0\"/><mass value=\"0.8\"/>"
      "<inertia ixx=\"0.004\" iyy=\"0.004\" izz=\"0.004\"/></inertial><collision><geometry>"
      "<box size=\"0.3 0.3 0.1\"/></geometry></collision></link>"
      "<joint name=\"slide\" type=\"prismatic\"><origin xyz=\"0 0 0.1\" rpy=\"0 0 "
      "1.5707963267948966\"/><parent link=\"base\"/><child link=\"tray\"/>"
      "<axis xyz=\"0 2 0\"/><limit lower=\"0.05\" upper=\"0.25\"/>"
      "<dynamics damping=\"3\" friction=\"2\"/></joint>"
      "<link name=\"door\"><collision><origin xyz=\"0 0.1 0\"/><geometry>"
      "<box size=\"0.02 0.2 0.2\"/></geometry></collision></link>"
      "<joint name=\"hinge\" type=\"revolute\"><origin xyz=\"-0.2 -0.1 0\"/>"
      "<parent link=\"base\"/><child link=\"door\"/><axis xyz=\"0 0 1\"/>"
      "<limit lower=\"0\" upper=\"1.5\"/></joint>"
      "<link name=\"handle\"><collision><geometry><sphere radius=\"0.02\"/></geometry>"
      "</collision></link><joint name=\"weld\" type=\"fixed\"><origin xyz=\"-0.03 0.18 0\"/>"
      "<parent link=\"door\"/><child link=\"handle\"/></joint></robot>");
  const std::string body =
      "[[bodies]]\nname = \"cabinet\"\nshape = \"urdf\"\nfile = \"cabinet.urdf\"\n"
      "position_m = [0.5, 0, 0]\n";
  const std::string head =
      "kind = \"scene\"\nversion = 1\nname = \"s\"\ngravity_m_s2 = [0, 0, -9.81]\n";
  const auto free = loadSceneFile(folder.write("free.toml", head + body + "fixed = false\n"));
  EXPECT_TRUE(refusedWith(free, "set fixed = true"));
  const SceneModel scene = orThrow(loadSceneFile(folder.write("scene.toml", head + body)));
  ASSERT_EQ(scene.bodies.size(), 3U);
  const SceneBody &cabinet = scene.bodies[0], &tray = scene.bodies[1], &door = scene.bodies[2];
  EXPECT_TRUE(cabinet.fixed);
  EXPECT_EQ(cabinet.shapes.size(), 1U);
  EXPECT_EQ(tray.name, "cabinet/tray");
  EXPECT_FALSE(tray.joint->isHinge());
  // The tray's y is the world's −x; the tray starts 50 mm along it, at its lower end.
  EXPECT_LE((tray.pose.translation_m - Eigen::Vector3d(0.45, 0, 0.1)).norm(), 1e-12);
  EXPECT_NEAR(tray.joint->least, 0.0, 1e-15);
  EXPECT_NEAR(tray.joint->most, 0.2, 1e-15);
  EXPECT_EQ(tray.joint->viscous_friction, 3.0);
  EXPECT_EQ(tray.joint->dry_friction, 2.0);
  EXPECT_EQ(tray.mass_kg, 0.8);
  const Eigen::Vector3d opened = poseOn(*tray.joint, tray.pose, 0.2).translation_m;
  EXPECT_LE((opened - Eigen::Vector3d(0.25, 0, 0.1)).norm(), 1e-12);
  EXPECT_EQ(door.name, "cabinet/door");
  EXPECT_EQ(door.shapes.size(), 2U);
  // 600 kg/m³ of a box of 0.8 l and a ball of 33.5 ml.
  EXPECT_NEAR(door.mass_kg, 600.0 * (0.02 * 0.2 * 0.2 + 4.0 / 3.0 * 3.14159265 * 8e-6), 1e-6);
  const Eigen::Vector3d edge =
      poseOn(*door.joint, door.pose, 1.5707963267948966) * Eigen::Vector3d(0, 0.2, 0);
  EXPECT_LE((edge - Eigen::Vector3d(0.1, -0.1, 0)).norm(), 1e-12);
  std::string noticed;
  for (const Diagnostic& d : scene.notices) noticed += d.key + ": " + d.problem + "\n";
  EXPECT_TRUE(contains(noticed, "link[door]: has no <inertial>"));
  EXPECT_TRUE(contains(noticed, "link[door]: moves without dry friction"));
}

TEST(Urdf, FrictionOfALink_IsThatOfTheBodyItMovesWith) {
  const Folder folder;
  const auto link = [](const std::string& name, const std::string& contact) {
    return "<link name=\"" + name + "\">" + contact +
           "<collision><geometry><sphere radius=\"0.02\"/></geometry></collision></link>";
  };
  const auto joint = [](const std::string& type, const std::string& on, const std::string& of) {
    return "<joint name=\"" + of + "\" type=\"" + type +
           "\"><origin xyz=\"0.1 0 0\"/><parent link=\"" + on + "\"/><child link=\"" + of +
           "\"/></joint>";
  };
  const auto lateral = [](const std::string& value) {
    return "<contact><lateral_friction value=\"" + value + "\"/></contact>";
  };
  folder.write("r.urdf", "<robot name=\"r\">" + link("base", lateral("0.1")) + link("arm", "") +
                             link("grip", lateral("0.3")) + link("end", "") +
                             link("tip", lateral("0.5")) + joint("continuous", "base", "arm") +
                             joint("fixed", "arm", "grip") + joint("continuous", "arm", "end") +
                             joint("fixed", "base", "tip") +
                             "<gazebo reference=\"arm\"><mu1>0.4</mu1></gazebo></robot>");
  const auto load = [&](const std::string& more) {
    return orThrow(loadSceneFile(
        folder.write("s.toml", kSceneHead + fileBody("t", "urdf", "r.urdf", 0.3) + more)));
  };
  const SceneModel scene = load("");
  ASSERT_EQ(scene.bodies.size(), 3U);
  EXPECT_EQ(scene.bodies[0].friction, 0.1);
  EXPECT_EQ(scene.bodies[1].friction, 0.3);  // of the grip, which the arm carries
  EXPECT_EQ(scene.bodies[2].friction, 0.8);  // a body's default
  const std::string notices = format(scene.notices);
  EXPECT_TRUE(
      contains(notices, "lateral_friction = 0.5: is not applied: the body has one friction, 0.1"));
  EXPECT_TRUE(contains(notices, "mu1 = 0.4: is not applied: the body has one friction, 0.3"));
  for (const SceneBody& body : load("friction = 0.2\n").bodies) EXPECT_EQ(body.friction, 0.2);
}

/// As in Bullet's own files: a base of mass 0, and a placeholder of 1 kg·m² for the moving link.
TEST(Urdf, PlaceholderInertiasOfMovingLinks_AreReplacedOrRefused) {
  const Folder folder;
  const auto write = [&](const std::string& inertial) {
    folder.write(
        "lid.urdf",
        "<robot name=\"r\"><link name=\"base\"><inertial><mass value=\"0\"/><inertia "
        "ixx=\"0\" iyy=\"0\" izz=\"0\"/></inertial><collision><geometry><box size=\"0.1 0.1 "
        "0.1\"/></geometry></collision></link><link name=\"lid\"><inertial>" +
            inertial +
            "</inertial><collision><geometry><box size=\"0.12 0.06 0.01\"/></geometry>"
            "</collision></link><joint name=\"hinge\" type=\"revolute\"><origin "
            "xyz=\"0 0 0.2\"/><parent link=\"base\"/><child link=\"lid\"/><axis xyz=\"1 0 "
            "0\"/><limit lower=\"0\" upper=\"1\"/></joint></robot>");
  };
  const auto load = [&](const std::string& more) {
    return loadSceneFile(
        folder.write("lid.toml",
                     "kind = \"scene\"\nversion = 1\nname = \"s\"\ngravity_m_s2 = [0, 0, 0]\n"
                     "[[bodies]]\nname = \"r\"\nshape = \"urdf\"\nfile = \"lid.urdf\"\n"
                     "position_m = [0.5, 0, 0]\n" +
                         more));
  };
  // m (a² + b²) / 12 about x and z.
  const double about_x = 0.1 * (0.06 * 0.06 + 0.01 * 0.01) / 12.0;
  const double about_z = 0.1 * (0.12 * 0.12 + 0.06 * 0.06) / 12.0;
  for (const char* inertia : {"<inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/>",
                              "<inertia ixx=\"1\" iyy=\"1\" izz=\"9\"/>", ""}) {
    write(std::string("<mass value=\"0.1\"/>") + inertia);
    const Expected<SceneModel> refused = load("inertia = \"refuse\"\n");
    EXPECT_TRUE(refusedWith(refused, "inertia = \"colliders\""));
    for (const char* decided : {"", "inertia = \"colliders\"\n"}) {
      const SceneModel scene = orThrow(load(decided));
      ASSERT_EQ(scene.bodies.size(), 2U);
      EXPECT_TRUE(scene.bodies[0].fixed);
      EXPECT_EQ(scene.bodies[1].mass_kg, 0.1);
      EXPECT_NEAR(scene.bodies[1].inertia_kg_m2(0, 0), about_x, 1e-15);
      EXPECT_NEAR(scene.bodies[1].inertia_kg_m2(2, 2), about_z, 1e-15);
    }
  }
  write("<mass value=\"1e-9\"/>");
  EXPECT_TRUE(contains(format(load("inertia = \"colliders\"\n").errors()),
                       "the URDF's 'lid' has 1e-09 kg; must be in [1e-04, 1000] kg"));
}

TEST(Urdf, FileThatIsNoUrdf_IsRefusedWithTheReason) {
  const Folder folder;
  const Expected<UrdfBody> broken = loadUrdf(folder.write("broken.urdf", "<robot><link></robot>"));
  EXPECT_TRUE(
      refusedWith(broken, "broken.urdf:1: is not well-formed XML: an element is not closed"));
  const auto said = [&](const std::string& text) {
    return format(loadUrdf(folder.write("said.urdf", text)).errors());
  };
  EXPECT_TRUE(contains(said(""), "said.urdf: is empty; give"));
  EXPECT_TRUE(contains(said("kind = \"scene\"\n"), "it holds no XML")) << said("kind\n");
  EXPECT_TRUE(contains(said("<robot>\n<link name=a/></robot>"),
                       "said.urdf:2: is not well-formed XML: an attribute"));
  EXPECT_FALSE(loadUrdf(folder.write("other.urdf", "<model/>")).ok());
  EXPECT_FALSE(loadUrdf(folder.file("none.urdf")).ok());
}

// Found by libFuzzer: links with one fault each were all listed.
TEST(Urdf, ManyFaults_AreListedUpToTwentyAndCounted) {
  std::string links;
  for (int i = 0; i < 30; ++i) links += "<link/>";  // without a name
  const Folder folder;
  const Expected<UrdfBody> body =
      loadUrdf(folder.write("many.urdf", "<robot name=\"r\">" + links + "</robot>"));
  ASSERT_FALSE(body.ok());
  ASSERT_EQ(body.errors().size(), 21U) << format(body.errors());
  EXPECT_TRUE(contains(format(body.errors().back()), "has 10 more faults"));
}

// Found by an audit: each of these took half a minute and longer.
TEST(Urdf, FileBeyondBounds_IsRefusedBeforeParsing) {
  std::string attributes = "<robot", links = "<robot name=\"r\">", bare = links;
  for (int i = 0; i < 100'000; ++i) attributes += " a" + std::to_string(i) + "=\"1\"";
  for (int i = 0; i < 100'000; ++i) links += "<link name=\"" + std::to_string(i) + "\"/>";
  for (int i = 0; i < 100'000; ++i) bare += "<link/>";
  const Folder folder;
  const auto said = [&](const std::string& text) {
    const Expected<UrdfBody> body = loadUrdf(folder.write("large.urdf", text));
    return body.ok() ? "read" : format(body.errors());
  };
  EXPECT_TRUE(contains(said(attributes + "/>"), "has more than 8000 attributes"));
  EXPECT_TRUE(contains(said(links + "</robot>"), "has more than 8000 attributes"));
  EXPECT_TRUE(contains(said(bare + "</robot>"), "has more than 16000 elements"));
  EXPECT_TRUE(
      contains(said("<robot>" + std::string(5 << 20, ' ') + "</robot>"), "larger than 4 MB"));
}

}  // namespace
}  // namespace wholehand::test
