// Efforts on a person's hand when the physics world fails, and after the loop has stood still.
#include "loop/device/simulated/simulated_device.hpp"
#include "loop/physics/analytic/analytic_world.hpp"
#include "loop/renderer/safety_tools.hpp"
#include "support/faulty_world.hpp"

#include <cstring>

namespace wholehand::test {
namespace {

/// A renderer of a closed-form world that fails: the hand meets a rigid stop halfway along x.
struct FailingWorldRig {
  std::unique_ptr<Rig> rig;  ///< provides models, device and gains; its own renderer stays idle
  std::unique_ptr<AnalyticWorld> world;
  std::unique_ptr<FaultyWorld> faulty;
  std::unique_ptr<HapticRenderer> renderer;
};

FailingWorldRig failingWorldRig(InjectedWorldFault fault, std::mt19937_64& random) {
  FailingWorldRig out;
  Models m =
      withWeight(load(shippedFiles("lambda-pride", "empty", "adult-median-right", "stiff-adult")));
  Intention intention = slamming(m.device, random, clear(m.device));
  out.rig = orThrow(buildRig(std::move(m), std::move(intention), {}));
  const Models& models = out.rig->models;
  AnalyticScene scene;
  scene.axes.resize(static_cast<std::size_t>(models.hand.axis_count));
  scene.axes[models.device.axisIndex("x")].upper_stop = 0.0;
  out.world = std::make_unique<AnalyticWorld>(models.hand, std::move(scene));
  out.faulty = std::make_unique<FaultyWorld>(*out.world, fault);
  out.renderer = std::make_unique<HapticRenderer>(*out.rig->device, *out.faulty, models.hand,
                                                  SceneModel{}, out.rig->renderer->config());
  return out;
}

std::vector<TickRecord> run(HapticRenderer& renderer, int ticks) {
  std::vector<TickRecord> records;
  records.reserve(static_cast<std::size_t>(ticks));
  runTicks(renderer, ticks, [&](const TickRecord& r) { records.push_back(r); });
  return records;
}

struct WorldFailure {
  const char* name;
  InjectedWorldFault::Kind kind;
  Fault reported;
  int delay;  ///< ticks until the ramp begins: a failed step is known only after the write
};

class InjectedWorldFailure : public ::testing::TestWithParam<WorldFailure> {};

TEST_P(InjectedWorldFailure, AtARandomTick_RampsToNeutralAndTheWorldIsNotSteppedUntilArmed) {
  const WorldFailure failure = GetParam();
  std::mt19937_64 random = seededRandom(5);
  for (int i = 0; i < cases(3); ++i) {
    const int at =
        static_cast<int>(uniform(random, 20, 1000));  // some of them while the force engages
    SCOPED_TRACE("tick " + std::to_string(at));
    FailingWorldRig f = failingWorldRig({failure.kind, at}, random);
    ASSERT_TRUE(f.renderer->arm());
    const std::vector<TickRecord> records = run(*f.renderer, at + 300);
    ASSERT_EQ(records[at - 1].faults & kStoppingFaults, Fault::kNone);
    EXPECT_EQ(records[at].faults & failure.reported, failure.reported);
    EXPECT_EQ(f.renderer->latched() & failure.reported, failure.reported);
    for (const TickRecord& r : records) {
      expectWithinLimits(*f.renderer, r);
      ASSERT_TRUE(allFinite(r.sent)) << "tick " << r.tick;
    }
    expectRamp(*f.renderer, records, at + failure.delay);
    EXPECT_EQ(f.faulty->steps(), at);  // the steps before it, and none since

    ASSERT_TRUE(f.renderer->arm());
    const std::vector<TickRecord> again = run(*f.renderer, 15);
    EXPECT_FALSE(f.renderer->atNeutral());
    EXPECT_EQ(again.back().faults & kStoppingFaults, Fault::kNone);
    EXPECT_GT(again.back().authority, 0.0);
    EXPECT_LT(again.front().authority, 1e-3);
    EXPECT_EQ(f.faulty->steps(), 15);
  }
}
INSTANTIATE_TEST_SUITE_P(
    Kinds, InjectedWorldFailure,
    ::testing::ValuesIn(std::vector<WorldFailure>{
        {"NonFiniteState", InjectedWorldFault::Kind::kNonFiniteState, Fault::kNonFiniteState, 0},
        // A failure that the engine does not report shows in the effort computed from its state.
        {"SilentNan", InjectedWorldFault::Kind::kSilentNan, Fault::kNonFiniteEffort, 0},
        {"StepFails", InjectedWorldFault::Kind::kStepFails, Fault::kPhysicsStep, 1}}),
    [](const auto& tested) { return std::string(tested.param.name); });

// ---- the loop stands still

/// A patient who moves across the workspace on every axis at once.
std::unique_ptr<Rig> crossingRig() {
  Models m =
      withWeight(load(shippedFiles("lambda-pride", "empty", "adult-median-right", "stiff-adult")));
  AxisPosition here(m.device.axisCount()), there(m.device.axisCount());
  for (int a = 0; a < here.size(); ++a) {
    const DeviceAxis& axis = m.device.axes[a];
    here[a] = std::lerp(axis.lower, axis.upper, 0.1);
    there[a] = std::lerp(axis.lower, axis.upper, 0.9);
  }
  Intention intention = Intention::throughWaypoints({{0.0, here}, {0.4, here}, {1.1, there}});
  return orThrow(buildRig(std::move(m), std::move(intention), {}));
}

/// Effort that the renderer would send if it were fully engaged.
AxisEffort wanted(const HapticRenderer& renderer, const TickRecord& r) {
  const RendererConfig& config = renderer.config();
  AxisEffort out = r.rendered;
  for (int a = 0; a < out.size(); ++a) {
    out[a] = std::clamp(out[a] + config.safety.neutral[a], -config.safety.effort_limit[a],
                        config.safety.effort_limit[a]);
  }
  return out;
}

TEST(StalledLoop, WhilePatientMovesFast_EngagesAgainWithoutAStep) {
  const auto rig = crossingRig();
  HapticRenderer& renderer = *rig->renderer;
  const RendererConfig& config = renderer.config();
  const AxisEffort& limit = config.safety.effort_limit;
  ASSERT_TRUE(renderer.arm());
  TickRecord before = *runTicks(renderer, 600);
  const AxisEffort held = before.sent;
  ASSERT_EQ(before.authority, 1.0);
  TickRecord now = before;
  renderer.tick(200, now);  // the device moved on for 200 ms under that effort

  // The test can fail: the wanted effort jumps by half the limit or more on the worst axis.
  double jump = 0.0;
  for (int a = 0; a < held.size(); ++a) {
    jump = std::max(jump, std::abs(wanted(renderer, now)[a] - held[a]) / limit[a]);
  }
  EXPECT_GT(jump, 0.5);

  // docs/safety.md: time for the distance at a tenth of the speed limits, 30 ms to half a second.
  double blend_s = config.safety.ramp.reengage_s;
  for (int a = 0; a < held.size(); ++a) {
    const double speed = 0.1 * rig->models.device.axes[a].speed_limit;
    blend_s = std::max(blend_s, std::abs(now.q_m[a] - before.q_m[a]) / speed);
  }
  blend_s = std::min(blend_s, 0.5);
  EXPECT_GT(blend_s, 0.2) << "the hand went far";

  // sent = held + s (wanted - held), both within the limit: |sent - held| <= 2 limit s. From one
  // tick to the next it changes by (s' - s) (wanted' - held) + s (wanted' - wanted), where s rises
  // by at most the smoothstep's steepest slope, 1.5 T / blend_s. That is at most 3 limit T /
  // blend_s, plus the share s of the rendered force's own change.
  double largest = 0.0;
  double authority = 0.0;  // of the tick before; 0 because it was engaged again
  for (int k = 1; k <= 700; ++k) {
    const AxisEffort want = wanted(renderer, now), wanted_before = wanted(renderer, before);
    for (int a = 0; a < held.size(); ++a) {
      const double change = std::abs(now.sent[a] - before.sent[a]);
      const double own = authority * std::abs(want[a] - wanted_before[a]);
      ASSERT_LE(change, 3.0 * limit[a] * config.period_s / blend_s + own + 1e-12) << k;
      ASSERT_LE(std::abs(now.sent[a] - held[a]), 2.0 * limit[a] * now.authority + 1e-12) << k;
      if (k == 1) largest = std::max(largest, change / limit[a]);
      if (k * config.period_s >= blend_s + config.period_s) {
        ASSERT_EQ(now.sent[a], want[a]) << k;  // fully engaged again
      }
    }
    authority = now.authority;
    before = now;
    renderer.tick(1, now);
  }
  // The smoothstep's first step, 3 (T / blend_s)², of a span of at most twice the limit.
  const double u = config.period_s / blend_s;
  EXPECT_LE(largest, 6.0 * u * u + 1e-12);
  figure("step of the effort after a stall of 200 ms, worst axis, share of its limit", largest, "");
  figure("the same had it not engaged anew", jump, "");
}

// This also holds for a simulated device: docs/safety.md, kLongGap.
TEST(StalledLoop, MoreThanHalfASecond_LetsGoFromTheHeldEffort) {
  for (const std::uint32_t periods : {500U, 501U, 2000U, 3'600'000U}) {
    const auto rig = crossingRig();
    HapticRenderer& renderer = *rig->renderer;
    const AxisEffort& neutral = renderer.config().safety.neutral;
    ASSERT_TRUE(renderer.arm());
    TickRecord now = *runTicks(renderer, 600);
    AxisEffort before = now.sent;
    renderer.tick(periods, now);
    EXPECT_EQ(any(now.faults & Fault::kLongGap), periods > 500);
    if (periods == 500) continue;
    for (int k = 0; !renderer.atNeutral(); ++k) {
      ASSERT_LE(k, 100);
      for (int a = 0; a < before.size(); ++a) {
        ASSERT_LE(std::abs(now.sent[a] - neutral[a]), std::abs(before[a] - neutral[a]) + 1e-12);
      }
      before = now.sent;
      renderer.tick(1, now);
    }
  }
}

TEST(StalledLoop, FivePeriods_StaysEngaged) {
  const auto rig = crossingRig();
  HapticRenderer& renderer = *rig->renderer;
  ASSERT_TRUE(renderer.arm());
  TickRecord now = *runTicks(renderer, 600);
  const AxisEffort before = now.sent;
  renderer.tick(5, now);
  EXPECT_EQ(now.authority, 1.0);
  // The change over five periods comes at once, as far as the slew limit of one period allows.
  const AxisEffort want = wanted(renderer, now);
  const AxisEffort& most = renderer.config().safety.supervisor.most_change;
  for (int a = 0; a < want.size(); ++a) {
    EXPECT_EQ(now.sent[a], std::clamp(want[a], before[a] - most[a], before[a] + most[a])) << a;
  }
}

struct Stalls {
  std::uint32_t periods;  ///< skipped periods
  int every;              ///< ticks between two stalls
};

/// A relaxed person leans along x on a wall at 0 with 100 N/m from 2 cm behind it, while the loop
/// stalls repeatedly. @return amplitude of the device in the last four of 14 s [m]
double swingAgainstAWall(Stalls stalls, double reengage_s) {
  Models m = load(shippedFiles());
  const int x = m.device.axisIndex("x");
  for (PatientAxis& axis : m.patient.axes) {
    if (axis.name == "x") axis.mass = 1.0, axis.damping = 5.0, axis.stiffness = 100.0;
  }
  // The damping by palm contact is off, since it would hide the swing.
  for (AxisRendering& axis : m.rendering.axes) axis.palm_contact = false;
  AxisPosition away(m.device.axisCount());
  for (int a = 0; a < away.size(); ++a) {
    away[a] = std::lerp(m.device.axes[a].lower, m.device.axes[a].upper, 0.4);
  }
  AxisPosition beyond = away;
  away[x] = -0.03;
  beyond[x] = 0.02;
  Intention intention = Intention::throughWaypoints({{0.0, away}, {0.5, away}, {0.75, beyond}});
  const auto rig = orThrow(buildRig(std::move(m), std::move(intention), {}));
  const Models& models = rig->models;
  AnalyticScene scene;
  scene.axes.resize(static_cast<std::size_t>(models.hand.axis_count));
  scene.axes[x].upper_stop = 0.0;
  AnalyticWorld world(models.hand, std::move(scene));
  RendererConfig config = rig->renderer->config();
  config.safety.ramp.reengage_s = reengage_s;
  HapticRenderer renderer(*rig->device, world, models.hand, models.scene, config);
  EXPECT_TRUE(renderer.arm());
  const auto& device = dynamic_cast<const SimulatedDevice&>(*rig->device);
  TickRecord r;
  double time_s = 0.0, least_m = 1.0, most_m = -1.0;
  for (int k = 0; time_s < 14.0; ++k) {
    const std::uint32_t elapsed = k > 450 && k % stalls.every == 0 ? 1 + stalls.periods : 1;
    renderer.tick(elapsed, r);
    time_s += elapsed * config.period_s;
    if (time_s < 10.0) continue;
    least_m = std::min(least_m, device.position()[x]);
    most_m = std::max(most_m, device.position()[x]);
  }
  return most_m - least_m;
}

// An old effort held for long does not react to the person's motion, so every stall pushes again.
TEST(StalledLoop, RepeatedStallsAtAWall_SettleWithTheConfiguredBlend) {
  EXPECT_LT(swingAgainstAWall({6, 100}, NeutralRampConfig{}.reengage_s), 1e-4);
  for (const Stalls stalls : {Stalls{6, 60}, Stalls{15, 150}}) {
    SCOPED_TRACE(std::to_string(stalls.periods) + " every " + std::to_string(stalls.every));
    const double swing_m = swingAgainstAWall(stalls, NeutralRampConfig{}.reengage_s);
    const double long_blend_m = swingAgainstAWall(stalls, 0.2);
    EXPECT_LT(swing_m, 1e-4);
    EXPECT_GT(long_blend_m, 5e-3);  // the test can fail
    figure("swing at a wall in a loop that stalls again and again", 1e3 * swing_m, "mm");
    figure("the same, blended over 0.2 s", 1e3 * long_blend_m, "mm");
  }
}

}  // namespace
}  // namespace wholehand::test
