// Runs every combination of shipped device, hand, exercise and patient. The device must stay within
// its limits and come to rest on request, for every kind of patient.
#include "loop/adversarial/arena.hpp"
#include "support/contains.hpp"
#include "support/file_bytes.hpp"

#include <cmath>
#include <ctime>
#include <fstream>
#include <iterator>
#include <map>
#include <set>

namespace wholehand::test {
namespace {

/// Patients who put in no energy of their own, or (tremor) a little; they may not cause a stop. All
/// others are active.
const std::set<std::string> kPassive = {
    "relaxed-adult",    "stiff-adult",  "no-arm",       "tremor",
    "enslaved-fingers", "pill-rolling", "holds-a-ball", "weak"};

/// The stops that a patient may cause according to docs/patients.md.
Fault documentedStops(const Case& c) {
  if (kPassive.contains(c.patient)) return Fault::kNone;
  return Fault::kSpeedLimit;
}

std::string pathOf(const std::string& folder, const std::string& name) {
  return std::string(WHOLEHAND_SOURCE_DIR) + "/config/" + folder + "/" + name + ".toml";
}

/// True if the exercise refuses a device that lacks what it needs. Each pair is checked once by
/// loading it; no exercise refuses the device that the exercises are made for.
bool refused(const Case& c) {
  static std::map<std::string, bool> known;
  const std::string pair = c.device + " " + c.exercise;
  if (const auto at = known.find(pair); at != known.end()) return at->second;
  ModelFiles files = shippedFiles(c.device);
  files.exercise = pathOf("exercises", c.exercise);
  const bool is = !loadModels(files).ok();
  EXPECT_FALSE(is && c.device == "lambda-pride") << c.exercise;
  return known[pair] = is;
}

/// True if a key of a fault, such as "wall.axes[finger_flexion].name", belongs to the exercise's
/// own file: the file contains every word of the key.
bool standsIn(const std::string& exercise, const std::string& key) {
  const std::string text = bytesOfFile(pathOf("exercises", exercise));
  std::string word;
  for (const char c : key + ".") {
    if (c != '.' && c != '[' && c != ']') {
      word += c;
    } else if (!word.empty()) {
      if (text.find(word) == std::string::npos) return false;
      word.clear();
    }
  }
  return !key.empty();
}

std::vector<Case> everyCase() {
  std::vector<Case> all;
  for (const std::string& device : shipped("devices")) {
    for (const std::string& hand : shipped("hands")) {
      for (const std::string& exercise : shipped("exercises")) {
        for (const std::string& patient : shipped("patients")) {
          all.push_back({device, hand, exercise, patient});
        }
      }
    }
  }
  return all;
}

/// All cases, or a random selection by the seed. The selection has every device, hand, exercise and
/// patient at least once in a case that is not refused, and every refused pair of device and
/// exercise; under a sanitizer it keeps only a few of these.
std::vector<Case> sampled(std::vector<Case> all, std::size_t most) {
  if (cases(1) > 1) return all;
  Random random = seededRandom(41);
  std::shuffle(all.begin(), all.end(), random);
  std::set<std::string> covered;
  const auto covers = [&covered](const Case& c) {
    if (refused(c)) return covered.insert("no " + c.device + c.exercise).second;
    bool more = false;
    for (const std::string* name : {&c.device, &c.hand, &c.exercise, &c.patient}) {
      more = covered.insert(*name).second || more;
    }
    return more;
  };
  const auto rest = std::stable_partition(all.begin(), all.end(), covers);
  const auto needed = static_cast<std::size_t>(rest - all.begin());
  all.resize(std::min(all.size(), kReducedCounts ? most : std::max(needed, most)));
  return all;
}

struct Tally {
  int runs = 0, refused = 0, stopped = 0, touched = 0, let_go = 0;
  std::int64_t ticks = 0;
  int latest_neutral = 0;
  double deepest_m = -1.0;
  std::map<std::string, int> outcomes;
};

void checkOutcome(const Case& c, const Outcome& o, Tally& tally) {
  EXPECT_EQ(o.broken, "") << c.text();
  const Fault allowed = documentedStops(c);
  EXPECT_EQ(o.stopped_by | allowed, allowed)
      << c.text() << ": stopped by " << faultNames(o.stopped_by) << " in tick " << o.ticks;
  EXPECT_LE(o.neutral_after_ticks, 100) << c.text();
  ++tally.runs;
  tally.ticks += o.ticks;
  tally.stopped += any(o.stopped_by) ? 1 : 0;
  tally.touched += o.touched_ticks > 0 ? 1 : 0;
  tally.let_go += o.let_go ? 1 : 0;
  tally.latest_neutral = std::max(tally.latest_neutral, o.neutral_after_ticks);
  tally.deepest_m = std::max(tally.deepest_m, o.deepest_m);
  const std::string end =
      any(o.stopped_by) ? "stopped by " + faultNames(o.stopped_by) : "to the end";
  ++tally.outcomes[c.patient + ": " + end];
  ++tally.outcomes[c.exercise + (o.touched_ticks > 0 ? ": touched" : ": not touched")];
}

void print(const Tally& tally) {
  for (const auto& [what, count] : tally.outcomes) std::printf("%4d %s\n", count, what.c_str());
  figure("runs", tally.runs, "");
  figure("refused", tally.refused, "");
  figure("runs that touched something", tally.touched, "");
  figure("runs in which the person let go", tally.let_go, "");
  figure("runs stopped by a fault", tally.stopped, "");
  figure("ticks", static_cast<double>(tally.ticks), "");
  figure("longest way to neutral", tally.latest_neutral, "ms");
  figure("bone deepest in a body (negative: outside)", 1e3 * tally.deepest_m, "mm");
}

TEST(EveryPatient, OnEveryDeviceHandAndExercise_StaysWithinLimitsAndStopsGently) {
  constexpr int kTicks = 3000;
  const std::vector<Case> all = everyCase();
  const std::vector<Case> tried = sampled(all, kReducedCounts ? 8 : 60);
  Arena arena;
  Tally tally;
  const std::clock_t began = std::clock();
  for (const Case& c : tried) {
    SCOPED_TRACE(c.text());
    const std::vector<std::string> faults = arena.enter(c, 1);
    if (refused(c)) {
      ++tally.refused;
      EXPECT_FALSE(faults.empty());
      for (const std::string& key : faults) EXPECT_TRUE(standsIn(c.exercise, key)) << key;
      continue;
    }
    ASSERT_TRUE(faults.empty()) << faults.front();
    Random random = randomOf(c);
    const std::optional<Outcome> outcome = arena.run(c, kTicks, random);
    ASSERT_TRUE(outcome) << "starts inside a body";
    checkOutcome(c, *outcome, tally);
  }
  print(tally);
  figure("cases of all", static_cast<double>(tried.size()) / static_cast<double>(all.size()), "");
  figure("CPU time", static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC, "s");
  if (kStatisticsMeaningful) {
    EXPECT_GT(tally.touched, tally.runs / 4);
  }
}

/// The check must be able to fail: an effort beyond a limit is reported.
TEST(Attack, LimitTighterThanTheRenderers_IsNoticed) {
  Arena arena;
  const Case c{"lambda-pride", "adult-median-right", "free-grasping", "stiff-adult"};
  ASSERT_TRUE(arena.enter(c, 1).empty());
  Random random = randomOf(c);
  const auto outcome =
      arena.run(c, 3000, random, [](Rig& rig) { rig.models.device.axes[0].effort_limit = 0.5; });
  ASSERT_TRUE(outcome);
  EXPECT_TRUE(contains(outcome->broken, "x beyond its limit"));
}

TEST(Bones, FingerInsideABall_MeasuresTheBallsRadiusAsDepth) {
  Models m = load(shippedFiles());
  const AxisPosition q(m.device.axisCount());
  const Capsule& tip = *std::find_if(m.hand.capsules.begin(), m.hand.capsules.end(),
                                     [](const Capsule& c) { return c.name == "index_distal"; });
  const Eigen::Vector3d at_m = handAt(m.hand, q).linkPose(tip.link) * tip.b_m;
  constexpr double kRadius_m = 0.03;
  m.scene.bodies = {ball(at_m, kRadius_m, 0.0)};
  const auto rig = build(std::move(m), std::make_unique<ChangingDevice>());
  TickRecord record;
  record.theta = JointPosition(rig->models.hand.joint_count);
  Synergy(rig->models.hand).expand(q, record.theta);
  record.body_count = 1;
  record.bodies[0].position_m = Vec3::from(at_m);
  Bones bones(*rig);
  EXPECT_NEAR(bones.deepest(record), kRadius_m, 1e-12);  // the fingertip is at its centre
  record.bodies[0].position_m = Vec3::from(at_m + Eigen::Vector3d(0.5, 0.0, 0.0));
  EXPECT_LT(bones.deepest(record), 0.0);
}

}  // namespace
}  // namespace wholehand::test
