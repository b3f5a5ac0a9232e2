#include "model/patient_config.hpp"

#include "model/axis_keys.hpp"
#include "model/toml_file.hpp"

namespace wholehand {
namespace {

// Values at the tip become values of the joint by the lever arm squared: one factor for the force,
// one for the path.
constexpr AxisQuantity kMass{"mass_kg", "inertia_kg_m2", "mass_tip_kg", 2, 0.0, 100.0};
constexpr AxisQuantity kDamping{
    "damping_n_s_m", "damping_nm_s_rad", "damping_tip_n_s_m", 2, 0.0, 1e4};
constexpr AxisQuantity kStiffness{
    "stiffness_n_m", "stiffness_nm_rad", "stiffness_tip_n_m", 2, 0.0, 1e6};

/// The kind of an axis that this device does not have, so that its keys can be checked all the
/// same.
AxisKind guessedKind(const std::string& name) {
  return name == "x" || name == "y" || name == "z" ? AxisKind::kTranslation : AxisKind::kRotation;
}

MotionMapping readMotion(TomlTable& root) {
  MotionMapping motion;
  std::optional<TomlTable> table = root.optionalTable("motion");
  if (!table) return motion;
  motion.margin = table->number("margin", between(0.0, 0.4), motion.margin);
  motion.speed_share = table->number("speed_share", above(0.0, 1.0), motion.speed_share);
  motion.base_scale = table->number("base_scale", between(0.0, 10.0), motion.base_scale);
  motion.center = table->flag("center", motion.center);
  return motion;
}

PatientAxis readAxis(TomlTable& table, const std::string& name, AxisKind kind, double lever_m) {
  PatientAxis axis;
  axis.name = name;
  axis.mass = readAxisQuantity(table, kMass, kind, lever_m);
  axis.damping = readAxisQuantity(table, kDamping, kind, lever_m);
  axis.stiffness = readAxisQuantity(table, kStiffness, kind, lever_m);
  return axis;
}

}  // namespace

Expected<PatientConfig> loadPatientFile(const std::string& path, const DeviceModel& device) {
  TomlFile file(path, "patient");
  if (!file.readable()) return file.finish();
  TomlTable& root = file.root();
  PatientConfig config;
  config.path = path;
  config.name = root.text("name");
  for (const DeviceAxis& axis : device.axes) config.axes.push_back({axis.name, 0.0, 0.0, 0.0});
  std::vector<std::string> names;
  for (TomlTable& table : root.tables("axes", 1)) {
    const std::string name = table.text("name");
    if (!table.good("name") || !checkNewName(table, name, names)) {
      table.skipRest();
      continue;
    }
    names.push_back(name);
    const int i = device.axisIndex(name);
    if (i < 0) {
      constexpr double kAnyLever_m = 1.0;
      (void)readAxis(table, name, guessedKind(name), kAnyLever_m);
      continue;
    }
    const auto at = static_cast<std::size_t>(i);
    config.axes[at] = readAxis(table, name, device.axes[at].kind, device.axes[at].lever_arm_m);
  }
  config.motion = readMotion(root);
  if (Diagnostics faults = file.finish(); !faults.empty()) return faults;
  return config;
}

}  // namespace wholehand
