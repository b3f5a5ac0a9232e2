#include "clinic/backup.hpp"

#include "clinic/intents.hpp"
#include "clinic/keys.hpp"
#include "clinic/marks.hpp"
#include "clinic/request.hpp"
#include "clinic/row_digests.hpp"
#include "clinic/rows.hpp"
#include "files/text/text_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace wholehand::clinic {
namespace {
namespace fs = std::filesystem;

constexpr std::size_t kMostNamed = 20;

/// Numbers of notes go on at random above all that are known: SQLite takes no number below the
/// largest of the table, and the next one may be that of an erased note.
constexpr const char* kDrawNotes =
    "UPDATE sqlite_sequence SET seq = max(seq, (SELECT COALESCE(MAX(id), 0) FROM note),"
    " (SELECT COALESCE(MAX(CAST(substr(line, 6) AS INTEGER)), 0) FROM mark WHERE line LIKE 'note"
    " %')) + (1 + abs(random()) % 1048576) * 16777216 WHERE name = 'note'";

std::string folderOf(const std::string& file) {
  const fs::path folder = fs::path(file).parent_path();
  return folder.empty() ? "." : folder.string();
}

/// Number of rows of every table, by the table's name.
std::map<std::string, std::int64_t> rowsOf(Database& db) {
  std::map<std::string, std::int64_t> rows;
  for (const std::string& name :
       db.all<std::string>("SELECT name FROM sqlite_schema WHERE type = 'table'")) {
    rows[name] = db.number("SELECT COUNT(*) FROM \"" + name + "\"");
  }
  return rows;
}

std::int64_t sum(const std::map<std::string, std::int64_t>& rows) {
  std::int64_t total = 0;
  for (const auto& [name, count] : rows) total += count;
  return total;
}

std::string clinicOf(Database& db) {
  std::string id = db.text("SELECT id FROM clinic");
  if (id.empty()) throw DatabaseError(db.path() + ": has no clinic; it was never begun");
  return id;
}

/// Copies a whole clinic database to a new file and compares the two. Throws on failure.
/// @param copied_us noted in the copy; 0: nothing is
std::int64_t copyCompared(const std::string& from, Database::Mode mode, const std::string& to,
                          std::int64_t copied_us, const std::string& row_key) {
  std::map<std::string, std::int64_t> before;
  {
    Database db(from, mode);
    db.run("BEGIN");  // one consistent state for the counts and the copy
    before = rowsOf(db);
    db.copyTo(to);
    db.run("COMMIT");
  }
  Database copy(to, Database::Mode::kReadWrite);
  checkIntegrity(copy);
  if (rowsOf(copy) != before) throw DatabaseError(to + ": differs from " + from);
  if (copied_us != 0) {
    if (!row_key.empty() && hasDigests(copy)) guardRows(copy, row_key);
    copy.change("UPDATE clinic SET copied_us = ?", copied_us);
  }
  copy.run("PRAGMA journal_mode = DELETE;");  // a single file without a write-ahead log
  return sum(before);
}

void migrateFile(const std::string& path) {
  Database db(path, Database::Mode::kReadWrite);
  migrate(db);
}

/// Erases from a copy what was erased while it was made. @return the marks
Lines eraseSince(const std::string& database, const std::string& copy, const std::string& row_key) {
  Database now(database, Database::Mode::kReadWrite);
  Lines lines = linesOf(now);
  Database db(copy, Database::Mode::kReadWrite);
  if (lines != linesOf(db)) {
    if (!row_key.empty() && hasDigests(db)) guardRows(db, row_key);
    Transaction transaction(db);
    addLines(db, lines);
    (void)eraseMarked(db, lines);
    transaction.commit();
    compact(db);
  }
  db.run("PRAGMA journal_mode = DELETE");
  return lines;
}

std::string madeIn(const std::string& folder) {
  return folder + "/clinic.db.restored";
}

/// Plan of the renaming that completes a restore.
std::string planIn(const std::string& folder) {
  return folder + "/restore.json";
}

void renameOrThrow(const std::string& from, const std::string& to) {
  if (const int failure = renameDurably(from, to); failure != 0) {
    throw DatabaseError(to + ": cannot be written: " + std::strerror(failure));
  }
}

/// Marks and stored actions of the database that a restore replaces; empty when it cannot be read.
struct Replaced {
  Lines lines;
  std::vector<std::string> recordings;  ///< still to be removed
  Kept kept;
};
Replaced replacedBy(const std::string& database, const std::string& clinic) {
  Replaced out;
  std::error_code error;
  if (!fs::exists(database, error)) return out;
  try {
    Database db(database, Database::Mode::kReadWrite);
    if (clinicOf(db) != clinic) return {};
    migrate(db);
    out.lines = linesOf(db);
    out.kept = keptOf(db);
    for (const std::string& names :
         db.all<std::string>("SELECT recordings FROM intent WHERE what <> 'list'")) {
      for (const Json& name : Json::parse(names)) out.recordings.push_back(name);
    }
    // One file, so that it is renamed at once.
    db.run("PRAGMA journal_mode = DELETE");
  } catch (const DatabaseError&) {  // damaged: that may be why a backup is restored
  }
  return out;
}

std::string codeOf(Database& db, const std::string& mark) {
  return db.text("SELECT code FROM patient WHERE mark = ?", mark);
}

/// What people did since the backup and have to do again, of patients who are there.
Json toDoAgain(Database& db, const Lines& all, const Lines& known) {
  std::map<std::string, std::pair<std::int64_t, Json>> last;  // by what is moved: the last time
  const std::set<std::string> before(known.begin(), known.end());
  for (const std::string& line : all) {
    const std::vector<std::string> words = wordsOf(line);
    if (words.size() != 4 || before.contains(line)) continue;
    const std::string code = codeOf(db, words[3]);
    Json entry = {{"what", words[0]}, {"to", code}};
    bool there = !code.empty();
    if (words[0] == "moved") {
      Statement visit = db.query(
          "SELECT v.began_us, p.code FROM visit v LEFT JOIN patient p ON p.id = v.patient"
          " WHERE v.id = CAST(? AS INTEGER)",
          words[2]);
      there = visit.step() && visit.text(1) != code && there;
      entry["visit"] = numberIn(words[2]);
      if (there) entry.update({{"began_us", visit.integer(0)}, {"from", visit.text(1)}});
    } else if (words[0] == "joined") {
      const std::string from = codeOf(db, words[2]);
      entry["from"] = from;
      there = there && !from.empty();
    } else {
      entry["sha256"] = words[2];
    }
    auto& slot = last[words[0] + words[2]];
    const std::int64_t count = numberIn(words[1]);
    if (count >= slot.first) slot = {count, there ? entry : Json()};
  }
  std::vector<std::pair<std::int64_t, Json>> entries;
  for (auto& [key, entry] : last) {
    if (!entry.second.is_null()) entries.push_back(std::move(entry));
  }
  std::sort(entries.begin(), entries.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  Json out = Json::array();
  for (auto& [count, entry] : entries) out.push_back(std::move(entry));
  return out;
}

/// Makes the copy that becomes the clinic's database.
void makeRestored(const std::string& file, const std::string& folder, const std::string& clinic,
                  const std::string& row_key, std::int64_t now_us, std::vector<std::string>& done) {
  const std::string made = madeIn(folder);
  removeDatabase(made);
  const std::int64_t rows = copyCompared(file, Database::Mode::kReadOnly, made, 0, {});
  Database db(made, Database::Mode::kReadWrite);
  migrate(db);
  if (clinicOf(db) != clinic) {
    throw DatabaseError(file + ".keys: belongs to another clinic than " + file);
  }
  if (!row_key.empty()) guardAndAdopt(db, row_key);
  if (const auto damaged = damagedRows(db, kMostNamed); !damaged.empty()) {
    done.push_back(
        fmt::format("damaged in this backup, and not served: {}", fmt::join(damaged, ", ")));
  }
  // All marks that are known. A clinic that ran in this folder has written all of its own here.
  const MarkList beside = readMarkList(markListIn(folderOf(file))),
                 here = readMarkList(markListIn(folder));
  const Replaced replaced = replacedBy(folder + "/clinic.db", clinic);
  const Lines known = linesOf(db);
  Transaction transaction(db);
  for (const Lines& lines : {beside.lines, here.lines, replaced.lines}) addLines(db, lines);
  const Lines all = linesOf(db);
  const std::int64_t erased = eraseMarked(db, all, replaced.kept);
  const bool whole =
      !replaced.lines.empty() ||
      std::any_of(here.lines.begin(), here.lines.end(),
                  [&](const std::string& line) { return line.starts_with("block " + clinic); });
  const std::int64_t copied_us = db.number("SELECT copied_us FROM clinic");
  const std::int64_t until_us = whole ? now_us : std::max(copied_us, beside.until_us);
  const Json again = toDoAgain(db, all, known);
  const Json restored = {
      {"at_us", now_us}, {"copied_us", copied_us}, {"until_us", until_us}, {"again", again}};
  // Recordings made after the backup use visit numbers that the restored database would assign
  // again, so a new block of numbers is drawn.
  db.change("UPDATE clinic SET next_visit = ?, restored = ?, copied_us = 0", drawBlock(db, clinic),
            restored.dump());
  db.run(kDrawNotes);
  if (db.guard()) noteSequences(db);
  db.change(
      "UPDATE visit SET state = CASE WHEN patient IS NULL THEN 'guest' ELSE 'unfinished' END"
      " WHERE state = 'open'");
  storeIntent(db, now_us, "restore", {{}, replaced.recordings});
  writeLog(db, now_us, 0, "restored", 0, 0, fmt::format("{} rows erased again", erased));
  transaction.commit();
  compact(db);
  db.run("PRAGMA journal_mode = DELETE");
  done.push_back(fmt::format("restored {} rows of {}", rows, file));
  if (erased > 0) done.push_back(fmt::format("{} erased rows stay erased", erased));
  if (!whole) {
    done.push_back(
        fmt::format("the marks of erased patients reach until {}: erase again whoever was erased "
                    "later",
                    isoTime(until_us)));
  }
  for (const Json& entry : again) {
    done.push_back(fmt::format(
        "to be done again: {} {} to {}", entry.value("what", ""),
        entry.contains("visit") ? entry["visit"].dump() : entry.value("from", "a recording"),
        entry.value("to", "")));
  }
}

void restoreInto(const std::string& file, const std::string& folder, std::int64_t now_us,
                 std::vector<std::string>& done) {
  const auto keys = readKeyFile(file + ".keys");
  if (!keys) throw DatabaseError(format(keys.errors()));
  finishRestore(folder);
  // A backup of an earlier version gets its digests here if the folder has their key, else when
  // the clinic is unlocked.
  const auto here = readKeyFile(folder + "/keys");
  const bool same = here && here->clinic == keys->clinic;
  makeRestored(file, folder, keys->clinic, same && keys->rows.empty() ? here->rows : keys->rows,
               now_us, done);
  // From here on every step may be repeated.
  Json plan = {{"database", ""}, {"keys", ""}};
  std::error_code error;
  if (fs::exists(folder + "/clinic.db", error)) {
    plan["database"] = "clinic.db.replaced-" + randomHex(4);
    done.push_back("the database that was here is now " + folder + "/" +
                   plan["database"].get<std::string>());
  }
  const auto there = readKeyFile(folder + "/keys");
  if (!there || there->clinic != keys->clinic) {
    if (auto written = writeKeyFile(folder + "/keys.restored", *keys); !written) {
      throw DatabaseError(format(written.errors()));
    }
    plan["keys"] = "keys.replaced-" + randomHex(4);
    done.push_back("its keys are those of the backup");
  }
  if (const int failure = writeDurably(planIn(folder), plan.dump()); failure != 0) {
    throw DatabaseError(planIn(folder) + ": cannot be written: " + std::strerror(failure));
  }
  finishRestore(folder);
}

/// What is wrong with a clinic's database: rows by name, changes that were lost, pages, tables.
std::vector<std::string> faultsOf(Database& db, const std::string& folder,
                                  const std::string& row_key) {
  std::vector<std::string> wrong;
  const auto collect = [&](const std::function<void()>& check) {
    try {
      check();
    } catch (const DatabaseError& error) {
      wrong.emplace_back(error.what());
    }
  };
  collect([&] { checkSchema(db); });
  collect([&] { checkIntegrity(db); });
  if (row_key.empty()) return wrong;  // of an earlier version: unlocking adds the digests
  collect([&] {
    guardRows(db, row_key);
    if (!hasDigests(db)) return;
    for (const std::string& name : damagedRows(db, kMostNamed)) {
      wrong.push_back(name + ": the row is damaged");
    }
    const ChangesBeside beside = changesBeside(counterIn(folder), row_key);
    if (beside.damaged) wrong.push_back(counterIn(folder) + ": is damaged: delete it");
    const std::int64_t lost =
        lostChanges(db) + std::max<std::int64_t>(beside.n.value_or(0) - changesIn(db), 0);
    if (lost > 0) {
      wrong.push_back(
          fmt::format("the last {} changes of rows are lost: clinic.db-wal was damaged", lost));
    }
  });
  return wrong;
}

}  // namespace

Expected<FolderLock> FolderLock::take(const std::string& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  const std::string path = folder + "/lock";
  const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (file < 0) {
    return fileFault(path, std::string("cannot be opened: ") + std::strerror(errno),
                     "give a folder that this user may write to");
  }
  if (::flock(file, LOCK_EX | LOCK_NB) != 0) {
    ::close(file);
    return fileFault(folder, "is in use by another wholehand-clinic",
                     "end that one, or do it at its page");
  }
  return FolderLock(file);
}

FolderLock::~FolderLock() {
  if (file_ >= 0) ::close(file_);
}

void finishRestore(const std::string& folder) {
  std::error_code error;
  const std::string made = madeIn(folder), database = folder + "/clinic.db";
  if (!fs::exists(planIn(folder), error)) {
    removeDatabase(made);  // one that was broken off earlier changes nothing
    fs::remove(folder + "/keys.restored", error);
    return;
  }
  std::ifstream in(planIn(folder));
  const Json plan = Json::parse(in, nullptr, false);
  if (!plan.is_object()) throw DatabaseError(planIn(folder) + ": is damaged: restore again");
  const auto kept = [&](const char* key) {
    return folder + "/" + fs::path(plan.value(key, "")).filename().string();
  };
  if (fs::exists(made, error)) {
    if (fs::exists(database, error)) {
      for (const char* tail : {"-wal", "-shm"}) {  // of a database that cannot be opened
        fs::rename(database + tail, kept("database") + tail, error);
      }
      renameOrThrow(database, kept("database"));
    }
    renameOrThrow(made, database);
  }
  const std::string keys = folder + "/keys", new_keys = keys + ".restored";
  if (fs::exists(new_keys, error)) {
    if (fs::exists(keys, error)) renameOrThrow(keys, kept("keys"));
    renameOrThrow(new_keys, keys);
  }
  fs::remove(counterIn(folder), error);  // counts the changes of the database that was here
  fs::remove(planIn(folder), error);
}

Expected<std::int64_t> backUp(const std::string& folder, const std::string& file,
                              std::int64_t now_us) {
  std::error_code error;
  fs::create_directories(folderOf(file), error);
  if (fs::exists(file, error)) return fileFault(file, "exists already", "give a new name");
  const auto keys = readKeyFile(folder + "/keys");
  if (!keys) return keys.errors();
  const std::string part = file + ".part";
  try {
    removeDatabase(part);
    migrateFile(folder + "/clinic.db");
    const std::int64_t rows =
        copyCompared(folder + "/clinic.db", Database::Mode::kReadWrite, part, now_us, keys->rows);
    const Lines lines = eraseSince(folder + "/clinic.db", part, keys->rows);
    extendMarkList(markListIn(folderOf(file)), {lines, now_us});
    if (auto written = writeKeyFile(file + ".keys", *keys); !written) return written.errors();
    if (const int failure = renameDurably(part, file); failure != 0) {
      throw DatabaseError(file + ": cannot be written: " + std::strerror(failure));
    }
    return rows;
  } catch (const DatabaseError& failure) {
    removeDatabase(part);
    return fileFault("", failure.what(), "the backup does not count");
  }
}

Expected<std::vector<std::string>> restoreBackup(const std::string& file, const std::string& folder,
                                                 std::int64_t now_us) {
  const auto lock = FolderLock::take(folder);
  if (!lock) return lock.errors();
  std::vector<std::string> done;
  try {
    restoreInto(file, folder, now_us, done);
    return done;
  } catch (const DatabaseError& failure) {
    return fileFault("", failure.what(), "correct the cause, then restore again");
  }
}

Expected<std::int64_t> verifyClinic(const std::string& folder) {
  try {
    Database db(folder + "/clinic.db", Database::Mode::kReadWrite);
    migrate(db);
    const std::string clinic = clinicOf(db);
    const auto keys = readKeyFile(folder + "/keys");
    if (!keys) return keys.errors();
    if (keys->clinic != clinic) {
      return fileFault(folder + "/keys", "belongs to another clinic than clinic.db",
                       "copy the file from beside a backup of this one");
    }
    const std::vector<std::string> wrong = faultsOf(db, folder, keys->rows);
    if (!wrong.empty()) {
      return fileFault(db.path(), fmt::format("{}", fmt::join(wrong, "; ")),
                       "restore a backup if nothing else helps");
    }
    return sum(rowsOf(db));
  } catch (const DatabaseError& failure) {
    return fileFault("", failure.what(), "restore a backup if nothing else helps");
  }
}

std::int64_t newestBackup_us(const std::string& folder) {
  std::int64_t newest_us = 0;
  std::error_code error;
  if (folder.empty()) return 0;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    struct stat file {};
    const bool is = it->path().extension() == ".db" && ::stat(it->path().c_str(), &file) == 0;
    if (is) newest_us = std::max(newest_us, file.st_mtim.tv_sec * kSecond_us);
  }
  return newest_us;
}

void removeOldBackups(const std::string& folder, std::int64_t now_us) {
  std::error_code error;
  std::vector<std::pair<std::int64_t, fs::path>> backups;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    struct stat file {};
    const bool ours = name.starts_with("clinic-") && name.ends_with(".db");
    if (!ours || ::stat(it->path().c_str(), &file) != 0) continue;
    backups.emplace_back(file.st_mtim.tv_sec * kSecond_us, it->path());
  }
  // A clock that was set forward makes every backup old: the newest ones stay.
  std::sort(backups.rbegin(), backups.rend());
  for (std::size_t i = kBackupsAlwaysKept; i < backups.size(); ++i) {
    const auto& [made_us, path] = backups[i];
    if (now_us - made_us <= kBackupsKept_us) continue;
    fs::remove(path, error);
    fs::remove(path.string() + ".keys", error);
  }
}

}  // namespace wholehand::clinic
