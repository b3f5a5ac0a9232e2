#include "clinic/clinic.hpp"

#include "clinic/backup.hpp"
#include "clinic/text.hpp"
#include "core/sha256.hpp"
#include "core/tick_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <new>
#include <sodium.h>
#include <string_view>
#include <system_error>
#include <utility>

/// Requests, sessions and keys; patients: their rows, notes, mistakes, exports; visits: opened and
/// closed on the station, noted, moved.
namespace wholehand::clinic {
namespace {
namespace fs = std::filesystem;

constexpr std::int64_t kSecond_us = 1'000'000, kHideAfter_us = 300 * kSecond_us;
constexpr std::int64_t kAnswersKept_us = 2 * 86'400 * kSecond_us;
constexpr int kFreeTries = 5, kFirstWait_s = 30, kLongestWait_s = 3600;
constexpr std::size_t kMostSessions = 64, kMostDepth = 16;
constexpr std::size_t kLeastPhrase = 8, kMostPhrase = 200, kLeastPin = 4, kMostPin = 8;

Refused changed(std::string why) {
  return {409, "changed", std::move(why), {}};
}

/// With what it is now.
Refused changedTo(const Json& now, std::string why) {
  return {409, "changed", std::move(why), {}, {{"now", now}}};
}

std::string textOf(const Json& body, const char* key, const std::string& field) {
  const auto found = body.find(key);
  if (found == body.end() || !found->is_string()) throw badValue(field, field + " is no text");
  return found->get<std::string>();
}

std::string pinOf(const Json& body, const std::string& field) {
  std::string pin = textOf(body, "pin", field);
  const bool digits =
      std::all_of(pin.begin(), pin.end(), [](char c) { return c >= '0' && c <= '9'; });
  if (!digits || pin.size() < kLeastPin || pin.size() > kMostPin) {
    throw badValue(field, "a PIN has 4 to 8 digits");
  }
  return pin;
}

bool isColour(const std::string& text) {
  return text.size() == 7 && text[0] == '#' &&
         text.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
}

Json parsed(const std::string& body) {
  if (body.empty()) return Json::object();
  if (jsonDepth(body) > kMostDepth) {
    throw badValue("", fmt::format("the JSON is nested {} deep; at most {} are read",
                                   jsonDepth(body), kMostDepth));
  }
  Json json;
  try {
    json = Json::parse(body);
  } catch (const Json::exception& error) {
    const std::string why = error.what();
    const bool utf8 = why.find("UTF-8") != std::string::npos;
    // Not the parser's words: they quote what was sent.
    throw badValue("", utf8 ? "the text is not UTF-8" : "the body is not JSON");
  }
  if (!json.is_object()) throw badValue("", "the body is no JSON object");
  return json;
}

/// What the page says before a clinic begins: an empty folder may be a disk that is not mounted.
Json folderFacts(const std::string& folder) {
  std::error_code error;
  const fs::path path = fs::absolute(folder, error);
  bool empty = true;
  for (fs::directory_iterator it(path, error), end; !error && it != end; it.increment(error)) {
    // What this process has made itself.
    const std::string name = it->path().filename().string();
    const bool own = name == "lock" || name.starts_with("clinic.db") ||
                     ((name == "hands" || name == "backups") && fs::is_empty(it->path(), error));
    empty = empty && own;
  }
  return {{"path", path.lexically_normal().string()}, {"empty", empty}};
}

/// True when a path is of a route; '#' stands for a number.
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

}  // namespace

Clinic::Clinic(ClinicOptions options, const Clock& clock, Station& station)
    : options_(std::move(options)), clock_(clock), station_(station) {}
Clinic::~Clinic() = default;

const std::vector<Clinic::Route>& Clinic::routes() {
  using A = Access;
  using K = Kind;
  static const std::vector<Route> kRoutes = {
      {"GET", "/api/state", A::kAnyone, K::kRead, &Clinic::state},
      {"POST", "/api/init", A::kAnyone, K::kSession, &Clinic::init},
      {"POST", "/api/unlock", A::kAnyone, K::kSession, &Clinic::unlock},
      {"POST", "/api/sign_in", A::kAnyone, K::kSession, &Clinic::signIn},
      {"POST", "/api/lock", A::kSigned, K::kSession, &Clinic::lockClinic},
      {"POST", "/api/sign_out", A::kSigned, K::kSession, &Clinic::signOut},
      {"POST", "/api/hide", A::kSigned, K::kSession, &Clinic::hide},
      {"POST", "/api/show", A::kSigned, K::kSession, &Clinic::show},
      {"POST", "/api/accounts", A::kShown, K::kWrite, &Clinic::addAccount},
      {"GET", "/api/presets", A::kSigned, K::kRead, &Clinic::presets},
      {"GET", "/api/patients", A::kShown, K::kRead, &Clinic::patients},
      {"GET", "/api/patients/propose", A::kShown, K::kRead, &Clinic::proposeCode},
      {"POST", "/api/patients", A::kShown, K::kWrite, &Clinic::addPatient},
      {"GET", "/api/patients/#", A::kShown, K::kRead, &Clinic::patient},
      {"PUT", "/api/patients/#", A::kShown, K::kWrite, &Clinic::changePatient},
      {"DELETE", "/api/patients/#", A::kShown, K::kWrite, &Clinic::deletePatient},
      {"POST", "/api/patients/#/merge", A::kShown, K::kWrite, &Clinic::mergePatients},
      {"POST", "/api/patients/#/erase", A::kShown, K::kWrite, &Clinic::erasePatient},
      {"POST", "/api/patients/#/no_show", A::kShown, K::kWrite, &Clinic::noShow},
      {"POST", "/api/patients/#/notes", A::kShown, K::kWrite, &Clinic::notePatient},
      {"POST", "/api/patients/#/visits", A::kShown, K::kStation, &Clinic::beginVisit},
      {"POST", "/api/guest_visits", A::kShown, K::kStation, &Clinic::beginGuestVisit},
      {"GET", "/api/visits/open", A::kSigned, K::kRead, &Clinic::openVisit},
      {"GET", "/api/visits/#", A::kSigned, K::kRead, &Clinic::visit},
      {"PUT", "/api/notes/#", A::kSigned, K::kSession, &Clinic::putNote},
      {"GET", "/api/sessions", A::kShown, K::kRead, &Clinic::sessions},
      {"POST", "/api/sessions/give", A::kShown, K::kWrite, &Clinic::giveSessions},
      {"DELETE", "/api/sessions/#", A::kShown, K::kWrite, &Clinic::deleteSession},
      {"POST", "/api/visits/#/item", A::kSigned, K::kStation, &Clinic::nextItem},
      {"POST", "/api/visits/#/finish", A::kSigned, K::kStation, &Clinic::finishVisit},
      {"POST", "/api/visits/#/notes", A::kSigned, K::kWrite, &Clinic::noteVisit},
      {"POST", "/api/visits/#/pain", A::kSigned, K::kWrite, &Clinic::pain},
      {"POST", "/api/visits/#/move", A::kShown, K::kWrite, &Clinic::moveVisit},
      {"DELETE", "/api/visits/#", A::kShown, K::kWrite, &Clinic::deleteVisit},
      {"GET", "/api/export/patient/#.csv", A::kShown, K::kRead, &Clinic::exportPatient},
      {"GET", "/api/export/all.csv", A::kShown, K::kRead, &Clinic::exportAll},
  };
  return kRoutes;
}

Answer Clinic::answer(const Request& request) {
  Lock lock(mutex_);
  Call call{request, lock};
  const auto refuse = [&](const Refused& refused) {
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
  } catch (const Refused& refused) {
    refuse(refused);
  } catch (const DatabaseError& error) {
    refuse({503, "database", error.what(), {}});
    closeLost();
  } catch (const Json::exception&) {
    refuse({503, "database", "a row of the database is damaged; run wholehand-clinic verify", {}});
  } catch (const std::bad_alloc&) {
    refuse({503, "busy", "there is not enough memory; try again", {}});
  }
  return std::move(call.answer);
}

// Lets go of a database whose file is gone: it may come back.
void Clinic::closeLost() {
  try {
    if (db_) db_->checkFile();
  } catch (const DatabaseError&) {
    db_.reset();
  }
}

// Opens what is not open yet: what hindered it may be gone by the next request.
void Clinic::open() {
  if (db_) return;
  if (!presets_) {
    auto presets = loadPresets(options_.config + "/clinic/presets.toml");
    if (!presets) throw DatabaseError(format(presets.errors()));
    auto hands = loadShippedHands(options_.config + "/hands");
    if (!hands) throw DatabaseError(format(hands.errors()));
    presets_ = std::move(*presets);
    hands_ = std::move(*hands);
  }
  std::error_code error;
  const std::string path = options_.folder + "/clinic.db", keys_path = options_.folder + "/keys";
  if (!fs::exists(path, error) && (was_open_ || fs::exists(keys_path, error))) {
    throw DatabaseError(path + ": is gone: put it back, or restore a backup");
  }
  fs::create_directories(options_.folder + "/hands", error);
  if (error) throw DatabaseError(options_.folder + ": cannot be made: " + error.message());
  fs::permissions(options_.folder, fs::perms::owner_all, error);
  Database db(path, Database::Mode::kCreate);
  migrate(db);
  Statement clinic = db.query("SELECT id FROM clinic");
  if (clinic.step()) {
    const auto keys = readKeyFile(keys_path);
    if (!keys) throw DatabaseError(format(keys.errors()));
    if (keys->clinic != clinic.text(0)) {
      throw DatabaseError(keys_path +
                          ": belongs to another clinic than clinic.db; "
                          "copy the file from beside a backup of this one");
    }
  } else if (fs::exists(keys_path, error)) {
    throw DatabaseError(keys_path +
                        ": is here, but clinic.db is empty: restore a backup; "
                        "to begin anew, move the file keys away");
  }
  Statement accounts = db.query("SELECT id, failed FROM account");
  while (accounts.step()) {
    tries_[accounts.integer(0)].failed = static_cast<int>(accounts.integer(1));
  }
  last_backup_us_ = newestBackup_us(options_.backups);
  db_ = std::move(db);
  was_open_ = true;
}

void Clinic::route(Call& call) {
  open();
  bool known_path = false;
  for (const Route& route : routes()) {
    if (!matches(call.request.path, route.path, call.ids)) continue;
    known_path = true;
    if (call.request.method != route.method) continue;
    admit(call, route.access);
    call.body = parsed(call.request.body);
    return perform(call, route);
  }
  if (known_path) throw Refused{405, "not_found", "no such method here", {}};
  throw notFound("there is no " + call.request.path);
}

void Clinic::admit(Call& call, Access access) {
  if (access == Access::kAnyone) return;
  if (!key_) {
    const bool is_new = db_->number("SELECT COUNT(*) FROM clinic") == 0;
    throw Refused{423,
                  "locked",
                  is_new ? "this clinic has not begun; give it a pass phrase"
                         : "the clinic is locked; give its pass phrase or recovery code",
                  {}};
  }
  call.session_id = sha256(call.request.token);
  const auto found = sessions_.find(call.session_id);
  if (call.request.token.empty() || found == sessions_.end()) {
    throw Refused{401, "not_signed_in", "nobody is signed in; choose a tile and type its PIN", {}};
  }
  Session& session = found->second;
  const std::int64_t now_us = clock_.steady_us();
  if (now_us - session.last_us >= kHideAfter_us) session.hidden = true;
  if (call.request.path != "/api/visits/open") session.last_us = now_us;
  call.session = session;
  if (session.hidden && access == Access::kShown) {
    throw Refused{403, "hidden", "names are hidden; type the PIN to show them", {}};
  }
}

void Clinic::perform(Call& call, const Route& route) {
  const bool changes = route.kind == Kind::kWrite || route.kind == Kind::kStation;
  std::string key, digest;
  if (changes) {
    const std::string& given = call.request.key;
    if (given.empty() || given.size() > 100) {
      throw badValue("Idempotency-Key", "the header Idempotency-Key has 1 to 100 characters");
    }
    key = sha256(given);
    digest = sha256(
        fmt::format("{}\n{}\n{}", call.request.method, call.request.path, call.request.body));
    Statement before = db_->query("SELECT request, body FROM answer WHERE key = ?", key);
    if (before.step()) {
      if (before.text(0) != digest) {
        throw badValue("Idempotency-Key", "this key was used for another request; draw a new one");
      }
      call.answer.body = unseal("answer", before.text(1));
      return;
    }
  }
  if (route.kind == Kind::kWrite) begin(call);
  const Json body = (this->*route.handler)(call);
  if (call.answer.body.empty()) {
    call.answer.body = body.dump(-1, ' ', false, Json::error_handler_t::replace);
  }
  if (call.transaction) {
    if (changes && key_) {
      const std::int64_t now_us = clock_.now_us();
      db_->change("DELETE FROM answer WHERE at_us < ? OR at_us > ?", now_us - kAnswersKept_us,
                  now_us + kAnswersKept_us);
      db_->change("INSERT INTO answer VALUES (?, ?, ?, ?)", key, digest, now_us,
                  Blob{seal("answer", call.answer.body)});
    }
    call.transaction->commit();
    call.transaction.reset();
  }
  for (const auto& then : call.after) then();
}

std::string Clinic::seal(std::string_view kind, std::string_view text) const {
  return key_->seal(kind, text);
}

std::string Clinic::unseal(std::string_view kind, std::string_view sealed) const {
  auto text = key_->open(kind, sealed);
  if (!text) {
    throw DatabaseError(options_.folder +
                        "/clinic.db: a sealed text does not open with this "
                        "clinic's key: the database is damaged, restore a backup");
  }
  return std::move(*text);
}

void Clinic::log(std::int64_t account, const std::string& what, std::int64_t patient,
                 std::int64_t visit, const std::string& detail) {
  db_->change(
      "INSERT INTO log (at_us, account, what, patient, visit, detail) VALUES (?, ?, ?, ?, ?, ?)",
      clock_.now_us(), account, what, patient, visit, detail);
}

bool Clinic::tryToLog(std::int64_t account, const std::string& what, std::int64_t patient) {
  try {
    Transaction transaction(*db_);
    log(account, what, patient);
    transaction.commit();
    return true;
  } catch (const DatabaseError&) {
    return false;
  }
}

// Erased rows are overwritten at once; the log beside the database has them until it is emptied.
void Clinic::tryToCompact() {
  if (!compact_due_ || !db_) return;
  try {
    compact(*db_);
    compact_due_ = false;
  } catch (const DatabaseError&) {  // the next minute tries again
  }
}

Json Clinic::state(Call&) {
  const bool is_new = db_->number("SELECT COUNT(*) FROM clinic") == 0;
  Json tiles = Json::array();
  if (key_) {
    Statement rows = db_->query("SELECT id, name, colour FROM account ORDER BY id");
    while (rows.step()) {
      tiles.push_back({{"id", rows.integer(0)},
                       {"name", unseal("account", rows.text(1))},
                       {"colour", rows.text(2)}});
    }
  }
  const char* clinic = is_new ? "new" : "locked";
  Json backup = {{"last_us", last_backup_us_}, {"folder", options_.backups}};
  if (!backup_problem_.empty()) backup["problem"] = backup_problem_;
  Json out = {{"clinic", key_ ? "open" : clinic},
              {"tiles", std::move(tiles)},
              {"station", {{"heard", station_.scene().heard}}},
              {"visit", db_->number("SELECT id FROM visit WHERE state = 'open'")},
              {"backup", std::move(backup)},
              {"version", 1}};
  if (is_new) out["folder"] = folderFacts(options_.folder);
  return out;
}

Json Clinic::init(Call& call) {
  if (db_->number("SELECT COUNT(*) FROM clinic") != 0) {
    throw Refused{409, "changed", "this clinic has begun already; unlock it", {}};
  }
  const std::string phrase = textOf(call.body, "pass_phrase", "pass_phrase");
  if (phrase.size() < kLeastPhrase || phrase.size() > kMostPhrase) {
    throw badValue("pass_phrase", "a pass phrase has 8 to 200 characters");
  }
  const Json tile = call.body.value("tile", Json::object());
  Key key = Key::random();
  const std::string code = newRecoveryCode();
  const std::string clinic = randomHex(16);
  const std::string path = options_.folder + "/keys";
  const KeyFile keys{clinic, wrap(key, phrase, options_.cost),
                     wrap(key, *checkedRecoveryCode(code), options_.cost)};
  if (auto written = writeKeyFile(path, keys); !written) {
    throw DatabaseError(format(written.errors()));
  }
  begin(call);
  key_ = std::move(key);
  try {
    db_->change("INSERT INTO clinic VALUES (1, ?, ?)", clinic, drawnVisitNumber());
    const std::int64_t account = insertAccount(tile, "tile.");
    log(account, "began the clinic");
    call.transaction->commit();
    call.transaction.reset();
    Json signed_in = sessionOf(account);
    signed_in["recovery_code"] = code;
    return signed_in;
  } catch (...) {
    key_.reset();
    std::error_code ignored;
    fs::remove(path, ignored);
    throw;
  }
}

Json Clinic::unlock(Call& call) {
  if (key_) return Json::object();
  if (db_->number("SELECT COUNT(*) FROM clinic") == 0) {
    throw Refused{423, "locked", "this clinic has not begun; give it a pass phrase", {}};
  }
  Tries& tries = tries_[0];
  refuseWhileWaiting(tries);
  const auto keys = readKeyFile(options_.folder + "/keys");
  if (!keys) throw DatabaseError(format(keys.errors()));
  std::optional<Key> key;
  if (call.body.contains("recovery_code")) {
    const auto code = checkedRecoveryCode(textOf(call.body, "recovery_code", "recovery_code"));
    if (!code) {
      throw badValue("recovery_code",
                     "the recovery code was mistyped: its check characters do not fit; compare it "
                     "with the printed one, group by group");
    }
    key = unwrap(keys->by_recovery, *code);
  } else {
    key = unwrap(keys->by_phrase, textOf(call.body, "pass_phrase", "pass_phrase"));
  }
  if (!key) {
    countFailure(tries);
    throw Refused{401, "wrong_phrase", "this is not the clinic's pass phrase or recovery code", {}};
  }
  tries = {};
  key_ = std::move(key);
  return Json::object();
}

Json Clinic::lockClinic(Call&) {
  key_.reset();
  sessions_.clear();
  return Json::object();
}

std::string Clinic::browserKey(std::int64_t account) const {
  return key_->derived(fmt::format("browser {}", account));
}

Json Clinic::sessionOf(std::int64_t account) {
  return {
      {"token", newSession(account)}, {"account", account}, {"browser_key", browserKey(account)}};
}

std::string Clinic::newSession(std::int64_t account) {
  if (sessions_.size() >= kMostSessions) {
    const auto oldest = std::min_element(
        sessions_.begin(), sessions_.end(),
        [](const auto& a, const auto& b) { return a.second.last_us < b.second.last_us; });
    sessions_.erase(oldest);
  }
  std::string token = randomHex(32);
  sessions_[sha256(token)] = {account, clock_.steady_us(), false, 0};
  return token;
}

void Clinic::refuseWhileWaiting(const Tries& tries) const {
  const std::int64_t left_us = tries.wait_until_us - clock_.steady_us();
  if (left_us <= 0) return;
  const std::int64_t wait_s = (left_us + kSecond_us - 1) / kSecond_us;
  throw Refused{429,
                "too_many_tries",
                fmt::format("too many tries; wait {} s", wait_s),
                {},
                {{"wait_s", wait_s}}};
}

// After five wrong ones 30 s, then twice as long each time, up to an hour.
void Clinic::countFailure(Tries& tries) const {
  ++tries.failed;
  if (tries.failed < kFreeTries) return;
  const int doublings = std::min(tries.failed - kFreeTries, 10);
  const std::int64_t wait_s = std::min(kFirstWait_s << doublings, kLongestWait_s);
  tries.wait_until_us = clock_.steady_us() + wait_s * kSecond_us;
}

void Clinic::checkPin(std::int64_t account, const Json& body) {
  Statement row = db_->query("SELECT pin FROM account WHERE id = ?", account);
  if (!row.step()) throw notFound(fmt::format("there is no account {}", account));
  Tries& tries = tries_[account];
  refuseWhileWaiting(tries);
  const auto pin = body.find("pin");
  const bool right = pin != body.end() && pin->is_string() &&
                     pinMatches(unseal("pin", row.text(0)), pin->get<std::string>());
  if (right && tries.failed == 0) return;
  if (right) {
    tries = {};
  } else {
    countFailure(tries);  // counts also where the database cannot be written
  }
  try {
    db_->change("UPDATE account SET failed = ? WHERE id = ?", tries.failed, account);
  } catch (const DatabaseError&) {  // a full disk keeps nobody out
  }
  if (right) return;
  tryToLog(account, "wrong PIN");
  throw Refused{401,
                "wrong_pin",
                "this is not the tile's PIN",
                {},
                {{"tries_left", std::max(kFreeTries - tries.failed, 0)}}};
}

Json Clinic::signIn(Call& call) {
  if (!key_) throw Refused{423, "locked", "the clinic is locked; give its pass phrase", {}};
  const auto account = call.body.find("account");
  if (account == call.body.end() || !account->is_number_integer()) {
    throw badValue("account", "account is no number of a tile");
  }
  const auto id = account->get<std::int64_t>();
  checkPin(id, call.body);
  tryToLog(id, "signed in");
  return sessionOf(id);
}

Json Clinic::signOut(Call& call) {
  sessions_.erase(call.session_id);
  return Json::object();
}

Json Clinic::hide(Call& call) {
  sessions_[call.session_id].hidden = true;
  return Json::object();
}

Json Clinic::show(Call& call) {
  checkPin(call.session.account, call.body);
  sessions_[call.session_id].hidden = false;
  return {{"browser_key", browserKey(call.session.account)}};
}

std::int64_t Clinic::insertAccount(const Json& tile, const std::string& prefix) {
  const std::string name = textOf(tile, "name", prefix + "name");
  if (name.empty() || !isText(name, 60, false)) {
    throw badValue(prefix + "name", "a tile's name has 1 to 60 characters");
  }
  const std::string colour = textOf(tile, "colour", prefix + "colour");
  if (!isColour(colour)) throw badValue(prefix + "colour", "a colour is written #0d6b5a");
  const std::string pin = hashPin(pinOf(tile, prefix + "pin"));
  db_->change("INSERT INTO account (name, colour, pin) VALUES (?, ?, ?)",
              Blob{seal("account", name)}, colour, Blob{seal("pin", pin)});
  return db_->lastId();
}

Json Clinic::addAccount(Call& call) {
  const std::int64_t id = insertAccount(call.body, "");
  log(call.session.account, "added an account", 0, 0, std::to_string(id));
  return {{"account", id}};
}

void Clinic::backUpIfDue() {
  constexpr std::int64_t kDay_us = 86'400 * kSecond_us;
  const Lock lock(mutex_);
  const std::int64_t now_us = clock_.now_us();
  tryToCompact();
  if (options_.backups.empty() || !db_ || std::abs(now_us - last_backup_us_) < kDay_us) return;
  try {
    if (db_->number("SELECT COUNT(*) FROM clinic") == 0) return;
    std::string name = isoTime(now_us);
    std::erase_if(name, [](char c) { return c == '-' || c == ':'; });
    const std::string path = options_.backups + "/clinic-" + name + ".db";
    if (const auto done = backUp(options_.folder, path); !done) {
      backup_problem_ = format(done.errors());
      return;
    }
    backup_problem_.clear();
    last_backup_us_ = now_us;
    removeOldBackups(options_.backups, now_us);
    log(0, "backed up");
  } catch (const DatabaseError& error) {
    backup_problem_ = error.what();
  }
}

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
    throw changedTo(patientJson(id), "the patient has visits: move them, or erase the patient");
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

namespace {

/// So long a difference between station and database is an order on its way.
constexpr std::int64_t kApart_us = 10 * kSecond_us;
constexpr int kMostPain = 10;
constexpr std::int64_t kLastNote = (std::int64_t{1} << 48) - 1;
constexpr double kRounding = 1e-6;  // of single precision on the wire

std::string sideOf(const Json& body) {
  const Json side = body.value("side", Json());
  if (side != "right" && side != "left") throw badValue("side", "side must be right or left");
  return side;
}

/// What Clinic::trialsIn() reads.
constexpr std::string_view kTrialColumns =
    "SELECT item, recording, began_us, state, why, measures, id FROM trial";
constexpr int kMostTrials = 100;

/// "right" or "left", the end of every hand's name; empty: another.
std::string sideOfHand(const Json& measures) {
  const std::string hand = measures.value("hand", "");
  for (const char* side : {"right", "left"}) {
    if (hand.ends_with(std::string("-") + side)) return side;
  }
  return {};
}

}  // namespace

struct Clinic::VisitRow {
  std::int64_t id = 0, account = 0, began_us = 0, ended_us = 0, item = 0;
  int offset_min = 0;
  std::optional<std::int64_t> patient;
  std::string side, hand, hand_file, state;
  Plan plan;
  Json pain_before, pain_after;
  Json in_force = Json::object(), changed = Json::object(), before = Json::object();
};

Clinic::VisitRow Clinic::visitRow(std::int64_t id) {
  Statement row = db_->query(
      "SELECT patient, account, side, hand, hand_file, began_us, ended_us, offset_min, state, plan,"
      " item, pain_before, pain_after, in_force, changed, before FROM visit WHERE id = ?",
      id);
  if (!row.step()) throw notFound(fmt::format("there is no visit {}", id));
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

/// The visit of a request. While names are hidden, only the one that is open.
Clinic::VisitRow Clinic::visitOf(const Call& call) {
  return visitFor(call, call.ids.at(0));
}
Clinic::VisitRow Clinic::visitFor(const Call& call, std::int64_t id) {
  VisitRow visit = visitRow(id);
  if (call.session.hidden && visit.state != "open") {
    throw Refused{403, "hidden", "names are hidden; type the PIN to show them", {}};
  }
  return visit;
}

/// @param rows with the columns kTrialColumns
Json Clinic::trialsIn(Statement rows, const Plan& plan) {
  Json trials = Json::array();
  while (rows.step()) {
    const Json m = Json::parse(rows.text(5));
    const auto item = static_cast<std::size_t>(rows.integer(0));
    const bool planned = item < plan.size();
    const Json recording = m.value("recording", Json::object());
    trials.push_back({{"id", rows.integer(6)},
                      {"item", item},
                      {"exercise", m.value("exercise", Json(planned ? plan[item].exercise : ""))},
                      {"level", m.value("level", Json(planned ? plan[item].level : 0))},
                      {"recording", rows.text(1)},
                      {"began_us", rows.integer(2)},
                      {"duration_s", recording.value("duration_s", Json())},
                      {"side", sideOfHand(m)},
                      {"active_s", m.value("active_s", Json())},
                      {"helped_share", m.value("helped_share", Json())},
                      {"results", m.value("results", Json::array())},
                      {"peak_speed_m_s", m.value("peak_speed_m_s", Json())},
                      {"path_ratio", m.value("path_ratio", Json())},
                      {"reach_s", m.value("reach_s", Json())},
                      {"ended_by", m.value("ended_by", Json(""))},
                      {"state", rows.text(3)},
                      {"why", rows.text(4)}});
  }
  return trials;
}

Json Clinic::trialsOf(std::int64_t visit, const Plan& plan) {
  return trialsIn(
      db_->query(std::string(kTrialColumns) + " WHERE visit = ? ORDER BY began_us, id", visit),
      plan);
}

Json Clinic::visitJson(std::int64_t id, bool hidden) {
  const VisitRow v = visitRow(id);
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
          {"trials", trialsOf(id, v.plan)},
          {"notes", notesOf("visit", id, hidden)},
          {"pain_before", v.pain_before},
          {"pain_after", v.pain_after}};
}

/// Force preset, then the person's own, then what was set in the open visit; what the station has
/// narrower bounds for is clamped.
Parameters Clinic::limitsOf(const std::optional<std::int64_t>& patient, const Json& changed) {
  std::string preset = presets_->force.front().id;
  Parameters own = changed.get<Parameters>();
  if (patient) {
    Statement row = db_->query("SELECT preset, parameters FROM patient WHERE id = ?", *patient);
    if (!row.step()) throw notFound(fmt::format("there is no patient {}", *patient));
    preset = row.text(0);
    own.merge(Json::parse(row.text(1)).get<Parameters>());
  }
  const ForcePreset* force = presets_->forceOf(preset);
  if (force == nullptr) throw badValue("preset", "the patient's preset is no longer offered");
  const StationScene scene = station_.scene();
  for (const auto& [name, value] : force->parameters) {
    const auto heard = scene.bounds.find(name);
    const bool has = heard != scene.bounds.end();
    if (scene.heard && !has) continue;  // a device without such an axis
    own.emplace(name, has ? std::clamp(value, heard->second[0], heard->second[1]) : value);
  }
  return own;
}

VisitOrder Clinic::orderOf(const VisitRow& visit, std::int64_t item) {
  const Parameters limits = limitsOf(visit.patient, visit.changed);
  const PlanItem now = capped(visit.plan, limits).at(item);
  const ExerciseFacts* facts = presets_->exercise(now.exercise);
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
  for (const auto& [name, value] : limits) {
    if (has(presets_->device, name) || has(facts->parameters, name)) order.parameters[name] = value;
  }
  for (const auto& [name, value] : now.parameters) order.parameters[name] = value;
  return order;
}

/// What the station will have: an item that follows raises no limit that was lowered.
Json Clinic::inForce(const VisitOrder& order) const {
  Parameters values = order.parameters;
  const StationScene scene = station_.scene();
  for (auto& [name, value] : values) {
    const auto now = scene.values.find(name);
    const bool goes_on = scene.visit == order.visit && now != scene.values.end();
    if (goes_on && isEffortLimit(name)) value = std::min(value, now->second);
  }
  return {{"parameters", values}, {"help", order.help}, {"level", order.level}};
}

/// Keeps with the open visit what was set at the station since the last look: the item's, where it
/// names a parameter, else the person's.
void Clinic::keepSettings(VisitRow& visit) {
  const StationScene scene = station_.scene();
  const bool same = scene.visit == static_cast<std::uint64_t>(visit.id) && scene.item == visit.item;
  if (!same || !visit.in_force.contains("parameters")) return;
  PlanItem& item = visit.plan.at(visit.item);
  const Parameters limits = limitsOf(visit.patient, visit.changed);
  Json& known = visit.in_force["parameters"];
  const Json before = visit.in_force;
  for (const auto& [name, value] : scene.values) {
    const auto first = scene.initial.find(name);
    if (first == scene.initial.end() || !presets_->bounds.contains(name)) continue;
    const double was = known.value(name, first->second);
    if (std::abs(value - was) <= kRounding * std::abs(was)) continue;
    known[name] = value;
    const auto limit = limits.find(name);
    const bool above = isEffortLimit(name) && limit != limits.end() && value > limit->second;
    const bool items = item.parameters.contains(name);
    if (items) item.parameters[name] = value;
    if (!items || above) visit.changed[name] = value;
  }
  if (scene.exercise == item.exercise) {
    if (!scene.help.empty() && scene.help != visit.in_force["help"]) {
      visit.in_force["help"] = item.help = scene.help;
    }
    if (scene.level != visit.in_force["level"]) {
      visit.in_force["level"] = item.level = scene.level;
    }
  }
  if (visit.in_force == before) return;
  Transaction transaction(*db_);
  db_->change("UPDATE visit SET plan = ?, in_force = ?, changed = ? WHERE id = ?",
              toJson(visit.plan).dump(), visit.in_force.dump(), visit.changed.dump(), visit.id);
  transaction.commit();
}

/// Ends a visit: what was set in it is the person's from now on.
void Clinic::closeVisit(std::int64_t account, VisitRow visit, const std::string& state) {
  db_->change("UPDATE visit SET state = ?, ended_us = ? WHERE id = ?",
              visit.patient ? state : std::string("guest"),
              std::max(clock_.now_us(), visit.began_us), visit.id);
  if (!visit.patient || visit.changed.empty()) return;
  Statement row = db_->query("SELECT parameters, plan FROM patient WHERE id = ?", *visit.patient);
  row.step();
  Json own = Json::parse(row.text(0));
  for (const auto& [name, value] : visit.changed.items()) {
    if (own.contains(name) && own[name] == value) continue;
    if (!visit.before.contains(name)) visit.before[name] = own.value(name, Json());
    own[name] = value;
  }
  db_->change("UPDATE visit SET before = ? WHERE id = ?", visit.before.dump(), visit.id);
  db_->change("UPDATE patient SET parameters = ?, version = version + 1 WHERE id = ?", own.dump(),
              *visit.patient);
  // An item above a limit that was lowered would be refused at the next change of the person.
  db_->change("UPDATE patient SET plan = ? WHERE id = ?",
              toJson(capped(planFrom(row.text(1)), limitsOf(visit.patient))).dump(),
              *visit.patient);
  log(account, "kept settings", *visit.patient, visit.id, visit.changed.dump());
}

/// Gives the person back what the visit has changed, unless it was changed again: the visit was
/// another's.
void Clinic::takeBackSettings(const VisitRow& visit) {
  if (!visit.patient || visit.before.empty()) return;
  Statement row = db_->query("SELECT parameters FROM patient WHERE id = ?", *visit.patient);
  row.step();
  Json own = Json::parse(row.text(0));
  for (const auto& [name, value] : visit.before.items()) {
    if (own.value(name, Json()) != visit.changed.at(name)) continue;
    own[name] = value;
    if (value.is_null()) own.erase(name);
  }
  db_->change("UPDATE patient SET parameters = ?, version = version + 1 WHERE id = ?", own.dump(),
              *visit.patient);
}

/// A shipped hand of this size, or a file of the visit's own.
void Clinic::chooseHand(VisitRow& visit) {
  visit.hand = "adult-median-" + visit.side;
  if (!visit.patient) return;
  Statement row = db_->query("SELECT hands FROM patient WHERE id = ?", *visit.patient);
  row.step();
  const Json hand = Json::parse(row.text(0)).value(visit.side, Json());
  const std::string field = "hands." + visit.side;
  if (hand.is_null()) throw badValue(field, "length and breadth of this hand are missing");
  const double length_m = hand.at("length_m"), breadth_m = hand.at("breadth_m");
  visit.hand = shippedHand(hands_, visit.side, length_m, breadth_m);
  if (!visit.hand.empty()) return;
  const std::string name = fmt::format("visit-{}-{}", visit.id, visit.side);
  visit.hand_file = name + ".toml";
  const auto written =
      writeHandFile(options_.config + "/hands", options_.folder + "/hands/" + visit.hand_file, name,
                    visit.side, length_m, breadth_m);
  if (!written) throw Refused{503, "database", format(written.errors()), field};
}

void Clinic::refuseWhileOpen() {
  const std::int64_t open = db_->number("SELECT id FROM visit WHERE state = 'open'");
  if (open == 0) return;
  throw Refused{409,
                "visit_open",
                "another visit is open; finish it first",
                {},
                {{"now", visitJson(open, false)}}};
}

/// Sends an order and waits for its reply; other requests go on meanwhile.
void Clinic::ask(Call& call, const std::function<StationReply()>& order) {
  if (asking_) throw Refused{409, "busy", "the station is being asked already; try again", {}};
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
  if (reply.what == StationReply::What::kRefused) throw Refused{409, "station", reply.why, {}};
  if (reply.what == StationReply::What::kSilent) {
    throw Refused{504, "station_silent", reply.why, {}};
  }
}

std::int64_t Clinic::takeVisitNumber() {
  db_->run("UPDATE clinic SET next_visit = next_visit + 1");
  return db_->number("SELECT next_visit - 1 FROM clinic");
}

/// A visit without a plan, which is over. @return its number
std::int64_t Clinic::insertVisit(std::int64_t patient, std::int64_t account,
                                 const std::string& side, std::int64_t began_us,
                                 std::int64_t ended_us, const std::string& state) {
  const std::int64_t id = takeVisitNumber();
  db_->change(
      "INSERT INTO visit (id, patient, account, side, hand, hand_file, began_us, ended_us,"
      " offset_min, state, plan, item) VALUES (?, ?, ?, ?, '', '', ?, ?, ?, ?, '[]', 0)",
      id, patient, account, side, began_us, ended_us, clock_.offset_min(began_us), state);
  return id;
}

Json Clinic::startVisit(Call& call, std::optional<std::int64_t> patient, const std::string& side,
                        const Plan& plan) {
  if (plan.empty()) throw badValue("plan", "a visit has at least one item");
  if (asking_) throw Refused{409, "busy", "the station is being asked already; try again", {}};
  refuseWhileOpen();
  VisitRow visit;
  visit.patient = patient;
  visit.side = side;
  visit.plan = plan;
  // The row is on the disk before the station knows its number: no recording is without one.
  begin(call);
  visit.id = takeVisitNumber();
  chooseHand(visit);
  const VisitOrder order = orderOf(visit, 0);
  const std::int64_t now_us = clock_.now_us();
  db_->change(
      "INSERT INTO visit (id, patient, account, side, hand, hand_file, began_us, ended_us,"
      " offset_min, state, plan, item, in_force) VALUES (?, ?, ?, ?, ?, ?, ?, 0, ?, 'open', ?, 0,"
      " ?)",
      visit.id, patient, call.session.account, side, visit.hand, visit.hand_file, now_us,
      clock_.offset_min(now_us), toJson(plan).dump(), inForce(order).dump());
  log(call.session.account, "asked for a visit", patient.value_or(0), visit.id);
  call.transaction->commit();
  call.transaction.reset();
  try {
    ask(call, [&] { return station_.open(order); });
  } catch (const Refused& refused) {
    Transaction transaction(*db_);
    db_->change("DELETE FROM visit WHERE id = ?", visit.id);
    log(call.session.account, "visit refused", patient.value_or(0), visit.id, refused.code);
    transaction.commit();
    std::error_code ignored;
    if (!visit.hand_file.empty()) {
      std::filesystem::remove(options_.folder + "/hands/" + visit.hand_file, ignored);
    }
    throw;
  }
  begin(call);
  log(call.session.account, "began a visit", patient.value_or(0), visit.id);
  return visitJson(visit.id, call.session.hidden);
}

Json Clinic::beginVisit(Call& call) {
  const std::int64_t id = call.ids.at(0);
  checkPatient(id);
  const std::string side = sideOf(call.body);
  Statement row = db_->query("SELECT side FROM patient WHERE id = ?", id);
  row.step();
  if (row.text(0) != "both" && row.text(0) != side) {
    throw badValue("side", "the patient's affected side is " + row.text(0) + ", not " + side);
  }
  return startVisit(call, id, side,
                    readPlan(call.body.value("plan", Json::array()), "plan", limitsOf(id)));
}

Json Clinic::beginGuestVisit(Call& call) {
  return startVisit(call, {}, sideOf(call.body), presets_->plans.front().items);
}

Json Clinic::openVisit(Call& call) {
  const std::int64_t id = db_->number("SELECT id FROM visit WHERE state = 'open'");
  if (id == 0) return {{"visit", nullptr}, {"patient", nullptr}};
  Json row;
  const VisitRow visit = visitRow(id);
  if (!call.session.hidden && visit.patient) row = patientRows({}, *visit.patient).at(0);
  return {{"visit", visitJson(id, call.session.hidden)}, {"patient", row}};
}

Json Clinic::nextItem(Call& call) {
  VisitRow visit = visitOf(call);
  if (visit.state != "open" && visit.state != "unfinished") {
    throw changedTo(visitJson(visit.id, call.session.hidden), "this visit was finished meanwhile");
  }
  if (visit.state != "open") refuseWhileOpen();
  const Json item = call.body.value("item", Json());
  const auto items = static_cast<std::int64_t>(visit.plan.size());
  if (!item.is_number_integer() || item < 0 || item >= items) {
    throw badValue("item", fmt::format("item must be one of 0 to {}", items - 1));
  }
  const auto k = item.get<std::int64_t>();
  keepSettings(visit);
  const VisitOrder order = orderOf(visit, k);
  const Json in_force = inForce(order);
  ask(call, [&] { return station_.open(order); });
  begin(call);
  // Another console may have finished it meanwhile: then nothing changes, and the station is told.
  db_->change(
      "UPDATE visit SET item = ?, in_force = ?, state = 'open', ended_us = 0 WHERE id = ? AND state"
      " = ?",
      k, in_force.dump(), visit.id, visit.state);
  log(call.session.account, "began an item", visit.patient.value_or(0), visit.id,
      std::to_string(k));
  return visitJson(visit.id, call.session.hidden);
}

Json Clinic::finishVisit(Call& call) {
  VisitRow visit = visitOf(call);
  const Json state = call.body.value("state", Json());
  if (state != "done" && state != "unfinished") {
    throw badValue("state", "state must be done or unfinished");
  }
  if (visit.state != "open" && visit.state != "unfinished") {
    throw changedTo(visitJson(visit.id, call.session.hidden), "this visit was finished meanwhile");
  }
  keepSettings(visit);
  // A station that is not there has nothing open; lookAtStation() closes it when it comes back.
  if (visit.state == "open" && station_.scene().heard) {
    ask(call, [&] { return station_.close(static_cast<std::uint64_t>(visit.id)); });
  }
  begin(call);
  closeVisit(call.session.account, visit, state.get<std::string>());
  log(call.session.account, "finished a visit", visit.patient.value_or(0), visit.id, state);
  return visitJson(visit.id, call.session.hidden);
}

Json Clinic::noteVisit(Call& call) {
  const VisitRow visit = visitOf(call);
  insertNote(call, {}, visit.id);
  return visitJson(visit.id, call.session.hidden);
}

/// A note whose number the page has drawn: new, or the same again with its text of now.
Json Clinic::putNote(Call& call) {
  const std::int64_t id = call.ids.at(0);
  const auto owner = [&](const char* key) -> std::optional<std::int64_t> {
    const Json given = call.body.value(key, Json());
    if (given.is_null()) return {};
    if (!given.is_number_integer()) throw badValue(key, fmt::format("{} is no number", key));
    return given.get<std::int64_t>();
  };
  std::optional<std::int64_t> patient = owner("patient"), visit = owner("visit");
  if (id < 1 || id > kLastNote) throw badValue("", "a note has a number of 1 to 2^48 - 1");
  if (patient && visit) throw badValue("visit", "a note is a visit's or a patient's, not both");
  begin(call);
  Statement row =
      db_->query("SELECT patient, visit, account, at_us, kind FROM note WHERE id = ?", id);
  if (row.step()) {
    const auto other = [&](int column, const std::optional<std::int64_t>& given) {
      return given && (row.isNull(column) || row.integer(column) != *given);
    };
    if (other(0, patient) || other(1, visit) || row.integer(2) != call.session.account) {
      throw changed("this number is a note of another visit, patient or account");
    }
    patient = visit = {};
    if (!row.isNull(0)) patient = row.integer(0);
    if (!row.isNull(1)) visit = row.integer(1);
    call.body.emplace("at_us", row.integer(3));
    call.body.emplace("kind", row.text(4));
    db_->change("DELETE FROM note WHERE id = ?", id);
  }
  if (visit) {
    (void)visitFor(call, *visit);
  } else if (!patient) {
    throw notFound(fmt::format("there is no note {}: name its visit or patient", id));
  } else if (call.session.hidden) {
    throw Refused{403, "hidden", "names are hidden; type the PIN to show them", {}};
  } else {
    checkPatient(*patient);
  }
  insertNote(call, patient, visit, id);
  return notesOf("id", id, call.session.hidden).at(0);
}

Json Clinic::pain(Call& call) {
  const VisitRow visit = visitOf(call);
  const Json when = call.body.value("when", Json());
  if (when != "before" && when != "after") throw badValue("when", "when must be before or after");
  const Json value = call.body.value("value", Json());
  const bool number = value.is_number_integer() && value >= 0 && value <= kMostPain;
  if (!number && !value.is_null()) throw badValue("value", "pain is a whole number of 0 to 10");
  std::optional<std::int64_t> pain;
  if (number) pain = value.get<std::int64_t>();
  db_->change(when == "before" ? "UPDATE visit SET pain_before = ? WHERE id = ?"
                               : "UPDATE visit SET pain_after = ? WHERE id = ?",
              pain, visit.id);
  return visitJson(visit.id, call.session.hidden);
}

Json Clinic::moveVisit(Call& call) {
  const VisitRow visit = visitOf(call);
  if (visit.state == "open") {
    throw Refused{409,
                  "visit_open",
                  "the limits in force are the other person's: finish the visit "
                  "first",
                  {}};
  }
  const Json to = call.body.value("patient", Json());
  if (!to.is_number_integer()) throw badValue("patient", "patient is no number of a patient");
  const auto patient = to.get<std::int64_t>();
  checkPatient(patient);
  takeBackSettings(visit);
  db_->change("UPDATE visit SET patient = ?, state = ?, changed = '{}', before = '{}' WHERE id = ?",
              patient, visit.state == "guest" ? std::string("done") : visit.state, visit.id);
  log(call.session.account, "moved a visit", patient, visit.id,
      fmt::format("from {}", visit.patient.value_or(0)));
  return visitJson(visit.id, false);
}

Json Clinic::visit(Call& call) {
  const VisitRow visit = visitOf(call);
  if (visit.patient && !call.session.hidden) logOpened(call, *visit.patient);
  return visitJson(visit.id, call.session.hidden);
}

void Clinic::removeRecordings(Call& call, std::vector<std::string> recordings) {
  call.after.emplace_back([this, &call, files = ErasedFiles{std::move(recordings), {}}] {
    const auto left = removeFiles(options_.folder, options_.recordings, files);
    call.answer.body = Json({{"recordings_left", left}}).dump();
  });
}

Json Clinic::sessions(Call&) {
  const std::int64_t all = db_->number("SELECT COUNT(*) FROM trial WHERE visit IS NULL");
  return {{"sessions",
           trialsIn(db_->query(std::string(kTrialColumns) +
                                   " WHERE visit IS NULL ORDER BY began_us DESC, id DESC LIMIT ?",
                               kMostTrials),
                    {})},
          {"more", std::max(all - kMostTrials, std::int64_t{0})}};
}

/// Makes sessions that were recorded outside of a visit the trials of a new one.
Json Clinic::giveSessions(Call& call) {
  const Json to = call.body.value("patient", Json());
  if (!to.is_number_integer()) throw badValue("patient", "patient is no number of a patient");
  const auto patient = to.get<std::int64_t>();
  checkPatient(patient);
  const Json ids = call.body.value("sessions", Json());
  const bool numbers =
      ids.is_array() && !ids.empty() && ids.size() <= kMostTrials &&
      std::all_of(ids.begin(), ids.end(), [](const Json& id) { return id.is_number_integer(); });
  if (!numbers) throw badValue("sessions", "sessions is no list of numbers of sessions");
  std::int64_t began_us = std::numeric_limits<std::int64_t>::max(), ended_us = 0;
  std::string side;
  for (const Json& id : ids) {
    const Json one =
        trialsIn(db_->query(std::string(kTrialColumns) +
                                " WHERE id = ? AND visit IS NULL AND state = 'measured'",
                            id.get<std::int64_t>()),
                 {});
    if (one.empty()) {
      throw Refused{409, "changed",
                    fmt::format("session {} was given or deleted meanwhile", id.dump()),
                    "sessions"};
    }
    const std::int64_t at_us = one[0]["began_us"];
    began_us = std::min(began_us, at_us);
    const Json lasted = one[0]["duration_s"];
    const double lasted_s = lasted.is_number() ? lasted.get<double>() : 0.0;
    ended_us = std::max(ended_us, at_us + static_cast<std::int64_t>(lasted_s * 1e6));
    side = one[0]["side"];
  }
  const std::int64_t visit =
      insertVisit(patient, call.session.account, side, began_us, ended_us, "done");
  for (const Json& id : ids) {
    db_->change("UPDATE trial SET visit = ?, why = '' WHERE id = ?", visit, id.get<std::int64_t>());
  }
  log(call.session.account, "gave sessions", patient, visit, ids.dump());
  return visitJson(visit, false);
}

Json Clinic::deleteSession(Call& call) {
  const std::int64_t id = call.ids.at(0);
  Statement row = db_->query("SELECT recording FROM trial WHERE id = ? AND visit IS NULL", id);
  if (!row.step()) {
    throw changed("this session was given or deleted meanwhile");
  }
  removeRecordings(call, {row.text(0)});
  db_->change("DELETE FROM trial WHERE id = ?", id);
  log(call.session.account, "deleted a session", 0, 0, row.text(0));
  return Json::object();
}

Json Clinic::deleteVisit(Call& call) {
  const VisitRow visit = visitOf(call);
  if (visit.patient) {
    throw Refused{409,
                  "changed",
                  "only a guest's visit is deleted; move this one",
                  {},
                  {{"now", visitJson(visit.id, false)}}};
  }
  if (visit.state == "open") refuseWhileOpen();
  std::vector<std::string> recordings;
  Statement rows = db_->query("SELECT recording FROM trial WHERE visit = ?", visit.id);
  while (rows.step()) recordings.push_back(rows.text(0));
  removeRecordings(call, std::move(recordings));
  db_->change("DELETE FROM visit WHERE id = ?", visit.id);
  log(call.session.account, "deleted a guest visit", 0, visit.id);
  return Json::object();
}

void Clinic::lookAtStation() {
  const StationScene scene = station_.scene();
  std::uint64_t close = 0;
  {
    const Lock lock(mutex_);
    if (!scene.heard || asking_ || !db_) return;
    try {
      const auto open =
          static_cast<std::uint64_t>(db_->number("SELECT id FROM visit WHERE state = 'open'"));
      if (scene.visit != 0 && scene.visit == open && !scene.recording.empty()) {
        std::string name = scene.recording.substr(scene.recording.rfind('/') + 1);
        if (db_->number("SELECT COUNT(*) FROM trial WHERE recording = ?", name) == 0) {
          Transaction transaction(*db_);
          db_->change(
              "INSERT INTO trial (recording, size, modified_ns, state, why, visit, item, began_us,"
              " sha256, measures_version, measures)"
              " VALUES (?, 0, 0, 'waiting', '', ?, ?, ?, '', 0, '{}')",
              name, static_cast<std::int64_t>(open), std::int64_t{scene.item}, clock_.now_us());
          transaction.commit();
        }
      }
      const std::int64_t now_us = clock_.steady_us();
      if (scene.visit == open) {
        apart_since_us_ = 0;
        if (open != 0) {
          VisitRow visit = visitRow(static_cast<std::int64_t>(open));
          keepSettings(visit);
        }
      } else if (apart_since_us_ == 0) {
        apart_since_us_ = std::max<std::int64_t>(now_us, 1);
      } else if (now_us - apart_since_us_ >= kApart_us) {
        apart_since_us_ = 0;
        if (open != 0) {  // the station began anew, or the last change did not reach the disk
          Transaction transaction(*db_);
          closeVisit(0, visitRow(static_cast<std::int64_t>(open)), "unfinished");
          log(0, "the station has this visit no longer", 0, static_cast<std::int64_t>(open));
          transaction.commit();
        }
        close = scene.visit;
      }
    } catch (const DatabaseError&) {  // the next look tries again
    } catch (const Refused&) {
    }
  }
  if (close != 0) (void)station_.close(close);  // nobody's limits stay in force
}

}  // namespace wholehand::clinic
