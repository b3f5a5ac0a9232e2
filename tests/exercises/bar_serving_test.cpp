// How the bar handles dispensers that lie, stand out of reach, or are called home.
#include "exercises/bar_table.hpp"

namespace wholehand::test {
namespace {

const Eigen::Vector3d kLemonHome(0.119, -0.023, 0.004), kCherryHome(0.119, 0.105, 0.004);

BodyState& lemon(BarTable& bar) {
  return bar.record.bodies[bar.bodyOf(0)];
}
double fromHome_m(BarTable& bar, int dispenser) {
  const BodyState& body = bar.record.bodies[bar.bodyOf(dispenser)];
  return (body.position_m.eigen() - (dispenser == 0 ? kLemonHome : kCherryHome)).norm();
}
void layAside(BarTable& bar) {
  const double s = std::sqrt(0.5);
  lemon(bar).orientation_xyzw = {s, 0.0, 0.0, s};
  lemon(bar).position_m = {0.16, 0.2, -0.031};
}

TEST(FreeBar, DispenserPushedAwayUpright_IsReturnedWithoutLeaking) {
  BarTable bar(1, kFree);
  bar.tick();
  ASSERT_EQ(bar.value("stage"), kReach);
  lemon(bar).position_m.x = 0.27;  // the position reported in the issue
  bar.tick();
  EXPECT_EQ(bar.value("stage"), kDrawBack);
  bar.run(1.9);
  EXPECT_EQ(bar.count("stood_up"), 0);
  bar.run(0.2);  // stand_up_s = 2
  EXPECT_EQ(bar.count("stood_up"), 1);
  EXPECT_LT(fromHome_m(bar, 0), 1e-12);
  EXPECT_EQ(bar.value("stage"), kReach);
  EXPECT_EQ(bar.value("spilt_l"), 0.0);
}

TEST(FreeBar, DispenserAsideButWithinReach_StaysInPlace) {
  BarTable bar(1, kFree);
  bar.tick();
  lemon(bar).position_m = {0.13, 0.06, 0.004};
  bar.run(5.0);
  EXPECT_EQ(bar.count("stood_up"), 0);
  EXPECT_EQ(bar.value("stage"), kReach);
}

TEST(FreeBar, DispenserHeldOutOfReach_IsNotTakenFromTheHand) {
  BarTable bar(1, kFree);
  bar.tick();
  bar.hold(0, 3.0);
  bar.record.q_s[0] = -0.08;  // drawn back as far as possible, with the dispenser
  lemon(bar).position_m = {-0.2, -0.023, 0.004};
  bar.run(5.0);
  EXPECT_EQ(bar.count("stood_up"), 0);
  EXPECT_EQ(bar.count("knocked_over"), 0);
}

TEST(FreeBar, DispenserLyingAgainstTheHand_IsStoodUpNevertheless) {
  BarTable bar(1, kFree);
  bar.tick();
  layAside(bar);
  bar.palm(0, 0.01);
  bar.squeeze(0, 2.0);
  for (std::size_t i = 0; i < 4; ++i) bar.record.contacts[i].normal = {1.0, 0.0, 0.0};
  bar.run(2.2);
  EXPECT_EQ(bar.count("stood_up"), 1);
}

TEST(FreeBar, HandDrawnBackWithStretchedFingers_MustKeepTheHomePlaceFree) {
  BarTable bar(1, kFree);
  bar.tick();
  layAside(bar);
  bar.record.q_s[0] = -0.071;  // drawn back is -0.07
  bar.record.q_s[1] = -0.03;   // in front of the lemon's place
  bar.record.q_s[3] = 0.0;     // the fingers reach 0.19 m ahead; the home place begins at 0.094 m
  bar.run(5.0);
  EXPECT_EQ(bar.count("stood_up"), 0);
  EXPECT_EQ(bar.value("stage"), kDrawBack);
  bar.record.q_s[3] = 2.0;  // draws the fingers in
  bar.run(0.1);
  EXPECT_EQ(bar.count("stood_up"), 1);
  EXPECT_LT(fromHome_m(bar, 0), 1e-12);
}

TEST(Bar, RowThatWouldSlideIntoTheFingers_WaitsUntilTheyAreDrawnIn) {
  BarTable bar(3);
  for (int i = 0; i < 3; ++i) {
    bar.record.bodies[bar.bodyOf(i)].position_m.y -= 0.128;
  }
  bar.exercise->reset();
  bar.record.q_s[0] = -0.071;
  bar.record.q_s[1] = -0.06;
  bar.record.q_s[3] = 0.0;
  bar.run(5.0);
  EXPECT_EQ(bar.value("stage"), kDrawBack);
  EXPECT_LT(bar.value("row_y_m"), -0.1);  // moving from -0.151 to -0.023
  bar.record.q_s[3] = 2.0;
  bar.runUntil("stage", kReach);
  EXPECT_NEAR(bar.value("row_y_m"), -0.023, 1e-9);
}

TEST(FreeBar, Restarted_ReturnsDisplacedDispensers) {
  BarTable bar(2, kFree);
  bar.tick();
  // Each dispenser stands at the other one's place.
  BodyState& cherry = bar.record.bodies[bar.bodyOf(1)];
  std::swap(lemon(bar).position_m, cherry.position_m);
  bar.run(3.0);
  EXPECT_GT(fromHome_m(bar, 0), 0.1);
  bar.hold(0, 3.0);
  bar.act(Act::kRestart);
  bar.run(1.0);
  EXPECT_EQ(bar.value("stage"), kDrawBack);
  EXPECT_GT(fromHome_m(bar, 0), 0.1);  // not out of the hand
  bar.drawBack();
  bar.run(0.01);
  EXPECT_LT(fromHome_m(bar, 0), 1e-12);
  EXPECT_LT(fromHome_m(bar, 1), 1e-12);
  EXPECT_EQ(bar.value("stage"), kReach);
  EXPECT_EQ(bar.left_l(), 0.7);
}

TEST(FreeBar, RestartedWithAllAtHome_ContinuesAtOnce) {
  BarTable bar(2, kFree);
  bar.run(0.1);
  bar.act(Act::kRestart);
  bar.run(0.002);
  EXPECT_EQ(bar.value("stage"), kReach);
  EXPECT_EQ(bar.count("stood_up"), 0);
}

TEST(Bar, Restarted_SlidesTheRowHome) {
  BarTable bar(3);
  bar.run(0.01);
  for (int i = 0; i < 3; ++i) {  // as in the second drink: moved, with the lemon still within reach
    bar.record.bodies[bar.bodyOf(i)].position_m.y += 0.06;
  }
  bar.exercise->reset();
  bar.run(1.0);
  EXPECT_NEAR(bar.value("row_y_m"), 0.037, 1e-9);
  bar.act(Act::kRestart);
  bar.run(0.1);
  bar.runUntil("stage", kReach);
  EXPECT_NEAR(bar.value("row_y_m"), -0.023, 1e-9);  // reach_y_m[0]
}

}  // namespace
}  // namespace wholehand::test
