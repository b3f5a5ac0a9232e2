#pragma once

#include "model/axis_keys.hpp"
#include "model/device_model.hpp"
#include "model/patient/patient_config.hpp"
#include "model/toml/toml_file.hpp"

#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// Axes that one table of a patient file names together.
struct LinkedAxes {
  std::vector<std::string> names;
  std::vector<AxisKind> kinds;
  std::vector<int> on_device;   ///< index; -1: a standard axis that this device lacks
  std::vector<double> lever_m;  ///< path of the tip per radian; 1 for a translation; 0: none
};

/// Reads `axes` (two or more names) and `lever_m` (a table of tip distances of rotations, if other
/// than the device's). Empty when a name is wrong, which is reported.
[[nodiscard]] std::optional<LinkedAxes> readLinkedAxes(TomlTable& table, const DeviceModel& device);

/// Key under which the table gives the quantity for these axes: of translations, of rotations, or
/// of tips, the only key for mixed axes. Empty when there is none; keys of the wrong unit are
/// reported.
[[nodiscard]] std::string_view linkedKey(TomlTable& table, const LinkedAxes& axes,
                                         const AxisQuantity& quantity);

/// Factors from a tip value to the axes' values: the lever arms for a tip key, else ones.
[[nodiscard]] std::vector<double> linkedFactors(const LinkedAxes& axes,
                                                const AxisQuantity& quantity, std::string_view key);

/// Reads every `[[links]]`: adds diagonal elements to the person's axes and the others to the
/// links. Reports sums that are not positive semidefinite.
/// @pre config.axes is in the device's order and contains the values of [[axes]]
void readLinks(TomlTable& root, const DeviceModel& device, PatientConfig& config);

}  // namespace wholehand
