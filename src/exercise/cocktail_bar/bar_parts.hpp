#pragma once

#include "exercise/cocktail_bar/bar.hpp"
#include "model/device_model.hpp"
#include "model/toml/toml_file.hpp"

#include <string>
#include <vector>

/// Tables of a bar's file. Private to bar_*.cpp.
namespace wholehand {

/// A step as in the file; its dispenser depends on the level.
struct StepPart {
  int liquid = -1;
  double amount_l = 0.0;
};
struct DrinkPart {
  std::string name;
  std::vector<StepPart> steps;
  bool sound = true;  ///< no faults in its steps
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

// Each function reports faults of its table to the file and returns valid defaults.
void readWall(TomlTable& wall, const DeviceModel& device, Bar& bar);
void readGlass(TomlTable& table, BarGlass& glass);
void readRow(TomlTable& table, BarRow& row);
void readDrawnBack(TomlTable& table, BarDrawnBack& drawn_back);
void readUpset(TomlTable& table, BarTipOver& upset);
void readScoring(TomlTable& table, BarScoring& scoring);
[[nodiscard]] std::vector<BarLiquid> readLiquids(TomlTable& root);
[[nodiscard]] std::vector<BarDispenser> readDispensers(TomlTable& root,
                                                       const std::vector<BarLiquid>& liquids);
[[nodiscard]] std::vector<DrinkPart> readDrinks(TomlTable& root,
                                                const std::vector<BarLiquid>& liquids);
[[nodiscard]] std::vector<LevelPart> readLevels(TomlTable& root, const BarParts& parts);

/// Cross-checks tables: every drink of a level can be poured with the level's dispensers.
void checkLevels(TomlTable& root, const BarParts& parts, const Bar& bar);

/// Applies the level to the bar. @pre no faults were reported, bar.level is one of the levels
void takeLevel(const BarParts& parts, Bar& bar);

}  // namespace wholehand
