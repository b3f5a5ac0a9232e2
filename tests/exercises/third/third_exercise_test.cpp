// Checks the promise of docs/exercises.md: a third exercise is one folder and one TOML file, and no
// other file changes. This folder's CMakeLists.txt puts them in place.
#include "exercise_kinds.hpp"
#include "exercises/load_exercise.hpp"
#include "support/contains.hpp"
#include "support/rig_tools.hpp"

#include <fstream>
#include <iterator>
#include <set>
#include <sstream>

namespace wholehand::test {
namespace {

const std::string kHere = std::string(WHOLEHAND_SOURCE_DIR) + "/tests/exercises/third";
const std::string kFile = kHere + "/hold-still.toml";

std::string textOf(const std::string& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(ThirdExercise, FolderOfAnExercise_IsListedAndBuiltWithTheOthers) {
  std::set<std::string> kinds;
  for (const ExerciseKind& kind : kExerciseKinds) kinds.insert(kind.name);
  for (const char* kind :
       {"cocktail_bar", "free_grasping", "squeeze_to_level", "hold_still", "my_task"}) {
    EXPECT_TRUE(kinds.contains(kind)) << kind;
  }
  std::set<std::string> sources;
  std::istringstream listed(textOf(LISTED_SOURCES));
  for (std::string source; std::getline(listed, source, ';');) sources.insert(source);
  EXPECT_TRUE(sources.contains("hold_still/hold_still.cpp"));
  EXPECT_TRUE(sources.contains("free_grasping/free_grasping.cpp"));
  EXPECT_TRUE(sources.contains("load_exercise.cpp"));
}

TEST(ThirdExercise, FileOfAnExercise_IsFoundByName) {
  const std::vector<ExerciseFile> found = listExercises(kHere);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].name, "hold-still");
  EXPECT_EQ(found[0].path, kFile);
}

TEST(ThirdExercise, FaultsOfTheFile_AreReportedTogetherByKey) {
  std::string text = textOf(kFile);
  text.replace(text.find("hold_s = 0.2"), 12, "hold_s = -1.0\nbogus = 1");
  const std::string path = testing::TempDir() + "hold-still.toml";
  std::ofstream(path) << text.replace(text.find("../../.."), 8, WHOLEHAND_SOURCE_DIR);
  const Models m = load(shippedFiles());
  const auto loaded = loadExercise(path, 1, m.device, m.hand);
  ASSERT_FALSE(loaded.ok());
  const std::string reported = format(loaded.errors());
  EXPECT_TRUE(contains(reported, "hold_s"));
  EXPECT_TRUE(contains(reported, "bogus"));
}

TEST(ThirdExercise, ExerciseInTheLoop_SeesEveryTickAndReportsItsState) {
  ModelFiles files = shippedFiles();
  files.exercise = kFile;
  Models m = load(files);
  ASSERT_NE(m.exercise, nullptr);
  EXPECT_EQ(m.exercise->description().name, "hold-still");
  // Still for 0.1 s, 0.1 m/s for 0.1 s, then still: the hold of 0.2 s starts when the filtered
  // velocity (30 Hz) has fallen from 0.1 to 0.05 m/s, which takes ln 2 / (2 π 30 Hz) = 3.7 ms.
  const AxisPosition start(m.device.axisCount());
  const auto script = [start](int read) {
    AxisPosition q = start;
    q[0] = 1e-4 * std::clamp(read - 100, 0, 100);
    return q;
  };
  const auto rig = buildScripted(std::move(m), script);
  ASSERT_TRUE(rig->renderer->arm());
  std::vector<double> held_s;
  std::vector<std::size_t> reported;
  runTicks(*rig->renderer, 600, [&](const TickRecord& r) {
    if (r.exercise.event_count > 0) reported.push_back(held_s.size());
    held_s.push_back(r.exercise.values[0]);
  });
  EXPECT_NEAR(held_s[99], 0.1, 1.5e-3);
  EXPECT_EQ(held_s[190], 0.0);
  ASSERT_EQ(reported.size(), 1U);
  EXPECT_NEAR(static_cast<double>(reported[0]), 404.0, 2.0);
}

/// The exercise made by the guide's first command, built as the guide says and played by its
/// virtual patient.
TEST(NewExercise, ExerciseMadeByTheGuide_IsCertifiedAndPlayedToItsEnd) {
  ModelFiles files = shippedFiles();
  files.exercise = std::string(CLEAN_FOLDER) + "/config/exercises/my-task.toml";
  Models m = load(files);
  EXPECT_EQ(m.exercise->description().name, "my-task");
  EXPECT_EQ(m.exercise_panel.title.fr, "Doser sa force");
  EXPECT_EQ(m.exercise_walls.size(), 2U);
  const std::vector<std::string>& names = m.exercise->description().value_names;
  const auto done = std::find(names.begin(), names.end(), kDoneValue) - names.begin();
  std::unique_ptr<Player> player = m.exercise->makePlayer({1});
  ASSERT_NE(player, nullptr);
  const auto rig = buildRig(std::move(m), std::move(player), RigOptions{});  // certifies
  ASSERT_TRUE(rig.ok()) << format(rig.errors());
  ASSERT_TRUE((*rig)->renderer->arm());
  bool played = false;
  for (int s = 0; s < 60 && !played; ++s) {
    runTicks(*(*rig)->renderer, 1000, [&](const TickRecord& r) {
      (*rig)->listener->afterTick(r);
      played = r.exercise.values[done] > 0.5;
    });
  }
  EXPECT_TRUE(played);
}

TEST(NewExercise, PanelWithUnknownNames_IsRefusedWithTheKnownOnes) {
  std::string text = textOf(std::string(CLEAN_FOLDER) + "/config/exercises/my-task.toml");
  text.replace(text.find("name = \"held_s\""), 15, "name = \"bold_s\"");
  text.replace(text.find("band_entered ="), 14, "band_left    =");
  text.replace(text.find("../scenes"), 9, std::string(CLEAN_FOLDER) + "/config/scenes");
  const std::string path = testing::TempDir() + "my-task.toml";
  std::ofstream(path) << text;
  const Models m = load(shippedFiles());
  const auto loaded = loadExercise(path, 1, m.device, m.hand);
  ASSERT_FALSE(loaded.ok());
  ASSERT_EQ(loaded.errors().size(), 2U) << format(loaded.errors());
  EXPECT_EQ(loaded.errors()[0].key, "panel.values[bold_s].name");
  EXPECT_TRUE(contains(loaded.errors()[0].remedy, "held_s"));
  EXPECT_EQ(loaded.errors()[1].key, "panel.events.band_left");
  EXPECT_TRUE(contains(loaded.errors()[1].remedy, "band_held"));
}

}  // namespace
}  // namespace wholehand::test
