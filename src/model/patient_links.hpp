#pragma once

#include "model/axis_keys.hpp"
#include "model/device_model.hpp"
#include "model/patient_config.hpp"
#include "model/toml/toml_file.hpp"

#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// Axes that one table of a patient file names together.
struct LinkedAxes {
  std::vector<std::string> names;
  std::vector<AxisKind> kinds;
  std::vector<int> on_device;   ///< index; -1: known, but this device has it not
  std::vector<double> lever_m;  ///< path of the tip per radian; 1 for a translation; 0: none
};

/// Reads `axes` (two or more names) and `lever_m` (a table; where the tip of a rotation is, if not
/// where the device says). Nothing where a name is wrong, which is reported.
[[nodiscard]] std::optional<LinkedAxes> readLinkedAxes(TomlTable& table, const DeviceModel& device);

/// The key under which the table gives the quantity of these axes: that of translations, of
/// rotations, or of tips, which is the only one for both together. Empty where it gives none; keys
/// of the wrong unit are reported.
[[nodiscard]] std::string_view linkedKey(TomlTable& table, const LinkedAxes& axes,
                                         const AxisQuantity& quantity);

/// What turns a value at the tip into one of the axis: a lever arm each where the key says tip,
/// else ones.
[[nodiscard]] std::vector<double> linkedFactors(const LinkedAxes& axes,
                                                const AxisQuantity& quantity, std::string_view key);

/// Reads every `[[links]]`: adds what they have on the diagonal to the person's axes and the rest
/// to their links; reports sums that are not positive semidefinite.
/// @pre config.axes is the device's and holds what [[axes]] says
void readLinks(TomlTable& root, const DeviceModel& device, PatientConfig& config);

}  // namespace wholehand
