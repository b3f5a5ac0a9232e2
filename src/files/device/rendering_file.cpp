#include "files/device/rendering_file.hpp"

#include "files/device/axis_keys.hpp"
#include "files/toml/toml_file.hpp"
#include "loop/core/printable.hpp"

#include <string>
#include <vector>

namespace wholehand {
namespace {

constexpr AxisQuantity kStiffness{"k_pm_n_m", "k_pm_nm_rad", {}, 1, 0.0, 1e6, true};
constexpr AxisQuantity kDamping{"k_dm_n_s_m", "k_dm_nm_s_rad", {}, 1, 0.0, 1e4};
constexpr AxisQuantity kArmature{"armature_kg", "armature_kg_m2", {}, 1, 0.0, 10.0};
constexpr AxisQuantity kEffortFull{
    "effort_full_n", "effort_full_nm", "effort_full_tip_n", 1, 0.0, 1000.0, true};
constexpr AxisQuantity kEffortDead{"effort_dead_n", "effort_dead_nm", "effort_dead_tip_n", 1, 0.0,
                                   1000.0};
/// Default of f_d: large enough that slow free motion does not raise Φ.
constexpr double kDeadShare = 0.1;

const NumberRule kGamma = between(0.0, 1.0);
const NumberRule kFilter = above(0.0, 10000.0, "Hz");
const NumberRule kDecay = between(0.01, 5.0, "s");

/// Defaults for all axes.
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
  const char* armature = axis.kind == AxisKind::kTranslation ? "armature_kg" : "armature_kg_m2";
  const bool heavier = table.has(armature);
  const double stated = readAxisQuantity(table, kArmature, axis.kind, lever, 0.0);
  if (heavier) out.armature = stated;
  table.refuse("k_ps_per_s2", armature,
               "makes the person feel another force than acts on the object: the avatar's "
               "stiffness is K_pm; an axis too light for it takes armature");
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

/// "roll, pitch and yaw"
std::string listed(const std::vector<std::string>& names) {
  std::string out;
  for (std::size_t i = 0; i < names.size(); ++i) {
    out += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  }
  return out;
}

/// Reports an axis that the device does not have. The remedy names the axis without gains that was
/// probably meant; that axis is removed from `without_gains`, so that one mistake gives one
/// message.
void refuseAxis(NamedAxis& axis, const DeviceModel& device, bool only_one,
                std::vector<std::string>& without_gains) {
  std::string meant = nearestWord(axis.name, without_gains);
  if (meant.empty() && only_one && without_gains.size() == 1) meant = without_gains.front();
  std::erase(without_gains, meant);
  axis.table.fail("name", "is not an axis of the device " + printable(device.path),
                  meant.empty() ? "remove it" : "did you mean " + meant + "?");
  axis.table.ignoreUnknownKeys();
}

void readAxes(TomlTable& root, const DeviceModel& device, const Common& common,
              RenderingConfig& config) {
  config.axes.resize(device.axes.size());
  std::vector<std::string> without_gains;
  for (const DeviceAxis& axis : device.axes) without_gains.push_back(axis.name);
  std::vector<NamedAxis> unknown;
  for (NamedAxis& axis : readAxisNames(root)) {
    const int i = device.axisIndex(axis.name);
    if (i < 0) {
      unknown.push_back(axis);
      continue;
    }
    std::erase(without_gains, axis.name);
    config.axes[i] = readAxis(axis.table, device.axes[i], common, config.paper);
  }
  for (NamedAxis& axis : unknown) {
    refuseAxis(axis, device, unknown.size() == 1, without_gains);
  }
  // An unreadable [[axes]] was reported already.
  if (root.isGood("axes") && !without_gains.empty()) {
    root.fail(
        "axes",
        "have no gains for " + listed(without_gains) + " of the device " + printable(device.path),
        "add an [[axes]] with name = \"" + without_gains.front() + "\"" +
            (without_gains.size() > 1 ? ", and one for each other" : ""));
  }
}

void readRendering(TomlTable& root, const DeviceModel& device, RenderingConfig& config) {
  config.name = root.text("name");
  config.paper = root.flag("paper", false);
  Common common;
  common.gamma = root.number("gamma", kGamma, common.gamma);
  common.velocity_filter_hz = root.number("velocity_filter_hz", kFilter, common.velocity_filter_hz);
  common.decay_s = root.number("decay_s", kDecay, common.decay_s);
  readAxes(root, device, common, config);
}

}  // namespace

Expected<RenderingConfig> loadRenderingFile(const std::string& path, const DeviceModel& device) {
  return readTomlFile<RenderingConfig>(
      path, "rendering",
      [&](TomlTable& root, RenderingConfig& config) { readRendering(root, device, config); });
}

}  // namespace wholehand
