#include "replay/engineering_facts.hpp"
#include "replay/grip_log.hpp"
#include "replay/therapy_facts.hpp"
#include "replay/touch_log.hpp"
#include "telemetry/synthetic_recording.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace wholehand {
namespace {

TEST(TouchLog, ShortBreaks_AreOneTouch) {
  TouchLog log(3, "cube");
  for (int i = 0; i < 3000; ++i) {
    const double t = i * 1e-3;
    const bool touching = (t >= 0.5 && t < 1.0 && i % 50 > 5) || (t >= 2.0 && t < 2.25);
    log.contact(t, 1e-3, touching, 2.0 + t, t >= 2.0);
    log.position({0.1 * t + (i % 2) * 4e-4, 0.0, 0.0});  // 30 cm, with 0.4 mm of jitter
  }
  ASSERT_EQ(log.story().touches.size(), 2U);
  EXPECT_EQ(log.story().touches[0].body, 3);
  EXPECT_NEAR(log.story().longest_s(), 0.494, 1e-9);  // from the first contact, at 0.506 s
  EXPECT_NEAR(log.story().largestForce_n(), 4.249, 1e-9);
  EXPECT_NEAR(log.story().held_s(), 0.25, 1e-9);
  EXPECT_NEAR(log.story().travelled_m, 0.3, 2e-3);
}

// A force of 4 N + 0.5 N sin(2π 5 Hz t) over whole periods: its mean is 4 N, its deviation 0.5/√2
// N.
TEST(GripLog, SteadyGripWithTremor_HasItsMeanAndDeviation) {
  GripLog log;
  for (int i = 0; i < 5000; ++i) {
    const double t = i * 1e-3;
    const bool rises = t < 1.25 || t >= 3.75;  // the first and the last quarter of a second
    const double tremor_n = 0.5 * std::sin(2.0 * std::numbers::pi * 5.0 * t);
    log.add(t, t < 1.0 || t >= 4.0 ? 0.0 : rises ? 9.0 : 4.0 + tremor_n);
  }
  ASSERT_EQ(log.grips().size(), 1U);
  const Grip& grip = log.grips().front();
  EXPECT_NEAR(grip.from_s, 1.0, 1e-9);
  EXPECT_NEAR(grip.to_s, 3.999, 1e-9);
  EXPECT_NEAR(grip.mean_n, 4.0, 0.01);
  EXPECT_NEAR(grip.deviation_n, 0.5 / std::sqrt(2.0), 0.01);
  EXPECT_EQ(grip.largest_n, 9.0);
}

TEST(GripLog, TouchesOfLessThanASecondOrANewton_AreNoGrips) {
  GripLog log;
  for (int i = 0; i < 3000; ++i) log.add(i * 1e-3, i % 1000 < 900 ? 5.0 : 0.0);
  for (int i = 3000; i < 6000; ++i) log.add(i * 1e-3, 0.99);
  log.add(7.0, std::nan(""));
  log.end();
  EXPECT_TRUE(log.grips().empty());
}

TickRecord restingTick(int number) {
  TickRecord record;
  record.tick = static_cast<std::uint64_t>(number);
  record.time_s = number * 1e-3;
  record.effort_limit = AxisEffort(6, 20.0);
  record.phi = AxisRatio(6, number < 1000 ? 0.9 : 0.1);
  record.sent = AxisEffort(6);
  return record;
}

/// Facts of so many resting ticks, of which `change` makes what they are.
nlohmann::json therapyFacts(int ticks, const std::function<void(TickRecord&, int)>& change,
                            const RecordingMeta& meta = synthetic::meta()) {
  TherapyFacts facts(meta);
  for (int i = 0; i < ticks; ++i) {
    TickRecord record = restingTick(i);
    change(record, i);
    facts.add(record, true);
  }
  return facts.json();
}

TEST(TherapyFacts, LimitThatChanges_IsToldWithItsTimesAndStaysShort) {
  const auto limits = therapyFacts(4000, [](TickRecord& record, int i) {
    record.effort_limit[2] = i < 2000 ? 20.0 : 8.0;
    record.effort_limit[3] = 20.0 - 10.0 * std::min(1.0, i / 2000.0);  // 2 s from 20 N to 10 N
  })["limits"];
  ASSERT_EQ(limits.size(), 6U);
  EXPECT_EQ(limits[0], nlohmann::json::parse("[[0.0, 20.0]]"));
  EXPECT_EQ(limits[2], nlohmann::json::parse("[[0.0, 20.0], [2.0, 8.0]]"));
  EXPECT_LE(limits[3].size(), 23U);  // one every 0.1 s
  EXPECT_EQ(limits[3].back()[1], 10.0);
}

TEST(TherapyFacts, SlotsOfAGame_CountOnceTheyHeldABodyAndTheirEmptyPlaceIsNoWay) {
  RecordingMeta meta = synthetic::meta();
  const auto scene_bodies = meta.body_names.size() - 2;  // the last two are taken for slots
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

TEST(TherapyFacts, ForceOnABody_IsToldByItsName) {
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
  EXPECT_NEAR(json["bodies"][0]["largest_force_n"].get<double>(), 10.0, 1e-12);  // twice 5 N
  EXPECT_NEAR(json["largest_force_s"].get<double>(), 1.0, 1e-12);
}

TEST(EngineeringFacts, Ticks_AreCountedInStepsOfThePeriod) {
  const RecordingMeta meta = synthetic::meta();
  EngineeringFacts facts(meta);
  for (int i = 0; i < 4000; ++i) {
    TickRecord record = restingTick(i);
    record.wall_ns = 95'500;  // 9.55 % of a millisecond
    if (i == 7) record.faults = Fault::kSpeedLimit;
    if (i == 7) record.fault_axis = 3;
    facts.add(record);
  }
  const auto json = facts.json();
  EXPECT_EQ(json["times"]["counts"][9], 4000);
  EXPECT_NEAR(json["damped_share"].get<double>(), 0.25, 1e-12);  // the first second of four
  ASSERT_EQ(json["faults"].size(), 1U);
  EXPECT_EQ(json["faults"][0]["name"], "speed limit exceeded");
  EXPECT_EQ(json["faults"][0]["axis"], "finger_flexion");
  EXPECT_EQ(json["faults"][0]["ticks"], 1);
  EXPECT_EQ(json["settings"]["seed"], std::to_string(meta.seed));
}

}  // namespace
}  // namespace wholehand
