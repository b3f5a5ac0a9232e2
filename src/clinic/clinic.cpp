#include "clinic/clinic.hpp"

#include "clinic/backup.hpp"
#include "clinic/text.hpp"
#include "core/sha256.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <new>
#include <sodium.h>
#include <string_view>
#include <utility>

/// Requests, sessions and keys; patients and visits are in files of their own.
namespace wholehand::clinic {
namespace {
namespace fs = std::filesystem;

constexpr std::int64_t kSecond_us = 1'000'000, kHideAfter_us = 300 * kSecond_us;
constexpr std::int64_t kAnswersKept_us = 2 * 86'400 * kSecond_us;
constexpr int kFreeTries = 5, kFirstWait_s = 30, kLongestWait_s = 3600;
constexpr std::size_t kMostSessions = 64, kMostDepth = 16;
constexpr std::size_t kLeastPhrase = 8, kMostPhrase = 200, kLeastPin = 4, kMostPin = 8;

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

}  // namespace wholehand::clinic
