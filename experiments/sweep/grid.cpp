#include "experiments/sweep/grid.hpp"

#include "devices/passport/sealed_file.hpp"
#include "files/toml/toml_file.hpp"
#include "rig/engines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace wholehand {
namespace {

constexpr std::size_t kMostValues = 10'000;  // maximum number of values of one axis
constexpr double kMostWhole = 1e9;

struct TrialRule {
  const char* name;
  std::vector<std::string> figures;
};

const std::vector<TrialRule>& trialRules() {
  static const std::vector<TrialRule> kRules = {
      {"grasp",
       {"held", "faulted", "slip_m", "carry_shift_m", "rotation_rad", "noise_n", "grip_n",
        "tip_force_max_n", "felt_error", "coupling_error_rad"}},
      {"contact",
       {"stable", "certified", "refuted", "margin", "noise_n", "penetration_m", "faulted"}},
      {"play",
       {"completed", "ended", "faulted", "score", "spilt_l", "amount_error_max_l", "time_s"}}};
  return kRules;
}

/// Allowed values of an axis.
struct AxisRule {
  const char* name;
  std::vector<SweepTrial> trials;
  bool text = false;
  std::vector<std::string> words = {};  ///< allowed texts; empty: any
  NumberRule number = {};
  bool whole = false;
};

const std::vector<AxisRule>& axisRules() {
  using enum SweepTrial;
  const std::vector<SweepTrial> all = {kGrasp, kContact, kPlay}, touching = {kGrasp, kContact};
  static const std::vector<AxisRule> kRules = {
      {"hand", all, true},
      {"device", all, true},
      {"rendering", all, true},
      {"patient", all, true},
      {"engine", all, true, engineNames()},
      {"exercise", {kPlay}, true},
      {"level", {kPlay}, false, {}, between(1, 1000), true},
      {"seed", {kPlay}, false, {}, between(0, kMostWhole), true},
      {"object", touching, true, {"cube", "sphere", "cylinder", "disk"}},
      {"posture", touching, true, {"power", "pinch"}},
      {"gravity", {kGrasp}, false, {}, between(0, 1), true},
      {"friction", touching, false, {}, between(0.0, 2.0)},
      {"size", touching, false, {}, between(0.5, 2.0)},
      {"jitter", touching, false, {}, between(0, kMostWhole), true},
      {"stiffness", touching, false, {}, above(0.0, 1000.0)},
      {"adaptive_damping", touching, false, {}, between(0.0, 1000.0)},
      {"device_damping", touching, false, {}, between(0.0, 1000.0)},
      {"delay_ticks", touching, false, {}, between(0, 8), true},
      {"rate_hz", touching, false, {}, between(500.0, 16000.0, "Hz")}};
  return kRules;
}

bool fits(const AxisRule& rule, SweepTrial trial) {
  return std::find(rule.trials.begin(), rule.trials.end(), trial) != rule.trials.end();
}

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : ", ") + word;
  return out;
}

std::string axesOf(SweepTrial trial) {
  std::vector<std::string> names;
  for (const AxisRule& rule : axisRules()) {
    if (fits(rule, trial)) names.emplace_back(rule.name);
  }
  return joined(names);
}

template <class T>
bool repeats(std::vector<T> values) {
  std::sort(values.begin(), values.end());
  return std::adjacent_find(values.begin(), values.end()) != values.end();
}

void checkWords(const AxisRule& rule, const std::vector<std::string>& words, TomlTable& table) {
  for (const std::string& word : words) {
    const bool known = std::find(rule.words.begin(), rule.words.end(), word) != rule.words.end();
    if (!rule.words.empty() && !known) {
      table.fail(rule.name, "has \"" + word + "\"", "each must be one of " + joined(rule.words));
    }
  }
}

SweepAxis readAxis(const AxisRule& rule, TomlTable& table) {
  SweepAxis axis{rule.name, {}, {}};
  if (rule.text) {
    axis.names = table.texts(rule.name);
    if (axis.names.empty() && table.isGood(rule.name)) {
      table.fail(rule.name, "has no value", "name at least one");
    }
    checkWords(rule, axis.names, table);
  } else {
    axis.numbers = table.numbersUpTo(rule.name, kMostValues, rule.number);
    const bool whole = std::all_of(axis.numbers.begin(), axis.numbers.end(),
                                   [](double x) { return std::floor(x) == x; });
    if (rule.whole && !whole) {
      table.fail(rule.name, "has a fraction", "each must be a whole number");
    }
  }
  if (repeats(axis.names) || repeats(axis.numbers)) {
    table.fail(rule.name, "has a value twice", "each cell is run once: remove one of them");
  }
  return axis;
}

std::vector<SweepAxis> readAxes(SweepTrial trial, TomlTable& table) {
  std::vector<SweepAxis> axes;
  for (const std::string& key : table.keys()) {
    const auto& rules = axisRules();
    const auto found = std::find_if(rules.begin(), rules.end(),
                                    [&](const AxisRule& rule) { return key == rule.name; });
    if (found == rules.end() || !fits(*found, trial)) {
      table.allowKey(key);
      table.fail(key, std::string("is no axis of the trial ") + trialName(trial),
                 "the axes are " + axesOf(trial));
    } else {
      axes.push_back(readAxis(*found, table));
    }
  }
  if (axes.empty()) table.fail("", "has no axis", "name at least one of " + axesOf(trial));
  return axes;
}

/// Values of an axis of words; its default if the grid lacks it.
std::vector<std::string> wordsOf(const std::vector<SweepAxis>& axes, const char* name,
                                 const char* otherwise) {
  for (const SweepAxis& axis : axes) {
    if (axis.name == name) return axis.names;
  }
  return {otherwise};
}

/// Every object is grasped in every posture, and no pinch is tuned for a cylinder or a disk.
void checkPostures(const std::vector<SweepAxis>& axes, TomlTable& table) {
  const std::vector<std::string> postures = wordsOf(axes, "posture", "power");
  if (std::find(postures.begin(), postures.end(), "pinch") == postures.end()) return;
  for (const std::string& object : wordsOf(axes, "object", "cylinder")) {
    if (object != "cylinder" && object != "disk") continue;
    table.fail(
        "posture", "has \"pinch\", which is not known for the object " + object,
        "pinch takes object = [\"sphere\", \"cube\"]; other objects need a grid of their own");
  }
}

int indexOf(const std::vector<SweepAxis>& axes, TomlTable& map, const char* key) {
  const std::string name = map.text(key);
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (axes[i].name == name) return static_cast<int>(i);
  }
  if (map.isGood(key)) map.fail(key, "is no axis of this grid", "name a key of [axes]");
  return 0;
}

std::vector<SweepMap> readMaps(const SweepGrid& grid, TomlTable& root) {
  std::vector<SweepMap> maps;
  for (TomlTable& table : root.tables("maps", 0)) {
    SweepMap map;
    map.figure = table.choice("figure", figuresOf(grid.trial));
    map.rows = indexOf(grid.axes, table, "rows");
    map.columns = indexOf(grid.axes, table, "columns");
    if (map.rows == map.columns && grid.axes.size() > 1 && table.isGood("columns")) {
      table.fail("columns", "is the axis of the rows, too", "name another axis");
    }
    maps.push_back(map);
  }
  return maps;
}

}  // namespace

std::string SweepAxis::label(int index) const {
  return names.empty() ? fmt::format("{}", numbers.at(index)) : names.at(index);
}

int SweepGrid::cells() const {
  int count = 1;
  for (const SweepAxis& axis : axes) count *= axis.size();
  return count;
}

std::vector<int> SweepGrid::places(int cell) const {
  std::vector<int> out(axes.size());
  for (std::size_t i = axes.size(); i-- > 0;) {
    out[i] = cell % axes[i].size();
    cell /= axes[i].size();
  }
  return out;
}

std::string SweepGrid::describe(int cell) const {
  const std::vector<int> at = places(cell);
  std::string out;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    out += (i == 0 ? "" : ", ") + axes[i].name + " " + axes[i].label(at[i]);
  }
  return out;
}

std::vector<std::string> figuresOf(SweepTrial trial) {
  return trialRules().at(static_cast<std::size_t>(trial)).figures;
}

const char* trialName(SweepTrial trial) {
  return trialRules().at(static_cast<std::size_t>(trial)).name;
}

Expected<SweepGrid> loadSweepGrid(const std::string& path) {
  TomlFile file(path, "sweep");
  if (!file.readable()) return file.finish();
  SweepGrid grid;
  grid.path = path;
  TomlTable& root = file.root();
  grid.name = root.text("name");
  std::vector<std::string> trials;
  for (const TrialRule& rule : trialRules()) trials.emplace_back(rule.name);
  const std::string trial = root.choice("trial", trials);
  grid.trial =
      static_cast<SweepTrial>(std::find(trials.begin(), trials.end(), trial) - trials.begin());
  if (grid.trial == SweepTrial::kGrasp) {
    grid.hold_s = root.number("hold_s", between(0.1, 600.0, "s"), grid.hold_s);
  }
  TomlTable axes = root.table("axes");
  grid.axes = readAxes(grid.trial, axes);
  if (grid.trial != SweepTrial::kPlay) checkPostures(grid.axes, axes);
  double cells = 1.0;
  for (const SweepAxis& axis : grid.axes) cells *= std::max(1, axis.size());
  if (cells > SweepGrid::kMostCells) {
    axes.fail("", fmt::format("has {:.0f} cells", cells),
              fmt::format("at most {} in one grid: split it", SweepGrid::kMostCells));
  }
  grid.maps = readMaps(grid, root);
  if (Diagnostics faults = file.finish(); !faults.empty()) return faults;
  auto text = readWhole(path);
  if (!text) return text.errors();
  grid.text = std::move(*text);
  return grid;
}

}  // namespace wholehand
