#include "files/scene/scene_file.hpp"

#include "files/scene/separation.hpp"
#include "files/scene_text.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/model/scene_model.hpp"
#include "support/contains.hpp"
#include "support/figure.hpp"
#include "support/file_bytes.hpp"
#include "support/folder.hpp"

#include <Eigen/Eigenvalues>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numbers>
#include <regex>
#include <vector>

namespace wholehand::test {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

const std::string kUrdfBody = fileBody("u", "urdf", "thing.urdf");

std::string ball(const std::string& name, double x_m, double y_m = 0.0) {
  return "[[bodies]]\nname = \"" + name +
         "\"\nshape = \"sphere\"\nradius_m = 0.02\nmass_kg = 0.1\nposition_m = [" +
         std::to_string(x_m) + ", " + std::to_string(y_m) + ", 0]\n";
}

TEST(SceneFile, EveryShippedScene_LoadsWithoutOverlaps) {
  int count = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(WHOLEHAND_SOURCE_DIR "/config/scenes")) {
    if (entry.path().extension() != ".toml") continue;
    ++count;
    const SceneModel scene = orThrow(loadSceneFile(entry.path().string()));
    for (const SceneBody& body : scene.bodies) {
      ASSERT_FALSE(body.shapes.empty()) << body.name;
      if (body.fixed) continue;
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> inertia(body.inertia_kg_m2);
      EXPECT_GT(body.mass_kg, 0.0) << body.name;
      EXPECT_GT(inertia.eigenvalues()[0], 0.0) << body.name;
    }
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        EXPECT_GT(separation(scene.bodies[i], scene.bodies[j]), -1e-4);
      }
    }
  }
  EXPECT_GE(count, 3);
}

TEST(SceneFile, FourShapes_MatchThePapersFigure) {
  const SceneModel scene =
      orThrow(loadSceneFile(WHOLEHAND_SOURCE_DIR "/config/scenes/four-shapes.toml"));
  EXPECT_EQ(scene.gravity_m_s2, Vector3d::Zero());
  ASSERT_EQ(scene.bodies.size(), 4U);
  for (const char* name : {"cube", "sphere", "cylinder", "disk"}) {
    ASSERT_GE(scene.bodyIndex(name), 0) << name;
    const SceneBody& body = scene.bodies[scene.bodyIndex(name)];
    EXPECT_DOUBLE_EQ(body.mass_kg, 0.1);
    EXPECT_DOUBLE_EQ(body.linear_damping_per_s, 0.7);  // value of the paper
  }
  const SceneBody& cube = scene.bodies[scene.bodyIndex("cube")];
  EXPECT_NEAR(cube.inertia_kg_m2(0, 0), 0.1 * 0.05 * 0.05 / 6.0, 1e-15);  // m a² / 6
}

TEST(SceneFile, Table_CarriesItsBodies) {
  const SceneModel scene = orThrow(loadSceneFile(WHOLEHAND_SOURCE_DIR "/config/scenes/table.toml"));
  const SceneBody& table = scene.bodies[scene.bodyIndex("table")];
  EXPECT_TRUE(table.fixed);
  for (const SceneBody& body : scene.bodies) {
    if (!body.fixed) {
      EXPECT_NEAR(separation(table, body), 0.0, 1e-6) << body.name;
    }
  }
  const SceneBody& mug = scene.bodies[scene.bodyIndex("mug")];
  EXPECT_EQ(mug.shapes.size(), 5U);
  const std::string folder = WHOLEHAND_SOURCE_DIR "/config/scenes/assets/";
  EXPECT_EQ(scene.assets,
            (std::vector<std::string>{folder + "octagonal-prism.obj", folder + "mug.urdf"}));
  EXPECT_NEAR(mug.mass_kg, 0.23, 1e-12);  // 0.2 + 0.03 of its inertials
}

TEST(SceneFile, EveryKey_ReachesTheModel) {
  const Folder folder;
  const SceneModel scene = orThrow(loadSceneFile(folder.write("s.toml", kSceneHead + R"(
hand_friction = 0.5
[[bodies]]
name = "rod"
shape = "capsule"
radius_m = 0.01
length_m = 0.1
mass_kg = 0.2
position_m = [0.1, 0.2, 0.3]
orientation_rpy_rad = [0.0, 1.5707963267948966, 0.0]
friction = 0.3
linear_damping_per_s = 0.25
color = "#a1B2c3"
)")));
  EXPECT_DOUBLE_EQ(scene.hand_friction, 0.5);
  const SceneBody& rod = scene.bodies.at(0);
  EXPECT_DOUBLE_EQ(rod.friction, 0.3);
  EXPECT_DOUBLE_EQ(rod.linear_damping_per_s, 0.25);
  EXPECT_EQ(rod.color, "#a1B2c3");
  const Vector3d tip = rod.pose * Vector3d(0.0, 0.0, 0.06);  // z turned onto x by the pitch
  EXPECT_LT((tip - Vector3d(0.16, 0.2, 0.3)).norm(), 1e-12);
}

TEST(SceneFile, UrdfWithMass_IsScaledToTheScenesMass) {
  const Folder folder;
  folder.write("thing.urdf", R"(<robot name="r"><link name="a">
    <inertial><mass value="2"/><inertia ixx="0.0002" iyy="0.0003" izz="0.0004"/></inertial>
    <collision><geometry><sphere radius="0.02"/></geometry></collision></link></robot>)");
  const SceneModel own = orThrow(loadSceneFile(folder.write("own.toml", kSceneHead + kUrdfBody)));
  EXPECT_DOUBLE_EQ(own.bodies[0].mass_kg, 2.0);
  EXPECT_DOUBLE_EQ(own.bodies[0].inertia_kg_m2(2, 2), 0.0004);
  const SceneModel half =
      orThrow(loadSceneFile(folder.write("half.toml", kSceneHead + kUrdfBody + "mass_kg = 1.0\n")));
  EXPECT_DOUBLE_EQ(half.bodies[0].inertia_kg_m2(2, 2), 0.0002);
}

// Many public files of furniture and floors give 0 kg.
TEST(SceneFile, FixedUrdf_MayHaveAnyInertial) {
  const Folder folder;
  folder.write("thing.urdf", R"(<robot name="r"><link name="a">
    <inertial><mass value="0"/><inertia ixx="0" iyy="0" izz="0"/></inertial>
    <collision><geometry><sphere radius="0.02"/></geometry></collision></link></robot>)");
  EXPECT_TRUE(
      loadSceneFile(folder.write("fixed.toml", kSceneHead + kUrdfBody + "fixed = true\n")).ok());
  const SceneModel stands =
      orThrow(loadSceneFile(folder.write("stands.toml", kSceneHead + kUrdfBody)));
  EXPECT_TRUE(stands.bodies[0].fixed);
  EXPECT_TRUE(contains(format(stands.notices), "has a mass of 0: the body stands, as in Bullet"));
  const SceneModel moves = orThrow(
      loadSceneFile(folder.write("moves.toml", kSceneHead + kUrdfBody + "mass_kg = 0.2\n")));
  EXPECT_FALSE(moves.bodies[0].fixed);
  EXPECT_NEAR(moves.bodies[0].inertia_kg_m2(0, 0), 0.4 * 0.2 * 4e-4, 1e-12);
}

TEST(SceneFile, UrdfWithoutMass_IsWeighedByItsColliders) {
  const Folder folder;
  const auto write = [&](const std::string& inertial) {
    folder.write("thing.urdf", "<robot name=\"r\"><link name=\"a\">" + inertial +
                                   "<collision><geometry><box size=\"0.1 0.1 0.05\"/></geometry>"
                                   "</collision></link></robot>");
    return loadSceneFile(folder.write(
        "s.toml", kSceneHead + kUrdfBody + (inertial.empty() ? "" : "fixed = false\n")));
  };
  for (const char* inertial : {"", "<inertial><mass value=\"0\"/></inertial>"}) {
    const SceneModel scene = orThrow(write(inertial));
    EXPECT_FALSE(scene.bodies[0].fixed);
    EXPECT_NEAR(scene.bodies[0].mass_kg, 0.3, 1e-12);  // 500 cm³ at 600 kg/m³
    EXPECT_TRUE(contains(format(scene.notices), "the URDF has no mass: 0.3 kg, at 600 kg/m³"));
  }
  EXPECT_TRUE(contains(format(write("<inertial><mass value=\"-1\"/></inertial>").errors()),
                       "link[a].inertial.mass.value = -1: is negative"));
}

TEST(SceneFile, FrictionOfAUrdf_IsAppliedUnlessTheSceneGivesOne) {
  const Folder folder;
  const auto load = [&](const std::string& contact, const std::string& gazebo,
                        const std::string& more) {
    folder.write("thing.urdf", R"(<robot name="r"><link name="a"><contact>)" + contact +
                                   R"(</contact><collision><geometry><sphere radius="0.02"/>
      </geometry></collision></link><gazebo reference="a">)" +
                                   gazebo + "</gazebo></robot>");
    return orThrow(
        loadSceneFile(folder.write("s.toml", kSceneHead + kUrdfBody + "mass_kg = 0.1\n" + more)));
  };
  const std::string lateral = "<lateral_friction value=\"0.1\"/>";
  EXPECT_EQ(load(lateral, "", "").bodies[0].friction, 0.1);
  EXPECT_EQ(load("", "<mu1>0.2</mu1><mu2>0.2</mu2>", "").bodies[0].friction, 0.2);
  EXPECT_EQ(load(lateral, "", "friction = 0.3\n").bodies[0].friction, 0.3);
  EXPECT_EQ(load("", "", "").bodies[0].friction, 0.8);
  EXPECT_TRUE(load(lateral, "", "").notices.empty());
  const auto noticed = [&](const std::string& contact, const std::string& gazebo) {
    const SceneModel scene = load(contact, gazebo, "");
    return scene.notices.size() == 1 ? format(scene.notices[0]) : "";
  };
  EXPECT_TRUE(contains(noticed(lateral + "<rolling_friction value=\"0.01\"/>", ""),
                       "thing.urdf:1: link[a].contact.rolling_friction = 0.01: is not applied"));
  EXPECT_EQ(noticed("<rolling_friction value=\"0\"/>", ""), "");
  EXPECT_TRUE(contains(noticed(lateral, "<mu1>0.2</mu1>"),
                       "gazebo[a].mu1 = 0.2: is not applied: the body has one friction, 0.1"));
  EXPECT_TRUE(contains(noticed("", "<mu1>100</mu1>"), "mu1 = 100: is too large: 2 is applied"));
}

// v = sqrt(2 g h): 15 m/s after 11.47 m, for any thickness of the floor.
TEST(SceneFile, FallFasterThanContactsAllow_IsRefused) {
  const Folder folder;
  const auto from = [&](double z_m) {
    return loadSceneFile(
        folder.write("s.toml", kSceneHead +
                                   "[[bodies]]\nname = \"floor\"\nshape = \"box\"\nfixed = true\n"
                                   "size_m = [2, 2, 1]\nposition_m = [0, 0, -3.5]\n"  // -4 .. -3
                                   "[[bodies]]\nname = \"b\"\nshape = \"sphere\"\nradius_m = 0.02\n"
                                   "mass_kg = 0.1\nposition_m = [0, 0, " +
                                   std::to_string(z_m) + "]\n"));
  };
  EXPECT_TRUE(from(8.46).ok());
  const auto refused = from(8.5);
  ASSERT_FALSE(refused.ok());
  const std::string why = format(refused.errors());
  EXPECT_TRUE(contains(why, "may fall 11.5 m and arrive at 15 m/s"));
  EXPECT_TRUE(contains(why, "11.5 m above the lowest top of a fixed shape"));
}

// At 30 m/s2, 15 m/s are reached after 3.75 m. The hand is near the origin.
TEST(SceneFile, FallOntoTheHandFasterThanContactsAllow_IsRefusedForAnySourceOfTheMass) {
  const Folder folder;
  const std::string head = replaced(kSceneHead, "-9.81", "-30");
  const auto said = [&](const std::string& body) {
    const auto scene = loadSceneFile(folder.write("s.toml", head + body));
    return scene.ok() ? "" : format(scene.errors());
  };
  const std::string ball =
      "[[bodies]]\nname = \"b\"\nshape = \"sphere\"\nradius_m = 0.02\nmass_kg = 0.1\n";
  EXPECT_EQ(said(ball + "position_m = [0, 0, 3.7]\n"), "");
  EXPECT_TRUE(contains(said(ball + "position_m = [0, 0, 3.8]\n"), "may fall 3.8 m"));
  folder.write("thing.urdf", R"(<robot name="r"><link name="a"><collision><origin xyz="0 0 4"/>
<geometry><sphere radius="0.02"/></geometry></collision></link></robot>)");
  EXPECT_TRUE(contains(said(kUrdfBody + "mass_kg = 0.1\n"), "may fall 4 m and arrive at 15.5 m/s"));
}

const std::string kRefuse = "inertia = \"refuse\"\n";

TEST(SceneFile, UrdfWithAnImpossibleInertial_IsRefusedOrReplaced) {
  const Folder folder;
  const auto write = [&](const std::string& inertial) {
    folder.write("thing.urdf", "<robot name=\"r\"><link name=\"a\"><inertial>" + inertial +
                                   "</inertial><collision><geometry><box size=\"0.06 0.08 0.24\"/>"
                                   "</geometry></collision></link></robot>");
  };
  // The placeholder of many public files: 1 kg m² at 0.1 kg. Between -0.12 and 0.12 m, 0.1 kg have
  // a second moment of 0.1·0.12² at most; between -0.03 and 0.03 m, of 9e-5.
  write("<mass value=\"0.1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/>");
  const Expected<SceneModel> placeholder =
      loadSceneFile(folder.write("placeholder.toml", kSceneHead + kUrdfBody + kRefuse));
  ASSERT_FALSE(placeholder.ok());
  const std::string message = format(placeholder.errors());
  EXPECT_TRUE(contains(message, "are 1, 1, 1 kg·m²"));
  EXPECT_TRUE(contains(message, "9e-05 kg·m² at most along that axis, not 0.5"));
  EXPECT_TRUE(contains(message, "inertia = \"colliders\""));
  // m (a² + b²) / 12
  const SceneModel even = orThrow(loadSceneFile(
      folder.write("even.toml", kSceneHead + kUrdfBody + "inertia = \"colliders\"\n")));
  EXPECT_NEAR(even.bodies[0].inertia_kg_m2(2, 2), 0.1 * (0.06 * 0.06 + 0.08 * 0.08) / 12.0, 1e-12);
  EXPECT_NEAR(even.bodies[0].inertia_kg_m2(0, 0), 0.1 * (0.08 * 0.08 + 0.24 * 0.24) / 12.0, 1e-12);
  // A centre of mass in millimetres that is read as metres.
  write(
      "<origin xyz=\"0 0 60\"/><mass value=\"0.1\"/><inertia ixx=\"1e-4\" iyy=\"1e-4\" "
      "izz=\"1e-4\"/>");
  const Expected<SceneModel> far =
      loadSceneFile(folder.write("far.toml", kSceneHead + kUrdfBody + kRefuse));
  EXPECT_TRUE(refusedWith(far, "59.9 m outside of its colliders"));
}

// 0.1 kg of osmium are a ball of r = 10.18 mm: 2/5 m r² = 4.15e-6 kg m2. No real body has less.
TEST(SceneFile, UrdfWithLessInertiaThanABallOfOsmium_IsRefused) {
  const Folder folder;
  const auto said = [&](const std::string& mass, const std::string& moment) {
    folder.write("thing.urdf",
                 fmt::format(R"(<robot name="r"><link name="a"><inertial><mass value="{0}"/>
<inertia ixx="{1}" iyy="{1}" izz="{1}"/></inertial><collision><geometry>
<box size="0.06 0.04 0.02"/></geometry></collision></link></robot>)",
                             mass, moment));
    const auto scene = loadSceneFile(folder.write("s.toml", kSceneHead + kUrdfBody + kRefuse));
    return scene.ok() ? "" : format(scene.errors());
  };
  EXPECT_EQ(said("0.1", "4.16e-6"), "");
  EXPECT_TRUE(contains(said("0.1", "4.13e-6"), "0.1 kg have 4.15e-06 at least"));
  EXPECT_TRUE(contains(said("0.1", "1e-30"), "are 1e-30 kg·m² in the mean"));
  // 100 g read as 100 kg: a 48 cm3 body of 2.1e6 kg/m3. At up to ten times that density, the
  // inertia is at least 2/5 m (3 V / 40 π)^(2/3) = 0.00438.
  EXPECT_TRUE(
      contains(said("100", "3e-5"), "100 kg have 0.00438 at least, as a ball of 2.08e+07 kg"));
}

TEST(SceneFile, BallastFarFromTheColliders_IsRefused) {
  const Folder folder;
  const auto at = [&](const std::string& z_m) {
    folder.write("thing.urdf", R"(<robot name="r"><link name="a"><inertial><mass value="0.1"/>
<inertia ixx="1.667e-5" iyy="3.333e-5" izz="4.333e-5"/></inertial><collision><geometry>
<box size="0.06 0.04 0.02"/></geometry></collision></link><link name="w"><inertial><origin xyz="0 0 )" +
                                   z_m + R"("/><mass value="0.01"/>
<inertia ixx="1e-6" iyy="1e-6" izz="1e-6"/></inertial></link><joint name="j" type="fixed">
<parent link="a"/><child link="w"/></joint></robot>)");
    return loadSceneFile(folder.write("s.toml", kSceneHead + kUrdfBody + kRefuse));
  };
  EXPECT_TRUE(at("0.05").ok());
  ASSERT_FALSE(at("60").ok());  // mm read as m; ten diagonals of the box are 0.748 m
  EXPECT_TRUE(
      contains(format(at("60").errors()), "is 60 m outside of its colliders; 0.748 m at most"));
}

TEST(SceneFile, Overlap_NamesBothBodiesAndTheDepth) {
  const Folder folder;
  const Expected<SceneModel> deep = loadSceneFile(
      folder.write("deep.toml", kSceneHead + ball("left", 0.0) + ball("right", 0.03)));
  ASSERT_FALSE(deep.ok());
  const std::string message = format(deep.errors());
  EXPECT_TRUE(contains(message, "'right' starts 10 mm inside 'left'"));
  EXPECT_TRUE(contains(message, ":16: bodies"));  // right's position_m
  EXPECT_TRUE(loadSceneFile(folder.write("touch.toml",
                                         kSceneHead + ball("left", 0.0) + ball("right", 0.03995)))
                  .ok());  // 0.05 mm: rounding in files
  EXPECT_FALSE(loadSceneFile(folder.write("near.toml",
                                          kSceneHead + ball("left", 0.0) + ball("right", 0.0398)))
                   .ok());
}

// Moving links are recorded by name. Earlier, run --record refused such names without naming a
// line.
TEST(SceneFile, MovingLinkWhoseNameCannotBeRecorded_IsRefusedAtItsLine) {
  const Folder folder;
  const auto load = [&](const std::string& name, const std::string& more = "") {
    folder.write("thing.urdf",
                 "<robot name=\"r\"><link name=\"a\"><collision><geometry><sphere radius=\"0.02\"/>"
                 "</geometry></collision></link>\n<link name=\"" +
                     name +
                     "\"><inertial><mass value=\"0.1\"/><inertia ixx=\"2e-5\" iyy=\"2e-5\" "
                     "izz=\"2e-5\"/></inertial><collision><geometry><sphere radius=\"0.02\"/>"
                     "</geometry></collision></link>\n<joint name=\"j\" type=\"revolute\">"
                     "<origin xyz=\"0.1 0 0\"/><parent link=\"a\"/><child link=\"" +
                     name +
                     "\"/><axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"1\"/></joint></robot>");
    return loadSceneFile(folder.write("s.toml", kSceneHead + kUrdfBody + more));
  };
  EXPECT_TRUE(load("t\u00fcr"));
  EXPECT_TRUE(load(std::string(198, 'n')));  // 200 with "u/"
  EXPECT_TRUE(refusedWith(load(std::string(199, 'n')), "thing.urdf:2: link[nnn"));
  EXPECT_TRUE(refusedWith(load(std::string(3000, 'n')), "is too long"));
  EXPECT_TRUE(refusedWith(load("t\xfcr"), "thing.urdf:2: link[t\\xfcr]: moves on a joint, and"));
  EXPECT_TRUE(refusedWith(load("a&#10;b"), "thing.urdf:2: link[a\\x0ab]: moves on a joint, and"));
  EXPECT_TRUE(load("door", ball("u/lid", 0.5)));
  EXPECT_TRUE(refusedWith(load("door", ball("u/door", 0.5)),
                          "thing.urdf:2: link[door]: moves on a joint as 'u/door', the name of"));
}

TEST(SceneFile, AllFaults_AreReportedTogetherOnePerLine) {
  const Folder folder;
  const Expected<SceneModel> scene = loadSceneFile(
      folder.write("bad.toml",
                   "kind = \"scene\"\nversion = 1\nname = \"\"\n"
                   "[[bodies]]\nname = \"a\"\nshape = \"box\"\nsize_m = [0.1, nan, 0.1]\n"
                   "mass_kg = 0\nposition_m = [0, 0]\nwobble = 1\n"));
  ASSERT_FALSE(scene.ok());
  // name empty, gravity missing, size, mass, position, unknown key
  EXPECT_EQ(scene.errors().size(), 6U) << format(scene.errors());
}

TEST(SceneFile, TooManyBodies_AreRefused) {
  const Folder folder;
  std::string text = kSceneHead;
  const auto ballAt = [&](int i, bool moves) {
    const std::string moving = ball("b" + std::to_string(i), 0.05 * (i % 64), 0.05 * (i / 64));
    return moves ? moving : std::regex_replace(moving, std::regex("mass_kg = 0.1"), "fixed = true");
  };
  for (int i = 0; i < kMaxSceneBodies; ++i) text += ballAt(i, i < kMaxBodies);
  EXPECT_TRUE(loadSceneFile(folder.write("full.toml", text)).ok());
  const Expected<SceneModel> scene =
      loadSceneFile(folder.write("over.toml", text + ball("x", -9.0)));
  EXPECT_TRUE(refusedWith(scene, "1025 bodies"));
  std::string moving = kSceneHead;
  for (int i = 0; i <= kMaxBodies; ++i) moving += ballAt(i, true);
  const Expected<SceneModel> unwatched = loadSceneFile(folder.write("moving.toml", moving));
  EXPECT_TRUE(refusedWith(unwatched, "moves and is body 129 of the scene"));
}

TEST(SceneFile, MassRatioBeyond100_IsReported) {
  const Folder folder;
  const auto notices = [&](const char* mass_kg) {
    const std::string heavy = std::regex_replace(ball("heavy", 0.1), std::regex("mass_kg = 0.1"),
                                                 std::string("mass_kg = ") + mass_kg);
    Diagnostics all =
        orThrow(loadSceneFile(folder.write("s.toml", kSceneHead + ball("light", 0.0) + heavy)))
            .notices;
    std::erase_if(all, [](const Diagnostic& d) { return contains(d.problem, "kg/m³"); });
    return all;
  };
  EXPECT_TRUE(notices("9.99").empty());
  const Diagnostics said = notices("20.0");
  ASSERT_EQ(said.size(), 1U);
  EXPECT_TRUE(contains(format(said[0]), "\"heavy\" (20 kg) is 200 times as heavy as \"light\""));
}

}  // namespace
}  // namespace wholehand::test
