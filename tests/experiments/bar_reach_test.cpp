// The bar for an arm that does not reach far, with the real physics: the row comes, a drink is
// mixed.
#include "experiments/bar_figures.hpp"
#include "support/rig_tools.hpp"

#include <cstddef>

namespace wholehand::test {
namespace {

TEST(BarWithShortReach, DrinkOfEitherHand_IsMixedWithinIt) {
  for (const char* name : {"adult-median-right", "woman-p50-left"}) {
    SCOPED_TRACE(name);
    ModelFiles files = shippedFiles("lambda-pride", "empty", name);
    files.scene.clear();
    files.exercise = std::string(WHOLEHAND_SOURCE_DIR) + "/config/exercises/cocktail-bar.toml";
    files.level = 2;
    Models models = load(files);
    const BarFigures figures(models.exercise->description());
    const int lemon = models.scene.bodyIndex("dispenser_lemon");
    std::unique_ptr<Player> made = models.exercise->makePlayer(1);
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
    for (int k = 0; k < 60'000 && poured_l < 0.043; ++k) {  // sunset: 30 and 20 ml, 5 ml off each
      rig->renderer->tick(1, record);
      player->see(record);
      ASSERT_EQ(record.faults & kStopping, Fault::kNone) << "tick " << k;
      poured_l = figures(BarFigures::kPouredTotal, record.exercise);
      nearest_m = std::min(nearest_m, record.bodies[lemon].position_m.x);
    }
    EXPECT_GE(poured_l, 0.043);
    EXPECT_LT(nearest_m, 0.119 - 0.005);  // of the scene: 0.119
  }
}

}  // namespace
}  // namespace wholehand::test
