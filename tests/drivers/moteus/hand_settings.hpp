#pragma once

#include "moteus/settings.hpp"
#include "support/figure.hpp"
#include "support/file_bytes.hpp"
#include "support/folder.hpp"

#include <string>

namespace wholehand::test {

/// Three motors of a hand: fingers, and a thumb whose flexion cable runs over its circumduction
/// joint.
inline constexpr const char* kHandSettings = R"(kind = "moteus"
version = 1
delay_s = 0.001
[[motors]]
name = "fingers"
id = 1
sign = 1
gear_ratio = 1.0
offset_rad = -1.5
max_torque_nm = 0.8
encoder_step_rad = 5e-5
[[motors]]
name = "thumb base"
id = 2
sign = -1
gear_ratio = 1.5
offset_rad = 1.0
max_torque_nm = 0.8
encoder_step_rad = 5e-5
[[motors]]
name = "thumb tip"
id = 3
sign = 1
gear_ratio = 1.0
offset_rad = 0.2
max_torque_nm = 0.8
encoder_step_rad = 5e-5
[[axes]]
name = "finger_flexion"
motor = "fingers"
range_rad = [0.0, 3.141592653589793]
effort_limit_nm = 0.8
[[axes]]
name = "thumb_circumduction"
motor = "thumb base"
range_rad = [0.0, 1.5707963267948966]
effort_limit_nm = 0.6
[[axes]]
name = "thumb_flexion"
motor = "thumb tip"
range_rad = [0.0, 1.3962634015954636]
effort_limit_nm = 0.8
[axes.coupling]
thumb_circumduction = 0.4
)";

/// Writes a settings file for a test; replaces `was` by `is` if given.
inline std::string settingsFile(const Folder& folder, const std::string& text = kHandSettings,
                                const std::string& was = "", const std::string& is = "") {
  return folder.write("settings.toml", was.empty() ? text : replaced(text, was, is));
}

inline moteus::Settings handSettings() {
  const Folder folder;
  return orThrow(moteus::loadSettings(settingsFile(folder)));
}

}  // namespace wholehand::test
