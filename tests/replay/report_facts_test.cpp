#include "loop/core/sha256.hpp"
#include "record/synthetic_recording.hpp"
#include "replay/recording_measures.hpp"
#include "replay/recording_report.hpp"
#include "replay/therapy_facts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <numbers>
#include <string>
#include <utility>

namespace wholehand {
namespace {

/// Moved time before and after the current tick.
struct Moving {
  MovedTime before, now;
  void tick(Mover by, Help help = Help::kUnspecified, std::uint32_t periods = 1) {
    before = now;
    now.add(by, help, periods);
  }
};

TEST(MovedTime, PersonWithoutATick_IsNotCredited) {
  MovedTime time;
  EXPECT_FALSE(time.isPersons());
  time.add(Mover::kPerson, Help::kSome, 0);  // the first tick of a recording
  EXPECT_TRUE(time.isPersons());
  EXPECT_EQ(time.mostHelp(), Help::kSome);
  time.add(Mover::kPerson, Help::kFull, 999'998);
  EXPECT_EQ(time.mostHelp(), Help::kFull);
  time.add(Mover::kNobody, Help::kFull, 1);  // one of a million periods
  EXPECT_TRUE(time.isShared());
  EXPECT_EQ(time.share(), 999'999.0 / 1'000'000.0);
  EXPECT_EQ(time.mostly(), Mover::kPerson);
  EXPECT_EQ((time - time).sum(), 0U);
}

TEST(BodyContacts, ContactsWithShortBreaks_AreOneTouch) {
  BodyContacts log(3, "cube");
  Moving moving;
  for (int i = 0; i < 3000; ++i) {
    const double t = i * 1e-3;
    const bool touching = (t >= 0.5 && t < 1.0 && i % 50 > 5) || (t >= 2.0 && t < 2.25);
    // In a break between two contacts of the first touch, the virtual patient moves the hand.
    moving.tick(i == 603 ? Mover::kVirtualPatient : Mover::kPerson);
    if (touching) log.contact({t, 1e-3, 2.0 + t, t >= 2.0}, moving.before, moving.now);
    log.position({0.1 * t + (i % 2) * 4e-4, 0.0, 0.0}, t, true);  // 0.4 mm of jitter
  }
  const std::vector<Touch>& touches = log.timeline().touches;
  ASSERT_EQ(touches.size(), 2U);
  EXPECT_EQ(touches[0].body, 3);
  EXPECT_NEAR(touches[0].to_s - touches[0].from_s, 0.494,
              1e-9);  // from the first contact, at 0.506 s
  EXPECT_NEAR(touches[1].largest_force_n, 4.249, 1e-9);
  EXPECT_NEAR(touches[1].held_s, 0.25, 1e-9);
  EXPECT_TRUE(touches[0].moved.isShared());
  ASSERT_EQ(log.timeline().persons().size(), 1U);
  EXPECT_EQ(log.timeline().persons()[0].from_s, touches[1].from_s);
  // Each touch counts from its first contact to 0.2 s after its last; 0.2 s is the longest break
  // that is bridged.
  EXPECT_NEAR(log.timeline().travelled_m, 0.1 * (1.2 - 0.506) + 0.1 * (2.45 - 2.0), 2e-3);
}

// The exercise moves a row of fruit; a finger touched it once before.
TEST(BodyContacts, BodyMovedByTheExercise_HasTravelledNothing) {
  BodyContacts log(3, "lemon");
  Moving moving;
  for (int i = 0; i < 10'000; ++i) {
    const double t = i * 1e-3;
    moving.tick(Mover::kPerson);
    if (i >= 1000 && i < 1100) log.contact({t, 1e-3, 2.0, false}, moving.before, moving.now);
    log.position({i < 2000 ? 0.0 : 0.1 * (t - 2.0), 0.0, 0.0}, t, true);
  }
  EXPECT_EQ(log.timeline().travelled_m, 0.0);
}

// A force of 4 N + 0.5 N sin(2π 5 Hz t) over whole periods has the mean 4 N and the deviation
// 0.5/√2 N.
TEST(GripLog, SteadyGripWithTremor_HasItsMeanAndDeviation) {
  GripLog log;
  Moving moving;
  for (int i = 0; i < 5000; ++i) {
    const double t = i * 1e-3;
    const bool rises = t < 1.25 || t >= 3.75;  // the first and the last quarter of a second
    const double tremor_n = 0.5 * std::sin(2.0 * std::numbers::pi * 5.0 * t);
    moving.tick(i == 1000 ? Mover::kMotion : Mover::kPerson);  // the first tick of the grip
    const double force_n = t < 1.0 || t >= 4.0 ? 0.0 : rises ? 9.0 : 4.0 + tremor_n;
    log.add(t, force_n, moving.before, moving.now);
  }
  ASSERT_EQ(log.grips().size(), 1U);
  const Grip& grip = log.grips().front();
  EXPECT_NEAR(grip.from_s, 1.0, 1e-9);
  EXPECT_NEAR(grip.to_s, 3.999, 1e-9);
  EXPECT_NEAR(grip.mean_n, 4.0, 0.01);
  EXPECT_NEAR(grip.deviation_n, 0.5 / std::sqrt(2.0), 0.01);
  EXPECT_EQ(grip.largest_n, 9.0);
  EXPECT_EQ(grip.moved.sum(), 3000U);  // 1.000 s to 3.999 s
  EXPECT_EQ(grip.moved.persons(), 2999U);
}

TEST(GripLog, TouchesBelowASecondOrANewton_AreNoGrips) {
  GripLog log;
  const MovedTime none;
  for (int i = 0; i < 3000; ++i) log.add(i * 1e-3, i % 1000 < 900 ? 5.0 : 0.0, none, none);
  for (int i = 3000; i < 6000; ++i) log.add(i * 1e-3, 0.99, none, none);
  log.add(7.0, std::nan(""), none, none);
  log.end();
  EXPECT_TRUE(log.grips().empty());
}

TickRecord restingTick(int number) {
  TickRecord record;
  record.tick = static_cast<std::uint64_t>(number);
  record.time_s = number * 1e-3;
  record.moved_by = Mover::kPerson;
  record.effort_limit = AxisEffort(6, 20.0);
  record.phi = AxisRatio(6, number < 1000 ? 0.9 : 0.1);
  record.sent = AxisEffort(6);
  return record;
}

/// Makes facts of `ticks` resting ticks; `change` edits each one.
nlohmann::json therapyFacts(int ticks, const std::function<void(TickRecord&, int)>& change,
                            const RecordingMeta& meta = synthetic::meta()) {
  TherapyFacts facts(meta);
  for (int i = 0; i < ticks; ++i) {
    TickRecord record = restingTick(i);
    change(record, i);
    facts.add(record, true, static_cast<std::uint64_t>(i));
  }
  return facts.json();
}

TEST(TherapyFacts, ChangingLimit_IsReportedByTimeInAShortList) {
  const auto limits = therapyFacts(4000, [](TickRecord& record, int i) {
    record.effort_limit[2] = i < 2000 ? 20.0 : 8.0;
    record.effort_limit[3] =
        20.0 - 10.0 * std::min(1.0, i / 2000.0);  // falls from 20 N to 10 N in 2 s
  })["limits"];
  ASSERT_EQ(limits.size(), 6U);
  EXPECT_EQ(limits[0], nlohmann::json::parse("[[0.0, 20.0]]"));
  EXPECT_EQ(limits[2], nlohmann::json::parse("[[0.0, 20.0], [2.0, 8.0]]"));
  EXPECT_LE(limits[3].size(), 23U);  // one entry every 0.1 s
  EXPECT_EQ(limits[3].back()[1], 10.0);
}

TEST(TherapyFacts, SlotsOfAGame_CountOnlyWithABodyAndOnlyItsOwnTravel) {
  RecordingMeta meta = synthetic::meta();
  const auto scene_bodies = meta.body_names.size() - 2;  // the last two bodies serve as slots
  meta.game_slots = 2;
  meta.capsule_names = {"palm"};
  const auto slot = static_cast<int>(scene_bodies);
  const auto change = [slot](TickRecord& record, int i) {
    record.body_count = slot + 2;
    for (int b = slot; b < record.body_count; ++b) record.bodies[b].position_m = {0, 0, -10};
    // In the first slot one body moves 0.1 m in steps of 2 mm, another stands 1 m beside it.
    const bool there = (i >= 50 && i <= 100) || i >= 200;
    const double x_m = i >= 200 ? 1.1 : 0.002 * (i - 50);
    if (there) record.bodies[slot].position_m = {x_m, 0, 0.5};
    record.contact_count = there ? 1 : 0;
    record.contacts[0].body = slot;
    record.contacts[0].capsule = 0;
    record.contacts[0].force_n = Vec3{0.0, 0.0, 1.0};
  };
  const auto json = therapyFacts(300, change, meta);
  EXPECT_EQ(json["bodies_in_scene"], scene_bodies + 1);
  ASSERT_EQ(json["bodies"].size(), 1U);
  EXPECT_NEAR(json["bodies"][0]["travelled_m"].get<double>(), 0.1, 1e-9);
}

TEST(TherapyFacts, ForceOnABody_IsReportedByItsName) {
  RecordingMeta meta = synthetic::meta();
  meta.capsule_names = {"palm", "index_distal", "thumb_distal"};
  const auto change = [](TickRecord& record, int i) {
    record.contact_count = i >= 1000 ? 2 : 0;
    for (int c = 0; c < record.contact_count; ++c) {
      Contact& contact = record.contacts[c];
      contact.body = 2;
      contact.capsule = 1 + c;  // a finger and the thumb
      contact.force_n = Vec3{0.0, 3.0, 4.0};
    }
  };
  const auto json = therapyFacts(2000, change, meta);
  ASSERT_EQ(json["bodies"].size(), 1U);
  EXPECT_EQ(json["bodies"][0]["name"], "cylinder");
  EXPECT_NEAR(json["bodies"][0]["held_s"].get<double>(), 1.0, 1e-9);
  EXPECT_NEAR(json["bodies"][0]["largest_force_n"].get<double>(), 10.0,
              1e-12);  // two contacts of 5 N
  EXPECT_NEAR(json["strongest"]["time_s"].get<double>(), 1.0, 1e-12);
  EXPECT_EQ(json["strongest"]["row"], 1000);
}

TEST(TherapyFacts, LimitThatChangesAllTheTime_EndsWithTheLastValue) {
  // The limit changes every 0.5 s for 5,000 s, which is more than a page holds.
  const auto json = therapyFacts(10'000, [](TickRecord& record, int i) {
    record.time_s = 0.5 * i;
    record.effort_limit[1] = 5.0 + i % 7;
  });
  const auto& changes = json["limits"][1];
  EXPECT_LE(changes.size(), 2'000U);
  EXPECT_GE(changes.size(), 500U);
  EXPECT_EQ(changes.front()[0], 0.0);
  EXPECT_EQ(changes.back(), nlohmann::json({4999.5, 5.0 + 9'999 % 7}));
  EXPECT_GE(json["limits_between_s"].get<double>(), 0.5);
}

TEST(TherapyFacts, TouchesBeyondTheDrawnOnes_AreCountedInTheSums) {
  // 3,000 touches of one body, one tick long and 0.25 s apart; nobody moves during every third.
  RecordingMeta meta = synthetic::meta();
  meta.capsule_names = {"palm"};
  const auto json = therapyFacts(
      6'000,
      [](TickRecord& record, int i) {
        record.time_s = 0.125 * i;
        record.contact_count = i % 2;
        record.contacts[0].body = 2;
        record.contacts[0].force_n = Vec3{0.0, 0.0, 1.0};
        if (i / 2 % 3 == 0) record.moved_by = Mover::kNobody;
      },
      meta);
  EXPECT_EQ(json["touches"].size(), 1'000U);
  EXPECT_EQ(json["touches_left_out"], 2'000);
  EXPECT_EQ(json["touches_not_persons"], 1'000);
  EXPECT_EQ(json["bodies"][0]["touches"], 2'000);
}

/// Metadata of a bar with two values and the events that a report reads.
RecordingMeta barMeta() {
  RecordingMeta meta = synthetic::meta();
  meta.event_names = {"engaged", "step_done", "drink_done", "level_done", "restarted"};
  meta.value_names = {"poured_total_l", "score", "stars"};
  meta.result_names = {"poured_total_l", "score"};
  meta.result_labels = {"Poured", "Score"};
  meta.result_units = {"ml", ""};
  meta.result_factors = {1000.0, 1.0};
  meta.result_decimals = {0.0, 0.0};
  return meta;
}

/// One event of a session at the bar: its tick, and the values of the exercise from then on.
struct BarMoment {
  int tick, event, index;
  double value, poured_l, score;
};

/// Facts of a session with these events; `mover` gives the mover of each tick.
nlohmann::json barFacts(const std::vector<BarMoment>& moments,
                        const std::function<Mover(int)>& mover) {
  double poured_l = 0.0, score = 0.0;
  const auto change = [&](TickRecord& record, int i) {
    record.moved_by = mover(i);
    record.help = Help::kFull;
    record.q_m = AxisPosition(6);
    record.q_m[1] = 1e-4 * i;
    for (const BarMoment& m : moments) {
      if (m.tick != i) continue;
      ExerciseRecord& out = record.exercise;
      out.events[out.event_count++] = {m.event, m.index, m.value};
      poured_l = m.poured_l;
      score = m.score;
    }
    record.exercise.value_count = 3;
    record.exercise.values = {poured_l, score, 3.0};
  };
  return therapyFacts(2'000, change, barMeta());
}

enum : int { kEngaged, kStepDone, kDrinkDone, kLevelDone, kRestarted };

// Two drinks of 40 ml finish a level. The level begins again, and a third drink of 30 ml is
// finished.
const std::vector<BarMoment> kThreeDrinks = {
    {100, kEngaged, 0, 0.0, 0.0, 0.0},       {300, kStepDone, 0, 0.04, 0.04, 0.0},
    {300, kDrinkDone, 0, 90.0, 0.04, 90.0},  {500, kEngaged, 0, 0.0, 0.04, 90.0},
    {700, kStepDone, 0, 0.04, 0.08, 90.0},   {700, kDrinkDone, 1, 80.0, 0.08, 85.0},
    {800, kLevelDone, -1, 85.0, 0.08, 85.0}, {900, kRestarted, -1, 0.0, 0.0, 0.0},
    {1000, kEngaged, 0, 0.0, 0.0, 0.0},      {1200, kStepDone, 0, 0.03, 0.03, 0.0},
    {1200, kDrinkDone, 0, 70.0, 0.03, 70.0}, {1900, kRestarted, -1, 0.0, 0.0, 0.0},
};

TEST(TherapyFacts, RestartedLevel_KeepsTheFiguresOfItsFinishedDrinks) {
  const auto json = barFacts(kThreeDrinks, [](int) { return Mover::kPerson; });
  EXPECT_EQ(json["sums"]["drink_done"]["count"], 3);
  EXPECT_EQ(json["sums"]["drink_done"]["stars"], 9.0);
  EXPECT_EQ(json["sums"]["drink_done"]["helps"], nlohmann::json({0, 3, 0, 0}));
  EXPECT_EQ(json["sums"]["level_done"]["count"], 1);
  EXPECT_NEAR(json["results"][0]["value"].get<double>(), 110.0, 1e-9);  // 40 + 40 + 30 ml
  EXPECT_NEAR(json["results"][1]["value"].get<double>(), 80.0, 1e-9);   // mean of 90, 80, 70
  EXPECT_EQ(json["moved"]["share"], 1.0);
}

TEST(TherapyFacts, DrinksOfTheVirtualPatient_AreListedButNotSummed) {
  // The person moves from tick 500, when the second drink begins, to tick 1199, before the third
  // ends.
  const auto json = barFacts(kThreeDrinks, [](int tick) {
    return tick >= 500 && tick < 1200 ? Mover::kPerson : Mover::kVirtualPatient;
  });
  const auto& sums = json["sums"]["drink_done"];
  EXPECT_EQ(sums["count"], 1);
  EXPECT_EQ(sums["shared"], 1);
  EXPECT_EQ(sums["others"], 1);
  EXPECT_NEAR(json["results"][0]["value"].get<double>(), 40.0, 1e-9);
  EXPECT_EQ(json["results"][1]["value"], 80.0);
  ASSERT_EQ(json["parts"].size(), 4U);
  EXPECT_EQ(json["parts"][0]["by"], static_cast<int>(Mover::kVirtualPatient));
  EXPECT_EQ(json["parts"][0]["share"], 0.0);
  EXPECT_TRUE(json["parts"][1]["persons"].get<bool>());
  EXPECT_EQ(json["parts"][2]["event"], "level_done");
  EXPECT_EQ(json["parts"][2]["share"], 301.0 / 701.0);  // ticks 500 to 800 of 100 to 800
  EXPECT_EQ(json["parts"][3]["share"], 200.0 / 201.0);  // all but the last of ticks 1000 to 1200
  EXPECT_EQ(json["sums"]["level_done"]["shared"], 1);
  EXPECT_EQ(json["moved"]["by"], nlohmann::json({0, 700, 1300, 0}));
  EXPECT_EQ(json["moved"]["runs"].size(), 3U);
  // The reaches are ticks 0 to 100, 300 to 500 and 900 to 1000.
  EXPECT_EQ(json["reaches"]["count"], 1);
  EXPECT_EQ(json["reaches"]["shared"], 1);
  EXPECT_EQ(json["reaches"]["others"], 1);
}

/// A reach of 0.3 m to the left and then 0.4 m up, one second each, at 0.3 and 0.4 m/s, with 0.2 mm
/// of tremor. Before it, the virtual patient moves 1 m at 2 m/s.
void reachAroundACorner(TickRecord& record, int i) {
  constexpr int kPersonFrom = 500;
  const double t = 1e-3 * (i - kPersonFrom), tremor_m = 2e-4 * (i % 2);
  const bool person = i >= kPersonFrom;
  record.moved_by = person ? Mover::kPerson : Mover::kVirtualPatient;
  record.help = person && i < kPersonFrom + 500 ? Help::kSome : Help::kNone;
  record.q_m = AxisPosition(6);
  record.qd_mf = AxisVelocity(6);
  record.q_m[0] = tremor_m + (person ? 0.0 : 0.002 * i - 1.0);
  record.q_m[1] = person ? std::min(0.3, 0.3 * t) : 0.0;
  record.q_m[2] = person ? std::max(0.0, 0.4 * (t - 1.0)) : 0.0;
  if (!person) record.qd_mf[0] = 2.0;
  if (person) record.qd_mf[t < 1.0 ? 1 : 2] = t < 1.0 ? 0.3 : 0.4;
  ExerciseRecord& out = record.exercise;
  if (i == kPersonFrom) out.events[out.event_count++] = {kRestarted, -1, 0.0};
  if (i == kPersonFrom + 2000) out.events[out.event_count++] = {kEngaged, 0, 0.0};
}

// The hand still moves at the virtual patient's speed when the person takes over; the person aims
// at nothing.
TEST(TherapyFacts, HandTakenOverInMotion_GivesThePersonNoPeakSpeed) {
  const auto change = [](TickRecord& record, int i) {
    record.moved_by = i < 500 ? Mover::kVirtualPatient : Mover::kPerson;
    record.qd_mf = AxisVelocity(6);
    record.qd_mf[0] = i < 500 ? 2.0 : 2.0 * std::exp(-0.01 * (i - 500));
  };
  EXPECT_TRUE(therapyFacts(2000, change, barMeta())["reaches"]["peak_m_s"].is_null());
}

// Path over straight line: (0.3 + 0.4) / 0.5. Tremor across steps of 1 mm makes the path 2 % longer
// at most: sqrt(1 + 0.2²).
TEST(RecordingMeasures, ReachAroundACorner_HasItsTimePathAndSpeed) {
  const test::Folder folder;
  const std::string path = folder.path() + "/visit.h5";
  RecordingMeta meta = barMeta();
  meta.clinic_visit = 1'234'567'890'123;
  meta.clinic_item = 2;
  const auto writer = RecordingWriter::create(path, meta);
  ASSERT_TRUE(writer) << format(writer.errors());
  for (int i = 0; i <= 2500; ++i) {
    TickRecord record = restingTick(i);
    reachAroundACorner(record, i);
    ASSERT_TRUE((*writer)->append(record));
  }
  EXPECT_FALSE(recordingMeasures(path).ok()) << "it is still being written";
  (*writer)->close();
  const auto measures = recordingMeasures(path);
  ASSERT_TRUE(measures) << format(measures.errors());
  EXPECT_EQ((*measures)["visit"], 1'234'567'890'123U);
  EXPECT_EQ((*measures)["item"], 2);
  // The hand is 1 mm away at tick 504; the help ends at tick 1000.
  EXPECT_NEAR((*measures)["active_s"].get<double>(), 1.997, 1e-9);
  EXPECT_NEAR((*measures)["helped_s"].get<double>(), 0.496, 1e-9);
  EXPECT_EQ((*measures)["led_s"], 0.0);
  EXPECT_NEAR((*measures)["helped_share"].get<double>(), 496.0 / 1997.0, 1e-9);
  EXPECT_EQ((*measures)["ended_by"], "stop");
  EXPECT_EQ((*measures)["reaches"], 1);
  EXPECT_NEAR((*measures)["reach_s"].get<double>(), 2.0, 1e-9);
  EXPECT_NEAR((*measures)["path_ratio"].get<double>(), 1.4, 0.02 * 1.4);
  EXPECT_NEAR((*measures)["peak_speed_m_s"].get<double>(), 0.4, 1e-6);
  EXPECT_EQ((*measures)["recording"]["ticks"], 2501);
  EXPECT_TRUE((*measures)["recording"]["complete"].get<bool>());
  std::ifstream in(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  EXPECT_EQ((*measures)["recording"]["sha256"], sha256(bytes));
}

// A session ends at the neutral effort or in a fault. The recording of a killed one ends while it
// renders.
TEST(RecordingMeasures, SessionWithoutAnEnd_IsBrokenOffAndNotComplete) {
  const test::Folder folder;
  const std::string path = folder.path() + "/killed.h5";
  const std::pair<SafetyState, const char*> endings[] = {{SafetyState::kRendering, "broken_off"},
                                                         {SafetyState::kArmed, "broken_off"},
                                                         {SafetyState::kFaulted, "fault"},
                                                         {SafetyState::kDisarmed, "stop"}};
  for (const auto& [state, word] : endings) {
    const auto writer = RecordingWriter::create(path, barMeta());
    ASSERT_TRUE(writer) << format(writer.errors());
    for (int i = 0; i < 100; ++i) {
      TickRecord record = restingTick(i);
      record.safety_state = i < 99 ? SafetyState::kRendering : state;
      ASSERT_TRUE((*writer)->append(record));
    }
    (*writer)->close();
    const auto measures = recordingMeasures(path);
    ASSERT_TRUE(measures) << format(measures.errors());
    EXPECT_EQ((*measures)["ended_by"], word);
    EXPECT_EQ((*measures)["recording"]["complete"], word != std::string("broken_off"));
    const auto report = reportData(path, "");
    ASSERT_TRUE(report) << format(report.errors());
    EXPECT_EQ((*report)["about"]["ended_by"], word);
  }
}

// A recording killed in its first second still names its visit.
TEST(RecordingMeasures, RecordingWithoutATick_NamesItsVisit) {
  const test::Folder folder;
  const std::string path = folder.path() + "/short.h5";
  RecordingMeta meta = barMeta();
  meta.clinic_visit = 7;
  const auto writer = RecordingWriter::create(path, meta);
  ASSERT_TRUE(writer) << format(writer.errors());
  (*writer)->close();
  const auto measures = recordingMeasures(path);
  ASSERT_TRUE(measures) << format(measures.errors());
  EXPECT_EQ((*measures)["visit"], 7U);
  EXPECT_EQ((*measures)["recording"]["ticks"], 0);
  EXPECT_EQ((*measures)["recording"]["duration_s"], 0.0);
  EXPECT_TRUE((*measures)["peak_speed_m_s"].is_null());
}

TEST(RecordingMeasures, DamagedFile_IsNamed) {
  const test::Folder folder;
  const std::string path = folder.path() + "/cut.h5";
  std::ofstream(path) << "half a recor";
  const auto measures = recordingMeasures(path);
  ASSERT_FALSE(measures);
  EXPECT_EQ(measures.errors().front().file, path);
}

TEST(EngineeringFacts, Ticks_AreCountedInStepsOfThePeriod) {
  const RecordingMeta meta = synthetic::meta();
  EngineeringFacts facts(meta);
  for (int i = 0; i < 4000; ++i) {
    TickRecord record = restingTick(i);
    record.wall_ns = 95'500;  // 9.55 % of 1 ms
    if (i == 7) record.faults = Fault::kSpeedLimit;
    if (i == 7) record.fault_axis = 3;
    record.sent[1] = 2.0;
    record.q_m = AxisPosition(6);
    record.q_m[1] = 1e-5 * i;
    facts.add(record);
  }
  const auto json = facts.json();
  EXPECT_NEAR(json["work_j"].get<double>(), 2.0 * 1e-5 * 3999, 1e-9);  // force times way
  EXPECT_EQ(json["times"]["counts"][9], 4000);
  EXPECT_NEAR(json["damped_share"].get<double>(), 0.25, 1e-12);  // 1 s of 4 s
  ASSERT_EQ(json["faults"].size(), 1U);
  EXPECT_EQ(json["faults"][0]["name"], "speed limit exceeded");
  EXPECT_EQ(json["faults"][0]["axis"], "finger_flexion");
  EXPECT_EQ(json["faults"][0]["ticks"], 1);
  EXPECT_EQ(json["settings"]["seed"], std::to_string(meta.seed));
}

}  // namespace
}  // namespace wholehand
