// Two devices combined to one; the test sets their samples and answers.
#include "drivers/composite/composite.hpp"

#include "loop/realtime/allocation_counter.hpp"
#include "support/figure.hpp"
#include "support/seed.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace wholehand::test {
namespace {

std::int64_t simulated_ns = 0;  // the clock of the parts and of the whole

/// A driver whose times, sequences and answers the test sets.
class SetDriver final : public DeviceDriver {
 public:
  explicit SetDriver(std::vector<std::string> names) {
    for (const std::string& name : names) {
      wh_axis axis{};
      axis.size = sizeof(axis);
      name.copy(axis.name, sizeof(axis.name) - 1);
      axes_.push_back(axis);
    }
    sample.status = WH_ENABLED | WH_HOMED;
    sample.valid = (1U << axes_.size()) - 1U;
  }
  [[nodiscard]] std::string where() const override { return "the driver set"; }
  [[nodiscard]] std::string name() const override { return "set"; }
  [[nodiscard]] const std::vector<wh_axis>& axes() const noexcept override { return axes_; }
  [[nodiscard]] Expected<Done> control(std::uint32_t verb, double) override {
    verbs.push_back(verb);
    if (verb == refused_verb) return fileFault(where(), "did not", "look");
    return Done{};
  }
  [[nodiscard]] int read(wh_sample& to) noexcept override {
    to = sample;
    return read_result;
  }
  [[nodiscard]] int write(const wh_command& command) noexcept override {
    given = command;
    return write_result;
  }
  void name(DriverIdentity identity) { identity_ = std::move(identity); }
  void take(std::int64_t monotonic_ns) {
    ++sample.sequence;
    sample.monotonic_ns = monotonic_ns;
    simulated_ns = std::max(simulated_ns, monotonic_ns);
  }

  wh_sample sample{};
  wh_command given{};
  int read_result = WH_OK, write_result = WH_OK;
  std::uint32_t refused_verb = 99;
  std::vector<std::uint32_t> verbs;

 private:
  std::vector<wh_axis> axes_;
};

class CompositeParts : public testing::Test {
 protected:
  CompositeParts() {
    simulated_ns = 0;
    CompositeConfig config;
    config.longest_skew_s = 0.005;
    config.parts[0].axes = {"y", "x"};
    config.parts[1].axes = {"finger_flexion"};
    whole_ =
        orThrow(Composite::make(config, {base_, hand_}, []() noexcept { return simulated_ns; }));
    both(1'000'000, 1'000'000);
    EXPECT_TRUE(whole_->control(WH_ENABLE, 0.0));
  }
  void both(std::int64_t base_ns, std::int64_t hand_ns) {
    base_->take(base_ns);
    hand_->take(hand_ns);
  }
  wh_sample read() {
    wh_sample sample{};
    sample.size = sizeof(sample);
    result_ = whole_->read(sample);
    return sample;
  }
  static wh_command command() {
    wh_command command{};
    command.size = sizeof(command);
    command.axes = 3;
    command.sequence = 9;
    command.effort[0] = 1.0, command.effort[1] = 2.0, command.effort[2] = 3.0;
    return command;
  }

  std::shared_ptr<SetDriver> base_ =
      std::make_shared<SetDriver>(std::vector<std::string>{"x", "y", "z"});
  std::shared_ptr<SetDriver> hand_ =
      std::make_shared<SetDriver>(std::vector<std::string>{"thumb", "finger_flexion"});
  std::unique_ptr<Composite> whole_;
  int result_ = 0;
};

TEST_F(CompositeParts, AxesPositionsAndEfforts_AreInTheFilesOrder) {
  base_->sample.position[0] = 0.01, base_->sample.position[1] = 0.02;
  hand_->sample.position[1] = 0.5;
  hand_->sample.effort[1] = -0.25;
  const wh_sample sample = read();
  ASSERT_EQ(whole_->axes().size(), 3U);
  EXPECT_STREQ(whole_->axes()[0].name, "y");
  EXPECT_EQ(sample.position[0], 0.02);
  EXPECT_EQ(sample.position[1], 0.01);
  EXPECT_EQ(sample.position[2], 0.5);
  EXPECT_EQ(sample.effort[2], -0.25);
  EXPECT_EQ(sample.valid, 7U);
  ASSERT_EQ(whole_->write(command()), WH_OK);
  EXPECT_EQ(base_->given.effort[1], 1.0);
  EXPECT_EQ(base_->given.effort[0], 2.0);
  EXPECT_EQ(base_->given.effort[2], 0.0) << "an axis that the file does not name";
  EXPECT_EQ(hand_->given.effort[1], 3.0);
  EXPECT_EQ(base_->given.axes, 3U);
  EXPECT_EQ(hand_->given.axes, 2U);
  EXPECT_EQ(hand_->given.sequence, 9U);
}

TEST_F(CompositeParts, Identity_NamesBothPartsOrNeither) {
  EXPECT_EQ(whole_->identity().serial, "");
  base_->name({"B-1", "1.0", "sdk"});
  EXPECT_EQ(whole_->identity().serial, "");
  hand_->name({"H-7", "2.0", "frame 1"});
  EXPECT_EQ(whole_->identity().serial, "B-1 + H-7");
  EXPECT_EQ(whole_->identity().firmware, "1.0 + 2.0");
  EXPECT_EQ(whole_->identity().sdk, "sdk + frame 1");
}

TEST_F(CompositeParts, Status_CombinesBothParts) {
  const struct {
    std::uint32_t base, hand, whole;
  } cases[] = {{WH_ENABLED | WH_HOMED, WH_HOMED, WH_HOMED},
               {WH_ENABLED, WH_ENABLED | WH_HOMED, WH_ENABLED},
               {WH_ENABLED | WH_HOMED, WH_ENABLED | WH_HOMED | WH_DRIVE_FAULT,
                WH_ENABLED | WH_HOMED | WH_DRIVE_FAULT},
               {WH_ENABLED | WH_HOMED | WH_SILENCED, WH_ENABLED | WH_HOMED | WH_HOT,
                WH_ENABLED | WH_HOMED | WH_SILENCED | WH_HOT}};
  for (const auto& one : cases) {
    base_->sample.status = one.base;
    hand_->sample.status = one.hand;
    EXPECT_EQ(read().status, one.whole);
  }
}

// docs/composite.md: the efforts of the other part are judged in full.
TEST_F(CompositeParts, DeratingOfOnePart_NamesItsAxesOnly) {
  EXPECT_EQ(read().derating, 0U);
  hand_->sample.status |= WH_DERATING;
  EXPECT_EQ(read().derating, 4U);
  EXPECT_NE(read().status & WH_DERATING, 0U);
  base_->sample.status |= WH_DERATING;
  EXPECT_EQ(read().derating, 7U);
  base_->sample.derating = 1U << 1U;  // its y, the first of the whole
  EXPECT_EQ(read().derating, 5U);
  hand_->sample.status &= ~static_cast<std::uint32_t>(WH_DERATING);
  base_->sample.derating = 1U << 2U;  // its z, which the whole does not have
  EXPECT_EQ(read().status & (WH_DERATING | WH_HOT), WH_HOT) << "no axis of the whole derates";
}

TEST_F(CompositeParts, SkewBeyondTheBound_InvalidatesTheOlderAxesUntilItFalls) {
  both(20'000'000, 15'000'000);
  EXPECT_EQ(read().valid, 7U) << "5 ms are allowed";
  both(30'000'000, 24'999'999);
  wh_sample sample = read();
  EXPECT_EQ(sample.valid, 3U) << "the hand's axis is older";
  EXPECT_EQ(sample.monotonic_ns, 24'999'999);
  both(31'000'000, 40'000'000);
  EXPECT_EQ(read().valid, 4U) << "the base's axes are";
  both(41'000'000, 41'000'000);
  EXPECT_EQ(read().valid, 7U);
  EXPECT_EQ(whole_->largestSkew_ns(), 9'000'000);
}

TEST_F(CompositeParts, Sequence_RisesOnlyIfAPartHasANewSample) {
  const std::uint64_t first = read().sequence;
  EXPECT_EQ(read().sequence, first);
  EXPECT_EQ(result_, WH_NOTHING_NEW);
  hand_->take(2'000'000);
  EXPECT_EQ(read().sequence, first + 1);
  EXPECT_EQ(result_, WH_OK);
}

TEST_F(CompositeParts, PartWithoutASample_IsLostAndTheOtherStillTakesEfforts) {
  (void)read();
  hand_->read_result = WH_FAILED;
  both(2'000'000, 2'000'000);
  wh_sample sample = read();
  EXPECT_GE(result_, 0);
  EXPECT_EQ(sample.valid, 3U);
  EXPECT_EQ(sample.status & WH_ENABLED, 0U);
  hand_->write_result = WH_FAILED;
  EXPECT_EQ(whole_->write(command()), WH_OK);
  EXPECT_EQ(base_->given.effort[0], 2.0);
  hand_->read_result = hand_->write_result = WH_OK;
  both(3'000'000, 3'000'000);
  EXPECT_EQ(read().valid, 3U) << "until it is enabled anew";
  ASSERT_TRUE(whole_->control(WH_ENABLE, 0.0));
  EXPECT_EQ(read().valid, 7U);
}

// Arming reads the position first: a loss of the last session must not refuse it.
TEST_F(CompositeParts, LossOfASession_EndsWithWhDisable) {
  (void)read();
  hand_->read_result = WH_FAILED;
  EXPECT_EQ(read().valid, 3U);
  ASSERT_TRUE(whole_->control(WH_DISABLE, 0.0));
  EXPECT_EQ(read().valid, 3U) << "it still gives no sample";
  hand_->read_result = WH_OK;
  both(2'000'000, 2'000'000);
  EXPECT_EQ(read().valid, 7U);
}

TEST_F(CompositeParts, PartThatStaysEnabledAfterWhDisable_IsReported) {
  for (SetDriver* stays : {base_.get(), hand_.get()}) {
    base_->sample.status = hand_->sample.status = WH_ENABLED | WH_HOMED;
    ASSERT_TRUE(whole_->control(WH_ENABLE, 0.0));
    ASSERT_TRUE(whole_->control(WH_DISABLE, 0.0));
    base_->sample.status = hand_->sample.status = WH_HOMED;
    EXPECT_EQ(read().status & WH_ENABLED, 0U);
    stays->sample.status = WH_ENABLED | WH_HOMED;
    EXPECT_NE(read().status & WH_ENABLED, 0U);
  }
}

TEST_F(CompositeParts, CommandThatIsNotFiniteOrWhileDisabled_ReachesNeitherPart) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      base_->given = hand_->given = {};
      wh_command wrong = command();
      wrong.effort[axis] = bad;
      EXPECT_EQ(whole_->write(wrong), WH_FAILED);
      EXPECT_EQ(base_->given.axes, 0U);
      EXPECT_EQ(hand_->given.axes, 0U);
    }
  }
  EXPECT_EQ(whole_->write(command()), WH_OK) << "the command after it";
  ASSERT_TRUE(whole_->control(WH_DISABLE, 0.0));
  base_->given = hand_->given = {};
  EXPECT_EQ(whole_->write(command()), WH_FAILED);
  EXPECT_EQ(base_->given.axes, 0U);
  EXPECT_EQ(hand_->given.axes, 0U);
}

TEST_F(CompositeParts, PartWhoseWatchdogReleased_GetsNoCommandUntilWhEnable) {
  for (SetDriver* silent : {base_.get(), hand_.get()}) {
    SetDriver* well = silent == base_.get() ? hand_.get() : base_.get();
    (void)read();
    silent->sample.status = WH_ENABLED | WH_HOMED | WH_SILENCED;
    both(simulated_ns + 1'000'000, simulated_ns + 1'000'000);
    (void)read();
    silent->sample.status = WH_ENABLED | WH_HOMED;
    both(simulated_ns + 1'000'000, simulated_ns + 1'000'000);
    (void)read();
    base_->given = hand_->given = {};
    EXPECT_EQ(whole_->write(command()), WH_OK);
    EXPECT_EQ(silent->given.axes, 0U);
    EXPECT_NE(well->given.axes, 0U) << "it follows the loop's ramp";
    ASSERT_TRUE(whole_->control(WH_ENABLE, 0.0));
    EXPECT_EQ(whole_->write(command()), WH_OK);
    EXPECT_NE(silent->given.axes, 0U);
  }
}

TEST_F(CompositeParts, SamplesThatRunBackwards_LoseTheirPart) {
  both(10'000'000, 10'000'000);
  (void)read();
  --base_->sample.sequence;
  EXPECT_EQ(read().valid, 4U);
  ASSERT_TRUE(whole_->control(WH_ENABLE, 0.0));
  both(10'000'000, 10'000'000);
  EXPECT_EQ(read().valid, 7U);
  hand_->take(9'000'000);
  EXPECT_EQ(read().valid, 3U);
}

TEST_F(CompositeParts, SampleOfTheFuture_LosesItsPart) {
  (void)read();
  both(2'000'000, 2'000'000);
  (void)read();
  both(3'000'000, 5'000'001);
  simulated_ns = 4'000'000;
  EXPECT_EQ(read().valid, 3U) << "1 ms ahead is allowed";
}

// Nobody reads between WH_ENABLE and the first tick, and some drives send a sample after a command.
TEST_F(CompositeParts, PauseBeforeTheFirstCommand_LosesNoPart) {
  (void)read();
  simulated_ns += 900'000'000;
  EXPECT_EQ(read().valid, 7U);
  EXPECT_EQ(whole_->write(command()), WH_OK);
  simulated_ns += 19'000'000;
  EXPECT_EQ(read().valid, 7U);
  simulated_ns += 2'000'000;
  EXPECT_EQ(result_, WH_NOTHING_NEW);
  (void)read();
  EXPECT_EQ(result_, WH_FAILED) << "neither part gave a new sample for 21 ms";
}

TEST_F(CompositeParts, BothLost_FailsReadsAndWrites) {
  base_->read_result = hand_->read_result = WH_FAILED;
  (void)read();
  EXPECT_EQ(result_, WH_FAILED);
  EXPECT_EQ(whole_->write(command()), WH_FAILED);
}

TEST_F(CompositeParts, PartThatCannotBeEnabled_LeavesNeitherEnabled) {
  hand_->refused_verb = WH_ENABLE;
  EXPECT_FALSE(whole_->control(WH_ENABLE, 0.0));
  EXPECT_EQ(base_->verbs.back(), static_cast<std::uint32_t>(WH_DISABLE));
}

TEST_F(CompositeParts, PartThatCannotBeDisabled_DoesNotPreventDisablingTheOther) {
  base_->refused_verb = WH_DISABLE;
  EXPECT_FALSE(whole_->control(WH_DISABLE, 0.0));
  EXPECT_EQ(hand_->verbs.back(), static_cast<std::uint32_t>(WH_DISABLE));
}

TEST_F(CompositeParts, ReadsAndWrites_AllocateNothing) {
  wh_sample sample{};
  sample.size = sizeof(sample);
  const wh_command effort = command();
  const std::uint64_t before = threadAllocations();
  for (int i = 0; i < 1000; ++i) {
    both(2'000'000 + i, 2'000'000);
    (void)whole_->read(sample);
    (void)whole_->write(effort);
  }
  EXPECT_EQ(threadAllocations(), before);
}

TEST_F(CompositeParts, DroppedWatchdogs_AreReportedOnceBothHaveLetGo) {
  hand_->refused_verb = WH_DROP_WATCHDOG;  // its watchdog can only be starved of commands
  ASSERT_TRUE(whole_->control(WH_DROP_WATCHDOG, 0.0));
  hand_->given = {};
  EXPECT_EQ(whole_->write(command()), WH_OK);
  EXPECT_EQ(base_->given.axes, 3U) << "its driver keeps quiet by itself";
  EXPECT_EQ(hand_->given.axes, 0U) << "nothing is written to it any more";
  for (SetDriver* first : {base_.get(), hand_.get()}) {
    SetDriver* second = first == base_.get() ? hand_.get() : base_.get();
    first->sample.status = WH_HOMED | WH_SILENCED;
    second->sample.status = WH_ENABLED | WH_HOMED;
    EXPECT_EQ(read().status & WH_SILENCED, 0U) << "the other one has no watchdog yet";
    EXPECT_NE(read().status & WH_ENABLED, 0U);
    second->sample.status = WH_HOMED;
    EXPECT_NE(read().status & WH_SILENCED, 0U);
  }
  ASSERT_TRUE(whole_->control(WH_ENABLE, 0.0));
  base_->sample.status = WH_ENABLED | WH_HOMED | WH_SILENCED;
  hand_->sample.status = WH_ENABLED | WH_HOMED;
  EXPECT_NE(read().status & WH_SILENCED, 0U) << "in use one is enough";
}

/// Two parts that give samples at rates of their own. From some time on, one gives nothing new, and
/// its times go on.
struct Rates {
  std::array<std::int64_t, 2> every_ns{}, longest_gap_ns{};
  int silent = -1;  ///< the part that falls silent; -1: none
  std::int64_t silent_ns = 0;
};

/// Reads and writes once a period for `until_ns`. Returns the time from the last new sample of the
/// silent part to the first sample of the whole that says so; -1: none says so.
std::int64_t faultAfter_ns(const Rates& rates, std::int64_t period_ns, std::int64_t until_ns) {
  simulated_ns = 1'000'000'000;
  const std::int64_t begun_ns = simulated_ns;
  const std::array<std::shared_ptr<SetDriver>, 2> parts = {
      std::make_shared<SetDriver>(std::vector<std::string>{"x"}),
      std::make_shared<SetDriver>(std::vector<std::string>{"y"})};
  CompositeConfig config;
  config.longest_skew_s = 1.0;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    config.parts[p].axes = {p == 0 ? "x" : "y"};
    config.parts[p].longest_gap_s = static_cast<double>(rates.longest_gap_ns[p]) * 1e-9;
    parts[p]->take(simulated_ns);
  }
  const auto whole = orThrow(
      Composite::make(config, {parts[0], parts[1]}, []() noexcept { return simulated_ns; }));
  EXPECT_TRUE(whole->control(WH_ENABLE, 0.0));
  std::array<std::int64_t, 2> last_ns = {simulated_ns, simulated_ns};
  wh_command command{};
  command.size = sizeof(command);
  command.axes = 2;
  for (; simulated_ns < begun_ns + until_ns; simulated_ns += period_ns) {
    for (std::size_t p = 0; p < parts.size(); ++p) {
      const bool silent =
          static_cast<int>(p) == rates.silent && simulated_ns >= begun_ns + rates.silent_ns;
      parts[p]->read_result = WH_NOTHING_NEW;
      if (silent) {
        parts[p]->sample.monotonic_ns = simulated_ns;
      } else if (simulated_ns - last_ns[p] >= rates.every_ns[p]) {
        parts[p]->take(simulated_ns);
        parts[p]->read_result = WH_OK;
        last_ns[p] = simulated_ns;
      }
    }
    wh_sample sample{};
    sample.size = sizeof(sample);
    const int result = whole->read(sample);
    ++command.sequence;
    (void)whole->write(command);
    const bool whole_is_well =
        result >= 0 && sample.valid == 3U && (sample.status & WH_ENABLED) != 0;
    if (whole_is_well) continue;
    const std::size_t lost = rates.silent < 0 ? 0 : static_cast<std::size_t>(rates.silent);
    if (result >= 0) EXPECT_EQ(sample.valid, lost == 0 ? 2U : 1U) << "the axis of the silent part";
    EXPECT_EQ(sample.status & WH_ENABLED, 0U);
    return simulated_ns - last_ns[lost];
  }
  return -1;
}

Rates randomRates(std::mt19937_64& random) {
  Rates rates;
  for (std::size_t p = 0; p < 2; ++p) {
    rates.longest_gap_ns[p] = std::llround(uniform(random, 4.0, 40.0) * 1e6);
    const double most_ms = 0.5 * static_cast<double>(rates.longest_gap_ns[p]) * 1e-6;
    rates.every_ns[p] = std::llround(uniform(random, 0.25, most_ms) * 1e6);
  }
  return rates;
}

TEST(CompositeOfRates, PartThatGivesNothingNewWithFreshTimes_IsFoundWithinItsOwnGap) {
  auto random = seededRandom(5871);
  std::int64_t most_beyond_ns = 0;
  for (int run = 0; run < 400; ++run) {
    Rates rates = randomRates(random);
    rates.silent = run % 2;
    rates.silent_ns = std::llround(uniform(random, 60.0, 200.0) * 1e6);
    const std::int64_t period_ns = std::llround(uniform(random, 0.25, 1.5) * 1e6);
    const std::int64_t own_gap_ns = rates.longest_gap_ns[static_cast<std::size_t>(rates.silent)];
    const std::int64_t after_ns = faultAfter_ns(rates, period_ns, 400'000'000);
    ASSERT_GT(after_ns, own_gap_ns) << "run " << run << ": too early";
    ASSERT_LE(after_ns, own_gap_ns + period_ns) << "run " << run;
    most_beyond_ns = std::max(most_beyond_ns, after_ns - own_gap_ns);
  }
  figure("silent part of a composite, found after its own longest gap, at most",
         static_cast<double>(most_beyond_ns) * 1e-6, "ms");
}

TEST(CompositeOfRates, PartWithoutAStatedGap_IsFoundWithin20ms) {
  for (const int silent : {0, 1}) {
    const Rates rates{{1'000'000, 1'000'000},
                      {std::llround(CompositePart{}.longest_gap_s * 1e9),
                       std::llround(CompositePart{}.longest_gap_s * 1e9)},
                      silent,
                      100'000'000};
    const std::int64_t after_ns = faultAfter_ns(rates, 1'000'000, 400'000'000);
    EXPECT_GT(after_ns, 20'000'000);
    EXPECT_LE(after_ns, 21'000'000);
  }
}

TEST(CompositeOfRates, PartsWithinTheirGaps_AreNeverFaulted) {
  auto random = seededRandom(5872);
  for (int run = 0; run < 100; ++run) {
    const Rates rates = randomRates(random);
    const std::int64_t period_ns = std::llround(uniform(random, 0.25, 1.5) * 1e6);
    ASSERT_EQ(faultAfter_ns(rates, period_ns, 2'000'000'000), -1) << "run " << run;
  }
}

}  // namespace
}  // namespace wholehand::test
