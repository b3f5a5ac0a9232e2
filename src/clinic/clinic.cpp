#include "clinic/clinic.hpp"

#include "loop/core/sha256.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

namespace wholehand::clinic {
namespace {
namespace fs = std::filesystem;

constexpr std::int64_t kAnswersKept_us = 2 * kDay_us;
/// A clock that is wrong at a start cannot be told: the newest answers stay, however old.
constexpr std::int64_t kAnswersAlwaysKept = 1000;
constexpr std::int64_t kCarryOutAgain_us = 60 * kSecond_us;

/// Facts about the folder that the page shows before a clinic is created there. An empty folder may
/// be a disk that is not mounted.
Json folderFacts(const std::string& folder) {
  std::error_code error;
  const fs::path path = fs::absolute(folder, error);
  bool empty = true;
  for (fs::directory_iterator it(path, error), end; !error && it != end; it.increment(error)) {
    // Skips files that this process has made itself.
    const std::string name = it->path().filename().string();
    const bool own = name == "lock" || name.starts_with("clinic.db") ||
                     ((name == "hands" || name == "backups") && fs::is_empty(it->path(), error));
    empty = empty && own;
  }
  return {{"path", path.lexically_normal().string()}, {"empty", empty}};
}

/// True when a path matches the pattern of a route; '#' in the pattern stands for a number, which
/// is added to `ids`.
bool matches(std::string_view path, std::string_view pattern, std::vector<std::int64_t>& ids) {
  ids.clear();
  std::size_t p = 0;
  for (const char c : pattern) {
    if (c != '#') {
      if (p >= path.size() || path[p++] != c) return false;
      continue;
    }
    const std::size_t end = std::min(path.find_first_not_of("0123456789", p), path.size());
    if (end == p || end - p > 17) return false;
    ids.push_back(std::stoll(std::string(path.substr(p, end - p))));
    p = end;
  }
  return p == path.size();
}

/// Makes a handler that calls a member function of the object.
template <class T>
std::function<Json(Call&)> by(T& object, Json (T::*handler)(Call&)) {
  return [&object, handler](Call& call) { return (object.*handler)(call); };
}

}  // namespace

Clinic::Clinic(ClinicOptions options, const Clock& clock, Station& station)
    : station_(station),
      records_(std::move(options), clock),
      plans_(records_, station),
      visits_(records_, accounts_, plans_, patients_, station),
      trials_(records_, station, mutex_),
      routes_(routes()) {}

std::vector<Clinic::Route> Clinic::routes() {
  using A = Access;
  using K = Kind;
  return {
      {"GET", "/api/state", A::kAnyone, K::kRead, by(*this, &Clinic::state)},
      {"POST", "/api/init", A::kAnyone, K::kSession, by(accounts_, &Accounts::init)},
      {"POST", "/api/unlock", A::kAnyone, K::kSession, by(accounts_, &Accounts::unlock)},
      {"POST", "/api/sign_in", A::kAnyone, K::kSession, by(*this, &Clinic::signIn)},
      {"POST", "/api/lock", A::kSigned, K::kSession, by(*this, &Clinic::lock)},
      {"POST", "/api/sign_out", A::kSigned, K::kSession, by(*this, &Clinic::signOut)},
      {"POST", "/api/hide", A::kSigned, K::kSession, by(accounts_, &Accounts::hide)},
      {"POST", "/api/show", A::kSigned, K::kSession, by(accounts_, &Accounts::show)},
      {"POST", "/api/accounts", A::kShown, K::kWrite, by(accounts_, &Accounts::addAccount)},
      {"POST", "/api/accounts/#/leave", A::kShown, K::kWrite, by(accounts_, &Accounts::leave)},
      {"POST", "/api/pin", A::kShown, K::kSession, by(accounts_, &Accounts::changePin)},
      {"GET", "/api/backup/places", A::kShown, K::kRead, by(upkeep_, &Upkeep::places)},
      {"POST", "/api/backup", A::kShown, K::kSession, by(upkeep_, &Upkeep::backUpNow)},
      {"GET", "/api/log", A::kShown, K::kRead, by(upkeep_, &Upkeep::log)},
      {"POST", "/api/restored/done", A::kShown, K::kWrite,
       by(patients_, &Patients::forgetRestored)},
      {"POST", "/api/lost/done", A::kShown, K::kWrite, by(patients_, &Patients::forgetLost)},
      {"POST", "/api/clock/done", A::kShown, K::kWrite, by(patients_, &Patients::confirmClock)},
      {"POST", "/api/phrase", A::kShown, K::kSession, by(accounts_, &Accounts::changePhrase)},
      {"POST", "/api/recovery_code", A::kShown, K::kSession,
       by(accounts_, &Accounts::changeRecoveryCode)},
      {"GET", "/api/presets", A::kSigned, K::kRead, by(plans_, &Plans::presets)},
      {"GET", "/api/patients", A::kShown, K::kRead, by(patients_, &Patients::list)},
      {"GET", "/api/patients/propose", A::kShown, K::kRead, by(patients_, &Patients::proposeCode)},
      {"POST", "/api/patients", A::kShown, K::kWrite, by(patients_, &Patients::add)},
      {"GET", "/api/patients/#", A::kShown, K::kRead, by(patients_, &Patients::show)},
      {"PUT", "/api/patients/#", A::kShown, K::kWrite, by(patients_, &Patients::change)},
      {"GET", "/api/patients/#/damaged", A::kShown, K::kRead,
       by(patients_, &Patients::showDamaged)},
      {"POST", "/api/patients/#/sign_again", A::kShown, K::kWrite,
       by(patients_, &Patients::signAgain)},
      {"DELETE", "/api/patients/#", A::kShown, K::kWrite, by(patients_, &Patients::remove)},
      {"POST", "/api/patients/#/merge", A::kShown, K::kWrite, by(patients_, &Patients::merge)},
      {"POST", "/api/patients/#/erase", A::kShown, K::kWrite, by(patients_, &Patients::erase)},
      {"POST", "/api/patients/#/no_show", A::kShown, K::kWrite, by(patients_, &Patients::noShow)},
      {"POST", "/api/patients/#/notes", A::kShown, K::kWrite, by(patients_, &Patients::note)},
      {"POST", "/api/patients/#/visits", A::kShown, K::kStation, by(visits_, &Visits::begin)},
      {"POST", "/api/guest_visits", A::kShown, K::kStation, by(visits_, &Visits::beginGuest)},
      {"GET", "/api/visits/open", A::kSigned, K::kRead, by(visits_, &Visits::open)},
      {"GET", "/api/visits/#", A::kSigned, K::kRead, by(visits_, &Visits::show)},
      {"PUT", "/api/notes/#", A::kSigned, K::kSession, by(visits_, &Visits::putNote)},
      {"GET", "/api/sessions", A::kShown, K::kRead, by(visits_, &Visits::sessions)},
      {"POST", "/api/sessions/give", A::kShown, K::kWrite, by(visits_, &Visits::giveSessions)},
      {"DELETE", "/api/sessions/#", A::kShown, K::kWrite, by(visits_, &Visits::deleteSession)},
      {"POST", "/api/visits/#/item", A::kSigned, K::kStation, by(visits_, &Visits::nextItem)},
      {"POST", "/api/visits/#/finish", A::kSigned, K::kStation, by(visits_, &Visits::finish)},
      {"POST", "/api/visits/#/notes", A::kSigned, K::kWrite, by(visits_, &Visits::note)},
      {"POST", "/api/visits/#/pain", A::kSigned, K::kWrite, by(visits_, &Visits::pain)},
      {"POST", "/api/visits/#/move", A::kShown, K::kWrite, by(visits_, &Visits::move)},
      {"DELETE", "/api/visits/#", A::kShown, K::kWrite, by(visits_, &Visits::remove)},
      {"GET", "/api/export/patient/#.csv", A::kShown, K::kRead,
       by(patients_, &Patients::exportOne)},
      {"GET", "/api/export/progress", A::kShown, K::kRead,
       by(patients_, &Patients::exportProgress)},
      {"GET", "/api/export/all.csv", A::kShown, K::kRead, by(patients_, &Patients::exportAll)},
  };
}

std::unique_lock<std::mutex> Clinic::turnOf(const Request& request) {
  if (request.method != "GET") {
    ++changes_waiting_;
    std::unique_lock lock(mutex_);
    if (--changes_waiting_ == 0) changes_waiting_.notify_all();
    return lock;
  }
  const std::lock_guard turn(reads_);
  for (int n = changes_waiting_; n != 0; n = changes_waiting_) changes_waiting_.wait(n);
  return std::unique_lock(mutex_);
}

Answer Clinic::answer(const Request& request) {
  std::unique_lock lock = turnOf(request);
  Call call{request, lock};
  const auto refuse = [&](const RequestRefusal& refused) {
    call.transaction.reset();
    Json body = refused.more;
    body["refused"] = refused.code;
    body["why"] = refused.why;
    if (!refused.field.empty()) body["field"] = refused.field;
    call.answer = {refused.status, "application/json", {}, {}};
    call.answer.body = body.dump(-1, ' ', false, Json::error_handler_t::replace);
  };
  try {
    route(call);
  } catch (const RequestRefusal& refused) {
    refuse(refused);
  } catch (const DatabaseError& error) {
    refuse({503, "database", error.what(), {}});
    records_.closeLost();
  } catch (const Json::exception&) {
    refuse({503, "database", "a row of the database is damaged; run wholehand-clinic verify", {}});
  } catch (const std::bad_alloc&) {
    refuse({503, "busy", "there is not enough memory; try again", {}});
  }
  return std::move(call.answer);
}

void Clinic::route(Call& call) {
  records_.open();
  records_.watchClock();
  bool known_path = false;
  for (const Route& route : routes_) {
    if (!matches(call.request.path, route.path, call.ids)) continue;
    known_path = true;
    if (call.request.method != route.method) continue;
    accounts_.admit(call, route.access);
    call.body = parsed(call.request.body);
    return perform(call, route);
  }
  if (known_path) throw RequestRefusal{405, "not_found", "no such method here", {}};
  throw notFound("there is no " + call.request.path);
}

void Clinic::perform(Call& call, const Route& route) {
  const bool changes = route.kind == Kind::kWrite || route.kind == Kind::kStation;
  std::string key, digest;
  // A repeated request gets its stored answer and changes nothing.
  if (changes) {
    const std::string& given = call.request.key;
    if (given.empty() || given.size() > 100) {
      throw badValue("Idempotency-Key", "the header Idempotency-Key has 1 to 100 characters");
    }
    key = sha256(given);
    digest = sha256(
        fmt::format("{}\n{}\n{}", call.request.method, call.request.path, call.request.body));
    Statement before =
        records_.db().query("SELECT request, body, shown FROM answer WHERE key = ?", key);
    if (before.step()) {
      if (before.text(0) != digest) {
        throw badValue("Idempotency-Key", "this key was used for another request; draw a new one");
      }
      if (before.integer(2) != 0 && call.session.hidden) {
        throw RequestRefusal{
            403, "hidden", "this was carried out; type the PIN to see its answer", {}};
      }
      call.answer.body = records_.unseal("answer", before.text(1));
      return;
    }
  }
  if (route.kind == Kind::kWrite) records_.begin(call);
  const Json body = route.handler(call);
  // The text of what was read is made without the lock.
  if (route.kind == Kind::kRead && !call.transaction && call.after.empty()) call.lock.unlock();
  if (call.answer.body.empty()) {
    call.answer.body = body.dump(-1, ' ', false, Json::error_handler_t::replace);
  }
  // Stores the answer in the same transaction as the change.
  if (call.transaction) {
    if (changes && records_.key()) {
      const std::int64_t now_us = records_.clock().now_us();
      if (!records_.clockJumped()) {
        records_.db().change(
            "DELETE FROM answer WHERE rowid <= (SELECT MAX(rowid) FROM answer) - ? AND (at_us < ? "
            "OR"
            " at_us > ?)",
            kAnswersAlwaysKept, now_us - kAnswersKept_us, now_us + kAnswersKept_us);
      }
      records_.db().change(
          "INSERT INTO answer (key, request, at_us, shown, body) VALUES (?, ?, ?, ?, ?)", key,
          digest, now_us, call.session.hidden ? 0 : 1,
          Blob{records_.seal("answer", call.answer.body)});
    }
    call.transaction->commit();
    call.transaction.reset();
  }
  for (const auto& then : call.after) then();
}

Json Clinic::state(Call&) {
  const char* locked = records_.isNew() ? "new" : "locked";
  Json out = {{"clinic", records_.key() ? "open" : locked},
              {"tiles", accounts_.tiles()},
              {"station", {{"heard", station_.scene().received}}},
              {"visit", visits_.openOne()},
              {"backup", records_.backupFacts()},
              {"version", 1}};
  if (records_.isNew()) out["folder"] = folderFacts(records_.options().folder);
  return out;
}

/// Locks the clinic. Refused while a request waits for the station, because its answer needs the
/// key.
Json Clinic::lock(Call& call) {
  visits_.refuseWhileAsking();
  patients_.index().forget();
  return accounts_.lockClinic(call);
}

/// Names are decrypted once, while somebody is signed in.
Json Clinic::signIn(Call& call) {
  Json out = accounts_.signIn(call);
  patients_.index().refresh();
  return out;
}

Json Clinic::signOut(Call& call) {
  Json out = accounts_.signOut(call);
  if (!accounts_.anybody()) patients_.index().forget();
  return out;
}

void Clinic::backUpIfDue() {
  const std::lock_guard lock(mutex_);
  records_.watchClock();
  records_.backUpIfDue();
}

void Clinic::carryOut() {
  std::int64_t last = 0;
  const auto fail = [&](const std::string& problem) {
    carry_out_again_us_ = records_.clock().steady_us() + kCarryOutAgain_us;
    try {
      if (records_.isOpen()) noteProblem(records_.db(), last, problem);
    } catch (const DatabaseError&) {  // the disk is full: the intent stays, without its reason
    }
  };
  std::unique_lock lock(mutex_);
  try {
    records_.open();
    last = lastIntent(records_.db());
    if (last == 0) return;
    const bool later = records_.clock().steady_us() < carry_out_again_us_;
    if (later && !(waits_for_readers_ && otherReaders(records_.db().path()).empty())) return;
    waits_for_readers_ = false;
    const Places places = records_.places();
    std::vector<std::string> left;
    do {
      left = removeErasedFiles(records_.db(), places, records_.clock().now_us());
      if (!erases(records_.db(), last)) break;
      records_.compact();
      const Lines lines = linesOf(records_.db());
      const Kept kept = keptOf(records_.db());
      lock.unlock();  // copies of many patients take a while
      Lines more;
      std::string problem;
      try {
        more = eraseFromCopies(places, lines, kept);
      } catch (const std::exception& error) {
        problem = error.what();
      }
      lock.lock();
      if (!problem.empty()) return fail(problem);
      if (!addLinesOfCopies(records_.db(), more)) break;
    } while (true);
    if (!left.empty()) return fail(notRemoved(left));
    finishIntents(records_.db(), last, records_.clock().now_us());
  } catch (const ReadByOthers& error) {
    fail(error.what());
    waits_for_readers_ = !otherReaders(records_.db().path()).empty();
  } catch (const DatabaseError& error) {
    fail(error.what());
  } catch (const Json::exception&) {
    fail("a row of the database is damaged; run wholehand-clinic verify");
  }
}

void Clinic::lookAtStation() {
  const StationScene scene = station_.scene();
  std::uint64_t close = 0;
  {
    const std::lock_guard lock(mutex_);
    if (!records_.isOpen()) return;
    try {
      close = visits_.compareWithStation(scene);
    } catch (const DatabaseError&) {  // the next call tries again
    } catch (const RequestRefusal&) {
    }
  }
  if (close != 0)
    (void)station_.close(close);  // closes the visit, so that nobody's limits stay in
                                  // force
}

void Clinic::lookAtRecordings(const Measure& measure, const std::function<bool()>& stop) {
  trials_.look(measure, stop);
}

}  // namespace wholehand::clinic
