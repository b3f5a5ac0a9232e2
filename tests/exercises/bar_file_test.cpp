#include "exercises/bar_table.hpp"
#include "support/contains.hpp"
#include "support/file_bytes.hpp"
#include "support/folder.hpp"
#include "support/toml_lines.hpp"

#include <set>

namespace wholehand::test {
namespace {

/// A folder with the shipped exercise and its scene, either of them changed.
class FaultyBar {
 public:
  void inBar(const std::string& find, const std::string& with) { bar = replaced(bar, find, with); }
  void inScene(const std::string& find, const std::string& with) {
    scene = replaced(scene, find, with);
  }

  [[nodiscard]] Diagnostics faults(int level = 1) const {
    const Folder folder;
    folder.write("scenes/cocktail-bar.toml", scene);
    const std::string path = folder.write("exercises/bar.toml", bar);
    const auto loaded = loadExercise(path, level, shippedDevice(), shippedHand());
    return loaded.ok() ? Diagnostics{} : loaded.errors();
  }

  std::string bar = bytesOfFile(config("exercises/cocktail-bar.toml"));
  std::string scene = bytesOfFile(config("scenes/cocktail-bar.toml"));
};

struct Case {
  std::string find, replace, key, expected, remedy;
};

void expectOneFault(const FaultyBar& faulty, const Case& c) {
  SCOPED_TRACE(c.find + " -> " + c.replace);
  const Diagnostics faults = faulty.faults();
  ASSERT_EQ(faults.size(), 1U) << format(faults);
  EXPECT_EQ(faults[0].key, c.key);
  EXPECT_TRUE(contains(format(faults[0]), c.expected));
  EXPECT_TRUE(contains(faults[0].remedy, c.remedy)) << format(faults[0]);
  EXPECT_GT(faults[0].line, 0);
  EXPECT_TRUE(faults[0].file.ends_with("bar.toml"));
}

TEST(BarFile, AsShipped_HasNoFault) {
  const FaultyBar bar;
  for (int level = 1; level <= 4; ++level) {
    EXPECT_TRUE(bar.faults(level).empty()) << format(bar.faults(level));
  }
}

TEST(BarFile, MissingKey_IsReported) {
  FaultyBar bar;
  const std::vector<std::string> lines = linesOf(bar.bar);
  const auto keys = keyLines(lines);
  EXPECT_GT(keys.size(), 90U);
  for (const auto& [line, key, value] : keys) {
    // These keys have defaults: the transition times of equations.md and the walls' speed.
    if (key == "engage_s" || key == "release_s" || key == "follow_m_s") continue;
    // A file may leave out an event, a unit, factor, decimals, goal or result of a value.
    static const std::set<std::string> kOptional = {"unit", "factor", "decimals", "goal", "result"};
    const bool event = static_cast<std::ptrdiff_t>(line) >
                       std::find(lines.begin(), lines.end(), "[panel.events]") - lines.begin();
    if (event || kOptional.contains(key)) continue;
    std::vector<std::string> without = lines;
    without.erase(without.begin() + static_cast<long>(line));
    bar.bar = joined(without);
    // On a rotation with a fingertip, the message names the key without _tip_.
    const std::string named = std::regex_replace(key, std::regex("_tip_n.*"), "_nm");
    EXPECT_TRUE(namesKey(bar.faults(), named)) << lines[line] << "\n" << format(bar.faults());
  }
}

TEST(BarFile, KeyOfAnotherTypeNameOrSize_IsRefused) {
  FaultyBar bar;
  const std::vector<std::string> lines = linesOf(bar.bar);
  auto random = seededRandom(107);
  for (const KeyLine& key : keyLines(lines)) {
    for (const std::string& wrong : wrongLines(key, random)) {
      std::vector<std::string> changed = lines;
      changed[key.line] = wrong;
      bar.bar = joined(changed);
      EXPECT_TRUE(namesKey(bar.faults(), key.key)) << lines[key.line] << " -> " << wrong << "\n"
                                                   << format(bar.faults());
    }
  }
}

TEST(BarFile, WrongValues_AreReportedWithTheirKeyAndRemedy) {
  const std::vector<Case> cases = {
      {"exercise = \"cocktail_bar\"", "exercise = \"coctail_bar\"", "exercise", "unknown",
       "cocktail_bar"},
      {"lead_in_m = 0.0 ", "lead_in_m = 0.05 ", "wall.lead_in_m", "out of range", "0.02"},
      {"release_m = 0.03", "release_m = 0.01", "wall.release_m", "less than engage_m",
       "at least engage_m"},
      // The device's 10 N at the tip, faded by a smoothstep (steepest slope 1.5 / T) of 0.3 s: 10 N
      // 1.5 / 0.3 s 1 ms = 0.05 N per tick at most.
      {"engage_s = 1.0", "engage_s = 0.29", "wall.engage_s", "out of range", "0.3"},
      {"release_s = 0.3", "release_s = 0.29", "wall.release_s", "out of range", "0.3"},
      {"release_s = 0.3", "release_s = 5.1", "wall.release_s", "out of range", "5"},
      {"name = \"finger_flexion\"", "name = \"finger_flexoin\"", "wall.axes[finger_flexoin].name",
       "is neither an axis of the device", "hand axis"},
      {"[[dispensers]]",
       "[[liquids]]\nname = \"lemon\"\ncolor = \"#F6C636\"\npattern = \"stripes\"\n"
       "symbol = \"triangle\"\nviscosity_pa_s = 0.157\n[[dispensers]]",
       "liquids[lemon].name", "is given twice", "name of its own"},
      {"name = \"finger_flexion\"", "name = \"x\"", "wall.axes[x].name", "carries the hand",
       "hand's joints"},
      {"filter_hz = 5.0", "filter_hz = 0.0", "squeeze.filter_hz", "out of range", "Hz"},
      {"return_n_m = 25.0", "return_n_m = 180.0", "levels[Four liquids, narrow tolerance].high_n",
       "presses out 4.9 ml a stroke", "5 ml at least"},
      {"stiffness_tip_n_m = 280.0", "stiffness_tip_n_m = 280.0\ndamping_tip_n_s_m = 0.11",
       "wall.axes[finger_flexion].damping_tip_n_s_m", "no place beside a liquid", "remove it"},
      {"viscosity_pa_s = 0.251", "viscosity_pa_s = 0.001", "liquids[cherry].viscosity_pa_s",
       "not felt", "at least 1 N·s/m"},
      {"body = \"glass\"", "body = \"glas\"", "glass.body", "no such body", "name of one"},
      {"inner_radius_m = 0.03", "inner_radius_m = 0.3", "glass.inner_radius_m",
       "more than the body's radius", "less"},
      {"m_per_l = 1.48", "m_per_l = 7.4", "glass.capacity_l", "higher than the glass", "at most"},
      {"spacing_m = 0.128", "spacing_m = 0.03", "row.spacing_m", "width of", "more"},
      {"reach_y_m = [-0.023, 0.105]", "reach_y_m = [0.105, -0.023]", "row.reach_y_m", "", ""},
      {"three_stars = 90.0", "three_stars = 60.0", "score.three_stars", "less than two_stars",
       "at least"},
      {"color = \"#A31D38\"", "color = \"red\"", "liquids[cherry].color", "not a colour",
       "#RRGGBB"},
      {"pattern = \"dots\"", "pattern = \"dotz\"", "liquids[cherry].pattern", "unknown", "dots"},
      {"liquid = \"coconut\"\nstart_l", "liquid = \"coconat\"\nstart_l", "dispensers[3].liquid",
       "not a liquid", "coconut"},
      {"drinks = [\"sunset\", \"dawn\"]", "drinks = [\"sunsets\", \"dawn\"]",
       "levels[Two liquids].drinks", "not a drink", "sunset"},
      {"drinks = [\"sunset\", \"dawn\"]", "drinks = []", "levels[Two liquids].drinks", "empty",
       "one"},
      {"drinks = [\"sunset\", \"dawn\"]", "drinks = [\"lagoon\"]", "levels[Two liquids].drinks",
       "blueberry", "dispenser"},
      {"tolerance_l = 0.005", "tolerance_l = 0.05",
       "levels[One dispenser, wide tolerance].tolerance_l", "not less", "less"},
      {"low_n = 1.3", "low_n = 0.4", "levels[One dispenser, wide tolerance].low_n",
       "below threshold_n", "threshold_n"},
      {"high_n = 3.0", "high_n = 1.2", "levels[One dispenser, wide tolerance].high_n",
       "not above low_n", "low_n"},
      {"capacity_l = 0.07", "capacity_l = 0.05", "levels[Four liquids, narrow tolerance].drinks",
       "does not fit into the glass", "0.05"},
      {"liquid = \"coconut\"\nstart_l = 0.35", "liquid = \"coconut\"\nstart_l = 0.01",
       "levels[Four liquids, narrow tolerance].drinks", "start_l", "0.015"},
  };
  for (const Case& c : cases) {
    FaultyBar faulty;
    faulty.inBar(c.find, c.replace);
    expectOneFault(faulty, c);
  }
}

// The page arms an exercise by its name, and a recording's file name contains it.
TEST(BarFile, NameThatCannotBePartOfAFileName_IsRefused) {
  for (const std::string& name :
       {std::string("a/b"), std::string(101, 'x'), std::string(300, 'x')}) {
    FaultyBar faulty;
    const Case c{"name = \"cocktail-bar\"", "name = \"" + name + "\"", "name",
                 name.size() <= 200 ? "cannot be part of a file's name" : "name", ""};
    faulty.inBar(c.find, c.replace);
    expectOneFault(faulty, c);
  }
}

TEST(BarFile, UnsuitableScene_IsReportedWithTheBody) {
  FaultyBar turned;
  turned.inScene("position_m = [0.119, -0.023, 0.004]",
                 "position_m = [0.119, -0.023, 0.004]\norientation_rpy_rad = [0.5, 0.0, 0.0]");
  expectOneFault(turned, {"", "", "dispensers[0].body", "upright cylinder", "cylinder"});

  FaultyBar free;
  free.inScene("fixed = true\nposition_m = [0.119, -0.023",
               "mass_kg = 0.2\nposition_m = [0.119, -0.023");
  expectOneFault(free, {"", "", "dispensers[0].body", "cannot slide in a row", "fixed = true"});

  FaultyBar glass;
  glass.inScene("fixed = true                       # the exercise slides it", "mass_kg = 0.2");
  expectOneFault(glass, {"", "", "glass.body", "is not fixed", "fixed = true"});

  FaultyBar counter;
  counter.inScene("name = \"counter\"", "name = \"table\"");
  expectOneFault(counter, {"", "", "scene", "no box named counter", "add it"});
}

TEST(BarFile, MissingScene_IsReportedWithTheExercisesKey) {
  FaultyBar bar;
  bar.inBar("scene = \"../scenes/cocktail-bar.toml\"", "scene = \"../scenes/none.toml\"");
  const Diagnostics faults = bar.faults();
  ASSERT_EQ(faults.size(), 1U) << format(faults);
  EXPECT_TRUE(faults[0].file.ends_with("exercises/bar.toml"));
  EXPECT_EQ(faults[0].key, "scene");
  EXPECT_TRUE(contains(faults[0].value, "../scenes/none.toml"));
  EXPECT_EQ(faults[0].problem.find(".."), std::string::npos) << faults[0].problem;
  EXPECT_TRUE(contains(faults[0].problem, "/scenes/none.toml"));
  EXPECT_TRUE(contains(faults[0].remedy, "relative to the folder"));
}

TEST(BarFile, FaultInTheScene_NamesItsNormalisedPath) {
  FaultyBar bar;
  bar.inScene("hand_friction = 0.8", "hand_friction = 8.0");
  const Diagnostics faults = bar.faults();
  ASSERT_EQ(faults.size(), 1U) << format(faults);
  EXPECT_TRUE(faults[0].file.ends_with("/scenes/cocktail-bar.toml")) << faults[0].file;
  EXPECT_EQ(faults[0].file.find(".."), std::string::npos) << faults[0].file;
}

TEST(BarFile, FaultsInFileAndScene_AreAllReported) {
  FaultyBar bar;
  bar.inBar("lead_in_m = 0.0 ", "lead_in_m = 0.5 ");
  bar.inBar("high_n = 3.0", "hihg_n = 3.0");
  bar.inScene("hand_friction = 0.8", "hand_friction = 8.0");
  const Diagnostics faults = bar.faults();
  ASSERT_EQ(faults.size(), 3U) << format(faults);
  EXPECT_TRUE(namesKey(faults, "lead_in_m"));
  EXPECT_TRUE(namesKey(faults, "hihg_n"));
  EXPECT_TRUE(namesKey(faults, "hand_friction"));
}

TEST(BarFile, UnknownLevelOrFile_IsReported) {
  const FaultyBar bar;
  for (const int level : {0, 5, -1}) {
    const Diagnostics faults = bar.faults(level);
    ASSERT_EQ(faults.size(), 1U);
    EXPECT_EQ(faults[0].problem, "the exercise has levels 1 to 4");
  }
  const auto none = loadExercise("/no/such.toml", 1, shippedDevice(), shippedHand());
  EXPECT_TRUE(refusedWith(none, "/no/such.toml"));
  const auto misspelt =
      loadExercise(config("exercises/coctail-bar.toml"), 1, shippedDevice(), shippedHand());
  ASSERT_FALSE(misspelt.ok());
  EXPECT_TRUE(contains(misspelt.errors()[0].file, "coctail-bar.toml"));
  EXPECT_TRUE(misspelt.errors()[0].remedy.starts_with("exercises there: cocktail-bar, "))
      << misspelt.errors()[0].remedy;
  const auto scene =
      loadExercise(config("scenes/cocktail-bar.toml"), 1, shippedDevice(), shippedHand());
  ASSERT_TRUE(refusedWith(scene, "another kind of file"));
  EXPECT_EQ(scene.errors()[0].remedy, "an exercise file is expected here");
  EXPECT_FALSE(
      loadExercise(config("exercises/free-grasping.toml"), 2, shippedDevice(), shippedHand()));
}

}  // namespace
}  // namespace wholehand::test
