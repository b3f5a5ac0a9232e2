#pragma once

#include "commissioning/identification/interval.hpp"
#include "commissioning/sealed_file.hpp"
#include "core/expected.hpp"
#include "device/plugin/device_driver.hpp"
#include "model/device_model.hpp"

#include <chrono>
#include <string>
#include <vector>

/// What was measured of one device, kept beside its device file. Not for the tick.
namespace wholehand {

inline constexpr std::chrono::days kPassportLasts{30};

/// One axis as measured: where each figure lies. SI; per radian for a rotation.
struct PassportAxis {
  std::string name;
  AxisKind kind = AxisKind::kTranslation;
  Interval mass;            ///< [kg or kg·m²]
  Interval damping;         ///< viscous [N·s/m or N·m·s/rad]
  Interval coulomb;         ///< dry friction [N or N·m]
  Interval gravity;         ///< effort that holds it in the middle of its travel [N or N·m]
  Interval delay_s;         ///< from a command to its effect
  double resolution = 0.0;  ///< smallest change of position that was read [m or rad]
  double mark = 0.0;        ///< where it stood on the device's mark [m or rad]
};

struct Passport {
  std::string path;  ///< where it was read; empty for one that was not
  DriverIdentity identity;
  std::string driver;         ///< what it calls itself
  std::string device;         ///< name in the device file
  std::string device_sha256;  ///< of the device file's bytes
  std::string operator_name;
  Day measured_on{};
  double rate_hz = 1000.0;  ///< ticks a second while it was measured
  std::vector<PassportAxis> axes;
  std::string sha256;  ///< its own digest; empty for one that was not read
};

/// Where the passport of this device belongs: mine.toml and serial S-1 make mine.S-1.passport.toml.
/// What a file's name should not hold becomes a dash.
[[nodiscard]] std::string passportPath(const std::string& device_file, const std::string& serial);

/// The file's text, sealed.
[[nodiscard]] std::string passportText(const Passport& passport);

/// Refused: a file that cannot be read, is truncated, was changed, is of another kind, or says what
/// cannot be.
[[nodiscard]] Expected<Passport> readPassport(const std::string& path);

/// Whether it has the axes of this device, in their order and kind.
[[nodiscard]] bool sameAxes(const Passport& passport, const DeviceModel& model);

/// Whether the passport speaks of this device and file, today. Refused, each by name: another
/// serial, firmware or SDK (foreign), a device file that was changed since, axes that differ, one
/// older than kPassportLasts or from the future.
[[nodiscard]] Expected<Done> checkPassport(const Passport& passport, const DriverIdentity& identity,
                                           const DeviceModel& model, Day day);

/// The device at the worst corners of what was measured, for the certificate: least damping and
/// dry friction, largest delay and coarsest position, with every mass at its lower and at its upper
/// end. A figure of the file stands where it is worse. Delays are whole periods, rounded up where
/// they exceed one by more than a tenth.
/// @pre sameAxes()
[[nodiscard]] std::vector<DeviceModel> worstCorners(const DeviceModel& model,
                                                    const Passport& passport, double period_s);

}  // namespace wholehand
