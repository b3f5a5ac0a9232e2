#include "exercises/bar_table.hpp"
#include "exercises/squeeze_to_level/squeeze_task.hpp"
#include "rig/run/run.hpp"
#include "support/rig_tools.hpp"
#include "support/seed.hpp"

namespace wholehand::test {
namespace {

using squeeze_to_level::BandChange;
using squeeze_to_level::BandRules;
using squeeze_to_level::BandSteps;
using squeeze_to_level::Instruction;

const BandRules kRules{{{1.0, 2.0}, {3.0, 4.0}}, 0.5, 0.2};

int ticks(BandSteps& steps, double squeeze_n, int count) {
  int held = 0;
  for (int i = 0; i < count; ++i) held += steps.tick(squeeze_n, true, 1.0, kTick_s).held >= 0;
  return held;
}

TEST(BandSteps, AwayFromTheObject_AsksToReachThenToSqueezeMore) {
  BandSteps steps(kRules);
  (void)steps.tick(0.0, false, 1.0, kTick_s);
  EXPECT_EQ(steps.instruction(), Instruction::kReach);
  (void)steps.tick(0.0, true, 1.0, kTick_s);
  EXPECT_EQ(steps.instruction(), Instruction::kMore);
  (void)steps.tick(2.5, true, 1.0, kTick_s);
  EXPECT_EQ(steps.instruction(), Instruction::kLess);
}

TEST(BandSteps, HeldWithoutLeaving_GivesTheFullScore) {
  BandSteps steps(kRules);
  EXPECT_EQ(ticks(steps, 1.5, 500), 1);
  EXPECT_EQ(steps.instruction(), Instruction::kLetGo);
  EXPECT_NEAR(steps.score(), 50.0, 0.2);  // one of two bands; one tick more may pass
  EXPECT_EQ(ticks(steps, 0.1, 1), 0);
  EXPECT_EQ(ticks(steps, 3.5, 500), 1);
  EXPECT_FALSE(steps.done());
  EXPECT_TRUE(steps.tick(0.1, true, 1.0, kTick_s).done);
  EXPECT_NEAR(steps.score(), 100.0, 0.4);
}

/// Half a second within the band in total and half a second beyond it: 0.5 / 1.0 of one of two
/// bands.
TEST(BandSteps, LeavingAsLongAsHolding_HalvesTheBandsScore) {
  BandSteps steps(kRules);
  (void)ticks(steps, 1.5, 250);
  (void)ticks(steps, 2.5, 500);
  EXPECT_EQ(ticks(steps, 1.5, 250), 1);
  EXPECT_NEAR(steps.score(), 25.0, 0.2);
}

TEST(BandSteps, WithoutLettingGo_TheNextBandDoesNotBegin) {
  BandSteps steps(kRules);
  (void)ticks(steps, 1.5, 500);
  EXPECT_EQ(ticks(steps, 3.5, 2000), 0);
  EXPECT_EQ(steps.band(), 0);
}

TEST(BandSteps, HalfTheLevel_NeedsHalfTheForce) {
  BandSteps steps(kRules);
  BandChange news;
  for (int i = 0; i < 501 && news.held < 0; ++i) news = steps.tick(0.75, true, 0.5, kTick_s);
  EXPECT_EQ(news.held, 0);
}

/// The virtual patient completes it with every shipped hand, within the limits, and its results are
/// reported.
TEST(SqueezeToLevel, PlayedByItsVirtualPatient_IsCompletedWithin25s) {
  for (const std::string& hand :
       sampleTenth<std::string>({"adult-median-right", "adult-median-left"})) {
    SCOPED_TRACE(hand);
    Models models = load(exerciseFiles("squeeze-to-level", 1, hand));
    std::unique_ptr<Player> player = models.exercise->makePlayer({7});
    ASSERT_NE(player, nullptr);
    const auto rig = orThrow(buildRig(std::move(models), std::move(player), RigOptions{}));
    ASSERT_TRUE(rig->renderer->arm());
    TickStatistics statistics;
    runTicks(*rig->renderer, 25'000, [&](const TickRecord& r) {
      EXPECT_EQ(r.faults & kStoppingFaults, Fault::kNone);
      rig->listener->afterTick(r);
      statistics.add(r);
    });
    const auto results = exerciseResults(rig->models, statistics.snapshot());
    ASSERT_EQ(results.size(), 2U);
    EXPECT_EQ(results[0].name, "bands_done");
    EXPECT_EQ(results[0].value, 3.0);
    EXPECT_EQ(results[0].shown, "Levels done 3");
    EXPECT_EQ(results[1].name, "score");
    EXPECT_GT(results[1].value, 50.0);
    EXPECT_LE(results[1].value, 100.0);
    std::printf("figure: %s, score %.0f\n", hand.c_str(), results[1].value);
  }
}

}  // namespace
}  // namespace wholehand::test
