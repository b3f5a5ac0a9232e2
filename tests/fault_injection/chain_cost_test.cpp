// What all that watches and limits costs in a tick, in CPU time.
#include "fault_injection/fault_bench.hpp"
#include "realtime/sanitized.hpp"
#include "safety/force_limiter.hpp"
#include "safety/power_limiter.hpp"
#include "safety/slew_limiter.hpp"
#include "support/figure.hpp"
#include "support/seed.hpp"

#include <ctime>

namespace wholehand::test {
namespace {

double cpuNow_ns() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e9 * static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec);
}

/// The chain of docs/safety.md in its order, as HapticRenderer calls it.
struct Chain {
  explicit Chain(const RendererConfig& renderer)
      : config(renderer), tank(fullTank(renderer.tank)), ramp(engageFrom(renderer.neutral)) {}

  void tick(const TickRecord& r) {
    faults |= watchDevice(device, r.q_m, ramp.sent, 1, config.supervisor).faults;
    faults |= watchWorld(world, r, config.supervisor);
    const EnergyTankStep step =
        advanceTank(tank, r.q_m, r.q_s, AxisEnergy(r.q_m.size()), config.gains, config.tank,
                    config.effort_limit, 1, config.period_s);
    tank = step.state;
    AxisEffort wanted(r.q_m.size());
    for (int a = 0; a < wanted.size(); ++a) wanted[a] = r.rendered[a] + config.neutral[a];
    const LimitedEffort held = limitEffort(wanted, config.effort_limit);
    slew.note(ramp.sent);
    ramp = advanceRamp(ramp, held.effort, config.neutral, false, 1, config.period_s, config.ramp);
    const LimitedEffort out =
        limitPower(ramp.sent, config.neutral, r.qd_mf, config.supervisor.power_limit_w);
    const LimitedEffort slow = limitSlew(out.effort, slew, config.supervisor.most_change);
    ramp.sent = slow.effort;
    faults |= held.faults | out.faults | slow.faults;
    tank = noteSent(tank, ramp.sent, r.f_s, config.effort_limit);
    state = nextSafetyState(state, faults & kStopping, false, ramp.authority);
  }

  const RendererConfig& config;
  DeviceWatchState device;
  WorldWatchState world;
  EnergyTankState tank;
  NeutralRampState ramp;
  SlewWindow slew;
  SafetyState state = SafetyState::kArmed;
  Fault faults = Fault::kNone;
};

class SafetyChain : public ::testing::TestWithParam<std::string> {};

TEST_P(SafetyChain, InTheTick_TakesAtMostThreeMicroseconds) {
  if (WHOLEHAND_SANITIZED) GTEST_SKIP() << "a sanitizer takes its own time";
  const Workbench workbench(GetParam());
  std::mt19937_64 random = seededRandom(31);
  Bench bench(workbench, {}, random, workbench.config());
  ASSERT_TRUE(bench.renderer.arm());
  std::vector<TickRecord> ticks;
  for (int k = 0; k < 300; ++k) {
    ticks.push_back(bench.tick());
    ticks.back().body_count = kMaxBodies;  // the worst world
  }
  std::vector<double> cost_us;
  for (int batch = 0; batch < 201; ++batch) {
    Chain chain(workbench.config());
    const double begin_ns = cpuNow_ns();
    for (const TickRecord& r : ticks) chain.tick(r);
    cost_us.push_back(1e-3 * (cpuNow_ns() - begin_ns) / static_cast<double>(ticks.size()));
    ASSERT_EQ(chain.faults & kStopping, Fault::kNone);
    ASSERT_EQ(chain.state, SafetyState::kRendering);  // the work was done
  }
  std::sort(cost_us.begin(), cost_us.end());
  const double median_us = cost_us[cost_us.size() / 2];
  figure("safety chain in a tick with 32 bodies, p50", median_us, "µs");
  figure("the same, slowest of 201 batches of 300 ticks", cost_us.back(), "µs");
  EXPECT_LE(median_us, 3.0);
}
INSTANTIATE_TEST_SUITE_P(Devices, SafetyChain, ::testing::Values("lambda-pride", "wrist-9axis"),
                         [](const auto& tested) {
                           std::string name = tested.param;
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace wholehand::test
