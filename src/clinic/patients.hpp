#pragma once

#include "clinic/accounts.hpp"
#include "clinic/patient_index.hpp"
#include "clinic/plans.hpp"
#include "clinic/records.hpp"

#include <atomic>
#include <cstdint>
#include <string>

namespace wholehand::clinic {

/// Visits of an export that are written, and all of them; `of` is 0 while no export runs. Any
/// thread.
struct ExportProgress {
  std::atomic<std::int64_t> done{0}, of{0};
};

/// Patients: records, notes, corrections, exports. One thread at a time.
class Patients {
 public:
  Patients(Records& records, Accounts& accounts, Plans& plans)
      : records_(records), accounts_(accounts), plans_(plans) {}

  /// Refuses a number that belongs to no patient.
  void check(std::int64_t id);
  /// The patient that a request's body names; it exists.
  [[nodiscard]] std::int64_t named(const Json& body);
  /// The list of patients in memory.
  [[nodiscard]] PatientIndex& index() { return index_; }

  Json list(Call& call);
  /// What a restore left to people was done.
  Json forgetRestored(Call& call);
  /// Somebody confirms that changes were lost.
  Json forgetLost(Call& call);
  /// Somebody confirms the clock after a jump.
  Json confirmClock(Call& call);
  Json proposeCode(Call& call);
  Json add(Call& call);
  Json change(Call& call);
  Json show(Call& call);
  /// What can be read of a damaged row: a beginning for signAgain(). Side, hands and limits are
  /// left to the therapist; `was` says what stands there, `unreadable` names what cannot be read.
  Json showDamaged(Call& call);
  /// Replaces a damaged row by values that a therapist has confirmed.
  Json signAgain(Call& call);
  Json remove(Call& call);
  Json merge(Call& call);
  Json erase(Call& call);
  Json noShow(Call& call);
  Json note(Call& call);
  Json exportOne(Call& call);
  Json exportAll(Call& call);
  Json exportProgress(Call& call);

 private:
  struct Data;
  [[nodiscard]] Data read(const Json& body) const;
  void store(std::int64_t id, const Data& data);
  [[nodiscard]] Json toJson(std::int64_t id);
  void checkNoOpenVisit(std::int64_t patient);
  [[nodiscard]] std::string exported(Call& call, std::int64_t patient);

  Records& records_;
  Accounts& accounts_;
  Plans& plans_;
  PatientIndex index_{records_};
  ExportProgress export_;
};

/// Measured values as CSV, one per line, by code, without names and notes. Needs no key.
/// @param patient 0: all
[[nodiscard]] std::string csvOf(Database& db, std::int64_t patient,
                                ExportProgress* progress = nullptr);

}  // namespace wholehand::clinic
