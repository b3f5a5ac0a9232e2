#pragma once

#include "loop/device/simulated/simulated_device.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <utility>

namespace wholehand::test {

/// A device of one free axis with a mass only; tests add the rest.
inline DeviceModel oneAxisDevice(double mass) {
  DeviceModel device;
  device.name = "one-axis";
  DeviceAxis axis;
  axis.name = "x";
  axis.lower = -1e3;
  axis.upper = 1e3;
  axis.effort_limit = 100.0;
  axis.speed_limit = 100.0;
  axis.mass = mass;
  device.axes = {axis};
  return device;
}

/// A person who applies no effort.
inline PatientConfig nobody(int axes = 1) {
  PatientConfig patient;
  patient.axes.assign(static_cast<std::size_t>(axes), PatientAxis{});
  return patient;
}

inline Intention stayAt(double position) {
  return Intention::throughWaypoints({{0.0, AxisPosition(1, position)}});
}

/// A person who pulls one axis to the intended position.
inline PatientConfig personOf(PatientAxis axis) {
  PatientConfig patient;
  patient.axes = {std::move(axis)};
  return patient;
}

/// Opens the device at 1 kHz.
inline std::unique_ptr<SimulatedDevice> opened(const DeviceModel& model,
                                               const PatientConfig& patient, Intention intention) {
  auto device = std::make_unique<SimulatedDevice>(model, patient, std::move(intention), 1e-3);
  EXPECT_TRUE(device->open().ok());
  return device;
}

/// Reading of the person at the device, at its last read.
inline PersonReading personAt(const SimulatedDevice& device) {
  PersonReading person;
  device.report(person);
  return person;
}

/// Reads and writes one effort for a number of ticks; returns the last reading.
inline DeviceReading hold(SimulatedDevice& device, double effort, int ticks) {
  DeviceReading reading;
  for (int i = 0; i < ticks; ++i) {
    (void)device.write(AxisEffort(1, effort));
    (void)device.read(reading, 1);
  }
  return reading;
}

}  // namespace wholehand::test
