#include "clinic/accounts.hpp"

#include "clinic/row_digests.hpp"
#include "clinic/rows.hpp"
#include "clinic/text.hpp"
#include "loop/core/sha256.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <tuple>
#include <utility>

namespace wholehand::clinic {
namespace {

constexpr std::int64_t kHideAfter_us = 300 * kSecond_us;
constexpr int kFreeTries = 5, kFirstWait_s = 30, kLongestWait_s = 3600;
constexpr std::size_t kMostSessions = 64;
constexpr std::int64_t kGone_us = 60 * kSecond_us;  // a page that is open asks more often
constexpr const char* kRowsPurpose = "rows";
constexpr std::size_t kLeastPhrase = 8, kMostPhrase = 200, kLeastPin = 4, kMostPin = 8;

std::string pinOf(const Json& body, const std::string& field) {
  std::string pin = textOf(body, "pin", field);
  const bool digits =
      std::all_of(pin.begin(), pin.end(), [](char c) { return c >= '0' && c <= '9'; });
  if (!digits || pin.size() < kLeastPin || pin.size() > kMostPin) {
    throw badValue(field, "a PIN has 4 to 8 digits");
  }
  return pin;
}

std::string phraseOf(const Json& body, const char* key) {
  std::string phrase = textOf(body, key, key);
  if (phrase.size() < kLeastPhrase || phrase.size() > kMostPhrase) {
    throw badValue(key, "a pass phrase has 8 to 200 characters");
  }
  return phrase;
}

bool isColour(const std::string& text) {
  return text.size() == 7 && text[0] == '#' &&
         text.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
}

}  // namespace

Json Accounts::tiles() {
  Json tiles = Json::array();
  if (!records_.key()) return tiles;
  Statement rows = records_.db().query("SELECT name, left_us, id, colour FROM account ORDER BY id");
  while (rows.step()) {
    Json& tile = tiles.emplace_back(rowJson(rows, 2));
    tile["name"] = records_.unseal("account", rows.text(0));
    if (rows.integer(1) != 0) tile["left"] = true;
  }
  return tiles;
}

void Accounts::admit(Call& call, Access access) {
  if (access == Access::kAnyone) return;
  if (!records_.key()) {
    const bool is_new = records_.isNew();
    throw refusal(423, "locked",
                  is_new ? "this clinic has not begun; give it a pass phrase"
                         : "the clinic is locked; give its pass phrase or recovery code");
  }
  call.session_id = sha256(call.request.token);
  const auto found = sessions_.find(call.session_id);
  if (call.request.token.empty() || found == sessions_.end()) {
    throw refusal(401, "not_signed_in", "nobody is signed in; choose a tile and type its PIN");
  }
  Session& session = found->second;
  const std::int64_t now_us = records_.clock().steady_us();
  if (now_us - session.last_us >= kHideAfter_us) session.hidden = true;
  session.heard_us = now_us;
  if (call.request.path != "/api/visits/open") session.last_us = now_us;
  call.session = session;
  if (session.hidden && access == Access::kShown) {
    throw RequestRefusal{403, "hidden", "names are hidden; type the PIN to show them", {}};
  }
}

Json Accounts::init(Call& call) {
  if (!records_.isNew()) {
    throw RequestRefusal{409, "changed", "this clinic has begun already; unlock it", {}};
  }
  const std::string phrase = phraseOf(call.body, "pass_phrase");
  const Json tile = call.body.value("tile", Json::object());
  // Creates the key and writes the key file.
  Key key = Key::random();
  const std::string code = newRecoveryCode();
  const std::string clinic = randomHex(16);
  const std::string path = records_.options().folder + "/keys";
  const KeyFile keys{clinic, wrap(key, phrase, records_.options().cost),
                     wrap(key, *checkedRecoveryCode(code), records_.options().cost),
                     key.derived(kRowsPurpose)};
  if (auto written = writeKeyFile(path, keys); !written) {
    throw DatabaseError(format(written.errors()));
  }
  // Creates the clinic and its first account. A failure removes the key file.
  guardRows(records_.db(), keys.rows, counterIn(records_.options().folder));
  records_.begin(call);
  records_.unlock(std::move(key));
  try {
    digestAllRows(records_.db());
    records_.db().change("INSERT INTO clinic (one, id, next_visit) VALUES (1, ?, ?)", clinic,
                         drawBlock(records_.db(), clinic));
    records_.storeIntent("list");
    const std::int64_t account = insertAccount(tile, "tile.");
    records_.log(account, "began the clinic");
    call.transaction->commit();
    call.transaction.reset();
    Json signed_in = sessionOf(account);
    signed_in["recovery_code"] = code;
    return signed_in;
  } catch (...) {
    call.transaction.reset();
    records_.lock();
    records_.close();
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
    std::filesystem::remove(counterIn(records_.options().folder), ignored);
    throw;
  }
}

Json Accounts::unlock(Call& call) {
  if (records_.key()) return Json::object();
  if (records_.isNew()) {
    throw RequestRefusal{423, "locked", "this clinic has not begun; give it a pass phrase", {}};
  }
  Tries& tries = triesOf(0);
  refuseWhileWaiting(tries);
  const auto keys = readKeyFile(records_.options().folder + "/keys");
  if (!keys) throw DatabaseError(format(keys.errors()));
  Key key = unwrapped(*keys, call.body, tries);
  adoptRows(*keys, key);
  clearTries(0, tries);
  records_.unlock(std::move(key));
  return Json::object();
}

/// The clinic's key, by the pass phrase or the recovery code in the body. A failure counts.
Key Accounts::unwrapped(const KeyFile& keys, const Json& body, Tries& tries) {
  std::optional<Key> key;
  if (body.contains("recovery_code")) {
    const auto code = checkedRecoveryCode(textOf(body, "recovery_code", "recovery_code"));
    if (!code) {
      throw badValue("recovery_code",
                     "the recovery code was mistyped: its check characters do not fit; compare it "
                     "with the printed one, group by group");
    }
    key = unwrap(keys.by_recovery, *code);
  } else {
    key = unwrap(keys.by_phrase, textOf(body, "pass_phrase", "pass_phrase"));
  }
  if (!key) {
    countFailure(0, tries);
    throw refusal(401, "wrong_phrase", "this is not the clinic's pass phrase or recovery code");
  }
  return std::move(*key);
}

/// Wraps the clinic's key anew, also beside the backups of the folder of backups.
/// @return files that still have the old words
Json Accounts::rewrap(Call& call, const std::function<void(KeyFile&, const Key&)>& change) {
  Tries& tries = triesOf(0);
  refuseWhileWaiting(tries);
  const std::string path = records_.options().folder + "/keys";
  auto keys = readKeyFile(path);
  if (!keys) throw DatabaseError(format(keys.errors()));
  const Key key = unwrapped(*keys, call.body, tries);
  clearTries(0, tries);
  change(*keys, key);
  if (auto written = writeKeyFile(path, *keys); !written) {
    throw DatabaseError(format(written.errors()));
  }
  Json left = Json::array();
  std::error_code error;
  const std::string& backups = records_.options().backups;
  if (backups.empty()) return left;
  for (const auto& entry : std::filesystem::directory_iterator(backups, error)) {
    if (entry.path().extension() != ".keys") continue;
    const auto old = readKeyFile(entry.path().string());
    if (old && old->clinic != keys->clinic) continue;
    if (!old || !writeKeyFile(entry.path().string(), *keys)) left.push_back(entry.path().string());
  }
  return left;
}

Json Accounts::changePhrase(Call& call) {
  const std::string phrase = phraseOf(call.body, "new_pass_phrase");
  const Json left = rewrap(call, [&](KeyFile& keys, const Key& key) {
    keys.by_phrase = wrap(key, phrase, records_.options().cost);
  });
  records_.tryToLog(call.session.account, "changed the pass phrase");
  return {{"old_copies", left}};
}

Json Accounts::changeRecoveryCode(Call& call) {
  const std::string code = newRecoveryCode();
  const Json left = rewrap(call, [&](KeyFile& keys, const Key& key) {
    keys.by_recovery = wrap(key, *checkedRecoveryCode(code), records_.options().cost);
  });
  records_.tryToLog(call.session.account, "changed the recovery code");
  return {{"recovery_code", code}, {"old_copies", left}};
}

/// Gives the rows of an earlier version their digests. The key file is written first: with its key
/// the next start goes on.
void Accounts::adoptRows(KeyFile keys, const Key& key) {
  const std::string rows = key.derived(kRowsPurpose);
  const std::string path = records_.options().folder + "/keys";
  if (!keys.rows.empty() && keys.rows != rows) {
    throw DatabaseError(path +
                        ": is damaged: its key of rows is another clinic's; copy the file"
                        " from beside a backup");
  }
  if (keys.rows.empty()) {
    keys.rows = rows;
    if (auto written = writeKeyFile(path, keys); !written) {
      throw DatabaseError(format(written.errors()));
    }
  }
  guardAndAdopt(records_.db(), rows, counterIn(records_.options().folder));
}

Json Accounts::lockClinic(Call&) {
  records_.lock();
  sessions_.clear();
  return Json::object();
}

std::string Accounts::browserKey(std::int64_t account) const {
  return records_.key()->derived(fmt::format("browser {}", account));
}

Json Accounts::sessionOf(std::int64_t account) {
  return {
      {"token", newSession(account)}, {"account", account}, {"browser_key", browserKey(account)}};
}

std::string Accounts::newSession(std::int64_t account) {
  if (sessions_.size() >= kMostSessions) {
    // Idle ones first; among them those whose page is gone, then the oldest.
    const std::int64_t now_us = records_.clock().steady_us();
    const auto rank = [now_us](const Session& session) {
      const bool idle = session.hidden || now_us - session.last_us >= kHideAfter_us;
      const bool gone = now_us - session.heard_us >= kGone_us;
      return std::tuple(!idle, !gone, session.last_us);
    };
    sessions_.erase(std::min_element(
        sessions_.begin(), sessions_.end(),
        [&](const auto& a, const auto& b) { return rank(a.second) < rank(b.second); }));
  }
  std::string token = randomHex(32);
  const std::int64_t now_us = records_.clock().steady_us();
  sessions_[sha256(token)] = {account, now_us, now_us, false, 0};
  return token;
}

void Accounts::refuseWhileWaiting(const Tries& tries) const {
  const std::int64_t left_us = tries.wait_until_us - records_.clock().steady_us();
  if (left_us <= 0) return;
  const std::int64_t wait_s = (left_us + kSecond_us - 1) / kSecond_us;
  throw refusal(429, "too_many_tries", fmt::format("too many tries; wait {} s", wait_s),
                {{"wait_s", wait_s}});
}

/// Failed tries of an account. A wait goes on after a restart, as long as the clock says; a clock
/// that was set back does not make it longer than it was.
Accounts::Tries& Accounts::triesOf(std::int64_t account) {
  const auto [at, is_new] = tries_.try_emplace(account);
  Tries& tries = at->second;
  if (!is_new) return tries;
  Statement row =
      records_.db().query("SELECT failed, wait_s, last_us FROM tries WHERE account = ?", account);
  if (!row.step()) return tries;
  tries.failed = static_cast<int>(row.integer(0));
  const std::int64_t whole_us = row.integer(1) * kSecond_us;
  const std::int64_t passed_us = records_.clock().now_us() - row.integer(2);
  tries.wait_until_us =
      records_.clock().steady_us() + whole_us - std::clamp<std::int64_t>(passed_us, 0, whole_us);
  return tries;
}

void Accounts::clearTries(std::int64_t account, Tries& tries) {
  if (tries.failed == 0) return;
  tries = {};
  try {
    records_.db().change("DELETE FROM tries WHERE account = ?", account);
  } catch (const DatabaseError&) {  // a full disk must not keep anybody from signing in
  }
}

// Counts a failed try. After five failed tries the waiting time is 30 s; each further failure
// doubles it, up to an hour.
void Accounts::countFailure(std::int64_t account, Tries& tries) {
  ++tries.failed;
  const int doublings = std::clamp(tries.failed - kFreeTries, 0, 10);
  const std::int64_t wait_s =
      tries.failed < kFreeTries ? 0 : std::min(kFirstWait_s << doublings, kLongestWait_s);
  tries.wait_until_us = records_.clock().steady_us() + wait_s * kSecond_us;
  try {
    records_.db().change(
        "INSERT INTO tries (account, failed, wait_s, last_us) VALUES (?, ?, ?, ?) ON CONFLICT"
        " (account) DO UPDATE SET failed = excluded.failed, wait_s = excluded.wait_s, last_us ="
        " excluded.last_us",
        account, tries.failed, wait_s, records_.clock().now_us());
  } catch (const DatabaseError&) {  // counts even if the database cannot be written
  }
}

void Accounts::checkPin(std::int64_t account, const Json& body) {
  Statement row =
      records_.db().query("SELECT pin FROM account WHERE id = ? AND left_us = 0", account);
  if (!row.step()) throw notFound(fmt::format("there is no account {}", account));
  Tries& tries = triesOf(account);
  refuseWhileWaiting(tries);
  const auto pin = body.find("pin");
  const bool right = pin != body.end() && pin->is_string() &&
                     pinMatches(records_.unseal("pin", row.text(0)), pin->get<std::string>());
  if (right && tries.failed == 0) return;
  if (right) return clearTries(account, tries);
  countFailure(account, tries);
  records_.tryToLog(account, "wrong PIN");
  throw refusal(401, "wrong_pin", "this is not the tile's PIN",
                {{"tries_left", std::max(kFreeTries - tries.failed, 0)}});
}

Json Accounts::signIn(Call& call) {
  if (!records_.key())
    throw RequestRefusal{423, "locked", "the clinic is locked; give its pass phrase", {}};
  const std::int64_t id = integerOf(call.body, "account", "account is no number of a tile");
  checkPin(id, call.body);
  records_.tryToLog(id, "signed in");
  return sessionOf(id);
}

Json Accounts::signOut(Call& call) {
  sessions_.erase(call.session_id);
  return Json::object();
}

Json Accounts::hide(Call& call) {
  sessions_[call.session_id].hidden = true;
  return Json::object();
}

Json Accounts::show(Call& call) {
  checkPin(call.session.account, call.body);
  sessions_[call.session_id].hidden = false;
  return {{"browser_key", browserKey(call.session.account)}};
}

std::int64_t Accounts::insertAccount(const Json& tile, const std::string& prefix) {
  const std::string name = textOf(tile, "name", prefix + "name");
  if (name.empty() || !isText(name, 60, false)) {
    throw badValue(prefix + "name", "a tile's name has 1 to 60 characters");
  }
  const std::string colour = textOf(tile, "colour", prefix + "colour");
  if (!isColour(colour)) throw badValue(prefix + "colour", "a colour is written #0d6b5a");
  const std::string pin = hashPin(pinOf(tile, prefix + "pin"));
  records_.db().change("INSERT INTO account (name, colour, pin) VALUES (?, ?, ?)",
                       Blob{records_.seal("account", name)}, colour,
                       Blob{records_.seal("pin", pin)});
  return records_.db().lastId();
}

Json Accounts::addAccount(Call& call) {
  const std::int64_t id = insertAccount(call.body, "");
  records_.log(call.session.account, "added an account", 0, 0, std::to_string(id));
  return {{"account", id}};
}

Json Accounts::changePin(Call& call) {
  const std::string pin = hashPin(pinOf({{"pin", call.body.value("new_pin", "")}}, "new_pin"));
  checkPin(call.session.account, call.body);
  records_.begin(call);
  records_.db().change("UPDATE account SET pin = ? WHERE id = ?", Blob{records_.seal("pin", pin)},
                       call.session.account);
  records_.log(call.session.account, "changed the PIN");
  return Json::object();
}

Json Accounts::leave(Call& call) {
  const std::int64_t account = call.ids.at(0);
  if (account == call.session.account) {
    throw RequestRefusal{409, "own_account", "nobody takes themselves off the list", {}};
  }
  if (records_.db().change("UPDATE account SET left_us = ? WHERE id = ? AND left_us = 0",
                           records_.clock().now_us(), account) == 0) {
    throw notFound("there is no such colleague");
  }
  records_.log(call.session.account, "took a colleague off", 0, 0, std::to_string(account));
  call.after.emplace_back([this, account] {
    std::erase_if(sessions_, [&](const auto& each) { return each.second.account == account; });
  });
  return Json::object();
}

void Accounts::logOpened(const Call& call, std::int64_t patient) {
  Session& session = sessions_[call.session_id];
  if (session.opened_patient != patient &&
      records_.tryToLog(call.session.account, "opened", patient)) {
    session.opened_patient = patient;
  }
}

}  // namespace wholehand::clinic
