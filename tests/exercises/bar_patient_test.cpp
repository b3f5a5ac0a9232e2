// Settings for one patient at the bar: tolerance, fade time, reach. Runs without physics.
#include "exercises/bar_table.hpp"
#include "exercises/cocktail_bar/bar.hpp"

namespace wholehand::test {
namespace {

const LiveParameter& described(const BarTable& bar, const std::string& name) {
  const auto& all = bar.exercise->description().parameters;
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const LiveParameter& p) { return p.name == name; });
  if (found != all.end()) return *found;
  ADD_FAILURE() << "no parameter " << name;
  return all.front();
}

void set(BarTable& bar, const std::string& name, double value) {
  const LiveParameter& p = described(bar, name);
  ASSERT_GE(value, p.lower) << name;
  ASSERT_LE(value, p.upper) << name;
  bar.parameters[&p - bar.exercise->description().parameters.data()] = value;
}

// ---------------------------------------------------------------- tolerance

TEST(BarTolerance, InitialValue_IsThatOfTheLevel) {
  for (int level = 1; level <= 4; ++level) {
    BarTable bar(level);
    bar.tick();
    EXPECT_EQ(bar.value("tolerance_l"), described(bar, "line_tolerance_l").value);
  }
}

TEST(BarTolerance, ChangedTolerance_EndsAStepAtTheAskedAmountLessTheTolerance) {
  for (const double tolerance_l : {0.012, 0.001}) {  // wider, narrower
    BarTable bar(1);
    set(bar, "line_tolerance_l", tolerance_l);
    bar.hold(0, 2.0);
    bar.runUntil("stage", kLetGo);
    EXPECT_EQ(bar.value("tolerance_l"), tolerance_l);
    // The step asks for 20 ml of lemonade; a tick at the fastest flow is 0.02 ml.
    EXPECT_NEAR(bar.value("poured_l"), 0.02 - tolerance_l, 2.1e-5);
  }
}

// ---------------------------------------------------------------- fade

TEST(BarFade, FadeTime_IsTheWallsTimeToFadeIn) {
  for (const double fade_s : {0.3, 1.0, 3.0}) {
    BarTable bar(1);
    set(bar, "wall_fade_s", fade_s);
    bar.hold(0, 0.0);
    int ticks = 0;
    for (; bar.out.alpha < 1.0 && ticks < 10'000; ++ticks) bar.tick();
    EXPECT_NEAR(ticks * 1e-3, fade_s, 2.5e-3);  // Eq. (16): u rises by T / T_on a tick
    // The file sets the fade-out time, whatever the patient's setting: a stop waits for it.
    bar.drawBack();
    for (ticks = 0; bar.out.alpha > 0.0 && ticks < 10'000; ++ticks) bar.tick();
    EXPECT_NEAR(ticks * 1e-3, 0.3, 2.5e-3);
  }
}

TEST(BarFade, ChangeDuringAFade_ContinuesFromThePresentValue) {
  BarTable bar(1);
  set(bar, "wall_fade_s", 5.0);
  bar.hold(0, 0.0);
  double before = 0.0;
  for (int k = 0; k < 3000; ++k) {
    if (k == 1000) set(bar, "wall_fade_s", 0.3);
    bar.tick();
    // 3u² - 2u³ rises by at most 1.5 du.
    EXPECT_LE(bar.out.alpha - before, 1.5 * 1e-3 / 0.3 + 1e-12);
    EXPECT_GE(bar.out.alpha, before);
    before = bar.out.alpha;
  }
  EXPECT_EQ(before, 1.0);
}

// ---------------------------------------------------------------- reach

/// Position of the median right palm's base when it grips the target, measured to 0.1 mm.
constexpr double kMeasured_m = 1e-4;
Eigen::Vector3d gripOf(const BarTable& bar) {
  const int target = static_cast<int>(bar.value("target_dispenser"));
  const BodyState& body = bar.record.bodies[bar.bodyOf(target)];
  return body.position_m.eigen() - Eigen::Vector3d(0.049, 0.016 + 0.025, 0.004);
}

TEST(BarReach, ReachOfTheWholeDevice_LeavesTheRowAtItsScenePosition) {
  for (int level = 1; level <= 4; ++level) {
    BarTable bar(level);
    const Vec3 before = bar.record.bodies[bar.bodyOf(0)].position_m;
    bar.run(2.0);
    const Vec3 after = bar.record.bodies[bar.bodyOf(0)].position_m;
    EXPECT_EQ(before.x, after.x);
    EXPECT_EQ(before.y, after.y);
  }
}

TEST(BarReach, NarrowReach_BringsEveryNextDispenserWithinIt) {
  for (const auto& [left_m, right_m] : {std::pair{0.03, 0.03}, {0.03, 0.12}, {0.12, 0.03}}) {
    BarTable bar(4);
    set(bar, "reach_left_m", left_m);
    set(bar, "reach_right_m", right_m);
    int seen = 0;
    for (int step = 0; step < 3; ++step) {  // lagoon: lemon, blueberry, cherry
      bar.drawBack();
      bar.runUntil("stage", 0);
      const double y_m = gripOf(bar).y();
      // A right hand grips from beside the dispenser, up to 24 mm farther right.
      EXPECT_LE(y_m, left_m + kMeasured_m);
      EXPECT_GE(y_m - 0.024, -right_m - kMeasured_m);
      ++seen;
      const int target = static_cast<int>(bar.value("target_dispenser"));
      bar.hold(target, 2.0);
      bar.runUntil("stage", 3);
      bar.squeeze(-1, 0.0);
      bar.run(0.5);
    }
    EXPECT_EQ(seen, 3);
  }
}

TEST(BarReach, ShortForwardReach_BringsRowRailAndGlassNearer) {
  BarTable bar(2);
  bar.run(2.0);
  const auto x_m = [&](const char* body) {
    return bar.record.bodies[bar.scene.bodyIndex(body)].position_m.x;
  };
  const double row_m = x_m("dispenser_lemon"), rail_m = x_m("rail"), glass_m = x_m("glass");
  set(bar, "reach_forward_m", 0.06);
  bar.tick();
  EXPECT_EQ(bar.value("stage"), 6);  // the hand is asked to stay back meanwhile
  bar.run(3.0);
  EXPECT_EQ(bar.value("stage"), 0);
  EXPECT_NEAR(gripOf(bar).x(), 0.06, kMeasured_m);
  const double nearer_m = row_m - x_m("dispenser_lemon");
  EXPECT_NEAR(rail_m - x_m("rail"), nearer_m, 1e-12);
  EXPECT_NEAR(glass_m - x_m("glass"), nearer_m, 1e-12);
  EXPECT_NEAR(x_m("dispenser_cherry"), x_m("dispenser_lemon"), 1e-12);
}

TEST(BarReach, ChangeWhileTheHandIsAtADispenser_WaitsUntilItIsDrawnBack) {
  BarTable bar(2);
  bar.run(2.0);
  bar.hold(0, 1.5);
  bar.run(0.5);
  const auto at = [&] { return bar.record.bodies[bar.bodyOf(0)].position_m; };
  const Vec3 before = at();
  set(bar, "reach_right_m", 0.03);
  set(bar, "reach_forward_m", 0.06);
  bar.run(3.0);
  EXPECT_EQ(at().x, before.x);
  EXPECT_EQ(at().y, before.y);
  bar.drawBack();
  bar.run(3.0);
  EXPECT_LT(at().x, before.x);
}

/// In the mirror image left and right are exchanged.
TEST(BarReach, LeftHand_HasTheMirrorImage) {
  Bar bar;
  bar.row = {true, 0.128, -0.023, 0.105, 0.15};
  bar.dispensers.resize(1);
  bar.dispensers[0].home_m = {0.119, 0.04, 0.004};
  bar.dispensers[0].grip_m = Eigen::Vector3d::Zero();
  bar.drinks = {{"one", {{0, 0.04, 0.005}}}};
  BarLayout right = makeBarLayout(bar, shippedDevice(), &shippedHand());
  BarLayout left = right;
  left.beside = -1.0;
  left.grip_m.y() = -right.grip_m.y();
  Bar mirrored = bar;
  mirrored.row.reach_lower_m = -0.105;
  mirrored.row.reach_upper_m = 0.023;
  const BarParameters of_right(bar, right, shippedDevice()),
      of_left(mirrored, left, shippedDevice());
  std::vector<double> v;
  for (const LiveParameter& p : of_right.all()) v.push_back(p.value);
  for (const auto& [left_m, right_m] : {std::pair{0.12, 0.12}, {0.04, 0.1}, {0.1, 0.04}}) {
    v[6] = left_m;
    v[7] = right_m;
    const RowReach a = of_right.reach(v.data());
    std::swap(v[6], v[7]);
    const RowReach b = of_left.reach(v.data());
    EXPECT_DOUBLE_EQ(a.lower_m, -b.upper_m);
    EXPECT_DOUBLE_EQ(a.upper_m, -b.lower_m);
    EXPECT_LE(a.lower_m, a.upper_m);
  }
}

}  // namespace
}  // namespace wholehand::test
