#pragma once

#include "clinic/accounts.hpp"
#include "clinic/plans.hpp"
#include "clinic/records.hpp"

#include <cstdint>
#include <string>
#include <string_view>

namespace wholehand::clinic {

/// Patients: records, notes, corrections, exports. One thread at a time.
class Patients {
 public:
  Patients(Records& records, Accounts& accounts, Plans& plans)
      : records_(records), accounts_(accounts), plans_(plans) {}

  /// Refuses a number that belongs to no patient.
  void check(std::int64_t id);
  /// Rows of the list of patients.
  /// @param find part of a name or code; empty: all
  /// @param only a patient's id; 0: all
  [[nodiscard]] Json rows(std::string_view find, std::int64_t only);

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
  Json remove(Call& call);
  Json merge(Call& call);
  Json erase(Call& call);
  Json noShow(Call& call);
  Json note(Call& call);
  Json exportOne(Call& call);
  Json exportAll(Call& call);

 private:
  struct Data;
  [[nodiscard]] Data read(const Json& body) const;
  [[nodiscard]] Json toJson(std::int64_t id);
  void checkNoOpenVisit(std::int64_t patient);

  Records& records_;
  Accounts& accounts_;
  Plans& plans_;
};

/// Measured values as CSV, one per line, by code, without names and notes. Needs no key.
/// @param patient 0: all
[[nodiscard]] std::string csvOf(Database& db, std::int64_t patient);

}  // namespace wholehand::clinic
