#include "clinic/records.hpp"

#include "clinic/backup.hpp"
#include "clinic/row_digests.hpp"
#include "clinic/rows.hpp"
#include "clinic/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <system_error>
#include <utility>

namespace wholehand::clinic {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostNamed = 20;
/// A clock that is slewed, or set by a network in everyday use, does not jump.
constexpr std::int64_t kJump_us = 60 * kSecond_us;

/// First fault of pages; empty: none. Values that a table does not allow are not judged: digests
/// name their rows.
std::string faultOf(Database& db) {
  Statement rows = db.query("PRAGMA integrity_check");
  while (rows.step()) {
    std::string line = rows.text(0);
    const bool value = line.starts_with("CHECK constraint") || line.starts_with("NULL value") ||
                       line.starts_with("non-") || line.find(" value in ") != std::string::npos;
    if (line != "ok" && !value) return line;
  }
  return {};
}

/// Throws when pages of tables are damaged. Damaged indexes are made anew.
void checkTables(Database& db) {
  if (faultOf(db).empty()) return;
  db.run("REINDEX");
  if (const std::string fault = faultOf(db); !fault.empty()) {
    throw DatabaseError(db.path() + ": is damaged: " + fault + "; restore a backup");
  }
}

/// Guards the rows. Changes that a damaged write-ahead log lost are noted until somebody confirms
/// them.
void guardFrom(Database& db, const std::string& folder, const std::string& row_key) {
  const ChangesBeside beside = changesBeside(counterIn(folder), row_key);
  guardAndAdopt(db, row_key, counterIn(folder));
  const std::int64_t lost = beside.n.value_or(0) - changesIn(db);
  if (lost <= 0) return;
  Transaction transaction(db);
  setLostChanges(db, lost + lostChanges(db));
  transaction.commit();
}

}  // namespace

// Closes a database whose file has disappeared; the file may come back.
void Records::closeLost() {
  try {
    if (db_) db_->checkFile();
  } catch (const DatabaseError&) {
    db_.reset();
  }
}

// Opens everything that is not open yet. The cause of an earlier failure may be gone by the next
// request.
void Records::open() {
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
  fs::create_directories(options_.folder + "/hands", error);
  if (error) throw DatabaseError(options_.folder + ": cannot be made: " + error.message());
  fs::permissions(options_.folder, fs::perms::owner_all, error);
  finishRestore(options_.folder);
  // Refuses to create a new database where one existed before.
  const std::string path = options_.folder + "/clinic.db", keys_path = options_.folder + "/keys";
  if (!fs::exists(path, error) && (was_open_ || fs::exists(keys_path, error))) {
    throw DatabaseError(path + ": is gone: put it back, or restore a backup");
  }
  Database db(path, Database::Mode::kCreate);
  migrate(db);
  checkTables(db);
  checkSchema(db);
  // Checks that the key file belongs to this database.
  Statement clinic = db.query("SELECT id FROM clinic");
  if (clinic.step()) {
    const auto keys = readKeyFile(keys_path);
    if (!keys) throw DatabaseError(format(keys.errors()));
    if (keys->clinic != clinic.text(0)) {
      throw DatabaseError(keys_path +
                          ": belongs to another clinic than clinic.db; "
                          "copy the file from beside a backup of this one");
    }
    if (!keys->rows.empty()) {
      guardFrom(db, options_.folder, keys->rows);
      damaged_ = damagedRows(db, kMostNamed);
    }
  } else if (fs::exists(keys_path, error)) {
    throw DatabaseError(keys_path +
                        ": is here, but clinic.db is empty: restore a backup; "
                        "to begin anew, move the file keys away");
  }
  removeUnnamedHandFiles(db, options_.folder);
  last_backup_us_ = newestBackup_us(options_.backups);
  db_ = std::move(db);
  ++opening_;
  was_open_ = true;
}

Database& Records::db() {
  if (!db_) throw DatabaseError(options_.folder + "/clinic.db: was closed meanwhile; try again");
  return *db_;
}

const Key& Records::openKey() const {
  if (!key_) throw DatabaseError("the clinic was locked meanwhile; unlock it and try again");
  return *key_;
}

std::string Records::seal(std::string_view kind, std::string_view text) const {
  return openKey().seal(kind, text);
}

std::string Records::unseal(std::string_view kind, std::string_view sealed) const {
  auto text = openKey().open(kind, sealed);
  if (!text) {
    throw DatabaseError(options_.folder +
                        "/clinic.db: a sealed text does not open with this "
                        "clinic's key: the database is damaged, restore a backup");
  }
  return std::move(*text);
}

void Records::log(std::int64_t account, const std::string& what, std::int64_t patient,
                  std::int64_t visit, const std::string& detail) {
  writeLog(db(), clock_.now_us(), account, what, patient, visit, detail);
}

bool Records::tryToLog(std::int64_t account, const std::string& what, std::int64_t patient) {
  try {
    Transaction transaction(db());
    log(account, what, patient);
    transaction.commit();
    return true;
  } catch (const DatabaseError&) {
    return false;
  }
}

void Records::storeIntent(const std::string& what, const Erasure& erasure) {
  clinic::storeIntent(db(), clock_.now_us(), what, erasure);
}

std::vector<std::string> Records::removeErased() {
  std::vector<std::string> left;
  try {
    left = removeErasedFiles(db(), places(), clock_.now_us());
    compact();
  } catch (const DatabaseError&) {  // the intent stays: Clinic::carryOut() tries again
  }
  return left;
}

void Records::compact() {
  readers_.end();
  clinic::compact(db());
}

void Records::forgetDamaged(const std::string& name) {
  std::erase_if(damaged_, [&](const std::string& row) {
    return row == name || row.starts_with(name + " of ");
  });
}

Json Records::underWay() {
  Json out = Json::array();
  Statement rows = db().query("SELECT what, at_us, problem FROM intent ORDER BY n");
  while (rows.step()) out.push_back(rowJson(rows));
  return out;
}

void Records::watchClock() {
  const std::int64_t now_us = clock_.now_us(), boot_us = clock_.boot_us();
  std::int64_t ahead_us = 0;
  if (seen_us_ != 0) {
    ahead_us = (now_us - seen_us_) - (boot_us - seen_boot_us_);
  } else if (db_) {  // since the last process
    ahead_us = std::min<std::int64_t>(
        now_us - db_->number("SELECT at_us FROM log ORDER BY n DESC LIMIT 1"), 0);
  } else {
    return;
  }
  seen_us_ = now_us;
  seen_boot_us_ = boot_us;
  if (std::abs(ahead_us) >= kJump_us) jumped_ = true;
  if (!jumped_ || !db_ || !db_->guard()) return;
  try {
    Transaction transaction(*db_);
    if (clockJump(*db_) == 0) setClockJump(*db_, now_us);
    log(0, "the clock jumped", 0, 0, fmt::format("by {} s", ahead_us / kSecond_us));
    transaction.commit();
    jumped_ = false;
  } catch (const DatabaseError&) {  // the disk is full: the jump is noted later
  }
}

bool Records::clockJumped() {
  return jumped_ || (db_ && clockJump(*db_) != 0);
}

void Records::confirmClock() {
  setClockJump(db(), 0);
  jumped_ = false;
}

void Records::backUpIfDue() {
  const std::int64_t now_us = clock_.now_us();
  if (options_.backups.empty() || !db_ || std::abs(now_us - last_backup_us_) < kDay_us) return;
  try {
    if (isNew()) return;
    if (const auto done = backUpTo(options_.backups); !done) {
      backup_problem_ = format(done.errors());
      return;
    }
    log(0, "backed up");
  } catch (const DatabaseError& error) {
    backup_problem_ = error.what();
  }
}

Expected<std::string> Records::backUpTo(const std::string& folder) {
  const std::int64_t now_us = clock_.now_us();
  std::string name = isoTime(now_us);
  std::erase_if(name, [](char c) { return c == '-' || c == ':'; });
  const std::string path = folder + "/clinic-" + name + ".db";
  if (const auto done = backUp(options_.folder, path, now_us); !done) return done.errors();
  if (folder == options_.backups) {
    backup_problem_.clear();
    last_backup_us_ = now_us;
    if (!clockJumped()) removeOldBackups(folder, now_us);
  }
  return path;
}

Json Records::backupFacts() const {
  Json facts = {{"last_us", last_backup_us_}, {"folder", options_.backups}};
  if (!backup_problem_.empty()) facts["problem"] = backup_problem_;
  return facts;
}

}  // namespace wholehand::clinic
