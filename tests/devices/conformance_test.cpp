// The conformance suite with drivers that break one rule each, and with correct drivers.
#include "devices/conformance/conformance.hpp"

#include "drivers/firmware_process.hpp"
#include "loop/realtime/allocation_counter.hpp"
#include "support/contains.hpp"
#include "support/folder.hpp"
#include "support/seed.hpp"
#include "support/watched_main.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <string>
#include <tuple>

namespace wholehand::test {
namespace {

DriverLocation builtAt(const std::string& name, const std::string& settings = {}) {
  return {std::string(WHOLEHAND_BINARY_DIR) + "/drivers/" + name + ".so", "", settings};
}

ConformanceOptions with(DriverLocation driver, const std::string& only,
                        double longest_check_s = 30.0) {
  seesRealTime();
  ConformanceOptions options;
  options.driver = std::move(driver);
  options.only = only;
  options.allow_effort = options.allow_beyond_limit = true;
  options.longest_check_s = longest_check_s;
  return options;
}

std::string failures(const std::vector<CheckResult>& results) {
  std::string out;
  for (const CheckResult& r : results) {
    if (r.finding.outcome == Outcome::kFailed) {
      out += std::string(r.check->id) + ": " + r.finding.text + "\n";
    }
  }
  return out;
}

// The finding of one check. A check that this machine delayed excuses the driver, so it is repeated
// up to `times` times.
CheckFinding findingOf(const std::string& id, const ConformanceOptions& options, int times = 5) {
  CheckFinding found;
  for (int k = 0; k < times && found.outcome != Outcome::kFailed; ++k) {
    for (const CheckResult& r : conform(options)) {
      if (id == r.check->id) found = r.finding;
    }
  }
  return found;
}

std::string groupOf(const std::string& id) {
  return id.substr(0, id.find('.') + 1);
}

/// What a composite makes of such a part.
enum class InWhole {
  kFound,        ///< the same check finds it
  kKept,         ///< the composite keeps the rule by itself: the check passes
  kNotMeasured,  ///< the axes of a part that is lost are not measured
  kNotNeutral,   ///< the other part's watchdog is reported; the effort remains
  kNoPart,       ///< it is not tried as a part
};

/// A driver that breaks the rule of one check: broken_driver.c with these settings, or
/// faulty_driver.c built as this object.
struct Broken {
  const char* name;
  const char* check;
  InWhole in_whole = InWhole::kFound;
  bool is_object = false;
};

class OneRuleBroken : public testing::TestWithParam<Broken> {};

TEST_P(OneRuleBroken, Defect_IsFoundByItsCheck) {
  const std::string id = GetParam().check;
  const DriverLocation driver =
      GetParam().is_object ? builtAt(GetParam().name) : builtAt("broken", GetParam().name);
  const bool uncounted = id == "time.read_allocations" && !allocationCountingAvailable();
  const CheckFinding found = findingOf(id, with(driver, id, 1.5), uncounted ? 1 : 5);
  if (uncounted) {
    EXPECT_EQ(found.outcome, Outcome::kSkipped) << "a sanitizer owns malloc";
    return;
  }
  EXPECT_EQ(found.outcome, Outcome::kFailed) << found.text;
  EXPECT_FALSE(found.text.empty());
}
const std::vector<Broken> kBroken = {
    {"exits", "lifecycle.open"},
    {"mute", "faults.open_says", InWhole::kKept},
    {"shared", "lifecycle.open_twice"},
    {"eager", "lifecycle.open_disabled"},
    {"chatty", "faults.lines"},
    {"leaks", "lifecycle.files"},
    {"overfills", "boundary.capacity", InWhole::kKept},
    {"oversized", "boundary.older_sample", InWhole::kKept},
    {"twins", "description.names_unique", InWhole::kNoPart},
    {"millimetres", "description.travel_plausible"},
    {"inverted", "description.travel_ordered"},
    {"limitless", "description.effort_finite"},
    {"milliseconds", "description.delay_plausible"},
    {"unwatched", "description.watchdog"},
    {"strict", "lifecycle.disable_first"},
    {"obliging", "lifecycle.unknown_verb", InWhole::kKept},
    {"stuck", "lifecycle.disable"},
    {"willing", "lifecycle.write_disabled", InWhole::kKept},
    {"backwards", "samples.sequence", InWhole::kNotMeasured},
    {"frozen", "samples.moves_on", InWhole::kNotMeasured},
    {"clock", "samples.clock", InWhole::kNotMeasured},
    {"walltime", "samples.clock_monotonic", InWhole::kNotMeasured},
    {"stale", "samples.age", InWhole::kNotMeasured},
    {"nan", "samples.position_finite"},
    {"missing", "samples.valid"},
    {"ghosts", "samples.valid_described", InWhole::kKept},
    {"hollow", "samples.nothing_new", InWhole::kNotMeasured},
    {"beyond", "samples.travel"},
    {"coarse", "samples.resolution"},
    {"hot", "samples.temperature"},
    {"codeless", "faults.code"},
    {"remembers", "commands.enabled_neutral"},
    {"rigid", "commands.sequence_restarts"},
    {"countless", "commands.more_axes", InWhole::kKept},
    {"gullible", "commands.nan", InWhole::kKept},
    {"reversed", "commands.sign"},
    {"unclipped", "commands.beyond_limit"},
    {"blocks", "time.read_wall"},
    {"sleeps", "time.read_waits"},
    {"computes", "time.read_cpu"},
    {"allocates", "time.read_allocations"},
    {"talks", "time.read_says"},
    {"forks", "time.read_processes"},
    {"ponders", "time.write_waits"},
    {"sleepless", "watchdog.silenced", InWhole::kNotNeutral},
    {"tardy", "watchdog.silenced", InWhole::kNotNeutral},
    {"forgiving", "watchdog.latched", InWhole::kKept},
    {"impatient", "watchdog.before_first"},
    {"undroppable", "watchdog.dropped"},
    {"none", "boundary.loads", InWhole::kNoPart, true},
    {"no_symbol", "boundary.symbol", InWhole::kNoPart, true},
    {"other_major", "boundary.major", InWhole::kNoPart, true},
    {"too_short", "boundary.size", InWhole::kNoPart, true},
    {"without_write", "boundary.functions", InWhole::kNoPart, true}};
INSTANTIATE_TEST_SUITE_P(Kinds, OneRuleBroken, testing::ValuesIn(kBroken),
                         [](const auto& tested) { return tested.param.name; });

/// One defect of one axis of broken_rails.c, and the check that must find it.
struct BrokenRail {
  const char* defect;
  const char* check;
  const char* axis = "y";
  bool of_all = false;  ///< both axes have the defect
};

class OneAxisBroken : public testing::TestWithParam<BrokenRail> {};

TEST_P(OneAxisBroken, Defect_IsFoundByItsCheckWithTheAxis) {
  const auto& [defect, id, axis, of_all] = GetParam();
  ConformanceOptions options = with(builtAt("broken_rails", std::string(defect) + " " + axis), id);
  options.known = {{"x", 0.25, 0.0}, {"y", 0.25, 0.0}};
  const CheckFinding found = findingOf(id, options, 3);
  EXPECT_EQ(found.outcome, Outcome::kFailed) << found.text;
  if (!of_all) EXPECT_TRUE(contains(found.text, axis)) << found.text;
}
// These defects passed an earlier suite that judged bits, measured efforts and the first axis.
const std::vector<BrokenRail> kBrokenRails = {
    {"late", "motion.delay"},           {"halved", "motion.measured"},
    {"turned", "motion.sign"},          {"holds", "commands.neutral_again"},
    {"watchdog_bit", "motion.silence"}, {"pushes", "motion.neutral"},
    {"nan_taken", "commands.nan"},      {"unlimited", "commands.beyond_limit"},
    {"repeats", "motion.jumps"},        {"old", "samples.age", "y", true},
    {"disable_bit", "motion.disable"},
};
// Defects of the first axis, and reports that differ from the motion.
const std::vector<BrokenRail> kMoreBrokenRails = {{"turned", "motion.sign", "x"},
                                                  {"watchdog_bit", "motion.silence", "x"},
                                                  {"disable_bit", "motion.disable", "x"},
                                                  {"holds", "motion.released"},
                                                  {"holds", "watchdog.neutral"},
                                                  {"holds", "commands.disabled_neutral"},
                                                  {"keeps_saying", "commands.disabled_neutral"},
                                                  {"ignores_neutral", "motion.released"},
                                                  {"halved_unsaid", "motion.mass"},
                                                  {"millinewton", "motion.moves"},
                                                  {"millimetre", "motion.within"},
                                                  {"old_unsaid", "motion.delay"},
                                                  {"fast_clock", "samples.clock_rate", "y", true},
                                                  {"unlimited_unsaid", "motion.limit"},
                                                  {"unlimited_back", "commands.beyond_limit"},
                                                  {"limits_sum", "commands.beyond_limit", "x"},
                                                  {"clips_unsaid", "commands.beyond_limit"},
                                                  {"encoder_turned", "motion.sign"},
                                                  {"swapped", "motion.alone", "x"},
                                                  {"positions_swapped", "motion.alone", "x"},
                                                  {"coupled", "motion.alone"},
                                                  {"dead", "motion.moves"},
                                                  {"weak", "motion.proportional"},
                                                  {"one_sided", "motion.proportional"},
                                                  {"both_one_way", "motion.proportional"},
                                                  {"lame_back", "motion.proportional"},
                                                  {"dead_zone", "motion.proportional"},
                                                  {"smoothed", "motion.delay"},
                                                  {"slewed", "motion.delay"},
                                                  // It answers arbitrarily late; the part that no
                                                  // mass explains depends on the earlier pushes.
                                                  {"integrated", "motion.delay"},
                                                  {"forgets", "motion.enable"},
                                                  {"remembers", "motion.enable"},
                                                  {"rezeroes", "motion.enable"},
                                                  {"outlives", "motion.close"},
                                                  {"tardy_off", "motion.disable"},
                                                  {"once", "motion.silence", "y", true},
                                                  {"patient", "motion.silence", "y", true},
                                                  {"sticky_bit", "watchdog.enable", "y", true},
                                                  {"sulks", "commands.after_bad", "y", true},
                                                  {"says_turned", "commands.sign"},
                                                  {"says_other", "motion.measured"},
                                                  {"says_gram", "motion.measured"},
                                                  {"drifts", "motion.rests"},
                                                  {"tenth", "motion.jumps"}};
std::string nameOfRail(const testing::TestParamInfo<BrokenRail>& tested) {
  const BrokenRail& rail = tested.param;
  std::string name = std::string(rail.defect) + "_" + rail.axis + "_" + rail.check;
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
}
INSTANTIATE_TEST_SUITE_P(Kinds, OneAxisBroken, testing::ValuesIn(sampleTenth(kBrokenRails)),
                         nameOfRail);
INSTANTIATE_TEST_SUITE_P(More, OneAxisBroken, testing::ValuesIn(sampleTenth(kMoreBrokenRails)),
                         nameOfRail);

/// Composite of two parts, each with one axis.
class PairOf {
 public:
  struct Part {
    std::string driver, settings, axis;
  };
  PairOf(const Part& first, const Part& second) {
    std::ofstream file(path_);
    file << "kind = \"composite\"\nversion = 1\nlongest_skew_s = 0.005\n";
    for (const Part& part : {first, second}) {
      file << "[[parts]]\ndriver = \"" << builtAt(part.driver).path << "\"\naxes = [\"" << part.axis
           << "\"]\n";
      if (!part.settings.empty()) file << "settings = \"" << part.settings << "\"\n";
    }
  }
  [[nodiscard]] DriverLocation location() const { return builtAt("composite", path_); }

 private:
  Folder folder_;
  std::string path_ = folder_.file("pair.toml");
};

class OneBadPart : public testing::TestWithParam<std::tuple<Broken, bool>> {};

// A part that breaks one rule, beside a part that breaks none.
TEST_P(OneBadPart, Defect_IsFoundInTheWholeOrKeptFromIt) {
  const auto& [part, bad_first] = GetParam();
  const bool of_x = std::string(part.name) == "hot";  // the defect of one axis
  const PairOf::Part bad{"broken", part.name, of_x ? "x" : "y"};
  const PairOf::Part good{"broken", "", of_x ? "y" : "x"};
  const PairOf pair(bad_first ? bad : good, bad_first ? good : bad);
  const std::string check = part.in_whole == InWhole::kNotMeasured  ? "samples.valid"
                            : part.in_whole == InWhole::kNotNeutral ? "watchdog.neutral"
                                                                    : part.check;
  const bool kept = part.in_whole == InWhole::kKept;
  const bool uncounted = check == "time.read_allocations" && !allocationCountingAvailable();
  const CheckFinding found =
      findingOf(check, with(pair.location(), check, 2.0), kept || uncounted ? 1 : 5);
  if (uncounted) return;
  EXPECT_EQ(found.outcome, kept ? Outcome::kPassed : Outcome::kFailed) << found.text;
}
std::vector<Broken> badParts() {
  std::vector<Broken> out = kBroken;
  std::erase_if(out, [](const Broken& part) { return part.in_whole == InWhole::kNoPart; });
  return out;
}
INSTANTIATE_TEST_SUITE_P(Kinds, OneBadPart,
                         testing::Combine(testing::ValuesIn(sampleTenth(badParts())),
                                          testing::Bool()),
                         [](const auto& tested) {
                           return std::string(std::get<0>(tested.param).name) +
                                  (std::get<1>(tested.param) ? "_first" : "_second");
                         });

class OneBadRail : public testing::TestWithParam<BrokenRail> {};

// The order of the parts is drawn.
TEST_P(OneBadRail, Defect_IsFoundInTheWholeWithTheAxisOrKeptFromIt) {
  const auto& [defect, id, axis, of_all] = GetParam();
  const PairOf::Part bad{"broken_rails", std::string(defect) + " y", "y"}, good{"rails", "", "x"};
  const bool bad_first = (seed() + std::string(defect).size()) % 2 == 0;
  const PairOf pair(bad_first ? bad : good, bad_first ? good : bad);
  ConformanceOptions options = with(pair.location(), id);
  options.known = {{"y", 0.25, 0.0}};
  const bool kept = std::string(id) == "commands.nan";  // the whole itself refuses NaN
  const CheckFinding found = findingOf(id, options, kept ? 1 : 3);
  EXPECT_EQ(found.outcome, kept ? Outcome::kPassed : Outcome::kFailed) << found.text;
  if (!of_all && !kept) EXPECT_TRUE(contains(found.text, axis)) << found.text;
}
INSTANTIATE_TEST_SUITE_P(Kinds, OneBadRail, testing::ValuesIn(sampleTenth(kBrokenRails)),
                         nameOfRail);

TEST(Conformance, CompositeOfCorrectParts_PassesEveryCheck) {
  const PairOf rails({"broken_rails", "", "y"}, {"rails", "", "x"});
  ConformanceOptions options = with(rails.location(), "");
  options.known = {{"y", 0.25, 0.0}};
  EXPECT_EQ(failures(conform(options)), "");
  const PairOf moving({"broken", "moving", "x"}, {"broken", "moving", "y"});
  EXPECT_EQ(failures(conform(with(moving.location(), "samples."))), "");
}

TEST(Conformance, DriverThatCrashes_FailsTheRunningCheckAndNoOtherGroup) {
  const auto results = conform(with(builtAt("broken", "crashes"), "samples."));
  EXPECT_TRUE(contains(failures(results), "samples.succeed: the driver ended the process"));
  EXPECT_EQ(results.back().finding.outcome, Outcome::kSkipped);
  EXPECT_EQ(failures(conform(with(builtAt("broken", "crashes"), "description."))), "");
}

TEST(Conformance, DriverThatHangs_IsEndedAndReported) {
  const auto results = conform(with(builtAt("broken", "hangs"), "samples.", 0.5));
  EXPECT_TRUE(contains(failures(results), "samples.succeed: the driver hangs"));
}

TEST(Conformance, CorrectDrivers_PassEveryCheck) {
  EXPECT_EQ(failures(conform(with(builtAt("broken", "moving"), "samples."))), "");
  EXPECT_EQ(failures(conform(with(builtAt("rails"), ""))), "");
}

// Correct rails: plain, with a weight that the driver carries and a brake holds, with dry friction,
// and without a measured effort.
TEST(Conformance, CorrectRails_PassEveryCheck) {
  for (const std::string& kind : sampleTenth<std::string>({"", "weighs", "rubs", "silent"})) {
    ConformanceOptions options = with(builtAt("broken_rails", kind), "");
    options.known = {{"x", 0.25, 0.0}, {"y", 0.25, 0.0}};
    EXPECT_EQ(failures(conform(options)), "") << kind;
  }
}

// The firmware runs in its own process: rails of 0.25 kg with 3 N·s/m.
TEST(Conformance, FrameAndItsFirmware_PassTheMotionChecks) {
  const std::vector<std::string> carriers = everyCarrier();
  const FirmwareProcess firmware(carriers[seed() % carriers.size()]);
  ConformanceOptions options = with(builtAt("frame"), "motion.");
  options.driver.locator = firmware.locator();
  options.known = {{"x", 0.25, 0.0}, {"y", 0.25, 0.0}, {"z", 0.25, 0.0}};
  EXPECT_EQ(failures(conform(options)), "") << firmware.locator();
}

// A driver for hosts may wait, has no watchdog and moves by itself; only checks without effort run.
TEST(Conformance, DriverForHosts_PassesTheChecksWithoutEffort) {
  const Folder folder;
  ConformanceOptions options = with(builtAt("pushed", folder.file("kept")), "");
  options.allow_effort = false;
  EXPECT_EQ(failures(conform(options)), "");
}

TEST(Conformance, RunWithoutPermissionForEffort_EnablesNothing) {
  ConformanceOptions options = with(builtAt("broken"), "");
  options.allow_effort = false;
  for (const CheckResult& r : conform(options)) {
    if (r.check->effect == Effect::kLooks) continue;
    EXPECT_EQ(r.finding.outcome, Outcome::kSkipped) << r.check->id;
    EXPECT_TRUE(contains(r.finding.text, "--allow-effort")) << r.check->id;
  }
}

// Efforts of a check move a person's hand, so only checks that state it may enable.
TEST(Conformance, Checks_HaveUniqueNamesAndDescriptions) {
  std::set<std::string> ids;
  for (const CheckGroup& group : checkGroups()) {
    for (const Check& check : group.checks) {
      EXPECT_TRUE(ids.insert(check.id).second) << check.id;
      EXPECT_EQ(groupOf(check.id), std::string(group.name) + ".");
      EXPECT_TRUE(check.before != DriverStage::kEnabled || check.effect != Effect::kLooks)
          << check.id;
      EXPECT_GT(std::string(check.asks).size(), 10U) << check.id;
      EXPECT_GT(std::string(check.remedy).size(), 3U) << check.id;
    }
  }
  EXPECT_GE(ids.size(), 60U);
}

}  // namespace
}  // namespace wholehand::test
