#include "loop/core/active_time.hpp"

#include "loop/core/geometry.hpp"
#include "record/synthetic_recording.hpp"
#include "replay/therapy_facts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

enum : int { kEngaged, kDisengaged, kPaused, kResumed, kRestarted };

/// Bar on six axes (x, y, z in m, three in rad) that can be paused and measures the grip.
RecordingMeta pausableBar() {
  RecordingMeta meta = synthetic::meta();
  meta.value_names = {"paused", "squeeze_n"};
  meta.event_names = {"engaged", "disengaged", "paused", "resumed", "restarted"};
  return meta;
}

/// What happens in a tick, for scripts that are counted by hand: one tick is 1 ms.
struct Script {
  Mover by = Mover::kPerson;
  Help help = Help::kNone;
  bool aims = true;  ///< the page sends the aim, at which the hand is at once
  double x_m = 0.0;
  double finger_rad = 0.0;
  bool paused = false, absent = false;
  double grip_n = 0.0;
  int event = -1;
};

TickRecord tickOf(const Script& script, int i, bool simulated) {
  TickRecord record;
  record.tick = static_cast<std::uint64_t>(i);
  record.time_s = i * 1e-3;
  record.moved_by = script.by;
  record.help = script.help;
  record.q_m = AxisPosition(6);
  record.q_m[0] = script.x_m;
  record.q_m[3] = script.finger_rad;
  if (simulated) record.intention = record.q_m;
  if (simulated && script.aims) {
    record.commands[record.command_count++].type = CommandType::kAim;
  }
  if (script.absent) record.faults = Fault::kHolderSilent;
  record.exercise.value_count = 2;
  record.exercise.values = {script.paused ? 1.0 : 0.0, script.grip_n};
  if (script.event >= 0) record.exercise.events[record.exercise.event_count++] = {script.event};
  return record;
}

ActivePeriods played(int ticks, bool simulated, const std::function<Script(int)>& script) {
  const RecordingMeta meta = pausableBar();
  ActiveTime active(meta.axis_units, meta.value_names);
  for (int i = 0; i < ticks; ++i) active.add(tickOf(script(i), i, simulated));
  return active.periods();
}

// 0.105 m/s from tick 1000 to tick 2000: 1 mm away every 10 ticks, from tick 1010 to tick 2000.
// Each movement counts for itself and for 2 s after it: ticks 1010 to 4000.
TEST(ActiveTime, OneMovementOfASecond_CountsFromItsFirstMillimetreToTwoSecondsAfterIt) {
  for (const bool simulated : {true, false}) {
    const ActivePeriods sum = played(8'000, simulated, [](int i) {
      return Script{.x_m = 1.05e-4 * std::clamp(i - 1000, 0, 1000)};
    });
    EXPECT_EQ(sum.active, 2991U) << simulated;
    EXPECT_EQ(sum.helped + sum.led, 0U);
  }
}

TEST(ActiveTime, RestingHand_IsNotActive) {
  for (const bool simulated : {true, false}) {
    const auto resting = [](int i) {
      return Script{.x_m = 4e-4 * (i % 2), .finger_rad = 0.5 + 8e-3 * (i % 2)};  // noise
    };
    EXPECT_EQ(played(8'000, simulated, resting).active, 0U);
  }
}

// A hand that was taken over in motion glides on, but nobody has aimed yet.
TEST(ActiveTime, MovementWithoutAnAim_IsNotTheSimulatedHandsPersons) {
  const auto glides = [](int i) { return Script{.aims = false, .x_m = 1.1e-3 * i}; };
  EXPECT_EQ(played(8'000, true, glides).active, 0U);
  EXPECT_EQ(played(8'000, false, glides).active, 7'999U);  // a device that is moved has no aims
}

TEST(ActiveTime, PauseAbsenceAndAnotherMover_EndItAtOnceAndCountNothing) {
  const std::function<void(Script&)> interruptions[] = {
      [](Script& s) { s.paused = true; }, [](Script& s) { s.absent = true; },
      [](Script& s) { s.by = Mover::kVirtualPatient; }};
  for (const auto& interrupt : interruptions) {
    // Moves all the time. Interrupted in ticks 1000 to 2999.
    const ActivePeriods sum = played(4'000, true, [&](int i) {
      Script script{.x_m = 1.1e-3 * i};
      if (i >= 1000 && i < 3000) interrupt(script);
      return script;
    });
    EXPECT_EQ(sum.active, 999U + 999U);  // the first tick of each part is where it begins
    // Does not move afterwards: what moved before does not count.
    const ActivePeriods before = played(4'000, true, [&](int i) {
      Script script{.x_m = 1.1e-3 * std::min(i, 1500)};
      if (i >= 1000 && i < 2000) interrupt(script);
      return script;
    });
    EXPECT_EQ(before.active, 999U);
  }
}

// Ticks 0 to 999 without help, 1000 to 1999 with some, 2000 to 2999 with full help; moves always.
TEST(ActiveTime, HelpedAndLedTime_AreApart) {
  const ActivePeriods sum = played(3'000, true, [](int i) {
    const Help help = i < 1000 ? Help::kNone : i < 2000 ? Help::kSome : Help::kFull;
    return Script{.help = help, .x_m = 1.1e-3 * i};
  });
  EXPECT_EQ(sum.active, 1'999U);
  EXPECT_EQ(sum.helped, 1'000U);
  EXPECT_EQ(sum.led, 999U);
}

// A finger that turns by 1.1 degrees once: 2001 ticks. One that turns by 0.9 degrees: none.
TEST(ActiveTime, TurningFinger_CountsFromOneDegree) {
  for (const double degrees : {0.9, 1.1}) {
    const ActivePeriods sum = played(
        8'000, true, [&](int i) { return Script{.finger_rad = i < 1000 ? 0.0 : degrees * kDeg}; });
    EXPECT_EQ(sum.active, degrees > 1.0 ? 2'001U : 0U);
  }
}

// A grip of 5 N from tick 1000 to tick 1999 with a still hand.
TEST(ActiveTime, GripInADevice_IsEffort_AndASimulatedOneIsNot) {
  const auto grips = [](int i) { return Script{.grip_n = i >= 1000 && i < 2000 ? 5.0 : 0.5}; };
  EXPECT_EQ(played(8'000, false, grips).active, 3'000U);
  EXPECT_EQ(played(8'000, true, grips).active, 0U);
}

TEST(ActiveTime, SkippedPeriods_Count) {
  const RecordingMeta meta = pausableBar();
  ActiveTime active(meta.axis_units, meta.value_names);
  active.add(tickOf({}, 0, false));
  TickRecord late = tickOf({.x_m = 0.1}, 30, false);
  late.elapsed_periods = 30;
  active.add(late);
  EXPECT_EQ(active.periods().active, 30U);
}

/// Reaches of a script in which the hand moves 1.1 mm in each tick, or not at all.
nlohmann::json reachesOf(const std::vector<std::pair<int, int>>& events, int paused_from,
                         int paused_to, bool moves = true) {
  const RecordingMeta meta = pausableBar();
  TherapyFacts facts(meta);
  for (int i = 0; i < 5'000; ++i) {
    Script script{.x_m = moves ? 1.1e-3 * i : 0.0, .paused = i >= paused_from && i < paused_to};
    TickRecord record = tickOf(script, i, false);
    for (const auto& [tick, event] : events) {
      if (tick != i) continue;
      record.exercise.events[record.exercise.event_count++] = {event};
    }
    facts.add(record, i > 0);
  }
  return facts.json()["reaches"];
}

// The bar lets go of a held bottle at a pause and takes hold of it again when the pause ends.
TEST(Reaches, PauseWhileHolding_IsNoReach) {
  const auto reaches = reachesOf({{1000, kEngaged},
                                  {2000, kPaused},
                                  {2000, kDisengaged},
                                  {3000, kResumed},
                                  {3001, kEngaged},
                                  {4000, kDisengaged},
                                  {4700, kEngaged}},
                                 2000, 3000);
  EXPECT_EQ(reaches["count"], 2);
  EXPECT_NEAR(reaches["sum_s"].get<double>(), 1.0 + 0.7, 1e-9);
}

TEST(Reaches, PauseOnTheWay_EndsTheReachWithoutAResult) {
  const auto reaches = reachesOf(
      {{1000, kPaused}, {2000, kResumed}, {2500, kEngaged}, {3000, kDisengaged}, {3500, kEngaged}},
      1000, 2000);
  EXPECT_EQ(reaches["count"], 1);
  EXPECT_NEAR(reaches["sum_s"].get<double>(), 0.5, 1e-9);
}

TEST(Reaches, HandThatIsThereAlready_DoesNotReach) {
  EXPECT_EQ(reachesOf({{50, kEngaged}}, 0, 0)["count"], 0);                        // 50 ms
  EXPECT_EQ(reachesOf({{1000, kRestarted}, {1000, kEngaged}}, 0, 0)["count"], 0);  // 0 ms
  EXPECT_EQ(reachesOf({{1000, kEngaged}}, 0, 0, false)["count"], 0);               // no way
  EXPECT_EQ(reachesOf({{1000, kEngaged}}, 0, 0)["count"], 1);
}

}  // namespace
}  // namespace wholehand
