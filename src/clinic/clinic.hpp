#pragma once

#include "clinic/accounts.hpp"
#include "clinic/patients.hpp"
#include "clinic/plans.hpp"
#include "clinic/records.hpp"
#include "clinic/request.hpp"
#include "clinic/station.hpp"
#include "clinic/text.hpp"
#include "clinic/trials.hpp"
#include "clinic/visits.hpp"

#include <functional>
#include <mutex>
#include <vector>

/// A clinic's patients, visits and results (docs/clinic.md).
namespace wholehand::clinic {

/// Answers requests, one at a time but for those that wait for the station. Every answered change
/// is on the disk. Any thread. What fails is answered by name; nothing ends the process.
class Clinic {
 public:
  Clinic(ClinicOptions options, const Clock& clock, Station& station);

  [[nodiscard]] Answer answer(const Request& request);

  /// Compares what the station has open with the database; call every second.
  void lookAtStation();
  /// Measures recordings that the database does not know as they are; call every few seconds. Stops
  /// early when `stop` returns true.
  void lookAtRecordings(const Measure& measure, const std::function<bool()>& stop);
  /// Makes a backup when the last one is a day old, and removes those of 30 days; frees what was
  /// erased and is not freed yet. Call every minute.
  void backUpIfDue();

 private:
  enum class Kind { kRead, kWrite, kStation, kSession };
  struct Route {
    const char* method;
    const char* path;
    Access access;
    Kind kind;
    std::function<Json(Call&)> handler;
  };
  [[nodiscard]] std::vector<Route> routes();
  void route(Call& call);
  void perform(Call& call, const Route& route);
  Json state(Call& call);
  Json lock(Call& call);

  Station& station_;
  std::mutex mutex_;  ///< guards all below
  Records records_;
  Accounts accounts_{records_};
  Plans plans_;
  Patients patients_{records_, accounts_, plans_};
  Visits visits_;
  Trials trials_;
  const std::vector<Route> routes_;
};

}  // namespace wholehand::clinic
