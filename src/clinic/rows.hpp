#pragma once

#include "clinic/records.hpp"

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

/// Rows of visits, trials and notes, and their JSON form for the pages.
namespace wholehand::clinic {

struct VisitRow {
  std::int64_t id = 0, account = 0, began_us = 0, ended_us = 0, item = 0;
  int offset_min = 0;
  std::optional<std::int64_t> patient;
  std::string side, hand, hand_file, state;
  Plan plan;
  Json pain_before, pain_after;
  Json in_force = Json::object(), changed = Json::object(), before = Json::object();
};
/// Members and columns of the same names; `patient` and pain may be NULL.
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(VisitRow, id, patient, account, side, hand, hand_file, began_us,
                                   ended_us, offset_min, state, plan, item, pain_before, pain_after,
                                   in_force, changed, before)
/// Refuses, by name, to serve a row whose digest is wrong or missing.
void refuseDamaged(Database& db, const char* table, std::int64_t row, const std::string& name);
[[nodiscard]] VisitRow visitRow(Database& db, std::int64_t id);
[[nodiscard]] Json visitJson(Records& records, std::int64_t id, bool hidden);
/// A visit in a list: of a damaged row only the number, with the state "damaged".
[[nodiscard]] Json listedVisit(Records& records, std::int64_t id);
/// Restores the person's values from before the visit, except those changed again since. Used when
/// the visit belongs to somebody else.
void takeBackSettings(Database& db, const VisitRow& visit);
[[nodiscard]] std::int64_t takeVisitNumber(Database& db);
/// Inserts a visit; one without a number draws it. @return its number
std::int64_t insertVisit(Records& records, VisitRow visit);
/// Inserts a row; objects and arrays are stored as text.
void insertRow(Database& db, const char* table, const Json& columns);
/// Columns of a row by their names in the query.
/// @param from first of them @param parsed texts that are JSON
[[nodiscard]] Json rowJson(const Statement& row, int from = 0,
                           std::initializer_list<const char*> parsed = {});

/// Inserts a trial whose recording is not measured yet.
void insertWaitingTrial(Database& db, const std::string& recording, std::int64_t visit,
                        std::int64_t item, std::int64_t began_us, const std::string& sha256 = {});
/// Adds a line to the log; 0: no account, patient or visit.
void writeLog(Database& db, std::int64_t at_us, std::int64_t account, const std::string& what,
              std::int64_t patient = 0, std::int64_t visit = 0, const std::string& detail = {});

/// Query with the columns that trialsIn() reads.
[[nodiscard]] std::string trialColumns(Database& db);
/// Trials as JSON; of a damaged row only the reason.
/// @param rows query that begins with trialColumns()
[[nodiscard]] Json trialsIn(Statement rows, const Plan& plan);

/// Largest number of a note that a page draws.
inline constexpr std::int64_t kLastDrawnNote = (std::int64_t{1} << 48) - 1;

/// Notes as JSON.
/// @param column column that `id` refers to: "patient", "visit" or "id"
[[nodiscard]] Json notesOf(Records& records, const char* column, std::int64_t id, bool hidden);
/// Inserts a note.
/// @param id number of the note; empty: the next one above those that pages draw
void insertNote(Records& records, Call& call, std::optional<std::int64_t> patient,
                std::optional<std::int64_t> visit, std::optional<std::int64_t> id = {});

}  // namespace wholehand::clinic
