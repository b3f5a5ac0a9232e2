#pragma once

#include "clinic/accounts.hpp"
#include "clinic/plans.hpp"
#include "clinic/records.hpp"

#include <cstdint>
#include <string>
#include <string_view>

namespace wholehand::clinic {

/// Patients: their rows, notes, mistakes, exports. One thread at a time.
class Patients {
 public:
  Patients(Records& records, Accounts& accounts, Plans& plans)
      : records_(records), accounts_(accounts), plans_(plans) {}

  /// Refuses a number that is no patient's.
  void check(std::int64_t id);
  /// @param find part of a name or code; empty: all
  /// @param only a patient's id; 0: all
  [[nodiscard]] Json rows(std::string_view find, std::int64_t only);

  Json list(Call& call);
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

/// Measured values, one a line, by code, without names and notes; needs no key. @param patient 0:
/// all
[[nodiscard]] std::string csvOf(Database& db, std::int64_t patient);

}  // namespace wholehand::clinic
