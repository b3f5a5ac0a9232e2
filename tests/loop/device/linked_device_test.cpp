// A simulated device with a person whose axes are linked.
#include "devices/one_axis.hpp"
#include "loop/device/simulated/simulated_device.hpp"
#include "loop/patient/active_patient.hpp"
#include "loop/realtime/allocation_counter.hpp"
#include "support/tolerance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace wholehand {
namespace {

using test::nobody;
using test::oneAxisDevice;
using test::opened;
using test::personAt;
using test::tolerance;

constexpr double kTick_s = 1e-3;

DeviceModel twoAxes(double mass = 0.8) {
  DeviceModel device = oneAxisDevice(mass);
  device.axes.push_back(device.axes.front());
  device.axes.back().name = "y";
  return device;
}

/// A person of 1 kg, 20 N·s/m, 200 N/m on each of two axes, and `stiffness` from one to the other.
PatientConfig person(double stiffness, double damping = 0.0, double mass = 0.0) {
  PatientConfig patient = nobody(2);
  patient.axes[0] = {"x", 1.0, 20.0, 200.0};
  patient.axes[1] = {"y", 1.0, 20.0, 200.0};
  AxisMatrix swap(2, 2);
  swap << 0.0, 1.0, 1.0, 0.0;
  patient.links = {mass * swap, damping * swap, stiffness * swap};
  return patient;
}

Intention restAt(double x, double y) {
  AxisPosition q(2);
  q[0] = x;
  q[1] = y;
  return Intention::throughWaypoints({{0.0, q}});
}

DeviceReading push(SimulatedDevice& device, double on_x, double on_y, int ticks) {
  DeviceReading reading;
  AxisEffort effort(2);
  effort[0] = on_x;
  effort[1] = on_y;
  for (int i = 0; i < ticks; ++i) {
    (void)device.write(effort);
    (void)device.read(reading, 1);
  }
  return reading;
}

/// At rest q = q_i + K⁻¹ f; K = [200 -80; -80 200], whose inverse is [200 80; 80 200] / 33600.
TEST(LinkedDevice, ConstantEffort_RestsWhereTheStiffnessMatrixSays) {
  const auto device = opened(twoAxes(), person(-80.0), restAt(0.01, -0.02));
  const DeviceReading reading = push(*device, 3.0, 0.0, 6000);
  EXPECT_NEAR(reading.q_m[0], 0.01 + 3.0 * 200.0 / 33600.0, tolerance(1e-9));
  EXPECT_NEAR(reading.q_m[1], -0.02 + 3.0 * 80.0 / 33600.0, tolerance(1e-9));
  EXPECT_NEAR(personAt(*device).effort[0], -3.0,
              tolerance(1e-7));  // the person holds against the push
  EXPECT_NEAR(personAt(*device).effort[1], 0.0, tolerance(1e-7));
}

/// M q̈ = f with the device's mass on the diagonal alone: M = [1.8 0.5; 0.5 1.8].
TEST(LinkedDevice, LinkedMass_MovesTheOtherAxisFromTheFirstTick) {
  PatientConfig heavy = person(0.0, 0.0, 0.5);
  for (PatientAxis& axis : heavy.axes) axis.damping = axis.stiffness = 0.0;
  const auto device = opened(twoAxes(), heavy, restAt(0.0, 0.0));
  push(*device, 2.0, 0.0, 1 + 100);
  const double determinant = 1.8 * 1.8 - 0.5 * 0.5;
  EXPECT_NEAR(device->velocity()[0], 0.1 * 2.0 * 1.8 / determinant, tolerance(1e-12));
  EXPECT_NEAR(device->velocity()[1], -0.1 * 2.0 * 0.5 / determinant, tolerance(1e-12));
}

/// A link as small as rounding moves the axes as if it were not there.
TEST(LinkedDevice, LinkOfNearlyZero_MovesAsSingleAxesDo) {
  SimulatedDevice linked(twoAxes(), person(1e-13), restAt(0.01, 0.0), kTick_s);
  PatientConfig apart = person(0.0);
  apart.links = {};
  SimulatedDevice single(twoAxes(), apart, restAt(0.01, 0.0), kTick_s);
  ASSERT_TRUE(linked.open().ok() && single.open().ok());
  for (int k = 0; k < 1000; ++k) {
    push(linked, std::sin(0.02 * k), 2.0, 1);
    push(single, std::sin(0.02 * k), 2.0, 1);
    for (int i = 0; i < 2; ++i) {
      ASSERT_NEAR(linked.position()[i], single.position()[i], tolerance(1e-12));
    }
  }
}

TEST(LinkedDevice, PersonWhoLetsGo_LeavesBothAxesToTheDevice) {
  PatientConfig patient = person(-80.0, -5.0, 0.3);
  patient.letting_go.after_s = 0.5;
  const auto device = opened(twoAxes(), patient, restAt(0.0, 0.0));
  push(*device, 2.0, 0.0, 1 + 500);
  const double before = device->velocity()[1];
  push(*device, 2.0, 0.0, 100);
  EXPECT_TRUE(device->person().hasLetGo());
  EXPECT_NEAR(device->velocity()[1], before, tolerance(1e-12));  // no force acts on it
  EXPECT_EQ(personAt(*device).effort[1], 0.0);
}

/// A slam lets go of its own axis; the other axis keeps its own stiffness and is no longer pulled.
TEST(LinkedDevice, SlammedAxis_NoLongerPullsTheOther) {
  PatientConfig patient = person(-80.0, -5.0, 0.3);
  patient.slam = {.axis = "x", .towards_upper = true, .after_s = 0.1, .speed_share = 0.01};
  const auto device = opened(twoAxes(), patient, restAt(0.0, 0.0));
  push(*device, 0.0, 0.0, 150);
  ASSERT_FALSE(device->person().hasLetGo());
  EXPECT_GT(std::abs(device->position()[0]), 1e-4);
  EXPECT_EQ(device->position()[1], 0.0);
}

TEST(LinkedDevice, SameCallsTwice_GiveTheSameBitsAndDoNotAllocate) {
  DeviceModel model = twoAxes();
  for (DeviceAxis& axis : model.axes) {
    axis.coulomb = 0.2;
    axis.upper = 0.01;
  }
  PatientConfig patient = person(-80.0, -5.0, 0.3);
  patient.tremor.along = AxisEffort(2, 1.0);
  SimulatedDevice device(model, patient, restAt(0.0, 0.005), kTick_s);
  std::vector<double> first, second;
  for (std::vector<double>* seen : {&first, &second}) {
    seen->reserve(2000);
    ASSERT_TRUE(device.open().ok());
    const AllocationScope count;
    for (int k = 0; k < 1000; ++k) {
      const DeviceReading reading = push(device, 4.0 * std::sin(0.02 * k), 1.0, 1);
      seen->push_back(reading.q_m[0]);
      seen->push_back(personAt(device).effort[1]);
    }
    EXPECT_EQ(count.allocations(), 0U);
    device.close();
  }
  EXPECT_EQ(first, second);
}

TEST(LinkedDevice, PersonAroundACircle_DoesMinusTheWorkOfTheirDampers) {
  // The device leads both axes around a circle stiffly. Over whole turns the work of the person's
  // springs and dampers is -∮ ẋᵀ B ẋ dt = -turns π r² ω tr(B), by virtual work.
  constexpr double kRadius_m = 0.01, kTurn_s = 0.5;
  const double omega = 2.0 * std::numbers::pi / kTurn_s;
  const PatientConfig patient = person(-80.0, -5.0);
  double work = 0.0;
  const int ticks = static_cast<int>(std::lround(kTurn_s / kTick_s));
  const AxisPosition meant(2);
  const AxisVelocity meant_speed(2);
  for (int k = 0; k < ticks; ++k) {
    const double angle = omega * (k + 0.5) * kTick_s;
    AxisPosition q(2);
    AxisVelocity qd(2);
    q[0] = kRadius_m * std::cos(angle);
    q[1] = kRadius_m * std::sin(angle);
    qd[0] = -omega * q[1];
    qd[1] = omega * q[0];
    const AxisEffort f = patientEffort(patient, q, qd, meant, meant_speed);
    work += (f[0] * qd[0] + f[1] * qd[1]) * kTick_s;
  }
  EXPECT_NEAR(work, -std::numbers::pi * kRadius_m * kRadius_m * omega * (20.0 + 20.0),
              tolerance(1e-9));
}

}  // namespace
}  // namespace wholehand
