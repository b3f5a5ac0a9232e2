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

/// An axis that nobody knows would feel no person, and nobody would notice.
void refuseAxis(NamedAxis& axis, const std::vector<NamedAxis>& all, const DeviceModel& device) {
  std::vector<std::string> names, used;
  for (const DeviceAxis& on_device : device.axes) names.push_back(on_device.name);
  for (const KnownAxis& known : kKnownAxes) {
    if (device.axisIndex(std::string(known.name)) < 0) names.emplace_back(known.name);
  }
  for (const NamedAxis& other : all) used.push_back(other.name);
  const std::string near = nearestUnused(axis.name, names, used);
  axis.table.fail("name", "is no axis of the device " + device.path + " nor any known one",
                  near.empty() ? "remove it" : "did you mean " + near + "?");
  axis.table.skipRest();
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
  std::vector<NamedAxis> named = readAxisNames(root);
  for (NamedAxis& axis : named) {
    const int i = device.axisIndex(axis.name);
    if (i >= 0) {
      const DeviceAxis& own = device.axes[static_cast<std::size_t>(i)];
      config.axes[static_cast<std::size_t>(i)] =
          readAxis(axis.table, axis.name, own.kind, own.lever_arm_m);
    } else if (const std::optional<AxisKind> kind = knownAxisKind(axis.name)) {
      constexpr double kAnyLever_m =
          1.0;  // another device's axis: its keys are checked all the same
      (void)readAxis(axis.table, axis.name, *kind, kAnyLever_m);
    } else {
      refuseAxis(axis, named, device);
    }
  }
  config.motion = readMotion(root);
  if (Diagnostics faults = file.finish(); !faults.empty()) return faults;
  return config;
}

}  // namespace wholehand
