// Compares the energy tank with closed forms and with a table of unstable and stable loops. An
// independent program computed the table before this project began (a push of 5 N on a rigid wall,
// 10 µm encoder, 20 N limit).
#include "loop/control/energy_tank.hpp"

#include "devices/one_axis.hpp"
#include "loop/control/bilateral_coupling.hpp"
#include "loop/control/one_axis_gains.hpp"
#include "support/constants.hpp"

#include <algorithm>

namespace wholehand::test {
namespace {

struct Loop {
  double mass = 0.5, damping = 0.2, person_mass = 0.3, person_damping = 1.0, person_stiffness = 0.0;
  double k_pm = 1000.0, gamma = 0.0, k_ps = 2500.0;
  int delay = 1;
};

CouplingGains gainsOfAxis(const Loop& loop) {
  return oneAxisGains(loop.k_pm, loop.k_ps, loop.gamma);
}

struct Outcome {
  double speed_rms = 0.0;          // over the last 2 s
  double effort_change_rms = 0.0;  // the tank's contribution
  double largest_effort = 0.0;
};

/// A person pushes with a force over time; the avatar touches a rigid wall.
template <class Push>
Outcome simulate(const Loop& loop, bool with_tank, double wall_m, double start_m, double end_s,
                 Push&& push) {
  constexpr double kLimit = 20.0;
  DeviceModel device = oneAxisDevice(loop.mass);
  device.output_delay_ticks = loop.delay;
  device.axes[0].damping = loop.damping;
  device.axes[0].encoder_step = 1e-5;
  device.axes[0].effort_limit = kLimit;
  PatientConfig person = nobody();
  person.axes[0].mass = loop.person_mass;
  person.axes[0].damping = loop.person_damping;
  person.axes[0].stiffness = loop.person_stiffness;
  // The push is a force: the test adds it to the effort without delay, as an intention's pull would
  // act. The device adds both.
  DeviceModel plant = device;
  plant.axes[0].effort_limit = 1e6;
  plant.output_delay_ticks = 0;
  SimulatedDevice simulated(plant, person, stayAt(start_m), kPeriod_s);
  EXPECT_TRUE(simulated.open());
  const CouplingGains gains = gainsOfAxis(loop);
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
        couplingEffort(reading.q_m, velocity.filtered, q_s, qd_s, dampingOf(gains), gains)[0];
    EnergyTankStep step =
        advanceTank(tank, reading.q_m, q_s, AxisEnergy(), {0.5 * gains.inertia[0] * v_s * v_s, 0.0},
                    gains, config, AxisEffort(1, kLimit), 1, kPeriod_s);
    const double added = with_tank ? step.effort[0] : 0.0;
    const double f = std::clamp(coupling + added, -kLimit, kLimit);
    const double without = std::clamp(coupling, -kLimit, kLimit);
    const AxisEffort f_s =
        avatarEffort(reading.q_m, velocity.filtered, q_s, qd_s, dampingOf(gains), gains);
    tank = recordSent(step.state, AxisEffort(1, f), f_s, AxisEffort(1, kLimit));
    out.effort_change_rms += (f - without) * (f - without);
    out.largest_effort = std::max(out.largest_effort, std::abs(f));
    // Avatar, symplectic Euler, against the rigid wall.
    v_s += kPeriod_s * f_s[0] / gains.inertia[0];
    if (x_s + kPeriod_s * v_s > wall_m) v_s = x_s >= wall_m ? 0.0 : (wall_m - x_s) / kPeriod_s;
    x_s += kPeriod_s * v_s;
    for (int i = 8; i > 0; --i) sent[i] = sent[i - 1];
    sent[0] = f;
    EXPECT_EQ(simulated.write(AxisEffort(1, sent[loop.delay] + push(k * kPeriod_s))), Fault::kNone);
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

TEST(EnergyTank, ReciprocalStableLoop_IsNotChanged) {
  // γ = 1, vigorous free motion and a wall, relaxed arm: 0 N in the table.
  Loop loop{0.8, 1.0, 1.0, 5.0, 100.0, 1000.0, 1.0, 2500.0, 1};
  EXPECT_EQ(simulate(loop, true, 0.02, 0.0, 6.0, vigorous).effort_change_rms, 0.0);
}

TEST(EnergyTank, CertifiedGainsOfTheSixAxisDevice_AreHardlyChanged) {
  // config/rendering/lambda-pride.toml, x: b = 6 N·s/m, γ = 0.3, K_ps 3900.
  Loop loop{0.8, 6.0, 1.0, 5.0, 100.0, 1000.0, 0.3, 3900.0, 1};
  const Outcome out = simulate(loop, true, 0.02, 0.0, 6.0, vigorous);
  std::printf("certified gains: the tank changes the effort by %.3f N rms\n",
              out.effort_change_rms);
  EXPECT_LT(out.effort_change_rms, 0.02);
}

TEST(EnergyTank, LowerLimitInForce_DoesNotEmptyTheTank) {
  // The axis presses 25 mm into a wall of 1500 N/m and leaves it, with the effort limited to 8 of
  // 20 N. The energy of the saturated spring is counted with the 8 N, so no energy appears to be
  // made.
  DeviceModel device = oneAxisDevice(0.8);
  device.axes[0].damping = 6.0;
  device.axes[0].effort_limit = 20.0;
  const EnergyTankConfig config = makeEnergyTank(device, kPeriod_s);
  Loop loop;
  loop.k_pm = 1500.0;
  loop.gamma = 1.0;
  const CouplingGains gains = gainsOfAxis(loop);
  EnergyTankState tank = fullTank(config);
  double before = 0.0;
  for (int k = 0; k <= 1000; ++k) {
    const double x = 0.0125 * (1.0 - std::cos(2.0 * std::numbers::pi * k / 1000.0));
    // The exact work of the limited spring along the step, by the mean effort.
    const auto held = [&](double e) { return -std::min(1500.0 * e, 8.0); };
    tank = recordSent(tank, AxisEffort(1, 0.5 * (held(before) + held(x))), AxisEffort(1),
                      AxisEffort(1, 8.0));
    const EnergyTankStep step = advanceTank(tank, AxisPosition(1, x), AxisPosition(1, 0.0), {}, {},
                                            gains, config, AxisEffort(1, 8.0), 1, kPeriod_s);
    EXPECT_EQ(step.effort[0], 0.0) << k;
    tank = step.state;
    before = x;
  }
}

TEST(EnergyTank, SpringAlone_KeepsItsEnergy) {
  // An ideal spring, stretched and released along any path, returns the energy it took: E = Ê
  // again.
  EnergyTankConfig config;
  config.axes = 1;
  config.capacity = AxisEnergy(1, 10.0);
  config.device_damping = AxisDamping(1, 0.0);
  config.most_damping = AxisDamping(1, 100.0);
  config.encoder_step = AxisPosition(1, 0.0);
  Loop loop;
  loop.delay = 0;
  const CouplingGains gains = gainsOfAxis(loop);
  EnergyTankState tank = fullTank(config);
  // Midpoint forces integrate the spring's work exactly.
  double x = 0.0;
  tank = advanceTank(tank, AxisPosition(1, x), AxisPosition(1, 0.0), {}, {}, gains, config,
                     AxisEffort(1, 1e9), 1, kPeriod_s)
             .state;
  for (int k = 1; k <= 4000; ++k) {
    const double next = 0.01 * std::sin(2.0 * std::numbers::pi * k / 1000.0);
    tank = recordSent(tank, AxisEffort(1, -loop.k_pm * 0.5 * (x + next)), AxisEffort(1),
                      AxisEffort(1, 1e9));
    tank = advanceTank(tank, AxisPosition(1, next), AxisPosition(1, 0.0), {}, {}, gains, config,
                       AxisEffort(1, 1e9), 1, kPeriod_s)
               .state;
    x = next;
  }
  EXPECT_NEAR(tank.energy[0], 10.0, 1e-9);
}

TEST(EnergyTank, EffortThatDrivesTheHand_IsPaidForAndThenTakenBack) {
  // 2 N along a motion of 0.1 m/s give 0.2 W; 50 mJ last 0.25 s, then the damping takes 2 N back.
  DeviceModel device = oneAxisDevice(0.8);
  device.axes[0].effort_limit = 20.0;  // Ê = 20 N · 5 mm / 2
  EnergyTankConfig config = makeEnergyTank(device, kPeriod_s);
  Loop loop;
  loop.k_pm = 1e-9;
  const CouplingGains gains = gainsOfAxis(loop);
  EnergyTankState tank = fullTank(config);
  double empty_s = 0.0, effort = 0.0;
  for (int k = 0; k < 1000; ++k) {
    const AxisPosition q(1, 1e-4 * k);
    const EnergyTankStep step =
        advanceTank(tank, q, q, {}, {}, gains, config, AxisEffort(1, 20.0), 1, kPeriod_s);
    effort = step.effort[0];
    if (effort != 0.0 && empty_s == 0.0) empty_s = k * kPeriod_s;
    tank = recordSent(step.state, AxisEffort(1, 2.0 + effort), AxisEffort(1), AxisEffort(1, 20.0));
  }
  EXPECT_NEAR(empty_s, 0.25, 0.002);
  EXPECT_NEAR(effort, -2.0, 0.01);
}

TEST(EnergyTank, ExerciseThatPushesTheHand_IsNotChargedToTheTank) {
  // The same push by an exercise gives 2 J in 10 s. The hand's tank of 50 mJ stays full, since the
  // power limit bounds an exercise. A loop spring that pushes at the same time is charged.
  DeviceModel device = oneAxisDevice(0.8);
  device.axes[0].effort_limit = 20.0;
  device.output_delay_ticks = 3;
  const EnergyTankConfig config = makeEnergyTank(device, kPeriod_s);
  Loop loop;
  loop.k_pm = 1e-9;
  const CouplingGains gains = gainsOfAxis(loop);
  for (const double beside_n : {0.0, 0.5}) {
    EnergyTankState tank = fullTank(config);
    const int ticks = beside_n == 0.0 ? 10000 : 500;
    for (int k = 0; k < ticks; ++k) {
      const AxisPosition q(1, 1e-4 * k);
      tank =
          advanceTank(tank, q, q, {}, {}, gains, config, AxisEffort(1, 20.0), 1, kPeriod_s).state;
      tank = recordSent(tank, AxisEffort(1, 2.0 + beside_n), AxisEffort(1), AxisEffort(1, 20.0),
                        AxisEffort(1, 2.0));
    }
    const double gone_s = kPeriod_s * (ticks - 1 - 3);
    EXPECT_NEAR(tank.hand, config.hand_capacity - beside_n * 0.1 * gone_s, 1e-4);
  }
}

TEST(EnergyTank, OneEncoderCount_ChangesTheEffortByAtMostAFiftiethOfTheLimit) {
  // The tank is empty with the largest debt, and the position changes by one count δ within a tick;
  // at every rate.
  DeviceModel device = oneAxisDevice(0.8);
  device.axes[0].effort_limit = 20.0;
  device.axes[0].encoder_step = 1e-5;
  for (const double rate_hz : {1000.0, 2000.0, 4000.0, 8000.0}) {
    const EnergyTankConfig config = makeEnergyTank(device, 1.0 / rate_hz);
    EnergyTankState tank = fullTank(config);
    tank.energy[0] = -config.capacity[0];
    tank.hand = -config.hand_capacity;
    tank.fresh = false;
    const EnergyTankStep step =
        advanceTank(tank, AxisPosition(1, 1e-5), AxisPosition(1, 1e-5), {}, {}, gainsOfAxis(Loop{}),
                    config, AxisEffort(1, 20.0), 1, 1.0 / rate_hz);
    EXPECT_LT(step.effort[0], 0.0);
    EXPECT_GE(step.effort[0], -0.02 * 20.0 - 1e-12) << rate_hz;
  }
}

/// Two axes of 1000 N/m whose avatar is held by a rigid object. The object blocks n = (0.6, 0.8)
/// and is free and at rest along m = (−0.8, 0.6). The person moves both axes around a circle.
struct HeldPair {
  double sigma = 1.0;  ///< of the second axis: it acts on the object with K_pm / σ

  /// Avatar position on n · q_s = 0 with a force balance along m: mᵀ K_s (q_m − q_s) = 0.
  [[nodiscard]] AxisPosition avatar(const AxisPosition& q) const {
    const double k_1 = 1000.0, k_2 = 1000.0 / sigma;
    const double along = (-0.8 * k_1 * q[0] + 0.6 * k_2 * q[1]) / (0.64 * k_1 + 0.36 * k_2);
    AxisPosition q_s(2);
    q_s[0] = -0.8 * along;
    q_s[1] = 0.6 * along;
    return q_s;
  }
};

struct Circled {
  double hand_j, least_axis_j, damped_n;
};

/// H after `turns` whole turns of radius 5 mm, one per second.
Circled circle(const HeldPair& pair, int turns) {
  EnergyTankConfig config;
  config.axes = 2;
  config.capacity = AxisEnergy(2, 0.05);
  config.hand_capacity = 0.1;
  config.device_damping = AxisDamping(2);
  config.most_damping = AxisDamping(2, 100.0);
  config.encoder_step = AxisPosition(2);
  CouplingGains gains;
  gains.axes = 2;
  gains.k_pm = AxisStiffness(2, 1000.0);
  EnergyTankState tank = fullTank(config);
  const AxisEffort no_limit(2, 1e9);
  const auto at = [](double turn) {
    AxisPosition q(2);
    q[0] = 5e-3 * std::cos(2.0 * std::numbers::pi * turn);
    q[1] = -5e-3 * std::sin(2.0 * std::numbers::pi * turn);
    return q;
  };
  tank = advanceTank(tank, at(0.0), pair.avatar(at(0.0)), {}, {}, gains, config, no_limit, 1,
                     kPeriod_s)
             .state;
  Circled out{0.0, 1.0, 0.0};
  for (int k = 1; k <= 1000 * turns; ++k) {
    // The mean of a step's two efforts integrates a linear spring's work exactly.
    const AxisPosition a = at((k - 1) / 1000.0), b = at(k / 1000.0);
    const AxisPosition a_s = pair.avatar(a), b_s = pair.avatar(b);
    AxisEffort f(2), drive(2);
    for (int i = 0; i < 2; ++i) {
      const double e = 0.5 * (a[i] - a_s[i] + b[i] - b_s[i]);
      f[i] = -1000.0 * e;
      drive[i] = 1000.0 * e;  // the axis's account uses the rendered drive
    }
    tank = recordSent(tank, f, drive, no_limit);
    const EnergyTankStep step =
        advanceTank(tank, b, b_s, {}, {}, gains, config, no_limit, 1, kPeriod_s);
    tank = step.state;
    for (int i = 0; i < 2; ++i) {
      out.least_axis_j = std::min(out.least_axis_j, tank.energy[i]);
      out.damped_n = std::max(out.damped_n, std::abs(step.effort[i]));
    }
  }
  out.hand_j = tank.hand;
  return out;
}

TEST(EnergyTank, ClosedCycleAcrossTwoAxes_KeepsEnergyInOneAccount) {
  // The energy that enters through one axis leaves through the other: no energy is made, none is
  // damped.
  const Circled held = circle({}, 100);
  EXPECT_NEAR(held.hand_j, 0.1, 1e-9);
  EXPECT_EQ(held.damped_n, 0.0);
}

TEST(EnergyTank, CouplingThatMakesEnergyAcrossTwoAxes_IsChargedToTheHandsAccountOnly) {
  // σ = 3 on the second axis. The rendered stiffness is K = K_pm (I − m mᵀ K_s / (mᵀ K_s m)). By
  // Green's theorem a turn in this direction makes π r² (K_21 − K_12).
  HeldPair pair;
  pair.sigma = 3.0;
  const double k_1 = 1000.0, k_2 = 1000.0 / 3.0, mkm = 0.64 * k_1 + 0.36 * k_2;
  const double k_12 = 1000.0 * 0.8 * 0.6 * k_2 / mkm, k_21 = 1000.0 * 0.6 * 0.8 * k_1 / mkm;
  const double turn_j = std::numbers::pi * 25e-6 * (k_21 - k_12);
  const Circled one = circle(pair, 1);
  EXPECT_NEAR(0.1 - one.hand_j, turn_j, 1e-3 * turn_j);
  EXPECT_EQ(one.damped_n, 0.0);
  EXPECT_GT(one.least_axis_j, 0.0);
  // After enough turns the account is empty, and the damping takes the energy back.
  const int turns = static_cast<int>(std::ceil(0.1 / turn_j)) + 1;
  EXPECT_GT(circle(pair, turns).damped_n, 0.1);
}

TEST(EnergyTank, WallThatFadesInUnderTheFinger_IsPaidFromTheTank) {
  // α k p²/2 rises from 0 to 4 mJ with the finger held still: E falls by the same amount.
  DeviceModel device = oneAxisDevice(0.8);
  const EnergyTankConfig config = makeEnergyTank(device, kPeriod_s);
  const CouplingGains gains = gainsOfAxis(Loop{});
  EnergyTankState tank = fullTank(config);
  const AxisPosition q(1, 0.0);
  for (double wall_j : {0.0, 0.002, 0.004}) {
    tank = advanceTank(tank, q, q, AxisEnergy(1, wall_j), {}, gains, config, AxisEffort(1, 20.0), 1,
                       kPeriod_s)
               .state;
  }
  EXPECT_NEAR(tank.energy[0], config.capacity[0] - 0.004, 1e-15);
}

}  // namespace
}  // namespace wholehand::test
