#include "station/server/control_timeouts.hpp"

#include "support/seed.hpp"
#include "support/tolerance.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace wholehand {
namespace {

constexpr std::int64_t kMs = 1'000'000;

// Checks the table in control_timeouts.hpp line by line; the test sets the time.
struct ControlTimeoutsTest : ::testing::Test {
  ControlHolder controls;
  ControlTimeouts timeouts{controls};
  ControlTimeouts::Client anna = controls.newClient(), ben = controls.newClient();
  std::int64_t now = 1000 * kMs;

  /// Lets `ms` pass with a call of advance() every 10 ms, and returns all advice in one.
  ControlTimeouts::Advice after(std::int64_t ms) {
    ControlTimeouts::Advice all = timeouts.advance(now += std::min<std::int64_t>(ms, 10) * kMs);
    for (std::int64_t passed = 10; passed < ms; passed += 10) {
      add(timeouts.advance(now += std::min<std::int64_t>(ms - passed, 10) * kMs), all);
    }
    return all;
  }
  static void add(const ControlTimeouts::Advice& more, ControlTimeouts::Advice& all) {
    if (more.holder_alive) all.holder_alive = more.holder_alive;
    all.give_back = all.give_back || more.give_back;
    all.unattended = all.unattended || more.unattended;
    all.holder_changed = all.holder_changed || more.holder_changed;
    if (more.silent_client != 0) all.silent_client = more.silent_client;
    if (more.suspended_client != 0) all.suspended_client = more.suspended_client;
  }
  /// Lets `ms` pass in one step, as in a standstill of the program.
  ControlTimeouts::Advice afterStandstill(std::int64_t ms) {
    return timeouts.advance(now += ms * kMs);
  }
  void annaTakes() {
    ASSERT_EQ(timeouts.take(anna, now), "");
    ASSERT_TRUE(timeouts.advance(now).holder_changed);
  }
};

TEST_F(ControlTimeoutsTest, NoHolder_GivesNoAdvice) {
  const auto advice = after(60'000);
  EXPECT_FALSE(advice.holder_alive);
  EXPECT_FALSE(advice.give_back);
  EXPECT_FALSE(advice.holder_changed);
}

TEST_F(ControlTimeoutsTest, SecondClient_IsRefusedUntilTheFirstGivesBack) {
  annaTakes();
  EXPECT_EQ(timeouts.take(ben, now), "another client holds the controls");
  EXPECT_EQ(timeouts.take(anna, now), "");  // taking them twice is accepted
  EXPECT_NE(timeouts.release(ben), "");
  EXPECT_EQ(timeouts.release(anna), "");
  const auto advice = after(0);
  EXPECT_TRUE(advice.give_back);
  EXPECT_TRUE(advice.holder_changed);
  EXPECT_FALSE(advice.holder_alive);  // released, not lost: the effort stays
  EXPECT_EQ(timeouts.take(ben, now), "");
}

TEST_F(ControlTimeoutsTest, SilentHolder_IsSuspendedAfter200msAndResumesWithin2s) {
  annaTakes();
  EXPECT_FALSE(after(200).holder_alive);
  const auto silent = after(1);
  ASSERT_TRUE(silent.holder_alive);
  EXPECT_FALSE(*silent.holder_alive);
  EXPECT_FALSE(silent.holder_changed);
  EXPECT_EQ(silent.suspended_client, anna);
  EXPECT_EQ(timeouts.take(ben, now), "another client holds the controls");
  EXPECT_FALSE(after(1799).holder_changed);
  timeouts.noteMessage(anna, now);
  const auto back = after(0);
  ASSERT_TRUE(back.holder_alive);
  EXPECT_TRUE(*back.holder_alive);
  EXPECT_FALSE(back.give_back) << "her aim goes on";
  EXPECT_TRUE(timeouts.holds(anna));
}

TEST_F(ControlTimeoutsTest, SilentFor2s_LosesTheControlsAndMustTakeThemAnew) {
  annaTakes();
  EXPECT_FALSE(after(2000).holder_changed);
  const auto silent = after(1);
  EXPECT_FALSE(silent.holder_alive) << "was said when the silence began";
  EXPECT_TRUE(silent.holder_changed);  // all clients are notified, Anna too
  EXPECT_EQ(silent.silent_client, anna);
  EXPECT_FALSE(timeouts.held());
  timeouts.noteMessage(anna, now);
  EXPECT_FALSE(after(100).holder_alive);  // a new message is not enough
  EXPECT_EQ(timeouts.take(anna, now), "");
  const auto back = after(0);
  ASSERT_TRUE(back.holder_alive);
  EXPECT_TRUE(*back.holder_alive);
  EXPECT_TRUE(back.give_back);  // her earlier aim no longer applies
}

// Standstills of 0.1 to 5 s: her messages wait in a socket, or her page stood still too.
TEST_F(ControlTimeoutsTest, ProgramStall_KeepsHolderThatSendsAfterwards) {
  auto random = test::seededRandom(1701);
  for (int i = 0; i < test::cases(1000); ++i) {
    annaTakes();
    for (int more = 0; more < 20; ++more) {
      (void)after(static_cast<std::int64_t>(random() % 100));
      timeouts.noteMessage(anna, now);
      const auto woken = afterStandstill(100 + static_cast<std::int64_t>(random() % 4900));
      ASSERT_FALSE(woken.holder_alive);
      ASSERT_EQ(woken.silent_client, 0U);
      const auto waits = after(static_cast<std::int64_t>(random() % 200));
      ASSERT_FALSE(waits.holder_alive);
      timeouts.noteMessage(anna, now);
      ASSERT_TRUE(timeouts.holds(anna));
    }
    ASSERT_EQ(timeouts.release(anna), "");
    (void)after(0);
  }
}

TEST_F(ControlTimeoutsTest, HolderVanishingInAStandstill_IsSuspended200msAfterIt) {
  (void)after(0);
  annaTakes();
  (void)after(100);
  (void)afterStandstill(5000);
  EXPECT_FALSE(after(200).holder_alive);
  const auto silent = after(1);
  ASSERT_TRUE(silent.holder_alive);
  EXPECT_FALSE(*silent.holder_alive);
  ASSERT_EQ(timeouts.release(anna), "");
  (void)after(0);
  annaTakes();
  (void)afterStandstill(300);
  const auto second = afterStandstill(300);
  ASSERT_TRUE(second.holder_alive) << "one standstill of a silence is excused";
  EXPECT_FALSE(*second.holder_alive);
}

// Browsers let a hidden page send heartbeats once a second, and later once a minute.
TEST_F(ControlTimeoutsTest, TooRareHeartbeats_ReturnTheEffortOnceAtMost) {
  struct Case {
    std::int64_t every_ms, for_ms;
  };
  for (const auto& [every_ms, for_ms] :
       {Case{1000, 24'000}, {210, 24'000}, {1000, 600'000}, {60'000, 3'600'000}}) {
    annaTakes();
    int returns = 0;
    bool alive = true;
    for (std::int64_t t = 0; t < for_ms; t += 10) {
      if (t % every_ms == 0) timeouts.noteMessage(anna, now);
      const auto advice = after(10);
      if (!advice.holder_alive) continue;
      returns += *advice.holder_alive ? 1 : 0;
      alive = *advice.holder_alive;
      EXPECT_LE(t, 2 * std::min<std::int64_t>(every_ms, 1000) + 210);
    }
    EXPECT_FALSE(alive);
    EXPECT_LE(returns, 1) << "a beat every " << every_ms << " ms";
    ASSERT_EQ(timeouts.take(anna, now), "");
    ASSERT_EQ(timeouts.release(anna), "");
    (void)after(0);
  }
}

// On a busy machine the page is silent for up to 1.9 s every few seconds, for an hour. Its player
// never loses the controls, and the effort returns once the heartbeats are regular.
TEST_F(ControlTimeoutsTest, FrequentSilencesUnder2s_KeepTheControls) {
  auto random = test::seededRandom(1703);
  annaTakes();
  bool alive = true;
  std::int64_t silences = 0;
  for (std::int64_t t = 0, beat = 0; t < 3'600'000; t += 10) {
    if (t >= beat) {
      timeouts.noteMessage(anna, now);
      const bool silent = random() % 20 == 0;  // about every 2 s
      silences += silent ? 1 : 0;
      beat = t + (silent ? 210 + static_cast<std::int64_t>(random() % 1700) : 100);
    }
    const auto advice = after(10);
    if (advice.holder_alive) alive = *advice.holder_alive;
    ASSERT_TRUE(timeouts.holds(anna)) << "after " << t << " ms";
  }
  EXPECT_GT(silences, 500);
  for (std::int64_t t = 0; t < 12'000; t += 10) {
    if (t % 100 == 0) timeouts.noteMessage(anna, now);
    const auto advice = after(10);
    if (advice.holder_alive) alive = *advice.holder_alive;
  }
  EXPECT_TRUE(alive) << "she has been heard for 12 s";
}

// Messages arrive 0 to 400 ms apart, for an hour. No effort returns while she is not heard.
TEST_F(ControlTimeoutsTest, HeartbeatsAtRandom_ReturnTheEffortOnceIn10sAtMost) {
  auto random = test::seededRandom(1702);
  for (int i = 0; i < test::cases(100); ++i) {
    annaTakes();
    std::int64_t returned_ms = -10'000, heard_ms = 0;
    for (std::int64_t t = 0, beat = 0; t < 60'000; t += 10) {
      if (t >= beat) {
        timeouts.noteMessage(anna, now);
        heard_ms = t;
        beat = t + static_cast<std::int64_t>(random() % (random() % 4 == 0 ? 400 : 190));
      }
      const auto advice = after(10);
      if (!advice.holder_alive || !*advice.holder_alive) continue;
      ASSERT_GE(t - returned_ms, 10'000);
      ASSERT_EQ(t, heard_ms);
      returned_ms = t;
    }
    if (timeouts.holds(anna)) ASSERT_EQ(timeouts.release(anna), "");
    (void)after(0);
  }
}

// A page that draws says from another thread that it is busy, now and then not in time. The effort
// is out all the time, nobody else gets the controls, and after its next message it goes on without
// a press.
TEST_F(ControlTimeoutsTest, BusyHolder_IsSuspendedAndKeepsTheControlsFor30s) {
  auto random = test::seededRandom(1704);
  for (int i = 0; i < test::cases(300); ++i) {
    annaTakes();
    const auto busy_ms = 1000 + static_cast<std::int64_t>(random() % 29'000);
    bool alive = true;
    for (std::int64_t t = 0, beat = 0; t < busy_ms; t += 10) {
      if (t >= beat) {
        timeouts.noteBusy(anna, now);
        beat = t + 50 + static_cast<std::int64_t>(random() % 1900);
      }
      const auto advice = after(10);
      if (advice.holder_alive) alive = *advice.holder_alive;
      ASSERT_EQ(alive, t + 10 <= 200) << t;
      ASSERT_TRUE(timeouts.holds(anna)) << t;
    }
    ASSERT_EQ(timeouts.take(ben, now), "another client holds the controls");
    timeouts.noteMessage(anna, now);
    EXPECT_TRUE(after(0).holder_alive.value_or(false)) << "after " << busy_ms << " ms";
    ASSERT_EQ(timeouts.release(anna), "");
    (void)after(0);
  }
}

TEST_F(ControlTimeoutsTest, HolderBusyForGood_LosesTheControls2sAfter30s) {
  annaTakes();
  ControlTimeouts::Advice all;
  std::int64_t lost_ms = 0;
  for (std::int64_t t = 0; t < 120'000; t += 10) {
    timeouts.noteBusy(anna, now);
    const auto advice = after(10);
    if (advice.silent_client != 0) lost_ms = t + 10;
    add(advice, all);
  }
  EXPECT_NEAR(static_cast<double>(lost_ms), 32'000.0, 20.0);
  EXPECT_EQ(timeouts.take(ben, now), "");
  timeouts.noteBusy(anna, now);
  EXPECT_TRUE(timeouts.holds(ben));
}

// The effort returns once in 10 s at most, too, when busy times and others alternate.
TEST_F(ControlTimeoutsTest, BusyAndHeardInTurn_ReturnTheEffortOnceIn10sAtMost) {
  annaTakes();
  std::int64_t returned_ms = -10'000;
  for (std::int64_t t = 0; t < 120'000; t += 10) {
    if (t / 400 % 2 == 0)
      timeouts.noteBusy(anna, now);
    else if (t % 50 == 0)
      timeouts.noteMessage(anna, now);
    const auto advice = after(10);
    if (!advice.holder_alive || !*advice.holder_alive) continue;
    EXPECT_GE(t - returned_ms, 10'000);
    returned_ms = t;
  }
  EXPECT_TRUE(timeouts.holds(anna));
}

TEST_F(ControlTimeoutsTest, HolderSilentFor5s_IsReplacedByTheVirtualPatientWithoutEffort) {
  annaTakes();
  (void)after(2001);
  EXPECT_FALSE(after(5000).give_back);
  const auto lost = after(1);
  EXPECT_TRUE(lost.give_back);
  EXPECT_FALSE(lost.holder_alive);
  for (int i = 0; i < 100; ++i) {
    const auto advice = after(60'000);
    EXPECT_FALSE(advice.give_back);
    EXPECT_FALSE(advice.holder_alive);
  }
}

TEST_F(ControlTimeoutsTest, LostLine_FadesAtOnceAndTheVirtualPatientSteersAfter5s) {
  annaTakes();
  timeouts.left(anna, now);
  const auto lost = after(0);
  ASSERT_TRUE(lost.holder_alive);
  EXPECT_FALSE(*lost.holder_alive);
  EXPECT_FALSE(lost.give_back);
  EXPECT_TRUE(lost.holder_changed);
  EXPECT_FALSE(after(5000).give_back);
  const auto given = after(1);
  EXPECT_TRUE(given.give_back);
  EXPECT_FALSE(given.holder_alive);  // the effort returns when a client takes the controls
}

TEST_F(ControlTimeoutsTest, NextHolderAfterALostLine_StartsWithTheVirtualPatient) {
  annaTakes();
  timeouts.left(anna, now);
  (void)after(0);
  EXPECT_EQ(timeouts.take(ben, now), "");
  const auto advice = after(0);
  EXPECT_TRUE(advice.give_back);  // not Anna's last aim
  ASSERT_TRUE(advice.holder_alive);
  EXPECT_TRUE(*advice.holder_alive);
}

TEST_F(ControlTimeoutsTest, WatcherThatLeaves_ChangesNothing) {
  annaTakes();
  timeouts.left(ben, now);
  EXPECT_FALSE(after(0).holder_alive);
  EXPECT_TRUE(timeouts.holds(anna));
}

// A game over UDP shares the arbiter but not this object.
TEST_F(ControlTimeoutsTest, GameOverUdp_HoldsAndLosesTheControls) {
  const auto game = controls.newClient();
  ASSERT_TRUE(controls.take(game));
  auto advice = after(0);
  EXPECT_TRUE(advice.holder_changed);
  EXPECT_NE(timeouts.take(anna, now), "");
  EXPECT_FALSE(after(60'000).holder_alive);  // its own server watches for its silence
  ASSERT_TRUE(controls.release(game));
  advice = after(0);
  EXPECT_TRUE(advice.holder_changed);
  ASSERT_TRUE(advice.holder_alive);
  EXPECT_FALSE(*advice.holder_alive);
  EXPECT_FALSE(after(5000).give_back);
  advice = after(1);
  EXPECT_TRUE(advice.give_back);
  EXPECT_FALSE(advice.holder_alive);
}

TEST_F(ControlTimeoutsTest, LeftAloneFor15Minutes_IsReportedEvery15Minutes) {
  constexpr std::int64_t kQuarter = 15 * 60 * 1000;
  EXPECT_FALSE(after(0).unattended);
  annaTakes();
  for (int i = 0; i < 12'000; ++i) {  // she is connected for 20 minutes
    timeouts.noteMessage(anna, now);
    ASSERT_FALSE(after(100).unattended) << i;
  }
  EXPECT_EQ(timeouts.release(anna), "");
  EXPECT_FALSE(after(0).unattended);
  EXPECT_FALSE(after(kQuarter).unattended);
  EXPECT_TRUE(after(1).unattended);
  EXPECT_FALSE(after(kQuarter).unattended);
  EXPECT_TRUE(after(1).unattended);
}

// A therapist loads levels and arms without holding the controls.
TEST_F(ControlTimeoutsTest, OrderOfAClientWithoutTheControls_RestartsThe15Minutes) {
  constexpr std::int64_t kQuarter = 15 * 60 * 1000;
  EXPECT_FALSE(after(0).unattended);
  for (int i = 0; i < 4; ++i) {
    EXPECT_FALSE(after(kQuarter).unattended) << i;
    timeouts.attend(now);
  }
  EXPECT_FALSE(after(kQuarter).unattended);
  EXPECT_TRUE(after(1).unattended);
}

// The game's server has reported the loss to the program; this desk has not seen it yet.
TEST_F(ControlTimeoutsTest, NextHolderAfterAGameVanished_IsAliveAndStartsAnew) {
  for (const bool seen : {true, false}) {
    const auto game = controls.newClient();
    ASSERT_TRUE(controls.take(game));
    if (seen) (void)after(16);
    ASSERT_TRUE(controls.release(game));
    ASSERT_EQ(timeouts.take(anna, now), "");
    const auto advice = after(0);
    ASSERT_TRUE(advice.holder_alive) << seen;
    EXPECT_TRUE(*advice.holder_alive);
    EXPECT_TRUE(advice.give_back) << "not the game's last aim";
    ASSERT_EQ(timeouts.release(anna), "");
    (void)after(16);
  }
}

}  // namespace
}  // namespace wholehand
