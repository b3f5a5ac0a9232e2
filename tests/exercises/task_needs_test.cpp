// Tasks within a person's limits: the scene is moved, or the exercise is refused with the numbers.
#include "exercises/task_needs.hpp"

#include "exercises/exercise_session.hpp"
#include "support/contains.hpp"
#include "support/folder.hpp"
#include "support/seed.hpp"

#include <fmt/format.h>

namespace wholehand::test {
namespace {

/// lambda-pride with a person's limits on x.
Prescription limitsOnX(double lower_m, double upper_m) {
  Prescription out;
  out.name = "p";
  out.limits = {{0, lower_m, upper_m}};
  return out;
}

TEST(TaskNeeds, Scene_IsMovedByTheLeastThatFits) {
  const DeviceModel device = load(shippedFiles()).device;
  const Prescription limits = limitsOnX(-0.05, 0.06);  // without walls: -0.04 .. 0.05
  const DeviceModel within = deviceWithin(device, limits);
  EXPECT_DOUBLE_EQ(within.axes[0].lower, -0.04);
  EXPECT_DOUBLE_EQ(within.axes[0].upper, 0.05);
  EXPECT_EQ(within.axes[1].lower, device.axes[1].lower);
  const auto movedFor = [&](double from, double to) {
    TaskNeeds needs;
    needs.add(0, to);
    needs.add(0, from);
    needs.add(-1, 99.0);  // an axis that the device lacks
    return placeWithin(needs, within, "task", limits);
  };
  EXPECT_DOUBLE_EQ(orThrow(movedFor(-0.01, 0.02)).x(), 0.0);
  EXPECT_DOUBLE_EQ(orThrow(movedFor(0.03, 0.07)).x(), -0.02);
  EXPECT_DOUBLE_EQ(orThrow(movedFor(-0.08, 0.01)).x(), 0.04);
  EXPECT_NEAR(orThrow(movedFor(0.0, 0.0899)).x(), -0.0399, 1e-12);
  const auto refused = movedFor(0.0, 0.0912);
  ASSERT_FALSE(refused.ok());
  const std::string said = format(refused.errors());
  EXPECT_TRUE(contains(said, "90 mm")) << said;
  EXPECT_TRUE(contains(said, "91 mm")) << said;
}

/// A limit at the device's own end has no wall, so nothing is taken off there.
TEST(TaskNeeds, EndOfTheDevice_IsNoLimit) {
  const DeviceModel device = load(shippedFiles()).device;
  const DeviceModel within = deviceWithin(device, limitsOnX(device.axes[0].lower, 0.06));
  EXPECT_EQ(within.axes[0].lower, device.axes[0].lower);
  EXPECT_DOUBLE_EQ(within.axes[0].upper, 0.05);
}

/// The hand closes around what is thinner later: the fingers' need rises as the radius falls, and a
/// person whose fingers do not close so far is refused with both ranges.
TEST(TaskNeeds, Grasp_NeedsTheFingersAroundTheObject) {
  const Models models = load(shippedFiles());
  const PlayerReach reach = playerReach(models.device, &models.hand, 0.0);
  double before = 0.0;
  for (const double radius_m : {0.045, 0.035, 0.025}) {
    TaskNeeds needs;
    needs.addGrasp(playerReach(models.device, &models.hand, radius_m), models.hand, radius_m);
    ASSERT_EQ(needs.all().size(), 1U);
    EXPECT_EQ(needs.all()[0].axis, reach.fingers);
    EXPECT_GT(needs.all()[0].upper, before + 1.0 * kDeg) << radius_m;
    before = needs.all()[0].upper;
  }
  EXPECT_LT(before, 170.0 * kDeg);
  Prescription weak;
  weak.limits = {{reach.fingers, 0.3, 1.4}};
  TaskNeeds needs;
  needs.addGrasp(playerReach(models.device, &models.hand, 0.03), models.hand, 0.03);
  const auto refused = placeWithin(needs, deviceWithin(models.device, weak), "task", weak);
  ASSERT_FALSE(refused.ok());
  EXPECT_TRUE(contains(format(refused.errors()), "22 to 75°")) << format(refused.errors());
}

/// Files of an exercise for a person of these limits on the three translations.
struct PlacedExercise {
  Folder folder;
  ModelFiles files;
  PlacedExercise(const std::string& exercise, const std::string& hand,
                 const std::array<std::array<double, 2>, 3>& within_m)
      : files(exerciseFiles(exercise, 1, "adult-median-" + hand)) {
    std::string text =
        "kind = \"prescription\"\nversion = 1\nname = \"p\"\nside = \"" + hand + "\"\n";
    for (int k = 0; k < 3; ++k) {
      text += fmt::format("[[limits]]\naxis = \"{}\"\nwithin_m = [{}, {}]\n", "xyz"[k],
                          within_m[k][0], within_m[k][1]);
    }
    files.prescription = folder.write("p.toml", text);
  }
};

/// The grip of "squeeze to a level" is at the same place of either hand, mirrored in y.
TEST(TaskNeeds, SceneOfEitherHand_IsWithinTheLimits) {
  for (const std::string hand : {"right", "left"}) {
    const double side = hand == "left" ? -1.0 : 1.0;
    const double inner = side * 0.02, outer = side * 0.1;
    const PlacedExercise placed(
        "squeeze-to-level", hand,
        {{{-0.08, 0.04}, {std::min(inner, outer), std::max(inner, outer)}, {-0.11, -0.02}}});
    const Models models = load(placed.files);
    const PlayerReach reach = playerReach(models.device, &models.hand, 0.0);
    const SceneBody& grip = models.scene.bodies[models.scene.bodyIndex("grip")];
    Eigen::Vector3d base_m = grip.pose.translation_m - reach.grip_m;
    base_m.y() -= reach.beside * grip.shapes[0].radius_m;
    EXPECT_LE(base_m.x(), 0.03 + 1e-12) << hand;
    EXPECT_GE(side * base_m.y(), 0.03 - 1e-12) << hand;
    EXPECT_LE(base_m.z(), -0.03 + 1e-12) << hand;
    EXPECT_LT(models.exercise_moved_m.x(), 0.0);
    EXPECT_GT(side * models.exercise_moved_m.y(), 0.0);
  }
}

TEST(TaskNeeds, LimitsNarrowerThanTheTask_AreRefusedWithBothNumbers) {
  const PlacedExercise placed("drawer", "right", {{{-0.04, 0.04}, {-0.1, 0.1}, {-0.1, 0.1}}});
  const auto models = loadModels(placed.files);
  ASSERT_FALSE(models.ok());
  const std::string said = format(models.errors());
  EXPECT_TRUE(contains(said, "p.toml")) << said;
  EXPECT_TRUE(contains(said, "leave 60 mm")) << said;
  EXPECT_TRUE(contains(said, "drawer needs 100 mm")) << said;
}

/// What became of an exercise for persons with drawn limits.
struct PlacedCount {
  int done = 0, refused = 0;
};

/// Own movement of 60 to 100 % of the device's on each side of each translation; `share` of it is
/// allowed.
std::array<std::array<double, 2>, 3> drawnLimits(std::mt19937_64& random, double share) {
  std::array<std::array<double, 2>, 3> out;
  for (int k = 0; k < 3; ++k) {
    const double most_m = share * (k == 0 ? 0.085 : 0.12);
    out[k] = {-most_m * uniform(random, 0.6, 1.0), most_m * uniform(random, 0.6, 1.0)};
  }
  return out;
}

/// A hand that pulls aims ahead of the thing by so much.
constexpr double kLeads_m = 0.002;

/// Whatever is not refused is done by its virtual patient, which means to stay within the limits'
/// walls.
void playWithin(const std::string& task, const std::string& hand,
                const std::array<std::array<double, 2>, 3>& within_m, PlacedCount& count) {
  const PlacedExercise placed(task, hand, within_m);
  if (!loadModels(placed.files)) {
    ++count.refused;
    return;
  }
  ExerciseSession session(placed.files);
  double outside_m = -1.0;
  session.on_record = [&](const TickRecord& r) {
    EXPECT_EQ(r.faults & kStoppingFaults, Fault::kNone);
    for (int k = 0; k < 3; ++k) {
      outside_m =
          std::max({outside_m, within_m[k][0] - r.intention[k], r.intention[k] - within_m[k][1]});
    }
  };
  session.runUntil("done", 1.0);
  EXPECT_LE(outside_m, -kLimitBand_m + kLeads_m);
  ++count.done;
}

TEST(TaskNeeds, PlacedTasks_AreDoneWithinTheLimits) {
  auto random = seededRandom(6621);
  const std::vector<std::string> tasks = {"squeeze-to-level", "light-switch", "press-lever",
                                          "flip-top-lid"};
  PlacedCount count;
  for (int i = 0; count.done < 3 && i < 40; ++i) {
    const std::string task = tasks[random() % tasks.size()];
    const std::string hand = random() % 2 == 0 ? "right" : "left";
    SCOPED_TRACE(fmt::format("{}, {} hand, draw {}", task, hand, i));
    playWithin(task, hand, drawnLimits(random, uniform(random, 0.6, 1.0)), count);
  }
  EXPECT_EQ(count.done, 3);
}

/// All tasks of daily life and the squeeze, 100 persons each.
TEST(TaskNeeds, PlacedTasksOfManyPersons_AreDone_slow) {
  auto random = seededRandom(6622);
  for (const double share : {1.0, 0.8, 0.6}) {
    for (const char* task : {"squeeze-to-level", "light-switch", "press-lever", "flip-top-lid",
                             "coffee-mill", "cupboard-door", "drawer"}) {
      PlacedCount count;
      for (int i = 0; i < 100; ++i) {
        SCOPED_TRACE(fmt::format("{}, {} of own movement, draw {}", task, share, i));
        playWithin(task, i % 2 == 0 ? "right" : "left", drawnLimits(random, share), count);
      }
      std::printf("figure: %s within %.0f %% of own movement: %d done, %d refused\n", task,
                  100.0 * share, count.done, count.refused);
    }
  }
}

}  // namespace
}  // namespace wholehand::test
