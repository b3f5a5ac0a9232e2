// Properties that only the lab's engines have.
#include "loop/physics/engine_bench.hpp"

namespace wholehand::test {
namespace {

TEST(LabEngines, ForComparisonOnly_AreRefusedWhereADeviceMayHoldAPerson) {
  const auto rig =
      buildRig(load(shippedFiles()), std::make_unique<RestingDevice>(), with("bullet-paper"));
  ASSERT_FALSE(rig);
  EXPECT_EQ(format(rig.errors()),
            "--engine = bullet-paper: is not for real devices: its contact forces do not do the "
            "virtual work of what is felt; use --engine bullet");
  EXPECT_TRUE(refuseForPersons("mujoco").empty());
}

TEST(LabEngines, BulletPaper_WithAMovingSoftBody_IsRefused) {
  const Models m = load(shippedFiles());
  SceneBody soft = ball({0.3, 0.3, 0.0}, 0.02, 0.1);
  soft.soft_m = 0.005;
  const auto world = buildWorld("bullet-paper", m.hand, weightless({soft}));
  ASSERT_FALSE(world);
  EXPECT_EQ(world.errors()[0].key, "bodies.ball.soft_m");
  EXPECT_EQ(world.errors()[0].remedy, "use --engine bullet, or fix the body");
}

}  // namespace
}  // namespace wholehand::test
