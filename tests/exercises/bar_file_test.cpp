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

// The page arms an exercise by its name, and a recording's file name contains it.
TEST(BarFile, NameThatCannotBePartOfAFileName_IsRefused) {
  for (const std::string& name :
       {std::string("a/b"), std::string(101, 'x'), std::string(300, 'x')}) {
    FaultyBar faulty;
    faulty.inBar("name = \"cocktail-bar\"", "name = \"" + name + "\"");
    const Diagnostics faults = faulty.faults();
    ASSERT_EQ(faults.size(), 1U) << format(faults);
    EXPECT_EQ(faults[0].key, "name");
    if (name.size() > 200) continue;
    EXPECT_TRUE(contains(faults[0].problem, "cannot be part of a file's name"));
  }
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
