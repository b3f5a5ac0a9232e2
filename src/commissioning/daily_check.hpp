#pragma once

#include "commissioning/passport.hpp"
#include "device/plugin/plugin_device.hpp"

#include <chrono>
#include <string>
#include <utility>

namespace wholehand {

/// A check opens the device on the place's day on which it was done, and no longer than this.
inline constexpr std::chrono::hours kCheckLasts{12};

/// Daily check of a device with a passport: zero, signs, watchdog and emergency stop. Written only
/// if all four passed.
struct DailyCheck {
  std::string passport_sha256;  ///< of the passport used
  std::string operator_name;
  PlaceTime done_at;
};

/// mine.toml and serial S-1 make mine.S-1.check.toml.
[[nodiscard]] std::string dailyCheckPath(const std::string& device_file, const std::string& serial);

/// Text of the file, with its seal.
[[nodiscard]] std::string dailyCheckText(const DailyCheck& check);

/// Reads a check. Refused: a file that cannot be read, is truncated, was changed or is of another
/// kind.
[[nodiscard]] Expected<DailyCheck> readDailyCheck(const std::string& path);

/// A passport that is valid for a device now, and the proof of it.
struct Cleared {
  explicit Cleared(Passport valid) : passport(std::move(valid)), clearance(passport.sha256) {}
  Passport passport;
  Clearance clearance;
};

/// Verifies that a real device may be armed. It needs a passport valid for this device, this file
/// and this rate now, and a check done with that passport on this day of the place, within
/// kCheckLasts. Refused, each with its remedy: no serial number, no passport, a passport that
/// readPassport() or checkPassport() refuses, no check, a check of another day or passport, an
/// expired one, and one of the future: the clock was set back.
[[nodiscard]] Expected<Cleared> clearToArm(const DriverIdentity& identity, const DeviceModel& model,
                                           double rate_hz, const PlaceTime& now);

}  // namespace wholehand
