// An axis with weight must move as its weightless twin, from opening to closing.
#include "devices/host/device_host.hpp"
#include "devices/plain_driver.hpp"
#include "devices/plugin/plugin_device.hpp"
#include "support/contains.hpp"
#include "support/rig_tools.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>

namespace wholehand::test {
namespace {

constexpr double kCycle_s = 250e-6, kMass_kg = 0.6;
std::int64_t g_cycle_ns = 0;

/// A driver of three carriages with weight that fall while they are not enabled. Their first
/// enabling lifts them off a stand.
class HeavyDriver final : public PlainDriver {
 public:
  HeavyDriver(const std::array<double, 3>& weight_n, std::uint32_t disabled, bool at_neutral)
      : PlainDriver({"x", "y", "z"}, axis(disabled)),
        weight_n_(weight_n),
        at_neutral_(at_neutral) {}
  [[nodiscard]] Expected<Done> control(std::uint32_t verb, double argument) override {
    given_ = {};
    stood_ = stood_ && verb != WH_ENABLE;
    return PlainDriver::control(verb, argument);
  }
  [[nodiscard]] Expected<Done> enable(const wh_command& neutral) override {
    Expected<Done> done = control(WH_ENABLE, 0.0);
    for (std::size_t i = 0; i < 3 && at_neutral_; ++i) given_[i] = neutral.effort[i];
    return done;
  }
  [[nodiscard]] bool enablesAtNeutral() const noexcept override { return at_neutral_; }
  [[nodiscard]] int read(wh_sample& sample) noexcept override {
    sample.sequence = ++samples_;
    sample.monotonic_ns = g_cycle_ns;
    sample.status = WH_HOMED | (enabled ? static_cast<std::uint32_t>(WH_ENABLED) : 0U);
    sample.valid = 7;
    std::copy(position_m.begin(), position_m.end(), sample.position);
    return WH_OK;
  }
  [[nodiscard]] int write(const wh_command& command) noexcept override {
    if (!enabled) return WH_FAILED;
    std::copy_n(command.effort, 3, given_.begin());
    return WH_OK;
  }
  void pass() {
    for (std::size_t i = 0; i < 3 && !stood_; ++i) {
      const double force_n = (enabled ? given_[i] : 0.0) - weight_n_[i] - 3.0 * speed_m_s_[i];
      speed_m_s_[i] += kCycle_s * force_n / kMass_kg;
      position_m[i] += kCycle_s * speed_m_s_[i];
    }
  }
  std::array<double, 3> position_m{};

 private:
  static wh_axis axis(std::uint32_t disabled) {
    wh_axis axis = plainAxis();
    axis.effort_limit = 20.0;
    axis.resolution = 1e-6;
    axis.delay_s = 0.0;
    axis.disabled = disabled;
    return axis;
  }
  const std::array<double, 3> weight_n_;
  const bool at_neutral_;
  std::array<double, 3> given_{}, speed_m_s_{};
  bool stood_ = true;
  std::uint64_t samples_ = 0;
};

DeviceModel modelOf(const std::array<double, 3>& weight_n) {
  DeviceModel model =
      load(shippedFiles("desktop-3axis", "empty", "adult-median-right", "no-arm")).device;
  for (std::size_t i = 0; i < 3; ++i) {
    model.axes[i].effort_limit = 20.0;
    model.axes[i].neutral_effort = weight_n[i];
  }
  return model;
}

/// A host on the test's clock with a loop that acts as a session does.
struct HeldDevice {
  explicit HeldDevice(const std::array<double, 3>& weight)
      : weight_n(weight), driver(weight, WH_FALLS, true), model(modelOf(weight)) {
    config = guardConfig(driver, model, kCycle_s);
    describeDevice(*frame, driver, config, 1);
    host =
        std::make_unique<DeviceHost>(driver, *frame, config, []() noexcept { return g_cycle_ns; });
  }
  void cycle() {
    g_cycle_ns += static_cast<std::int64_t>(kCycle_s * 1e9);
    (void)host->cycle(1);
    driver.pass();
  }
  void ask(std::uint32_t verb) {
    frame->request.publish({++requests, 1, verb, 0.0});
    cycle();
    HostAnswer answer{};
    while (!frame->answer.take(answer) || answer.number != requests) cycle();
    EXPECT_EQ(answer.ok, 1) << answer.text;
    if (verb == WH_ENABLE) session = answer.session;
  }
  /// Runs one millisecond in which the loop renders this effort on every axis.
  void tick(double effort_n) {
    HostCommand command{};
    command.session = session;
    command.sequence = ++commands;
    command.monotonic_ns = g_cycle_ns;
    command.axes = 3;
    for (std::size_t i = 0; i < 3; ++i) command.effort[i] = weight_n[i] + effort_n;
    frame->command.publish(command);
    pass(1);
  }
  void pass(int ticks) {
    for (int k = 0; k < 4 * ticks; ++k) cycle();
  }

  std::array<double, 3> weight_n;
  HeavyDriver driver;
  DeviceModel model;
  GuardConfig config;
  std::unique_ptr<SharedFrame> frame = std::make_unique<SharedFrame>();
  std::unique_ptr<DeviceHost> host;
  std::uint64_t requests = 0, commands = 0, session = 0;
};

// Each axis weighs 0 to 10 N. Two sessions with a random pause; the first ends normally or its loop
// dies.
TEST(HeavyAxis, HeldByAHost_MovesAsItsWeightlessTwin) {
  auto random = seededRandom(3406);
  for (int i = 0; i < cases(200); ++i) {
    g_cycle_ns = 1'000'000'000;
    const std::array<double, 3> weight_n = {uniform(random, -10.0, 10.0),
                                            uniform(random, 0.0, 10.0), 0.0};
    HeldDevice heavy(weight_n);
    HeldDevice light({});
    const bool dies = random() % 2 == 0;
    // The host refuses to enable while it still lets go of a dead loop (20 ms and 80 ms).
    const int pause_ticks = static_cast<int>(random() % 1000) + (dies ? 110 : 0);
    const double amplitude_n = uniform(random, 0.0, 3.0);
    double farthest_m = 0.0;
    const auto both = [&](const auto& act) {
      const std::int64_t began_ns = g_cycle_ns;
      act(heavy);
      g_cycle_ns = began_ns;
      act(light);
      for (std::size_t a = 0; a < 3; ++a) {
        farthest_m =
            std::max(farthest_m, std::abs(heavy.driver.position_m[a] - light.driver.position_m[a]));
      }
    };
    for (int session = 0; session < 2; ++session) {
      both([](HeldDevice& d) { d.ask(WH_ENABLE); });
      both([](HeldDevice& d) { d.pass(200); });  // the loop begins late
      for (int k = 0; k < 400; ++k) {
        const double effort_n = amplitude_n * std::sin(0.02 * k) * (k < 300 ? 1.0 : 0.0);
        both([&](HeldDevice& d) { d.tick(effort_n); });
      }
      if (!dies) both([](HeldDevice& d) { d.ask(WH_DISABLE); });
      both([&](HeldDevice& d) { d.pass(pause_ticks); });
    }
    EXPECT_LE(farthest_m, 1e-3) << i << ", weighs " << weight_n[0] << " and " << weight_n[1]
                                << " N, pause of " << pause_ticks << " ms";
  }
}

TEST(HeavyAxis, WithoutAHost_IsRefusedUnlessItLocksOrIsBalanced) {
  for (const std::uint32_t disabled : {WH_NOT_SAID, WH_LOCKS, WH_BALANCED, WH_FALLS}) {
    const auto driver =
        std::make_shared<HeavyDriver>(std::array<double, 3>{0.0, 6.0, 0.0}, disabled, true);
    const auto device = orThrow(PluginDevice::make(driver, modelOf({0.0, 6.0, 0.0}), 1e-3));
    const auto opened = device->open();
    const bool stays = disabled == WH_LOCKS || disabled == WH_BALANCED;
    EXPECT_EQ(opened.ok(), stays) << disabled;
    if (!stays) {
      EXPECT_TRUE(refusedWith(opened, "y"));
      EXPECT_TRUE(refusedWith(opened, "let a host hold it"));
    }
  }
}

TEST(HeavyAxis, DriverThatEnablesWithoutNeutral_IsRefused) {
  const auto driver =
      std::make_shared<HeavyDriver>(std::array<double, 3>{0.0, 0.0, 6.0}, WH_LOCKS, false);
  EXPECT_TRUE(refusedWith(PluginDevice::make(driver, modelOf({0.0, 0.0, 6.0}), 1e-3),
                          "without its neutral effort"));
  EXPECT_TRUE(PluginDevice::make(driver, modelOf({}), 1e-3).ok());
}

}  // namespace
}  // namespace wholehand::test
