#include "files/patient/patient_file.hpp"

#include "files/device/axis_keys.hpp"
#include "files/toml/toml_file.hpp"
#include "loop/core/printable.hpp"
#include "loop/model/device_model.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace wholehand {
namespace {

// Tip values convert to joint values by the lever arm squared: one factor for the force, one for
// the path. In a link between two axes the factor is the product of both lever arms.
constexpr AxisQuantity kPersonMass{"mass_kg", "inertia_kg_m2", "mass_tip_kg", 2, 0.0, 100.0};
constexpr AxisQuantity kPersonDamping{
    "damping_n_s_m", "damping_nm_s_rad", "damping_tip_n_s_m", 2, 0.0, 1e4};
constexpr AxisQuantity kPersonStiffness{
    "stiffness_n_m", "stiffness_nm_rad", "stiffness_tip_n_m", 2, 0.0, 1e6};

/// Axes that one table of a patient file names together.
struct LinkedAxes {
  std::vector<std::string> names;
  std::vector<AxisKind> kinds;
  std::vector<int> on_device;  ///< index; -1: a standard axis that this device lacks
  std::vector<double>
      lever_m;  ///< path of the tip per radian; 1 for a translation; 0: no lever arm
};

// Lever arm assumed for an axis of another device, whose keys are still checked.
constexpr double kAnyLever_m = 1.0;
constexpr double kRounding = 1e-12;  // tolerance for a negative eigenvalue, when the diagonal is 1

std::string listOf(const std::vector<std::string>& names) {
  std::string out;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) out += i + 1 == names.size() ? " and " : ", ";
    out += names[i];
  }
  return out;
}

/// Reports an unknown or repeated name.
bool checkNames(TomlTable& table, const std::vector<std::string>& names,
                const DeviceModel& device) {
  std::vector<std::string> known;
  for (const DeviceAxis& axis : device.axes) known.push_back(axis.name);
  for (const KnownAxis& axis : kKnownAxes) known.emplace_back(axis.name);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (std::find(known.begin(), known.end(), names[i]) == known.end()) {
      const std::string near = nearestUnused(names[i], known, names);
      table.fail("axes",
                 names[i] + " is neither an axis of the device " + printable(device.path) +
                     " nor a standard axis",
                 near.empty() ? "remove it" : "did you mean " + near + "?");
      return false;
    }
    if (std::count(names.begin(), names.end(), names[i]) > 1) {
      table.fail("axes", names[i] + " is listed twice", "list every axis once");
      return false;
    }
  }
  return true;
}

void readLevers(TomlTable& table, LinkedAxes& axes) {
  std::optional<TomlTable> levers = table.optionalTable("lever_m");
  if (!levers) return;
  for (const std::string& name : levers->keys()) {
    const auto at = std::find(axes.names.begin(), axes.names.end(), name);
    const auto i = at - axes.names.begin();
    if (at == axes.names.end() || axes.kinds[i] == AxisKind::kTranslation) {
      levers->fail(name, "is not a rotation among these axes", "remove it");
    } else {
      const double lever_m = levers->number(name, between(-1.0, 1.0, "m"));
      axes.lever_m[i] = levers->isGood(name) ? lever_m : kAnyLever_m;
    }
  }
}

bool every(const LinkedAxes& axes, AxisKind kind) {
  return std::all_of(axes.kinds.begin(), axes.kinds.end(), [&](AxisKind k) { return k == kind; });
}

/// Sum of one quantity over all links.
struct Sum {
  const AxisQuantity& quantity;
  AxisMatrix total;  ///< including the axes' own values on the diagonal
  /// Source of each part: the table and its key.
  struct Part {
    TomlTable table;
    std::string key;
    AxisMatrix matrix;
  };
  std::vector<Part> parts;
};

/// Factors that convert a tip value to the axes' values: the lever arms for a tip key, else 1.
std::vector<double> linkedFactors(const LinkedAxes& axes, const AxisQuantity& quantity,
                                  std::string_view key) {
  if (key == quantity.tip_key) return axes.lever_m;
  return std::vector<double>(axes.names.size(), 1.0);
}

/// Matrix of one key over all axes of the device, in the units of the axes.
AxisMatrix readMatrix(TomlTable& table, const LinkedAxes& axes, const AxisQuantity& quantity,
                      std::string_view key, int device_axes) {
  AxisMatrix out = AxisMatrix::Zero(device_axes, device_axes);
  const std::size_t n = axes.names.size();
  const NumberRule rule = between(-quantity.upper, quantity.upper, unitOfKey(key));
  const std::vector<double> values = table.matrix(key, n, rule);
  if (!table.isGood(key)) return out;
  const std::vector<double> factors = linkedFactors(axes, quantity, key);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < n; ++k) {
      const double there = values[i * n + k], mirrored = values[k * n + i];
      if (there != mirrored) {
        table.fail(key,
                   "is not symmetric: " + axes.names[i] + " to " + axes.names[k] + " is " +
                       formatNumber(there) + ", " + axes.names[k] + " to " + axes.names[i] +
                       " is " + formatNumber(mirrored),
                   "write the same number in both places");
        return AxisMatrix::Zero(device_axes, device_axes);
      }
      const int row = axes.on_device[i], column = axes.on_device[k];
      if (row >= 0 && column >= 0) out(row, column) = there * factors[i] * factors[k];
    }
  }
  return out;
}

/// Reason why a matrix is not positive semidefinite, and the remedy; empty if it is.
struct Refusal {
  std::string problem, remedy;
  Eigen::VectorXd direction;  ///< direction along which the matrix is negative
};
std::optional<Refusal> indefinite(const AxisMatrix& m, const DeviceModel& device) {
  const Eigen::Index n = m.rows();
  const auto name = [&](Eigen::Index i) { return device.axes[i].name; };
  for (Eigen::Index i = 0; i < n; ++i) {
    const bool linked = (m.row(i).array() != 0.0).count() > (m(i, i) != 0.0 ? 1 : 0);
    if (m(i, i) > 0.0 || (m(i, i) == 0.0 && !linked)) continue;
    return Refusal{"is not positive semidefinite: with its own value " + name(i) + " has " +
                       formatNumber(m(i, i)) + " on the diagonal",
                   "give " + name(i) + " more on the diagonal, here or in its [[axes]]",
                   Eigen::VectorXd::Unit(n, i)};
  }
  // Scales the matrix to a unit diagonal, which makes it independent of units.
  Eigen::MatrixXd off = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index k = 0; k < n; ++k) {
      if (i != k && m(i, k) != 0.0) off(i, k) = m(i, k) / std::sqrt(m(i, i) * m(k, k));
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(off);
  const double most = -solver.eigenvalues()[0];
  if (most <= 1.0 + kRounding * static_cast<double>(n)) return std::nullopt;
  Eigen::VectorXd along = solver.eigenvectors().col(0);
  std::vector<std::string> names;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (std::abs(along[i]) > 0.1) names.push_back(name(i));
    if (m(i, i) > 0.0) along[i] /= std::sqrt(m(i, i));
  }
  const double share = std::floor(1000.0 / most) / 1000.0;
  return Refusal{
      "is not positive semidefinite with what the axes have of their own: moved together, " +
          listOf(names) + " would generate energy",
      "multiply the values off the diagonal by " + formatNumber(share) +
          " or less, or raise the diagonal",
      along};
}

void checkSum(Sum& sum, const DeviceModel& device) {
  if (sum.parts.empty()) return;
  const std::optional<Refusal> refusal = indefinite(sum.total, device);
  if (!refusal) return;
  const auto part_of = [&](const Sum::Part& part) {
    return refusal->direction.dot(part.matrix * refusal->direction);
  };
  auto worst =
      std::min_element(sum.parts.begin(), sum.parts.end(),
                       [&](const auto& a, const auto& b) { return part_of(a) < part_of(b); });
  if (worst->table.isGood(worst->key)) {
    worst->table.fail(worst->key, refusal->problem, refusal->remedy);
  }
}

/// Reads `axes` (two or more names) and `lever_m` (a table of tip distances of rotations that
/// differ from the device's). Reports a wrong name and then returns empty.
std::optional<LinkedAxes> readLinkedAxes(TomlTable& table, const DeviceModel& device) {
  LinkedAxes out;
  out.names = table.texts("axes");
  if (table.isGood("axes") && out.names.size() < 2) {
    table.fail("axes", "links nothing", "name two axes or more");
  }
  if (!table.isGood("axes") || !checkNames(table, out.names, device)) {
    table.ignoreUnknownKeys();
    return std::nullopt;
  }
  for (const std::string& name : out.names) {
    const int i = device.axisIndex(name);
    out.on_device.push_back(i);
    if (i < 0) {
      out.kinds.push_back(*knownAxisKind(name));
      out.lever_m.push_back(kAnyLever_m);
    } else {
      const DeviceAxis& axis = device.axes[i];
      out.kinds.push_back(axis.kind);
      out.lever_m.push_back(axis.kind == AxisKind::kTranslation ? 1.0 : axis.lever_arm_m);
    }
  }
  readLevers(table, out);
  return out;
}

/// Key under which the table gives the quantity for these axes: the key for translations, for
/// rotations, or for tips. Mixed axes allow the tip key only. Empty when the quantity is absent;
/// keys of the wrong unit are reported.
std::string_view linkedKey(TomlTable& table, const LinkedAxes& axes, const AxisQuantity& quantity) {
  const bool shifts = every(axes, AxisKind::kTranslation);
  const bool turns = every(axes, AxisKind::kRotation);
  const std::string_view own = shifts  ? quantity.translation_key
                               : turns ? quantity.rotation_key
                                       : quantity.tip_key;
  for (const std::string_view key : {quantity.translation_key, quantity.rotation_key}) {
    if (key == own) continue;
    table.refuse(key, own,
                 shifts  ? "has the wrong unit: these axes are translations"
                 : turns ? "has the wrong unit: these axes are rotations"
                         : "has the wrong unit: these axes are translations and rotations");
  }
  if (shifts) table.refuse(quantity.tip_key, own, "is for rotations that end in a fingertip");
  const bool there = table.allowKey(own);
  if (shifts || !table.allowKey(quantity.tip_key)) return there ? own : std::string_view{};
  if (turns && there) {
    table.refuse(quantity.tip_key, own, "is given twice, at the tip and at the joint");
    return own;
  }
  for (std::size_t i = 0; i < axes.names.size(); ++i) {
    if (axes.lever_m[i] != 0.0) continue;
    table.fail(quantity.tip_key, "needs a lever arm, which " + axes.names[i] + " does not have",
               "add lever_m = { " + axes.names[i] + " = ... }");
    break;
  }
  return quantity.tip_key;
}

/// Reads every `[[links]]`: adds diagonal elements to the person's axes and the others to the
/// links. Reports sums that are not positive semidefinite.
/// @pre config.axes is in the device's order and contains the values of [[axes]]
void readLinks(TomlTable& root, const DeviceModel& device, PatientConfig& config) {
  const int n = device.axisCount();
  std::array<Sum, 3> sums{Sum{kPersonMass, AxisMatrix::Zero(n, n), {}},
                          Sum{kPersonDamping, AxisMatrix::Zero(n, n), {}},
                          Sum{kPersonStiffness, AxisMatrix::Zero(n, n), {}}};
  const std::array<double PatientAxis::*, 3> own{&PatientAxis::mass, &PatientAxis::damping,
                                                 &PatientAxis::stiffness};
  // Sums the matrices of all tables for mass, damping and stiffness.
  for (TomlTable& table : root.tables("links", 0)) {
    const std::optional<LinkedAxes> axes = readLinkedAxes(table, device);
    if (!axes) continue;
    bool any = false, tip = false;
    for (Sum& sum : sums) {
      const std::string_view key = linkedKey(table, *axes, sum.quantity);
      tip = tip || key == sum.quantity.tip_key;
      if (key.empty() || !table.isGood(key)) continue;
      any = true;
      const AxisMatrix part = readMatrix(table, *axes, sum.quantity, key, n);
      sum.parts.push_back({table, std::string(key), part});
      sum.total += part;
    }
    if (table.keys().size() == (table.has("lever_m") ? 2U : 1U)) {
      table.fail("", "links nothing: it gives no mass, damping or stiffness",
                 "give one of them as a matrix, for instance stiffness_tip_n_m");
    } else if (any && !tip && table.has("lever_m")) {
      table.fail("lever_m", "has no effect: no key of this table is given at the tip", "remove it");
    }
  }
  // Adds the diagonals to the axes' own values; the rest are the links.
  std::array<AxisMatrix, 3> links;
  for (std::size_t s = 0; s < sums.size(); ++s) {
    Sum& sum = sums[s];
    for (int i = 0; i < n; ++i) {
      double& value = config.axes[i].*own[s];
      value += sum.total(i, i);
      sum.total(i, i) = value;
    }
    checkSum(sum, device);
    links[s] = sum.total;
    links[s].diagonal().setZero();
  }
  const bool linked =
      std::any_of(links.begin(), links.end(), [](const AxisMatrix& m) { return !m.isZero(0.0); });
  if (linked) config.links = {links[0], links[1], links[2]};
}

// Upper bounds exceed any tremor and any finger; a value in a wrong unit exceeds them.
constexpr AxisQuantity kTremor{"tremor_n", "tremor_nm", "tremor_tip_n", 1, 0.0, 10.0};
constexpr AxisQuantity kTremorAlong{"along_n", "along_nm", "along_tip_n", 1, -10.0, 10.0};
constexpr AxisQuantity kStrength{"strength_n", "strength_nm", "strength_tip_n", 1, 0.0, 1e4, true};
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

/// Refuses an unknown axis. Otherwise a misspelt axis would silently have no simulated person.
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
  axis.strength = readAxisQuantity(table, kStrength, kind, lever_m, axis.strength);
  axis.tremor = readAxisQuantity(table, kTremor, kind, lever_m, 0.0);
  axis.fight = readAxisQuantity(table, kFight, kind, lever_m, 0.0);
  axis.reflex = readReflex(table, kind);
  return axis;
}

/// The table of a habit, such as [tremor]: required if an axis uses it, else refused.
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

/// Reads the effort amplitudes of a tremor that moves several axes together.
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

/// Reads the behaviours. `all`: every axis of the file, including axes of other devices.
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
