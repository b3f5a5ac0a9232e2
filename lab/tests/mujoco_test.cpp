// What is MuJoCo's alone: its errors and warnings, its room, and what it lacks.
#include "lab/mujoco/engine_errors.hpp"
#include "lab/mujoco/mujoco_world.hpp"
#include "physics/engine_bench.hpp"
#include "support/says.hpp"

#include <cmath>
#include <filesystem>
#include <mujoco/mujoco.h>

namespace wholehand::test {
namespace {

namespace fs = std::filesystem;

TEST(MujocoErrors, InACall_LeaveItAndNeitherEndTheProgramNorPrint) {
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

TEST(MujocoErrors, InACallWithinACall_LeaveTheInnerOneAlone) {
  mujoco::takeErrors();
  bool inner = true, went_on = false;
  EXPECT_TRUE(mujoco::endsWell([&] {
    inner = mujoco::endsWell([] { mju_error("made by a test"); });
    went_on = true;
  }));
  EXPECT_FALSE(inner);
  EXPECT_TRUE(went_on);
}

TEST(MujocoContacts, BeyondItsRoom_AreCountedAsDropped) {
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
  EXPECT_TRUE(says(world.errors()[0].remedy, "--engine bullet"));
}

}  // namespace
}  // namespace wholehand::test
