// A rig when something fails: what is refused and what is left open.
#include "rig/rig.hpp"

#include "rig/watched_device.hpp"
#include "support/contains.hpp"

#include <fmt/format.h>

#include <cmath>

namespace wholehand::test {
namespace {

constexpr const char* kDevice = kWatchedDevice;

TEST(BuildRig, UncertifiedGainsOnADeviceThatMayHoldAPerson_AreRefused) {
  RigOptions options;
  options.uncertified = true;
  Story story;
  const auto refused =
      buildRig(load(shippedFiles(kDevice)), std::make_unique<WatchedDevice>(story), options);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.errors().front().key, "uncertified");
  EXPECT_TRUE(buildRigWithoutPerson(load(shippedFiles(kDevice)),
                                    std::make_unique<WatchedDevice>(story), options));
  Models models = load(shippedFiles(kDevice));
  EXPECT_TRUE(buildRig(models, Intention::throughWaypoints({{0.0, AxisPosition(3)}}), options));
}

// v = sqrt(2 g h) = 10.4 m/s, which the plate must stop in one step.
TEST(Rig, BallThatFallsFiveAndAHalfMetres_LandsAndTheSessionContinues) {
  Models models = load(shippedFiles());
  models.scene.bodies = {fixedBox({0.8, 0.0, -0.2}, {0.3, 0.3, 0.001}),
                         ball({0.8, 0.0, 5.3}, 0.005, 0.01)};
  const AxisPosition home(models.device.axisCount());
  const auto rig =
      orThrow(buildRig(std::move(models), Intention::throughWaypoints({{0.0, home}}), {}));
  orThrow(rig->renderer->arm());
  TickRecord record;
  double fastest_m_s = 0.0;
  for (int tick = 0; tick < 1500; ++tick) {
    rig->renderer->tick(1, record);
    fastest_m_s = std::max(fastest_m_s, -record.bodies[1].velocity_m_s.z);
  }
  EXPECT_GT(fastest_m_s, 10.0);
  EXPECT_EQ(faultNames(rig->renderer->latched()), faultNames(Fault::kNone));
  EXPECT_NEAR(record.bodies[1].position_m.z, -0.2 + 0.0005 + 0.005, 1e-4);
}

TEST(CheckGains, ArmatureRenderedAsAnExcessiveMass_IsRefusedWithTheMass) {
  Models models = load(shippedFiles("lambda-pride"));
  const int finger = models.device.axisIndex("finger_flexion");
  AxisRendering& rendering = models.rendering.axes[finger];
  const DeviceAxis& axis = models.device.axes[finger];
  rendering.armature = 0.05;
  const CheckedGains checked = orThrow(checkGains(models, 1e-3));
  ASSERT_FALSE(checked.refused.empty());
  const Diagnostic& said = checked.refused.front();
  EXPECT_EQ(said.key, "axes[finger_flexion].armature_kg_m2");
  EXPECT_EQ(said.value, "0.05");
  // Rendered mass in free motion: M (1 + (1 - γ) k_d τ) with k_d = 2 √(K/M) - T K/M, M = 4.96e-5 +
  // 0.05.
  const double M = 0.05 + 4.96e-5, k_p = rendering.k_pm / M;
  const double tau_s = 1.0 / (2.0 * 3.14159265358979 * rendering.velocity_filter_hz);
  const double felt =
      M * (1.0 + (1.0 - rendering.gamma) * (2.0 * std::sqrt(k_p) - 1e-3 * k_p) * tau_s);
  EXPECT_TRUE(contains(said.problem, fmt::format("felt as {:.2g}", felt)));
  EXPECT_GT(felt, axis.mass);
  EXPECT_TRUE(contains(said.remedy, "leave it out"));
  // A rendered mass below that of the device itself is allowed.
  rendering.armature = 0.3 * axis.mass;
  for (const Diagnostic& other : orThrow(checkGains(models, 1e-3)).refused) {
    EXPECT_EQ(other.problem.find("weight"), std::string::npos) << other.problem;
  }
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

// The capacities are those of loop/core/world_query.hpp, loop/core/axis_array.hpp and
// loop/dynamics/articulated_body.hpp.
TEST(BuildRig, ModelsBeyondTheTicksCapacities_AreRefused) {
  Models full = load(shippedFiles(kDevice));
  for (int i = 0; i < 1024; ++i) {
    full.scene.bodies.push_back(
        ball({0.3 + 0.03 * (i / 64), -0.9 + 0.03 * (i % 64), 0.5}, 0.01, 0.0));
  }
  Story story;
  EXPECT_TRUE(buildRig(full, std::make_unique<WatchedDevice>(story), {}));  // just fits

  Models bodies = full;
  bodies.scene.bodies.push_back(bodies.scene.bodies.back());
  expectTooLarge(bodies, "bodies", "1025");
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

/// An exercise with only a description.
class Described final : public Exercise {
 public:
  Described(std::size_t parameters, std::size_t values) {
    description_.parameters.resize(parameters);
    description_.value_names.resize(values);
  }
  void reset() override {}
  [[nodiscard]] WorldQuery query() const noexcept override { return {}; }
  void tick(const ExerciseInput&, ExerciseRecord&, BodyPlacements&) noexcept override {}
  [[nodiscard]] std::unique_ptr<Player> makePlayer(const PlayerTraits&) const override {
    return nullptr;
  }

 private:
};

// An exercise reads its parameters from an array of 24, of which the rendering uses four.
TEST(BuildRig, ExerciseWithMoreParametersOrValuesThanATickHolds_IsRefused) {
  Models models = load(shippedFiles(kDevice));
  Story story;
  models.exercise = std::make_shared<Described>(20, 48);
  EXPECT_TRUE(buildRig(models, std::make_unique<WatchedDevice>(story), {}));  // just fits
  models.exercise = std::make_shared<Described>(21, 0);
  expectTooLarge(models, "parameters", "21");
  models.exercise = std::make_shared<Described>(0, 49);
  expectTooLarge(models, "values", "49");
}

// The loader refuses such a file, but a program may build such a model.
TEST(BuildRig, InvalidLimits_AreRefusedByName) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused_for = [](auto change) {
    Models models = load(shippedFiles(kDevice));
    change(models.device, models.device.axes[1]);
    Story story;
    const auto rig = buildRig(models, std::make_unique<WatchedDevice>(story), {});
    return rig ? std::string("built") : rig.errors().front().key;
  };
  using Device = DeviceModel&;
  using Axis = DeviceAxis&;
  EXPECT_EQ(refused_for([](Device, Axis) {}), "built");
  EXPECT_EQ(refused_for([&](Device, Axis a) { a.effort_limit = nan; }), "y.effort_limit");
  EXPECT_EQ(refused_for([&](Device, Axis a) { a.effort_limit = 0.0; }), "y.effort_limit");
  EXPECT_EQ(refused_for([&](Device, Axis a) { a.speed_limit = nan; }), "y.speed_limit");
  EXPECT_EQ(refused_for([&](Device, Axis a) { a.effort_slew_limit = nan; }), "y.effort_slew_limit");
  // 1.5 / 80 ms is the ramp's steepest slope, from one limit to the other: 37.5 limits per second.
  EXPECT_EQ(refused_for([&](Device, Axis a) { a.effort_slew_limit = 37.0 * a.effort_limit; }),
            "y.effort_slew_limit");
  EXPECT_EQ(refused_for([&](Device, Axis a) { a.neutral_effort = nan; }), "y.neutral_effort");
  EXPECT_EQ(refused_for([&](Device, Axis a) { a.neutral_effort = -1.1 * a.effort_limit; }),
            "y.neutral_effort");
  EXPECT_EQ(refused_for([&](Device, Axis a) { std::swap(a.lower, a.upper); }), "y.range");
  EXPECT_EQ(refused_for([&](Device, Axis a) { a.workspace_margin = nan; }), "y.workspace_margin");
  EXPECT_EQ(refused_for([&](Device d, Axis) { d.power_limit_w = nan; }), "power_limit_w");
  EXPECT_EQ(refused_for([&](Device d, Axis) { d.power_limit_w = 0.0; }), "power_limit_w");
}

TEST(Rig, DestroyedRig_ClosesTheDevice) {
  Story story;
  auto rig = watched(story);
  ASSERT_TRUE(rig->renderer->arm());
  ASSERT_TRUE(story.open);
  rig.reset();
  EXPECT_FALSE(story.open);
}

TEST(Arm, RefusedArming_LeavesTheDeviceClosed) {
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
