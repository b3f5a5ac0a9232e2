#pragma once

#include "clinic/accounts.hpp"
#include "clinic/patients.hpp"
#include "clinic/plans.hpp"
#include "clinic/records.hpp"
#include "clinic/request.hpp"
#include "clinic/station_client.hpp"
#include "clinic/text.hpp"
#include "clinic/trials.hpp"
#include "clinic/upkeep.hpp"
#include "clinic/visits.hpp"

#include <atomic>
#include <functional>
#include <mutex>
#include <vector>

/// Patients, visits and results of a clinic (docs/clinic.md).
namespace wholehand::clinic {

/// Answers requests, one at a time except for those that wait for the station. Every answered
/// change is on the disk. Any thread. A failure is answered with a named reason; none ends the
/// process.
class Clinic {
 public:
  Clinic(ClinicOptions options, const Clock& clock, Station& station);

  [[nodiscard]] Answer answer(const Request& request);

  /// Compares the visit that is open on the station with the database. Call every second.
  void lookAtStation();
  /// Measures recordings that are new or changed since the database knew them. Call every few
  /// seconds. Stops early when `stop` returns true.
  void lookAtRecordings(const Measure& measure, const std::function<bool()>& stop);
  /// Makes a backup when the last one is a day old, and removes backups older than 30 days. Call
  /// every minute.
  void backUpIfDue();
  /// Carries out actions over rows and files that are stored and not done, those of an earlier
  /// process included. After a failure it tries again a minute later, and as soon as the programs
  /// that read the database are gone. Call every second.
  void carryOut();

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
  /// Locks the clinic for a request. What changes something goes before what reads: at most one
  /// read waits for the lock, the others for their turn.
  [[nodiscard]] std::unique_lock<std::mutex> turnOf(const Request& request);
  void route(Call& call);
  void perform(Call& call, const Route& route);
  Json state(Call& call);
  Json lock(Call& call);
  Json signIn(Call& call);
  Json signOut(Call& call);

  Station& station_;
  std::mutex reads_;                     ///< held by the read that waits for the lock
  std::atomic<int> changes_waiting_{0};  ///< requests that change something and wait for the lock
  std::mutex mutex_;                     ///< guards the members below
  Records records_;
  Accounts accounts_{records_};
  Upkeep upkeep_{records_};
  Plans plans_;
  Patients patients_{records_, accounts_, plans_};
  Visits visits_;
  Trials trials_;
  std::int64_t carry_out_again_us_ = 0;  ///< steady clock: not earlier, after a failure
  bool waits_for_readers_ = false;       ///< of other programs; earlier once they are gone
  const std::vector<Route> routes_;
};

}  // namespace wholehand::clinic
