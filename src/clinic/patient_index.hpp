#pragma once

#include "clinic/records.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace wholehand::clinic {

/// The list of patients in memory, with names decrypted once, while somebody is signed in. It is
/// never written. Changes of the database are followed row by row. One thread at a time.
class PatientIndex {
 public:
  explicit PatientIndex(Records& records) : records_(records) {}
  PatientIndex(const PatientIndex&) = delete;
  PatientIndex& operator=(const PatientIndex&) = delete;
  ~PatientIndex() = default;

  /// A page of the patients whose name or code contains a text, the last visited first: `patients`,
  /// `count` of all that were found, and `open`, those with an open or unfinished visit.
  [[nodiscard]] Json page(std::string_view find, std::int64_t page);
  /// Row of one patient; null: there is none.
  [[nodiscard]] Json row(std::int64_t patient);
  /// Reads all names, so that the first list need not.
  void refresh();
  /// Forgets all names.
  void forget();

  static constexpr std::int64_t kRowsOfPage = 50;

 private:
  struct Row {
    std::int64_t id = 0, visits = 0, last_visit_us = 0, visit = 0;
    std::string code, name, side, state, words;  ///< words: what a search looks at
    NLOHMANN_DEFINE_TYPE_INTRUSIVE(Row, id, code, name, side, visits, last_visit_us, state, visit)
  };
  static void changed(void* index, int kind, const char* database, const char* table,
                      long long row);
  void read(const std::string& where, std::int64_t patient);

  Records& records_;
  std::uint64_t opening_ = 0;  ///< of the database that was read; 0: none
  std::unordered_map<std::int64_t, Row> rows_;
  std::unordered_map<std::int64_t, std::int64_t> owners_;  ///< of visits
  std::unordered_set<std::int64_t> changed_patients_, changed_visits_;
  std::vector<const Row*> order_;  ///< the last visited first; empty: to be sorted
};

}  // namespace wholehand::clinic
