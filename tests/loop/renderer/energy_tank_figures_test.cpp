// The energy tank in the whole renderer: it does not act on a stable loop, at any rate.
#include "loop/device/simulated/simulated_device.hpp"
#include "loop/patient/motion.hpp"
#include "support/rig_tools.hpp"
#include "support/seed.hpp"

#include <cmath>

namespace wholehand::test {
namespace {

struct Felt {
  double ripple_n = 0.0;  ///< amplitude of the effort's alternation from tick to tick
  double largest_n = 0.0;
  int damped_ticks = 0;
};

/// Presses straight fingers against a wall until x is at its limit, then draws them back.
Felt pressAndDrawBack(double rate_hz, bool with_tank) {
  Models m = load(shippedFiles());
  const double face_m = reach(m.hand, AxisPosition(m.device.axisCount()), Eigen::Vector3d::UnitX());
  m.scene.bodies = {wall(Eigen::Vector3d::UnitX(), face_m + 0.02)};
  const AxisPosition open(m.device.axisCount());
  AxisPosition deep = open;
  deep[0] = 0.11;  // the person's 300 N/m over 9 cm exceed the device's 20 N
  auto player = std::make_unique<ScriptedPlayer>(
      Intention::throughWaypoints({{0.3, open}, {0.9, deep}, {1.4, deep}, {2.0, open}}));
  RigOptions options;
  options.period_s = 1.0 / rate_hz;
  auto device =
      std::make_unique<SimulatedDevice>(m.device, m.patient, std::move(player), options.period_s);
  const auto rig = build(std::move(m), std::move(device), options);
  RendererConfig config = rig->renderer->config();
  if (!with_tank) config.safety.tank = {};
  HapticRenderer renderer(*rig->device, *rig->world, rig->models.hand, rig->models.scene, config);
  EXPECT_TRUE(renderer.arm());
  Felt felt;
  double before = 0.0, last = 0.0;
  runTicks(renderer, static_cast<int>(2.4 * rate_hz), [&](const TickRecord& r) {
    felt.ripple_n = std::max(felt.ripple_n, std::abs(r.sent[0] - 2.0 * last + before) / 4.0);
    felt.largest_n = std::max(felt.largest_n, std::abs(r.sent[0]));
    felt.damped_ticks += any(r.faults & Fault::kTankEmpty) ? 1 : 0;
    before = last;
    last = r.sent[0];
  });
  return felt;
}

class AtEveryRate : public testing::TestWithParam<int> {};

TEST_P(AtEveryRate, PressedToSaturationAndDrawnBack_RippleEqualsThatWithoutTheTank) {
  const Felt with = pressAndDrawBack(GetParam(), true);
  const Felt without = pressAndDrawBack(GetParam(), false);
  const std::string at = " at " + std::to_string(GetParam()) + " Hz";
  figure("ripple, pressed to saturation and drawn back" + at, with.ripple_n, "N");
  figure("the same without the tank" + at, without.ripple_n, "N");
  EXPECT_NEAR(with.largest_n, 20.0, 1e-9) << "not saturated";
  EXPECT_LE(with.ripple_n, 1.05 * without.ripple_n);
  EXPECT_EQ(with.damped_ticks, 0);
}

TEST_P(AtEveryRate, ShippedBar_NeitherTankNorSlewLimitActs) {
  const int rate_hz = GetParam();
  // Plays one level chosen by the seed, or all four with full counts.
  auto random = seededRandom(static_cast<unsigned>(rate_hz));
  const bool full = fullCounts();
  const int drawn = 1 + static_cast<int>(random() % 4U);
  for (int level = full ? 1 : drawn; level <= (full ? 4 : drawn); ++level) {
    ModelFiles files = exerciseFiles("cocktail-bar");
    files.level = level;
    Models m = load(files);
    RigOptions options;
    options.period_s = 1.0 / rate_hz;
    std::unique_ptr<Player> player = m.exercise->makePlayer({random()});
    Player& seeing = *player;
    auto device =
        std::make_unique<SimulatedDevice>(m.device, m.patient, std::move(player), options.period_s);
    const auto rig = build(std::move(m), std::move(device), options);
    ASSERT_TRUE(rig->renderer->arm());
    int damped = 0, slewed = 0, ticks = 0, poured = 0;
    runTicks(*rig->renderer, (full ? 40 : 8) * rate_hz, [&](const TickRecord& r) {
      seeing.onRecord(r);
      damped += any(r.faults & Fault::kTankEmpty) ? 1 : 0;
      slewed += any(r.faults & Fault::kEffortSlew) ? 1 : 0;
      ++ticks;
      poured += r.contact_count > 0 ? 1 : 0;
    });
    const std::string at =
        ", level " + std::to_string(level) + " at " + std::to_string(rate_hz) + " Hz";
    figure("ticks of the bar in which the tank damps" + at, damped, "");
    figure("ticks in which the slew limit holds back" + at, slewed,
           ("of " + std::to_string(ticks)).c_str());
    EXPECT_EQ(damped, 0) << at;
    EXPECT_EQ(slewed, 0) << at;
    EXPECT_GT(poured, 0) << "nothing was touched";
  }
}

INSTANTIATE_TEST_SUITE_P(EnergyTank, AtEveryRate, testing::Values(1000, 2000, 4000, 8000));

}  // namespace
}  // namespace wholehand::test
