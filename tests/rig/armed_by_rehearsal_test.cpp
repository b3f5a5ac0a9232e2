// A device that may move a person can only be armed by a rehearsal of exactly that rig.
#include "rig/rehearsal.hpp"
#include "support/contains.hpp"
#include "support/rig_tools.hpp"

#include <type_traits>

namespace wholehand::test {
namespace {

// Only rehearse() makes an object of this type.
static_assert(!std::is_default_constructible_v<RehearsalPassed>);
static_assert(!std::is_constructible_v<RehearsalPassed, std::string>);

/// Rests at the origin. It counts as a device that may move a person, since it is not declared as
/// simulated.
class Handle final : public RestingDevice {
 public:
  explicit Handle(int& opened) : RestingDevice(AxisPosition(3)), opened_(opened) {}
  [[nodiscard]] Expected<Done> open() override {
    ++opened_;
    return Done{};
  }

 private:
  int& opened_;
};

Models models() {
  Models out = load(shippedFiles("desktop-3axis"));
  out.scene.bodies.push_back(fixedBox({0.4, 0.0, 0.0}, {0.1, 0.1, 0.1}));
  return out;
}

Expected<Rehearsal> rehearsed(const Models& of, const RigOptions& rig = {}) {
  return rehearse(of, AxisPosition(3), rig);
}

std::string fingerprint(const Models& of, const RigOptions& options = {}) {
  int opened = 0;
  return orThrow(buildRig(of, std::make_unique<Handle>(opened), options))
      ->renderer->config()
      .rehearsal;
}

TEST(ArmedByRehearsal, NoRehearsal_DeviceThatMayMoveAPersonIsNotOpened) {
  int opened = 0;
  const auto rig = orThrow(buildRig(models(), std::make_unique<Handle>(opened), {}));
  const Expected<Done> armed = rig->renderer->arm();
  ASSERT_FALSE(armed);
  EXPECT_TRUE(contains(armed.errors().front().problem, "rehearsed"));
  EXPECT_TRUE(contains(armed.errors().front().remedy, "rehearse()"));
  EXPECT_EQ(opened, 0);
  EXPECT_EQ(rig->renderer->safetyState(), SafetyState::kDisarmed);
}

TEST(ArmedByRehearsal, OwnRehearsal_ArmsRepeatedly) {
  int opened = 0;
  const auto rig = orThrow(buildRig(models(), std::make_unique<Handle>(opened), {}));
  const Rehearsal rehearsal = orThrow(rehearsed(rig->models));
  for (int session = 1; session <= 2; ++session) {
    ASSERT_TRUE(rig->renderer->arm(rehearsal.passed));
    EXPECT_EQ(opened, session);
    EXPECT_EQ(runTicks(*rig->renderer, 250)->safety_state, SafetyState::kRendering);
    rig->renderer->requestStop();
    EXPECT_EQ(runTicks(*rig->renderer, 120)->safety_state, SafetyState::kDisarmed);
  }
}

TEST(ArmedByRehearsal, RehearsalOfAnotherSceneOrRate_IsRefusedAndDeviceIsNotOpened) {
  int opened = 0;
  const auto rig = orThrow(buildRig(models(), std::make_unique<Handle>(opened), {}));
  Models other = models();
  other.scene.bodies.front().pose.translation_m.x() += 0.01;
  RigOptions faster;
  faster.period_s = 0.5e-3;
  for (const Rehearsal& of_other :
       {orThrow(rehearsed(other)), orThrow(rehearsed(models(), faster))}) {
    ASSERT_TRUE(of_other.passed);
    const Expected<Done> armed = rig->renderer->arm(of_other.passed);
    ASSERT_FALSE(armed);
    EXPECT_TRUE(contains(armed.errors().front().problem, "not what is to be rendered"));
  }
  EXPECT_EQ(opened, 0);
}

// A rehearsal with a laxer time limit is only a measurement and must not arm anything.
TEST(ArmedByRehearsal, RehearsalWithALaxerLimit_IsNoPass) {
  RehearsalOptions loose;
  loose.allowed_period_share = 10.0 * allowedPeriodShare();
  EXPECT_FALSE(orThrow(rehearse(models(), AxisPosition(3), {}, loose)).passed);
}

TEST(ArmedByRehearsal, SimulatedDevicesAndThoseThatMoveNobody_NeedNoRehearsal) {
  const auto simulated =
      orThrow(buildRig(models(), Intention::throughWaypoints({{0.0, AxisPosition(3)}}), {}));
  EXPECT_TRUE(simulated->renderer->arm());
  int opened = 0;
  EXPECT_TRUE(build(models(), std::make_unique<Handle>(opened))->renderer->arm());
}

TEST(RehearsalFingerprint, ChangeOfContactsOrTicks_ChangesTheFingerprint) {
  const Models same = models();
  const std::string one = fingerprint(same);
  EXPECT_EQ(fingerprint(models()), one);
  const auto differs = [&](auto change) {
    Models other = models();
    change(other);
    return fingerprint(other) != one;
  };
  EXPECT_TRUE(differs([](Models& m) { m.scene.bodies.clear(); }));
  EXPECT_TRUE(differs([](Models& m) { m.scene.bodies.push_back(m.scene.bodies.front()); }));
  EXPECT_TRUE(differs([](Models& m) { m.scene.bodies[0].shapes[0].half_extents_m.y() *= 2.0; }));
  EXPECT_TRUE(differs([](Models& m) { m.scene.bodies[0].friction *= 0.5; }));
  EXPECT_TRUE(differs([](Models& m) { m.scene.gravity_m_s2.z() = 0.0; }));
  EXPECT_TRUE(differs([](Models& m) { m.hand.capsules[0].radius_m *= 1.1; }));
  EXPECT_TRUE(differs([](Models& m) { m.hand.links.back().mass_kg *= 1.1; }));
  EXPECT_TRUE(differs([](Models& m) { m.device.axes[0].upper *= 0.9; }));
  EXPECT_TRUE(differs([](Models& m) { m.device.axes[0].effort_limit *= 0.9; }));
  EXPECT_TRUE(differs([](Models& m) { m.rendering.axes[0].k_pm *= 0.9; }));
  RigOptions faster;
  faster.period_s = 0.5e-3;
  EXPECT_NE(fingerprint(same, faster), one);
  Models of_another_patient = models();
  of_another_patient.patient.axes[0].stiffness += 1.0;
  EXPECT_EQ(fingerprint(of_another_patient), one);  // the patient takes no part in a rehearsal
}

}  // namespace
}  // namespace wholehand::test
