#include "server/control_desk.hpp"

#include <gtest/gtest.h>

namespace wholehand {
namespace {

constexpr std::int64_t kMs = 1'000'000;

// The table in control_desk.hpp, line by line, in time that the test makes.
struct ControlDeskTest : ::testing::Test {
  ControlsArbiter arbiter;
  ControlDesk desk{arbiter};
  ControlDesk::Client anna = arbiter.newClient(), ben = arbiter.newClient();
  std::int64_t now = 1000 * kMs;

  ControlDesk::Advice after(std::int64_t ms) { return desk.advance(now += ms * kMs); }
  void annaTakes() {
    ASSERT_EQ(desk.take(anna, now), "");
    ASSERT_TRUE(desk.advance(now).holder_changed);
  }
};

TEST_F(ControlDeskTest, Nobody_NothingIsSaid) {
  const auto advice = after(60'000);
  EXPECT_FALSE(advice.owner_alive);
  EXPECT_FALSE(advice.give_back);
  EXPECT_FALSE(advice.holder_changed);
}

TEST_F(ControlDeskTest, SecondClient_IsRefusedUntilTheFirstGivesBack) {
  annaTakes();
  EXPECT_EQ(desk.take(ben, now), "another client holds the controls");
  EXPECT_EQ(desk.take(anna, now), "");  // twice does no harm
  EXPECT_NE(desk.release(ben), "");
  EXPECT_EQ(desk.release(anna), "");
  const auto advice = after(0);
  EXPECT_TRUE(advice.give_back);
  EXPECT_TRUE(advice.holder_changed);
  EXPECT_FALSE(advice.owner_alive);  // given back, not lost: the effort stays
  EXPECT_EQ(desk.take(ben, now), "");
}

TEST_F(ControlDeskTest, SilentHolder_LosesTheControlsAfter200msAndMustTakeThemAnew) {
  annaTakes();
  EXPECT_FALSE(after(200).owner_alive);
  const auto silent = after(1);
  ASSERT_TRUE(silent.owner_alive);
  EXPECT_FALSE(*silent.owner_alive);
  EXPECT_TRUE(silent.holder_changed);  // all are told, Anna too
  EXPECT_EQ(silent.silent_client, anna);
  EXPECT_FALSE(desk.held());
  desk.heard(anna, now);
  EXPECT_FALSE(after(100).owner_alive);  // to be heard again is not enough
  EXPECT_EQ(desk.take(anna, now), "");
  const auto back = after(0);
  ASSERT_TRUE(back.owner_alive);
  EXPECT_TRUE(*back.owner_alive);
  EXPECT_TRUE(back.give_back);  // where the hand was asked to be before is not meant any more
}

// Browsers let a hidden page beat once a second, and once a minute after some time.
TEST_F(ControlDeskTest, BeatsTooSeldom_TheEffortChangesOnce) {
  struct Case {
    std::int64_t every_ms, for_ms;
  };
  for (const auto& [every_ms, for_ms] :
       {Case{1000, 24'000}, {210, 24'000}, {1000, 600'000}, {60'000, 3'600'000}}) {
    annaTakes();
    int changes = 0;
    for (std::int64_t t = 0; t < for_ms; t += 10) {
      if (t % every_ms == 0) desk.heard(anna, now);
      const auto advice = after(10);
      if (!advice.owner_alive) continue;
      ++changes;
      EXPECT_FALSE(*advice.owner_alive);
      EXPECT_LE(t, 210);  // controls given back within 1 s
    }
    EXPECT_EQ(changes, 1) << "a beat every " << every_ms << " ms";
    ASSERT_EQ(desk.take(anna, now), "");
    ASSERT_EQ(desk.release(anna), "");
    (void)after(0);
  }
}

TEST_F(ControlDeskTest, SilentFor5s_TheVirtualPatientSteersAndNothingPushes) {
  annaTakes();
  (void)after(201);
  EXPECT_FALSE(after(5000).give_back);
  const auto lost = after(1);
  EXPECT_TRUE(lost.give_back);
  EXPECT_FALSE(lost.owner_alive);
  for (int i = 0; i < 100; ++i) {
    const auto advice = after(60'000);
    EXPECT_FALSE(advice.give_back);
    EXPECT_FALSE(advice.owner_alive);
  }
}

TEST_F(ControlDeskTest, LineLost_FadesAtOnceAndTheVirtualPatientSteersAfter5s) {
  annaTakes();
  desk.left(anna, now);
  const auto lost = after(0);
  ASSERT_TRUE(lost.owner_alive);
  EXPECT_FALSE(*lost.owner_alive);
  EXPECT_FALSE(lost.give_back);
  EXPECT_TRUE(lost.holder_changed);
  EXPECT_FALSE(after(5000).give_back);
  const auto given = after(1);
  EXPECT_TRUE(given.give_back);
  EXPECT_FALSE(given.owner_alive);  // it pushes again when somebody takes the controls
}

TEST_F(ControlDeskTest, LineLost_TheNextHolderBeginsWithTheVirtualPatient) {
  annaTakes();
  desk.left(anna, now);
  (void)after(0);
  EXPECT_EQ(desk.take(ben, now), "");
  const auto advice = after(0);
  EXPECT_TRUE(advice.give_back);  // not Anna's last aim
  ASSERT_TRUE(advice.owner_alive);
  EXPECT_TRUE(*advice.owner_alive);
}

TEST_F(ControlDeskTest, WatcherLeaves_NothingHappens) {
  annaTakes();
  desk.left(ben, now);
  EXPECT_FALSE(after(0).owner_alive);
  EXPECT_TRUE(desk.holds(anna));
}

// A game over UDP shares the arbiter, not the desk.
TEST_F(ControlDeskTest, GameElsewhere_HoldsAndLosesThem) {
  const auto game = arbiter.newClient();
  ASSERT_TRUE(arbiter.take(game));
  auto advice = after(0);
  EXPECT_TRUE(advice.holder_changed);
  EXPECT_NE(desk.take(anna, now), "");
  EXPECT_FALSE(after(60'000).owner_alive);  // its silence is its own server's matter
  ASSERT_TRUE(arbiter.release(game));
  advice = after(0);
  EXPECT_TRUE(advice.holder_changed);
  ASSERT_TRUE(advice.owner_alive);
  EXPECT_FALSE(*advice.owner_alive);
  EXPECT_FALSE(after(5000).give_back);
  advice = after(1);
  EXPECT_TRUE(advice.give_back);
  EXPECT_FALSE(advice.owner_alive);
}

TEST_F(ControlDeskTest, LeftAloneFor15Minutes_IsSaidOnceInAsLong) {
  constexpr std::int64_t kQuarter = 15 * 60 * 1000;
  EXPECT_FALSE(after(0).unattended);
  annaTakes();
  for (int i = 0; i < 12'000; ++i) {  // she watches, for 20 minutes
    desk.heard(anna, now);
    ASSERT_FALSE(after(100).unattended) << i;
  }
  EXPECT_EQ(desk.release(anna), "");
  EXPECT_FALSE(after(0).unattended);
  EXPECT_FALSE(after(kQuarter).unattended);
  EXPECT_TRUE(after(1).unattended);
  EXPECT_FALSE(after(kQuarter).unattended);
  EXPECT_TRUE(after(1).unattended);
}

// A therapist loads levels and arms without holding the controls.
TEST_F(ControlDeskTest, OrderOfSomebodyWithoutTheControls_BeginsThe15MinutesAnew) {
  constexpr std::int64_t kQuarter = 15 * 60 * 1000;
  EXPECT_FALSE(after(0).unattended);
  for (int i = 0; i < 4; ++i) {
    EXPECT_FALSE(after(kQuarter).unattended) << i;
    desk.attend(now);
  }
  EXPECT_FALSE(after(kQuarter).unattended);
  EXPECT_TRUE(after(1).unattended);
}

// The game's own server has told the program that nobody is alive; this desk has told it nothing.
TEST_F(ControlDeskTest, GameVanishesBetweenTwoFrames_TheNextHolderIsAliveAndStartsAnew) {
  for (const bool seen : {true, false}) {
    const auto game = arbiter.newClient();
    ASSERT_TRUE(arbiter.take(game));
    if (seen) (void)after(16);
    ASSERT_TRUE(arbiter.release(game));
    ASSERT_EQ(desk.take(anna, now), "");
    const auto advice = after(0);
    ASSERT_TRUE(advice.owner_alive) << seen;
    EXPECT_TRUE(*advice.owner_alive);
    EXPECT_TRUE(advice.give_back) << "not the game's last aim";
    ASSERT_EQ(desk.release(anna), "");
    (void)after(16);
  }
}

}  // namespace
}  // namespace wholehand
