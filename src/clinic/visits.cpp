#include "clinic/visits.hpp"

#include "clinic/limits.hpp"
#include "clinic/row_digests.hpp"
#include "files/text/text_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <system_error>
#include <utility>

namespace wholehand::clinic {
namespace {

/// A shorter difference between station and database means that an order is still on its way.
constexpr std::int64_t kApart_us = 10 * kSecond_us;

std::string limitsFileOf(std::int64_t visit) {
  return fmt::format("visit-{}-limits.toml", visit);
}

std::string sideOf(const Json& body) {
  const Json side = body.value("side", Json());
  if (side != "right" && side != "left") throw badValue("side", "side must be right or left");
  return side;
}

}  // namespace

std::int64_t Visits::openOne() {
  return records_.db().number("SELECT id FROM visit WHERE state = 'open'");
}

VisitRow Visits::visitFor(const Call& call, std::int64_t id) {
  VisitRow visit = visitRow(records_.db(), id);
  if (call.session.hidden && visit.state != "open") {
    throw RequestRefusal{403, "hidden", "names are hidden; type the PIN to show them", {}};
  }
  return visit;
}

VisitOrder Visits::orderOf(const VisitRow& visit, std::int64_t item) {
  const Parameters settings = plans_.settingsOf(visit.patient, visit.changed);
  const PlanItem now = capped(visit.plan, plans_.limitsAmong(settings)).at(item);
  const ExerciseFacts* facts = records_.presets().exercise(now.exercise);
  if (facts == nullptr) throw badValue("item", now.exercise + " is no longer one of ours");
  VisitOrder order{static_cast<std::uint64_t>(visit.id),
                   static_cast<std::uint32_t>(item),
                   now.exercise,
                   now.level,
                   visit.hand,
                   visit.hand_file,
                   now.help,
                   {}};
  const auto has = [](const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  for (const auto& [name, value] : settings) {
    if (has(records_.presets().device, name) || has(facts->parameters, name))
      order.parameters[name] = value;
  }
  for (const auto& [name, value] : now.parameters) order.parameters[name] = value;
  order.prescription_file = writeLimits(visit);
  return order;
}

/// Writes the limits of the visit's hand to a file that the station reads. Returns its name; empty
/// for a person without limits.
std::string Visits::writeLimits(const VisitRow& visit) {
  if (!visit.patient) return {};
  Statement row = records_.db().query("SELECT hands FROM patient WHERE id = ?", *visit.patient);
  row.step();
  const Json hand = Json::parse(row.text(0)).value(visit.side, Json::object());
  const Json limits = hand.value("limits", Json::array());
  if (limits.empty()) return {};
  std::string name = limitsFileOf(visit.id);
  const std::string path = records_.options().folder + "/hands/" + name;
  const std::string text =
      prescriptionText(fmt::format("visit-{}", visit.id), visit.side, limitTexts(limits));
  auto written = prepareFiles({path});
  if (written) written = writeText(path, text);
  if (!written) throw RequestRefusal{503, "database", format(written.errors()), "hands"};
  return name;
}

/// Settings that the station will have after the order: within a visit, a later item does not raise
/// a lowered effort limit.
Json Visits::inForce(const VisitOrder& order) const {
  Parameters values = order.parameters;
  const StationScene scene = station_.scene();
  for (auto& [name, value] : values) {
    if (scene.visit == order.visit) value = scene.limits.lowered(name, value);
  }
  return {{"parameters", values}, {"help", order.help}, {"level", order.level}};
}

/// Saves in the open visit what was set at the station since the last call. A value belongs to the
/// item if the item names that parameter, else to the person.
void Visits::keepSettings(VisitRow& visit) {
  const StationScene scene = station_.scene();
  const bool same = scene.visit == static_cast<std::uint64_t>(visit.id) && scene.item == visit.item;
  if (!same || !visit.in_force.contains("parameters")) return;
  PlanItem& item = visit.plan.at(visit.item);
  const PersonLimits limits = plans_.limitsOf(visit.patient, visit.changed);
  Json& known = visit.in_force["parameters"];
  const Json before = visit.in_force;
  // Parameters that differ from the last known values.
  for (const auto& [name, value] : scene.values) {
    const auto first = scene.initial.find(name);
    if (first == scene.initial.end() || !records_.presets().bounds.contains(name)) continue;
    const double was = known.value(name, first->second);
    if (value == was) continue;
    known[name] = value;
    const bool above = limits.exceeds(name, value);
    const bool items = item.parameters.contains(name);
    if (items) item.parameters[name] = value;
    if (!items || above) visit.changed[name] = value;
  }
  // Help and level of the item.
  if (scene.exercise == item.exercise) {
    if (!scene.help.empty() && scene.help != visit.in_force["help"]) {
      visit.in_force["help"] = item.help = scene.help;
    }
    if (scene.level != visit.in_force["level"]) {
      visit.in_force["level"] = item.level = scene.level;
    }
  }
  if (visit.in_force == before) return;
  Transaction transaction(records_.db());
  records_.db().change("UPDATE visit SET plan = ?, in_force = ?, changed = ? WHERE id = ?",
                       Json(visit.plan).dump(), visit.in_force.dump(), visit.changed.dump(),
                       visit.id);
  transaction.commit();
}

/// Ends a visit and keeps the values set in it as the person's own. An unfinished visit has already
/// done so; the person's values may have changed since.
void Visits::close(std::int64_t account, VisitRow visit, const std::string& state) {
  records_.db().change("UPDATE visit SET state = ?, ended_us = ? WHERE id = ?",
                       visit.patient ? state : std::string("guest"),
                       std::max(records_.clock().now_us(), visit.began_us), visit.id);
  if (!visit.patient || visit.changed.empty() || visit.state == "unfinished") return;
  Statement row =
      records_.db().query("SELECT parameters, plan FROM patient WHERE id = ?", *visit.patient);
  row.step();
  Json own = Json::parse(row.text(0));
  for (const auto& [name, value] : visit.changed.items()) {
    if (own.contains(name) && own[name] == value) continue;
    if (!visit.before.contains(name)) visit.before[name] = own.value(name, Json());
    own[name] = value;
  }
  records_.db().change("UPDATE visit SET before = ? WHERE id = ?", visit.before.dump(), visit.id);
  records_.db().change("UPDATE patient SET parameters = ?, version = version + 1 WHERE id = ?",
                       own.dump(), *visit.patient);
  // Caps the plan: an item above a lowered limit would be refused at the next change of the person.
  records_.db().change(
      "UPDATE patient SET plan = ? WHERE id = ?",
      Json(capped(Json::parse(row.text(1)), plans_.limitsOf(visit.patient))).dump(),
      *visit.patient);
  records_.log(account, "kept settings", *visit.patient, visit.id, visit.changed.dump());
}

/// Chooses a shipped hand of the person's size, or writes a hand file for the visit.
void Visits::chooseHand(VisitRow& visit) {
  visit.hand = "adult-median-" + visit.side;
  if (!visit.patient) return;
  const Json hands =
      Json::parse(records_.db().text("SELECT hands FROM patient WHERE id = ?", *visit.patient));
  const Json hand = hands.value(visit.side, Json());
  const std::string field = "hands." + visit.side;
  if (hand.is_null()) throw badValue(field, "length and breadth of this hand are missing");
  const double length_m = hand.at("length_m"), breadth_m = hand.at("breadth_m");
  visit.hand = shippedHand(records_.hands(), visit.side, length_m, breadth_m);
  if (!visit.hand.empty()) return;
  const std::string name = fmt::format("visit-{}-{}", visit.id, visit.side);
  visit.hand_file = name + ".toml";
  const auto written = writeHandFile(records_.options().config + "/hands",
                                     records_.options().folder + "/hands/" + visit.hand_file, name,
                                     visit.side, length_m, breadth_m);
  if (!written) throw RequestRefusal{503, "database", format(written.errors()), field};
}

/// Adapts an unfinished visit to its present person: side, hand and limits may have changed since,
/// or the visit was moved to another person.
void Visits::fitToPerson(VisitRow& visit) {
  refuseOtherSide(*visit.patient, visit.side);
  const Json own = Json::parse(
                 records_.db().text("SELECT parameters FROM patient WHERE id = ?", *visit.patient)),
             changed = visit.changed;
  for (const auto& [name, value] : changed.items()) {
    if (own.value(name, Json()) == value) continue;
    visit.changed.erase(name);
    visit.before.erase(name);
  }
  const std::string file = std::exchange(visit.hand_file, {});
  chooseHand(visit);
  Transaction transaction(records_.db());
  records_.db().change(
      "UPDATE visit SET hand = ?, hand_file = ?, changed = ?, before = ? WHERE id = ?", visit.hand,
      visit.hand_file, visit.changed.dump(), visit.before.dump(), visit.id);
  transaction.commit();
  if (!file.empty() && visit.hand_file != file) removeHandFile(file);
}

void Visits::removeHandFile(const std::string& name) const {
  std::error_code ignored;
  std::filesystem::remove(records_.options().folder + "/hands/" + name, ignored);
}

void Visits::refuseOtherSide(std::int64_t patient, const std::string& side) {
  const std::string affected = records_.db().text("SELECT side FROM patient WHERE id = ?", patient);
  if (affected != "both" && affected != side) {
    throw badValue("side", "the patient's affected side is " + affected + ", not " + side);
  }
}

void Visits::refuseWhileAsking() const {
  if (asking_)
    throw RequestRefusal{409, "busy", "the station is being asked already; try again", {}};
}

/// A limit that was lowered last may be among the changes that are lost.
void Visits::refuseWhileLost() {
  const std::int64_t lost = lostChanges(records_.db());
  if (lost == 0) return;
  throw refusal(409, "damaged",
                fmt::format("the last {} changes of clinic.db are lost: look at the limits of"
                            " whoever trained last and confirm it at the list of patients;"
                            " until then train under the gentle preset",
                            lost));
}

void Visits::refuseWhileOpen() {
  const std::int64_t open = openOne();
  if (open == 0) return;
  throw refusal(409, "visit_open", "another visit is open; finish it first",
                {{"now", visitJson(records_, open, false)}});
}

/// Sends an order and waits for its reply. The lock is released meanwhile, so that other requests
/// continue.
void Visits::ask(Call& call, const std::function<StationReply()>& order) {
  refuseWhileAsking();
  asking_ = true;
  call.lock.unlock();
  StationReply reply;
  try {
    reply = order();
  } catch (const std::exception& error) {
    reply.why = error.what();
  }
  call.lock.lock();
  asking_ = false;
  apart_since_us_ = 0;
  if (reply.what == StationReply::Status::kRefused)
    throw RequestRefusal{409, "station", reply.why, {}};
  if (reply.what == StationReply::Status::kSilent) {
    throw RequestRefusal{504, "station_silent", reply.why, {}};
  }
}

Json Visits::start(Call& call, std::optional<std::int64_t> patient, const std::string& side,
                   const Plan& plan) {
  if (plan.empty()) throw badValue("plan", "a visit has at least one item");
  refuseWhileAsking();
  refuseWhileOpen();
  if (!station_.scene().received) {  // the station would not learn the visit number, so no row is
                                     // needed
    throw RequestRefusal{504, "station_silent", "the station is not connected", {}};
  }
  VisitRow visit;
  visit.patient = patient;
  visit.side = side;
  visit.plan = plan;
  visit.account = call.session.account;
  visit.state = "open";
  // The row is on the disk before the station gets the visit number, so that every recording has a
  // visit.
  records_.begin(call);
  visit.id = takeVisitNumber(records_.db());
  chooseHand(visit);
  const VisitOrder order = orderOf(visit, 0);
  visit.began_us = records_.clock().now_us();
  visit.in_force = inForce(order);
  insertVisit(records_, visit);
  records_.log(call.session.account, "asked for a visit", patient.value_or(0), visit.id);
  call.transaction->commit();
  call.transaction.reset();
  try {
    ask(call, [&] { return station_.open(order); });
  } catch (const RequestRefusal& refused) {
    // A station that did not answer may still obey, and its recordings then name this visit. The
    // row stays.
    const bool silent = refused.code == "station_silent";
    Transaction transaction(records_.db());
    if (silent) {
      close(call.session.account, visitRow(records_.db(), visit.id), "unfinished");
    } else {
      records_.db().change("DELETE FROM visit WHERE id = ?", visit.id);
    }
    records_.log(call.session.account, "visit refused", patient.value_or(0), visit.id,
                 refused.code);
    transaction.commit();
    if (!silent) {
      if (!visit.hand_file.empty()) removeHandFile(visit.hand_file);
      removeHandFile(limitsFileOf(visit.id));
    }
    throw;
  }
  records_.begin(call);
  records_.log(call.session.account, "began a visit", patient.value_or(0), visit.id);
  return visitJson(records_, visit.id, call.session.hidden);
}

Json Visits::begin(Call& call) {
  const std::int64_t id = call.ids.at(0);
  patients_.check(id);
  refuseWhileLost();
  const std::string side = sideOf(call.body);
  refuseOtherSide(id, side);
  return start(
      call, id, side,
      plans_.readPlan(call.body.value("plan", Json::array()), "plan", plans_.limitsOf(id)));
}

Json Visits::beginGuest(Call& call) {
  return start(call, {}, sideOf(call.body), records_.presets().plans.front().items);
}

Json Visits::open(Call& call) {
  const std::int64_t id = openOne();
  if (id == 0) return {{"visit", nullptr}, {"patient", nullptr}};
  Json row;
  const VisitRow visit = visitRow(records_.db(), id);
  if (!call.session.hidden && visit.patient) row = patients_.index().row(*visit.patient);
  return {{"visit", visitJson(records_, id, call.session.hidden)}, {"patient", row}};
}

Json Visits::nextItem(Call& call) {
  VisitRow visit = visitOf(call);
  if (visit.state != "open" && visit.state != "unfinished") {
    throw changedMeanwhile("this visit was finished meanwhile",
                           visitJson(records_, visit.id, call.session.hidden));
  }
  if (visit.state != "open") refuseWhileOpen();
  const Json item = call.body.value("item", Json());
  const auto items = static_cast<std::int64_t>(visit.plan.size());
  if (!item.is_number_integer() || item < 0 || item >= items) {
    throw badValue("item", fmt::format("item must be one of 0 to {}", items - 1));
  }
  const auto k = item.get<std::int64_t>();
  refuseWhileAsking();
  if (visit.state == "unfinished") {
    refuseWhileLost();
    fitToPerson(visit);
  }
  keepSettings(visit);
  const VisitOrder order = orderOf(visit, k);
  const Json in_force = inForce(order);
  ask(call, [&] { return station_.open(order); });
  records_.begin(call);
  // If another console has finished or moved the visit meanwhile, no row matches and nothing
  // changes here; the comparison with the station closes it there.
  records_.db().change(
      "UPDATE visit SET item = ?, in_force = ?, state = 'open', ended_us = 0 WHERE id = ? AND state"
      " = ? AND patient IS ?",
      k, in_force.dump(), visit.id, visit.state, visit.patient);
  records_.log(call.session.account, "began an item", visit.patient.value_or(0), visit.id,
               std::to_string(k));
  return visitJson(records_, visit.id, call.session.hidden);
}

Json Visits::finish(Call& call) {
  if (const std::int64_t id = call.ids.at(0); isDamaged(id)) return finishDamaged(call, id);
  VisitRow visit = visitOf(call);
  const Json state = call.body.value("state", Json());
  if (state != "done" && state != "unfinished") {
    throw badValue("state", "state must be done or unfinished");
  }
  if (visit.state != "open" && visit.state != "unfinished") {
    throw changedMeanwhile("this visit was finished meanwhile",
                           visitJson(records_, visit.id, call.session.hidden));
  }
  if (visit.state == "open") keepSettings(visit);
  // A disconnected station cannot be asked; lookAtStation() closes the visit when the station is
  // back.
  if (visit.state == "open" && station_.scene().received) {
    ask(call, [&] { return station_.close(static_cast<std::uint64_t>(visit.id)); });
  }
  records_.begin(call);
  close(call.session.account, visit, state.get<std::string>());
  records_.log(call.session.account, "finished a visit", visit.patient.value_or(0), visit.id,
               state);
  return visitJson(records_, visit.id, call.session.hidden);
}

bool Visits::isDamaged(std::int64_t visit) {
  return records_.db().number("SELECT COUNT(*) FROM visit WHERE id = ?", visit) != 0 &&
         !isSound(records_.db(), "visit", visit);
}

/// Ends a visit whose row is damaged, also on the station. The row stays damaged, and none of its
/// values becomes the person's.
Json Visits::finishDamaged(Call& call, std::int64_t visit) {
  if (station_.scene().visit == static_cast<std::uint64_t>(visit)) {
    ask(call, [&] { return station_.close(static_cast<std::uint64_t>(visit)); });
  }
  records_.begin(call);
  setAside(call.session.account, visit);
  return listedVisit(records_, visit);
}

void Visits::setAside(std::int64_t account, std::int64_t visit) {
  {
    const SetAside aside(records_.db());
    records_.db().change("UPDATE visit SET state = 'unfinished', ended_us = ? WHERE id = ?",
                         records_.clock().now_us(), visit);
  }
  records_.log(account, "ended a visit whose row is damaged", 0, visit);
}

Json Visits::move(Call& call) {
  const VisitRow visit = visitOf(call);
  if (visit.state == "open") {
    throw refusal(409, "visit_open",
                  "the limits in force are the other person's: finish the visit first");
  }
  const std::int64_t patient = patients_.named(call.body);
  takeBackSettings(records_.db(), visit);
  records_.db().change(
      "UPDATE visit SET patient = ?, state = ?, changed = '{}', before = '{}' WHERE id = ?",
      patient, visit.state == "guest" ? std::string("done") : visit.state, visit.id);
  records_.storeIntent("list", {{fmt::format("moved {} {} {}", nextCount(records_.db()), visit.id,
                                             markOf(records_.db(), patient))},
                                {}});
  records_.log(call.session.account, "moved a visit", patient, visit.id,
               fmt::format("from {}", visit.patient.value_or(0)));
  return visitJson(records_, visit.id, false);
}

Json Visits::show(Call& call) {
  const VisitRow visit = visitOf(call);
  if (visit.patient && !call.session.hidden) accounts_.logOpened(call, *visit.patient);
  return visitJson(records_, visit.id, call.session.hidden);
}

/// Erases after the change is committed. The answer lists recordings that could not be removed.
void Visits::erase(Call& call, const Erasure& erasure) {
  records_.storeIntent("delete", erasure);
  call.after.emplace_back([this, &call] {
    call.answer.body = Json({{"recordings_left", records_.removeErased()}}).dump();
  });
}

Json Visits::remove(Call& call) {
  const VisitRow visit = visitOf(call);
  if (visit.patient) {
    throw changedMeanwhile("only a guest's visit is deleted; move this one",
                           visitJson(records_, visit.id, false));
  }
  if (visit.state == "open") refuseWhileOpen();
  erase(call, erasureOfVisit(records_.db(), visit.id));
  records_.log(call.session.account, "deleted a guest visit", 0, visit.id);
  return Json::object();
}

std::uint64_t Visits::compareWithStation(const StationScene& scene) {
  if (!scene.received || asking_) return 0;
  const auto open = static_cast<std::uint64_t>(openOne());
  // Lists a recording in progress as a trial that waits for its measures.
  if (scene.visit != 0 && scene.visit == open && !scene.recording.empty()) {
    std::string name = scene.recording.substr(scene.recording.rfind('/') + 1);
    if (records_.db().number("SELECT COUNT(*) FROM trial WHERE recording = ?", name) == 0) {
      Transaction transaction(records_.db());
      insertWaitingTrial(records_.db(), name, static_cast<std::int64_t>(open), scene.item,
                         records_.clock().now_us());
      transaction.commit();
    }
  }
  // A difference that lasts closes the visit on both sides.
  const std::int64_t now_us = records_.clock().steady_us();
  if (scene.visit == open) {
    apart_since_us_ = 0;
    if (open != 0) {
      VisitRow visit = visitRow(records_.db(), static_cast<std::int64_t>(open));
      keepSettings(visit);
    }
  } else if (apart_since_us_ == 0) {
    apart_since_us_ = std::max<std::int64_t>(now_us, 1);
  } else if (now_us - apart_since_us_ >= kApart_us) {
    apart_since_us_ = 0;
    if (open != 0) {  // the station was restarted, or its last change did not reach the disk
      Transaction transaction(records_.db());
      if (isDamaged(static_cast<std::int64_t>(open))) {
        setAside(0, static_cast<std::int64_t>(open));
        transaction.commit();
        return scene.visit;
      }
      close(0, visitRow(records_.db(), static_cast<std::int64_t>(open)), "unfinished");
      records_.log(0, "the station has this visit no longer", 0, static_cast<std::int64_t>(open));
      transaction.commit();
    }
    return scene.visit;
  }
  return 0;
}

}  // namespace wholehand::clinic
