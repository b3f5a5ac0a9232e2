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
  throw refusal(409, "damaged",
                name +
                    ": its row in clinic.db is damaged: restore a backup; until then train"
                    " under the gentle preset, and confirm hand and side");
}

VisitRow visitRow(Database& db, std::int64_t id) {
  Statement row = db.query("SELECT * FROM visit WHERE id = ?", id);
  if (!row.step()) throw notFound(fmt::format("there is no visit {}", id));
  refuseDamaged(db, "visit", id, fmt::format("visit {}", id));
  return rowJson(row, 0, {"plan", "in_force", "changed", "before"});
}

std::int64_t insertVisit(Records& records, VisitRow visit) {
  Database& db = records.db();
  if (visit.id == 0) visit.id = takeVisitNumber(db);
  visit.offset_min = records.clock().offset_min(visit.began_us);
  Json columns = visit;
  columns["began_n"] = changesIn(db) + 1;
  insertRow(db, "visit", columns);
  return visit.id;
}

void insertRow(Database& db, const char* table, const Json& columns) {
  std::string names, places;
  for (const auto& [name, value] : columns.items()) {
    names += (names.empty() ? "" : ", ") + name;
    places += places.empty() ? "?" : ", ?";
  }
  Statement row = db.query(fmt::format("INSERT INTO {} ({}) VALUES ({})", table, names, places));
  int at = -1;
  for (const Json& value : columns) {
    ++at;
    if (value.is_null()) continue;  // as a parameter without a value
    if (value.is_number_integer()) {
      row.bind(at, value.get<std::int64_t>());
    } else {
      row.bind(at, value.is_string() ? value.get<std::string>() : value.dump());
    }
  }
  row.step();
}

Json rowJson(const Statement& row, int from, std::initializer_list<const char*> parsed) {
  Json out = Json::object();
  for (int column = from; column < row.columns(); ++column) {
    Json& value = out[row.name(column)];
    if (row.isInteger(column)) {
      value = row.integer(column);
    } else if (!row.isNull(column)) {
      value = row.text(column);
    }
  }
  for (const char* name : parsed) out[name] = Json::parse(out[name].get<std::string>());
  return out;
}

std::string trialColumns(Database& db) {
  return "SELECT " + soundness(db, "trial", "trial") +
         ", measures, id, item, recording, began_us, state, why FROM trial";
}

Json trialsIn(Statement rows, const Plan& plan) {
  Json trials = Json::array();
  while (rows.step()) {
    // What is measured in a trial, and what stands for it where it was not.
    Json& trial = trials.emplace_back(Json{{"active_s", nullptr},
                                           {"helped_s", nullptr},
                                           {"led_s", nullptr},
                                           {"helped_share", nullptr},
                                           {"results", Json::array()},
                                           {"peak_speed_m_s", nullptr},
                                           {"path_ratio", nullptr},
                                           {"reach_s", nullptr},
                                           {"ended_by", ""}});
    Json m = Json::object();
    const bool sound = rows.integer(0) != 0;
    if (sound) m = Json::parse(rows.text(1));
    for (auto& [key, value] : trial.items()) value = m.value(key, value);
    Json row = rowJson(rows, 2);
    if (!sound) {
      const std::int64_t id = row["id"];
      row = {{"id", id}, {"item", 0}, {"recording", ""}, {"began_us", 0}, {"state", "failed"}};
      row["why"] = fmt::format(
          "row {} of trial in clinic.db is damaged: end the program and run wholehand-clinic "
          "rebuild",
          id);
    }
    const std::size_t item = row["item"];
    const bool planned = sound && item < plan.size();
    trial.update(row);
    trial["exercise"] = m.value("exercise", Json(planned ? plan[item].exercise : ""));
    trial["level"] = m.value("level", Json(planned ? plan[item].level : 0));
    trial["duration_s"] = m.value("recording", Json::object()).value("duration_s", Json());
    trial["side"] = sideOfHand(m);
  }
  return trials;
}

Json notesOf(Records& records, const char* column, std::int64_t id, bool hidden) {
  Json notes = Json::array();
  Statement rows = records.db().query(
      fmt::format("SELECT {}, text, id, COALESCE(visit, 0) AS visit, at_us, account, kind FROM note"
                  " WHERE {} = ? ORDER BY at_us, id",
                  soundness(records.db(), "note", "note"), column),
      id);
  while (rows.step()) {
    Json& note = notes.emplace_back(rowJson(rows, 2));
    if (rows.integer(0) == 0) {
      note.update({{"visit", 0}, {"at_us", 0}, {"account", 0}, {"kind", "text"}});
      note["text"] = fmt::format("note {}: its row in clinic.db is damaged: restore a backup",
                                 note["id"].get<std::int64_t>());
    } else {
      note["text"] = hidden ? "" : records.unseal("note", rows.text(1));
    }
  }
  return notes;
}

namespace {

Json listed(const VisitRow& visit) {
  Json out = visit;
  for (const char* name : {"hand_file", "in_force", "before"}) out.erase(name);
  out["hand"] = visit.hand.empty() ? visit.hand_file : visit.hand;
  out["next_item"] = visit.item + 1;
  return out;
}

}  // namespace

Json visitJson(Records& records, std::int64_t id, bool hidden) {
  const VisitRow visit = visitRow(records.db(), id);
  Json out = listed(visit);
  const std::string of_visit =
      trialColumns(records.db()) + " WHERE visit = ? ORDER BY began_us, id";
  out["trials"] = trialsIn(records.db().query(of_visit, id), visit.plan);
  out["notes"] = notesOf(records, "visit", id, hidden);
  return out;
}

Json listedVisit(Records& records, std::int64_t id) {
  if (isSound(records.db(), "visit", id)) return visitJson(records, id, false);
  VisitRow damaged;
  damaged.id = id;
  damaged.state = "damaged";
  Json out = listed(damaged);
  out["next_item"] = 0;
  out["trials"] = out["notes"] = Json::array();
  return out;
}

void takeBackSettings(Database& db, const VisitRow& visit) {
  if (!visit.patient || visit.before.empty()) return;
  Json own = Json::parse(db.text("SELECT parameters FROM patient WHERE id = ?", *visit.patient));
  for (const auto& [name, value] : visit.before.items()) {
    if (own.value(name, Json()) != visit.changed.at(name)) continue;
    own[name] = value;
    if (value.is_null()) own.erase(name);
  }
  db.change("UPDATE patient SET parameters = ?, version = version + 1 WHERE id = ?", own.dump(),
            *visit.patient);
}

void insertWaitingTrial(Database& db, const std::string& recording, std::int64_t visit,
                        std::int64_t item, std::int64_t began_us, const std::string& sha256) {
  insertRow(db, "trial",
            {{"recording", recording},
             {"size", 0},
             {"modified_ns", 0},
             {"state", "waiting"},
             {"why", ""},
             {"visit", visit},
             {"item", item},
             {"began_us", began_us},
             {"sha256", sha256},
             {"measures_version", 0},
             {"measures", "{}"}});
}

void writeLog(Database& db, std::int64_t at_us, std::int64_t account, const std::string& what,
              std::int64_t patient, std::int64_t visit, const std::string& detail) {
  insertRow(db, "log",
            {{"at_us", at_us},
             {"account", account},
             {"what", what},
             {"patient", patient},
             {"visit", visit},
             {"detail", detail}});
}

std::int64_t takeVisitNumber(Database& db) {
  db.run("UPDATE clinic SET next_visit = next_visit + 1");
  return db.number("SELECT next_visit - 1 FROM clinic");
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
