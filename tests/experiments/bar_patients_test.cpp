// Every shipped hand plays every level of both bars to its end, each with 50 seeds; only a sample
// of these plays is run by default.
#include "experiments/bar_figures.hpp"
#include "experiments/cocktail_trial.hpp"
#include "experiments/worker_pool.hpp"
#include "support/rig_tools.hpp"
#include "support/seed.hpp"
#include "support/shipped.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <sstream>
#include <thread>

namespace wholehand::test {
namespace {

struct Play {
  std::string exercise, hand;
  int level = 1;
  std::uint64_t seed = 1;
};

std::string nameOf(const Play& p) {
  return fmt::format("{}, level {}, {}, seed {}", p.exercise, p.level, p.hand, p.seed);
}

CocktailPlan planOf(const Play& p) {
  CocktailPlan plan;
  plan.files = exerciseFiles(p.exercise, p.level, p.hand);
  plan.seed = p.seed;
  return plan;
}

/// A play that once spilled forever from a bottle that leaned in the hand.
const Play kFound{"cocktail-bar-free", "woman-p05-right", 2, 11};

std::vector<Play> playsDrawn() {
  std::vector<Play> all;
  for (const std::string& hand : shipped("hands")) {
    for (int level = 1; level <= 4; ++level) {
      for (std::uint64_t seed = 1; seed <= 50; ++seed) {
        all.push_back({"cocktail-bar", hand, level, seed});
        if (level <= 2) all.push_back({"cocktail-bar-free", hand, level, seed});
      }
    }
  }
  if (fullCounts()) return all;
  auto random = seededRandom(75);
  std::vector<Play> drawn = {kFound};
  if (kReducedCounts) return drawn;
  for (const std::size_t i : sampleOf(all.size(), 2, random)) drawn.push_back(all[i]);
  return drawn;
}

/// The level must end; its result is reported, and nothing is lost on the way.
TEST(EveryHandAtTheBar, VirtualPatient_PlaysTheLevelToItsEnd) {
  const std::vector<Play> plays = playsDrawn();
  int completed = 0;
  double longest_s = 0.0;
  const bool all_done = workInProcesses(
      static_cast<int>(plays.size()),
      static_cast<int>(std::max(1U, std::thread::hardware_concurrency())),
      [&](int job) {
        const auto r = runCocktail(planOf(plays[job]));
        if (!r) return format(r.errors());
        return fmt::format("{:d} {:d} {:d} {} {} {}", r->ended, r->completed, r->faulted,
                           r->volume_error_l, r->time_s, r->score);
      },
      [&](int job, const std::string& line) {
        const std::string name = nameOf(plays[job]);
        std::istringstream in(line);
        bool ended = false, done = false, faulted = true;
        double error_l = 1.0, time_s = 0.0, score = 0.0;
        in >> ended >> done >> faulted >> error_l >> time_s >> score;
        EXPECT_TRUE(ended) << name << ": " << line;
        EXPECT_FALSE(faulted) << name;
        EXPECT_LE(error_l, tolerance(1e-9)) << name;
        completed += done ? 1 : 0;
        longest_s = std::max(longest_s, time_s);
        if (!done) figure("points of " + name + ", a step beyond its tolerance", score, "");
      });
  EXPECT_TRUE(all_done);
  figure("plays", static_cast<double>(plays.size()), "");
  figure("completed within tolerance", completed, "");
  figure("longest", longest_s, "s");
}

// The bar for an arm with a short reach, with the real physics: the row of bottles comes to the
// hand and a drink is mixed.

TEST(BarWithShortReach, DrinkForEitherHand_IsMixedWithinTheShortReach) {
  for (const int side : sampleOne(0, 1)) {
    const char* name = side == 0 ? "adult-median-right" : "woman-p50-left";
    SCOPED_TRACE(name);
    Models models = load(exerciseFiles("cocktail-bar", 2, name));
    const BarFigures figures(models.exercise->description());
    const int lemon = models.scene.bodyIndex("dispenser_lemon");
    std::unique_ptr<Player> made = models.exercise->makePlayer({1});
    Player* const player = made.get();
    const auto rig = orThrow(buildRig(std::move(models), std::move(made), {}));
    std::vector<double> values = rig->renderer->parametersAtStart();
    const std::vector<LiveParameter> all = rig->renderer->liveParameters();
    const auto set = [&](const std::string& parameter, double value) {
      const auto at = std::find_if(all.begin(), all.end(),
                                   [&](const LiveParameter& p) { return p.name == parameter; });
      ASSERT_NE(at, all.end()) << parameter;
      values[at - all.begin()] = value;
    };
    set("reach_left_m", 0.04);
    set("reach_right_m", 0.04);
    set("reach_forward_m", 0.06);
    rig->renderer->startParametersAt(values);
    ASSERT_TRUE(rig->renderer->arm());
    TickRecord record;
    double poured_l = 0.0, nearest_m = 1.0;
    for (int k = 0; k < 60'000 && poured_l < 0.022;
         ++k) {  // sunset: 16 and 12 ml, each within 4 ml
      rig->renderer->tick(1, record);
      player->onRecord(record);
      ASSERT_EQ(record.faults & kStoppingFaults, Fault::kNone) << "tick " << k;
      poured_l = figures(BarFigures::kPouredTotal, record.exercise);
      nearest_m = std::min(nearest_m, record.bodies[lemon].position_m.x);
    }
    EXPECT_GE(poured_l, 0.022);
    EXPECT_LT(nearest_m, 0.119 - 0.005);  // the scene places it at 0.119 m
  }
}

}  // namespace
}  // namespace wholehand::test
