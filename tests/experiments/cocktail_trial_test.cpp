// Virtual patients play the cocktail bar. README.md states the results for all seeds; some seeds
// are drawn here.
#include "experiments/cocktail_trial.hpp"

#include "experiments/bar_figures.hpp"
#include "experiments/worker_pool.hpp"
#include "loop/patient/steered_player.hpp"
#include "loop/realtime/allocation_counter.hpp"
#include "support/folder.hpp"
#include "support/rig_tools.hpp"
#include "support/seed.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>

namespace wholehand::test {
namespace {

ModelFiles barFiles(int level = 1) {
  return exerciseFiles("cocktail-bar", level);
}

CocktailResult play(int level, std::uint64_t seed) {
  CocktailPlan plan;
  plan.files = barFiles(level);
  plan.seed = seed;
  return orThrow(runCocktail(plan));
}

TEST(CocktailBar, EveryLevelWithRandomSeeds_IsCompletedWithinToleranceWithoutLoss) {
  auto random = seededRandom(72);
  for (const int level : sampleOne(1, 4)) {
    for (int i = 0; i < cases(1); ++i) {
      const std::uint64_t seed = 1 + random() % 1'000'000;
      const CocktailResult r = play(level, seed);
      const std::string of = "level " + std::to_string(level) + ", seed " + std::to_string(seed);
      EXPECT_TRUE(r.completed) << of;
      EXPECT_EQ(r.steps_in_tolerance, r.steps) << of;
      EXPECT_LE(r.volume_error_l, tolerance(1e-9)) << of;
      EXPECT_EQ(r.wrong_dispenser, 0) << of;
      EXPECT_GT(r.score, 70.0) << of;
      figure("score of " + of, r.score, "");
    }
  }
}

TEST(CocktailBar, SameSeed_IsBitIdenticalAndAnotherIsNot_slow) {
  const CocktailResult a = play(1, 5), b = play(1, 5), c = play(1, 6);
  EXPECT_EQ(a.score, b.score);
  EXPECT_EQ(a.amount_error_max_l, b.amount_error_max_l);
  EXPECT_EQ(a.time_s, b.time_s);
  EXPECT_NE(a.amount_error_max_l, c.amount_error_max_l);
}

TEST(CocktailBar, TickWithItsPlayer_AllocatesNothing) {
  if (!allocationCountingAvailable()) GTEST_SKIP() << "a sanitizer owns malloc here";
  Models models = load(barFiles());
  std::unique_ptr<Player> made = models.exercise->makePlayer({3});
  Player& player = *made;
  const auto rig = orThrow(buildRig(std::move(models), std::move(made), {}));
  ASSERT_TRUE(rig->renderer->arm().ok());
  TickRecord record;
  std::uint64_t allocations = 0;
  bool poured = false;
  for (int k = 0; k < 9000; ++k) {
    const AllocationScope scope;
    rig->renderer->tick(1, record);  // also advances the player
    player.onRecord(record);
    allocations += scope.allocations();
    poured = poured || record.exercise.values[0] == 2.0;  // stage: pouring
  }
  EXPECT_TRUE(poured);
  EXPECT_EQ(allocations, 0U);
}

TEST(CocktailBar, FreeDispenser_IsCarriedOverTheGlassAndPutBack) {
  auto random = seededRandom(73);
  CocktailPlan plan;
  plan.files = exerciseFiles("cocktail-bar-free");
  int completed = 0;
  for (int i = 0; i < cases(3); ++i) {
    plan.seed = 1 + random() % 1'000'000;
    const CocktailResult r = orThrow(runCocktail(plan));
    completed += r.completed ? 1 : 0;
    EXPECT_LE(r.volume_error_l, tolerance(1e-9)) << "seed " << plan.seed;
  }
  EXPECT_GE(completed, cases(3) - cases(1));  // one dispenser may slip out of the hand
}

Command command(CommandType type, Steering steering, const AxisPosition& aim = {}) {
  Command out;
  out.type = type;
  out.index = static_cast<std::int32_t>(steering);
  out.aim = aim;
  return out;
}

/// A person takes over the hand during a level, leads it among the dispensers and gives it back;
/// the virtual patient continues from there and finishes the level.
TEST(CocktailBar, HandTakenOverAndGivenBack_StillFinishesTheLevel) {
  Models models = load(barFiles());
  const int done = 5;  // stage "level done"
  auto steered = std::make_unique<SteeredPlayer>(models.exercise->makePlayer({4}), models.device);
  SteeredPlayer& player = *steered;
  const auto rig = orThrow(buildRig(std::move(models), std::move(steered), {}));
  ASSERT_TRUE(rig->renderer->arm().ok());
  AxisPosition aim(6);
  aim[0] = 0.03;
  aim[1] = 0.02;
  aim[3] = 1.2;
  TickRecord record;
  AxisPosition before;
  int tick = 0;
  for (; tick < 60000 && record.exercise.values[0] != done; ++tick) {
    if (tick == 4500) player.command(command(CommandType::kSteer, Steering::kPerson));
    if (tick == 4501) player.command(command(CommandType::kAim, Steering::kPerson, aim));
    if (tick == 6500) player.command(command(CommandType::kSteer, Steering::kVirtualPatient));
    rig->renderer->tick(1, record);
    player.onRecord(record);
    for (int a = 0; a < 6 && tick > 0; ++a) {
      // Stays within the device's limits: 1.5 m/s and 10 rad/s (lambda-pride.toml).
      const double limit = a < 3 ? 1.5e-3 : 10e-3;
      ASSERT_LE(std::abs(record.intention[a] - before[a]), limit) << "tick " << tick;
    }
    before = record.intention;
  }
  EXPECT_EQ(record.exercise.values[0], done) << "after " << tick << " ticks";
}

/// An episode in which a person takes over the hand, leads it and gives it back.
struct Visit {
  std::string exercise;
  int level = 1, begins = 0, ends = 0;  // [ticks]
  std::uint64_t seed = 0;
};

/// Largest step from aim to aim, as a share of each axis's range.
constexpr double kStep = 0.25;
constexpr int kAimEvery = 500;  // [ticks]

AxisPosition aimFrom(const AxisPosition& at, const DeviceModel& device, std::mt19937_64& random) {
  std::uniform_real_distribution<double> share(-kStep, kStep);
  AxisPosition aim = at;
  for (int a = 0; a < aim.size(); ++a) {
    const DeviceAxis& axis = device.axes[a];
    aim[a] += share(random) * (axis.upper - axis.lower);
    aim[a] = std::clamp(aim[a], axis.lower, axis.upper);
  }
  return aim;
}

/// Time from the return of the hand to the end of the level [s]. It is 0 if the level ended before,
/// or if a random aim stopped the device, since arming then restarts the level. Negative: the level
/// did not end within kWithin_s.
constexpr double kWithin_s = 240.0;
double finishAfter(const Visit& visit) {
  Models models = load(exerciseFiles(visit.exercise, visit.level));
  const DeviceModel device = models.device;
  auto steered = std::make_unique<SteeredPlayer>(models.exercise->makePlayer({visit.seed}), device);
  SteeredPlayer& player = *steered;
  const auto rig = orThrow(buildRig(std::move(models), std::move(steered), {}));
  orThrow(rig->renderer->arm());
  std::mt19937_64 random(visit.seed);
  TickRecord record;
  const int last = visit.ends + static_cast<int>(kWithin_s * 1000);
  for (int tick = 0; tick < last; ++tick) {
    const int visited = tick - visit.begins;
    if (visited == 0) player.command(command(CommandType::kSteer, Steering::kPerson));
    if (visited >= 0 && tick < visit.ends && visited % kAimEvery == 0) {
      const AxisPosition aim = aimFrom(record.intention, device, random);
      player.command(command(CommandType::kAim, Steering::kPerson, aim));
    }
    if (tick == visit.ends) player.command(command(CommandType::kSteer, Steering::kVirtualPatient));
    rig->renderer->tick(1, record);
    player.onRecord(record);
    if (rig->renderer->latched() != Fault::kNone) return tick < visit.ends ? 0.0 : -2.0;
    if (record.exercise.values[0] == 5.0) {  // stage: level done
      return std::max(0, tick - visit.ends) * 1e-3;
    }
  }
  return -1.0;
}

std::string wordsOf(const Visit& v) {
  return v.exercise + " level " + std::to_string(v.level) + ", seed " + std::to_string(v.seed) +
         ", " + std::to_string(v.begins) + " to " + std::to_string(v.ends);
}

/// Regression test: hands left between two bottles, or in a fist against one, stayed there forever
/// or sprang free beyond the device's speed limit.
TEST(CocktailBar, HandGivenBackWedged_GetsFreeAndFinishesTheLevel) {
  const Visit visits[] = {{"cocktail-bar", 1, 3'200, 6'205, 234'770},
                          {"cocktail-bar", 2, 13'787, 17'240, 789'258},
                          {"cocktail-bar", 2, 4'109, 6'156, 676'815},
                          {"cocktail-bar-free", 2, 24'627, 25'033, 572'286}};
  for (const int i : sampleOne(0, 3)) EXPECT_GT(finishAfter(visits[i]), 0.0) << wordsOf(visits[i]);
}

/// In 120 episodes all levels finished. One in forty is allowed for a hand that stays wedged or
/// springs free.
TEST(CocktailBar, HandGivenBackAnywhere_NearlyAlwaysFinishesTheLevel) {
  auto random = seededRandom(74);
  const auto draw = [&](int below) {
    return static_cast<int>(random() % static_cast<unsigned>(below));
  };
  int unfinished = 0;
  for (int i = 0; i < cases(2); ++i) {
    Visit visit;
    const bool free = draw(4) == 0;
    visit.exercise = free ? "cocktail-bar-free" : "cocktail-bar";
    visit.level = 1 + draw(free ? 2 : 4);
    visit.begins = 500 + draw(visit.level == 1 ? 8'000 : 25'000);
    visit.ends = visit.begins + 300 + draw(6'000);
    visit.seed = 1 + random() % 1'000'000;
    const double after_s = finishAfter(visit);
    if (after_s < 0.0) ++unfinished;
    figure("given back: " + wordsOf(visit), after_s, "s");
  }
  EXPECT_LE(unfinished, 1 + cases(2) / 20);  // 2.5 % are allowed
}

/// A spastic hand opens slowly. A hand with 0.5 N per digit gets thinner liquids, and one with
/// tremor a firmer squeeze, as docs/exercises.md proposes to the therapist.
TEST(CocktailBar, HandsOfPatients_CompleteEveryLevel) {
  struct Patient {
    const char* name;
    std::vector<std::pair<std::string, double>> parameters;
    double longest_step_s, spilt_l;  // upper bounds [s], [l]
  };
  const Patient patients[] = {{"spastic", {}, 60.0, 0.0},
                              {"weak", {{"viscosity_ratio", 0.1}}, 30.0, 0.0},
                              {"tremor", {{"squeeze_threshold_ratio", 2.0}}, 30.0, 0.01}};
  auto random = seededRandom(76);
  for (const int i : sampleOne(0, 2)) {
    const Patient& patient = patients[i];
    for (int k = 0; k < cases(2); ++k) {
      CocktailPlan plan;
      plan.files = barFiles(1 + static_cast<int>(random() % 4));
      plan.files.patient =
          fmt::format("{}/config/patients/{}.toml", WHOLEHAND_SOURCE_DIR, patient.name);
      plan.parameters = patient.parameters;
      plan.seed = 1 + random() % 1'000'000;
      SCOPED_TRACE(fmt::format("{}, level {}, seed {}", patient.name, plan.files.level, plan.seed));
      const CocktailResult r = orThrow(runCocktail(plan));
      EXPECT_TRUE(r.completed);
      EXPECT_LE(r.step_max_s, patient.longest_step_s);
      EXPECT_LE(r.spilt_l, patient.spilt_l);
    }
  }
}

/// When a hand leaves at full squeeze, the effort of the walls is gone within 2 s (if an open hand
/// still rests at the bottle, all but a hundredth: friction keeps a digit some thousandths of a
/// radian closed). No tick changes the sent effort by more than the device allows, and the bottle
/// stays usable: the level is played to its end.
TEST(CocktailBar, HandThatLeavesAtFullSqueeze_LeavesTheBottleUsable) {
  auto random = seededRandom(77);
  const char* const ways[] = {"lets go", "slips off", "stop", "gentle stop", "emergency stop"};
  for (const int how : sampleOne(0, 4)) {
    SCOPED_TRACE(ways[how]);
    Models models = load(barFiles(1 + static_cast<int>(random() % 4)));
    const DeviceModel device = models.device;
    const BarFigures figures(models.exercise->description());
    auto steered = std::make_unique<SteeredPlayer>(models.exercise->makePlayer({random()}), device);
    SteeredPlayer& player = *steered;
    const auto rig = orThrow(buildRig(std::move(models), std::move(steered), {}));
    orThrow(rig->renderer->arm());
    TickRecord record, last;
    const auto advance = [&] {
      last = record;
      rig->renderer->tick(1, record);
      player.onRecord(record);
    };
    int tick = 0;
    for (; tick < 60'000 && figures(BarFigures::kFlow, record.exercise) < 2e-3; ++tick) advance();
    ASSERT_LT(tick, 60'000);
    const int across = device.axisIndex("y"), fingers = device.axisIndex("finger_flexion"),
              thumb = device.axisIndex("thumb_flexion");
    AxisPosition aim = record.intention;
    const AxisEffort squeezed = record.exercise.effort;
    if (how == 0) {
      for (const int a : {fingers, thumb}) aim[a] = device.axes[a].lower;
    }
    if (how == 1) aim[across] = device.axes[across].lower;
    if (how <= 1) {
      player.command(command(CommandType::kSteer, Steering::kPerson));
      player.command(command(CommandType::kAim, Steering::kPerson, aim));
    }
    if (how == 2) rig->renderer->requestStop();
    if (how == 3) rig->renderer->requestGentleStop();
    if (how == 4) rig->renderer->requestEmergencyStop();
    for (int k = 0; k < 2000; ++k) {
      advance();
      for (int a = 0; a < aim.size(); ++a) {
        ASSERT_LE(std::abs(record.sent[a] - last.sent[a]),
                  1e-3 * device.axes[a].effort_slew_limit + 1e-12)
            << "axis " << a << ", tick " << k;
      }
    }
    for (int a = 0; a < aim.size(); ++a) {
      const bool rests = how <= 1 && record.contact_count > 0;
      const double most = rests ? 0.01 * std::abs(squeezed[a]) : 0.0;
      EXPECT_NEAR(record.exercise.effort.size() > a ? record.exercise.effort[a] : 0.0, 0.0,
                  most + 1e-12)
          << device.axes[a].name;
      if (how >= 2) EXPECT_EQ(record.sent[a], device.axes[a].neutral_effort) << a;
    }
    if (how >= 2) {
      orThrow(rig->renderer->arm());
    } else {
      player.command(command(CommandType::kSteer, Steering::kVirtualPatient));
    }
    record = TickRecord{};
    double lost_l = 0.0;
    for (tick = 0; tick < 240'000; ++tick) {
      advance();
      if (record.exercise.value_count == 0) continue;
      lost_l = std::max(lost_l, figures.volumeError_l(record.exercise));
      if (figures(BarFigures::kStage, record.exercise) == BarFigures::kLevelDone) break;
    }
    EXPECT_LT(tick, 240'000);
    EXPECT_LE(lost_l, tolerance(1e-12));
  }
}

/// Hands of 150 to 215 mm are certified and armed, and play the bar.
TEST(CocktailBar, HandOfAnyLength_IsArmedAndServesADrink) {
  auto random = seededRandom(78);
  for (int i = 0; i < cases(2); ++i) {
    const double length_m = 0.150 + 0.065 * static_cast<double>(random() % 1000) / 999.0;
    const double breadth_m = length_m * (0.42 + 0.04 * static_cast<double>(random() % 100) / 99.0);
    std::ifstream shipped(exerciseFiles("cocktail-bar").hand);
    std::string text;
    for (std::string line; std::getline(shipped, line); text += line + "\n") {
      if (line.rfind("length_m", 0) == 0) line = fmt::format("length_m = {:.4f}", length_m);
      if (line.rfind("breadth_m", 0) == 0) line = fmt::format("breadth_m = {:.4f}", breadth_m);
    }
    const Folder folder;
    CocktailPlan plan;
    plan.files = barFiles();
    plan.files.hand = folder.write("hand.toml", text);
    plan.seed = 1 + random() % 1'000'000;
    const std::string of =
        fmt::format("{:.1f} x {:.1f} mm, seed {}", 1e3 * length_m, 1e3 * breadth_m, plan.seed);
    const Expected<CocktailResult> r = runCocktail(plan);
    ASSERT_TRUE(r.ok()) << of << ": " << format(r.errors());
    EXPECT_TRUE(r->ended) << of;
    EXPECT_FALSE(r->faulted) << of;
    figure("score of a hand of " + of, r->score, "");
  }
}

TEST(CocktailBar, UnknownParameter_IsRefusedByName) {
  CocktailPlan plan;
  plan.files = barFiles();
  for (const auto& [name, value] : {std::pair{"viscosity", 1.0}, {"viscosity_ratio", 3.0}}) {
    plan.parameters = {{name, value}};
    const auto refused = runCocktail(plan);
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.errors().front().key, name);
  }
}

TEST(CocktailBar, ExerciseWithoutAGoal_IsRefused) {
  CocktailPlan plan;
  plan.files = exerciseFiles("free-grasping");
  EXPECT_FALSE(runCocktail(plan).ok());
}

TEST(WorkerPool, EveryJob_IsDoneOnceForAnyNumberOfProcesses) {
  for (const int workers : {1, 3, 20}) {
    std::vector<int> reported(10, 0);
    const bool complete = workInProcesses(
        10, workers, [](int job) { return std::to_string(job * job); },
        [&](int job, const std::string& line) {
          ++reported.at(static_cast<std::size_t>(job));
          EXPECT_EQ(line, std::to_string(job * job));
        });
    EXPECT_TRUE(complete);
    EXPECT_EQ(std::count(reported.begin(), reported.end(), 1), 10) << workers;
  }
}

TEST(WorkerPool, WorkerThatDies_IsReported) {
  EXPECT_FALSE(workInProcesses(
      4, 2,
      [](int job) -> std::string {
        if (job == 1) std::_Exit(1);
        return "done";
      },
      [](int, const std::string&) {}));
}

}  // namespace
}  // namespace wholehand::test
