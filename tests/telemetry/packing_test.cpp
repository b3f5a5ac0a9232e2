// What a recording packs comes back to the bit, whatever it is, and what the laws of the renderer
// make takes little room.
#include "support/says.hpp"
#include "telemetry/round_trip.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace wholehand {
namespace {

using synthetic::Folder;
using synthetic::kManyTicks;
using synthetic::ofSchema;
using synthetic::roundTrip;

/// Sets every array of numbers per axis and joint.
template <class Make>
void setArrays(TickRecord& r, Make make) {
  const auto fill = [&make](auto& array) {
    for (int i = 0; i < array.size(); ++i) array[i] = make();
  };
  fill(r.q_m), fill(r.intention), fill(r.patient_effort), fill(r.qd_mf), fill(r.q_s), fill(r.qd_s);
  fill(r.theta), fill(r.f_s), fill(r.coupling), fill(r.phi), fill(r.damping), fill(r.rendered);
  fill(r.sent), fill(r.tank), fill(r.tank_effort), fill(r.exercise.effort);
  fill(r.closure), fill(r.exercise.wall);
  r.exercise.alpha = make();
  for (int i = 0; i < r.exercise.value_count; ++i) r.exercise.values[i] = make();
  for (int b = 0; b < r.body_count; ++b) {
    BodyState& body = r.bodies[b];
    body = {{make(), make(), make()},
            {make(), make(), make(), make()},
            {make(), make(), make()},
            {make(), make(), make()}};
  }
  r.palm_distance_m = make();
  r.palm_target_distance_m = make();
}

/// One tick after another by the formulas of docs/recording.md, written down a second time.
class LawfulTicks {
 public:
  TickRecord next() {
    TickRecord r = synthetic::noisy(tick_, random_);
    const RecordedLaw law = synthetic::meta().law;
    r.elapsed_periods = 1;
    r.intention = AxisPosition(6);
    r.patient_effort = AxisEffort(6);
    for (int i = 0; i < 6; ++i) {
      const auto a = static_cast<std::size_t>(i);
      r.q_m[i] = 1e-5 * std::round(1e5 * std::sin(1e-3 * static_cast<double>(tick_) + i));
      const double moved = r.q_m[i] - before_.q_m[i];
      r.qd_mf[i] = (law.filter_tau_s[a] * before_.qd_mf[i] + moved) / (law.filter_tau_s[a] + 1e-3);
      r.qd_s[i] = 0.3 * std::sin(2e-3 * static_cast<double>(tick_) + i);
      r.q_s[i] = before_.q_s[i] + 1e-3 * r.qd_s[i];
      const double spring = law.k_pm[a] * (r.q_m[i] - r.q_s[i]);
      // Critical damping of an inertia that another axis changes.
      const double inertia = 20.0 + 3.0 * r.q_s[0] * r.q_s[0];
      r.f_s[i] = spring + inertia * (r.qd_mf[i] - r.qd_s[i]);
      // A tremor about a target that moves.
      r.intention[i] = 0.2 + 1e-5 * static_cast<double>(tick_) +
                       1e-3 * std::sin(0.066 * static_cast<double>(tick_) + i);
      r.patient_effort[i] = 0x1p-24 * std::round(0x1p24 * (3.0 + std::sin(r.time_s)));
      r.coupling[i] = law.gamma[a] * (spring - r.f_s[i]) - spring;
      r.phi[i] = std::pow(0.997, static_cast<double>(tick_ % 250));
      r.damping[i] = -r.phi[i] * law.k_dm[a] * r.qd_mf[i];
      r.exercise.effort[i] = r.tank_effort[i] = 0.0;
      r.rendered[i] = r.coupling[i] + r.damping[i];
      r.sent[i] = r.rendered[i];
    }
    for (int j = 0; j < r.theta.size(); ++j) {
      r.theta[j] = 0.1;
      for (int a = 0; a < 6; ++a) {
        if (law.synergy[6 * j + a] != 0.0) r.theta[j] += 0.5 * r.q_s[a];
      }
    }
    ++tick_;
    before_ = r;
    return r;
  }

 private:
  std::mt19937_64 random_{1};
  std::uint64_t tick_ = 0;
  TickRecord before_ = firstRecord();
  static TickRecord firstRecord() {
    TickRecord r;
    r.q_m = r.q_s = AxisPosition(6);
    r.qd_mf = AxisVelocity(6);
    return r;
  }
};

std::vector<TickRecord> lawfulTicks(std::size_t count) {
  LawfulTicks source;
  std::vector<TickRecord> ticks;
  for (std::size_t i = 0; i < count; ++i) ticks.push_back(source.next());
  return ticks;
}

/// 600, more than two chunks, whose every number is one that `make` makes.
template <class Make>
std::vector<TickRecord> ticksOf(Make make) {
  std::vector<TickRecord> ticks = synthetic::noisyTicks(600, 2);
  for (TickRecord& tick : ticks) setArrays(tick, make);
  return ticks;
}

TEST(Packing, AnyBitsAtAll_ComeBack) {
  std::mt19937_64 random(2);
  roundTrip(ticksOf([&random] { return std::bit_cast<double>(random()); }));
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const double special[] = {
      0.0,       -0.0,   1.0,        -1.0,    std::bit_cast<double>(0x7FF8'0000'0000'0001),
      kInfinity, 5e-324, -kInfinity, -1e-310, std::bit_cast<double>(~0ULL)};
  roundTrip(ticksOf([&] { return special[random() % std::size(special)]; }));
}

TEST(Packing, RowsWrittenInTheMiddleOfAChunkOrWithoutTheLaw_ComeBack) {
  const std::vector<TickRecord> ticks = lawfulTicks(260);  // a chunk has 250
  for (const std::size_t every : {7, 100}) roundTrip(ticks, synthetic::meta(), every);
  roundTrip(lawfulTicks(30), synthetic::meta(), 1);
  RecordingMeta without = synthetic::meta();
  without.law = {};
  roundTrip(ticks, without);
}

// 61 numbers of a tick follow from the others by the formulas: its time, 18 joints, and q_s, qd_mf,
// coupling, phi, damping, rendered and sent of six axes. The plain file holds all of them: 8 bytes
// for each, of which compression leaves 7.
TEST(Packing, WhatTheLawsMake_ComesBackFromEverySchemaAndTakesLittleRoom) {
  const std::vector<TickRecord> ticks = lawfulTicks(kManyTicks);
  const double plain_bytes = roundTrip(ticks, ofSchema(kPackedSchema - 1));
  for (std::uint32_t schema = kPackedSchema; schema <= synthetic::meta().schema; ++schema) {
    const double bytes = roundTrip(ticks, ofSchema(schema));
    std::printf("figure: %.0f bytes a tick in schema %u\n", bytes, schema);
    EXPECT_LT(bytes, plain_bytes - 0.7 * 61 * 7) << "schema " << schema;
  }
}

TEST(Packing, LawOfAnotherDevice_IsRefused) {
  const Folder folder;
  RecordingMeta meta = synthetic::meta();
  meta.law.synergy.pop_back();
  const auto refused = RecordingWriter::create(folder.file("a.h5"), meta);
  EXPECT_TRUE(test::refusedWith(refused, "for each axis and joint"));
}

#if defined(__SSE2__)
// The loop's thread flushes denormal numbers to zero; a thread that it starts does so, too.
TEST(Packing, WrittenWhereDenormalsAreFlushed_ComesBackElsewhere) {
  const Folder folder;
  std::vector<TickRecord> ticks = lawfulTicks(300);
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    ticks[i].phi[0] = 1e-307 / static_cast<double>(i + 1);  // denormal from the fifth on
  }
  const unsigned before = _mm_getcsr();
  _mm_setcsr(before | 0x8040U);
  synthetic::writeRecording(folder.file("a.h5"), ticks);
  _mm_setcsr(before);
  const auto reader = RecordingReader::open(folder.file("a.h5")).value();
  ASSERT_EQ(reader->size(), ticks.size());
  TickRecord got;
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    ASSERT_TRUE(reader->read(i, got) && synthetic::identical(got, ticks[i])) << "tick " << i;
  }
}
#endif

}  // namespace
}  // namespace wholehand
