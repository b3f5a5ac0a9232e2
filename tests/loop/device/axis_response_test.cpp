// Checks the axis response that the conformance check finds by pushing, against axes with a known
// law.
#include "devices/conformance/pushes.hpp"
#include "support/figure.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace wholehand::test {
namespace {

struct DrawnAxis {
  double gain = 0.0, damping = 0.0, friction = 0.0, own = 0.0, delay_s = 0.0, resolution = 0.0;
};

/// Draws axes of the size of haptic devices and irregular sampling times.
class Draw {
 public:
  explicit Draw(unsigned stream) : random_(seededRandom(stream)) {}
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  DrawnAxis axis() {
    DrawnAxis out;
    out.gain = between(15.0, 60.0);
    out.damping = between(1.0, 20.0);
    out.friction = between(0.0, 0.02);
    out.own = between(-0.01, 0.01);
    out.delay_s = between(0.0, 0.03);
    out.resolution = between(2e-6, 2e-5);
    return out;
  }
  /// One sample per millisecond, some of them late, with about `stalls` stalls of 4 to 10 ms.
  std::vector<double> times(double until_s, int stalls) {
    std::vector<double> out;
    const double chance = stalls / (until_s * 1e3);
    for (double t = 0.0; t < until_s;) {
      out.push_back(t);
      t += between(0.0, 1.0) < chance ? between(0.004, 0.01) : between(0.0008, 0.0013);
    }
    return out;
  }

 private:
  std::mt19937_64 random_;
};

// Whole and half pushes in both directions, each written at the first sampling time after it is
// due.
std::vector<PushTrace::EffortChange> pushes(const std::vector<double>& times, double push_s) {
  const std::pair<double, double> kPushes[] = {{0.2, 1.0},  {-0.2, 1.0}, {-0.2, 1.0},
                                               {0.2, 1.0},  {0.1, 1.4},  {-0.1, 1.4},
                                               {-0.1, 1.4}, {0.1, 1.4},  {0.0, 100.0}};
  std::vector<PushTrace::EffortChange> out;
  double due_s = 0.01;
  for (const auto& [share, lasts] : kPushes) {
    for (const double t : times) {
      if (t < due_s) continue;
      out.push_back({t, share});
      break;
    }
    due_s += lasts * push_s;
  }
  return out;
}

// Integrates the law of AxisResponse in steps of 10 µs.
PushTrace traceOf(const DrawnAxis& axis, const std::vector<double>& times,
                  std::vector<PushTrace::EffortChange> given) {
  constexpr double kStep_s = 1e-5;
  PushTrace out;
  out.given = std::move(given);
  out.resolution = axis.resolution;
  double q = 0.013, v = 0.0, t = 0.0;
  for (const double at_s : times) {
    for (; t < at_s; t += kStep_s) {
      double share = axis.own;
      for (const auto& g : out.given) {
        if (g.at_s + axis.delay_s <= t) share = g.share + axis.own;
      }
      const double rubs = axis.friction * std::tanh(v / 1e-4);
      v += kStep_s * (axis.gain * (share - rubs) - axis.damping * v);
      q += kStep_s * v;
    }
    out.seen.push_back({at_s, axis.resolution * std::round(q / axis.resolution)});
  }
  return out;
}

// Duration of a push: at least as long as the check's, so that the axis moves by 30 encoder steps.
double pushOf(const DrawnAxis& axis, double drawn_s) {
  return std::max(drawn_s, std::sqrt(60.0 * axis.resolution / (0.2 * axis.gain)));
}

/// Largest deviations over a number of drawn axes.
struct Apart {
  double gain = 0.0, delay_s = 0.0, own = 0.0, unexplained = 0.0, halves = 0.0;
};
Apart apartFor(unsigned stream, int stalls) {
  Apart out;
  for (int i = 0; i < cases(20); ++i) {
    Draw draw(stream + static_cast<unsigned>(i));
    const DrawnAxis axis = draw.axis();
    const auto times = draw.times(0.5, stalls);
    const PushTrace trace =
        traceOf(axis, times, pushes(times, pushOf(axis, draw.between(0.015, 0.04))));
    const AxisResponse found = findResponse(trace, 0.08);
    out.gain = std::max(out.gain, std::abs(found.gain / axis.gain - 1.0));
    out.delay_s = std::max(out.delay_s, std::abs(found.delay_s - axis.delay_s));
    out.own = std::max(out.own, std::abs(found.own - axis.own));
    out.unexplained = std::max(out.unexplained, found.unexplained);
    const auto gains = gainsByKind(trace, found.delay_s, 2, [](double share) {
      return share == 0.0 ? -1 : std::abs(share) > 0.15 ? 0 : 1;
    });
    out.halves = std::max(out.halves, std::abs(gains[1] / gains[0] - 1.0));
    EXPECT_EQ(largestJump(trace), 0.0) << i;
  }
  return out;
}

// Allows what the checks allow, or less. The exception is the unexplained share: in a few of 10,000
// correct axes that creep under dry friction it is above the check's 11 %.
void expectWithinWhatTheChecksAllow(const Apart& apart, const std::string& of) {
  EXPECT_LE(apart.gain, tolerance(0.2));
  EXPECT_LE(apart.delay_s, tolerance(0.003));
  EXPECT_LE(apart.halves, tolerance(0.2));
  EXPECT_LE(apart.unexplained, tolerance(0.2));
  EXPECT_LE(apart.own, tolerance(0.015));
  figure("gain of " + of + ", apart at most", 100.0 * apart.gain, "%");
  figure("delay of " + of + ", apart at most", 1e3 * apart.delay_s, "ms");
  figure("gain of half pushes of " + of + ", apart at most", 100.0 * apart.halves, "%");
}

TEST(AxisResponse, DrawnAxes_AreIdentified) {
  expectWithinWhatTheChecksAllow(apartFor(1000, 0), "pushed axes");
}

// Three stalls of 4 to 10 ms in half a second; the checks do not judge a trace with longer ones.
TEST(AxisResponse, MachineThatStalls_DoesNotSpoilTheIdentification) {
  expectWithinWhatTheChecksAllow(apartFor(2000, 3), "pushed axes by a machine that stalls");
}

TEST(AxisResponse, PositionsThatStandStillAndJump_AreDetected) {
  for (int i = 0; i < cases(20); ++i) {
    Draw draw(3000 + static_cast<unsigned>(i));
    const DrawnAxis axis = draw.axis();
    const auto times = draw.times(0.5, 0);
    PushTrace trace = traceOf(axis, times, pushes(times, 0.03));
    // Holds the position for 10 samples where the axis moves fastest; the next sample jumps.
    std::size_t fast = 20;
    const auto moved = [&](std::size_t k) {
      return std::abs(trace.seen[k + 10].position - trace.seen[k].position);
    };
    for (std::size_t k = 20; k + 20 < trace.seen.size(); ++k) {
      if (moved(k) > moved(fast)) fast = k;
    }
    for (std::size_t k = 1; k < 10; ++k) trace.seen[fast + k].position = trace.seen[fast].position;
    EXPECT_GT(largestJump(trace), 3.0 * axis.resolution) << i;
  }
}

}  // namespace
}  // namespace wholehand::test
