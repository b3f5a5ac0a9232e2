#pragma once

#include "devices/commissioning/bench.hpp"
#include "devices/passport/passport.hpp"
#include "files/page/chart_page.hpp"

#include <array>
#include <functional>
#include <string>
#include <vector>

namespace wholehand {

/// Steps of commissioning, in order.
enum class CommissioningStep {
  kIdentify,
  kHome,
  kSigns,
  kScaleAndTravel,
  kGravity,
  kMassFrictionDelay,
  kKnownWeight,
  kWatchdog,
  kEmergencyStop,
  kRangeStops,
  kEffortLimit,
  kPassport
};
inline constexpr int kCommissioningSteps = 12;
/// "identify", "home", "signs", "scale-and-travel", ...
[[nodiscard]] const char* stepName(CommissioningStep step);

struct CommissioningPlan {
  std::string operator_name;
  std::function<PlaceTime()> now;  ///< clock and place
  double measure_s = 20.0;         ///< duration of the measurement of an axis
  /// Writes the passport; tests write it elsewhere.
  std::function<Expected<Done>(const std::string& path, const std::string& text)> write;
  /// Writes the passport's chart page.
  std::function<Expected<Done>(const ChartPage& charts, const std::string& path)> draw;
};

/// Leads a person through the commissioning of a device (docs/commissioning.md). Each step tells
/// the person what to do and what was found, and can be repeated. A step is refused, naming the
/// missing one, when an earlier step is not done. A failed step counts as not done. Not real-time
/// safe.
class Commissioning {
 public:
  /// @pre bench outlives it
  Commissioning(Bench& bench, CommissioningPlan plan);

  [[nodiscard]] Expected<Done> carryOut(CommissioningStep step);
  [[nodiscard]] bool done(CommissioningStep step) const;
  /// First step that is not done; kPassport when all are done.
  [[nodiscard]] CommissioningStep next() const;
  /// Number of the current step; -1: none.
  [[nodiscard]] int stepUnderWay() const { return step_under_way_; }
  /// The findings so far; complete once kPassport is done.
  [[nodiscard]] const Passport& passport() const { return passport_; }
  [[nodiscard]] const std::string& path() const { return path_; }

  /// The passport for the daily check. Refused when there is none or it is invalid.
  [[nodiscard]] Expected<Passport> passportInForce() const;
  /// Runs the daily check of a device with a passport: zero, signs, watchdog, emergency stop,
  /// and the climb to the effort limit. Writes its file if all pass.
  [[nodiscard]] Expected<Done> checkToday();

 private:
  [[nodiscard]] Expected<Done> identify();
  [[nodiscard]] Expected<Done> home();
  [[nodiscard]] Expected<Done> signs();
  [[nodiscard]] Expected<Done> scaleAndTravel();
  [[nodiscard]] Expected<Done> gravity();
  [[nodiscard]] Expected<Done> massFrictionDelay();
  [[nodiscard]] Expected<Done> knownWeight();
  [[nodiscard]] Expected<Done> watchdog();
  [[nodiscard]] Expected<Done> emergencyStop();
  [[nodiscard]] Expected<Done> rangeStops();
  [[nodiscard]] Expected<Done> effortLimit();
  [[nodiscard]] Expected<Done> climbWith(const std::vector<PassportAxis>& measured);
  [[nodiscard]] Expected<Done> write();

  [[nodiscard]] Expected<Done> pushAway(std::size_t i);
  [[nodiscard]] Expected<Done> motorSign(std::size_t i);
  [[nodiscard]] Expected<bool> movesWith(std::size_t i, double sign);
  [[nodiscard]] Expected<Done> moveBetweenStops(std::size_t i);
  [[nodiscard]] Expected<Done> measure(std::size_t i);
  [[nodiscard]] Expected<Done> hang(std::size_t i);
  [[nodiscard]] const DeviceAxis& axis(std::size_t i) const { return bench_.model().axes[i]; }
  [[nodiscard]] std::size_t axes() const { return bench_.model().axes.size(); }
  [[nodiscard]] Diagnostic no(std::size_t i, const std::string& problem,
                              const std::string& remedy) const;
  using Look = std::function<void(const std::vector<double>& position)>;
  /// Asks while the device is disabled, until the answer is yes or no.
  [[nodiscard]] Expected<bool> askYes(const Question& question);
  /// Asks while the device is disabled, until the answer is a number above 0.
  [[nodiscard]] Expected<double> askNumber(const Question& question, const Look& look);
  void reportLine(const std::string& line, const std::vector<FoundFigure>& findings = {}) {
    bench_.person().reportLine(line, findings);
  }
  /// Runs one step or part of the daily check and reports its beginning and end.
  [[nodiscard]] Expected<Done> report(CommissioningStep step,
                                      const std::function<Expected<Done>()>& do_it);
  [[nodiscard]] Expected<Done> checkHomePosition(const Passport& kept);
  [[nodiscard]] Expected<Done> motorSigns();

  Bench& bench_;
  CommissioningPlan plan_;
  Passport passport_;
  std::string path_;
  std::vector<double> offset_;  ///< effort that balances the gravity of each axis [N or N·m]
  std::array<bool, kCommissioningSteps> done_{};
  int step_under_way_ = -1;
};

/// Leads the person through all steps. True: the passport was written; false: the person ended the
/// commissioning.
[[nodiscard]] bool leadCommissioning(Commissioning& commissioning, Operator& person);

/// Runs the daily check, and repeats it after a failure if the person wants. True: the check was
/// written.
[[nodiscard]] bool leadDailyCheck(Commissioning& commissioning, Operator& person);

}  // namespace wholehand
