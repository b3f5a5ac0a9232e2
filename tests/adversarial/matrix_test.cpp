// Every shipped device, hand, exercise and patient together: whoever the person is, the device is
// pushed within its limits and comes to rest when it is told to.
#include "adversarial/attack.hpp"
#include "exercise/load_exercise.hpp"
#include "patient/scripted_player.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"

#include <ctime>
#include <filesystem>
#include <map>
#include <random>
#include <set>

namespace wholehand::test {
namespace {

const std::string kConfig = std::string(WHOLEHAND_SOURCE_DIR) + "/config/";
constexpr double kPeriod_s = 1e-3;

/// Patients who put in no energy of their own, or (tremor) a little: nothing of theirs may stop a
/// device. All others are active.
const std::set<std::string> kPassive = {"relaxed-adult", "stiff-adult", "no-arm", "tremor"};

/// How an active patient may make a device stop: docs/patients.md.
constexpr Fault kDocumentedStops = Fault::kSpeedLimit;

std::vector<std::string> shipped(const std::string& kind) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(kConfig + kind)) {
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string fileOf(const std::string& kind, const std::string& name) {
  return kConfig + kind + "/" + name + ".toml";
}

struct Case {
  std::string device, hand, exercise, patient;
  [[nodiscard]] std::string text() const {
    return patient + " in " + exercise + " with " + hand + " on " + device;
  }
};

/// What an exercise needs of a device; without it, it is refused by this name.
bool refused(const Case& c) {
  return c.device == "desktop-3axis" && c.exercise != "free-grasping";
}

using Random = std::mt19937_64;

double uniform(Random& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11U) * 0x1.0p-53;
}

/// How long a minimum-jerk way may take so as to stay below half of every speed limit [s].
double wayTime(const DeviceModel& device, const AxisPosition& from, const AxisPosition& to) {
  double time_s = 0.1;
  for (int a = 0; a < from.size(); ++a) {
    const double limit = device.axes[static_cast<std::size_t>(a)].speed_limit;
    time_s = std::max(time_s, 1.875 * std::abs(to[a] - from[a]) / (0.5 * limit));
  }
  return time_s;
}

/// Back and above, `aside` of the way to the left, where no scene has a body; open.
AxisPosition clearOf(const DeviceModel& device, double aside) {
  AxisPosition q(device.axisCount());
  for (int a = 0; a < q.size(); ++a) {
    const DeviceAxis& axis = device.axes[static_cast<std::size_t>(a)];
    if (axis.name == "x") q[a] = 0.95 * axis.lower;
    if (axis.name == "y") q[a] = aside * axis.upper;
    if (axis.name == "z") q[a] = 0.95 * axis.upper;
  }
  return q;
}

/// Where the base of a hand is that holds a body: its axis 0.049, 0.041, 0.004 m from there.
void reachFor(const SceneBody& body, const DeviceModel& device, AxisPosition& q) {
  const Eigen::Vector3d base_m = body.pose.translation_m - Eigen::Vector3d(0.049, 0.041, 0.004);
  for (int i = 0; i < 3; ++i) {
    const int a = device.axisIndex(std::string(1, "xyz"[i]));
    const DeviceAxis& axis = device.axes[static_cast<std::size_t>(a)];
    q[a] = std::clamp(base_m[i], axis.lower, axis.upper);
  }
}

/// Grasps and fights: to a body, closing; tearing open; off to some corner; and again.
Intention graspAndFight(const Models& m, double aside, Random& random) {
  std::vector<Waypoint> way{{0.0, clearOf(m.device, aside)}};
  const auto go = [&](const AxisPosition& q) {
    way.push_back({way.back().time_s + wayTime(m.device, way.back().q, q), q});
  };
  const auto shape = [&](AxisPosition& q, double low, double high, bool fingers) {
    for (int a = 0; a < q.size(); ++a) {
      const DeviceAxis& axis = m.device.axes[static_cast<std::size_t>(a)];
      if ((axis.group == AxisGroup::kHand) != fingers) continue;
      q[a] = axis.lower + uniform(random, low, high) * (axis.upper - axis.lower);
    }
  };
  for (int i = 0; i < 8; ++i) {
    AxisPosition q = way.back().q;
    if (!m.scene.bodies.empty()) {
      reachFor(m.scene.bodies[random() % m.scene.bodies.size()], m.device, q);
    }
    go(q);
    shape(q, 0.5, 0.9, true);
    go(q);
    shape(q, 0.0, 0.2, true);
    go(q);
    shape(q, 0.0, 1.0, true);
    shape(q, 0.0, 1.0, false);
    go(q);
  }
  return Intention::throughWaypoints(std::move(way));
}

/// Loads what a case is made of, and keeps it for the next case; the world is built anew each time,
/// as the bodies of the last one lie about.
class Arena {
 public:
  /// Where the exercise is refused for this device: which keys are at fault.
  [[nodiscard]] std::vector<std::string> enter(const Case& c, int level) {
    const std::string place = c.device + c.hand + c.exercise + std::to_string(level);
    if (place == place_) return {};
    ModelFiles files = shippedFiles(c.device, "empty", c.hand);
    files.exercise = fileOf("exercises", c.exercise);
    files.level = level;
    Expected<Models> models = loadModels(files);
    std::vector<std::string> keys;
    if (!models) {
      for (const Diagnostic& fault : models.errors()) keys.push_back(fault.key);
      return keys;
    }
    models_ = std::move(*models);
    place_ = place;
    return keys;
  }

  /// @pre enter()
  std::optional<Outcome> run(const Case& c, int ticks, Random& random,
                             const std::function<void(Rig&)>& change = {}) {
    auto changing = std::make_unique<ChangingDevice>();
    ChangingDevice& device = *changing;
    const auto rig = build(models_, std::move(changing));
    if (change) change(*rig);
    Bones bones(*rig);
    for (const double aside : {0.0, 0.95}) {
      std::unique_ptr<Player> player = models_.exercise->makePlayer(random());
      if (!player) {
        player = std::make_unique<ScriptedPlayer>(graspAndFight(models_, aside, random));
      }
      Player& seeing = *player;
      device.put(std::make_unique<SimulatedDevice>(models_.device, person(c, random),
                                                   std::move(player), kPeriod_s));
      if (auto outcome = attack(*rig, device, seeing, bones, ticks)) return outcome;
    }
    return std::nullopt;
  }

 private:
  /// As shipped, but for when it happens: at a random time of a short run.
  PatientConfig person(const Case& c, Random& random) const {
    PatientConfig patient = orThrow(loadPatientFile(fileOf("patients", c.patient), models_.device));
    patient.tremor.phase_seed = random();
    patient.slam.after_s = uniform(random, 0.3, 1.0);
    if (std::isfinite(patient.letting_go.after_s)) {
      patient.letting_go.after_s = uniform(random, 0.5, 3.0);
    }
    return patient;
  }

  std::string place_;
  Models models_;
};

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

/// All, or a part by the seed in which every device, hand, exercise and patient is at least once
/// (in a case that is not refused), and every refused pair of device and exercise.
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
  all.resize(std::min(all.size(), std::max(needed, most)));
  return all;
}

/// Draws by the seed and the case alone: a case does the same among all and among few.
Random randomOf(const Case& c) {
  std::uint32_t hash = 2166136261U;  // FNV-1a
  for (const char letter : c.text()) hash = (hash ^ static_cast<unsigned char>(letter)) * 16777619U;
  std::seed_seq mixed{static_cast<std::uint32_t>(seed()), static_cast<std::uint32_t>(seed() >> 32U),
                      hash};
  return Random(mixed);
}

/// What an exercise needs of a device that has no fingers.
const std::vector<std::string> kRefusedKeys = {"wall.axes[finger_flexion].name",
                                               "wall.axes[thumb_flexion].name"};

struct Tally {
  int runs = 0, refused = 0, stopped = 0, touched = 0, let_go = 0;
  std::int64_t ticks = 0;
  int latest_neutral = 0;
  double deepest_m = -1.0;
  std::map<std::string, int> outcomes;
};

std::string faultNames(Fault faults) {
  std::string out;
  for (int bit = 0; bit < 32; ++bit) {
    if (!any(faults & static_cast<Fault>(1U << bit))) continue;
    out += (out.empty() ? "" : ", ") + std::string(faultName(bit));
  }
  return out;
}

void judge(const Case& c, const Outcome& o, Tally& tally) {
  EXPECT_EQ(o.broken, "") << c.text();
  const Fault allowed = kPassive.contains(c.patient) ? Fault::kNone : kDocumentedStops;
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

TEST(EveryPatient, OnEveryDeviceHandAndExercise_IsPushedWithinLimitsAndLetDownGently) {
  constexpr int kTicks = 3000;
  const std::vector<Case> all = everyCase();
  const std::vector<Case> tried = sampled(all, 60);
  Arena arena;
  Tally tally;
  const std::clock_t began = std::clock();
  for (const Case& c : tried) {
    SCOPED_TRACE(c.text());
    const std::vector<std::string> faults = arena.enter(c, 1);
    if (refused(c)) {
      ++tally.refused;
      EXPECT_EQ(faults, kRefusedKeys);
      continue;
    }
    ASSERT_TRUE(faults.empty()) << faults.front();
    Random random = randomOf(c);
    const std::optional<Outcome> outcome = arena.run(c, kTicks, random);
    ASSERT_TRUE(outcome) << "starts inside a body";
    judge(c, *outcome, tally);
  }
  print(tally);
  figure("cases of all", static_cast<double>(tried.size()) / static_cast<double>(all.size()), "");
  figure("CPU time", static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC, "s");
  EXPECT_GT(tally.touched, tally.runs / 4);
}

/// Nobody would notice if it saw nothing.
TEST(Attack, LimitTighterThanTheRenderers_IsNoticed) {
  Arena arena;
  const Case c{"lambda-pride", "adult-median-right", "free-grasping", "stiff-adult"};
  ASSERT_TRUE(arena.enter(c, 1).empty());
  Random random = randomOf(c);
  const auto outcome =
      arena.run(c, 3000, random, [](Rig& rig) { rig.models.device.axes[0].effort_limit = 0.5; });
  ASSERT_TRUE(outcome);
  EXPECT_NE(outcome->broken.find("x beyond its limit"), std::string::npos) << outcome->broken;
}

TEST(Bones, HandWhoseFingerIsInABall_AreWithinABody) {
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
  EXPECT_NEAR(bones.deepest(record), kRadius_m, 1e-12);  // its middle
  record.bodies[0].position_m = Vec3::from(at_m + Eigen::Vector3d(0.5, 0.0, 0.0));
  EXPECT_LT(bones.deepest(record), 0.0);
}

}  // namespace
}  // namespace wholehand::test
