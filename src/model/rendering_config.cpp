#include "model/rendering_config.hpp"

#include "model/axis_keys.hpp"
#include "model/toml_file.hpp"

#include <algorithm>

namespace wholehand {
namespace {

constexpr AxisQuantity kStiffness{"k_pm_n_m", "k_pm_nm_rad", {}, 1, 0.0, 1e6, true};
constexpr AxisQuantity kDamping{"k_dm_n_s_m", "k_dm_nm_s_rad", {}, 1, 0.0, 1e4};
constexpr AxisQuantity kEffortFull{
    "effort_full_n", "effort_full_nm", "effort_full_tip_n", 1, 0.0, 1000.0, true};
constexpr AxisQuantity kEffortDead{"effort_dead_n", "effort_dead_nm", "effort_dead_tip_n", 1, 0.0,
                                   1000.0};
/// f_d where the file says nothing: large enough that slow free motion does not raise Φ.
constexpr double kDeadShare = 0.1;

const NumberRule kGamma = between(0.0, 1.0);
const NumberRule kFilter = above(0.0, 10000.0, "Hz");
const NumberRule kDecay = between(0.01, 5.0, "s");
const NumberRule kAvatarStiffness = above(0.0, 1e6, "1/s²");

/// Values that axes share unless they state their own.
struct Common {
  double gamma = AxisRendering{}.gamma;
  double velocity_filter_hz = AxisRendering{}.velocity_filter_hz;
  double decay_s = AxisRendering{}.decay_s;
};

AxisRendering readAxis(TomlTable& table, const DeviceAxis& axis, const Common& common, bool paper) {
  AxisRendering out;
  out.name = axis.name;
  const double lever = axis.lever_arm_m;
  out.k_pm = readAxisQuantity(table, kStiffness, axis.kind, lever);
  out.k_dm = readAxisQuantity(table, kDamping, axis.kind, lever);
  out.gamma = table.number("gamma", kGamma, common.gamma);
  out.velocity_filter_hz = table.number("velocity_filter_hz", kFilter, common.velocity_filter_hz);
  out.k_ps_per_s2 = table.number("k_ps_per_s2", kAvatarStiffness, 0.0);
  out.effort_full = readAxisQuantity(table, kEffortFull, axis.kind, lever);
  out.effort_dead =
      readAxisQuantity(table, kEffortDead, axis.kind, lever, kDeadShare * out.effort_full);
  out.decay_s = table.number("decay_s", kDecay, common.decay_s);
  out.palm_contact = table.flag("palm_contact", false);
  if (out.palm_contact && axis.group != AxisGroup::kBase) {
    table.fail("palm_contact", "is for axes that carry the hand", "remove it");
  }
  if (hasAxisQuantity(table, kEffortFull, axis.kind) && out.effort_dead >= out.effort_full) {
    table.fail("", "effort_dead is not below effort_full",
               "the damping rises between the two: write effort_dead < effort_full");
  }
  if (paper) {
    out.gamma = 0.0;
    out.effort_dead = 0.0;
  }
  return out;
}

void readAxes(TomlTable& root, const DeviceModel& device, const Common& common,
              RenderingConfig& config) {
  config.axes.resize(device.axes.size());
  std::vector<std::string> device_names;
  for (const DeviceAxis& axis : device.axes) device_names.push_back(axis.name);
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
      const std::string near = nearestWord(name, device_names);
      table.fail("name", "is not an axis of the device " + device.path,
                 near.empty() ? "remove it" : "did you mean " + near + "?");
      table.skipRest();
      continue;
    }
    const auto at = static_cast<std::size_t>(i);
    config.axes[at] = readAxis(table, device.axes[at], common, config.paper);
  }
  for (const std::string& name : device_names) {
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      root.fail("axes", "have no gains for " + name + " of the device " + device.path,
                "add an [[axes]] with name = \"" + name + "\"");
    }
  }
}

}  // namespace

Expected<RenderingConfig> loadRenderingFile(const std::string& path, const DeviceModel& device) {
  TomlFile file(path, "rendering");
  if (!file.readable()) return file.finish();
  TomlTable& root = file.root();
  RenderingConfig config;
  config.path = path;
  config.name = root.text("name");
  config.paper = root.flag("paper", false);
  Common common;
  common.gamma = root.number("gamma", kGamma, common.gamma);
  common.velocity_filter_hz = root.number("velocity_filter_hz", kFilter, common.velocity_filter_hz);
  common.decay_s = root.number("decay_s", kDecay, common.decay_s);
  readAxes(root, device, common, config);
  if (Diagnostics faults = file.finish(); !faults.empty()) return faults;
  return config;
}

}  // namespace wholehand
