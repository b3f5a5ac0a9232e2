// Series over sections of a recording, compared with a plain loop over its rows.
#include "replay/recording_series.hpp"

#include "record/recording.hpp"
#include "record/synthetic_recording.hpp"
#include "replay/recording_report.hpp"
#include "replay/series_reader.hpp"
#include "support/rig_tools.hpp"
#include "support/seed.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace wholehand::test {
namespace {

using synthetic::Folder;

constexpr double kSeriesPeriod_s = 1e-3;

/// Writes these ticks to a recording and opens it.
std::unique_ptr<RecordingReader> recorded(const Folder& folder,
                                          const std::vector<TickRecord>& ticks) {
  const std::string path = folder.file("run.h5");
  synthetic::writeRecording(path, ticks);
  return orThrow(RecordingReader::open(path));
}

/// `count` ticks without events.
std::vector<TickRecord> quietTicks(std::uint64_t count) {
  std::vector<TickRecord> ticks;
  for (std::uint64_t tick = 0; tick < count; ++tick) {
    TickRecord r;
    r.tick = tick;
    r.time_s = static_cast<double>(tick) * kSeriesPeriod_s;
    r.q_m = AxisPosition(6, 0.1);
    r.sent = AxisEffort(6, 0.0);
    r.exercise.value_count = 3;
    r.parameter_count = 2;
    r.safety_state = SafetyState::kRendering;
    ticks.push_back(r);
  }
  return ticks;
}

Series seriesOf(RecordingReader& reader, double from_s, double to_s, int columns) {
  return Series(seriesMessage(reader, {from_s, to_s, columns}));
}

double forceSum_n(const TickRecord& r) {
  double sum = 0.0;
  for (int c = 0; c < r.contact_count; ++c) {
    const Vec3& f = r.contacts[c].force_n;
    sum += std::sqrt(f.x * f.x + f.y * f.y + f.z * f.z);
  }
  return sum;
}

struct Check {
  const char* name;
  int axis;
  std::function<double(const TickRecord&)> value;
};

const std::vector<Check>& checks() {
  const double none = std::numeric_limits<double>::quiet_NaN();
  static const std::vector<Check> all = {
      {"q_m", 0, [](const auto& r) { return r.q_m[0]; }},
      {"q_s", 5, [](const auto& r) { return r.q_s[5]; }},
      {"intention", 2,
       [none](const auto& r) { return r.intention.size() > 2 ? r.intention[2] : none; }},
      {"sent", 3, [](const auto& r) { return r.sent[3]; }},
      {"exercise_effort", 1, [](const auto& r) { return r.exercise.effort[1]; }},
      {"damping", 4, [](const auto& r) { return r.damping[4]; }},
      {"phi", 2, [](const auto& r) { return r.phi[2]; }},
      {"alpha", 0, [](const auto& r) { return r.exercise.alpha; }},
      {"palm_target_distance_m", 0,
       [none](const auto& r) { return r.palm_body < 0 ? none : r.palm_target_distance_m; }},
      {"contact_force_n", 0, forceSum_n},
      {"contact_count", 0, [](const auto& r) { return static_cast<double>(r.contact_count); }},
      {"duration_s", 0, [](const auto& r) { return 1e-9 * static_cast<double>(r.wall_ns); }},
      {"value", 2, [](const auto& r) { return r.exercise.values[2]; }}};
  return all;
}

/// Compares the series with a plain loop over all ticks for every column.
void expectExtremes(const Series& series, const std::vector<TickRecord>& ticks, double from_s,
                    double to_s) {
  const auto columns = static_cast<double>(series.columns());
  for (const Check& check : checks()) {
    const std::size_t channel = series.channel(check.name, check.axis);
    for (std::size_t c = 0; c < series.columns(); ++c) {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (const TickRecord& r : ticks) {
        if (r.time_s < from_s || r.time_s >= to_s) continue;
        const double at = std::floor((r.time_s - from_s) / (to_s - from_s) * columns);
        if (at != static_cast<double>(c) || !std::isfinite(check.value(r))) continue;
        low = std::min(low, check.value(r));
        high = std::max(high, check.value(r));
      }
      if (low > high) {
        ASSERT_TRUE(std::isnan(series.low(channel, c))) << check.name << " column " << c;
        ASSERT_TRUE(std::isnan(series.high(channel, c))) << check.name << " column " << c;
      } else {
        // The values are sums in single precision: they agree within a few units in the last place.
        ASSERT_NEAR(series.low(channel, c), low, 5e-7 * std::abs(low)) << check.name << " " << c;
        ASSERT_NEAR(series.high(channel, c), high, 5e-7 * std::abs(high)) << check.name << " " << c;
      }
    }
  }
}

TEST(RecordingSeries, Extremes_EqualThoseOfAPlainLoop) {
  auto random = seededRandom(91);
  std::vector<TickRecord> ticks;
  for (std::uint64_t tick = 0; tick < 1200; ++tick) {
    ticks.push_back(synthetic::noisy(tick, random));
    ticks.back().wall_ns += 1;  // 0 means that there is no value
  }
  ticks.erase(ticks.begin() + 400, ticks.begin() + 460);  // leaves columns empty
  const Folder folder;
  const auto reader = recorded(folder, ticks);
  std::uniform_real_distribution<double> time(-0.3, 1.5);
  for (int i = 0; i < 12; ++i) {
    double from_s = time(random), to_s = time(random);
    if (from_s > to_s) std::swap(from_s, to_s);
    const int columns = 1 + static_cast<int>(random() % 300);
    SCOPED_TRACE(testing::Message() << from_s << " .. " << to_s << " s in " << columns);
    const Series series = seriesOf(*reader, from_s, to_s, columns);
    expectExtremes(series, ticks, from_s, to_s);
    const auto first = std::find_if(ticks.begin(), ticks.end(),
                                    [&](const TickRecord& r) { return r.time_s >= from_s; });
    EXPECT_EQ(series.header["first_tick"], first - ticks.begin());
    EXPECT_FALSE(series.header["truncated"]);
  }
}

TEST(RecordingSeries, ReaderOfOnlyTheNeededDatasets_GivesTheSameBytes) {
  const Folder folder;
  const std::string path = folder.file("a.h5");
  synthetic::writeRecording(path, synthetic::noisyTicks(900, 7));
  const auto whole = orThrow(RecordingReader::open(path));
  const auto sparing = orThrow(viewRecording(path, leftOutOfSeries()));
  const SeriesQuestion question{-0.0005, 0.8995, 900};
  EXPECT_TRUE(seriesMessage(*sparing.reader, question) == seriesMessage(*whole, question));
}

TEST(RecordingSeries, SingleExtremeTick_IsVisibleInASeriesOfAMinute) {
  auto ticks = quietTicks(3000);
  ticks[1777].sent[4] = 7.5;
  ticks[1777].exercise.values[1] = -3.25;
  const Folder folder;
  const auto reader = recorded(folder, ticks);
  const Series series = seriesOf(*reader, 0.0, 60.0, 100);
  const std::size_t sent = series.channel("sent", 4), value = series.channel("value", 1);
  EXPECT_EQ(series.high(sent, 2), 7.5F);  // 1.777 s lies in column 2; a column covers 0.6 s
  EXPECT_EQ(series.low(sent, 2), 0.0F);
  EXPECT_EQ(series.low(value, 2), -3.25F);
  EXPECT_TRUE(std::isnan(series.high(sent, 5))) << "the recording ends at 3 s";
}

TEST(RecordingSeries, MissingTicks_AreGapsButSkippedPeriodsAreNot) {
  auto ticks = quietTicks(1000);
  ticks[600].elapsed_periods = 11;  // the loop was late and skipped ten periods
  ticks.erase(ticks.begin() + 590, ticks.begin() + 600);
  ticks.erase(ticks.begin() + 300, ticks.begin() + 325);  // missing ticks, as if the disk was full
  const Folder folder;
  const auto reader = recorded(folder, ticks);
  const auto gaps = seriesOf(*reader, 0.0, 1.0, 10).header["gaps"];
  ASSERT_EQ(gaps.size(), 1U);
  EXPECT_NEAR(gaps[0]["from_s"].get<double>(), 0.300, 1e-9);
  EXPECT_NEAR(gaps[0]["to_s"].get<double>(), 0.325, 1e-9);
  EXPECT_EQ(gaps[0]["ticks"], 25);
  EXPECT_EQ(reader->outline().missing, 25U);
  // A gap that ends exactly where a section begins is reported once, in the section before it.
  EXPECT_EQ(seriesOf(*reader, 0.0, 0.325, 10).header["gaps"].size(), 0U);
  EXPECT_EQ(seriesOf(*reader, 0.325, 1.0, 10).header["gaps"].size(), 1U);
}

TEST(RecordingSeries, EventsAndMarksAtSectionBorders_AreReportedOnce) {
  auto ticks = quietTicks(1000);
  ticks[123].exercise.event_count = 2;
  ticks[123].exercise.events[0] = {1, 3, 2.5};
  ticks[123].exercise.events[1] = {0, -1, 0.0};
  for (std::size_t i = 700; i < 1000; ++i) ticks[i].faults |= Fault::kStopRequested;
  for (std::size_t i = 800; i < 1000; ++i) ticks[i].faults |= Fault::kEmergencyStop;
  ticks[500].faults |= Fault::kHolderSilent;
  for (std::size_t i = 900; i < 1000; ++i) ticks[i].authority = 0.0;
  const Folder folder;
  const auto reader = recorded(folder, ticks);
  nlohmann::json events = nlohmann::json::array(), marks = nlohmann::json::array();
  for (int i = 0; i < 10; ++i) {
    const Series piece = seriesOf(*reader, 0.1 * i, 0.1 * (i + 1), 7);
    for (const auto& event : piece.header["events"]) events.push_back(event);
    for (const auto& mark : piece.header["marks"]) marks.push_back(mark);
  }
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0]["time_s"], 0.123);
  EXPECT_EQ(events[0]["type"], 1);
  EXPECT_EQ(events[0]["index"], 3);
  EXPECT_EQ(events[0]["value"], 2.5);
  std::vector<std::pair<std::string, double>> reported;
  for (const auto& mark : marks) reported.emplace_back(mark["kind"], mark["time_s"]);
  const std::vector<std::pair<std::string, double>> expected = {{"armed", 0.0},
                                                                {"controls_lost", 0.5},
                                                                {"stop", 700 * kSeriesPeriod_s},
                                                                {"emergency_stop", 0.8},
                                                                {"neutral", 0.9}};
  EXPECT_EQ(reported, expected);
}

TEST(RecordingSeries, SectionWithoutTicks_IsEmptyWithoutAFault) {
  const Folder folder;
  const auto reader = recorded(folder, quietTicks(10));
  for (const auto& [from_s, to_s] : {std::pair{5.0, 6.0}, {-2.0, -1.0}, {0.0091, 0.0099}}) {
    const Series series = seriesOf(*reader, from_s, to_s, 3);
    for (const float value : series.values) EXPECT_TRUE(std::isnan(value));
    EXPECT_FALSE(series.header["truncated"]);
  }
}

// Regression test from an audit: a time that was not a number made the plots write out of bounds.
TEST(RecordingSeries, TickWithANonFiniteTime_IsTheOnlyUnreadableOne) {
  const Folder folder;
  for (const double time_s :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    std::vector<TickRecord> ticks = quietTicks(20);
    ticks[7].time_s = time_s;
    ticks[9].contacts_dropped = std::numeric_limits<std::int32_t>::max();
    const auto reader = recorded(folder, ticks);
    TickRecord record;
    for (std::uint64_t i = 0; i < reader->size(); ++i) {
      EXPECT_EQ(reader->read(i, record), i != 7 && i != 9) << i;
    }
    const Series series = seriesOf(*reader, -kSeriesPeriod_s / 2, 19.5 * kSeriesPeriod_s, 20);
    const std::size_t q_m = series.channel("q_m");
    for (std::size_t c = 0; c < 20; ++c) {
      EXPECT_EQ(std::isnan(series.low(q_m, c)), c == 7 || c == 9) << c;
    }
    EXPECT_EQ(series.header["unreadable"].size(), 2U);
    EXPECT_TRUE(series.header["truncated"]);
  }
}

// Neighbouring ticks beyond 2^53 have equal times, so a section between them has no length.
TEST(RecordingReport, TicksNumberedBeyondDoublePrecision_AreReported) {
  const Folder folder;
  std::vector<TickRecord> ticks = quietTicks(2);
  for (TickRecord& tick : ticks) {
    tick.tick += std::uint64_t{1} << 60U;
    tick.time_s = static_cast<double>(tick.tick) * kSeriesPeriod_s;
  }
  recorded(folder, ticks);
  const auto data = reportData(folder.file("run.h5"), "");
  ASSERT_TRUE(data) << format(data.errors());
  EXPECT_EQ((*data)["about"]["ticks"], 2);
}

TEST(RecordingSeries, FloodOfEvents_IsCutAndMarkedAsTruncated) {
  auto ticks = quietTicks(4000);
  for (TickRecord& r : ticks) r.exercise.event_count = kMaxExerciseEvents;
  const Folder folder;
  const auto reader = recorded(folder, ticks);
  const Series series = seriesOf(*reader, 0.0, 60.0, 10);
  EXPECT_EQ(series.header["events"].size(), 20'000U);
  EXPECT_TRUE(series.header["truncated"]);
}

}  // namespace
}  // namespace wholehand::test
