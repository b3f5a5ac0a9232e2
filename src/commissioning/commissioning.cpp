#include "commissioning/commissioning.hpp"

#include "commissioning/moves.hpp"
#include "commissioning/passport_chart.hpp"
#include "commissioning/sealed_file.hpp"
#include "core/sha256.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <utility>

namespace wholehand {
namespace {

constexpr std::array<const char*, kCommissioningSteps> kNames = {
    "identify",         "home",     "signs",
    "scale-and-travel", "gravity",  "mass-friction-delay",
    "known-weight",     "watchdog", "emergency-stop",
    "range-stops",      "passport"};
constexpr double kZeroWithin = 0.01;  // of the range

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
    tell("Neither yes nor no.");
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
    tell("That is no number above 0: digits only, without a unit.");
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
    return told(step, [&]() -> Expected<Done> { return missing; });
  }
  using Method = Expected<Done> (Commissioning::*)();
  static constexpr std::array<Method, kCommissioningSteps> kMethods = {
      &Commissioning::identify,       &Commissioning::home,     &Commissioning::signs,
      &Commissioning::scaleAndTravel, &Commissioning::gravity,  &Commissioning::massFrictionDelay,
      &Commissioning::knownWeight,    &Commissioning::watchdog, &Commissioning::emergencyStop,
      &Commissioning::rangeStops,     &Commissioning::write};
  done_.back() = false;  // a new measurement makes the passport outdated
  Expected<Done> result = told(step, [&] { return (this->*kMethods.at(at))(); });
  done_.at(at) = result.ok();
  return result;
}

Expected<Done> Commissioning::told(CommissioningStep step,
                                   const std::function<Expected<Done>()>& do_it) {
  StepNews news{static_cast<int>(step), StepNews::What::kBegins, {}};
  step_under_way_ = news.step;
  bench_.person().tellStep(news);
  Expected<Done> result = do_it();
  step_under_way_ = -1;
  news.what = result ? StepNews::What::kDone : StepNews::What::kFailed;
  if (!result) news.why = result.errors();
  bench_.person().tellStep(news);
  return result;
}

Expected<Done> Commissioning::identify() {
  if (passport_.identity.serial.empty()) {
    return Diagnostic{
        bench_.model().path,
        0,
        "serial",
        "",
        "the driver says no serial number: a passport could not be told to be its own",
        "let the driver fill in wh_plugin.identify"};
  }
  (void)bench_.driver().control(WH_IDENTIFY, 0.0);  // optional: the device also has a label
  const auto is_this =
      askYes({Question::About::kThisDevice,
              fmt::format("Is this the device with serial number {} (firmware {}, {})? yes or no",
                          passport_.identity.serial, passport_.identity.firmware, passport_.driver),
              "", "", 0.0, 0.0});
  if (!is_this) return is_this.errors();
  if (*is_this) return Done{};
  return Diagnostic{"",
                    0,
                    "serial",
                    passport_.identity.serial,
                    "is not this device",
                    "name the device with --device-at"};
}

Expected<Done> Commissioning::home() {
  bench_.confirmNobodyAttached(false);
  const auto nobody = askYes(
      {Question::About::kNobodyAttached,
       "Put the device on its mark, where you will put it every day, and take everybody out of it. "
       "It may move from now on. Is NOBODY attached? yes or no",
       "", "", 0.0, 0.0});
  if (!nobody) return nobody.errors();
  if (!*nobody) {
    return Diagnostic{"",
                      0,
                      "step",
                      "home",
                      "somebody is attached, or it was not confirmed",
                      "take everybody out of the device, and answer yes"};
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
    tell(fmt::format("  {}: {:.3g} {} carry it", axis(i).name, *carries, axis(i).effortUnit()),
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
  tell("The passport is written: " + path_);
  const std::string charts = std::filesystem::path(path_).replace_extension(".html").string();
  if (auto drawn = plan_.draw(passportChart(passport_, bench_.model()), charts); drawn) {
    tell("What was measured, drawn: " + charts);
  } else {
    tell("The passport holds, but is not drawn: " + format(drawn.errors()));
  }
  tell("It lasts 30 days. Before each day's first use: wholehand device commission --daily");
  return Done{};
}

Expected<Done> Commissioning::atItsMark(const Passport& kept) {
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
  if (auto good = told(CommissioningStep::kHome, [&] { return atItsMark(*kept); }); !good) {
    return good;
  }
  if (auto good = told(CommissioningStep::kSigns, [&] { return motorSigns(); }); !good) return good;
  if (auto good = told(CommissioningStep::kWatchdog, [&] { return watchdog(); }); !good) {
    return good;
  }
  if (auto good = told(CommissioningStep::kEmergencyStop, [&] { return emergencyStop(); }); !good) {
    return good;
  }
  const DailyCheck check{kept->sha256, plan_.operator_name, plan_.now()};
  const std::string path = dailyCheckPath(model.path, passport_.identity.serial);
  if (auto written = plan_.write(path, dailyCheckText(check)); !written) {
    tell(format(written.errors()));
    return written;
  }
  tell("Checked for today: " + path);
  return Done{};
}

}  // namespace wholehand
