#include "clinic/backup.hpp"
#include "clinic/clinic.hpp"
#include "clinic/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

/// Patients: their rows, notes, mistakes, exports.
namespace wholehand::clinic {
namespace {

constexpr std::size_t kLongestCode = 60, kLongestName = 120, kLongestWarnings = 2000;
constexpr std::size_t kLongestNote = 4000, kLongestKind = 20, kMostItems = 20;
constexpr double kShortestHand_m = 0.150, kLongestHand_m = 0.215;
constexpr double kNarrowestHand_m = 0.050, kBroadestHand_m = 0.120;
constexpr double kMostMinutes = 120.0;
constexpr std::int64_t kMinute_us = 60'000'000, kDay_us = 1440 * kMinute_us;
constexpr std::int64_t kBackupsKept_us = 30 * kDay_us;

std::string textOr(const Json& body, const char* key, std::size_t most, bool lines = false) {
  const auto found = body.find(key);
  if (found == body.end() || found->is_null()) return {};
  if (!found->is_string()) throw badValue(key, fmt::format("{} is no text", key));
  std::string text = found->get<std::string>();
  if (!isText(text, most, lines)) {
    throw badValue(key,
                   fmt::format("{} has more than {} characters, or control characters", key, most));
  }
  return text;
}

double numberOf(const Json& value, const std::string& field, double lower, double upper,
                const std::string& unit) {
  const double number =
      value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
  if (!(number >= lower && number <= upper)) {
    throw badValue(field, fmt::format("{} = {}: must be a number in [{}, {}]{}", field,
                                      value.dump(-1, ' ', true, Json::error_handler_t::replace),
                                      lower, upper, unit.empty() ? "" : " " + unit));
  }
  return number;
}

bool isCode(const std::string& code) {
  return !code.empty() && code.size() <= kLongestCode &&
         std::all_of(code.begin(), code.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                  c == '-' || c == '_';
         });
}

Json readHand(const Json& hands, const std::string& side) {
  const std::string field = "hands." + side;
  if (!hands.is_object() || !hands.contains(side) || !hands[side].is_object()) {
    throw badValue(field, "length and breadth of the " + side + " hand are missing");
  }
  const Json& hand = hands[side];
  const double length_m = numberOf(hand.value("length_m", Json()), field + ".length_m",
                                   kShortestHand_m, kLongestHand_m, "m");
  const Json breadth = hand.value("breadth_m", Json());
  if (breadth.is_number() && breadth.get<double>() >= length_m) {
    throw badValue(field + ".breadth_m",
                   fmt::format("{}.breadth_m = {}: is not less than the length, {} m", field,
                               breadth.get<double>(), length_m));
  }
  const double breadth_m =
      numberOf(breadth, field + ".breadth_m", kNarrowestHand_m, kBroadestHand_m, "m");
  return {{"length_m", length_m}, {"breadth_m", breadth_m}};
}

}  // namespace

struct Clinic::PatientData {
  std::string code, side, preset;
  Json hands = Json::object(), secret;
  Parameters parameters;
  Plan plan;
};

Json toJson(const Plan& plan) {
  Json out = Json::array();
  for (const PlanItem& item : plan) {
    out.push_back({{"exercise", item.exercise},
                   {"level", item.level},
                   {"minutes", item.minutes},
                   {"help", item.help},
                   {"parameters", item.parameters}});
  }
  return out;
}

Plan planFrom(const std::string& json) {
  Plan plan;
  for (const Json& item : Json::parse(json)) {
    plan.push_back({item.at("exercise"), item.at("level"), item.at("minutes"), item.at("help"),
                    item.at("parameters").get<Parameters>()});
  }
  return plan;
}

bool isEffortLimit(const std::string& parameter) {
  return parameter.starts_with("effort_limit_");
}

Plan capped(Plan plan, const Parameters& limits) {
  for (PlanItem& item : plan) {
    for (auto& [name, value] : item.parameters) {
      const auto limit = limits.find(name);
      if (isEffortLimit(name) && limit != limits.end()) value = std::min(value, limit->second);
    }
  }
  return plan;
}

// The station's bounds of what it has, else the shipped ones.
Parameters Clinic::readParameters(const Json& values, const std::string& field) const {
  Parameters out;
  if (values.is_null()) return out;
  if (!values.is_object()) throw badValue(field, field + " is no object of names and numbers");
  const StationScene scene = station_.scene();
  for (const auto& [name, value] : values.items()) {
    const std::string key = fmt::format("{}.{}", field, name);
    const auto known = presets_->bounds.find(name);
    if (known == presets_->bounds.end()) throw badValue(field, "an unknown parameter is named");
    const auto heard = scene.bounds.find(name);
    const auto& bounds = heard != scene.bounds.end() ? heard->second : known->second;
    out[name] = numberOf(value, key, bounds[0], bounds[1], {});
  }
  return out;
}

Plan Clinic::readPlan(const Json& items, const std::string& field, const Parameters& limits) const {
  if (!items.is_array() || items.size() > kMostItems) {
    throw badValue(field, fmt::format("{} is no list of at most {} items", field, kMostItems));
  }
  Plan plan;
  for (const Json& row : items) {
    const std::string at = fmt::format("{}[{}]", field, plan.size());
    if (!row.is_object()) throw badValue(at, at + " is no item");
    PlanItem item;
    const Json exercise = row.value("exercise", Json());
    const ExerciseFacts* facts =
        exercise.is_string() ? presets_->exercise(exercise.get<std::string>()) : nullptr;
    if (facts == nullptr) throw badValue(at + ".exercise", at + ".exercise is not one of ours");
    item.exercise = facts->id;
    const double level = numberOf(row.value("level", Json(1)), at + ".level", 1, facts->levels, {});
    if (level != std::floor(level)) throw badValue(at + ".level", at + ".level is no whole number");
    item.level = static_cast<int>(level);
    item.minutes =
        numberOf(row.value("minutes", Json(10)), at + ".minutes", 1, kMostMinutes, "min");
    const Json help = row.value("help", Json("some"));
    if (help != "full" && help != "some" && help != "none") {
      throw badValue(at + ".help", at + ".help must be full, some or none");
    }
    item.help = help;
    item.parameters = readParameters(row.value("parameters", Json()), at + ".parameters");
    for (const auto& [name, value] : item.parameters) {
      const auto has = [&name = name](const std::vector<std::string>& names) {
        return std::find(names.begin(), names.end(), name) != names.end();
      };
      if (!has(presets_->device) && !has(facts->parameters)) {
        throw badValue(fmt::format("{}.parameters.{}", at, name),
                       fmt::format("{} has no parameter {}", item.exercise, name));
      }
      const auto limit = limits.find(name);
      if (!isEffortLimit(name) || limit == limits.end()) continue;
      if (value > limit->second) {
        throw badValue(fmt::format("{}.parameters.{}", at, name),
                       fmt::format("{} = {} is above the person's limit, {}; raise that first",
                                   name, value, limit->second));
      }
    }
    plan.push_back(std::move(item));
  }
  return plan;
}

Clinic::PatientData Clinic::readPatient(const Json& body) const {
  PatientData out;
  const std::string name = textOr(body, "name", kLongestName);
  if (name.find_first_not_of(' ') == std::string::npos) {
    throw badValue("name", "a patient has a name of 1 to 120 characters");
  }
  const auto code = body.find("code");
  if (code != body.end() && code->is_string()) out.code = code->get<std::string>();
  if (!isCode(out.code)) throw badValue("code", "a code has 1 to 60 letters, digits, - and _");
  const std::string born = textOr(body, "born", kLongestName);
  if (!born.empty()) {
    const auto day_us = dayOf(born);
    if (!day_us || born < "1900") throw badValue("born", "born is no day like 1956-03-02");
    // Where it is already tomorrow, a day more.
    if (*day_us > clock_.now_us() + kDay_us) {
      throw badValue("born", "the birth date is in the future");
    }
  }
  out.side = textOr(body, "side", kLongestKind);
  if (out.side != "right" && out.side != "left" && out.side != "both") {
    throw badValue("side", "side must be right, left or both");
  }
  const Json hands = body.value("hands", Json());
  for (const char* side : {"right", "left"}) {
    const bool affected = out.side == side || out.side == "both";
    const bool given = hands.is_object() && hands.contains(side) && !hands[side].is_null();
    if (affected || given) out.hands[side] = readHand(hands, side);
  }
  out.preset = textOr(body, "preset", kLongestKind);
  const ForcePreset* preset = presets_->forceOf(out.preset);
  if (preset == nullptr) throw badValue("preset", "preset is not one of GET /api/presets");
  out.parameters = readParameters(body.value("parameters", Json()), "parameters");
  Parameters limits = out.parameters;
  limits.insert(preset->parameters.begin(), preset->parameters.end());
  out.plan = readPlan(body.value("plan", Json::array()), "plan", limits);
  out.secret = {{"name", name},
                {"born", born},
                {"number", textOr(body, "number", kLongestCode)},
                {"warnings", textOr(body, "warnings", kLongestWarnings, true)}};
  return out;
}

Json Clinic::presets(Call&) {
  Json force = Json::array(), plans = Json::array(), exercises = Json::array();
  for (const ForcePreset& preset : presets_->force) {
    force.push_back({{"id", preset.id}, {"parameters", preset.parameters}});
  }
  for (const PlanPreset& plan : presets_->plans) {
    plans.push_back({{"id", plan.id}, {"items", toJson(plan.items)}});
  }
  for (const ExerciseFacts& facts : presets_->exercises) {
    exercises.push_back(
        {{"id", facts.id}, {"levels", facts.levels}, {"parameters", facts.parameters}});
  }
  Json bounds = presets_->bounds;
  for (const auto& [name, pair] : station_.scene().bounds) {
    if (bounds.contains(name)) bounds[name] = pair;
  }
  return {{"force", force}, {"plans", plans}, {"exercises", exercises}, {"bounds", bounds}};
}

/// @param only a patient's id; 0: all
Json Clinic::patientRows(std::string_view find, std::int64_t only) {
  Json rows = Json::array();
  const std::string wanted = folded(find);
  // Bare columns beside MAX() are those of the last visit.
  Statement query = db_->query(
      "SELECT p.id, p.code, p.side, p.secret,"
      " (SELECT COUNT(*) FROM visit WHERE patient = p.id AND state <> 'no_show'),"
      " v.id, v.state, MAX(v.began_us) FROM patient p"
      " LEFT JOIN visit v ON v.patient = p.id AND v.state <> 'no_show'"
      " WHERE p.id = ?1 OR ?1 = 0 GROUP BY p.id ORDER BY MAX(v.began_us) DESC, p.id DESC",
      only);
  while (query.step()) {
    const std::string code = query.text(1);
    const Json secret = Json::parse(unseal("patient", query.text(3)));
    const std::string name = secret.at("name");
    if (folded(name).find(wanted) == std::string::npos &&
        folded(code).find(wanted) == std::string::npos) {
      continue;
    }
    const std::string state = query.text(6);
    const bool shown = state == "open" || state == "unfinished";
    rows.push_back({{"id", query.integer(0)},
                    {"code", code},
                    {"name", name},
                    {"side", query.text(2)},
                    {"visits", query.integer(4)},
                    {"last_visit_us", query.integer(7)},
                    {"state", shown ? state : ""},
                    {"visit", shown ? query.integer(5) : 0}});
  }
  return rows;
}

Json Clinic::patients(Call& call) {
  Json all = patientRows(call.request.find, 0), open = Json::array(), guests = Json::array();
  for (const Json& row : all) {
    if (!row["state"].get_ref<const std::string&>().empty()) open.push_back(row);
  }
  Statement query = db_->query(
      "SELECT id FROM visit WHERE state = 'guest' AND patient IS NULL ORDER BY began_us");
  while (query.step()) guests.push_back(visitJson(query.integer(0), false));
  return {{"open", open}, {"patients", all}, {"guests", guests}};
}

Json Clinic::proposeCode(Call&) {
  std::int64_t n = db_->number("SELECT MAX(id) FROM patient") + 1;
  while (db_->number("SELECT COUNT(*) FROM patient WHERE code = ?", fmt::format("P-{:03}", n)) !=
         0) {
    ++n;
  }
  return {{"code", fmt::format("P-{:03}", n)}};
}

Json Clinic::addPatient(Call& call) {
  const PatientData data = readPatient(call.body);
  if (db_->number("SELECT COUNT(*) FROM patient WHERE code = ?", data.code) != 0) {
    throw Refused{409, "code_exists", "another patient has the code " + data.code, "code"};
  }
  const std::int64_t now_us = clock_.now_us();
  db_->change(
      "INSERT INTO patient (mark, version, code, side, hands, preset, parameters, plan, plan_us,"
      " created_us, secret) VALUES (?, 1, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
      randomHex(16), data.code, data.side, data.hands.dump(), data.preset,
      Json(data.parameters).dump(), toJson(data.plan).dump(), now_us, now_us,
      Blob{seal("patient", data.secret.dump())});
  const std::int64_t id = db_->lastId();
  log(call.session.account, "added", id);
  return patientJson(id);
}

void Clinic::checkPatient(std::int64_t id) {
  if (db_->number("SELECT COUNT(*) FROM patient WHERE id = ?", id) == 0) {
    throw notFound(fmt::format("there is no patient {}", id));
  }
}

void Clinic::checkNoOpenVisit(std::int64_t patient) {
  const std::int64_t visit =
      db_->number("SELECT id FROM visit WHERE patient = ? AND state = 'open'", patient);
  if (visit != 0) {
    throw Refused{409, "visit_open", "a visit of this patient is open; finish it first", {}};
  }
}

Json Clinic::changePatient(Call& call) {
  const std::int64_t id = call.ids.at(0);
  checkPatient(id);
  const Json version = call.body.value("version", Json());
  Statement row = db_->query("SELECT version, plan FROM patient WHERE id = ?", id);
  row.step();
  if (!version.is_number_integer() || version.get<std::int64_t>() != row.integer(0)) {
    throw Refused{409,
                  "changed",
                  "the patient was changed meanwhile; both texts are shown",
                  {},
                  {{"now", patientJson(id)}}};
  }
  const PatientData data = readPatient(call.body);
  if (db_->number("SELECT COUNT(*) FROM patient WHERE code = ? AND id <> ?", data.code, id) != 0) {
    throw Refused{409, "code_exists", "another patient has the code " + data.code, "code"};
  }
  const std::string plan = toJson(data.plan).dump();
  if (plan != row.text(1)) {
    db_->change("UPDATE patient SET plan = ?, plan_us = ? WHERE id = ?", plan, clock_.now_us(), id);
  }
  db_->change(
      "UPDATE patient SET version = version + 1, code = ?, side = ?, hands = ?, preset = ?,"
      " parameters = ?, secret = ? WHERE id = ?",
      data.code, data.side, data.hands.dump(), data.preset, Json(data.parameters).dump(),
      Blob{seal("patient", data.secret.dump())}, id);
  log(call.session.account, "changed", id);
  return patientJson(id);
}

Json Clinic::patient(Call& call) {
  const std::int64_t id = call.ids.at(0);
  Json out = patientJson(id);
  logOpened(call, id);
  return out;
}

void Clinic::logOpened(const Call& call, std::int64_t patient) {
  Session& session = sessions_[call.session_id];
  if (session.opened_patient != patient && tryToLog(call.session.account, "opened", patient)) {
    session.opened_patient = patient;
  }
}

Json Clinic::notesOf(const char* column, std::int64_t id, bool hidden) {
  Json notes = Json::array();
  Statement rows = db_->query(
      fmt::format("SELECT id, visit, at_us, account, kind, text FROM note WHERE {} = ? ORDER BY "
                  "at_us, id",
                  column),
      id);
  while (rows.step()) {
    notes.push_back({{"id", rows.integer(0)},
                     {"visit", rows.integer(1)},
                     {"at_us", rows.integer(2)},
                     {"account", rows.integer(3)},
                     {"kind", rows.text(4)},
                     {"text", hidden ? "" : unseal("note", rows.text(5))}});
  }
  return notes;
}

namespace {

void addPoint(Json& curves, const std::string& name, const std::string& exercise,
              const std::string& unit, std::int64_t at_us, double value) {
  for (Json& curve : curves) {
    if (curve["name"] != name || curve["exercise"] != exercise) continue;
    Json& points = curve["points"];
    if (points.back()[0] == at_us) points.erase(points.size() - 1);  // a visit's last trial counts
    points.push_back({at_us, value});
    return;
  }
  curves.push_back({{"name", name},
                    {"exercise", exercise},
                    {"unit", unit},
                    {"points", Json::array({Json::array({at_us, value})})}});
}

/// Over visits, the oldest first: active minutes, and each result of each exercise's panel.
Json curvesOf(const Json& visits) {
  Json curves = Json::array();
  for (auto visit = visits.rbegin(); visit != visits.rend(); ++visit) {
    double active_s = 0.0;
    bool measured = false;
    const std::int64_t at_us = (*visit)["began_us"];
    for (const Json& trial : (*visit)["trials"]) {
      if (trial["state"] != "measured") continue;
      measured = true;
      if (trial["active_s"].is_number()) active_s += trial["active_s"].get<double>();
    }
    if (measured) addPoint(curves, "active_min", "", "min", at_us, active_s / 60.0);
    for (const Json& trial : (*visit)["trials"]) {
      if (trial["state"] != "measured") continue;
      for (const Json& result : trial["results"]) {
        if (!result["value"].is_number()) continue;
        addPoint(curves, result["name"], trial["exercise"], result["unit"], at_us, result["value"]);
      }
    }
  }
  return curves;
}

}  // namespace

Json Clinic::patientJson(std::int64_t id) {
  Statement row = db_->query(
      "SELECT version, code, side, hands, preset, parameters, plan, plan_us, secret FROM patient"
      " WHERE id = ?",
      id);
  if (!row.step()) throw notFound(fmt::format("there is no patient {}", id));
  Json out = Json::parse(unseal("patient", row.text(8)));
  out["id"] = id;
  out["version"] = row.integer(0);
  out["code"] = row.text(1);
  out["side"] = row.text(2);
  out["hands"] = Json::parse(row.text(3));
  out["preset"] = row.text(4);
  out["parameters"] = Json::parse(row.text(5));
  out["plan"] = Json::parse(row.text(6));
  Json visits = Json::array();
  Json today = out["plan"];
  bool found_last = false;
  Statement rows = db_->query(
      "SELECT id, began_us, plan FROM visit WHERE patient = ? ORDER BY began_us DESC, id "
      "DESC",
      id);
  while (rows.step()) {
    visits.push_back(visitJson(rows.integer(0), false));
    // The last visit's items, unless the plan was changed since. A no-show has none.
    const Plan items = planFrom(rows.text(2));
    if (found_last || items.empty()) continue;
    found_last = true;
    if (rows.integer(1) < row.integer(7)) continue;
    const bool offered = presets_->forceOf(row.text(4)) != nullptr;
    today = toJson(offered ? capped(items, limitsOf(id)) : items);
  }
  out["curves"] = curvesOf(visits);
  out["visits"] = std::move(visits);
  out["notes"] = notesOf("patient", id, false);
  out["today"] = std::move(today);
  return out;
}

Json Clinic::deletePatient(Call& call) {
  const std::int64_t id = call.ids.at(0);
  checkPatient(id);
  if (db_->number("SELECT COUNT(*) FROM visit WHERE patient = ?", id) != 0) {
    throw Refused{409,
                  "changed",
                  "the patient has visits: move them, or erase the patient",
                  {},
                  {{"now", patientJson(id)}}};
  }
  db_->change("DELETE FROM patient WHERE id = ?", id);
  db_->run("DELETE FROM answer");
  log(call.session.account, "deleted", id);
  return Json::object();
}

Json Clinic::mergePatients(Call& call) {
  const std::int64_t id = call.ids.at(0);
  const Json from = call.body.value("from", Json());
  if (!from.is_number_integer() || from == id) throw badValue("from", "from is no other patient");
  const auto other = from.get<std::int64_t>();
  checkPatient(id);
  checkPatient(other);
  checkNoOpenVisit(other);
  // What the other's visits have changed is not this row's to give back.
  db_->change("UPDATE visit SET patient = ?, before = '{}' WHERE patient = ?", id, other);
  db_->change("UPDATE note SET patient = ? WHERE patient = ?", id, other);
  db_->change("UPDATE patient SET version = version + 1 WHERE id = ?", id);
  db_->change("DELETE FROM patient WHERE id = ?", other);
  log(call.session.account, "merged", id, 0, fmt::format("from {}", other));
  return patientJson(id);
}

Json Clinic::erasePatient(Call& call) {
  const std::int64_t id = call.ids.at(0);
  Statement row = db_->query("SELECT mark, code FROM patient WHERE id = ?", id);
  if (!row.step()) throw notFound(fmt::format("there is no patient {}", id));
  if (call.body.value("code", Json()) != row.text(1)) {
    throw badValue("code", "type the patient's code to erase everything of this person");
  }
  checkNoOpenVisit(id);
  listErased(options_.folder, options_.backups, row.text(0));
  const ErasedFiles files = eraseRows(*db_, id);
  log(call.session.account, "erased", id);
  call.after.emplace_back([this, &call, files] {
    const auto left = removeFiles(options_.folder, options_.recordings, files);
    compact_due_ = true;
    tryToCompact();
    const std::int64_t gone_us = last_backup_us_ == 0 ? 0 : last_backup_us_ + kBackupsKept_us;
    call.answer.body =
        Json({{"erased", true}, {"recordings_left", left}, {"gone_from_backups_us", gone_us}})
            .dump();
  });
  return {{"erased", true}};
}

Json Clinic::noShow(Call& call) {
  const std::int64_t id = call.ids.at(0);
  checkPatient(id);
  const std::int64_t now_us = clock_.now_us();
  const Json at = call.body.value("at_us", Json(now_us));
  const std::int64_t at_us = at.is_number_integer() ? at.get<std::int64_t>() : -1;
  if (at_us < 0 || at_us > now_us + kDay_us) {
    throw badValue("at_us", "at_us is no time in microseconds until now");
  }
  const std::int64_t visit = insertVisit(id, call.session.account, "", at_us, at_us, "no_show");
  log(call.session.account, "noted a no-show", id, visit);
  return visitJson(visit, false);
}

void Clinic::insertNote(Call& call, std::optional<std::int64_t> patient,
                        std::optional<std::int64_t> visit, std::optional<std::int64_t> id) {
  const std::string text = textOr(call.body, "text", kLongestNote, true);
  const std::string kind =
      call.body.contains("kind") ? textOr(call.body, "kind", kLongestKind) : std::string("text");
  const bool word = !kind.empty() && std::all_of(kind.begin(), kind.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || c == '_';
  });
  if (!word) throw badValue("kind", "kind is a word of at most 20 small letters and _");
  if (kind == "text" && text.empty()) throw badValue("text", "the note is empty");
  const std::int64_t now_us = clock_.now_us();
  const Json at = call.body.value("at_us", Json(now_us));
  const std::int64_t at_us = at.is_number_integer() ? at.get<std::int64_t>() : -1;
  if (at_us < 0 || at_us > now_us + 2 * kDay_us) {  // the clock may have been set back meanwhile
    throw badValue("at_us", "at_us is no time in microseconds until now");
  }
  db_->change(
      "INSERT INTO note (id, patient, visit, account, at_us, kind, text) VALUES (?, ?, ?, ?, ?, ?,"
      " ?)",
      id, patient, visit, call.session.account, at_us, kind, Blob{seal("note", text)});
}

Json Clinic::notePatient(Call& call) {
  const std::int64_t id = call.ids.at(0);
  checkPatient(id);
  insertNote(call, id, {});
  log(call.session.account, "wrote a note", id);
  return patientJson(id);
}

std::string csvOf(Database& db, std::int64_t patient) {
  std::string out =
      "code,visit,began,state,side,pain_before,pain_after,item,exercise,level,recording,measure,"
      "value,unit\r\n";
  Statement rows = db.query(
      "SELECT p.code, v.id, v.began_us, v.offset_min, v.state, v.side, v.pain_before, v.pain_after,"
      " t.item, t.recording, t.measures FROM visit v JOIN patient p ON p.id = v.patient"
      " LEFT JOIN trial t ON t.visit = v.id AND t.state = 'measured'"
      " WHERE p.id = ?1 OR ?1 = 0 ORDER BY p.code, v.began_us, v.id, t.began_us, t.id",
      patient);
  while (rows.step()) {
    const auto pain = [&](int column) {
      return rows.isNull(column) ? std::string{} : std::to_string(rows.integer(column));
    };
    const std::string visit =
        fmt::format("{},{},{},{},{},{},{}", csvCell(rows.text(0)), rows.integer(1),
                    isoTime(rows.integer(2), static_cast<int>(rows.integer(3))), rows.text(4),
                    rows.text(5), pain(6), pain(7));
    if (rows.isNull(9)) {
      out += visit + ",,,,,,,\r\n";
      continue;
    }
    const Json m = Json::parse(rows.text(10));
    const std::string exercise = m.value("exercise", Json("")).get<std::string>();
    const std::string trial =
        fmt::format("{},{},{},{},{}", visit, rows.integer(8), csvCell(exercise),
                    m.value("level", Json(0)).dump(), csvCell(rows.text(9)));
    const auto line = [&](const std::string& name, const Json& value, const std::string& unit) {
      if (!value.is_number()) return;
      const std::string number = value.dump();  // may begin with -: a number, and stays one
      out += fmt::format("{},{},{},{}\r\n", trial, csvCell(name), number, csvCell(unit));
    };
    for (const Json& result : m.value("results", Json::array())) {
      line(result.value("name", ""), result.value("value", Json()), result.value("unit", ""));
    }
    line("active", m.value("active_s", Json()), "s");
    line("helped_share", m.value("helped_share", Json()), "");
    line("peak_speed", m.value("peak_speed_m_s", Json()), "m/s");
    line("path_ratio", m.value("path_ratio", Json()), "");
    line("reach", m.value("reach_s", Json()), "s");
  }
  return out;
}

Json Clinic::exportPatient(Call& call) {
  const std::int64_t id = call.ids.at(0);
  checkPatient(id);
  Statement row = db_->query("SELECT code FROM patient WHERE id = ?", id);
  row.step();
  begin(call);
  log(call.session.account, "exported", id);
  call.answer.type = "text/csv; charset=utf-8";
  call.answer.file = "patient-" + row.text(0) + ".csv";
  call.answer.body = csvOf(*db_, id);
  return {};
}

Json Clinic::exportAll(Call& call) {
  begin(call);
  log(call.session.account, "exported all");
  call.answer.type = "text/csv; charset=utf-8";
  call.answer.file = "patients.csv";
  call.answer.body = csvOf(*db_, 0);
  return {};
}

}  // namespace wholehand::clinic
