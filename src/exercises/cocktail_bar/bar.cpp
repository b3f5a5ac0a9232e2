#include "exercises/cocktail_bar/bar.hpp"

#include "exercises/bottle_file.hpp"
#include "exercises/finger_wall_file.hpp"
#include "exercises/player_reach.hpp"
#include "files/device/axis_keys.hpp"
#include "files/toml/toml_file.hpp"
#include "loop/core/geometry.hpp"
#include "loop/model/device_model.hpp"
#include "loop/model/hand_model.hpp"
#include "loop/model/scene_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {

namespace {

/// A step as the file states it; the level decides its dispenser.
struct StepPart {
  int liquid = -1;
  double amount_l = 0.0;
};
struct DrinkPart {
  std::string name;
  std::vector<StepPart> steps;
  bool sound = true;  ///< its steps have no faults
};
struct LevelPart {
  std::string name;
  std::vector<int> dispensers;  ///< indices into BarParts::dispensers
  std::vector<int> drinks;      ///< indices into BarParts::drinks
  double tolerance_l = 0.0;
  double threshold_n = 0.0, low_n = 0.0, high_n = 0.0;
};
struct BarParts {
  std::vector<BarLiquid> liquids;
  std::vector<BarDispenser> dispensers;  ///< dispensers of all levels
  std::vector<DrinkPart> drinks;
  std::vector<LevelPart> levels;
};

bool isColor(const std::string& text) {
  return text.size() == 7 && text[0] == '#' &&
         std::all_of(text.begin() + 1, text.end(),
                     [](unsigned char c) { return std::isxdigit(c) != 0; });
}

// Every reader reports faults of its table to the file and returns valid defaults.

void readWall(TomlTable& wall, const DeviceModel& device, Bar& bar) {
  FingerWallFile file = readFingerWalls(wall, device);
  bar.lead_in_m = file.lead_in_m;
  bar.transition = file.transition;
  bar.walls = file.walls;
  bar.effort_limit = file.effort_limit;
}

void readGlass(TomlTable& table, BarGlass& glass) {
  glass.body = table.text("body");
  glass.inner_radius_m = table.number("inner_radius_m", above(0.0, 1.0, "m"));
  glass.m_per_l = table.number("m_per_l", above(0.0, 10.0, "m/l"));
  glass.capacity_l = table.number("capacity_l", above(0.0, 10.0, "l"));
  glass.slide_s = table.number("slide_s", between(0.1, 10.0, "s"));
}

void readRow(TomlTable& table, BarRow& row) {
  row.slides = true;
  row.spacing_m = table.number("spacing_m", above(0.0, 1.0, "m"));
  const std::array<double, 2> reach = table.interval("reach_y_m", between(-1.0, 1.0, "m"));
  row.reach_lower_m = reach[0];
  row.reach_upper_m = reach[1];
  row.speed_m_s = table.number("speed_m_s", between(0.01, 0.5, "m/s"));
}

void readDrawnBack(TomlTable& table, BarDrawnBack& drawn_back) {
  drawn_back.x_m = table.number("x_m", between(-1.0, 1.0, "m"));
  drawn_back.palm_m = table.number("palm_m", between(0.0, 1.0, "m"));
}

void readUpset(TomlTable& table, BarTipOver& upset) {
  upset.tilt_rad = table.number("tilt_rad", between(0.1, std::numbers::pi, "rad"));
  upset.leak_l_s = table.number("leak_l_s", between(0.0, 1.0, "l/s"));
  upset.stand_up_s = table.number("stand_up_s", between(0.1, 60.0, "s"));
  upset.dropped_m = table.number("dropped_m", between(0.001, 1.0, "m"));
}

void readScoring(TomlTable& table, BarScoring& scoring) {
  scoring.spill_points_per_l = table.number("spill_points_per_l", between(0.0, 1e6, "1/l"));
  scoring.time_points = table.number("time_points", between(0.0, 100.0));
  scoring.par_s = table.number("par_s", above(0.0, 3600.0, "s"));
  scoring.two_stars = table.number("two_stars", between(0.0, 100.0));
  scoring.three_stars = table.number("three_stars", between(0.0, 100.0));
  scoring.rest_s = table.number("rest_s", between(0.0, 600.0, "s"));
  if (table.isGood("two_stars") && table.isGood("three_stars") &&
      scoring.three_stars < scoring.two_stars) {
    table.fail("three_stars", "is less than two_stars", "must be at least two_stars");
  }
}

/// Reads the name of a table and adds it to `names`; reports a name that an earlier table has.
std::string newName(TomlTable& t, std::vector<std::string>& names) {
  std::string name = t.text("name");
  (void)checkNewName(t, name, names);
  names.push_back(name);
  return name;
}

std::vector<BarLiquid> readLiquids(TomlTable& root, const Bottle& bottle) {
  std::vector<BarLiquid> liquids;
  std::vector<std::string> names;
  for (TomlTable& t : root.tables("liquids", 1)) {
    BarLiquid l;
    l.name = newName(t, names);
    l.color = t.text("color");
    if (t.isGood("color") && !isColor(l.color)) {
      t.fail("color", "is not a colour", "must be \"#RRGGBB\", e.g. \"#F6C636\"");
    }
    l.pattern = t.choice("pattern", {"stripes", "dots", "waves", "rings"});
    l.symbol = t.choice("symbol", {"triangle", "circle", "square", "diamond"});
    l.viscosity_pa_s = readLiquid(t, bottle).nozzle.viscosity_pa_s;
    liquids.push_back(l);
  }
  return liquids;
}

/// Index of a name that another table refers to; reports an unknown one and returns -1.
int indexOf(TomlTable& table, std::string_view key, const std::string& name,
            const std::vector<std::string>& names, const std::string& what) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<int>(found - names.begin());
  const std::string near = nearestWord(name, names);
  table.fail(key, "'" + name + "' is not a " + what,
             near.empty() ? "write one of: " + fmt::format("{}", fmt::join(names, ", "))
                          : "did you mean " + near + "?");
  return -1;
}

int liquidOf(TomlTable& table, const std::vector<BarLiquid>& liquids) {
  std::vector<std::string> names;
  for (const BarLiquid& l : liquids) names.push_back(l.name);
  const std::string name = table.text("liquid");
  return table.isGood("liquid") ? indexOf(table, "liquid", name, names, "liquid") : -1;
}

Eigen::Vector3d pointOf(TomlTable& table, std::string_view key) {
  const std::vector<double> p = table.numbers(key, 3, between(-1.0, 1.0, "m"));
  return {p[0], p[1], p[2]};
}

/// Indices of the names of a list.
std::vector<int> indicesOf(TomlTable& table, std::string_view key,
                           const std::vector<std::string>& names, const std::string& what) {
  std::vector<int> out;
  for (const std::string& name : table.texts(key)) {
    const int i = indexOf(table, key, name, names, what);
    if (i >= 0) out.push_back(i);
  }
  if (table.isGood(key) && out.empty()) table.fail(key, "is empty", "name one at least");
  return out;
}

/// The level's dispenser of a liquid, as an index into its list; -1: none.
int dispenserWith(int liquid, const LevelPart& level, const BarParts& parts) {
  for (std::size_t i = 0; i < level.dispensers.size(); ++i) {
    const int at = level.dispensers[i];
    if (parts.dispensers[at].liquid == liquid) return static_cast<int>(i);
  }
  return -1;
}

void checkDispensers(TomlTable& t, const LevelPart& level, const BarParts& parts) {
  for (std::size_t i = 0; i < level.dispensers.size(); ++i) {
    const int at = level.dispensers[i];
    const int first = dispenserWith(parts.dispensers[at].liquid, level, parts);
    if (parts.dispensers[at].liquid >= 0 && first != static_cast<int>(i)) {
      t.fail("dispensers", "two of them hold the same liquid",
             "give each liquid one dispenser of the level");
    }
  }
}

/// Checks a level's drinks against its dispensers and the glass.
void checkDrinks(TomlTable& t, const LevelPart& level, const BarParts& parts, const Bar& bar) {
  std::map<int, double> asked_l;  // required volume of each liquid in the level
  // Checks each drink: its dispensers, the tolerance and the glass.
  for (const int index : level.drinks) {
    const DrinkPart& drink = parts.drinks[index];
    if (!drink.sound) continue;
    double full_l = 0.0;
    for (const StepPart& step : drink.steps) {
      full_l += step.amount_l + level.tolerance_l;
      asked_l[step.liquid] += step.amount_l + level.tolerance_l;
      if (dispenserWith(step.liquid, level, parts) < 0) {
        const int liquid = step.liquid;
        t.fail("drinks",
               "no dispenser of the level holds the " + parts.liquids[liquid].name + " of '" +
                   drink.name + "'",
               "add its dispenser, or take the drink out");
      }
      if (level.tolerance_l >= step.amount_l) {
        t.fail("tolerance_l", "is not less than a step of '" + drink.name + "' ",
               "must be less, else pouring nothing would count");
      }
    }
    if (full_l > bar.glass.capacity_l && bar.glass.capacity_l > 0.0) {
      t.fail(
          "drinks", "'" + drink.name + "' does not fit into the glass with its tolerances",
          fmt::format("its steps may add up to {} l at most", formatNumber(bar.glass.capacity_l)));
    }
  }
  // Checks that each dispenser holds enough for all drinks of the level.
  for (const auto& [liquid, volume_l] : asked_l) {
    const int at = dispenserWith(liquid, level, parts);
    if (at < 0) continue;
    const int d = level.dispensers[at];
    if (parts.dispensers[d].start_l < volume_l) {
      t.fail("drinks",
             "need more of a liquid than start_l of the dispenser " + parts.dispensers[d].body,
             fmt::format("it must hold {} l at least", formatNumber(volume_l)));
    }
  }
}

std::vector<BarDispenser> readDispensers(TomlTable& root, const std::vector<BarLiquid>& liquids) {
  std::vector<BarDispenser> dispensers;
  for (TomlTable& t : root.tables("dispensers", 1)) {
    BarDispenser d;
    d.body = t.text("body");
    d.liquid = liquidOf(t, liquids);
    d.start_l = t.number("start_l", between(0.001, 10.0, "l"));
    d.nozzle_m = pointOf(t, "nozzle_m");
    d.grip_m = pointOf(t, "grip_m");
    for (const BarDispenser& other : dispensers) {
      if (t.isGood("body") && other.body == d.body) {
        t.fail("body", "is the body of two dispensers", "give every dispenser its own");
      }
    }
    dispensers.push_back(d);
  }
  return dispensers;
}

std::vector<DrinkPart> readDrinks(TomlTable& root, const std::vector<BarLiquid>& liquids) {
  std::vector<DrinkPart> drinks;
  std::vector<std::string> names;
  for (TomlTable& t : root.tables("drinks", 1)) {
    DrinkPart drink;
    drink.name = newName(t, names);
    for (TomlTable& s : t.tables("steps", 1)) {
      drink.steps.push_back({liquidOf(s, liquids), s.number("amount_l", above(0.0, 10.0, "l"))});
      drink.sound = drink.sound && drink.steps.back().liquid >= 0 && s.isGood("amount_l");
    }
    if (drink.steps.size() > std::size_t{kMaxSteps}) {
      t.fail("steps", fmt::format("there are {} steps", drink.steps.size()),
             fmt::format("a drink may have {} at most", kMaxSteps));
    }
    drinks.push_back(drink);
  }
  return drinks;
}

std::vector<LevelPart> readLevels(TomlTable& root, const BarParts& parts) {
  std::vector<std::string> bodies, drinks;
  for (const BarDispenser& d : parts.dispensers) bodies.push_back(d.body);
  for (const DrinkPart& d : parts.drinks) drinks.push_back(d.name);
  std::vector<LevelPart> levels;
  const NumberRule force = between(0.0, 1000.0, "N");
  for (TomlTable& t : root.tables("levels", 1)) {
    LevelPart level;
    level.name = t.text("name");
    level.dispensers = indicesOf(t, "dispensers", bodies, "dispenser");
    level.drinks = indicesOf(t, "drinks", drinks, "drink");
    level.tolerance_l = t.number("tolerance_l", above(0.0, 1.0, "l"));
    level.threshold_n = t.number("threshold_n", force);
    level.low_n = t.number("low_n", force);
    level.high_n = t.number("high_n", force);
    if (t.isGood("threshold_n") && t.isGood("low_n") && level.low_n < level.threshold_n) {
      t.fail("low_n", "is below threshold_n: within the target nothing would flow",
             "must be at least threshold_n");
    }
    if (t.isGood("low_n") && t.isGood("high_n") && !(level.high_n > level.low_n)) {
      t.fail("high_n", "is not above low_n", "must be more than low_n");
    }
    if (level.dispensers.size() > std::size_t{kMaxDispensers}) {
      t.fail("dispensers", fmt::format("there are {}", level.dispensers.size()),
             fmt::format("a level may have {} at most", kMaxDispensers));
    }
    levels.push_back(level);
  }
  return levels;
}

/// Checks that a squeeze in the zone presses out enough liquid. The stroke of every digit is A (f −
/// p₀)/k_s, at which the shell's return spring balances the force.
void checkStroke(TomlTable& t, const LevelPart& level, const Bar& bar) {
  constexpr double kLeast_ml = 5.0;
  double shut_n = 0.0;
  for (int a = 0; a < bar.walls.axes; ++a) {
    if (bar.walls.stiffness[a] > 0.0) shut_n += bar.bottle.opening_n;
  }
  const double stroke_ml =
      1e6 * bar.bottle.area_m2 * (level.high_n - shut_n) / bar.bottle.return_n_m;
  if (!t.isGood("high_n") || !(stroke_ml < kLeast_ml)) return;
  t.fail("high_n", fmt::format("presses out {:.1f} ml a stroke", std::max(0.0, stroke_ml)),
         fmt::format("must press out {:g} ml at least: raise it or area_m2, or lower return_n_m",
                     kLeast_ml));
}

/// Checks across tables that every drink of a level can be poured with the level's dispensers.
void checkLevels(TomlTable& root, const BarParts& parts, const Bar& bar) {
  if (!root.isGood("levels")) return;
  std::vector<TomlTable> tables = root.tables("levels", 1);
  for (std::size_t i = 0; i < tables.size() && i < parts.levels.size(); ++i) {
    const auto unknown = [&parts](int d) { return parts.dispensers[d].liquid < 0; };
    const std::vector<int>& have = parts.levels[i].dispensers;
    if (!tables[i].isGood("dispensers") || !tables[i].isGood("drinks") ||
        !tables[i].isGood("tolerance_l") || std::any_of(have.begin(), have.end(), unknown)) {
      continue;
    }
    checkDispensers(tables[i], parts.levels[i], parts);
    checkStroke(tables[i], parts.levels[i], bar);
    checkDrinks(tables[i], parts.levels[i], parts, bar);
  }
}

/// Applies the level to the bar. @pre no faults were reported, bar.level is one of the levels
void takeLevel(const BarParts& parts, Bar& bar) {
  const LevelPart& level = parts.levels[bar.level - 1];
  bar.squeeze.threshold_n = level.threshold_n;
  bar.squeeze.low_n = level.low_n;
  bar.squeeze.high_n = level.high_n;
  bar.liquids = parts.liquids;
  for (const int i : level.dispensers) {
    bar.dispensers.push_back(parts.dispensers[i]);
  }
  for (const int i : level.drinks) {
    const DrinkPart& part = parts.drinks[i];
    BarDrink drink{part.name, {}};
    for (const StepPart& step : part.steps) {
      drink.steps.push_back(
          {dispenserWith(step.liquid, level, parts), step.amount_l, level.tolerance_l});
    }
    bar.drinks.push_back(std::move(drink));
  }
}

/// z of the upper (+1) or lower (-1) side of a box.
double sideOf(TomlTable& root, const std::string& name, double side, const SceneModel& scene) {
  const int i = scene.bodyIndex(name);
  if (i >= 0) {
    const SceneBody& body = scene.bodies[i];
    if (body.shapes.size() == 1 && body.shapes[0].kind().has_extents) {
      return body.pose.translation_m.z() + side * body.shapes[0].half_extents_m.z();
    }
  }
  root.fail("scene", "has no box named " + name, "add it: the page draws the bar from it");
  return 0.0;
}

/// Finds the bodies that the file names and takes their dimensions; reports those that do not fit.
void readBodies(TomlTable& root, const SceneModel& scene, BarParts& parts, Bar& bar) {
  bar.counter_z_m = sideOf(root, "counter", 1.0, scene);
  bar.rail_z_m = sideOf(root, "rail", -1.0, scene);
  if (!root.isGood("glass") || !root.isGood("dispensers")) return;
  TomlTable glass = root.table("glass");
  if (glass.isGood("body")) {
    const int glass_body = uprightCylinder(glass, "body", bar.glass.body, scene, false);
    if (glass_body >= 0) {
      const SceneBody* body = &scene.bodies[glass_body];
      bar.glass.radius_m = body->shapes[0].radius_m;
      bar.glass.height_m = body->shapes[0].length_m;
      if (!body->fixed)
        glass.fail("body", "is not fixed", "write fixed = true: the exercise moves it");
      if (bar.glass.inner_radius_m > bar.glass.radius_m) {
        glass.fail("inner_radius_m", "is more than the body's radius", "must be less");
      }
      if (bar.glass.capacity_l * bar.glass.m_per_l > bar.glass.height_m) {
        glass.fail(
            "capacity_l", "stands higher than the glass, at m_per_l",
            "must be " + formatNumber(bar.glass.height_m / bar.glass.m_per_l) + " l at most");
      }
    }
  }
  std::vector<TomlTable> tables = root.tables("dispensers", 1);
  for (std::size_t i = 0; i < tables.size() && i < parts.dispensers.size(); ++i) {
    if (!tables[i].isGood("body")) continue;
    BarDispenser& d = parts.dispensers[i];
    const int index = uprightCylinder(tables[i], "body", d.body, scene, false);
    if (index < 0) continue;
    const SceneBody* body = &scene.bodies[index];
    d.radius_m = body->shapes[0].radius_m;
    d.height_m = body->shapes[0].length_m;
    d.soft_m = body->soft_m;
    bar.walls.soft_m = std::max(bar.walls.soft_m, d.soft_m);
    d.free = !body->fixed;
    const bool narrow = bar.row.slides && bar.row.spacing_m < 2.0 * d.radius_m;
    if (narrow && root.table("row").isGood("spacing_m")) {  // reports it once
      root.table("row").fail("spacing_m", "is less than the width of " + d.body, "must be more");
    }
    if (d.free && bar.row.slides) {
      tables[i].fail("body", "is not fixed: it cannot slide in a row",
                     "set fixed = true in the scene, or take the table [row] out");
    }
  }
}

/// Keeps only the level's dispensers, in row order, puts the glass under the first nozzle (for
/// fixed dispensers), and sets body indices and initial places. For a left hand reach and places
/// are mirrored in y. @pre no faults were reported
void keepBodies(const BarParts& parts, Side side, Bar& bar, SceneModel& scene) {
  const double mirror = side == Side::kLeft ? -1.0 : 1.0;
  if (side == Side::kLeft) {
    bar.row.reach_lower_m = -std::exchange(bar.row.reach_upper_m, -bar.row.reach_lower_m);
  }
  std::vector<SceneBody> kept;
  for (SceneBody& body : scene.bodies) {
    const auto is = [&body](const BarDispenser& d) { return d.body == body.name; };
    const bool any = std::any_of(parts.dispensers.begin(), parts.dispensers.end(), is);
    const bool wanted = std::any_of(bar.dispensers.begin(), bar.dispensers.end(), is);
    if (wanted || !any) kept.push_back(std::move(body));
  }
  scene.bodies = std::move(kept);
  // A single dispenser hangs in the middle of the reach; several start at its lower end.
  const BarRow& row = bar.row;
  const double first_y_m = bar.dispensers.size() == 1
                               ? 0.5 * (row.reach_lower_m + row.reach_upper_m)
                               : row.reach_lower_m;
  for (std::size_t i = 0; i < bar.dispensers.size(); ++i) {
    BarDispenser& d = bar.dispensers[i];
    d.body_index = scene.bodyIndex(d.body);
    SceneBody& body = scene.bodies[d.body_index];
    double& y_m = body.pose.translation_m.y();
    y_m = row.slides ? first_y_m + static_cast<double>(i) * row.spacing_m : mirror * y_m;
    d.home_m = body.pose.translation_m;
  }
  bar.rail_index = scene.bodyIndex("rail");
  bar.rail_home_m = scene.bodies[bar.rail_index].pose.translation_m;
  bar.glass.body_index = scene.bodyIndex(bar.glass.body);
  const BarDispenser& first = bar.dispensers[bar.drinks[0].steps[0].dispenser];
  Eigen::Vector3d& glass_m = scene.bodies[bar.glass.body_index].pose.translation_m;
  glass_m.y() *= mirror;
  if (!first.free) glass_m.head<2>() = (first.home_m + first.nozzle_m).head<2>();
}

/// Reads the tables that do not depend on other tables.
void readPlain(TomlTable& root, const DeviceModel& device, Bar& bar) {
  TomlTable wall = root.table("wall");
  readWall(wall, device, bar);
  TomlTable squeeze = root.table("squeeze");
  bar.squeeze.filter_hz = squeeze.number("filter_hz", above(0.0, 1000.0, "Hz"));
  bar.squeeze.full_n = squeeze.number("full_n", above(0.0, 1000.0, "N"));
  bar.squeeze.let_go_n = squeeze.number("let_go_n", above(0.0, 100.0, "N"));
  TomlTable bottle = root.table("bottle");
  bar.bottle = readBottle(bottle);
  TomlTable glass = root.table("glass");
  readGlass(glass, bar.glass);
  if (std::optional<TomlTable> row = root.optionalTable("row")) readRow(*row, bar.row);
  TomlTable drawn_back = root.table("drawn_back");
  readDrawnBack(drawn_back, bar.drawn_back);
  if (std::optional<TomlTable> upset = root.optionalTable("upset")) readUpset(*upset, bar.upset);
  TomlTable score = root.table("score");
  readScoring(score, bar.scoring);
}

}  // namespace

double thinnest_pa_s(const std::vector<BarLiquid>& liquids) {
  double least = HUGE_VAL;
  for (const BarLiquid& l : liquids) least = std::min(least, l.viscosity_pa_s);
  return least;
}

Expected<Bar> loadBar(TomlFile& file, const ExerciseSource& source) {
  TomlTable& root = file.root();
  Bar bar;
  bar.name = source.name;
  bar.level = source.level;
  bar.x_axis = source.device->axisIndex("x");
  readPlain(root, *source.device, bar);
  BarParts parts;
  parts.liquids = readLiquids(root, bar.bottle);
  parts.dispensers = readDispensers(root, parts.liquids);
  parts.drinks = readDrinks(root, parts.liquids);
  parts.levels = readLevels(root, parts);
  for (const LevelPart& level : parts.levels) bar.level_names.push_back(level.name);
  checkLevels(root, parts, bar);
  if (source.scene != nullptr) readBodies(root, *source.scene, parts, bar);
  const int levels = static_cast<int>(parts.levels.size());
  Diagnostics faults = file.finish();
  if (faults.empty() && source.scene != nullptr && (source.level < 1 || source.level > levels)) {
    faults.push_back(keyFault(source.path, "level", std::to_string(source.level),
                              levels == 1 ? "the exercise has one level"
                                          : fmt::format("the exercise has levels 1 to {}", levels),
                              "choose a level that it has"));
  }
  if (!faults.empty() || source.scene == nullptr) return faults;
  takeLevel(parts, bar);
  keepBodies(parts, source.hand->side, bar, *source.scene);
  return bar;
}

BarLayout makeBarLayout(const Bar& bar, const DeviceModel& device, const HandModel* hand) {
  BarLayout layout;
  double radius_m = 0.0;
  for (const BarDispenser& d : bar.dispensers) {
    if (layout.dispenser_count == kMaxDispensers) break;
    layout.dispensers[layout.dispenser_count++] = {d.body_index, d.grip_m, d.nozzle_m, d.free};
    radius_m = std::max(radius_m, d.radius_m);
  }
  static_cast<PlayerReach&>(layout) = playerReach(device, hand, radius_m);
  layout.glass_body = bar.glass.body_index;
  layout.glass_top_m = 0.5 * bar.glass.height_m;
  return layout;
}

BarReach reachOf(const BarLayout& layout, double slack_m) noexcept {
  BarReach reach;
  const std::array<int, 3> axes = {layout.x, layout.y, layout.z};
  for (int k = 0; k < 3; ++k) {
    const int axis = axes[k];
    if (axis < 0) continue;
    reach.lower_m[k] = layout.lower[axis] + layout.grip_m[k] - slack_m;
    reach.upper_m[k] = layout.upper[axis] + layout.grip_m[k] + slack_m;
  }
  return reach;
}

namespace {

constexpr double kRamp_s = 1.0;  // ramp time of a parameter over its whole range
/// Lateral offset of the hand's path beside a dispenser, on the side of the back of the hand. The
/// pages use the same value.
constexpr double kLane_m = 0.024;
/// Least reach to the side and forward. A dispenser needs room beside the hand; the half-bent
/// fingers of a withdrawn hand must clear the row, or the sliding row stops.
constexpr double kLeastAside_m = 0.03, kLeastForward_m = 0.06;
/// Limits of the finger range: a bottle is gripped at about 131 degrees, and half-bent fingers pass
/// beside it.
constexpr double kLeastClosed_rad = 140.0 * kDeg, kMostOpen_rad = 45.0 * kDeg;
constexpr double kFinest_l = 0.001, kWidest_l = 0.012;
constexpr double kShortestFade_s = 0.3, kLongestFade_s = 5.0;

LiveParameter ranged(const char* name, const char* unit, double lower, double upper, double value) {
  lower = std::min(lower, value);
  upper = std::max(upper, value);
  return {name, unit, lower, upper, value, (upper - lower) / kRamp_s};
}

}  // namespace

BarParameters::BarParameters(const Bar& bar, const BarLayout& layout, const DeviceModel& whole)
    : row_(bar.row),
      beside_(layout.beside),
      grip_x_m_(bar.dispensers.front().home_m.x() + bar.dispensers.front().grip_m.x() -
                layout.grip_m.x()),
      grip_y_m_(bar.dispensers.front().grip_m.y() - layout.grip_m.y()) {
  all_ = {{"wall_stiffness_ratio", "1", 0.0, kLargestWallRatio, 1.0, 0.5},
          {"viscosity_ratio", "1", kThinnestRatio, kThickestRatio, 1.0, 0.5},
          {"lead_in_m", "m", 0.0, kLargestLeadIn_m, bar.lead_in_m, 0.005},
          {"squeeze_threshold_ratio", "1", 0.25, 2.0, 1.0, 0.5},
          ranged("line_tolerance_l", "l", kFinest_l, kWidest_l,
                 bar.drinks.front().steps.front().tolerance_l),
          ranged("wall_fade_s", "s", kShortestFade_s, kLongestFade_s, bar.transition.engage_s)};
  if (layout.y >= 0) {
    most_left_m_ = layout.upper[layout.y], most_right_m_ = -layout.lower[layout.y];
    const DeviceAxis& y = whole.axes[layout.y];
    left_ = add(ranged("reach_left_m", "m", kLeastAside_m, y.upper, most_left_m_));
    right_ = add(ranged("reach_right_m", "m", kLeastAside_m, -y.lower, most_right_m_));
  }
  if (layout.x >= 0) {
    most_forward_m_ = layout.upper[layout.x];
    forward_ = add(ranged("reach_forward_m", "m", kLeastForward_m, whole.axes[layout.x].upper,
                          most_forward_m_));
  }
  if (layout.fingers >= 0) {
    const DeviceAxis& fingers = whole.axes[layout.fingers];
    add(ranged("fingers_open_rad", "rad", fingers.lower, kMostOpen_rad,
               layout.lower[layout.fingers]));
    add(ranged("fingers_close_rad", "rad", kLeastClosed_rad, fingers.upper,
               layout.upper[layout.fingers]));
  }
}

int BarParameters::add(LiveParameter parameter) {
  all_.push_back(std::move(parameter));
  return static_cast<int>(all_.size()) - 1;
}

RowReach BarParameters::reach(const double* v) const noexcept {
  RowReach out{row_.reach_lower_m, row_.reach_upper_m, 0.0};
  if (left_ >= 0) {
    // The hand moves between its path beside the dispenser, on the side of its back, and the grip.
    const double lane_left_m = beside_ < 0.0 ? kLane_m : 0.0;
    const double lane_right_m = beside_ > 0.0 ? kLane_m : 0.0;
    const double lower_m = -std::min(v[right_], most_right_m_) + lane_right_m - grip_y_m_;
    const double upper_m = std::min(v[left_], most_left_m_) - lane_left_m - grip_y_m_;
    const double middle_m =
        std::clamp(0.5 * (lower_m + upper_m), row_.reach_lower_m, row_.reach_upper_m);
    out.lower_m = std::clamp(lower_m, row_.reach_lower_m, middle_m);
    out.upper_m = std::clamp(upper_m, middle_m, row_.reach_upper_m);
  }
  if (forward_ >= 0 && row_.slides)
    out.nearer_m = std::max(0.0, grip_x_m_ - std::min(v[forward_], most_forward_m_));
  return out;
}

}  // namespace wholehand
