// The worst contacts of a scene, simulated before anybody feels a force.
#include "rig/rehearsal.hpp"

#include "loop/realtime/monotonic_clock.hpp"
#include "support/contains.hpp"
#include "support/rig_tools.hpp"
#include "support/seed.hpp"

#include <chrono>
#include <cstring>

namespace wholehand::test {
namespace {

/// Half the period, for any build type.
RehearsalOptions strict() {
  RehearsalOptions options;
  options.allowed_period_share = 0.5;
  return options;
}

Models bar() {
  return load(exerciseFiles("cocktail-bar"));
}

AxisPosition origin(const Models& models) {
  return AxisPosition(models.device.axisCount());
}

/// An exercise that takes too long, or gives a non-finite effort.
class InvalidExercise final : public Exercise {
 public:
  std::int64_t busy_ns = 0;
  double effort = 0.0;
  void reset() override {}
  [[nodiscard]] WorldQuery query() const noexcept override { return {}; }
  void tick(const ExerciseInput&, ExerciseRecord& out, BodyPlacements&) noexcept override {
    out.effort[0] = effort;
    const std::int64_t until_ns = threadCpuNow_ns() + busy_ns;
    while (threadCpuNow_ns() < until_ns) {
    }
  }
  [[nodiscard]] std::unique_ptr<Player> makePlayer(const PlayerTraits&) const override {
    return nullptr;
  }

 private:
};

TEST(Rehearsal, CocktailBar_ReachesTheContactsOfAWholePlayInHalfASecond) {
  const Models models = bar();
  const auto began = std::chrono::steady_clock::now();
  const std::int64_t cpu_ns = threadCpuNow_ns();
  const Rehearsal r = orThrow(rehearse(models, models.exercise->makePlayer({1})->start(), {}));
  figure("rehearsal_bar_wall",
         std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count(), "s");
  const double cpu_s = 1e-9 * static_cast<double>(threadCpuNow_ns() - cpu_ns);
  figure("rehearsal_bar_cpu", cpu_s / r.attempts, "s an attempt");
  figure("rehearsal_bar_p999", 1e-3 * r.summary.cpu.p999_ns, "µs");
  figure("rehearsal_bar_attempts", r.attempts, "");
  std::printf("%s\n", describe(r).c_str());
  // 20 s of play by the virtual patient have at most 3 contact points at once.
  EXPECT_GE(r.summary.contacts_max, 3);
  EXPECT_GE(r.bodies_touched, 3) << "rail, glass and the dispenser are within reach";
  EXPECT_GT(r.summary.records, 1000U);
  EXPECT_LE(1e-3 * r.summary.cpu.p999_ns, 1e3 * allowedPeriodShare());
}

TEST(Rehearsal, EveryDevice_TouchesTheBodiesOnATable) {
  for (const std::string& device :
       sampleTenth<std::string>({"lambda-pride", "wrist-9axis", "desktop-3axis"})) {
    SCOPED_TRACE(device);
    const Models models = load(shippedFiles(device, "table"));
    RehearsalOptions any;
    any.allowed_period_share = 100.0;
    const Rehearsal r = orThrow(rehearse(models, origin(models), {}, any));
    std::printf("%s: %s\n", device.c_str(), describe(r).c_str());
    EXPECT_GE(r.bodies_touched, device == "desktop-3axis" ? 2 : 4);
  }
}

TEST(Rehearsal, PileOfManyShapes_IsRefusedWithStageAndName) {
  Models models = load(shippedFiles());
  SceneBody pile = fixedBox({0.05, 0.06, 0.0}, {0.05, 0.05, 0.05});
  pile.name = "pile";
  const Shape one = pile.shapes.front();
  for (int i = 1; i < 500; ++i) {
    pile.shapes.push_back(one);
    pile.shapes.back().in_body.translation_m.z() = 1e-4 * i;
  }
  models.scene.bodies = {ball({0.0, -0.3, 0.3}, 0.01, 0.0), pile};
  RehearsalOptions options;
  // No other stage takes as long, even on a slow machine.
  options.allowed_period_share = WHOLEHAND_SANITIZED != 0 ? 3.0 : 1.0;
  const auto began = std::chrono::steady_clock::now();
  const auto refused = rehearse(models, origin(models), {}, options);
  figure("rehearsal_hopeless_wall",
         std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count(), "s");
  ASSERT_FALSE(refused);
  const std::string why = format(refused.errors());
  std::printf("%s\n", why.c_str());
  EXPECT_TRUE(contains(why, "most of it is physics_step"));
  EXPECT_TRUE(contains(why, "\"pile\""));
  EXPECT_TRUE(contains(why, "fewer than 500 shapes"));
}

TEST(Rehearsal, SlowExercise_IsRefusedWithItsStage) {
  Models models = load(shippedFiles());
  const auto slow = std::make_shared<InvalidExercise>();
  slow->busy_ns = 600'000;  // of 1 ms; 0.5 ms is allowed
  models.exercise = slow;
  const auto refused = rehearse(models, origin(models), {}, strict());
  ASSERT_FALSE(refused);
  const std::string why = format(refused.errors());
  EXPECT_TRUE(contains(why, "most of it is exercise"));
  EXPECT_TRUE(contains(why, "500 µs"));
}

// At a quarter of the rate the same scene has four times as much time.
TEST(Rehearsal, TimeLimit_FollowsTheRate) {
  Models models = load(shippedFiles());
  const auto slow = std::make_shared<InvalidExercise>();
  slow->busy_ns = 600'000;
  models.exercise = slow;
  RigOptions slower;
  slower.period_s = 4e-3;
  slower.uncertified = true;  // the gains are not tested here
  const auto passed = rehearse(models, origin(models), slower, strict());
  ASSERT_TRUE(passed) << format(passed.errors());
  EXPECT_GE(1e-3 * passed->summary.cpu.p50_ns, 600.0);
  EXPECT_STREQ(stageName(passed->slowest), "exercise");
}

TEST(Rehearsal, WorldThatFails_IsRefusedWithBodyAndFault) {
  Models models = load(shippedFiles());
  models.scene.bodies = {ball({0.05, 0.04, 0.0}, 0.03, 0.0)};
  const auto broken = std::make_shared<InvalidExercise>();
  broken->effort = std::numeric_limits<double>::quiet_NaN();
  models.exercise = broken;
  const auto refused = rehearse(models, origin(models), {});
  ASSERT_FALSE(refused);
  const std::string why = format(refused.errors());
  EXPECT_TRUE(contains(why, "ball"));
  EXPECT_TRUE(contains(why, "non-finite effort"));
}

TEST(Rehearsal, MassesTooDifferentToSettle_AreNamed) {
  for (const double top_kg : {0.02, 1000.0}) {
    // More than the 32 bodies that are solved directly; twelve stand.
    const int count = top_kg > 1.0 ? 40 : 12;
    Models models = load(shippedFiles());
    models.scene.bodies = {fixedBox({0.5, 0.0, -0.3}, {0.4, 0.4, 0.02})};
    for (int k = 0; k < count; ++k) {
      SceneBody cube = fixedBox({0.5, 0.0, -0.27 + 0.04 * k}, {0.04, 0.04, 0.04});
      cube.name = "cube " + std::to_string(k);
      cube.fixed = false;
      cube.mass_kg = k == count - 1 ? top_kg : 0.02;
      cube.inertia_kg_m2 = cube.mass_kg * 0.04 * 0.04 / 6.0 * Eigen::Matrix3d::Identity();
      models.scene.bodies.push_back(cube);
    }
    RehearsalOptions any;
    any.allowed_period_share = 100.0;
    const Rehearsal r = orThrow(rehearse(models, origin(models), {}, any));
    EXPECT_EQ(r.unsettled > 0.0, top_kg > 1.0) << describe(r);
    EXPECT_EQ(contains(describe(r), "do not settle"), top_kg > 1.0);
  }
}

TEST(Rehearsal, Cancelled_EndsWithTheTickAndReportsIt) {
  const Models models = bar();
  RehearsalOptions options;
  int asked = 0;
  options.cancelled = [&asked] { return ++asked > 100; };
  const auto refused = rehearse(models, origin(models), {}, options);
  EXPECT_TRUE(refusedWith(refused, "stopped"));
  EXPECT_EQ(asked, 101);
}

// A session after a rehearsal gives the same bits as one without: exercise, player and the thread's
// arithmetic are unchanged.
TEST(Rehearsal, RehearsalBeforeASession_LeavesItUnchanged) {
  const auto play = [](bool rehearsed) {
    const Models models = bar();
    if (rehearsed) {
      orThrow(rehearse(models, models.exercise->makePlayer({3})->start(), {}));
    }
    const auto rig = orThrow(buildRig(models, models.exercise->makePlayer({3}), {}));
    EXPECT_TRUE(rig->renderer->arm());
    std::vector<AxisEffort> sent;
    std::vector<AxisPosition> q_s;
    runTicks(*rig->renderer, 1500, [&](const TickRecord& r) {
      sent.push_back(r.sent);
      q_s.push_back(r.q_s);
    });
    return std::pair(sent, q_s);
  };
  const auto without = play(false), with = play(true);
  ASSERT_EQ(without.first.size(), with.first.size());
  for (std::size_t k = 0; k < without.first.size(); ++k) {
    ASSERT_EQ(0, std::memcmp(&without.first[k], &with.first[k], sizeof(AxisEffort))) << k;
    ASSERT_EQ(0, std::memcmp(&without.second[k], &with.second[k], sizeof(AxisPosition))) << k;
  }
  volatile double tiny = std::numeric_limits<double>::min();
  tiny = tiny / 4.0;
  EXPECT_NE(tiny, 0.0) << "denormal numbers count again";
}

}  // namespace
}  // namespace wholehand::test
