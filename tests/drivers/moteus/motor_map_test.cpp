#include "moteus/motor_map.hpp"

#include "support/seed.hpp"
#include "support/tolerance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace wholehand::moteus {
namespace {

Motor motor(int id, double sign, double gear_ratio, double offset_rad) {
  Motor out;
  out.name = "m" + std::to_string(id);
  out.id = id;
  out.sign = sign;
  out.gear_ratio = gear_ratio;
  out.offset_rad = offset_rad;
  out.max_torque_nm = 1.0;
  out.encoder_step_rad = 1e-3;
  return out;
}

MotorAxis axis(std::size_t motor, double lower_rad, double upper_rad,
               std::vector<MotorAxis::Coupling> couplings = {}) {
  MotorAxis out;
  out.name = "a" + std::to_string(motor);
  out.motor = motor;
  out.lower_rad = lower_rad;
  out.upper_rad = upper_rad;
  out.effort_limit_nm = 0.5;
  out.couplings = std::move(couplings);
  return out;
}

// A thumb whose flexion cable runs over the joint of its circumduction.
MotorMap thumb() {
  return {{motor(1, 1.0, 2.0, 0.1), motor(2, -1.0, 0.5, -0.2)},
          {axis(0, 0.0, 1.5), axis(1, 0.0, 1.2, {{0, 0.4}})}};
}

// Computed by hand: q0 = (0.7 - 0.1) / 2 = 0.3; theta1 = -(0.3 + 0.2) / 0.5 = -1; q1 = -1 + 0.4 *
// 0.3.
TEST(MotorMap, PositionOfAThumbInSeries_FollowsTheFormula) {
  const PerMotor q = thumb().positions({0.7, 0.3});
  EXPECT_NEAR(q[0], 0.3, 1e-15);
  EXPECT_NEAR(q[1], -0.88, 1e-15);
}

// Computed by hand: tau_m1 = -tau_1 / 0.5; tau_m0 = (tau_0 + 0.4 tau_1) / 2.
TEST(MotorMap, EffortsOfAThumbInSeries_BothLoadTheCircumduction) {
  const PerMotor m = thumb().torques({0.2, 0.1});
  EXPECT_NEAR(m[1], -0.2, 1e-15);
  EXPECT_NEAR(m[0], 0.12, 1e-15);
  EXPECT_NEAR(thumb().worstTorque(0), 0.5 * (1.0 + 0.4) / 2.0, 1e-15);
}

TEST(MotorMap, Travel_IncludesTheShareOfTheOtherAxis) {
  // theta1 is smallest, -0.6, for q1 = 0 and q0 = 1.5, and largest at 1.2.
  const auto travel = thumb().motorTravel(1);
  EXPECT_NEAR(travel.lower, -0.2 - 0.5 * 1.2, 1e-15);
  EXPECT_NEAR(travel.upper, -0.2 + 0.5 * 0.6, 1e-15);
}

TEST(MotorMap, Resolution_AddsTheStepsOfAllItsMotors) {
  EXPECT_NEAR(thumb().resolution(0), 1e-3 / 2.0, 1e-15);
  EXPECT_NEAR(thumb().resolution(1), 1e-3 / 0.5 + 0.4 * 1e-3 / 2.0, 1e-15);
}

MotorMap randomMap(std::mt19937_64& random) {
  std::uniform_real_distribution<double> in(-1.0, 1.0);
  const std::size_t n = 1 + random() % 8;
  std::vector<Motor> motors;
  std::vector<MotorAxis> axes;
  for (std::size_t i = 0; i < n; ++i) {
    motors.push_back(motor(static_cast<int>(i + 1), random() % 2 == 0 ? 1.0 : -1.0,
                           std::exp(2.0 * in(random)), 2.0 * in(random)));
    std::vector<MotorAxis::Coupling> couplings;
    for (std::size_t b = 0; b < i; ++b) {
      if (random() % 2 == 0) couplings.push_back({b, in(random)});
    }
    axes.push_back(axis((i + 1) % n, -1.0, 1.0, couplings));  // the motors are in another order
  }
  return {motors, axes};
}

double product(const PerMotor& a, const PerMotor& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

// The principle of virtual work is the closed form: tau_q . dq = tau_m . dm for every dm.
TEST(MotorMap, RandomMaps_DoTheSameWorkOnBothSides) {
  auto random = test::seededRandom(2);
  std::uniform_real_distribution<double> in(-1.0, 1.0);
  for (int i = 0; i < test::cases(10'000); ++i) {
    const MotorMap map = randomMap(random);
    PerMotor m{}, dm{}, ahead{}, tau_q{};
    for (std::size_t k = 0; k < map.size(); ++k) {
      m[k] = in(random), dm[k] = in(random), tau_q[k] = in(random);
      ahead[k] = m[k] + dm[k];
    }
    PerMotor dq = map.positions(ahead);
    const PerMotor q = map.positions(m);
    double scale = 1.0;
    for (std::size_t k = 0; k < map.size(); ++k) {
      dq[k] -= q[k];
      scale += std::abs(tau_q[k] * dq[k]);
    }
    const PerMotor tau_m = map.torques(tau_q);
    ASSERT_NEAR(product(tau_q, dq), product(tau_m, dm), 1e-12 * scale) << "case " << i;
    const PerMotor back_m = map.motorPositions(q), back_tau = map.axisEfforts(tau_m);
    for (std::size_t k = 0; k < map.size(); ++k) {
      ASSERT_NEAR(back_m[k], m[k], 1e-10);
      ASSERT_NEAR(back_tau[k], tau_q[k], 1e-10);
    }
  }
}

}  // namespace
}  // namespace wholehand::moteus
