// The energy tank against the rows of unstable and stable loops that were computed before this
// project began by an independent program (a push of 5 N on a rigid wall, 10 µm encoder, 20 N
// limit), and against closed forms.
#include "control/energy_tank.hpp"

#include "control/bilateral_coupling.hpp"
#include "control/one_axis_gains.hpp"
#include "control/velocity_estimator.hpp"
#include "device/one_axis.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wholehand {
namespace {

constexpr double kPeriod_s = 1e-3;

struct Loop {
  double mass = 0.5, damping = 0.2, person_mass = 0.3, person_damping = 1.0, person_stiffness = 0.0;
  double k_pm = 1000.0, gamma = 0.0, k_ps = 2500.0;
  int delay = 1;
};

CouplingGains gainsOf(const Loop& loop) {
  return test::oneAxisGains(loop.k_pm, loop.k_ps, loop.gamma);
}

struct Outcome {
  double speed_rms = 0.0;          // over the last 2 s
  double effort_change_rms = 0.0;  // what the tank added
  double largest_effort = 0.0;
};

/// A person pushes with a force over time; the avatar meets a rigid wall.
template <class Push>
Outcome simulate(const Loop& loop, bool with_tank, double wall_m, double start_m, double end_s,
                 Push&& push) {
  constexpr double kLimit = 20.0;
  DeviceModel device = testing::oneAxisDevice(loop.mass);
  device.output_delay_ticks = loop.delay;
  device.axes[0].damping = loop.damping;
  device.axes[0].encoder_step = 1e-5;
  device.axes[0].effort_limit = kLimit;
  PatientConfig person = testing::nobody();
  person.axes[0].mass = loop.person_mass;
  person.axes[0].damping = loop.person_damping;
  person.axes[0].stiffness = loop.person_stiffness;
  // The push is a force: it is sent beside the effort, without delay, as a pull of the intention
  // would be. The device adds both.
  DeviceModel plant = device;
  plant.axes[0].effort_limit = 1e6;
  plant.output_delay_ticks = 0;
  SimulatedDevice simulated(plant, person, testing::stayAt(start_m), kPeriod_s);
  EXPECT_TRUE(simulated.open());
  const CouplingGains gains = gainsOf(loop);
  const EnergyTankConfig config = makeEnergyTank(device, kPeriod_s);
  EnergyTankState tank = fullTank(config);
  VelocityState velocity;
  std::array<double, 9> sent{};
  double x_s = start_m, v_s = 0.0;
  Outcome out;
  const int ticks = static_cast<int>(end_s / kPeriod_s);
  int counted = 0;
  for (int k = 0; k < ticks; ++k) {
    DeviceReading reading;
    EXPECT_EQ(simulated.read(reading, 1), Fault::kNone);
    const AxisPosition q_s(1, x_s);
    const AxisVelocity qd_s(1, v_s);
    velocity = estimateVelocity(velocity, reading.q_m, gains, 1, kPeriod_s);
    const double coupling =
        couplingEffort(reading.q_m, velocity.filtered, q_s, qd_s, test::dampingOf(gains), gains)[0];
    EnergyTankStep step = advanceTank(tank, reading.q_m, q_s, AxisEnergy(), gains, config,
                                      AxisEffort(1, kLimit), 1, kPeriod_s);
    const double added = with_tank ? step.effort[0] : 0.0;
    const double f = std::clamp(coupling + added, -kLimit, kLimit);
    const double without = std::clamp(coupling, -kLimit, kLimit);
    tank = noteSent(step.state, AxisEffort(1, f), velocity.filtered, qd_s, test::dampingOf(gains),
                    gains);
    out.effort_change_rms += (f - without) * (f - without);
    out.largest_effort = std::max(out.largest_effort, std::abs(f));
    // Avatar, symplectic Euler, against the rigid wall.
    const double a =
        avatarEffort(reading.q_m, velocity.filtered, q_s, qd_s, test::dampingOf(gains), gains)[0] /
        gains.inertia[0];
    v_s += kPeriod_s * a;
    if (x_s + kPeriod_s * v_s > wall_m) v_s = x_s >= wall_m ? 0.0 : (wall_m - x_s) / kPeriod_s;
    x_s += kPeriod_s * v_s;
    for (int i = 8; i > 0; --i)
      sent[static_cast<std::size_t>(i)] = sent[static_cast<std::size_t>(i - 1)];
    sent[0] = f;
    EXPECT_EQ(simulated.write(
                  AxisEffort(1, sent[static_cast<std::size_t>(loop.delay)] + push(k * kPeriod_s))),
              Fault::kNone);
    if (k > ticks - 2000) {
      out.speed_rms += simulated.velocity()[0] * simulated.velocity()[0];
      ++counted;
    }
  }
  out.speed_rms = std::sqrt(out.speed_rms / counted);
  out.effort_change_rms = std::sqrt(out.effort_change_rms / ticks);
  return out;
}

double fiveNewton(double) {
  return 5.0;
}
double vigorous(double t) {
  return 12.0 * std::sin(2.0 * std::numbers::pi * t) +
         6.0 * std::sin(2.0 * std::numbers::pi * 2.7 * t);
}

class UnstableRow : public ::testing::TestWithParam<std::pair<double, int>> {};

TEST_P(UnstableRow, PressedWall_SettlesOnlyWithTheTank) {
  Loop loop;
  loop.k_pm = GetParam().first;
  loop.delay = GetParam().second;
  // Without the tank: 0.22, 0.099, 0.038 and 0.38 m/s in the table of the independent program.
  EXPECT_GT(simulate(loop, false, 0.0, -0.02, 20.0, fiveNewton).speed_rms, 0.02);
  const Outcome with = simulate(loop, true, 0.0, -0.02, 20.0, fiveNewton);
  EXPECT_LT(with.speed_rms, 1e-3);
  EXPECT_LE(with.largest_effort, 20.0);
}
INSTANTIATE_TEST_SUITE_P(EnergyTank, UnstableRow,
                         ::testing::Values(std::pair{1000.0, 1}, std::pair{2000.0, 1},
                                           std::pair{4000.0, 1}, std::pair{2000.0, 4}));

TEST(EnergyTank, ReciprocalStableLoop_IsLeftAlone) {
  // γ = 1, vigorous free motion and a wall, relaxed arm: 0 N in the table.
  Loop loop{0.8, 1.0, 1.0, 5.0, 100.0, 1000.0, 1.0, 2500.0, 1};
  EXPECT_EQ(simulate(loop, true, 0.02, 0.0, 6.0, vigorous).effort_change_rms, 0.0);
}

TEST(EnergyTank, CertifiedGainsOfTheSixAxisDevice_AreHardlyTouched) {
  // config/rendering/lambda-pride.toml, x: b = 6 N·s/m, γ = 0.3, K_ps 3900.
  Loop loop{0.8, 6.0, 1.0, 5.0, 100.0, 1000.0, 0.3, 3900.0, 1};
  const Outcome out = simulate(loop, true, 0.02, 0.0, 6.0, vigorous);
  std::printf("certified gains: the tank changes the effort by %.3f N rms\n",
              out.effort_change_rms);
  EXPECT_LT(out.effort_change_rms, 0.02);
}

TEST(EnergyTank, LowerLimitInForce_DoesNotEmptyIt) {
  // A rigid wall pressed 25 mm deep and left again, 1500 N/m, the effort held to 8 of 20 N: what
  // the saturated spring holds is counted with the 8 N, so that nothing seems made of nothing.
  DeviceModel device = testing::oneAxisDevice(0.8);
  device.axes[0].damping = 6.0;
  device.axes[0].effort_limit = 20.0;
  const EnergyTankConfig config = makeEnergyTank(device, kPeriod_s);
  Loop loop;
  loop.k_pm = 1500.0;
  loop.gamma = 1.0;
  const CouplingGains gains = gainsOf(loop);
  EnergyTankState tank = fullTank(config);
  double before = 0.0;
  for (int k = 0; k <= 1000; ++k) {
    const double x = 0.0125 * (1.0 - std::cos(2.0 * std::numbers::pi * k / 1000.0));
    // The work of the held spring along the step, exactly: the mean effort.
    const auto held = [&](double e) { return -std::min(1500.0 * e, 8.0); };
    tank = noteSent(tank, AxisEffort(1, 0.5 * (held(before) + held(x))), AxisVelocity(1),
                    AxisVelocity(1), AxisRatio(1), gains);
    const EnergyTankStep step = advanceTank(tank, AxisPosition(1, x), AxisPosition(1, 0.0), {},
                                            gains, config, AxisEffort(1, 8.0), 1, kPeriod_s);
    EXPECT_EQ(step.effort[0], 0.0) << k;
    tank = step.state;
    before = x;
  }
}

TEST(EnergyTank, SpringAlone_KeepsItsEnergy) {
  // An ideal spring, stretched and released along any path, gives back what it took: E = Ê again.
  EnergyTankConfig config;
  config.axes = 1;
  config.capacity = AxisEnergy(1, 10.0);
  config.device_damping = AxisRatio(1, 0.0);
  config.most_damping = AxisRatio(1, 100.0);
  config.encoder_step = AxisPosition(1, 0.0);
  Loop loop;
  loop.delay = 0;
  const CouplingGains gains = gainsOf(loop);
  EnergyTankState tank = fullTank(config);
  // Midpoint forces integrate the spring's work exactly.
  double x = 0.0;
  tank = advanceTank(tank, AxisPosition(1, x), AxisPosition(1, 0.0), {}, gains, config,
                     AxisEffort(1, 1e9), 1, kPeriod_s)
             .state;
  for (int k = 1; k <= 4000; ++k) {
    const double next = 0.01 * std::sin(2.0 * std::numbers::pi * k / 1000.0);
    tank = noteSent(tank, AxisEffort(1, -loop.k_pm * 0.5 * (x + next)), AxisVelocity(1),
                    AxisVelocity(1), AxisRatio(1), gains);
    tank = advanceTank(tank, AxisPosition(1, next), AxisPosition(1, 0.0), {}, gains, config,
                       AxisEffort(1, 1e9), 1, kPeriod_s)
               .state;
    x = next;
  }
  EXPECT_NEAR(tank.energy[0], 10.0, 1e-9);
}

TEST(EnergyTank, EffortThatDrivesTheHand_IsPaidThenTakenBack) {
  // 2 N along a motion of 0.1 m/s give 0.2 W; 50 mJ last 0.25 s, then damping takes 2 N back.
  DeviceModel device = testing::oneAxisDevice(0.8);
  EnergyTankConfig config = makeEnergyTank(device, kPeriod_s);
  Loop loop;
  loop.k_pm = 1e-9;
  const CouplingGains gains = gainsOf(loop);
  EnergyTankState tank = fullTank(config);
  double empty_s = 0.0, effort = 0.0;
  for (int k = 0; k < 1000; ++k) {
    const AxisPosition q(1, 1e-4 * k);
    const EnergyTankStep step =
        advanceTank(tank, q, q, {}, gains, config, AxisEffort(1, 20.0), 1, kPeriod_s);
    effort = step.effort[0];
    if (effort != 0.0 && empty_s == 0.0) empty_s = k * kPeriod_s;
    tank = noteSent(step.state, AxisEffort(1, 2.0 + effort), AxisVelocity(1, 0.1),
                    AxisVelocity(1, 0.1), test::dampingOf(gains), gains);
  }
  EXPECT_NEAR(empty_s, 0.25, 0.002);
  EXPECT_NEAR(effort, -2.0, 0.01);
}

TEST(EnergyTank, WallThatFadesInUnderTheFinger_IsPaidFor) {
  // α k p²/2 from 0 to 4 mJ with the finger held still: E falls by as much.
  DeviceModel device = testing::oneAxisDevice(0.8);
  const EnergyTankConfig config = makeEnergyTank(device, kPeriod_s);
  const CouplingGains gains = gainsOf(Loop{});
  EnergyTankState tank = fullTank(config);
  const AxisPosition q(1, 0.0);
  for (double wall_j : {0.0, 0.002, 0.004}) {
    tank = advanceTank(tank, q, q, AxisEnergy(1, wall_j), gains, config, AxisEffort(1, 20.0), 1,
                       kPeriod_s)
               .state;
  }
  EXPECT_NEAR(tank.energy[0], config.capacity[0] - 0.004, 1e-15);
}

}  // namespace
}  // namespace wholehand
