#include "devices/commissioning/commissioning.hpp"

#include "devices/commissioning/bench.hpp"
#include "devices/commissioning/climb.hpp"
#include "devices/commissioning/identification/drive_lag.hpp"
#include "devices/commissioning/identification/identify_axis.hpp"
#include "devices/passport/passport.hpp"
#include "devices/passport/sealed_file.hpp"
#include "loop/core/printable.hpp"
#include "loop/core/sha256.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <utility>

namespace wholehand {
namespace {

constexpr std::array<const char*, kCommissioningSteps> kNames = {
    "identify",         "home",         "signs",
    "scale-and-travel", "gravity",      "mass-friction-delay",
    "known-weight",     "watchdog",     "emergency-stop",
    "range-stops",      "effort-limit", "passport"};
constexpr double kZeroWithin = 0.01;  // share of the range

// Measurements and tests of each step.

constexpr double kByHand = 0.05;  // share of the range that counts as moved by hand
constexpr double kOthers = 0.5;   // share of the motion of the pushed axis
constexpr double kScaleWithin = 0.05;
constexpr double kWrapped = 0.25;     // share of the range between two samples
constexpr double kStopWithin = 0.02;  // share of the range
constexpr double kWeightWithin = 0.1;
constexpr double kCross = 0.1;
constexpr int kMostDelay_ticks = 8;  // largest value of a device file

// The + direction in words for a person in front of the device.
std::string plus(const DeviceAxis& axis) {
  if (axis.name == "x") return "away from you";
  if (axis.name == "y") return "to your left";
  if (axis.name == "z") return "up";
  if (axis.group == AxisGroup::kHand) return "in its + direction (flexion: closing)";
  return "in its + direction (right-hand rule)";
}

std::vector<FoundFigure> measured(const DeviceAxis& axis, const PassportAxis& p) {
  const bool turns = axis.kind == AxisKind::kRotation;
  return {{axis.name, "mass", turns ? "kg·m²" : "kg", p.mass.lower, p.mass.upper},
          {axis.name, "damping", turns ? "N·m·s/rad" : "N·s/m", p.damping.lower, p.damping.upper},
          {axis.name, "dry-friction", axis.effortUnit(), p.coulomb.lower, p.coulomb.upper},
          {axis.name, "delay", "ms", 1e3 * p.delay_s.lower, 1e3 * p.delay_s.upper},
          {axis.name, "drive-lag", "ms", 1e3 * p.drive_lag_s.lower, 1e3 * p.drive_lag_s.upper}};
}

// Steps that test the watchdog and the emergency stop. Both act when this program cannot.

constexpr double kWatchdogSlack_s = 0.05;
constexpr double kPressWithin_s = 20.0;
constexpr int kProveTicks_ms = 80, kSettles_ms = 20;  // duration of the push after the stop, and
                                                      // its skipped beginning
constexpr int kSilentLooks = 20;  // ticks without a new sample that count as silence

// What the samples showed while the person was asked to press the emergency stop.
struct StopObservation {
  enum Kind { kNever, kEnabled, kCut, kWatchdog } what = kNever;
  std::uint64_t sequence = 0;
  int ticks = 0, still = 0;  // all ticks; consecutive ticks without a new sample
  int cut = 0;               // ticks since the stop cut the device off
};

StopObservation lookAtStop(StopObservation seen, int result, const wh_sample& sample) {
  const bool fresh = result >= 0 && (seen.sequence == 0 || sample.sequence > seen.sequence);
  ++seen.ticks;
  seen.still = fresh ? 0 : seen.still + 1;
  if (!fresh) return seen;
  seen.sequence = sample.sequence;
  const bool enabled = (sample.status & WH_ENABLED) != 0;
  const bool fault = (sample.status & WH_DRIVE_FAULT) != 0;
  if (seen.what == StopObservation::kEnabled && (!enabled || fault)) {
    // A drive whose watchdog was triggered may report disabled without an emergency stop.
    const bool silenced = (sample.status & WH_SILENCED) != 0;
    seen.what = silenced && !fault ? StopObservation::kWatchdog : StopObservation::kCut;
  }
  if (enabled && !fault) seen.what = StopObservation::kEnabled;
  return seen;
}

Question nextStep(const std::string& text) {
  return {QuestionKind::kNextStep, text, "", "", 0.0, 0.0};
}

// The step that the person chooses; empty: end.
std::optional<CommissioningStep> chooseNext(Commissioning& commissioning, Operator& person) {
  const CommissioningStep next = commissioning.next();
  for (;;) {
    const auto answer =
        person.ask(nextStep(fmt::format("Next: {}. Enter, the name of a step to repeat, or quit:",
                                        stepName(next))),
                   [] {});
    if (!answer || *answer == "quit") return std::nullopt;
    if (answer->empty()) return next;
    for (int i = 0; i < kCommissioningSteps; ++i) {
      const auto step = static_cast<CommissioningStep>(i);
      if (*answer == stepName(step)) return step;
    }
    person.reportLine(fmt::format("{} is no step.", printable(*answer)), {});
  }
}

}  // namespace

const char* stepName(CommissioningStep step) {
  return kNames.at(static_cast<std::size_t>(step));
}

Commissioning::Commissioning(Bench& bench, CommissioningPlan plan)
    : bench_(bench), plan_(std::move(plan)) {
  const DeviceModel& model = bench_.model();
  passport_.identity = bench_.driver().identity();
  passport_.driver = bench_.driver().name();
  passport_.device = model.name;
  passport_.operator_name = plan_.operator_name;
  passport_.rate_hz = 1.0 / bench_.period_s();
  for (const DeviceAxis& a : model.axes) {
    PassportAxis measured;
    measured.name = a.name;
    measured.kind = a.kind;
    passport_.axes.push_back(measured);
    offset_.push_back(a.neutral_effort);
  }
  path_ = passportPath(model.path, passport_.identity.serial);
}

Diagnostic Commissioning::no(std::size_t i, const std::string& problem,
                             const std::string& remedy) const {
  return {bench_.model().path, 0, "axes", axis(i).name, problem, remedy};
}

Expected<bool> Commissioning::askYes(const Question& question) {
  for (;;) {
    const auto answer = bench_.askWhile(question, [](const auto&) {});
    if (!answer) return answer.errors();
    if (*answer == "yes") return true;
    if (*answer == "no") return false;
    reportLine("Neither yes nor no.");
  }
}

Expected<double> Commissioning::askNumber(const Question& question, const Look& look) {
  for (;;) {
    const auto answer = bench_.askWhile(question, look);
    if (!answer) return answer.errors();
    char* end = nullptr;
    const double value = std::strtod(answer->c_str(), &end);
    const bool whole = end != answer->c_str() && *end == 0;
    if (whole && std::isfinite(value) && value > 0.0) return value;
    reportLine("That is no number above 0: digits only, without a unit.");
  }
}

bool Commissioning::done(CommissioningStep step) const {
  return done_.at(static_cast<std::size_t>(step));
}

CommissioningStep Commissioning::next() const {
  const auto missing = std::find(done_.begin(), done_.end(), false);
  const auto at = static_cast<int>(missing - done_.begin());
  return static_cast<CommissioningStep>(std::min(at, kCommissioningSteps - 1));
}

Expected<Done> Commissioning::carryOut(CommissioningStep step) {
  const auto at = static_cast<std::size_t>(step);
  for (std::size_t before = 0; before < at; ++before) {
    if (done_.at(before)) continue;
    const Diagnostic missing{"",
                             0,
                             "step",
                             kNames.at(at),
                             fmt::format("needs the step {} first", kNames.at(before)),
                             fmt::format("do {}", kNames.at(before))};
    return report(step, [&]() -> Expected<Done> { return missing; });
  }
  using Method = Expected<Done> (Commissioning::*)();
  static constexpr std::array<Method, kCommissioningSteps> kMethods = {
      &Commissioning::identify,      &Commissioning::home,
      &Commissioning::signs,         &Commissioning::scaleAndTravel,
      &Commissioning::gravity,       &Commissioning::massFrictionDelay,
      &Commissioning::knownWeight,   &Commissioning::watchdog,
      &Commissioning::emergencyStop, &Commissioning::rangeStops,
      &Commissioning::effortLimit,   &Commissioning::write};
  done_.back() = false;  // a new measurement makes the passport outdated
  Expected<Done> result = report(step, [&] { return (this->*kMethods.at(at))(); });
  done_.at(at) = result.ok();
  return result;
}

Expected<Done> Commissioning::report(CommissioningStep step,
                                     const std::function<Expected<Done>()>& do_it) {
  StepNews news{static_cast<int>(step), StepState::kUnderWay, {}};
  step_under_way_ = news.step;
  bench_.person().reportStep(news);
  Expected<Done> result = do_it();
  step_under_way_ = -1;
  news.state = result ? StepState::kDone : StepState::kFailed;
  if (!result) news.why = result.errors();
  bench_.person().reportStep(news);
  return result;
}

Expected<Done> Commissioning::identify() {
  if (passport_.identity.serial.empty()) {
    return keyFault(bench_.model().path, "serial", "",
                    "the driver says no serial number: a passport could not be matched to it",
                    "let the driver fill in wh_plugin.identify");
  }
  (void)bench_.driver().control(WH_IDENTIFY, 0.0);  // optional: the device also has a label
  const auto is_this =
      askYes({QuestionKind::kThisDevice,
              fmt::format("Is this the device with serial number {} (firmware {}, {})? yes or no",
                          passport_.identity.serial, passport_.identity.firmware, passport_.driver),
              "", "", 0.0, 0.0});
  if (!is_this) return is_this.errors();
  if (*is_this) return Done{};
  return keyFault("", "serial", passport_.identity.serial, "is not this device",
                  "name the device with --device-at");
}

Expected<Done> Commissioning::home() {
  bench_.confirmNobodyAttached(false);
  const auto nobody = askYes(
      {QuestionKind::kNobodyAttached,
       "Put the device on its mark, where you will put it every day, and take everybody out of it. "
       "It may move from now on. Is NOBODY attached? yes or no",
       "", "", 0.0, 0.0});
  if (!nobody) return nobody.errors();
  if (!*nobody) {
    return keyFault("", "step", "home", "somebody is attached, or it was not confirmed",
                    "take everybody out of the device, and answer yes");
  }
  bench_.confirmNobodyAttached(true);
  if (auto homed = bench_.home(); !homed) return homed;
  const auto position = bench_.position();
  if (!position) return position.errors();
  for (std::size_t i = 0; i < axes(); ++i) passport_.axes[i].mark = (*position)[i];
  return Done{};
}

Expected<Done> Commissioning::gravity() {
  for (std::size_t i = 0; i < axes(); ++i) {
    const auto carries = carryingEffort(bench_, i, offset_);
    if (!carries) return carries.errors();
    if (std::abs(*carries) > 0.5 * bench_.limit(i)) {
      return no(i,
                fmt::format("takes {:.3g} {} to be carried: more than half of what may be used",
                            *carries, axis(i).effortUnit()),
                "balance the axis");
    }
    const double differs = std::abs(*carries - axis(i).neutral_effort);
    if (differs > 0.03 * axis(i).effort_limit) {
      return no(i,
                fmt::format("takes {:.3g} {} to be carried, its file states a neutral effort of "
                            "{:.3g}: it would fall or rise when let go",
                            *carries, axis(i).effortUnit(), axis(i).neutral_effort),
                "state it in the device file, and begin again");
    }
    offset_[i] = *carries;
    reportLine(
        fmt::format("  {}: {:.3g} {} carry it", axis(i).name, *carries, axis(i).effortUnit()),
        {{axis(i).name, "carried-by", axis(i).effortUnit(), *carries, *carries}});
  }
  return Done{};
}

Expected<Done> Commissioning::write() {
  const auto file = readWhole(bench_.model().path);
  if (!file) return file.errors();
  passport_.device_sha256 = sha256(*file);
  passport_.measured_at = plan_.now();
  if (auto kept = plan_.write(path_, passportText(passport_)); !kept) return kept;
  reportLine("The passport is written: " + path_);
  const std::string charts = std::filesystem::path(path_).replace_extension(".html").string();
  if (auto drawn = plan_.draw(passportChart(passport_, bench_.model()), charts); drawn) {
    reportLine("What was measured, drawn: " + charts);
  } else {
    reportLine("The passport holds, but is not drawn: " + format(drawn.errors()));
  }
  reportLine(
      passport_.identity.simulated
          ? "It is of the simulated plant: no device is armed with it."
          : "It lasts 30 days. Before each day's first use: wholehand device commission --daily");
  return Done{};
}

Expected<Done> Commissioning::checkHomePosition(const Passport& kept) {
  if (auto at_home = home(); !at_home) return at_home;
  for (std::size_t i = 0; i < axes(); ++i) {
    const double off = passport_.axes[i].mark - kept.axes[i].mark;
    if (std::abs(off) <= kZeroWithin * (axis(i).upper - axis(i).lower)) continue;
    return no(i,
              fmt::format("is {:.3g} {} off its mark: it stands elsewhere, or its zero moved", off,
                          axis(i).positionUnit()),
              "put the device on its mark, home it, and check again");
  }
  return Done{};
}

Expected<Done> Commissioning::motorSigns() {
  for (std::size_t i = 0; i < axes(); ++i) {
    if (auto good = motorSign(i); !good) return good;
  }
  return Done{};
}

Expected<Passport> Commissioning::passportInForce() const {
  auto kept = readPassport(path_);
  if (!kept) return kept.errors();
  if (auto fits = checkPassport(*kept, bench_.driver().identity(), bench_.model(), plan_.now());
      !fits) {
    return fits.errors();
  }
  return kept;
}

Expected<Done> Commissioning::checkToday() {
  const auto kept = passportInForce();
  if (!kept) return kept.errors();
  const DeviceModel& model = bench_.model();
  if (auto good = report(CommissioningStep::kHome, [&] { return checkHomePosition(*kept); });
      !good) {
    return good;
  }
  if (auto good = report(CommissioningStep::kSigns, [&] { return motorSigns(); }); !good)
    return good;
  if (auto good = report(CommissioningStep::kWatchdog, [&] { return watchdog(); }); !good) {
    return good;
  }
  if (auto good = report(CommissioningStep::kEmergencyStop, [&] { return emergencyStop(); });
      !good) {
    return good;
  }
  if (auto good = report(CommissioningStep::kEffortLimit, [&] { return climbWith(kept->axes); });
      !good) {
    return good;
  }
  const DailyCheck check{kept->sha256, plan_.operator_name, plan_.now(), ""};
  const std::string path = dailyCheckPath(model.path, passport_.identity.serial);
  if (auto written = plan_.write(path, dailyCheckText(check)); !written) {
    reportLine(format(written.errors()));
    return written;
  }
  reportLine("Checked for today: " + path);
  return Done{};
}

Expected<Done> Commissioning::pushAway(std::size_t i) {
  std::vector<double> first, last;
  const auto answer = bench_.askWhile(
      {QuestionKind::kPushAway,
       fmt::format("Push axis {} {} by about a tenth of its range, leave it there; Enter",
                   axis(i).name, plus(axis(i))),
       axis(i).name, axis(i).positionUnit(), 0.0, 0.0},
      [&](const std::vector<double>& position) {
        if (first.empty()) first = position;
        last = position;
      });
  if (!answer) return answer.errors();
  if (first.empty()) return no(i, "gave no sample", "look at its cable");
  // Finds the axis that moved most relative to its range.
  std::vector<double> moved;
  for (std::size_t j = 0; j < axes(); ++j) {
    moved.push_back((last[j] - first[j]) / (axis(j).upper - axis(j).lower));
  }
  const std::size_t most =
      std::max_element(moved.begin(), moved.end(),
                       [](double a, double b) { return std::abs(a) < std::abs(b); }) -
      moved.begin();
  if (std::abs(moved[most]) < kByHand) {
    return no(i, "its position did not change while it was pushed",
              "push it further, or look at its encoder");
  }
  if (most != i && std::abs(moved[i]) < kOthers * std::abs(moved[most])) {
    return no(
        i,
        fmt::format("was pushed, but axis {} moved: their positions are swapped", axis(most).name),
        "name the axes as they are wired, and repeat the step");
  }
  if (moved[i] < 0.0) {
    return no(i,
              fmt::format("was pushed {}, and its position fell: its encoder has the wrong sign",
                          plus(axis(i))),
              "turn the sign of its position round in the driver, and repeat the step");
  }
  return Done{};
}

// True when the axis follows its effort; false when nothing moves, for example at a stop.
Expected<bool> Commissioning::movesWith(std::size_t i, double sign) {
  const auto push = pushSlowly(bench_, i, sign);
  if (!push) return push.errors();
  if (push->moved == 0.0) return false;
  if (push->axis != i) {
    return no(i,
              fmt::format("was given effort, but axis {} moved: their motors are swapped",
                          axis(push->axis).name),
              "wire or name them right, and repeat the step");
  }
  if (push->moved * sign < 0.0) {
    return no(i,
              fmt::format("moves in {} direction under {} effort: its motor has the wrong sign, or "
                          "its own weight moves it",
                          sign > 0.0 ? '-' : '+', sign > 0.0 ? '+' : '-'),
              "turn the sign of its effort round in the driver, or state in the device file what "
              "carries it, and repeat the step");
  }
  const double share_percent = 100.0 * push->share;
  reportLine(fmt::format("  {}: {} effort moves it {}, at {:.0f} % of its limit", axis(i).name,
                         sign > 0.0 ? '+' : '-', sign > 0.0 ? '+' : '-', share_percent),
             {{axis(i).name, sign > 0.0 ? "moves-at-plus" : "moves-at-minus", "%", share_percent,
               share_percent}});
  return true;
}

// Pushes in both directions: an axis moved by its own weight would follow one of the two pushes
// even without its motor.
Expected<Done> Commissioning::motorSign(std::size_t i) {
  const auto up = movesWith(i, 1.0);
  if (!up) return up.errors();
  const auto down = movesWith(i, -1.0);
  if (!down) return down.errors();
  if (*up || *down) return Done{};
  return no(i, "nothing moves at a fifth of its effort limit",
            "look for a brake, a cable or a wrong effort limit");
}

Expected<Done> Commissioning::signs() {
  for (std::size_t i = 0; i < axes(); ++i) {
    if (auto by_hand = pushAway(i); !by_hand) return by_hand;
    if (auto motor = motorSign(i); !motor) return motor;
  }
  return Done{};
}

Expected<Done> Commissioning::moveBetweenStops(std::size_t i) {
  const DeviceAxis& a = axis(i);
  double least = HUGE_VAL, most = -HUGE_VAL, last = std::nan(""), jump = 0.0;
  const auto stated = askNumber(
      {QuestionKind::kTravel,
       fmt::format("Move axis {} slowly to its one stop, then to the other; measure how far that "
                   "is [{}]:",
                   a.name, a.positionUnit()),
       a.name, a.positionUnit(), 0.0, 0.0},
      [&](const std::vector<double>& position) {
        const double q = position[i];
        if (std::isfinite(last)) jump = std::max(jump, std::abs(q - last));
        last = q;
        least = std::min(least, q);
        most = std::max(most, q);
      });
  if (!stated) return stated.errors();
  // Checks in this order: wrap-around, scale, travel, position of the stops.
  const double range = a.upper - a.lower, moved = most - least;
  if (jump > kWrapped * range) {
    return no(i,
              fmt::format("its position jumped by {:.3g} {}: its encoder wraps round", jump,
                          a.positionUnit()),
              "let the driver count turns, and repeat the step");
  }
  if (std::abs(moved / *stated - 1.0) > kScaleWithin) {
    return no(i,
              fmt::format("moved {:.4g} {}, its encoder says {:.4g}: {:.3g} times", *stated,
                          a.positionUnit(), moved, moved / *stated),
              "set the scale of its position in the driver, and repeat the step");
  }
  if (moved < range * (1.0 - kStopWithin)) {
    return no(
        i, fmt::format("travels {:.4g} {}, the file states {:.4g}", moved, a.positionUnit(), range),
        "state the range that it has, or move it to both stops");
  }
  const double margin = kStopWithin * range;
  if (least > a.lower + margin || most < a.upper - margin) {
    return no(
        i,
        fmt::format("has its stops at {:.4g} and {:.4g} {}, the file states {:.4g} to {:.4g}: "
                    "it was homed elsewhere than where it stands",
                    least, most, a.positionUnit(), a.lower, a.upper),
        "home it anew, or state the range that it has");
  }
  reportLine(fmt::format("  {}: {:.4g} to {:.4g} {}", a.name, least, most, a.positionUnit()),
             {{a.name, "travel", a.positionUnit(), least, most}});
  return Done{};
}

Expected<Done> Commissioning::scaleAndTravel() {
  for (std::size_t i = 0; i < axes(); ++i) {
    if (auto good = moveBetweenStops(i); !good) return good;
  }
  return Done{};
}

Expected<Done> Commissioning::measure(std::size_t i) {
  // Begins in mid-range, so that the whole motion has room.
  const double middle = 0.5 * (axis(i).lower + axis(i).upper);
  if (auto there = driveTo(bench_, i, middle, offset_); !there) return there;
  const auto excited = excite(bench_, i, offset_, plan_.measure_s);
  if (!excited) return excited.errors();
  for (std::size_t j = 0; j < axes(); ++j) {
    if (j == i || excited->response[j] <= kCross) continue;
    return no(i,
              fmt::format("moves axis {} along: {:.0f} % of its own response, 10 % are allowed",
                          axis(j).name, 100.0 * excited->response[j]),
              "let the driver decouple the axes: efforts in coordinates in which the inertia is "
              "diagonal");
  }
  const auto even = evenTrace(excited->trace, excited->taken_s, axis(i).name);
  if (!even) return even.errors();
  const auto found = identifyAxis(*even, axis(i).name);
  if (!found) return found.errors();
  if (found->delay_s.upper > kMostDelay_ticks * bench_.period_s()) {
    return no(i,
              fmt::format("its delay is up to {:.4f} s: more than {} periods", found->delay_s.upper,
                          kMostDelay_ticks),
              "use a faster bus, or a lower rate");
  }
  PassportAxis& p = passport_.axes[i];
  p.mass = found->mass;
  p.damping = found->damping;
  p.coulomb = found->coulomb;
  p.gravity = found->gravity;
  p.delay_s = found->delay_s;
  p.transport_s = excited->transport_s;
  p.resolution = found->resolution;
  p.drive_lag_s = identifyDriveLag(excited->trace.effort, excited->given, bench_.period_s());
  reportLine(
      fmt::format("  {}: mass {:.4g} to {:.4g}, damping {:.4g} to {:.4g}, dry friction {:.4g} to "
                  "{:.4g}, delay {:.2f} to {:.2f} ms ({:.2f} ms of it transport)",
                  axis(i).name, p.mass.lower, p.mass.upper, p.damping.lower, p.damping.upper,
                  p.coulomb.lower, p.coulomb.upper, 1e3 * p.delay_s.lower, 1e3 * p.delay_s.upper,
                  1e3 * excited->transport_s),
      measured(axis(i), p));
  return Done{};
}

Expected<Done> Commissioning::massFrictionDelay() {
  for (std::size_t i = 0; i < axes(); ++i) {
    if (auto measured = measure(i); !measured) return measured;
  }
  return Done{};
}

Expected<Done> Commissioning::hang(std::size_t i) {
  const auto before = carryingEffort(bench_, i, offset_);
  if (!before) return before.errors();
  const double room = bench_.limit(i) - std::abs(*before) - passport_.axes[i].coulomb.upper;
  const auto force = askNumber(
      {QuestionKind::kKnownForce,
       fmt::format("Let a known force pull axis {} against its + direction, {:.2g} to {:.2g} {} (a "
                   "weight over a pulley); its force:",
                   axis(i).name, 0.25 * room, 0.6 * room, axis(i).effortUnit()),
       axis(i).name, axis(i).effortUnit(), 0.25 * room, 0.6 * room},
      [](const std::vector<double>&) {});
  if (!force) return force.errors();
  const auto with = carryingEffort(bench_, i, offset_);
  if (!with) return with.errors();
  const double found = *with - *before;
  if (std::abs(found / *force - 1.0) > kWeightWithin) {
    return no(i,
              fmt::format("carries {:.4g} {} with {:.4g}: its efforts are {:.3g} times what they "
                          "are called",
                          *force, axis(i).effortUnit(), found, *force / found),
              "set the torque constant in the driver, and begin again with mass-friction-delay");
  }
  reportLine(fmt::format("  {}: {:.4g} {} were carried with {:.4g}", axis(i).name, *force,
                         axis(i).effortUnit(), found),
             {{axis(i).name, "known-force", axis(i).effortUnit(), *force, *force},
              {axis(i).name, "carried-with", axis(i).effortUnit(), found, found}});
  return Done{};
}

Expected<Done> Commissioning::knownWeight() {
  for (std::size_t i = 0; i < axes(); ++i) {
    if (auto good = hang(i); !good) return good;
  }
  reportLine("Take the weight off.");
  return Done{};
}

Expected<Done> Commissioning::rangeStops() {
  for (std::size_t i = 0; i < axes(); ++i) {
    const DeviceAxis& a = axis(i);
    const double margin = kStopWithin * (a.upper - a.lower);
    for (const double end : {a.upper - margin, a.lower + margin, 0.5 * (a.lower + a.upper)}) {
      if (auto there = driveTo(bench_, i, end, offset_); !there) return there;
    }
  }
  return Done{};
}

Expected<Done> Commissioning::climbWith(const std::vector<PassportAxis>& measured) {
  for (std::size_t i = 0; i < axes(); ++i) {
    if (auto there = driveTo(bench_, i, 0.5 * (axis(i).lower + axis(i).upper), offset_); !there) {
      return there;
    }
    const PassportAxis& p = measured[i];
    const auto reached = climb(bench_, i,
                               {p.mass.middle(), std::max(0.0, p.damping.middle()),
                                std::max(0.0, p.coulomb.middle()), p.delay_s.middle()},
                               offset_);
    if (!reached) return reached.errors();
    reportLine(fmt::format("  {}: responds as measured up to {:.0f} % of its effort limit",
                           axis(i).name, 100.0 * *reached),
               {{axis(i).name, "responds-up-to", "%", 100.0 * *reached, 100.0 * *reached}});
  }
  return Done{};
}

// Nobody is attached, the emergency stop and the watchdog are proven: the only motion above a fifth
// of the effort limits.
Expected<Done> Commissioning::effortLimit() {
  return climbWith(passport_.axes);
}

Expected<Done> Commissioning::watchdog() {
  double silence_s = 0.0;
  for (const wh_axis& a : bench_.driver().axes()) silence_s = std::max(silence_s, a.silence_s);
  const auto took = bench_.dropWatchdog(silence_s + kWatchdogSlack_s);
  if (!took) return took.errors();
  reportLine(fmt::format("  the drive let go after {:.0f} ms of silence", 1e3 * *took),
             {{"", "let-go-after", "ms", 1e3 * *took, 1e3 * *took}});
  return Done{};
}

// Tests the emergency stop, which the person presses while holding the key, because the device is
// enabled only then. When the device reports that it is cut off, it is pushed a little and must not
// move.
Expected<Done> Commissioning::emergencyStop() {
  using SampleUse = Bench::SampleUse;
  StopObservation seen;
  ReleaseCheck proof(bench_.model(), 1e-3 * kProveTicks_ms, kCommissioningShare);
  const double most_ticks = kPressWithin_s / bench_.period_s();
  double sample_s = 0.0;
  auto rested = bench_.move(
      {MotionKind::kEmergencyStop, "press the emergency stop while you hold it", "", 0.0},
      [&](int result, const wh_sample& sample) {
        sample_s = static_cast<double>(sample.monotonic_ns) * 1e-9;
        if (seen.what == StopObservation::kCut)
          return result < 0 ? SampleUse::kOver : SampleUse::kProve;
        seen = lookAtStop(seen, result, sample);
        if (seen.what == StopObservation::kCut) return SampleUse::kProve;
        if (seen.what == StopObservation::kWatchdog) return SampleUse::kOver;
        if (seen.still >= kSilentLooks || seen.ticks > most_ticks) return SampleUse::kOver;
        return seen.still > 0 ? SampleUse::kWait : SampleUse::kCheck;
      },
      [&](Bench::Now& now) -> Expected<bool> {
        if (seen.what != StopObservation::kCut) return true;
        now.effort = proof.push(now.position);
        const double pushed_ms = 1e3 * bench_.period_s() * ++seen.cut;
        if (pushed_ms > kSettles_ms) proof.addSample(sample_s, now.position);
        return pushed_ms < kProveTicks_ms;
      });
  if (!rested) return rested;
  if (seen.what == StopObservation::kCut) {
    Diagnostics acting = proof.acting("while the emergency stop is pressed");
    if (!acting.empty()) return acting;
  }
  const auto refuse = [](const char* why, const char* remedy) {
    return Diagnostic{"", 0, "step", "emergency-stop", why, remedy};
  };
  if (seen.what == StopObservation::kWatchdog) {
    return refuse(
        "its watchdog let go first, since this program was late: of the stop nothing was seen",
        "let nothing else run on this machine, and repeat the step");
  }
  if (seen.still >= kSilentLooks) {
    return refuse("the device fell silent with the stop: nothing says that its motors are off",
                  "let the stop cut the power of the motors, not that of their controller");
  }
  if (seen.what == StopObservation::kEnabled) {
    return refuse("the device stayed enabled: the emergency stop does not cut it off",
                  "wire it so that it cuts the power of the motors, and repeat the step");
  }
  const auto released = bench_.askWhile(
      {QuestionKind::kEmergencyStop, "It cut the device off. Release it; Enter", "", "", 0.0, 0.0},
      [](const auto&) {});
  if (!released) return released.errors();
  return Done{};
}

bool leadCommissioning(Commissioning& commissioning, Operator& person) {
  std::optional<CommissioningStep> step = commissioning.next();
  while (step) {
    const auto done = commissioning.carryOut(*step);
    if (commissioning.done(CommissioningStep::kPassport)) return true;
    // After a success, the next step follows automatically.
    step = done ? std::optional(commissioning.next()) : chooseNext(commissioning, person);
  }
  return false;
}

bool leadDailyCheck(Commissioning& commissioning, Operator& person) {
  while (!commissioning.checkToday()) {
    const auto answer = person.ask(nextStep("Enter to check again, or quit:"), [] {});
    if (!answer || *answer == "quit") return false;
  }
  return true;
}

}  // namespace wholehand
