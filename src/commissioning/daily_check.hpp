#pragma once

#include "commissioning/passport.hpp"

#include <string>

namespace wholehand {

/// The two-minute check of a day: zero, signs, watchdog and emergency stop of a device that has a
/// passport. All four passed, or it was not written.
struct DailyCheck {
  std::string passport_sha256;  ///< of the passport that it was done with
  std::string operator_name;
  Day done_on{};
};

/// mine.toml and serial S-1 make mine.S-1.check.toml.
[[nodiscard]] std::string dailyCheckPath(const std::string& device_file, const std::string& serial);

/// The file's text, sealed.
[[nodiscard]] std::string dailyCheckText(const DailyCheck& check);

/// Refused: a file that cannot be read, is truncated, was changed or is of another kind.
[[nodiscard]] Expected<DailyCheck> readDailyCheck(const std::string& path);

/// What a real device needs before it may be armed: its passport, valid for this device, this file
/// and this day, and a check of this day done with that passport. Refused, each by name with what
/// to do: no serial number, no passport, one that readPassport() or checkPassport() refuses, no
/// check, one of another day or another passport.
[[nodiscard]] Expected<Passport> clearToArm(const DriverIdentity& identity,
                                            const DeviceModel& model, Day day);

}  // namespace wholehand
