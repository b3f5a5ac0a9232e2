#include "exercises/bar_table.hpp"
#include "files/device/device_file.hpp"
#include "files/hand/hand_file.hpp"
#include "loop/realtime/allocation_counter.hpp"
#include "support/contains.hpp"
#include "support/figure.hpp"
#include "support/tolerance.hpp"

#include <nlohmann/json.hpp>

#include <set>

namespace wholehand::test {
namespace {

std::vector<ExerciseFile> shipped() {
  return listExercises(config("exercises"));
}

TEST(ShippedExercises, ListOfExercises_HasTheirFileNames) {
  std::set<std::string> names;
  for (const ExerciseFile& file : shipped()) names.insert(file.name);
  EXPECT_TRUE(names.contains("cocktail-bar"));
  EXPECT_TRUE(names.contains("cocktail-bar-free"));
  EXPECT_TRUE(names.contains("free-grasping"));
  EXPECT_TRUE(listExercises("/no/such/folder").empty());
}

TEST(ShippedExercises, EveryLevel_LoadsAndFitsTheRecord) {
  for (const ExerciseFile& file : shipped()) {
    int levels = 1;
    for (int level = 1; level <= levels; ++level) {
      SCOPED_TRACE(file.name + ", level " + std::to_string(level));
      const auto loaded = orThrow(loadExercise(file.path, level, shippedDevice(), shippedHand()));
      const ExerciseDescription& d = loaded.exercise->description();
      levels = d.levels;
      EXPECT_EQ(d.level, level);
      EXPECT_EQ(d.name, file.name);
      EXPECT_LE(d.value_names.size(), std::size_t{kMaxExerciseValues});
      const std::set<std::string> unique(d.value_names.begin(), d.value_names.end());
      EXPECT_EQ(unique.size(), d.value_names.size());
      EXPECT_TRUE(nlohmann::json::accept(d.json));
      EXPECT_LE(loaded.scene.bodies.size(), std::size_t{kMaxBodies});
      for (const LiveParameter& p : d.parameters) {
        EXPECT_LE(p.lower, p.value) << p.name;
        EXPECT_LE(p.value, p.upper) << p.name;
        EXPECT_GT(p.rate_per_s, 0.0) << p.name;
      }
    }
  }
}

TEST(ShippedExercises, Liquids_AreDistinguishableByFeel) {
  for (const char* name : {"cocktail-bar", "cocktail-bar-free"}) {
    const auto loaded = orThrow(
        loadExercise(config("exercises/") + name + ".toml", 1, shippedDevice(), shippedHand()));
    const auto json = nlohmann::json::parse(loaded.exercise->description().json);
    std::vector<double> resistance_n_s_m;
    for (const auto& liquid : json["liquids"]) {
      resistance_n_s_m.push_back(liquid["resistance_n_s_m"]);
    }
    std::sort(resistance_n_s_m.begin(), resistance_n_s_m.end());
    ASSERT_GE(resistance_n_s_m.size(), 4U);
    EXPECT_GE(resistance_n_s_m.front(), 79.0) << name << ": the device's own is 2.3 N·s/m";
    for (std::size_t i = 1; i < resistance_n_s_m.size(); ++i) {
      // Discrimination threshold: 34 % of the viscosity (Jones 1997).
      EXPECT_GE(resistance_n_s_m[i] / resistance_n_s_m[i - 1], 1.598) << name;
    }
  }
}

TEST(ShippedExercises, BarOnADeviceWithoutFingers_IsRefusedWithTheRemedy) {
  const DeviceModel device = loadDeviceFile(config("devices/desktop-3axis.toml")).value();
  const HandModel hand =
      assembleHand(loadHandFile(config("hands/adult-median-right.toml")).value(), device).value();
  for (const char* name : {"cocktail-bar.toml", "cocktail-bar-free.toml"}) {
    const std::string path = config("exercises/") + name;
    const auto loaded = loadExercise(path, 1, device, hand);
    ASSERT_FALSE(loaded.ok()) << "nobody could squeeze";
    ASSERT_EQ(loaded.errors().size(), 2U) << format(loaded.errors());  // one per axis
    const char* const axes[] = {"finger_flexion", "thumb_flexion"};
    for (std::size_t i = 0; i < 2; ++i) {
      const Diagnostic& fault = loaded.errors()[i];
      EXPECT_EQ(fault.file, path);
      EXPECT_GT(fault.line, 0);
      EXPECT_EQ(fault.key, std::string("wall.axes[") + axes[i] + "].name");
      EXPECT_TRUE(contains(format(fault), device.path));
      EXPECT_TRUE(contains(fault.remedy, "--scene F --motion F"));
    }
  }
  const auto free = loadExercise(config("exercises/free-grasping.toml"), 1, device, hand);
  EXPECT_TRUE(free.ok()) << format(free.errors());
}

TEST(ShippedExercises, LeftHand_HasTheMirroredReach) {
  const HandModel left =
      assembleHand(loadHandFile(config("hands/adult-median-left.toml")).value(), shippedDevice())
          .value();
  const auto y_m = [&](const char* file, const HandModel& hand, const char* body) {
    const auto loaded = loadExercise(config("exercises/") + file, 2, shippedDevice(), hand);
    EXPECT_TRUE(loaded.ok()) << format(loaded.errors());
    const SceneModel& scene = loaded->scene;
    return scene.bodies[scene.bodyIndex(body)].pose.translation_m.y();
  };
  // reach_y_m = [-0.023, 0.105] for a right hand.
  EXPECT_NEAR(y_m("cocktail-bar.toml", shippedHand(), "dispenser_lemon"), -0.023, 1e-12);
  EXPECT_NEAR(y_m("cocktail-bar.toml", shippedHand(), "dispenser_cherry"), 0.105, 1e-12);
  EXPECT_NEAR(y_m("cocktail-bar.toml", left, "dispenser_lemon"), -0.105, 1e-12);
  EXPECT_NEAR(y_m("cocktail-bar.toml", left, "dispenser_cherry"), 0.023, 1e-12);
  EXPECT_NEAR(y_m("cocktail-bar-free.toml", left, "dispenser_cherry"), -0.105, 1e-12);
  EXPECT_NEAR(y_m("cocktail-bar-free.toml", left, "glass"), -0.041, 1e-12);
}

/// 4 N of coupling at the tip plus the shell's wall, in N at the tip.
TEST(ShippedExercises, FirmSqueezeOfTheThickestLiquid_StaysBelowTheTipLimit) {
  BarTable bar(4);
  const double k_pm = 4.0, lever_m = 0.08;
  bar.hold(3, 8.0);
  bar.presses = false;
  bar.record.closure[3] = bar.record.closure[5] = 1.0;
  bar.record.contacts[3].capsule = BarTable::capsuleOf("thumb_distal");  // both axes touch
  bar.record.q_m[3] = bar.record.q_m[5] = 1.0;
  bar.run(1.5);
  // The avatar's finger stays at the touch; the device is beyond it by the stretch of 4 N.
  bar.record.q_m[3] = bar.record.q_m[5] = 1.0 + 4.0 * lever_m / k_pm;
  bar.tick();
  for (const int axis : {3, 5}) {
    const double wall_n = -bar.out.effort[axis] / lever_m;
    EXPECT_GT(wall_n, 1.0);
    EXPECT_LE(4.0 + wall_n, 10.0);
  }
}

TEST(ShippedExercises, Tick_DoesNotAllocate) {
  for (const ExerciseFile& file : shipped()) {
    auto loaded = loadExercise(file.path, 1, shippedDevice(), shippedHand());
    ASSERT_TRUE(loaded.ok()) << format(loaded.errors());
    std::vector<double> parameters;
    for (const LiveParameter& p : loaded->exercise->description().parameters) {
      parameters.push_back(p.value);
    }
    TickRecord record;
    record.q_m = record.q_s = record.closure = AxisPosition(6);
    record.qd_mf = AxisVelocity(6);
    ExerciseInput input;
    input.observed = &record;
    input.parameters = parameters.data();
    ExerciseRecord out;
    BodyPlacements placements;
    const AllocationScope scope;
    for (int i = 0; i < 3000; ++i) {
      record.palm_target_distance_m = i % 900 < 500 ? 0.01 : 0.2;
      record.palm_body = loaded->scene.bodyIndex("dispenser_lemon");
      record.command_count = i % 700 == 0 ? 1 : 0;
      record.commands[0].type = CommandType::kAction;
      record.commands[0].index = i / 700 % 4;
      const WorldQuery query = loaded->exercise->query();
      EXPECT_LT(query.closure_body, kMaxBodies);
      loaded->exercise->tick(input, out, placements);
    }
    EXPECT_EQ(scope.allocations(), 0U) << file.name;
  }
}

TEST(FreeGrasping, EveryBodyOfItsScene_IsATargetAndNobodyIsPushed) {
  auto loaded =
      loadExercise(config("exercises/free-grasping.toml"), 1, shippedDevice(), shippedHand());
  ASSERT_TRUE(loaded.ok()) << format(loaded.errors());
  LoadedExercise& free = *loaded;
  ASSERT_GT(free.scene.bodies.size(), 2U);
  EXPECT_EQ(free.exercise->query().targets, (1U << free.scene.bodies.size()) - 1U);
  EXPECT_EQ(free.exercise->query().closure_body, -1);
  TickRecord record;
  record.palm_body = 2;
  record.palm_target_distance_m = 0.0123;
  ExerciseInput input;
  input.observed = &record;
  ExerciseRecord out;
  out.effort = AxisEffort(6, 9.0);  // of an earlier tick
  BodyPlacements placements;
  placements.count = 3;
  free.exercise->tick(input, out, placements);
  for (const double f : out.effort) EXPECT_EQ(f, 0.0);
  EXPECT_EQ(out.effort.size(), 6);
  EXPECT_EQ(placements.count, 0);
  EXPECT_EQ(out.values[0], 2.0);
  EXPECT_EQ(out.values[1], 0.0123);
  EXPECT_TRUE(free.walls.empty());
}

}  // namespace
}  // namespace wholehand::test
