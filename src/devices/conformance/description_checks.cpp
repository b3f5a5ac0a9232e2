// Checks of the driver's description of its axes. The plausibility limits find wrong units, not
// wrong devices.
#include "devices/conformance/conformance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <set>

namespace wholehand {
namespace {

constexpr double kMostTravel_m = 3.0, kMostTravel_rad = 20.0;  // 3 m; about three turns
constexpr double kLeastTravel_m = 1e-3, kLeastTravel_rad = 0.02;
constexpr double kMostEffort_n = 500.0, kMostEffort_nm = 200.0;
constexpr double kLeastEffort_n = 0.01, kLeastEffort_nm = 1e-4;
constexpr double kFinest = 1e-9;
constexpr double kStepsOfTravel = 100.0;
constexpr double kLongestDelay_s = 0.02;
constexpr double kLongestSilence_s = 0.2;

bool turns(const wh_axis& axis) {
  return axis.kind == WH_ROTATION;
}

// Fails with the first axis for which `wrong` returns a text.
template <class Violation>
CheckFinding eachAxis(DriverBench& bench, Violation violation) {
  if (bench.axes().empty()) return skipped("has no axes");
  for (const wh_axis& axis : bench.axes()) {
    const std::string text = violation(axis);
    if (!text.empty()) return failed(std::string(axis.name) + ": " + text);
  }
  return passed();
}

template <std::string (*Violation)(const wh_axis&)>
CheckFinding eachAxis(DriverBench& bench) {
  return eachAxis(bench, Violation);
}

std::string outside(double value, double least, double most, const char* unit) {
  if (value >= least && value <= most) return {};
  return number(value) + " " + unit + " is not from " + number(least) + " to " + number(most);
}

// Result of a call of describe().
struct DescribeResult {
  int result = WH_FAILED;
  std::uint32_t count = 0;
  std::array<wh_axis, WH_MAX_AXES> axes{};
};
DescribeResult describeAgain(DriverBench& bench) {
  DescribeResult out;
  for (wh_axis& axis : out.axes) axis.size = sizeof(wh_axis);
  out.result = bench.plugin().describe(bench.device(), out.axes.data(), WH_MAX_AXES, &out.count);
  return out;
}

CheckFinding count(DriverBench& bench) {
  const DescribeResult now = describeAgain(bench);
  if (now.result < 0) return failed("describe fails");
  if (now.count >= 1 && now.count <= WH_MAX_AXES) return passed(std::to_string(now.count));
  return failed("has " + std::to_string(now.count) + " axes; 1 to 16 can be rendered to");
}

CheckFinding stable(DriverBench& bench) {
  const DescribeResult first = describeAgain(bench), second = describeAgain(bench);
  const auto equal = [](const wh_axis& a, const wh_axis& b) {
    return std::strncmp(a.name, b.name, sizeof(a.name)) == 0 && a.kind == b.kind &&
           a.effort_meaning == b.effort_meaning && a.lower == b.lower && a.upper == b.upper &&
           a.effort_limit == b.effort_limit && a.resolution == b.resolution &&
           a.delay_s == b.delay_s && a.silence_s == b.silence_s;
  };
  const bool same =
      first.count == second.count && first.count <= WH_MAX_AXES &&
      std::equal(first.axes.begin(), first.axes.begin() + first.count, second.axes.begin(), equal);
  return same ? passed() : failed("a second describe says something else");
}

CheckFinding namesEnd(DriverBench& bench) {
  const DescribeResult now = describeAgain(bench);
  for (std::uint32_t i = 0; i < std::min<std::uint32_t>(now.count, WH_MAX_AXES); ++i) {
    const char(&name)[32] = now.axes.at(i).name;
    if (::strnlen(name, sizeof(name)) == sizeof(name)) {
      return failed("the name of axis " + std::to_string(i) + " does not end with 0");
    }
  }
  return passed();
}

std::string names(const wh_axis& axis) {
  const std::string name = axis.name;
  if (name.empty()) return "has no name";
  const bool plain =
      name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string::npos;
  return plain ? "" : "is no name of a device file: a to z, 0 to 9 and _";
}

CheckFinding namesUnique(DriverBench& bench) {
  std::set<std::string> seen;
  return eachAxis(bench, [&](const wh_axis& axis) {
    return seen.insert(axis.name).second ? std::string() : "is there twice";
  });
}

std::string kinds(const wh_axis& axis) {
  return axis.kind == WH_TRANSLATION || axis.kind == WH_ROTATION
             ? std::string()
             : "its kind is " + std::to_string(axis.kind);
}

std::string kindsOfNames(const wh_axis& axis) {
  const std::string name = axis.name;
  if ((name == "x" || name == "y" || name == "z") && turns(axis)) return "is a translation";
  if ((name == "roll" || name == "pitch" || name == "yaw") && !turns(axis)) return "is a rotation";
  return {};
}

std::string meanings(const wh_axis& axis) {
  return axis.effort_meaning <= WH_VIBRATION
             ? std::string()
             : "its effort is of kind " + std::to_string(axis.effort_meaning);
}

CheckFinding rendered(DriverBench& bench) {
  const auto& axes = bench.axes();
  return std::any_of(axes.begin(), axes.end(),
                     [](const wh_axis& axis) { return axis.effort_meaning == WH_EFFORT; })
             ? passed()
             : failed("no axis takes an effort");
}

std::string travelFinite(const wh_axis& axis) {
  return std::isfinite(axis.lower) && std::isfinite(axis.upper) ? "" : "its travel is not finite";
}

std::string travelOrdered(const wh_axis& axis) {
  return axis.lower < axis.upper
             ? std::string()
             : "from " + number(axis.lower) + " to " + number(axis.upper) + " there is no travel";
}

std::string travelPlausible(const wh_axis& axis) {
  const double travel = axis.upper - axis.lower;
  return turns(axis) ? outside(travel, kLeastTravel_rad, kMostTravel_rad, "rad of travel")
                     : outside(travel, kLeastTravel_m, kMostTravel_m, "m of travel");
}

std::string effortFinite(const wh_axis& axis) {
  return std::isfinite(axis.effort_limit) && axis.effort_limit > 0.0
             ? std::string()
             : "its effort limit is " + number(axis.effort_limit);
}

std::string effortPlausible(const wh_axis& axis) {
  return turns(axis) ? outside(axis.effort_limit, kLeastEffort_nm, kMostEffort_nm, "N·m")
                     : outside(axis.effort_limit, kLeastEffort_n, kMostEffort_n, "N");
}

std::string resolutionFinite(const wh_axis& axis) {
  return std::isfinite(axis.resolution) && axis.resolution > 0.0
             ? std::string()
             : "its resolution is " + number(axis.resolution);
}

std::string resolutionPlausible(const wh_axis& axis) {
  return outside(axis.resolution, kFinest, (axis.upper - axis.lower) / kStepsOfTravel,
                 turns(axis) ? "rad a step" : "m a step");
}

std::string delayFinite(const wh_axis& axis) {
  return std::isfinite(axis.delay_s) && axis.delay_s >= 0.0
             ? std::string()
             : "its delay is " + number(axis.delay_s) + " s";
}

std::string delayPlausible(const wh_axis& axis) {
  return outside(axis.delay_s, 0.0, kLongestDelay_s, "s of delay");
}

std::string silenceFinite(const wh_axis& axis) {
  return std::isfinite(axis.silence_s) && axis.silence_s >= 0.0
             ? std::string()
             : "its silence is " + number(axis.silence_s) + " s";
}

std::string watchdogStated(const wh_axis& axis) {
  return axis.effort_meaning != WH_EFFORT || axis.silence_s > 0.0
             ? std::string()
             : "has no watchdog: its last effort would stay when the program dies";
}

std::string silencePlausible(const wh_axis& axis) {
  return outside(axis.silence_s, 0.0, kLongestSilence_s, "s of silence");
}

constexpr const char* kFill = "fill every field of every axis";
constexpr const char* kUnits = "use m, N, s, rad and N·m";

}  // namespace

std::span<const Check> descriptionChecks() {
  static constexpr Check kChecks[] = {
      {"description.count", "has 1 to 16 axes", "offer fewer", count},
      {"description.stable", "describes the same axes every time",
       "find out once, when the device is opened", stable},
      {"description.names_end", "names end with 0 within 32 bytes", "shorten the name", namesEnd},
      {"description.names", "names can stand in a device file", "use a to z, 0 to 9 and _",
       eachAxis<names>},
      {"description.names_unique", "no name is there twice", "give every axis a name of its own",
       namesUnique},
      {"description.kinds", "each axis is a translation or a rotation",
       "set WH_TRANSLATION or WH_ROTATION", eachAxis<kinds>},
      {"description.kinds_of_names", "x, y, z translate; roll, pitch, yaw rotate",
       "name the axis after what it does", eachAxis<kindsOfNames>},
      {"description.meanings", "what an effort is to each axis is known", "set effort_meaning",
       eachAxis<meanings>},
      {"description.rendered", "at least one axis takes an effort",
       "a device without effort axes cannot be rendered to", rendered},
      {"description.travel_finite", "travel is finite", kFill, eachAxis<travelFinite>},
      {"description.travel_ordered", "the lower end of travel is below the upper", "exchange them",
       eachAxis<travelOrdered>},
      {"description.travel_plausible", "travel is 1 mm to 3 m, or 0.02 to 20 rad", kUnits,
       eachAxis<travelPlausible>},
      {"description.effort_finite", "the effort limit is above 0", kFill, eachAxis<effortFinite>},
      {"description.effort_plausible", "the effort limit is 0.01 to 500 N, or 0.0001 to 200 N·m",
       kUnits, eachAxis<effortPlausible>},
      {"description.resolution_finite", "the resolution is above 0", kFill,
       eachAxis<resolutionFinite>},
      {"description.resolution_plausible", "the travel has at least 100 steps of resolution",
       kUnits, eachAxis<resolutionPlausible>},
      {"description.delay_finite", "the delay is 0 or more", kFill, eachAxis<delayFinite>},
      {"description.delay_plausible", "the delay is at most 20 ms", kUnits,
       eachAxis<delayPlausible>},
      {"description.silence_finite", "the silence is 0 or more", kFill, eachAxis<silenceFinite>},
      {"description.watchdog", "each axis with effort has a watchdog",
       "switch the drive's watchdog on and state its time", eachAxis<watchdogStated>},
      {"description.silence_plausible", "the watchdog acts within 0.2 s",
       "keep the factory's setting; 20 ms is usual", eachAxis<silencePlausible>},
  };
  return kChecks;
}

}  // namespace wholehand
