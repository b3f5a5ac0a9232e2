#pragma once

#include "commissioning/passport.hpp"
#include "device/plugin/clearance.hpp"

#include <string>
#include <utility>

namespace wholehand {

/// Daily check of a device with a passport: zero, signs, watchdog and emergency stop. Written only
/// if all four passed.
struct DailyCheck {
  std::string passport_sha256;  ///< of the passport used
  std::string operator_name;
  Day done_on{};
};

/// mine.toml and serial S-1 make mine.S-1.check.toml.
[[nodiscard]] std::string dailyCheckPath(const std::string& device_file, const std::string& serial);

/// Text of the file, with its seal.
[[nodiscard]] std::string dailyCheckText(const DailyCheck& check);

/// Reads a check. Refused: a file that cannot be read, is truncated, was changed or is of another
/// kind.
[[nodiscard]] Expected<DailyCheck> readDailyCheck(const std::string& path);

/// A passport that is valid for a device today, and the proof of it.
struct Cleared {
  explicit Cleared(Passport valid) : passport(std::move(valid)), clearance(passport.sha256) {}
  Passport passport;
  Clearance clearance;
};

/// Verifies that a real device may be armed. It needs a passport valid for this device, this file
/// this rate and this day, and a check of this day done with that passport. Refused, each with its
/// remedy: no serial number, no passport, a passport that readPassport() or checkPassport()
/// refuses, no check, a check of another day or passport.
[[nodiscard]] Expected<Cleared> clearToArm(const DriverIdentity& identity, const DeviceModel& model,
                                           double rate_hz, Day day);

}  // namespace wholehand
