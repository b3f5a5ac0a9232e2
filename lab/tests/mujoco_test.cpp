// Properties of MuJoCo only: its errors and warnings, its contact capacity, and unsupported hands.
#include "lab/mujoco/collisions.hpp"
#include "lab/mujoco/engine_errors.hpp"
#include "lab/mujoco/mujoco_engine.hpp"
#include "lab/mujoco/mujoco_world.hpp"
#include "loop/physics/body_yard.hpp"
#include "loop/physics/engine_bench.hpp"
#include "support/contains.hpp"
#include "support/seed.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <mujoco/mujoco.h>

namespace wholehand::test {
namespace {

namespace fs = std::filesystem;

TEST(MujocoErrors, ErrorInACall_EndsTheCallWithoutOutputOrExit) {
  mujoco::takeErrors();
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  bool went_on = false;
  EXPECT_FALSE(mujoco::endsWell([&] {
    mju_error("made by a test");
    went_on = true;
  }));
  EXPECT_FALSE(went_on);
  EXPECT_TRUE(mujoco::endsWell([] { mju_warning("made by a test"); }));
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_FALSE(fs::exists("MUJOCO_LOG.TXT")) << "stock MuJoCo writes it here";
}

TEST(MujocoErrors, ErrorInANestedCall_EndsTheInnerCallOnly) {
  mujoco::takeErrors();
  bool inner = true, went_on = false;
  EXPECT_TRUE(mujoco::endsWell([&] {
    inner = mujoco::endsWell([] { mju_error("made by a test"); });
    went_on = true;
  }));
  EXPECT_FALSE(inner);
  EXPECT_TRUE(went_on);
}

TEST(MujocoContacts, BeyondTheCapacity_AreCountedAsDropped) {
  const Models m = load(shippedFiles());
  const Eigen::Vector3d aside = -Eigen::Vector3d::UnitY();
  const double face_m = reach(m.hand, AxisPosition(6), aside) + 1e-3;
  MujocoSettings small;
  small.most_contacts = 4;
  const SceneModel scene = weightless(std::vector<SceneBody>(8, wall(aside, face_m)));
  Bench bench("mujoco", scene);
  bench.world = orThrow(MujocoWorld::build(bench.models.hand, bench.scene, small));
  AxisPosition q(6);
  ASSERT_TRUE(bench.world->placeHand(q));
  int dropped = 0;
  for (int k = 0; k < 200; ++k) {
    q[1] = -1e-4 * k;
    ASSERT_NO_FATAL_FAILURE(bench.step(q, AxisVelocity(6)));
    EXPECT_LE(bench.touching.count, small.most_contacts);
    dropped += bench.touching.dropped;
  }
  EXPECT_GT(dropped, 0);
}

/// Distance of a point from a solid in the solid's frame [m]; 0 inside. A box has these half edges.
double fromBox(const Eigen::Vector3d& at, const Eigen::Vector3d& half) {
  return (at.cwiseAbs() - half).cwiseMax(0.0).norm();
}
double fromCylinder(const Eigen::Vector3d& at, double radius_m, double half_length_m) {
  return std::hypot(std::max(at.head<2>().norm() - radius_m, 0.0),
                    std::max(std::abs(at.z()) - half_length_m, 0.0));
}

// The expected distance is the least over points of the capsule's axis, each from the solid's
// closed form.
TEST(MujocoCollisions, CapsuleAtABoxOrCylinder_IsDetectedExactlyWithinTheMargin) {
  constexpr double kCapsule_m = 0.01, kHalf_m = 0.02, kMargin_m = 0.002, kClear_m = 1e-4;
  const Eigen::Vector3d half(0.2, 0.03, 0.01);
  const std::string text =
      "<mujoco><default><geom margin='0.002' contype='2' conaffinity='0'/></default><worldbody>"
      "<geom type='box' size='0.2 0.03 0.01' conaffinity='4'/>"
      "<geom type='cylinder' size='0.03 0.1' pos='1 0 0' conaffinity='4'/>"
      "<body><freejoint/><geom type='capsule' size='0.01 0.02' contype='4' mass='1'/></body>"
      "</worldbody></mujoco>";
  mujoco::refineCollisions();
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "pair.xml", static_cast<int>(text.size()));
  std::copy(text.begin(), text.end(), static_cast<char*>(files->filedata[0]));
  const std::unique_ptr<mjModel, mujoco::Deleter> model(
      mj_loadXML("pair.xml", files.get(), nullptr, 0));
  mj_deleteVFS(files.get());
  ASSERT_NE(model, nullptr);
  const std::unique_ptr<mjData, mujoco::Deleter> data(mj_makeData(model.get()));
  std::mt19937_64 random = seededRandom(391);
  int touching = 0, apart = 0;
  for (int k = 0; k < 4000; ++k) {
    const bool box = k % 2 == 0;
    const Eigen::Quaterniond turned = Eigen::Quaterniond(anyTurn(random));
    const Eigen::Vector3d reach = (box ? half : Eigen::Vector3d(0.03, 0.03, 0.1)) +
                                  Eigen::Vector3d::Constant(kHalf_m + 2.0 * kCapsule_m);
    Eigen::Vector3d at;
    for (int i = 0; i < 3; ++i) at[i] = uniform(random, -reach[i], reach[i]);
    double nearest_m = 1.0;
    constexpr int kPoints = 400;
    for (int i = 0; i <= kPoints; ++i) {
      const double along_m = kHalf_m * (2.0 * i / kPoints - 1.0);
      const Eigen::Vector3d p = at + turned * Eigen::Vector3d(0.0, 0.0, along_m);
      nearest_m = std::min(nearest_m, box ? fromBox(p, half) : fromCylinder(p, 0.03, 0.1));
    }
    const Eigen::Vector3d placed = at + Eigen::Vector3d(box ? 0.0 : 1.0, 0.0, 0.0);
    std::copy_n(placed.data(), 3, data->qpos);
    data->qpos[3] = turned.w(), data->qpos[4] = turned.x();
    data->qpos[5] = turned.y(), data->qpos[6] = turned.z();
    mj_kinematics(model.get(), data.get());
    mj_comPos(model.get(), data.get());
    mj_collision(model.get(), data.get());
    const double gap_m = nearest_m - kCapsule_m - kMargin_m;
    if (std::abs(gap_m) < kClear_m) continue;
    EXPECT_EQ(data->ncon > 0, gap_m < 0.0) << (box ? "box" : "cylinder") << ", gap " << gap_m;
    ++(gap_m < 0.0 ? touching : apart);
  }
  EXPECT_GT(touching, 400);
  EXPECT_GT(apart, 400);
}

TEST(MujocoHand, WithAnAxisThatDrivesNoJointAlone_IsRefusedByName) {
  Models m = load(shippedFiles());
  const int fingers = 3, thumb = 5;
  for (int j = 0; j < m.hand.joint_count; ++j) {
    if (m.hand.synergy(j, fingers) != 0.0) m.hand.synergy(j, thumb) = 0.1;
  }
  const auto world = buildWorld("mujoco", m.hand, m.scene);
  ASSERT_FALSE(world);
  ASSERT_EQ(world.errors().size(), 1U);
  EXPECT_EQ(world.errors()[0].key, "synergy." + m.hand.axis_names[fingers]);
  EXPECT_TRUE(contains(world.errors()[0].remedy, "--engine bullet"));
}

}  // namespace
}  // namespace wholehand::test
