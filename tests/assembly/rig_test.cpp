// A rig when something fails: what is refused, what is left open.
#include "assembly/rig.hpp"

#include "assembly/watched_device.hpp"

#include <limits>

namespace wholehand::test {
namespace {

constexpr const char* kDevice = kWatchedDevice;

TEST(BuildRig, UncertifiedAroundADeviceThatMayHoldAPerson_IsRefused) {
  RigOptions options;
  options.uncertified = true;
  Story story;
  const auto refused =
      buildRig(load(shippedFiles(kDevice)), std::make_unique<WatchedDevice>(story), options);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.errors().front().key, "uncertified");
  EXPECT_TRUE(buildRigThatMovesNobody(load(shippedFiles(kDevice)),
                                      std::make_unique<WatchedDevice>(story), options));
  Models models = load(shippedFiles(kDevice));
  EXPECT_TRUE(buildRig(models, Intention::throughWaypoints({{0.0, AxisPosition(3)}}), options));
}

void expectTooLarge(const Models& models, const std::string& key, const std::string& count) {
  SCOPED_TRACE(key);
  Story story;
  const Intention rest = Intention::throughWaypoints({{0.0, AxisPosition(3)}});
  const auto around = buildRig(models, std::make_unique<WatchedDevice>(story), {});
  const auto simulated = buildRig(models, rest, {});
  for (const auto* refused : {&around, &simulated}) {
    ASSERT_FALSE(*refused);
    ASSERT_EQ(refused->errors().size(), 1U);
    EXPECT_EQ(refused->errors().front().key, key);
    EXPECT_EQ(refused->errors().front().value, count);
  }
}

// The rooms are those of core/tick_record.hpp, core/axis_array.hpp, dynamics/articulated_body.hpp.
TEST(BuildRig, ModelsPushedBeyondTheTicksRoom_AreRefused) {
  Models full = load(shippedFiles(kDevice));
  for (int i = 0; i < 32; ++i) {
    full.scene.bodies.push_back(ball({0.3, -0.8 + 0.05 * i, 0.5}, 0.01, 0.0));
  }
  Story story;
  EXPECT_TRUE(buildRig(full, std::make_unique<WatchedDevice>(story), {}));  // just fits

  Models bodies = full;
  bodies.scene.bodies.push_back(bodies.scene.bodies.back());
  expectTooLarge(bodies, "bodies", "33");
  Models links = load(shippedFiles(kDevice));
  links.hand.links.resize(41);
  expectTooLarge(links, "links", "41");
  Models joints = load(shippedFiles(kDevice));
  joints.hand.joint_count = 33;
  expectTooLarge(joints, "joints", "33");
  Models axes = load(shippedFiles(kDevice));
  axes.device.axes.resize(17);
  expectTooLarge(axes, "axes", "17");
}

TEST(Rig, AtItsEnd_ClosesTheDevice) {
  Story story;
  auto rig = watched(story);
  ASSERT_TRUE(rig->renderer->arm());
  ASSERT_TRUE(story.open);
  rig.reset();
  EXPECT_FALSE(story.open);
}

TEST(Arm, Refused_LeavesTheDeviceClosed) {
  Story unreadable, buried;
  const auto rig = watched(unreadable, 0);
  EXPECT_FALSE(rig->renderer->arm());
  EXPECT_FALSE(unreadable.open);

  Models models = load(shippedFiles(kDevice));
  models.scene.bodies.push_back(fixedBox(Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones()));
  const auto in_a_box = build(std::move(models), std::make_unique<WatchedDevice>(buried));
  EXPECT_FALSE(in_a_box->renderer->arm());
  EXPECT_GT(buried.reads, 0);
  EXPECT_FALSE(buried.open);
}

}  // namespace
}  // namespace wholehand::test
