#include "model/patient/patient_config.hpp"

#include "core/printable.hpp"
#include "model/axis_keys.hpp"
#include "model/patient/patient_keys.hpp"
#include "model/patient/patient_links.hpp"
#include "model/toml/toml_file.hpp"

#include <algorithm>

namespace wholehand {
namespace {

// Stronger than any tremor or finger, weaker than a slipped unit.
constexpr AxisQuantity kTremor{"tremor_n", "tremor_nm", "tremor_tip_n", 1, 0.0, 10.0};
constexpr AxisQuantity kTremorAlong{"along_n", "along_nm", "along_tip_n", 1, -10.0, 10.0};
constexpr AxisQuantity kFight{"fight_n", "fight_nm", "fight_tip_n", 1, 0.0, 100.0};

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

/// Refuses an unknown axis: it would feel no person, unnoticed.
void refuseAxis(NamedAxis& axis, const std::vector<NamedAxis>& all, const DeviceModel& device) {
  std::vector<std::string> names, used;
  for (const DeviceAxis& on_device : device.axes) names.push_back(on_device.name);
  for (const KnownAxis& known : kKnownAxes) {
    if (device.axisIndex(std::string(known.name)) < 0) names.emplace_back(known.name);
  }
  for (const NamedAxis& other : all) used.push_back(other.name);
  const std::string near = nearestUnused(axis.name, names, used);
  axis.table.fail(
      "name", "is neither an axis of the device " + printable(device.path) + " nor a standard axis",
      near.empty() ? "remove it" : "did you mean " + near + "?");
  axis.table.ignoreUnknownKeys();
}

StretchReflex readReflex(TomlTable& table, AxisKind kind) {
  StretchReflex reflex;
  constexpr const char* kGain = "reflex_gain_nm_s_rad2";
  if (!table.has(kGain)) return reflex;
  reflex.gain_nm_s_rad2 = table.number(kGain, between(0.0, 100.0, "N·m·s/rad²"));
  if (kind == AxisKind::kTranslation) {
    table.fail(kGain, "is for rotations: a translation has no muscle to stretch", "remove it");
    table.ignoreUnknownKeys();
    return reflex;
  }
  reflex.from_speed_rad_s = table.number("reflex_from_rad_s", between(0.0, 20.0, "rad/s"));
  reflex.below_rad = table.number("reflex_below_rad", between(-10.0, 10.0, "rad"));
  return reflex;
}

PatientAxis readAxis(TomlTable& table, const std::string& name, AxisKind kind, double lever_m) {
  PatientAxis axis;
  axis.name = name;
  axis.mass = readAxisQuantity(table, kPersonMass, kind, lever_m);
  axis.damping = readAxisQuantity(table, kPersonDamping, kind, lever_m);
  axis.stiffness = readAxisQuantity(table, kPersonStiffness, kind, lever_m);
  axis.tremor = readAxisQuantity(table, kTremor, kind, lever_m, 0.0);
  axis.fight = readAxisQuantity(table, kFight, kind, lever_m, 0.0);
  axis.reflex = readReflex(table, kind);
  return axis;
}

/// The table of a behaviour: required if an axis takes part in it, else forbidden.
std::optional<TomlTable> habitTable(TomlTable& root, const std::string& name, bool any_axis,
                                    const std::string& axis_key) {
  std::optional<TomlTable> table = root.optionalTable(name);
  if (any_axis && !table) {
    root.fail(name, "is missing, although an axis has " + axis_key, "add a table [" + name + "]");
  } else if (table && !any_axis) {
    table->fail("", "has no effect: no axis has " + axis_key,
                "give " + axis_key + " to an axis, or remove the table");
    table->ignoreUnknownKeys();
    return std::nullopt;
  }
  return table;
}

/// Efforts of a tremor that moves several axes together.
AxisEffort readTremorAlong(TomlTable& table, const DeviceModel& device) {
  AxisEffort along(device.axisCount());
  const std::optional<LinkedAxes> axes = readLinkedAxes(table, device);
  if (!axes) return along;
  const std::string_view key = linkedKey(table, *axes, kTremorAlong);
  if (key.empty()) {
    if (table.isGood("axes")) {
      table.fail("axes", "have no amplitude of tremor", "add along_n, along_nm or along_tip_n");
    }
    return along;
  }
  const NumberRule rule = between(kTremorAlong.lower, kTremorAlong.upper, unitOfKey(key));
  const std::vector<double> values = table.numbers(key, axes->names.size(), rule);
  const std::vector<double> factors = linkedFactors(*axes, kTremorAlong, key);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (axes->on_device[i] >= 0) along[axes->on_device[i]] = values[i] * factors[i];
  }
  return along;
}

/// Reads the behaviours; `all` are the axes of the file, other devices' included.
void readHabits(TomlTable& root, const std::vector<PatientAxis>& all, const DeviceModel& device,
                PatientConfig& config) {
  const auto any = [&all](auto has) { return std::any_of(all.begin(), all.end(), has); };
  std::optional<TomlTable> tremor = root.optionalTable("tremor");
  const bool along = tremor && tremor->has("axes");
  if (auto t =
          habitTable(root, "tremor", along || any([](const auto& a) { return a.tremor > 0.0; }),
                     "tremor_n, tremor_nm or tremor_tip_n")) {
    if (along) config.tremor.along = readTremorAlong(*t, device);
    config.tremor.frequency_hz = t->number("frequency_hz", between(3.0, 12.0, "Hz"));
    config.tremor.phase_seed = static_cast<std::uint64_t>(
        t->integer("phase_seed", 0, std::numeric_limits<std::int32_t>::max(), 1));
  }
  if (auto t = habitTable(root, "reflex",
                          any([](const auto& a) { return a.reflex.gain_nm_s_rad2 > 0.0; }),
                          "reflex_gain_nm_s_rad2")) {
    config.reflex.delay_s = t->number("delay_s", between(0.0, 0.2, "s"), config.reflex.delay_s);
    config.reflex.muscle_lag_s =
        t->number("muscle_lag_s", above(0.0, 0.5, "s"), config.reflex.muscle_lag_s);
    config.reflex.largest_triggers_all = t->flag("together", config.reflex.largest_triggers_all);
  }
  if (auto t = habitTable(root, "fight", any([](const auto& a) { return a.fight > 0.0; }),
                          "fight_n, fight_nm or fight_tip_n")) {
    config.fight_reaction_s =
        t->number("reaction_s", between(0.0, 1.0, "s"), config.fight_reaction_s);
  }
}

LettingGo readLettingGo(TomlTable& root) {
  LettingGo go;
  std::optional<TomlTable> table = root.optionalTable("letting_go");
  if (!table) return go;
  if (!table->has("after_s") && !table->has("effort_share")) {
    table->fail("", "has neither after_s nor effort_share", "give one or both");
  }
  go.after_s = table->number("after_s", between(0.0, 3600.0, "s"), go.after_s);
  go.effort_share = table->number("effort_share", above(0.0, 10.0), go.effort_share);
  return go;
}

Slam readSlam(TomlTable& root, const DeviceModel& device) {
  Slam slam;
  std::optional<TomlTable> table = root.optionalTable("slam");
  if (!table) return slam;
  slam.axis = table->text("axis");
  if (table->isGood("axis") && device.axisIndex(slam.axis) < 0 && !knownAxisKind(slam.axis)) {
    table->fail(
        "axis",
        "is neither an axis of the device " + printable(device.path) + " nor a standard axis",
        "name an axis, for instance x");
  }
  slam.towards_upper = table->choice("towards", {"upper", "lower"}) == "upper";
  slam.after_s = table->number("after_s", between(0.0, 3600.0, "s"), slam.after_s);
  slam.speed_share = table->number("speed_share", above(0.0, 2.0), slam.speed_share);
  slam.effort_share = table->number("effort_share", above(0.0, 5.0), slam.effort_share);
  return slam;
}

void readPatient(TomlTable& root, const DeviceModel& device, PatientConfig& config) {
  config.name = root.text("name");
  for (const DeviceAxis& axis : device.axes) config.axes.push_back({.name = axis.name});
  std::vector<NamedAxis> named = readAxisNames(root);
  std::vector<PatientAxis> all;
  for (NamedAxis& axis : named) {
    const int i = device.axisIndex(axis.name);
    if (i >= 0) {
      const DeviceAxis& own = device.axes[i];
      all.push_back(readAxis(axis.table, axis.name, own.kind, own.lever_arm_m));
      config.axes[i] = all.back();
    } else if (const std::optional<AxisKind> kind = knownAxisKind(axis.name)) {
      constexpr double kAnyLever_m = 1.0;  // an axis of another device: its keys are still checked
      all.push_back(readAxis(axis.table, axis.name, *kind, kAnyLever_m));
    } else {
      refuseAxis(axis, named, device);
    }
  }
  readLinks(root, device, config);
  config.motion = readMotion(root);
  readHabits(root, all, device, config);
  config.letting_go = readLettingGo(root);
  config.slam = readSlam(root, device);
}

}  // namespace

Expected<PatientConfig> loadPatientFile(const std::string& path, const DeviceModel& device) {
  return readTomlFile<PatientConfig>(path, "patient", [&](TomlTable& root, PatientConfig& config) {
    readPatient(root, device, config);
  });
}

}  // namespace wholehand
