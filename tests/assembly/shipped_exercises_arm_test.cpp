// Every shipped exercise begins: nobody's hand starts inside what is to be grasped.
#include "assembly/resting_player.hpp"
#include "exercise/load_exercise.hpp"
#include "support/rig_tools.hpp"
#include "support/seed.hpp"
#include "support/shipped.hpp"

namespace wholehand::test {
namespace {

std::string config(const std::string& name) {
  return std::string(WHOLEHAND_SOURCE_DIR) + "/config/" + name;
}

/// As `run` and the station begin: its virtual patient, or a hand at rest where it has none.
void expectBegins(Models models, std::uint64_t seed) {
  std::unique_ptr<Player> player = models.exercise->makePlayer(seed);
  if (!player) player = makeMotionPlayer(models);
  const auto rig = orThrow(buildRig(std::move(models), std::move(player), {}));
  const auto armed = rig->renderer->arm();
  ASSERT_TRUE(armed.ok()) << format(armed.errors());
  runTicks(*rig->renderer, 20, [](const TickRecord& r) {
    ASSERT_EQ(r.faults & kStopping, Fault::kNone) << "tick " << r.tick;
    ASSERT_EQ(r.contact_count, 0) << "touches at tick " << r.tick;
  });
}

TEST(ShippedExercises, EveryLevel_ArmsAtItsStartTouchingNothing) {
  const std::vector<ExerciseFile> exercises = listExercises(config("exercises"));
  ASSERT_GE(exercises.size(), 3U);
  for (const ExerciseFile& file : exercises) {
    int levels = 1;
    for (int level = 1; level <= levels; ++level) {
      for (const std::uint64_t seed : {1U, 2U}) {  // virtual patients start by it
        SCOPED_TRACE(file.name + ", level " + std::to_string(level) + ", seed " +
                     std::to_string(seed));
        ModelFiles files = shippedFiles();
        files.exercise = file.path;
        files.level = level;
        Models models = load(files);
        levels = models.exercise->description().levels;
        expectBegins(std::move(models), seed);
      }
    }
  }
}

// It names no device and no hand: with whichever a person has, it begins.
TEST(ShippedExercises, FreeGrasping_ArmsWithEveryDeviceAndHand) {
  std::size_t index = 0;
  for (const std::string& device : shipped("devices")) {
    for (const std::string& hand : shippedHands(seed(), cases(1) > 1)) {
      if (leftOutUnderASanitizer(index++)) continue;
      SCOPED_TRACE(hand + " on " + device);
      ModelFiles files = shippedFiles(device, "empty", hand);
      files.exercise = config("exercises/free-grasping.toml");
      expectBegins(load(files), 1);
    }
  }
}

/// A body is within reach when the device can put the palm where the power grasp of a bottle has
/// it: the bottle's axis 0.049, 0.041, 0.004 m from the palm's base (docs/exercises.md's
/// dispensers).
TEST(ShippedExercises, FreeGrasping_EveryBodyIsWithinReachOfAGrasp) {
  ModelFiles files = shippedFiles();
  files.exercise = config("exercises/free-grasping.toml");
  const Models models = load(files);
  ASSERT_FALSE(models.scene.bodies.empty());
  const Eigen::Vector3d held_m(0.049, 0.041, 0.004);
  for (const SceneBody& body : models.scene.bodies) {
    const Eigen::Vector3d base_m = body.pose.translation_m - held_m;
    for (int i = 0; i < 3; ++i) {
      const DeviceAxis& axis =
          models.device.axes[models.device.axisIndex(std::string(1, "xyz"[i]))];
      EXPECT_GE(base_m[i], axis.lower) << body.name << " along " << axis.name;
      EXPECT_LE(base_m[i], axis.upper) << body.name << " along " << axis.name;
    }
  }
}

}  // namespace
}  // namespace wholehand::test
