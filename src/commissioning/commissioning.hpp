#pragma once

#include "commissioning/bench.hpp"
#include "commissioning/daily_check.hpp"
#include "commissioning/passport.hpp"
#include "page/chart_page.hpp"

#include <array>
#include <functional>
#include <string>
#include <vector>

namespace wholehand {

/// The steps of commissioning, in their order.
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
  kPassport
};
inline constexpr int kCommissioningSteps = 11;
/// "identify", "home", "signs", "scale-and-travel", ...
[[nodiscard]] const char* stepName(CommissioningStep step);

struct CommissioningPlan {
  std::string operator_name;
  Day day{};
  double measure_s = 20.0;  ///< of each axis's mass, friction and delay
  /// Keeps the passport; tests keep it elsewhere.
  std::function<Expected<Done>(const std::string& path, const std::string& text)> write;
  /// Draws the passport.
  std::function<Expected<Done>(const ChartPage& charts, const std::string& path)> draw;
};

/// Leads a device through its commissioning (docs/commissioning.md). Each step tells the person
/// what to do and what was found, can be repeated, and is refused by name where one before it is
/// missing. A step that fails is not done any more. Not for the tick.
class Commissioning {
 public:
  /// @pre bench outlives it
  Commissioning(Bench& bench, CommissioningPlan plan);

  [[nodiscard]] Expected<Done> carryOut(CommissioningStep step);
  [[nodiscard]] bool done(CommissioningStep step) const;
  /// The first step that is not done; kPassport where all are.
  [[nodiscard]] CommissioningStep next() const;
  /// Number of the step under way; -1: none.
  [[nodiscard]] int stepUnderWay() const { return step_under_way_; }
  /// All that was found; complete once kPassport is done.
  [[nodiscard]] const Passport& passport() const { return passport_; }
  [[nodiscard]] const std::string& path() const { return path_; }

  /// The passport that the check of a day is for: refused where there is none, or it is no good.
  [[nodiscard]] Expected<Passport> passportInForce() const;
  /// The two-minute check of a device that has a passport: zero, signs, watchdog, emergency stop.
  /// Writes its file where all passed.
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
  /// Asks, the device disabled, until the answer is yes or no.
  [[nodiscard]] Expected<bool> askYes(const Question& question);
  /// Asks, the device disabled, until the answer is a number above 0.
  [[nodiscard]] Expected<double> askNumber(const Question& question, const Look& look);
  void tell(const std::string& line, const std::vector<FoundFigure>& findings = {}) {
    bench_.person().tell(line, findings);
  }
  /// One step, or a part of the daily check, told of from its beginning to its end.
  [[nodiscard]] Expected<Done> told(CommissioningStep step,
                                    const std::function<Expected<Done>()>& do_it);
  [[nodiscard]] Expected<Done> atItsMark(const Passport& kept);
  [[nodiscard]] Expected<Done> motorSigns();

  Bench& bench_;
  CommissioningPlan plan_;
  Passport passport_;
  std::string path_;
  std::vector<double> offset_;  ///< effort that carries each axis [N or N·m]
  std::array<bool, kCommissioningSteps> done_{};
  int step_under_way_ = -1;
};

}  // namespace wholehand
