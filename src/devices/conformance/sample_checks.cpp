// Checks of samples without commands, 1,000 per second for 0.25 s. A person may move the device.
#include "devices/conformance/conformance.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace wholehand {
namespace {

constexpr std::uint32_t kStatus =
    WH_ENABLED | WH_HOMED | WH_SATURATED | WH_DRIVE_FAULT | WH_HOT | WH_DERATING | WH_SILENCED;
constexpr std::int64_t kStill_ns = 20'000'000;  // default of watch.longest_gap_s
constexpr double kAge_s = 0.003;  // two periods of the loop and its cycle, in addition to the delay
constexpr double kClockRate = 0.01;
constexpr std::int64_t kAhead_ns = 1'000'000;
constexpr std::int64_t kOtherClock_ns = 1'000'000'000;
constexpr double kMargin = 0.02;  // share of the travel; default of a device file
constexpr double kMostEffort = 2.0;
constexpr double kColdest_c = -40.0, kHottest_c = 200.0;
constexpr std::size_t kEnoughSteps = 20;

// Fails with the first sample for which `wrong` returns a text.
template <class Violation>
CheckFinding eachSample(DriverBench& bench, Violation violation) {
  const auto& samples = bench.samples();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (samples[i].result < 0) continue;
    const std::string text = violation(samples[i].sample);
    if (!text.empty()) return failed("sample " + std::to_string(i) + ": " + text);
  }
  return passed();
}

// Fails with the first pair of successive samples for which `wrong` returns a text.
template <class Violation>
CheckFinding eachPair(DriverBench& bench, Violation violation) {
  const auto& samples = bench.samples();
  for (std::size_t i = 1; i < samples.size(); ++i) {
    if (samples[i].result < 0 || samples[i - 1].result < 0) continue;
    const std::string text = violation(samples[i - 1], samples[i]);
    if (!text.empty()) return failed("sample " + std::to_string(i) + ": " + text);
  }
  return passed();
}

template <std::string (*Violation)(const SampleRead&, const SampleRead&)>
CheckFinding eachPair(DriverBench& bench) {
  return eachPair(bench, Violation);
}

template <class Violation>
CheckFinding eachAxis(DriverBench& bench, Violation violation) {
  return eachSample(bench, [&](const wh_sample& sample) -> std::string {
    for (std::size_t a = 0; a < bench.axes().size(); ++a) {
      const std::string text = violation(sample, a);
      if (!text.empty()) return std::string(bench.axes()[a].name) + " " + text;
    }
    return {};
  });
}

template <std::string (*Violation)(const wh_sample&, std::size_t)>
CheckFinding eachAxis(DriverBench& bench) {
  return eachAxis(bench, Violation);
}

CheckFinding succeed(DriverBench& bench) {
  const auto& samples = bench.samples();
  const auto lost = std::count_if(samples.begin(), samples.end(),
                                  [](const SampleRead& s) { return s.result < 0; });
  if (lost == 0) return passed(std::to_string(samples.size()) + " samples");
  return failed(std::to_string(lost) + " of " + std::to_string(samples.size()) + " reads fail");
}

CheckFinding results(DriverBench& bench) {
  for (const SampleRead& s : bench.samples()) {
    if (s.result < 0 || s.result == WH_OK || s.result == WH_NOTHING_NEW) continue;
    return failed("read returns " + std::to_string(s.result));
  }
  return passed();
}

CheckFinding status(DriverBench& bench) {
  return eachSample(bench, [](const wh_sample& s) {
    return (s.status & ~kStatus) == 0 ? std::string() : "status has unknown bits";
  });
}

std::string sequence(const SampleRead& before, const SampleRead& now) {
  return now.sample.sequence >= before.sample.sequence ? std::string() : "sequence runs backwards";
}

CheckFinding movesOn(DriverBench& bench) {
  const auto& samples = bench.samples();
  std::int64_t since_ns = samples.front().read_ns;
  int still = 0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    if (samples[i].sample.sequence != samples[i - 1].sample.sequence) {
      since_ns = samples[i].read_ns;
      still = 0;
    } else if (++still > 15 && samples[i].read_ns - since_ns > kStill_ns) {
      return failed("no new sample for 20 ms: the loop would stop for a stale sample");
    }
  }
  return passed();
}

std::string newIsNew(const SampleRead& before, const SampleRead& now) {
  if (now.result == WH_OK && now.sample.sequence == before.sample.sequence) {
    return std::string("is said to be new and has the sequence of the last one");
  }
  if (now.result == WH_NOTHING_NEW && now.sample.sequence != before.sample.sequence) {
    return std::string("is said to be nothing new and has another sequence");
  }
  return std::string();
}

CheckFinding filledWithLast(DriverBench& bench) {
  bool any = false;
  CheckFinding found = eachPair(bench, [&](const SampleRead& before, const SampleRead& now) {
    if (now.result != WH_NOTHING_NEW) return std::string();
    any = true;
    const std::size_t axes = bench.axes().size();
    const bool same =
        now.sample.valid == before.sample.valid &&
        now.sample.monotonic_ns == before.sample.monotonic_ns &&
        std::equal(now.sample.position, now.sample.position + axes, before.sample.position);
    return same ? std::string() : "nothing is new, but it is not filled with the last sample";
  });
  if (!any && found.outcome == Outcome::kPassed) return skipped("every sample was a new one");
  return found;
}

std::string clockForwards(const SampleRead& before, const SampleRead& now) {
  return now.sample.monotonic_ns >= before.sample.monotonic_ns ? std::string()
                                                               : "monotonic_ns runs backwards";
}

CheckFinding clockIsMonotonic(DriverBench& bench) {
  for (const SampleRead& s : bench.samples()) {
    if (s.result < 0) continue;
    const std::int64_t age_ns = s.read_ns - s.sample.monotonic_ns;
    if (age_ns < -kAhead_ns) return failed("a sample is of the future");
    if (age_ns > kOtherClock_ns) {
      return failed("a sample is " + number(static_cast<double>(age_ns) * 1e-9) +
                    " s old: is that CLOCK_MONOTONIC?");
    }
  }
  return passed();
}

// Checks the age of the youngest quarter of the samples: a late machine makes some samples older.
CheckFinding age(DriverBench& bench) {
  double delay_s = 0.0;
  for (const wh_axis& axis : bench.axes()) delay_s = std::max(delay_s, axis.delay_s);
  std::vector<std::int64_t> ages;
  for (const SampleRead& s : bench.samples()) ages.push_back(s.read_ns - s.sample.monotonic_ns);
  const auto young = ages.begin() + static_cast<long>(ages.size() / 4);
  std::nth_element(ages.begin(), young, ages.end());
  const double age_s = static_cast<double>(*young) * 1e-9;
  const std::string text = number(1e3 * age_s) + " ms";
  return age_s <= delay_s + kAge_s ? passed(text) : failed("samples are " + text + " old");
}

CheckFinding clockRate(DriverBench& bench) {
  const auto& samples = bench.samples();
  const SampleRead &first = samples.front(), &last = samples.back();
  const auto read_s = static_cast<double>(last.read_ns - first.read_ns) * 1e-9;
  const auto stated_s =
      static_cast<double>(last.sample.monotonic_ns - first.sample.monotonic_ns) * 1e-9;
  if (std::abs(stated_s - read_s) <= kClockRate * read_s + kAge_s) return passed();
  return failed("in " + number(read_s) + " s their times go on by " + number(stated_s) + " s");
}

CheckFinding validDescribed(DriverBench& bench) {
  const std::uint32_t known = (1U << bench.axes().size()) - 1U;
  return eachSample(bench, [known](const wh_sample& s) {
    return (s.valid & ~known) == 0 ? std::string() : "valid has bits of axes that are not there";
  });
}

std::string validComplete(const wh_sample& s, std::size_t a) {
  return (s.valid >> a & 1U) != 0 ? std::string() : "is not measured";
}

std::string positionFinite(const wh_sample& s, std::size_t a) {
  const bool measured = (s.valid >> a & 1U) != 0;
  return !measured || std::isfinite(s.position[a]) ? std::string() : "is valid and not finite";
}

CheckFinding positionInTravel(DriverBench& bench) {
  return eachAxis(bench, [&](const wh_sample& s, std::size_t a) -> std::string {
    if ((s.status & WH_HOMED) == 0 || !std::isfinite(s.position[a])) return {};
    const wh_axis& axis = bench.axes()[a];
    const double margin = kMargin * (axis.upper - axis.lower);
    if (s.position[a] >= axis.lower - margin && s.position[a] <= axis.upper + margin) return {};
    return "stands at " + number(s.position[a]) + ", its travel is " + number(axis.lower) + " to " +
           number(axis.upper);
  });
}

// Finds an encoder step coarser than stated: all position steps are then multiples of a larger
// step.
std::string coarse(const wh_axis& axis, const std::set<double>& places) {
  std::vector<double> steps;
  for (auto at = places.begin(), next = at; at != places.end() && ++next != places.end();
       at = next) {
    steps.push_back(*next - *at);
  }
  if (steps.size() < kEnoughSteps) return {};
  const double least = *std::min_element(steps.begin(), steps.end());
  if (least <= axis.resolution * 1.01) return {};
  const bool multiples = std::all_of(steps.begin(), steps.end(), [least](double step) {
    const double times = step / least;
    return std::abs(times - std::round(times)) < 0.01;
  });
  return multiples ? std::string(axis.name) + " moves in steps of " + number(least) + ", not of " +
                         number(axis.resolution)
                   : std::string();
}

CheckFinding quantised(DriverBench& bench) {
  bool moved = false;
  for (std::size_t a = 0; a < bench.axes().size(); ++a) {
    std::set<double> places;
    for (const SampleRead& s : bench.samples()) {
      if (s.result >= 0 && std::isfinite(s.sample.position[a])) places.insert(s.sample.position[a]);
    }
    if (std::string violation = coarse(bench.axes()[a], places); !violation.empty())
      return failed(violation);
    moved = moved || places.size() > kEnoughSteps;
  }
  return moved ? passed() : skipped("it stood still: move it by hand meanwhile");
}

CheckFinding effortKnown(DriverBench& bench) {
  return eachAxis(bench, [&](const wh_sample& s, std::size_t a) {
    const double effort = s.effort[a];
    const double most = kMostEffort * bench.axes()[a].effort_limit;
    return std::isnan(effort) || std::abs(effort) <= most ? std::string()
                                                          : "measures " + number(effort);
  });
}

std::string temperatureKnown(const wh_sample& s, std::size_t a) {
  const double t = s.temperature_c[a];
  return std::isnan(t) || (t >= kColdest_c && t <= kHottest_c) ? std::string()
                                                               : "is at " + number(t) + " °C";
}

constexpr const char* kSequence = "count samples, and never start anew while the device is open";
constexpr const char* kClock = "take clock_gettime(CLOCK_MONOTONIC) when the sample arrives";
constexpr const char* kNan = "NaN where the device does not know";

}  // namespace

std::span<const Check> sampleChecks() {
  static constexpr Check kChecks[] = {
      {"samples.succeed", "every read of a device at rest succeeds",
       "hand over the last sample where no new one has come", succeed},
      {"samples.results", "read returns WH_OK, WH_NOTHING_NEW or an error",
       "return one of the header's values", results},
      {"samples.status", "only known bits of status are set", "clear the structure first", status},
      {"samples.sequence", "sequence never runs backwards", kSequence, eachPair<sequence>},
      {"samples.moves_on", "a new sample comes within 20 ms", "look at the bus", movesOn},
      {"samples.new", "WH_OK and WH_NOTHING_NEW agree with the sequence", kSequence,
       eachPair<newIsNew>},
      {"samples.nothing_new", "WH_NOTHING_NEW comes with the last sample", "keep a copy of it",
       filledWithLast},
      {"samples.clock", "monotonic_ns never runs backwards", kClock, eachPair<clockForwards>},
      {"samples.clock_monotonic", "monotonic_ns is of CLOCK_MONOTONIC", kClock, clockIsMonotonic},
      {"samples.age", "samples are no older than the stated delay and 3 ms",
       "hand over the newest sample, not the next", age},
      {"samples.clock_rate", "monotonic_ns goes on as fast as the clock", kClock, clockRate},
      {"samples.valid_described", "valid names no axis that is not described",
       "set one bit per described axis", validDescribed},
      {"samples.valid", "every axis is measured in every sample",
       "the loop stops where one is missing: look at the encoder", eachAxis<validComplete>},
      {"samples.position_finite", "positions that are valid are finite",
       "clear the bit of valid where there is no position", eachAxis<positionFinite>},
      {"samples.travel", "a homed axis stands within its travel and 2 % of it",
       "home it anew, and state the travel it has", positionInTravel},
      {"samples.resolution", "positions move in steps no coarser than stated",
       "state the steps that it has, and certify again", quantised},
      {"samples.effort", "measured efforts are NaN or below twice the limit", kNan, effortKnown},
      {"samples.temperature", "temperatures are NaN or from -40 to 200 °C", kNan,
       eachAxis<temperatureKnown>},
  };
  return kChecks;
}

}  // namespace wholehand
