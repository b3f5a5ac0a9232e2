#include "exercise/cocktail_bar/bar_file.hpp"

#include "exercise/cocktail_bar/bar_parts.hpp"
#include "exercise/cocktail_bar/bar_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

namespace wholehand {
namespace {

/// Reads the tables of the file that are independent of others.
void readPlain(TomlTable& root, const DeviceModel& device, Bar& bar) {
  TomlTable wall = root.table("wall");
  readWall(wall, device, bar);
  TomlTable squeeze = root.table("squeeze");
  bar.squeeze.filter_hz = squeeze.number("filter_hz", above(0.0, 1000.0, "Hz"));
  bar.squeeze.full_n = squeeze.number("full_n", above(0.0, 1000.0, "N"));
  bar.squeeze.let_go_n = squeeze.number("let_go_n", above(0.0, 100.0, "N"));
  TomlTable flow = root.table("flow");
  bar.flow.l_per_s_n = flow.number("l_per_s_n", above(0.0, 1.0, "l/(s N)"));
  bar.flow.max_l_s = flow.number("max_l_s", above(0.0, 1.0, "l/s"));
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

Expected<LoadedBar> loadBar(TomlFile& file, const ExerciseSource& source) {
  TomlTable& root = file.root();
  LoadedBar out;
  Bar& bar = out.bar;
  bar.name = source.name;
  bar.level = source.level;
  bar.x_axis = source.device->axisIndex("x");
  readPlain(root, *source.device, bar);
  BarParts parts;
  parts.liquids = readLiquids(root);
  parts.dispensers = readDispensers(root, parts.liquids);
  parts.drinks = readDrinks(root, parts.liquids);
  parts.levels = readLevels(root, parts);
  for (const LevelPart& level : parts.levels) bar.level_names.push_back(level.name);
  checkLevels(root, parts, bar);

  Diagnostics scene_faults;
  if (!source.scene_path.empty()) {
    Expected<SceneModel> scene = loadSceneFile(source.scene_path);
    if (scene) {
      out.scene = std::move(*scene);
      readBodies(root, out.scene, parts, bar);
    } else {
      scene_faults = scene.errors();
    }
  }
  const int levels = static_cast<int>(parts.levels.size());
  Diagnostics faults = file.finish();
  faults.insert(faults.end(), scene_faults.begin(), scene_faults.end());
  if (faults.empty() && (source.level < 1 || source.level > levels)) {
    faults.push_back({source.path, 0, "level", std::to_string(source.level),
                      levels == 1 ? "the exercise has one level"
                                  : fmt::format("the exercise has levels 1 to {}", levels),
                      "choose a level that it has"});
  }
  if (!faults.empty()) return faults;
  takeLevel(parts, bar);
  keepBodies(parts, source.hand->side, bar, out.scene);
  return out;
}

}  // namespace wholehand
