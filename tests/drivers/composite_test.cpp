// Two devices combined to one; the test sets their samples and answers.
#include "drivers/composite/composite.hpp"

#include "loop/realtime/allocation_counter.hpp"
#include "support/figure.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

namespace wholehand::test {
namespace {

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
    CompositeConfig config;
    config.longest_skew_s = 0.005;
    config.parts[0].axes = {"y", "x"};
    config.parts[1].axes = {"finger_flexion"};
    whole_ = orThrow(Composite::make(config, {base_, hand_}));
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

}  // namespace
}  // namespace wholehand::test
