#pragma once

#include "files/toml/toml_file.hpp"
#include "loop/model/device_model.hpp"

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace wholehand {

/// A quantity of an axis in a file. Translations and rotations have separate keys with their own
/// units; a rotation with a lever arm may give the value at the tip instead.
struct AxisQuantity {
  std::string_view translation_key;  ///< "effort_limit_n"
  std::string_view rotation_key;     ///< "effort_limit_nm"
  std::string_view tip_key = {};     ///< "effort_limit_tip_n"; empty: no such key
  int tip_power = 1;                 ///< joint value = tip value * lever arm ^ tip_power
  double lower = 0.0;                ///< smallest value, in the unit of the key
  double upper = 0.0;                ///< largest value, in the unit of the key
  bool open_lower = false;           ///< the lower bound itself is excluded
};

/// The unit that a key names: "N·m" for "effort_limit_nm"; empty when it names none.
[[nodiscard]] std::string unitOfKey(std::string_view key);

/// Reads the quantity in the axis's own unit; required without `fallback`. If the file has the key
/// of the other kind of axis, the error names the right one.
double readAxisQuantity(TomlTable& table, const AxisQuantity& quantity, AxisKind kind,
                        double lever_arm_m, std::optional<double> fallback = std::nullopt);

/// True when the table gives the quantity under a key for that kind of axis.
[[nodiscard]] bool hasAxisQuantity(const TomlTable& table, const AxisQuantity& quantity,
                                   AxisKind kind);

/// A standard axis name of Wholehand, for any device.
struct KnownAxis {
  std::string_view name;
  AxisKind kind;
};
inline constexpr std::array<KnownAxis, 9> kKnownAxes{{{"x", AxisKind::kTranslation},
                                                      {"y", AxisKind::kTranslation},
                                                      {"z", AxisKind::kTranslation},
                                                      {"roll", AxisKind::kRotation},
                                                      {"pitch", AxisKind::kRotation},
                                                      {"yaw", AxisKind::kRotation},
                                                      {"finger_flexion", AxisKind::kRotation},
                                                      {"thumb_circumduction", AxisKind::kRotation},
                                                      {"thumb_flexion", AxisKind::kRotation}}};

/// Kind of a standard axis; empty for any other name.
[[nodiscard]] std::optional<AxisKind> knownAxisKind(std::string_view name) noexcept;

/// An `[[axes]]` table and its name.
struct NamedAxis {
  TomlTable table;
  std::string name;
};
/// Every `[[axes]]` of a file. Tables with an unusable or repeated name are reported and skipped,
/// with all their other keys.
[[nodiscard]] std::vector<NamedAxis> readAxisNames(TomlTable& root);

/// Reports a name that an earlier table of the list has. @return true when it is new
bool checkNewName(TomlTable& table, const std::string& name,
                  const std::vector<std::string>& earlier);

}  // namespace wholehand
