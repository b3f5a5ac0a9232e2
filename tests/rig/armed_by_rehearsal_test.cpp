// A device that may move a person is armed by a rehearsal of that very rig, and by nothing else.
#include "rig/rehearsal.hpp"
#include "support/rig_tools.hpp"
#include "support/says.hpp"

#include <type_traits>

namespace wholehand::test {
namespace {

// Only rehearse() makes one.
static_assert(!std::is_default_constructible_v<RehearsalPassed>);
static_assert(!std::is_constructible_v<RehearsalPassed, std::string>);

/// Rests at the origin. It may move a person: it does not say that it is simulated.
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

TEST(ArmedByRehearsal, WithoutOne_ADeviceThatMayMoveAPersonIsNotEvenOpened) {
  int opened = 0;
  const auto rig = orThrow(buildRig(models(), std::make_unique<Handle>(opened), {}));
  const Expected<Done> armed = rig->renderer->arm();
  ASSERT_FALSE(armed);
  EXPECT_TRUE(says(armed.errors().front().problem, "rehearsed"));
  EXPECT_TRUE(says(armed.errors().front().remedy, "rehearse()"));
  EXPECT_EQ(opened, 0);
  EXPECT_EQ(rig->renderer->safetyState(), SafetyState::kDisarmed);
}

TEST(ArmedByRehearsal, WithItsOwn_IsArmedAndArmedAgain) {
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

TEST(ArmedByRehearsal, WithThatOfAnotherSceneOrRate_IsRefusedAndNotOpened) {
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
    EXPECT_TRUE(says(armed.errors().front().problem, "not what is to be rendered"));
  }
  EXPECT_EQ(opened, 0);
}

// Who allows a tick more than the limit finds out how long it takes, and may arm nothing with it.
TEST(ArmedByRehearsal, HeldToLessThanTheLimit_IsNoPass) {
  RehearsalOptions loose;
  loose.most_of_period = 10.0 * mostOfPeriod();
  EXPECT_FALSE(orThrow(rehearse(models(), AxisPosition(3), {}, loose)).passed);
}

TEST(ArmedByRehearsal, SimulatedDevicesAndThoseThatMoveNobody_NeedNone) {
  const auto simulated =
      orThrow(buildRig(models(), Intention::throughWaypoints({{0.0, AxisPosition(3)}}), {}));
  EXPECT_TRUE(simulated->renderer->arm());
  int opened = 0;
  EXPECT_TRUE(build(models(), std::make_unique<Handle>(opened))->renderer->arm());
}

TEST(RehearsalFingerprint, OfAnythingThatMakesOtherContactsOrTicks_Differs) {
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
  EXPECT_EQ(fingerprint(of_another_patient), one);  // who is not there when it is rehearsed
}

}  // namespace
}  // namespace wholehand::test
