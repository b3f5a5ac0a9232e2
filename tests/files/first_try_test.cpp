// Files of other programs load at the first try: what is put right is said in one line, what cannot
// be right is refused at its line, and nothing is wrong in silence.
#include "files/mesh/convex_mesh.hpp"
#include "files/mesh/mesh_file.hpp"
#include "files/scene/scene_file.hpp"
#include "files/scene_text.hpp"
#include "loop/model/principal_axes.hpp"
#include "loop/model/scene_model.hpp"
#include "support/contains.hpp"
#include "support/figure.hpp"
#include "support/folder.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <numbers>
#include <string>
#include <vector>

namespace wholehand::test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::Vector3i;

const std::vector<Vector3i> kCubeFaces = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5},
                                          {0, 4, 5}, {0, 5, 1}, {2, 3, 7}, {2, 7, 6},
                                          {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};

/// Corners of a box, counted by z first, then y, x: the order of kCubeFaces.
std::vector<Vector3d> corners(const Vector3d& low, const Vector3d& high) {
  std::vector<Vector3d> all;
  for (int i = 0; i < 8; ++i) {
    all.emplace_back((i & 4) != 0 ? high.x() : low.x(), (i & 2) != 0 ? high.y() : low.y(),
                     (i & 1) != 0 ? high.z() : low.z());
  }
  return all;
}

/// Boxes of one surface. With `share`, equal corners stand once, as in a file of one vertex table.
MeshSurface surfaceOf(const std::vector<std::array<Vector3d, 2>>& boxes, bool share) {
  MeshSurface surface;
  for (const auto& [low, high] : boxes) {
    std::vector<int> index;
    for (const Vector3d& p : corners(low, high)) {
      auto at = surface.points.end();
      if (share) {
        at = std::find_if(surface.points.begin(), surface.points.end(),
                          [&](const Vector3d& q) { return (p - q).norm() < 1e-9; });
      }
      index.push_back(static_cast<int>(at - surface.points.begin()));
      if (at == surface.points.end()) surface.points.push_back(p);
    }
    for (const Vector3i& t : kCubeFaces) {
      surface.triangles.emplace_back(index[t[0]], index[t[1]], index[t[2]]);
    }
  }
  return surface;
}

double volume_m3(const std::vector<Shape>& shapes) {
  double sum = 0.0;
  for (const Shape& shape : shapes) sum += moments(shape).volume_m3;
  return sum;
}

Expected<SceneModel> sceneWith(const Folder& folder, const std::string& links,
                               const std::string& more = "") {
  folder.write("r.urdf", "<robot name=\"r\">" + links + "</robot>");
  return loadSceneFile(
      folder.write("s.toml", kSceneHead + fileBody("t", "urdf", "r.urdf", 0.3) + more));
}

std::string link(const std::string& inertial, const std::string& collisions) {
  return "<link name=\"b\">" + inertial + collisions + "</link>";
}
std::string boxAt(const Vector3d& at, const Vector3d& size) {
  return fmt::format(
      "<collision><origin xyz=\"{} {} {}\"/><geometry><box size=\"{} {} {}\"/></geometry>"
      "</collision>",
      at.x(), at.y(), at.z(), size.x(), size.y(), size.z());
}
const std::string kPlateMass =
    "<inertial><mass value=\"0.1\"/><inertia ixx=\"1.667e-5\" "
    "iyy=\"3.333e-5\" izz=\"4.333e-5\"/></inertial>";
const std::string kPlate = boxAt(Vector3d::Zero(), {0.06, 0.04, 0.02});

std::string daeGeometry(const std::string& id, const Vector3d& low, const Vector3d& high) {
  std::string points, faces;
  for (const Vector3d& p : corners(low, high)) {
    points += fmt::format("{} {} {} ", p.x(), p.y(), p.z());
  }
  for (const Vector3i& t : kCubeFaces) faces += fmt::format("{} {} {} ", t[0], t[1], t[2]);
  return fmt::format(
      R"(<geometry id="{}"><mesh><source id="p"><float_array id="a" count="24">{}</float_array>
<technique_common><accessor source="#a" count="8" stride="3"><param name="X"/><param name="Y"/>
<param name="Z"/></accessor></technique_common></source><vertices id="v"><input
semantic="POSITION" source="#p"/></vertices><triangles count="12"><input semantic="VERTEX"
source="#v" offset="0"/><p>{}</p></triangles></mesh></geometry>)",
      id, points, faces);
}

TEST(FirstTry, DaeWhoseGeometriesRepeatTheirIds_KeepsEachGeometry) {
  const Folder folder;
  const auto dae = [&](const std::string& second) {
    return folder.write(
        "two.dae",
        R"(<COLLADA version="1.4.1"><asset><up_axis>Z_UP</up_axis></asset><library_geometries>)" +
            daeGeometry("g0", {-0.03, -0.015, -0.015}, {0.03, 0.015, 0.015}) + "\n" +
            daeGeometry(second, {0.04, -0.02, -0.005}, {0.08, 0.02, 0.005}) +
            R"(</library_geometries><library_visual_scenes><visual_scene id="s"><node>
<instance_geometry url="#g0"/></node><node><instance_geometry url="#)" +
            second + R"("/></node></visual_scene></library_visual_scenes><scene>
<instance_visual_scene url="#s"/></scene></COLLADA>)");
  };
  const MeshCollider mesh = orThrow(loadMeshCollider(dae("g1"), Vector3d::Ones()));
  EXPECT_EQ(mesh.shapes.size(), 2U);
  EXPECT_NEAR(volume_m3(mesh.shapes), 54e-6 + 16e-6, 1e-12);  // 60·30·30 and 40·40·10 mm³
  const auto same = loadMeshCollider(dae("g0"), Vector3d::Ones());
  EXPECT_TRUE(refusedWith(same, "names \"#g0\", the id of several elements (lines"));
}

TEST(FirstTry, MeshFarFromItsOrigin_IsNamedOrRefusedWithItsOffset) {
  const Folder folder;
  const auto at = [&](const Vector3d& low) {
    std::string obj;
    for (const Vector3d& p : corners(low, low + Vector3d::Constant(0.07))) {
      obj += fmt::format("v {:.12g} {:.12g} {:.12g}\n", p.x(), p.y(), p.z());
    }
    for (const Vector3i& t : kCubeFaces) {
      obj += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
    }
    folder.write("far.obj", obj);
    return loadSceneFile(folder.write(
        "s.toml", kSceneHead + fileBody("t", "mesh", "far.obj", 0.3) + "mass_kg = 0.2\n"));
  };
  EXPECT_EQ(format(orThrow(at({0.5, 0.0, 0.0})).notices), "");
  const std::string named = format(orThrow(at({3.0, 0.0, 0.0})).notices);
  EXPECT_TRUE(contains(named,
                       "lies 3 m from its own origin; its middle is at (3.035, 0.035, "
                       "0.035) m: take this off"))
      << named;
  const auto refused = at({412e3, 5.3e6, 0.0});
  EXPECT_TRUE(refusedWith(refused, ":8: bodies[t].file"));
  EXPECT_TRUE(refusedWith(refused, "within 10 m"));
}

TEST(FirstTry, ImpossibleDensityOfAPlainShape_IsNamed) {
  const Folder folder;
  const auto said = [&](const char* size, const char* mass) {
    return format(orThrow(loadSceneFile(folder.write(
                              "s.toml", kSceneHead + "[[bodies]]\nname = \"t\"\nshape = \"box\"\n" +
                                            "size_m = " + size + "\nposition_m = [0.6, 0, 0]\n" +
                                            "mass_kg = " + mass + "\n")))
                      .notices);
  };
  EXPECT_EQ(said("[0.05, 0.05, 0.05]", "0.25"), "");
  EXPECT_TRUE(
      contains(said("[0.05, 0.05, 0.05]", "250.0"), "heavier than any matter (2e+06 kg/m³"));
  EXPECT_TRUE(contains(said("[0.5, 0.5, 0.5]", "0.0002"), "lighter than air (0.0016 kg/m³"));
}

// Two boxes of 60 x 40 x 20 mm, the second moved by 30 mm along x: the union is one of 90 mm.
TEST(FirstTry, OverlappingColliders_CountTheirCommonVolumeOnce) {
  std::array<Shape, 2> boxes;
  for (Shape& box : boxes) box.half_extents_m = {0.03, 0.02, 0.01};
  boxes[1].in_body.translation_m = {0.03, 0.0, 0.0};
  const MassProperties m = uniformDensity({boxes[0], boxes[1]}, 0.9);
  const double a = 0.09, b = 0.04, c = 0.02;
  EXPECT_NEAR(moments(std::vector<Shape>{boxes[0], boxes[1]}).volume_m3, a * b * c, 1e-12);
  EXPECT_LT((m.com_m - Vector3d(0.015, 0.0, 0.0)).norm(), 1e-9);
  const Vector3d closed = 0.9 / 12.0 * Vector3d(b * b + c * c, a * a + c * c, a * a + b * b);
  EXPECT_LT((m.inertia_kg_m2 - Matrix3d(closed.asDiagonal())).norm(), 1e-6 * closed.norm());
}

// Two halves of a cube that touch in a diagonal plane share nothing.
TEST(FirstTry, CollidersThatTouchObliquely_LoseNothing) {
  const auto wedge = [](const Vector3d& third, const Vector3d& raised) {
    const Vector3d a(0, 0, 0), b(0.02, 0.02, 0), up(0, 0, 0.02);
    const std::vector<Vector3d> points = {a, b, third, a + up, b + up, raised};
    const std::vector<Vector3i> faces = {{0, 1, 2}, {3, 4, 5}, {0, 1, 4}, {0, 4, 3},
                                         {1, 2, 5}, {1, 5, 4}, {2, 0, 3}, {2, 3, 5}};
    return orThrow(convexMesh(points, faces));
  };
  const std::vector<Shape> halves = {wedge({0.02, 0, 0}, {0.02, 0, 0.02}),
                                     wedge({0, 0.02, 0}, {0, 0.02, 0.02})};
  EXPECT_NEAR(moments(halves).volume_m3, 8e-6, 1e-15);
  EXPECT_LT((moments(halves).center_m - Vector3d(0.01, 0.01, 0.01)).norm(), 1e-12);
}

// The lens of two equal balls: V = π (4 r + d) (2 r - d)² / 12.
TEST(FirstTry, OverlappingBalls_LoseTheirLens) {
  auto random = seededRandom(6201);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int n = 0; n < cases(20); ++n) {
    std::array<Shape, 2> balls;
    const double r = 0.02 + 0.03 * unit(random), d = 2.0 * r * unit(random);
    for (Shape& ball : balls) ball.type = ShapeType::kSphere, ball.radius_m = r;
    balls[1].in_body.translation_m =
        d * Vector3d(unit(random) - 0.5, unit(random) - 0.5, unit(random)).normalized();
    const double whole = 8.0 / 3.0 * std::numbers::pi * r * r * r;
    const double lens = std::numbers::pi * (4.0 * r + d) * (2.0 * r - d) * (2.0 * r - d) / 12.0;
    EXPECT_NEAR(moments(std::vector<Shape>{balls[0], balls[1]}).volume_m3, whole - lens,
                0.01 * lens + 1e-4 * whole)
        << "r " << r << ", d " << d;
  }
}

TEST(FirstTry, CollidersOfNoSizeBesideOthers_AreLeftOutAndNamed) {
  const Folder folder;
  const auto ball = [](const char* radius) {
    return fmt::format("<collision><geometry><sphere radius=\"{}\"/></geometry></collision>",
                       radius);
  };
  const SceneModel scene =
      orThrow(sceneWith(folder, link(kPlateMass, kPlate + ball("1e-7") + ball("0") +
                                                     boxAt(Vector3d::Zero(), Vector3d::Zero()))));
  EXPECT_EQ(scene.bodies[0].shapes.size(), 1U);
  const std::string said = format(scene.notices);
  EXPECT_TRUE(contains(said,
                       "link[b].collision[1].sphere.radius = 1e-7: is smaller than 1 mm; it "
                       "is left out"))
      << said;
  EXPECT_TRUE(contains(said, "link[b].collision[3].box.size = 0 0 0: is smaller than 1 mm"));
  EXPECT_FALSE(sceneWith(folder, link(kPlateMass, ball("1e-7"))).ok()) << "the only collider";
  EXPECT_FALSE(sceneWith(folder, link(kPlateMass, kPlate + ball("-0.01"))).ok())
      << "a negative radius";
  EXPECT_FALSE(
      sceneWith(folder, link(kPlateMass, kPlate + boxAt(Vector3d::Zero(), {0.05, 0.05, 1e-4})))
          .ok())
      << "a plate of 0.1 mm";
}

// Cells of a lattice that touch at faces, edges and corners: as many pieces, and their volume.
TEST(FirstTry, TouchingConvexParts_ArePieces) {
  auto random = seededRandom(6202);
  for (int n = 0; n < cases(30); ++n) {
    std::vector<std::array<Vector3d, 2>> boxes;
    for (int cell = 0; cell < 27; ++cell) {
      if (random() % 3 == 0) continue;
      const Vector3d low = 0.02 * Vector3d(cell % 3, cell / 3 % 3, cell / 9);
      boxes.push_back({low, low + Vector3d::Constant(0.02)});
    }
    if (boxes.size() < 2) continue;
    for (const bool share : {false, true}) {
      MeshFile file;
      file.surface = surfaceOf(boxes, share);
      file.part.resize(file.surface.triangles.size());
      const MeshCollider mesh = orThrow(meshCollider(file));
      EXPECT_EQ(mesh.shapes.size(), boxes.size()) << "share " << share;
      EXPECT_NEAR(volume_m3(mesh.shapes), 8e-6 * static_cast<double>(boxes.size()), 1e-12);
      EXPECT_EQ(format(mesh.notices), "");
    }
  }
}

// A mesh in centimetres whose largest part is beyond 10 m: nothing of it is left out in its place.
TEST(FirstTry, PartsOfAWrongUnit_AreRefusedTogether) {
  auto random = seededRandom(6204);
  for (int n = 0; n < cases(20); ++n) {
    const double tall = uniform(random, 11.0, 30.0), low = uniform(random, 0.1, 5.0);
    MeshFile file;
    const std::vector<std::array<Vector3d, 2>> boxes = {
        {Vector3d::Zero(), Vector3d(7.0, 7.0, tall)},
        {Vector3d(0.0, 8.0, 0.0), Vector3d(low, 8.0 + low, low)}};
    file.surface = surfaceOf(boxes, false);
    file.part.assign(12, 0);
    file.part.resize(24, 1);
    const auto mesh = meshCollider(file);
    EXPECT_TRUE(refusedWith(mesh, "must be 0.001 to 10 m across"));
  }
}

// A dump in hexadecimal digits is no file that was cut off.
TEST(FirstTry, TextThatIsNoStl_IsSaidToBeOne) {
  const Folder folder;
  std::string dump;
  for (int line = 0; line < 20; ++line) {
    dump += fmt::format("{:08x}: 434f 4c4f 523d 7f7f 7f20 4d41 5445 5249  COLOR=... MATERI\n",
                        16 * line);
  }
  const auto mesh = loadMeshCollider(folder.write("dump.stl", dump), Vector3d::Ones());
  EXPECT_TRUE(refusedWith(mesh, "is a text that does not begin as an STL"));
  std::string cut = std::string(80, ' ') + "\xFF\xFF" + std::string(2, '\0');
  const auto binary = loadMeshCollider(folder.write("cut.stl", cut), Vector3d::Ones());
  EXPECT_TRUE(refusedWith(binary, "is cut off"));
}

TEST(FirstTry, PlyWithFacesBeforeItsCorners_IsRead) {
  const Folder folder;
  std::string points, faces;
  for (const Vector3d& p : corners(Vector3d::Zero(), {0.06, 0.04, 0.02})) {
    points += fmt::format("{} {} {}\n", p.x(), p.y(), p.z());
  }
  for (const Vector3i& t : kCubeFaces) faces += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
  const std::string path = folder.write(
      "f.ply",
      "ply\nformat ascii 1.0\nelement face 12\nproperty list uchar int vertex_indices\n"
      "element vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
      "end_header\n" +
          faces + points);
  EXPECT_NEAR(volume_m3(orThrow(loadMeshCollider(path, Vector3d::Ones())).shapes), 48e-6, 1e-10);
}

TEST(FirstTry, PackageInAFolderOfAnotherName_IsFoundByItsName) {
  const Folder folder;
  std::string obj;
  for (const Vector3d& p : corners(Vector3d::Zero(), {0.06, 0.04, 0.02})) {
    obj += fmt::format("v {} {} {}\n", p.x(), p.y(), p.z());
  }
  for (const Vector3i& t : kCubeFaces) {
    obj += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  }
  for (const char* name : {"repo/urdf", "repo/meshes", "other/meshes"}) {
    std::filesystem::create_directories(folder.path() + "/" + name);
  }
  folder.write("repo/meshes/block.obj", obj);
  folder.write("other/meshes/lid.obj", obj);
  folder.write("repo/package.xml", "<package format=\"2\"><name> kitchen_things </name></package>");
  folder.write("other/package.xml", "<package><name>lids</name></package>");
  folder.write("repo/urdf/r.urdf", "<robot name=\"r\">" +
                                       link(kPlateMass, R"(<collision><geometry><mesh
filename="package://kitchen_things/meshes/block.obj"/></geometry></collision><collision><geometry>
<mesh filename="package://lids/meshes/lid.obj"/></geometry></collision>)") +
                                       "</robot>");
  const SceneModel scene = orThrow(loadSceneFile(
      folder.write("s.toml", kSceneHead + fileBody("t", "urdf", "repo/urdf/r.urdf", 0.3))));
  EXPECT_EQ(scene.bodies[0].shapes.size(), 2U);
}

TEST(FirstTry, WindowsPath_IsExplained) {
  const Folder folder;
  const auto said = [&](const std::string& file) {
    return format(
        loadSceneFile(folder.write("s.toml", kSceneHead + fileBody("t", "mesh", file))).errors());
  };
  for (const char* path : {R"(C:\Users\me\cup.obj)", R"(parts\mesh.obj)"}) {
    EXPECT_TRUE(contains(said(path), "s.toml:8: has a backslash in \"...\"")) << said(path);
    EXPECT_TRUE(contains(said(path), "write / in place of \\")) << said(path);
  }
  // "\n" and "\t" are escapes, so the text is well-formed.
  EXPECT_TRUE(contains(said(R"(new\new.obj)"), "write / in place of \\")) << said(R"(new\new.obj)");
}

// A tennis ball of 58 g and 33 mm with the placeholder of 1e-3 kg·m² that many files have. A ball's
// own: 2/5 m r².
TEST(FirstTry, PlaceholderInertia_IsReplacedUnlessTheSceneDecides) {
  const Folder folder;
  const std::string ball = link(
      R"(<inertial><mass value="0.058"/><inertia ixx="1e-3" iyy="1e-3" izz="1e-3"/></inertial>)",
      R"(<collision><geometry><sphere radius="0.033"/></geometry></collision>)");
  const double own = 0.4 * 0.058 * 0.033 * 0.033;
  const SceneModel unset = orThrow(sceneWith(folder, ball));
  EXPECT_NEAR(unset.bodies[0].inertia_kg_m2(0, 0), own, 1e-12);
  const std::string said = format(unset.notices);
  EXPECT_TRUE(contains(said,
                       "s.toml:8: bodies[t].file: the URDF has an inertial that no such body "
                       "has: its moments of inertia are 0.001, 0.001, 0.001 kg·m²"));
  EXPECT_TRUE(contains(said, "its colliders' own takes its place: 2.53e-05"));
  EXPECT_NEAR(
      orThrow(sceneWith(folder, ball, "inertia = \"file\"\n")).bodies[0].inertia_kg_m2(1, 1), 1e-3,
      1e-15);
  EXPECT_NEAR(
      orThrow(sceneWith(folder, ball, "inertia = \"colliders\"\n")).bodies[0].inertia_kg_m2(1, 1),
      own, 1e-12);
  const auto refused = sceneWith(folder, ball, "inertia = \"refuse\"\n");
  EXPECT_TRUE(refusedWith(refused, "inertia = \"colliders\""));
  // A centre in millimetres, moments that break the triangle rule, and a mass alone.
  for (
      const char* inertial :
      {R"(<origin xyz="60 20 10"/><mass value="0.058"/><inertia ixx="1e-5" iyy="1e-5" izz="1e-5"/>)",
       R"(<mass value="0.058"/><inertia ixx="1e-6" iyy="1e-6" izz="1e-3"/>)",
       R"(<mass value="0.058"/><inertia ixx="0" iyy="0" izz="0"/>)", R"(<mass value="0.058"/>)"}) {
    const SceneModel scene =
        orThrow(sceneWith(folder, link(std::string("<inertial>") + inertial + "</inertial>",
                                       R"(<collision><geometry><sphere radius="0.033"/></geometry>
</collision>)")));
    EXPECT_NEAR(scene.bodies[0].inertia_kg_m2(2, 2), own, 1e-12) << inertial;
    EXPECT_FALSE(scene.notices.empty()) << inertial;
  }
}

// Masses at the two ends of a rod reach the bound m·d² exactly: they are kept. Drawn lengths.
TEST(FirstTry, MassAtTheEndsOfABody_IsPossible) {
  const Folder folder;
  auto random = seededRandom(6203);
  std::uniform_real_distribution<double> length(0.05, 0.4);
  for (int n = 0; n < cases(20); ++n) {
    const double l = length(random), across = 0.1 * l * l / 4.0;
    const std::string rod =
        link(fmt::format(
                 R"(<inertial><mass value="0.1"/><inertia ixx="{}" iyy="{}" izz="{}"/></inertial>)",
                 1e-6, across, across),
             boxAt(Vector3d::Zero(), {l, 0.02, 0.02}));
    const SceneModel scene = orThrow(sceneWith(folder, rod));
    EXPECT_NEAR(scene.bodies[0].inertia_kg_m2(1, 1), across, 1e-15) << l;
    EXPECT_TRUE(scene.notices.empty()) << format(scene.notices);
  }
}

TEST(FirstTry, ProductsOfInertiaThatStandTwice_MustAgree) {
  const Folder folder;
  const auto inertia = [&](const char* other) {
    return sceneWith(folder,
                     link(fmt::format(R"(<inertial><mass value="0.1"/><inertia ixx="1.667e-5"
iyy="3.333e-5" izz="4.333e-5" ixy="1e-6" {}/></inertial>)",
                                      other),
                          kPlate));
  };
  EXPECT_EQ(orThrow(inertia("iyx=\"1e-6\"")).bodies[0].inertia_kg_m2(1, 0), 1e-6);
  EXPECT_EQ(orThrow(inertia("izx=\"2e-6\"")).bodies[0].inertia_kg_m2(0, 2), 2e-6);
  const auto refused = inertia("iyx=\"-1e-6\"");
  EXPECT_TRUE(refusedWith(refused, "differs from ixy = 1e-6"));
}

TEST(FirstTry, WhatAJointStatesAndNobodyApplies_IsNamed) {
  const Folder folder;
  const auto said = [&](const char* type, const char* inner) {
    return format(
        orThrow(sceneWith(folder, link("", boxAt({0, 0, -0.1}, {0.1, 0.1, 0.1})) +
                                      "<link name=\"arm\">" + kPlateMass + kPlate + "</link>" +
                                      fmt::format(R"(<joint name="j" type="{}"><parent
link="b"/><child link="arm"/><axis xyz="0 0 1"/>{}<dynamics friction="0.01"/></joint>)",
                                                  type, inner)))
            .notices);
  };
  EXPECT_EQ(said("revolute", R"(<limit lower="-1" upper="1"/>)"), "");
  const std::string endless = said("continuous", R"(<limit lower="-0.1" upper="0.1"/>)");
  EXPECT_TRUE(contains(endless, "joint[j].limit.lower = -0.1: is not applied"));
  const std::string soft = said("revolute", R"(<limit lower="-1" upper="1"/><safety_controller
soft_lower_limit="-0.5" soft_upper_limit="0.5"/>)");
  EXPECT_TRUE(contains(soft, "joint[j].safety_controller.soft_upper_limit = 0.5"));
  const std::string start = said("revolute", R"(<limit lower="0.2" upper="1.2"/>)");
  EXPECT_TRUE(contains(start, "link[arm]: starts at 0.2 rad"));
}

TEST(FirstTry, GravityThatDoesNotPointDown_IsNamed) {
  const Folder folder;
  const auto said = [&](const char* gravity) {
    return format(orThrow(loadSceneFile(folder.write("s.toml",
                                                     "kind = \"scene\"\nversion = 1\nname = \"s\"\n"
                                                     "gravity_m_s2 = " +
                                                         std::string(gravity) + "\n")))
                      .notices);
  };
  EXPECT_EQ(said("[0.0, 0.0, -9.81]"), "");
  EXPECT_EQ(said("[0.0, 0.0, 0.0]"), "");
  EXPECT_TRUE(contains(said("[0.0, -9.81, 0.0]"), "s.toml:4: gravity_m_s2: does not point down"));
  EXPECT_TRUE(contains(said("[0.0, 0.0, 9.81]"), "does not point down"));
}

}  // namespace
}  // namespace wholehand::test
