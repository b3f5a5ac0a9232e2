// The worst contacts of a scene, run before anybody feels a force.
#include "rig/rehearsal.hpp"

#include "loop/realtime/monotonic_clock.hpp"
#include "support/rig_tools.hpp"
#include "support/says.hpp"
#include "support/seed.hpp"

#include <chrono>
#include <cstring>

namespace wholehand::test {
namespace {

/// Half the period, in whatever way this was built.
RehearsalOptions strict() {
  RehearsalOptions options;
  options.most_of_period = 0.5;
  return options;
}

Models bar() {
  return load(exerciseFiles("cocktail-bar"));
}

AxisPosition origin(const Models& models) {
  return AxisPosition(models.device.axisCount());
}

/// An exercise that takes time, or pushes with what is no number.
class Awkward final : public Exercise {
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

TEST(Rehearsal, Bar_PassesWithTheContactsOfAWholePlayInHalfASecond) {
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
  // 20 s of play by the virtual patient touch with at most 3 points at once.
  EXPECT_GE(r.summary.contacts_max, 3);
  EXPECT_GE(r.bodies_touched, 3) << "rail, glass and the dispenser are within reach";
  EXPECT_GT(r.summary.records, 1000U);
  EXPECT_LE(1e-3 * r.summary.cpu.p999_ns, 1e3 * mostOfPeriod());
}

TEST(Rehearsal, EveryDevice_TouchesWhatLiesOnATable) {
  for (const std::string& device :
       aTenth<std::string>({"lambda-pride", "wrist-9axis", "desktop-3axis"})) {
    SCOPED_TRACE(device);
    const Models models = load(shippedFiles(device, "table"));
    RehearsalOptions any;
    any.most_of_period = 100.0;
    const Rehearsal r = orThrow(rehearse(models, origin(models), {}, any));
    std::printf("%s: %s\n", device.c_str(), describe(r).c_str());
    EXPECT_GE(r.bodies_touched, device == "desktop-3axis" ? 2 : 4);
  }
}

TEST(Rehearsal, PileOfManyShapes_IsRefusedByStageAndName) {
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
  options.most_of_period = kFew ? 3.0 : 1.0;
  const auto began = std::chrono::steady_clock::now();
  const auto refused = rehearse(models, origin(models), {}, options);
  figure("rehearsal_hopeless_wall",
         std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count(), "s");
  ASSERT_FALSE(refused);
  const std::string why = format(refused.errors());
  std::printf("%s\n", why.c_str());
  EXPECT_TRUE(says(why, "most of it is physics_step"));
  EXPECT_TRUE(says(why, "\"pile\""));
  EXPECT_TRUE(says(why, "fewer than 500 shapes"));
}

TEST(Rehearsal, SlowExercise_IsRefusedByItsStage) {
  Models models = load(shippedFiles());
  const auto slow = std::make_shared<Awkward>();
  slow->busy_ns = 600'000;  // of 1 ms; 0.5 ms is allowed
  models.exercise = slow;
  const auto refused = rehearse(models, origin(models), {}, strict());
  ASSERT_FALSE(refused);
  const std::string why = format(refused.errors());
  EXPECT_TRUE(says(why, "most of it is exercise"));
  EXPECT_TRUE(says(why, "500 µs"));
}

// The same scene at a quarter of the rate has four times the room.
TEST(Rehearsal, LimitFollowsTheRate) {
  Models models = load(shippedFiles());
  const auto slow = std::make_shared<Awkward>();
  slow->busy_ns = 600'000;
  models.exercise = slow;
  RigOptions slower;
  slower.period_s = 4e-3;
  slower.uncertified = true;  // of the gains nothing is asked here
  const auto passed = rehearse(models, origin(models), slower, strict());
  ASSERT_TRUE(passed) << format(passed.errors());
  EXPECT_GE(1e-3 * passed->summary.cpu.p50_ns, 600.0);
  EXPECT_STREQ(stageName(passed->slowest), "exercise");
}

TEST(Rehearsal, WorldThatBreaks_IsRefusedByTheBodyAndTheFault) {
  Models models = load(shippedFiles());
  models.scene.bodies = {ball({0.05, 0.04, 0.0}, 0.03, 0.0)};
  const auto broken = std::make_shared<Awkward>();
  broken->effort = std::numeric_limits<double>::quiet_NaN();
  models.exercise = broken;
  const auto refused = rehearse(models, origin(models), {});
  ASSERT_FALSE(refused);
  const std::string why = format(refused.errors());
  EXPECT_TRUE(says(why, "ball"));
  EXPECT_TRUE(says(why, "non-finite effort"));
}

TEST(Rehearsal, WeightsTooDifferentToSettle_AreNamed) {
  for (const double top_kg : {0.02, 1000.0}) {
    Models models = load(shippedFiles());
    models.scene.bodies = {fixedBox({0.5, 0.0, -0.3}, {0.4, 0.4, 0.02})};
    for (int k = 0; k < 12; ++k) {
      SceneBody cube = fixedBox({0.5, 0.0, -0.27 + 0.04 * k}, {0.04, 0.04, 0.04});
      cube.name = "cube " + std::to_string(k);
      cube.fixed = false;
      cube.mass_kg = k == 11 ? top_kg : 0.02;
      cube.inertia_kg_m2 = cube.mass_kg * 0.04 * 0.04 / 6.0 * Eigen::Matrix3d::Identity();
      models.scene.bodies.push_back(cube);
    }
    RehearsalOptions any;
    any.most_of_period = 100.0;
    const Rehearsal r = orThrow(rehearse(models, origin(models), {}, any));
    EXPECT_EQ(r.unsettled > 0.0, top_kg > 1.0) << describe(r);
    EXPECT_EQ(says(describe(r), "do not settle"), top_kg > 1.0);
  }
}

TEST(Rehearsal, Cancelled_EndsWithTheTickAndSaysSo) {
  const Models models = bar();
  RehearsalOptions options;
  int asked = 0;
  options.cancelled = [&asked] { return ++asked > 100; };
  const auto refused = rehearse(models, origin(models), {}, options);
  EXPECT_TRUE(refusedWith(refused, "stopped"));
  EXPECT_EQ(asked, 101);
}

// A session after it gives the same bits as one without: exercise, player and the thread's
// arithmetic are as they were.
TEST(Rehearsal, LeavesNoTrace) {
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
