// CPU time of the safety chain per tick.
#include "loop/core/compiler.hpp"
#include "loop/fault_injection/fault_bench.hpp"
#include "loop/safety/safety_chain.hpp"
#include "support/cpu_time.hpp"
#include "support/test_names.hpp"

namespace wholehand::test {
namespace {

/// Runs the steps of docs/safety.md in their order, as HapticRenderer::tick() calls them.
void run(SafetyChain& chain, TickRecord& record) {
  chain.checkReading(Fault::kNone, record);
  chain.checkWorld(record.contacts.data(), record.contact_count, {}, record);
  chain.watchEnergy(0.0, nullptr, record);
  chain.limitEffort(record);
  chain.checkWrite(Fault::kNone, record);
  chain.checkStep(Fault::kNone, record);
  chain.conclude(record);
}

class SafetyChainCost : public ::testing::TestWithParam<std::string> {};

TEST_P(SafetyChainCost, WithEveryBodyMoving_TakesAtMostTenMicroseconds_slow) {
  if (WHOLEHAND_SANITIZED) GTEST_SKIP() << "a sanitizer takes its own time";
  const Workbench workbench(GetParam());
  std::mt19937_64 random = seededRandom(31);
  Bench bench(workbench, {}, random, workbench.config());
  ASSERT_TRUE(bench.renderer.arm());
  SceneModel scene;  // the worst world: every body moves and turns
  scene.gravity_m_s2.setZero();
  scene.bodies.assign(kMaxBodies, ball({}, 0.03, 0.1));
  std::vector<TickRecord> ticks;
  for (int k = 0; k < 300; ++k) {
    ticks.push_back(bench.tick());
    ticks.back().body_count = kMaxBodies;
    for (BodyState& body : ticks.back().bodies) {
      body.velocity_m_s.x = 0.1;
      body.angular_velocity_rad_s.y = 1.0;
    }
  }
  std::vector<double> cost_us;
  for (int batch = 0; batch < 201; ++batch) {
    const RendererConfig& config = workbench.config();
    SafetyChain chain(config.safety, config.gains, scene, config.period_s);
    chain.arm(ticks.front().q_m);
    const double begin_ns = 1e9 * cpu_s();
    for (TickRecord& r : ticks) run(chain, r);
    cost_us.push_back(1e-3 * (1e9 * cpu_s() - begin_ns) / static_cast<double>(ticks.size()));
    ASSERT_EQ(chain.latched(), Fault::kNone);
    ASSERT_EQ(chain.state(), SafetyState::kRendering);  // the chain did its work
  }
  std::sort(cost_us.begin(), cost_us.end());
  const double median_us = cost_us[cost_us.size() / 2];
  figure("safety chain in a tick with 128 bodies that move, p50", median_us, "µs");
  figure("the same, slowest of 201 batches of 300 ticks", cost_us.back(), "µs");
  EXPECT_LE(median_us, 10.0);
}
INSTANTIATE_TEST_SUITE_P(Devices, SafetyChainCost, ::testing::Values("lambda-pride", "wrist-9axis"),
                         [](const auto& tested) { return withoutHyphens(tested.param); });

}  // namespace
}  // namespace wholehand::test
