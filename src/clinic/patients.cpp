#include "clinic/patients.hpp"

#include "clinic/limits.hpp"
#include "clinic/row_digests.hpp"
#include "clinic/rows.hpp"
#include "clinic/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

namespace wholehand::clinic {
namespace {

constexpr std::size_t kLongestCode = 60, kLongestName = 120, kLongestWarnings = 2000;
constexpr std::size_t kLongestKind = 20;
constexpr double kShortestHand_m = 0.150, kLongestHand_m = 0.215;
constexpr double kNarrowestHand_m = 0.050, kBroadestHand_m = 0.120;

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
  Json out{{"length_m", length_m}, {"breadth_m", breadth_m}};
  if (hand.contains("limits")) out["limits"] = readLimits(hand["limits"], field + ".limits");
  return out;
}

}  // namespace

struct Patients::Data {
  std::string code, side, preset;
  Json hands = Json::object(), secret;
  Parameters parameters;
  Plan plan;
};

Patients::Data Patients::read(const Json& body) const {
  Data out;
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
    // A day of tolerance covers time zones where the next day has already begun.
    if (*day_us > records_.clock().now_us() + kDay_us) {
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
  const ForcePreset* preset = records_.presets().forceOf(out.preset);
  if (preset == nullptr) throw badValue("preset", "preset is not one of GET /api/presets");
  out.parameters = plans_.readParameters(body.value("parameters", Json()), "parameters");
  Parameters settings = out.parameters;
  settings.insert(preset->parameters.begin(), preset->parameters.end());
  out.plan =
      plans_.readPlan(body.value("plan", Json::array()), "plan", plans_.limitsAmong(settings));
  out.secret = {{"name", name},
                {"born", born},
                {"number", textOr(body, "number", kLongestCode)},
                {"warnings", textOr(body, "warnings", kLongestWarnings, true)}};
  return out;
}

namespace {

/// What a restore left to people; null: nothing.
Json restored(Database& db) {
  Statement row = db.query("SELECT restored FROM clinic");
  Json out = row.step() ? Json::parse(row.text(0)) : Json::object();
  const bool whole = out.value("until_us", std::int64_t{0}) >= out.value("at_us", std::int64_t{0});
  return whole && out.value("again", Json::array()).empty() ? Json() : out;
}

}  // namespace

Json Patients::forgetRestored(Call& call) {
  records_.db().run("UPDATE clinic SET restored = '{}'");
  records_.log(call.session.account, "did again what a restore had undone");
  return Json::object();
}

/// The last changes, which a damaged write-ahead log lost, were made again where they matter.
Json Patients::forgetLost(Call& call) {
  confirmLostChanges(records_.db());
  records_.log(call.session.account, "confirmed lost changes");
  return Json::object();
}

/// The clock is right, whatever it did: what is old may be deleted again.
Json Patients::confirmClock(Call& call) {
  records_.confirmClock();
  records_.log(call.session.account, "confirmed the clock");
  return Json::object();
}

Json Patients::list(Call& call) {
  Json out = index_.page(call.request.find, call.request.page), guests = Json::array();
  for (const std::int64_t visit : records_.db().all<std::int64_t>(
           "SELECT id FROM visit WHERE state = 'guest' AND patient IS NULL ORDER BY began_us")) {
    guests.push_back(listedVisit(records_, visit));
  }
  out["guests"] = std::move(guests);
  out["under_way"] = records_.underWay();
  out["damaged"] = records_.damaged();
  out["clock_jumped_us"] = clockJump(records_.db());
  out["lost"] = lostChanges(records_.db());
  out["restored"] = restored(records_.db());
  return out;
}

Json Patients::proposeCode(Call&) {
  std::int64_t n = records_.db().number("SELECT MAX(id) FROM patient") + 1;
  while (records_.db().number("SELECT COUNT(*) FROM patient WHERE code = ?",
                              fmt::format("P-{:03}", n)) != 0) {
    ++n;
  }
  return {{"code", fmt::format("P-{:03}", n)}};
}

Json Patients::add(Call& call) {
  const Data data = read(call.body);
  if (records_.db().number("SELECT COUNT(*) FROM patient WHERE code = ?", data.code) != 0) {
    throw RequestRefusal{409, "code_exists", "another patient has the code " + data.code, "code"};
  }
  const std::int64_t now_us = records_.clock().now_us();
  records_.db().change(
      "INSERT INTO patient (mark, version, code, side, hands, preset, parameters, plan, plan_n,"
      " created_us, secret) VALUES (?, 1, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
      randomHex(16), data.code, data.side, data.hands.dump(), data.preset,
      Json(data.parameters).dump(), Json(data.plan).dump(), changesIn(records_.db()) + 1, now_us,
      Blob{records_.seal("patient", data.secret.dump())});
  const std::int64_t id = records_.db().lastId();
  records_.log(call.session.account, "added", id);
  return toJson(id);
}

void Patients::check(std::int64_t id) {
  if (records_.db().number("SELECT COUNT(*) FROM patient WHERE id = ?", id) == 0) {
    throw notFound(fmt::format("there is no patient {}", id));
  }
}

std::int64_t Patients::named(const Json& body) {
  const std::int64_t id = integerOf(body, "patient", "patient is no number of a patient");
  check(id);
  return id;
}

void Patients::checkNoOpenVisit(std::int64_t patient) {
  const std::int64_t visit =
      records_.db().number("SELECT id FROM visit WHERE patient = ? AND state = 'open'", patient);
  if (visit != 0) {
    throw RequestRefusal{409, "visit_open", "a visit of this patient is open; finish it first", {}};
  }
}

Json Patients::change(Call& call) {
  const std::int64_t id = call.ids.at(0);
  check(id);
  const Json version = call.body.value("version", Json());
  if (!version.is_number_integer() ||
      version != records_.db().number("SELECT version FROM patient WHERE id = ?", id)) {
    throw changedMeanwhile("the patient was changed meanwhile; both texts are shown", toJson(id));
  }
  store(id, read(call.body));
  records_.log(call.session.account, "changed", id);
  return toJson(id);
}

void Patients::store(std::int64_t id, const Data& data) {
  Database& db = records_.db();
  if (db.number("SELECT COUNT(*) FROM patient WHERE code = ? AND id <> ?", data.code, id) != 0) {
    throw RequestRefusal{409, "code_exists", "another patient has the code " + data.code, "code"};
  }
  const std::string plan = Json(data.plan).dump();
  db.change("UPDATE patient SET plan = ?1, plan_n = ?2 WHERE id = ?3 AND plan <> ?1", plan,
            changesIn(db) + 1, id);
  db.change(
      "UPDATE patient SET version = version + 1, code = ?, side = ?, hands = ?, preset = ?,"
      " parameters = ?, secret = ? WHERE id = ?",
      data.code, data.side, data.hands.dump(), data.preset, Json(data.parameters).dump(),
      Blob{records_.seal("patient", data.secret.dump())}, id);
}

Json Patients::signAgain(Call& call) {
  const std::int64_t id = call.ids.at(0);
  check(id);
  if (isSound(records_.db(), "patient", id)) {
    throw changedMeanwhile("the patient's row is sound", toJson(id));
  }
  if (call.body.value("confirmed", Json()) != true) {
    throw badValue("confirmed", "look at the person's hand, and confirm its side and size");
  }
  const Data data = read(call.body);
  const SignAgain again(records_.db(), id);
  store(id, data);
  // If the mark is what was damaged, an erasure has to find the person in copies by the right one.
  Statement row = records_.db().query("SELECT created_us, mark FROM patient WHERE id = ?", id);
  row.step();
  for (const std::string& mark : marksInCopies(records_.places(), id, row.integer(0))) {
    if (mark == row.text(1)) continue;
    records_.db().change("INSERT OR IGNORE INTO merged (patient, mark) VALUES (?, ?)", id, mark);
  }
  records_.forgetDamaged(fmt::format("patient {}", id));
  records_.log(call.session.account, "signed a damaged patient again", id);
  return toJson(id);
}

Json Patients::show(Call& call) {
  const std::int64_t id = call.ids.at(0);
  Json out = toJson(id);
  accounts_.logOpened(call, id);
  return out;
}

namespace {

void addPoint(Json& curves, const std::string& name, const std::string& exercise,
              const std::string& unit, std::int64_t at_us, double value) {
  for (Json& curve : curves) {
    if (curve["name"] != name || curve["exercise"] != exercise) continue;
    Json& points = curve["points"];
    if (points.back()[0] == at_us)
      points.erase(points.size() - 1);  // a later trial of the same
                                        // visit replaces the point
    points.push_back({at_us, value});
    return;
  }
  curves.push_back({{"name", name},
                    {"exercise", exercise},
                    {"unit", unit},
                    {"points", Json::array({Json::array({at_us, value})})}});
}

/// Curves over the visits, from the oldest: active minutes, and each result of each exercise's
/// panel.
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

Json Patients::toJson(std::int64_t id) {
  Statement row = records_.db().query(
      "SELECT plan_n, secret, id, version, code, side, hands, preset, parameters, plan FROM patient"
      " WHERE id = ?",
      id);
  if (!row.step()) throw notFound(fmt::format("there is no patient {}", id));
  refuseDamaged(records_.db(), "patient", id, fmt::format("patient {}", id));
  Json out = Json::parse(records_.unseal("patient", row.text(1)));
  out.update(rowJson(row, 2, {"hands", "parameters", "plan"}));
  Json visits = Json::array();
  Json today = out["plan"];
  bool found_last = false;
  Statement rows = records_.db().query(
      "SELECT id, began_n, plan FROM visit WHERE patient = ? ORDER BY began_n DESC", id);
  while (rows.step()) {
    visits.push_back(listedVisit(records_, rows.integer(0)));
    if (visits.back()["state"] == "damaged") continue;
    // Offers the items of the last visit, unless the plan was changed since. A visit that was
    // missed has no items.
    const Plan items = Json::parse(rows.text(2));
    if (found_last || items.empty()) continue;
    found_last = true;
    if (rows.integer(1) < row.integer(0)) continue;
    const bool offered = records_.presets().forceOf(out["preset"]) != nullptr;
    today = Json(offered ? capped(items, plans_.limitsOf(id)) : items);
  }
  out["curves"] = curvesOf(visits);
  out["visits"] = std::move(visits);
  out["notes"] = notesOf(records_, "patient", id, false);
  out["today"] = std::move(today);
  return out;
}

Json Patients::remove(Call& call) {
  const std::int64_t id = call.ids.at(0);
  check(id);
  if (records_.db().number("SELECT COUNT(*) FROM visit WHERE patient = ?", id) != 0) {
    throw changedMeanwhile("the patient has visits: move them, or erase the patient", toJson(id));
  }
  records_.storeIntent("delete", erasureOfPatient(records_.db(), id));
  records_.log(call.session.account, "deleted", id);
  call.after.emplace_back([this] { (void)records_.removeErased(); });
  return Json::object();
}

Json Patients::merge(Call& call) {
  const std::int64_t id = call.ids.at(0);
  const std::int64_t other = integerOf(call.body, "from", "from is no other patient");
  if (other == id) throw badValue("from", "from is no other patient");
  check(id);
  check(other);
  checkNoOpenVisit(other);
  // The moved visits forget the values of the other patient, so that they cannot be restored in
  // this one.
  records_.db().change("UPDATE visit SET patient = ?, before = '{}' WHERE patient = ?", id, other);
  records_.db().change("UPDATE note SET patient = ? WHERE patient = ?", id, other);
  records_.db().change("UPDATE patient SET version = version + 1 WHERE id = ?", id);
  // The mark is kept, so that erasing this patient also erases the other one in older backups.
  records_.db().change(
      "INSERT INTO merged (patient, mark) SELECT ?, mark FROM patient WHERE id = ?", id, other);
  records_.db().change("UPDATE merged SET patient = ? WHERE patient = ?", id, other);
  records_.storeIntent("list",
                       {{fmt::format("joined {} {} {}", nextCount(records_.db()),
                                     markOf(records_.db(), other), markOf(records_.db(), id))},
                        {}});
  records_.db().change("DELETE FROM patient WHERE id = ?", other);
  records_.log(call.session.account, "merged", id, 0, fmt::format("from {}", other));
  return toJson(id);
}

Json Patients::erase(Call& call) {
  const std::int64_t id = call.ids.at(0);
  Statement row = records_.db().query("SELECT code FROM patient WHERE id = ?", id);
  if (!row.step()) throw notFound(fmt::format("there is no patient {}", id));
  if (call.body.value("code", Json()) != row.text(0)) {
    throw badValue("code", "type the patient's code to erase everything of this person");
  }
  checkNoOpenVisit(id);
  records_.storeIntent("erase", erasureOfPatient(records_.db(), id));
  records_.log(call.session.account, "erased", id);
  // Backups follow in Clinic::carryOut().
  call.after.emplace_back([this, &call] {
    const auto left = records_.removeErased();
    call.answer.body = Json({{"erased", true}, {"recordings_left", left}}).dump();
  });
  return {{"erased", true}};
}

Json Patients::noShow(Call& call) {
  const std::int64_t id = call.ids.at(0);
  check(id);
  const std::int64_t now_us = records_.clock().now_us();
  const Json at = call.body.value("at_us", Json(now_us));
  const std::int64_t at_us = at.is_number_integer() ? at.get<std::int64_t>() : -1;
  if (at_us < 0 || at_us > now_us + kDay_us) {
    throw badValue("at_us", "at_us is no time in microseconds until now");
  }
  VisitRow missed;
  missed.patient = id;
  missed.account = call.session.account;
  missed.began_us = missed.ended_us = at_us;
  missed.state = "no_show";
  const std::int64_t visit = insertVisit(records_, missed);
  records_.log(call.session.account, "noted a no-show", id, visit);
  return visitJson(records_, visit, false);
}

Json Patients::note(Call& call) {
  const std::int64_t id = call.ids.at(0);
  check(id);
  insertNote(records_, call, id, {});
  records_.log(call.session.account, "wrote a note", id);
  return toJson(id);
}

std::string csvOf(Database& db, std::int64_t patient, ExportProgress* progress) {
  std::string out =
      "code,visit,began,state,side,pain_before,pain_after,item,exercise,level,recording,measure,"
      "value,unit\r\n";
  Statement rows = db.query(
      fmt::format(
          "SELECT p.code, v.id, v.began_us, v.offset_min, v.state, v.side, v.pain_before,"
          " v.pain_after, t.item, t.recording, t.measures, {} AND {} AND (t.id IS NULL OR {})"
          " FROM visit v JOIN patient p ON p.id = v.patient"
          " LEFT JOIN trial t ON t.visit = v.id AND t.state = 'measured'"
          " WHERE p.id = ?1 OR ?1 = 0 ORDER BY p.code, v.began_us, v.id, t.began_us, t.id",
          soundness(db, "visit", "v"), soundness(db, "patient", "p"), soundness(db, "trial", "t")),
      patient);
  if (progress != nullptr) {
    progress->of = std::max<std::int64_t>(
        db.number(
            "SELECT COUNT(*) FROM visit WHERE patient = ?1 OR (?1 = 0 AND patient IS NOT NULL)",
            patient),
        1);
  }
  std::int64_t visit_before = 0;
  while (rows.step()) {
    if (progress != nullptr && std::exchange(visit_before, rows.integer(1)) != rows.integer(1)) {
      ++progress->done;
    }
    if (rows.integer(11) == 0) {
      out += fmt::format("{},{},,damaged,,,,,,,,,,\r\n", csvCell(rows.text(0)), rows.integer(1));
      continue;
    }
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
      const std::string number = value.dump();  // a leading - belongs to the number and needs no
                                                // escape
      out += fmt::format("{},{},{},{}\r\n", trial, csvCell(name), number, csvCell(unit));
    };
    for (const Json& result : m.value("results", Json::array())) {
      line(result.value("name", ""), result.value("value", Json()), result.value("unit", ""));
    }
    line("active", m.value("active_s", Json()), "s");
    line("helped", m.value("helped_s", Json()), "s");
    line("led", m.value("led_s", Json()), "s");
    line("helped_share", m.value("helped_share", Json()), "");
    line("peak_speed", m.value("peak_speed_m_s", Json()), "m/s");
    line("path_ratio", m.value("path_ratio", Json()), "");
    line("reach", m.value("reach_s", Json()), "s");
  }
  return out;
}

namespace {

/// Releases the lock of the requests while an export reads.
class Unlocked {
 public:
  Unlocked(std::unique_lock<std::mutex>& lock, ExportProgress& progress)
      : lock_(lock), progress_(progress) {
    progress_.done = 0;
    progress_.of = 1;
    lock_.unlock();
  }
  ~Unlocked() {
    lock_.lock();
    progress_.of = 0;
  }
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;

 private:
  std::unique_lock<std::mutex>& lock_;
  ExportProgress& progress_;
};

}  // namespace

/// Reads the values on a connection of its own, so that other requests go on meanwhile. An erasure
/// ends the reading; it begins anew behind the erasure.
std::string Patients::exported(Call& call, std::int64_t patient) {
  call.transaction->commit();
  call.transaction.reset();
  while (true) {
    if (export_.of != 0) {
      throw RequestRefusal{409, "busy", "an export is under way; wait for it", {}};
    }
    if (patient != 0) check(patient);
    auto turn = std::make_unique<Readers::Turn>(records_.readers());
    const std::string path = records_.db().path();
    const Unlocked unlocked(call.lock, export_);
    try {
      const auto own = std::move(turn);  // ends before the lock is taken again
      Database reader(path, Database::Mode::kReadOnly);
      reader.endReadsWhen([&] { return own->isOver(); });
      guardByKeys(reader, records_.options().folder, true);
      return csvOf(reader, patient, &export_);
    } catch (const ReadEnded&) {  // the erasure has the lock
    }
  }
}

Json Patients::exportProgress(Call&) {
  return {{"done", export_.done.load()}, {"of", export_.of.load()}};
}

Json Patients::exportOne(Call& call) {
  const std::int64_t id = call.ids.at(0);
  check(id);
  const std::string code = records_.db().text("SELECT code FROM patient WHERE id = ?", id);
  records_.begin(call);
  records_.log(call.session.account, "exported", id);
  call.answer.type = "text/csv; charset=utf-8";
  call.answer.file = "patient-" + code + ".csv";
  call.answer.body = exported(call, id);
  return {};
}

Json Patients::exportAll(Call& call) {
  records_.begin(call);
  records_.log(call.session.account, "exported all");
  call.answer.type = "text/csv; charset=utf-8";
  call.answer.file = "patients.csv";
  call.answer.body = exported(call, 0);
  return {};
}

}  // namespace wholehand::clinic
