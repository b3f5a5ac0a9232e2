// The judge of measured efforts: alone, and with honest drives, which it must never stop.
#include "devices/plugin/effort_judge.hpp"

#include "loop/renderer/safety_tools.hpp"
#include "support/rig_tools.hpp"
#include "support/seed.hpp"
#include "support/shipped.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

namespace wholehand::test {
namespace {

TEST(RecentLeast, OfRandomSteps_IsThatOfTheWindowAndNeverLarger) {
  auto random = seededRandom(5801);
  for (int i = 0; i < cases(100); ++i) {
    RecentLeast least;
    std::vector<std::pair<double, std::int64_t>> held;
    // Windows within the capacity are exact; longer ones may only find a smaller value.
    const int window = i % 2 == 0 ? 1 + static_cast<int>(random() % 40) : 300;
    const double drift = uniform(random, -1.0, 1.0);  // rises for ever: nothing can be forgotten
    double value = 0.0, smallest = 0.0;
    for (int t = 1; t < 1000; ++t) {
      least.add(value, t);
      held.emplace_back(value, t);
      value += drift + uniform(random, -1.0, 1.0);
      smallest = std::min(smallest, value);
      if (random() % 3 == 0) continue;  // no sample
      double expected = value;
      for (auto at = held.rbegin(); at != held.rend() && at->second >= t - window; ++at) {
        expected = std::min(expected, at->first);
      }
      const double found = least.since(t - window, value);
      if (window < RecentLeast::kCapacity) {
        ASSERT_EQ(found, expected) << t;
      } else {
        ASSERT_LE(found, expected) << t;
        ASSERT_GE(found, smallest) << t;
      }
    }
  }
}

TEST(EffortJudge, UnknownEffort_IsNeverAstrayAndInfinityIs) {
  EffortJudge judge;
  judge.begin(0.0, 0.0, 0, {1.0, 0.25});
  for (int k = 1; k < 10; ++k) ASSERT_FALSE(judge.isAstray(std::nan(""), k, false));
  (void)judge.isAstray(std::numeric_limits<double>::infinity(), 10, true);
  (void)judge.isAstray(-std::numeric_limits<double>::infinity(), 11, true);
  EXPECT_TRUE(judge.isAstray(std::numeric_limits<double>::infinity(), 12, true));
}

// A step from 0 to 4: until the window has passed, everything between is due, then only 4.
TEST(EffortJudge, Step_MayArriveWithinTheWindowOnly) {
  EffortJudge judge;
  judge.begin(0.0, 0.0, 0, {0.5, 0.25});
  judge.send(4.0, 100);
  EXPECT_TRUE(judge.allows(-0.5, 100, false));
  EXPECT_FALSE(judge.allows(-0.6, 100, false));
  EXPECT_TRUE(judge.allows(5.5, 100, false));
  EXPECT_FALSE(judge.allows(5.6, 100, false));
  EXPECT_FALSE(judge.allows(2.4, 101, false));
  EXPECT_TRUE(judge.allows(2.5, 101, false));
  EXPECT_TRUE(judge.allows(0.0, 101, true)) << "less is allowed";
}

/// Efforts sent to an axis, one a tick.
struct SentEfforts {
  double period_s, limit;
  std::vector<double> efforts;
};

/// A person of a shipped patient file moves a device about, fast and at random, against bodies.
void addPatient(const std::string& patient, std::mt19937_64& random,
                std::vector<SentEfforts>& streams) {
  constexpr int kTicks = 2500;
  Models models = load(shippedFiles("lambda-pride", "four-shapes", "adult-median-right", patient));
  const std::vector<DeviceAxis> axes = models.device.axes;
  const AxisPosition start = clear(models.device);
  const Intention moves = slamming(models.device, random, start);
  const auto rig = orThrow(buildRig(std::move(models), moves, {}));
  orThrow(rig->renderer->arm());
  const std::size_t first = streams.size();
  for (const DeviceAxis& axis : axes) streams.push_back({1e-3, axis.effort_limit, {}});
  double most = 0.0;
  runTicks(*rig->renderer, kTicks, [&](const TickRecord& r) {
    for (int a = 0; a < r.sent.size(); ++a) {
      SentEfforts& of = streams[first + static_cast<std::size_t>(a)];
      of.efforts.push_back(r.sent[a]);
      most = std::max(most, std::abs(r.sent[a]) / of.limit);
    }
  });
  std::printf("%s: efforts up to %.2f of the limit\n", patient.c_str(), most);
}

/// As fast as the slew limit allows: steps, buzzing up to half the rate, and knocks between rests.
void addFastest(double period_s, std::mt19937_64& random, std::vector<SentEfforts>& streams) {
  SentEfforts out{period_s, 8.0, {}};
  const double most_change = 250.0 * out.limit * period_s;
  double aim = 0.0, now = 0.0;
  for (int part = 0; part < 100; ++part) {
    const int kind = static_cast<int>(random() % 3);
    const int half_turn = 1 + static_cast<int>(random() % 20);
    const double size = uniform(random, 0.0, out.limit);
    for (int k = 0; k < 200; ++k) {
      if (kind == 0 && random() % 30 == 0) aim = uniform(random, -out.limit, out.limit);
      if (kind == 1) aim = k / half_turn % 2 == 0 ? size : -size;
      if (kind == 2) aim = k % 50 < 3 ? size : 0.0;
      now += std::clamp(aim - now, -most_change, most_change);
      out.efforts.push_back(now);
    }
  }
  streams.push_back(std::move(out));
}

/// A drive within its statement, and a sensor: delay, lag, gain, offset, noise, a bad sample now
/// and then, samples slower than the loop, heat.
class HonestDrive {
 public:
  HonestDrive(const SentEfforts& stream, std::mt19937_64& random)
      : stream_(stream),
        random_(random),
        delay_(static_cast<int>(random() % 2)),
        every_(1 + static_cast<int>(random() % 4)),
        gain_(uniform(random, 0.9, 1.1)),
        offset_(stream.limit * uniform(random, -0.02, 0.02)),
        noise_(stream.limit * uniform(random, 0.0, 0.02)) {
    const double lag_s = random() % 4 == 0 ? 0.002 : uniform(random, 1e-6, 0.002);
    follows_ = 1.0 - std::exp(-stream.period_s / lag_s);
  }

  /// Judges one pass over the efforts. @return the number of samples
  int judge(int& stopped, int& apart) {
    const double limit = stream_.limit;
    const auto at_ns = [&](int k) {
      return std::int64_t{1'000'000'000} + std::llround(1e9 * stream_.period_s * k);
    };
    const auto window_ns = static_cast<std::int64_t>(1e9 * (2.0 * stream_.period_s + 5.0 * 0.002));
    constexpr double kUnsettled = 0.0067379;  // e^-5
    EffortJudge judge;
    judge.begin(0.0, stream_.efforts.front(), at_ns(0), {(0.1 + 2.0 * kUnsettled) * limit, 0.25});
    std::int64_t derated_ns = 0;
    double y = gain_ * stream_.efforts.front();
    int samples = 0;
    double before = stream_.efforts.front();
    for (int k = 1; k < static_cast<int>(stream_.efforts.size()); ++k) {
      const double sent = stream_.efforts[static_cast<std::size_t>(k)];
      const std::uint64_t bits = random_();
      if (bits % 8192 == 0) heat_ = heat_ < 1.0 ? 1.0 : uniform(random_, 0.0, 1.0);
      // u acts `delay_` ticks after it was sent, here over the period before the sample at k.
      const int acts = std::max(k - 1 - delay_, 0);
      y += follows_ * (heat_ * gain_ * stream_.efforts[static_cast<std::size_t>(acts)] - y);
      if (k % every_ == 0) {
        // A binomial number of 64 draws: a standard deviation of 4, tails to 8 of them.
        double measured = y + offset_ + noise_ * 0.25 * (std::popcount(random_()) - 32);
        if (bits % 100'003 == 0) measured = uniform(random_, -limit, limit);
        if (heat_ < 1.0) derated_ns = at_ns(k);
        const std::int64_t since_ns = at_ns(k) - window_ns;
        stopped += judge.isAstray(measured, since_ns, derated_ns >= since_ns) ? 1 : 0;
        apart += std::abs(measured - before) > 0.1 * limit + 0.25 * std::abs(before) ? 1 : 0;
        ++samples;
      }
      judge.send(sent, at_ns(k));
      before = sent;
    }
    return samples;
  }

 private:
  const SentEfforts& stream_;
  std::mt19937_64& random_;
  int delay_, every_;
  double gain_, offset_, noise_, follows_ = 1.0, heat_ = 1.0;
};

// People switch off a supervisor that stops without reason. WHOLEHAND_FULL judges 10^9 samples.
TEST(EffortJudge, HonestDrivesWithEveryPatient_AreNeverStopped) {
  auto random = seededRandom(5802);
  std::vector<SentEfforts> streams;
  for (const std::string& patient : shipped("patients")) addPatient(patient, random, streams);
  for (const double period_s : {1e-3, 0.5e-3, 0.25e-3, 0.125e-3}) {
    for (int i = 0; i < 10; ++i) addFastest(period_s, random, streams);
  }
  const double most = fullCounts() ? 1e9 : kReducedCounts ? 1e5 : 1e6;
  double judged = 0.0, apart = 0.0;
  while (judged < most) {
    HonestDrive drive(streams[random() % streams.size()], random);
    int stopped = 0, differs = 0;
    judged += drive.judge(stopped, differs);
    apart += differs;
    ASSERT_EQ(stopped, 0) << "after " << judged << " samples";
  }
  figure("samples of honest drives judged", judged, "");
  figure("of these beyond the tolerance of the last effort sent", apart, "");
  EXPECT_GT(apart, 1e-3 * judged) << "delay and lag must matter";
}

}  // namespace
}  // namespace wholehand::test
