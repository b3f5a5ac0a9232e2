#include "files/device/axis_keys.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace wholehand {
std::string unitOfKey(std::string_view key) {
  // Longer endings come first, so that "_tip_n" is found before "_n".
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 20> kUnits = {{
      {"_tip_n_s_m", "N·s/m at the tip"},
      {"_tip_n_m", "N/m at the tip"},
      {"_tip_kg", "kg at the tip"},
      {"_tip_n_s", "N/s at the tip"},
      {"_nm_s", "N·m/s"},
      {"_n_s", "N/s"},
      {"_tip_n", "N at the tip"},
      {"_nm_s_rad", "N·m·s/rad"},
      {"_n_s_m", "N·s/m"},
      {"_nm_rad", "N·m/rad"},
      {"_n_m", "N/m"},
      {"_kg_m2", "kg·m²"},
      {"_rad_s", "rad/s"},
      {"_m_s", "m/s"},
      {"_rad", "rad"},
      {"_nm", "N·m"},
      {"_kg", "kg"},
      {"_n", "N"},
      {"_m", "m"},
      {"_s", "s"},
  }};
  for (const auto& [ending, text] : kUnits) {
    if (key.ends_with(ending)) return std::string(text);
  }
  return {};
}

namespace {

NumberRule ruleFor(const AxisQuantity& quantity, std::string_view key) {
  return {quantity.lower, quantity.upper, quantity.open_lower, unitOfKey(key)};
}

/// Reads the tip key if present and allowed; otherwise reports why not.
bool usesTip(TomlTable& table, const AxisQuantity& quantity, AxisKind kind, double lever_arm_m,
             std::string_view key) {
  if (quantity.tip_key.empty() || !table.has(quantity.tip_key)) return false;
  if (kind == AxisKind::kTranslation) {
    table.refuse(quantity.tip_key, key, "is for rotations that end in a fingertip");
  } else if (table.has(key)) {
    table.refuse(quantity.tip_key, key, "is given twice, at the tip and at the joint");
  } else if (!(lever_arm_m > 0.0)) {
    table.refuse(quantity.tip_key, key, "needs a lever arm, which this axis does not have");
  } else {
    return true;
  }
  return false;
}

}  // namespace

double readAxisQuantity(TomlTable& table, const AxisQuantity& quantity, AxisKind kind,
                        double lever_arm_m, std::optional<double> fallback) {
  const bool turns = kind == AxisKind::kRotation;
  const std::string_view key = turns ? quantity.rotation_key : quantity.translation_key;
  const std::string_view other = turns ? quantity.translation_key : quantity.rotation_key;
  table.refuse(other, key,
               turns ? "has the wrong unit: this axis is a rotation"
                     : "has the wrong unit: this axis is a translation");
  if (usesTip(table, quantity, kind, lever_arm_m, key)) {
    const double tip = table.number(quantity.tip_key, ruleFor(quantity, quantity.tip_key));
    return tip * std::pow(lever_arm_m, quantity.tip_power);
  }
  const NumberRule rule = ruleFor(quantity, key);
  return fallback ? table.number(key, rule, *fallback) : table.number(key, rule);
}

bool hasAxisQuantity(const TomlTable& table, const AxisQuantity& quantity, AxisKind kind) {
  if (kind == AxisKind::kTranslation) return table.isGood(quantity.translation_key);
  return table.isGood(quantity.rotation_key) ||
         (!quantity.tip_key.empty() && table.isGood(quantity.tip_key));
}

std::optional<AxisKind> knownAxisKind(std::string_view name) noexcept {
  for (const KnownAxis& axis : kKnownAxes) {
    if (axis.name == name) return axis.kind;
  }
  return std::nullopt;
}

std::vector<NamedAxis> readAxisNames(TomlTable& root) {
  std::vector<NamedAxis> out;
  std::vector<std::string> names;
  for (TomlTable& table : root.tables("axes", 1)) {
    std::string name = table.text("name");
    if (!table.isGood("name") || !checkNewName(table, name, names)) {
      table.ignoreUnknownKeys();
      continue;
    }
    names.push_back(name);
    out.push_back({table, std::move(name)});
  }
  return out;
}

bool checkNewName(TomlTable& table, const std::string& name,
                  const std::vector<std::string>& earlier) {
  if (std::find(earlier.begin(), earlier.end(), name) == earlier.end()) return true;
  table.fail("name", "is given twice", "give every entry a name of its own");
  return false;
}

}  // namespace wholehand
