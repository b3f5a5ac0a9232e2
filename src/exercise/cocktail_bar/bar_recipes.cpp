#include "exercise/cocktail_bar/bar_parts.hpp"
#include "model/axis_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace wholehand {
namespace {

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

}  // namespace

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
    drink.name = t.text("name");
    (void)checkNewName(t, drink.name, names);
    names.push_back(drink.name);
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

namespace {

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

}  // namespace

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
    checkDrinks(tables[i], parts.levels[i], parts, bar);
  }
}

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

}  // namespace wholehand
