// Recordings made outside a visit: listed, given to a patient, deleted.
#include "clinic/visits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace wholehand::clinic {
namespace {

constexpr int kMostLoose = 100;

}  // namespace

Json Visits::sessions(Call&) {
  const std::int64_t all = records_.db().number("SELECT COUNT(*) FROM trial WHERE visit IS NULL");
  return {
      {"sessions", trialsIn(records_.db().query(
                                trialColumns(records_.db()) +
                                    " WHERE visit IS NULL ORDER BY began_us DESC, id DESC LIMIT ?",
                                kMostLoose),
                            {})},
      {"more", std::max(all - kMostLoose, std::int64_t{0})}};
}

/// Assigns sessions that were recorded outside a visit to a new visit.
Json Visits::giveSessions(Call& call) {
  const std::int64_t patient = patients_.named(call.body);
  const Json ids = call.body.value("sessions", Json());
  const bool numbers =
      ids.is_array() && !ids.empty() && ids.size() <= kMostLoose &&
      std::all_of(ids.begin(), ids.end(), [](const Json& id) { return id.is_number_integer(); });
  if (!numbers) throw badValue("sessions", "sessions is no list of numbers of sessions");
  // The visit spans all sessions.
  VisitRow spanning;
  spanning.patient = patient;
  spanning.account = call.session.account;
  spanning.state = "done";
  spanning.began_us = std::numeric_limits<std::int64_t>::max();
  for (const Json& id : ids) {
    const Json one =
        trialsIn(records_.db().query(trialColumns(records_.db()) +
                                         " WHERE id = ? AND visit IS NULL AND state = 'measured'",
                                     id.get<std::int64_t>()),
                 {});
    if (one.empty()) {
      throw RequestRefusal{409, "changed",
                           fmt::format("session {} was given or deleted meanwhile", id.dump()),
                           "sessions"};
    }
    const std::int64_t at_us = one[0]["began_us"];
    spanning.began_us = std::min(spanning.began_us, at_us);
    const Json lasted = one[0]["duration_s"];
    const double lasted_s = lasted.is_number() ? lasted.get<double>() : 0.0;
    spanning.ended_us =
        std::max(spanning.ended_us, at_us + static_cast<std::int64_t>(lasted_s * 1e6));
    spanning.side = one[0]["side"];
  }
  // Creates the visit and assigns the sessions.
  const std::int64_t visit = insertVisit(records_, spanning);
  Erasure given;  // erases nothing
  const std::int64_t count = nextCount(records_.db());
  for (const Json& id : ids) {
    records_.db().change("UPDATE trial SET visit = ?, why = '' WHERE id = ?", visit,
                         id.get<std::int64_t>());
    given.lines.push_back(fmt::format(
        "given {} {} {}", count,
        records_.db().text("SELECT sha256 FROM trial WHERE id = ?", id.get<std::int64_t>()),
        markOf(records_.db(), patient)));
  }
  records_.storeIntent("list", given);
  records_.log(call.session.account, "gave sessions", patient, visit, ids.dump());
  return visitJson(records_, visit, false);
}

Json Visits::deleteSession(Call& call) {
  const std::int64_t id = call.ids.at(0);
  Statement row =
      records_.db().query("SELECT recording FROM trial WHERE id = ? AND visit IS NULL", id);
  if (!row.step()) {
    throw RequestRefusal{409, "changed", "this session was given or deleted meanwhile", {}};
  }
  erase(call, erasureOfSession(records_.db(), id));
  records_.log(call.session.account, "deleted a session", 0, 0, row.text(0));
  return Json::object();
}

}  // namespace wholehand::clinic
