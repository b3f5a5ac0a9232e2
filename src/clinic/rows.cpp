#include "clinic/rows.hpp"

#include "clinic/plans.hpp"
#include "clinic/row_digests.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace wholehand::clinic {
namespace {

constexpr std::size_t kLongestNote = 4000, kLongestNoteKind = 20;

/// Side of a hand from the end of its name: "right" or "left"; empty: neither.
std::string sideOfHand(const Json& measures) {
  const std::string hand = measures.value("hand", "");
  for (const char* side : {"right", "left"}) {
    if (hand.ends_with(std::string("-") + side)) return side;
  }
  return {};
}

}  // namespace

void refuseDamaged(Database& db, const char* table, std::int64_t row, const std::string& name) {
  if (isSound(db, table, row)) return;
  throw RequestRefusal{409,
                       "damaged",
                       name +
                           ": its row in clinic.db is damaged: restore a backup; until then train"
                           " under the gentle preset, and confirm hand and side",
                       {}};
}

VisitRow visitRow(Database& db, std::int64_t id) {
  Statement row = db.query(
      "SELECT patient, account, side, hand, hand_file, began_us, ended_us, offset_min, state, plan,"
      " item, pain_before, pain_after, in_force, changed, before FROM visit WHERE id = ?",
      id);
  if (!row.step()) throw notFound(fmt::format("there is no visit {}", id));
  refuseDamaged(db, "visit", id, fmt::format("visit {}", id));
  VisitRow visit;
  visit.id = id;
  if (!row.isNull(0)) visit.patient = row.integer(0);
  visit.account = row.integer(1);
  visit.side = row.text(2);
  visit.hand = row.text(3);
  visit.hand_file = row.text(4);
  visit.began_us = row.integer(5);
  visit.ended_us = row.integer(6);
  visit.offset_min = static_cast<int>(row.integer(7));
  visit.state = row.text(8);
  visit.plan = planFrom(row.text(9));
  visit.item = row.integer(10);
  if (!row.isNull(11)) visit.pain_before = row.integer(11);
  if (!row.isNull(12)) visit.pain_after = row.integer(12);
  visit.in_force = Json::parse(row.text(13));
  visit.changed = Json::parse(row.text(14));
  visit.before = Json::parse(row.text(15));
  return visit;
}

std::string trialColumns(Database& db) {
  return "SELECT item, recording, began_us, state, why, measures, id, " +
         soundness(db, "trial", "trial") + " FROM trial";
}

namespace {

/// What is measured in a trial, and what stands for it where it was not.
Json notMeasured() {
  return {{"active_s", nullptr},     {"helped_s", nullptr},      {"led_s", nullptr},
          {"helped_share", nullptr}, {"results", Json::array()}, {"peak_speed_m_s", nullptr},
          {"path_ratio", nullptr},   {"reach_s", nullptr},       {"ended_by", ""}};
}

Json damagedTrial(std::int64_t id) {
  Json trial = notMeasured();
  trial.update({{"id", id},
                {"item", 0},
                {"exercise", ""},
                {"level", 0},
                {"recording", ""},
                {"began_us", 0},
                {"duration_s", nullptr},
                {"side", ""},
                {"state", "failed"},
                {"why", fmt::format("row {} of trial in clinic.db is damaged: end the program and"
                                    " run wholehand-clinic rebuild",
                                    id)}});
  return trial;
}

}  // namespace

Json trialsIn(Statement rows, const Plan& plan) {
  Json trials = Json::array();
  while (rows.step()) {
    if (rows.integer(7) == 0) {
      trials.push_back(damagedTrial(rows.integer(6)));
      continue;
    }
    const Json m = Json::parse(rows.text(5));
    const auto item = static_cast<std::size_t>(rows.integer(0));
    const bool planned = item < plan.size();
    const Json recording = m.value("recording", Json::object());
    Json& trial = trials.emplace_back(notMeasured());
    for (auto& [key, value] : trial.items()) value = m.value(key, value);
    trial.update({{"id", rows.integer(6)},
                  {"item", item},
                  {"exercise", m.value("exercise", Json(planned ? plan[item].exercise : ""))},
                  {"level", m.value("level", Json(planned ? plan[item].level : 0))},
                  {"recording", rows.text(1)},
                  {"began_us", rows.integer(2)},
                  {"duration_s", recording.value("duration_s", Json())},
                  {"side", sideOfHand(m)},
                  {"state", rows.text(3)},
                  {"why", rows.text(4)}});
  }
  return trials;
}

Json notesOf(Records& records, const char* column, std::int64_t id, bool hidden) {
  Json notes = Json::array();
  Statement rows = records.db().query(
      fmt::format("SELECT id, visit, at_us, account, kind, text, {} FROM note WHERE {} = ? ORDER "
                  "BY at_us, id",
                  soundness(records.db(), "note", "note"), column),
      id);
  while (rows.step()) {
    if (rows.integer(6) == 0) {
      notes.push_back({{"id", rows.integer(0)},
                       {"visit", 0},
                       {"at_us", 0},
                       {"account", 0},
                       {"kind", "text"},
                       {"text", fmt::format("note {}: its row in clinic.db is damaged: restore a"
                                            " backup",
                                            rows.integer(0))}});
      continue;
    }
    notes.push_back({{"id", rows.integer(0)},
                     {"visit", rows.integer(1)},
                     {"at_us", rows.integer(2)},
                     {"account", rows.integer(3)},
                     {"kind", rows.text(4)},
                     {"text", hidden ? "" : records.unseal("note", rows.text(5))}});
  }
  return notes;
}

Json visitJson(Records& records, std::int64_t id, bool hidden) {
  const VisitRow v = visitRow(records.db(), id);
  return {{"id", v.id},
          {"patient", v.patient ? Json(*v.patient) : Json()},
          {"side", v.side},
          {"began_us", v.began_us},
          {"ended_us", v.ended_us},
          {"offset_min", v.offset_min},
          {"state", v.state},
          {"account", v.account},
          {"plan", toJson(v.plan)},
          {"changed", v.changed},
          {"item", v.item},
          {"next_item", v.item + 1},
          {"hand", v.hand.empty() ? v.hand_file : v.hand},
          {"trials",
           trialsIn(records.db().query(
                        trialColumns(records.db()) + " WHERE visit = ? ORDER BY began_us, id", id),
                    v.plan)},
          {"notes", notesOf(records, "visit", id, hidden)},
          {"pain_before", v.pain_before},
          {"pain_after", v.pain_after}};
}

Json listedVisit(Records& records, std::int64_t id) {
  if (isSound(records.db(), "visit", id)) return visitJson(records, id, false);
  return {{"id", id},
          {"patient", nullptr},
          {"side", ""},
          {"began_us", 0},
          {"ended_us", 0},
          {"offset_min", 0},
          {"state", "damaged"},
          {"account", 0},
          {"plan", Json::array()},
          {"changed", Json::object()},
          {"item", 0},
          {"next_item", 0},
          {"hand", ""},
          {"trials", Json::array()},
          {"notes", Json::array()},
          {"pain_before", nullptr},
          {"pain_after", nullptr}};
}

void takeBackSettings(Database& db, const VisitRow& visit) {
  if (!visit.patient || visit.before.empty()) return;
  Statement row = db.query("SELECT parameters FROM patient WHERE id = ?", *visit.patient);
  row.step();
  Json own = Json::parse(row.text(0));
  for (const auto& [name, value] : visit.before.items()) {
    if (own.value(name, Json()) != visit.changed.at(name)) continue;
    own[name] = value;
    if (value.is_null()) own.erase(name);
  }
  db.change("UPDATE patient SET parameters = ?, version = version + 1 WHERE id = ?", own.dump(),
            *visit.patient);
}

std::int64_t takeVisitNumber(Database& db) {
  db.run("UPDATE clinic SET next_visit = next_visit + 1");
  return db.number("SELECT next_visit - 1 FROM clinic");
}

std::int64_t insertVisit(Records& records, std::int64_t patient, std::int64_t account,
                         const std::string& side, std::int64_t began_us, std::int64_t ended_us,
                         const std::string& state) {
  const std::int64_t id = takeVisitNumber(records.db());
  records.db().change(
      "INSERT INTO visit (id, patient, account, side, hand, hand_file, began_us, ended_us,"
      " offset_min, state, plan, item, began_n) VALUES (?, ?, ?, ?, '', '', ?, ?, ?, ?, '[]', 0, "
      "?)",
      id, patient, account, side, began_us, ended_us, records.clock().offset_min(began_us), state,
      changesIn(records.db()) + 1);
  return id;
}

void insertNote(Records& records, Call& call, std::optional<std::int64_t> patient,
                std::optional<std::int64_t> visit, std::optional<std::int64_t> id) {
  const std::string text = textOr(call.body, "text", kLongestNote, true);
  const std::string kind = call.body.contains("kind") ? textOr(call.body, "kind", kLongestNoteKind)
                                                      : std::string("text");
  const bool word = !kind.empty() && std::all_of(kind.begin(), kind.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || c == '_';
  });
  if (!word) throw badValue("kind", "kind is a word of at most 20 small letters and _");
  if (kind == "text" && text.empty()) throw badValue("text", "the note is empty");
  const std::int64_t now_us = records.clock().now_us();
  const Json at = call.body.value("at_us", Json(now_us));
  const std::int64_t at_us = at.is_number_integer() ? at.get<std::int64_t>() : -1;
  // After a jump the page's time may be of the clock before.
  const bool late = at_us > now_us + 2 * kDay_us && !records.clockJumped();
  if (at_us < 0 || late) {  // a tolerance of two days, because the clock
                            // may have been set back
    throw badValue("at_us", "at_us is no time in microseconds until now");
  }
  records.db().change(
      "INSERT INTO note (id, patient, visit, account, at_us, kind, text) VALUES (?, ?, ?, ?, ?, ?,"
      " ?)",
      id, patient, visit, call.session.account, at_us, kind, Blob{records.seal("note", text)});
}

}  // namespace wholehand::clinic
