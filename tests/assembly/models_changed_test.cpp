// A recording carries the files. What a program changed in memory is not in them: it says so, and
// is not run again as if it were.
#include "resimulation/resimulation.hpp"
#include "support/folder.hpp"
#include "support/recorded_run.hpp"
#include "support/says.hpp"

namespace wholehand::test {
namespace {

Models shippedModels() {
  return load(shippedFiles("lambda-pride", "four-shapes"));
}

TEST(ModelsChanged, AsTheFilesSay_IsRunAgain) {
  const Folder folder;
  const std::string path = recordRest(shippedModels(), folder.file("run.h5"));
  const auto reader = orThrow(RecordingReader::open(path));
  EXPECT_FALSE(reader->meta().models_changed);
  const auto again = resimulate(*reader, path);
  ASSERT_TRUE(again) << format(again.errors());
  EXPECT_GT(again->compared, 100U);
  EXPECT_EQ(again->difference.field, "");
  volatile double tiny = std::numeric_limits<double>::min();
  tiny = tiny / 4.0;
  EXPECT_NE(tiny, 0.0) << "the caller's thread flushes denormals from now on";
}

TEST(ModelsChanged, InMemory_IsSaidAndNotRunAgain) {
  std::vector<std::pair<const char*, void (*)(Models&)>> changes = {
      {"a body is moved", [](Models& m) { m.scene.bodies[0].pose.translation_m.x() += 1e-3; }},
      {"gravity", [](Models& m) { m.scene.gravity_m_s2.z() = -1.62; }},
      {"a longer finger", [](Models& m) { m.hand.capsules.back().b_m *= 1.01; }},
      {"another effort limit", [](Models& m) { m.device.axes[0].effort_limit *= 0.9; }},
      {"softer gains", [](Models& m) { m.rendering.axes[0].k_pm *= 0.9; }},
  };
  for (const auto& [what, change] : changes) {
    SCOPED_TRACE(what);
    const Folder folder;
    Models models = shippedModels();
    change(models);
    const std::string path = recordRest(std::move(models), folder.file("run.h5"));
    const auto reader = orThrow(RecordingReader::open(path));
    EXPECT_TRUE(reader->meta().models_changed);
    const auto again = resimulate(*reader, path);
    EXPECT_TRUE(refusedWith(again, "changed in memory"));
  }
}

}  // namespace
}  // namespace wholehand::test
