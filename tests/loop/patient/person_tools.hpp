#pragma once

#include "loop/model/device_model.hpp"
#include "loop/model/patient_config.hpp"
#include "support/axes.hpp"

#include <initializer_list>

/// Devices, poses and persons with a few axes.
namespace wholehand::test {

inline AxisPosition pose(double a, double b) {
  return of<AxisPosition>(a, b);
}

struct Moved {
  AxisPosition q;
  AxisVelocity qd;
};

/// A device with rotation axes of 0 to 3 rad.
inline DeviceModel digits(std::initializer_list<const char*> names) {
  DeviceModel device;
  for (const char* name : names) {
    DeviceAxis axis;
    axis.name = name;
    axis.kind = AxisKind::kRotation;
    axis.upper = 3.0;
    axis.effort_limit = 2.0;
    axis.speed_limit = 10.0;
    axis.mass = 5e-4;
    device.axes.push_back(axis);
  }
  return device;
}

inline PatientConfig calmPatient(int axes) {
  PatientConfig patient;
  patient.axes.assign(axes, PatientAxis{});
  return patient;
}

}  // namespace wholehand::test
