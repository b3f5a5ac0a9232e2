#include "clinic/backup.hpp"

#include "clinic/keys.hpp"
#include "files/text/text_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <map>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace wholehand::clinic {
namespace {
namespace fs = std::filesystem;

constexpr std::int64_t kVisitsPerBlock = 1 << 20;  // keeps numbers below 2^53, the integers of JSON

std::set<std::string> marksIn(const std::string& path) {
  std::set<std::string> marks;
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    if (!line.empty() && line[0] != '#') marks.insert(line);
  }
  return marks;
}

void addMarks(const std::string& path, const std::set<std::string>& more) {
  std::set<std::string> marks = marksIn(path);
  const std::size_t before = marks.size();
  marks.insert(more.begin(), more.end());
  if (marks.size() == before) return;
  std::string text = "# Erased patients, by random marks: a restored backup has them no longer.\n";
  for (const std::string& mark : marks) text += mark + "\n";
  if (const int error = writeDurably(path, text); error != 0) {
    throw DatabaseError(path + ": cannot be written: " + std::strerror(error) +
                        "; nothing was erased");
  }
}

std::string folderOf(const std::string& file) {
  const fs::path folder = fs::path(file).parent_path();
  return folder.empty() ? "." : folder.string();
}

/// Number of rows of every table, by the table's name.
std::map<std::string, std::int64_t> rowsOf(Database& db) {
  std::map<std::string, std::int64_t> rows;
  Statement tables = db.query("SELECT name FROM sqlite_schema WHERE type = 'table'");
  while (tables.step()) {
    const std::string name = tables.text(0);
    rows[name] = db.number("SELECT COUNT(*) FROM \"" + name + "\"");
  }
  return rows;
}

std::int64_t sum(const std::map<std::string, std::int64_t>& rows) {
  std::int64_t total = 0;
  for (const auto& [name, count] : rows) total += count;
  return total;
}

void checkIntegrity(Database& db) {
  Statement check = db.query("PRAGMA integrity_check");
  if (!check.step() || check.text(0) != "ok") {
    throw DatabaseError(db.path() + ": is damaged: " + check.text(0));
  }
  Statement references = db.query("PRAGMA foreign_key_check");
  if (references.step()) {
    throw DatabaseError(db.path() + ": a row of " + references.text(0) + " refers to none");
  }
}

std::string clinicOf(Database& db) {
  Statement row = db.query("SELECT id FROM clinic");
  if (!row.step()) throw DatabaseError(db.path() + ": has no clinic; it was never begun");
  return row.text(0);
}

/// Copies a whole clinic database to a new file and compares the two. Throws on failure.
std::int64_t copyCompared(const std::string& from, Database::Mode mode, const std::string& to) {
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
  copy.run("PRAGMA journal_mode = DELETE;");  // a single file without a write-ahead log
  return sum(before);
}

void removeDatabase(const std::string& path) {
  std::error_code ignored;
  for (const char* tail : {"", "-wal", "-shm", "-journal"}) fs::remove(path + tail, ignored);
}

void restoreInto(const std::string& file, const std::string& folder,
                 std::vector<std::string>& done) {
  const auto keys = readKeyFile(file + ".keys");
  if (!keys) throw DatabaseError(format(keys.errors()));
  const std::string made = folder + "/clinic.db.restored";
  removeDatabase(made);
  const std::int64_t rows = copyCompared(file, Database::Mode::kReadOnly, made);
  std::set<std::string> marks = marksIn(folder + "/erased");
  marks.merge(marksIn(folderOf(file) + "/erased"));
  {
    Database db(made, Database::Mode::kReadWrite);
    migrate(db);
    if (clinicOf(db) != keys->clinic) {
      throw DatabaseError(file + ".keys: belongs to another clinic than " + file);
    }
    int erased = 0;
    for (const std::string& mark : marks) {
      const std::int64_t patient = db.number("SELECT id FROM patient WHERE mark = ?", mark);
      if (patient == 0) continue;
      Transaction transaction(db);
      (void)eraseRows(db, patient);
      db.change(
          "INSERT INTO log (at_us, account, what, patient, visit, detail)"
          " VALUES (0, 0, 'erased again after a restore', ?, 0, '')",
          patient);
      transaction.commit();
      ++erased;
    }
    // Recordings made after the backup use visit numbers that the restored database would assign
    // again, so a new block of numbers is drawn.
    db.change("UPDATE clinic SET next_visit = ?", drawnVisitNumber());
    db.change(
        "UPDATE visit SET state = CASE WHEN patient IS NULL THEN 'guest' ELSE 'unfinished' END"
        " WHERE state = 'open'");
    compact(db);
    done.push_back(fmt::format("restored {} rows of {}", rows, file));
    if (erased > 0) done.push_back(fmt::format("{} erased stay erased", erased));
  }
  addMarks(folder + "/erased", marks);
  const std::string database = folder + "/clinic.db";
  std::error_code error;
  if (fs::exists(database, error)) {
    const std::string kept = database + ".replaced-" + randomHex(4);
    for (const char* tail : {"", "-wal", "-shm"}) fs::rename(database + tail, kept + tail, error);
    done.push_back("the database that was here is now " + kept);
  }
  if (const int failure = renameDurably(made, database); failure != 0) {
    throw DatabaseError(database + ": cannot be written: " + std::strerror(failure));
  }
  const auto there = readKeyFile(folder + "/keys");
  if (there && there->clinic == keys->clinic) return;
  if (fs::exists(folder + "/keys", error)) {
    fs::rename(folder + "/keys", folder + "/keys.replaced-" + randomHex(4), error);
  }
  if (auto written = writeKeyFile(folder + "/keys", *keys); !written) {
    throw DatabaseError(format(written.errors()));
  }
  done.push_back("its keys are those of the backup");
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

Expected<std::int64_t> backUp(const std::string& folder, const std::string& file) {
  std::error_code error;
  fs::create_directories(folderOf(file), error);
  if (fs::exists(file, error)) return fileFault(file, "exists already", "give a new name");
  const auto keys = readKeyFile(folder + "/keys");
  if (!keys) return keys.errors();
  const std::string part = file + ".part";
  try {
    removeDatabase(part);
    const std::int64_t rows = copyCompared(folder + "/clinic.db", Database::Mode::kReadWrite, part);
    addMarks(folderOf(file) + "/erased", marksIn(folder + "/erased"));
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

Expected<std::vector<std::string>> restoreBackup(const std::string& file,
                                                 const std::string& folder) {
  const auto lock = FolderLock::take(folder);
  if (!lock) return lock.errors();
  std::vector<std::string> done;
  try {
    restoreInto(file, folder, done);
    return done;
  } catch (const DatabaseError& failure) {
    removeDatabase(folder + "/clinic.db.restored");
    return fileFault("", failure.what(), "the folder is as it was");
  }
}

Expected<std::int64_t> verifyClinic(const std::string& folder) {
  try {
    Database db(folder + "/clinic.db", Database::Mode::kReadWrite);
    migrate(db);
    checkIntegrity(db);
    const std::string clinic = clinicOf(db);
    const auto keys = readKeyFile(folder + "/keys");
    if (!keys) return keys.errors();
    if (keys->clinic != clinic) {
      return fileFault(folder + "/keys", "belongs to another clinic than clinic.db",
                       "copy the file from beside a backup of this one");
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
  std::vector<fs::path> old;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    struct stat file {};
    const bool ours = name.starts_with("clinic-") && name.ends_with(".db");
    if (!ours || ::stat(it->path().c_str(), &file) != 0) continue;
    if (now_us - file.st_mtim.tv_sec * kSecond_us > kBackupsKept_us) old.push_back(it->path());
  }
  for (const fs::path& path : old) {
    fs::remove(path, error);
    fs::remove(path.string() + ".keys", error);
  }
}

std::set<std::string> marksOf(Database& db, std::int64_t patient) {
  std::set<std::string> marks;
  Statement rows = db.query(
      "SELECT mark FROM patient WHERE id = ?1 UNION SELECT mark FROM merged WHERE patient = ?1",
      patient);
  while (rows.step()) marks.insert(rows.text(0));
  return marks;
}

void listErased(const std::string& folder, const std::string& backups,
                const std::set<std::string>& marks) {
  addMarks(folder + "/erased", marks);
  if (!backups.empty()) {
    std::error_code ignored;
    fs::create_directories(backups, ignored);
    addMarks(backups + "/erased", marks);
  }
}

ErasedFiles eraseRows(Database& db, std::int64_t patient) {
  ErasedFiles files;
  {
    Statement rows = db.query(
        "SELECT t.recording FROM trial t JOIN visit v ON v.id = t.visit WHERE v.patient = ?",
        patient);
    while (rows.step()) files.recordings.push_back(rows.text(0));
    Statement hands =
        db.query("SELECT hand_file FROM visit WHERE patient = ? AND hand_file <> ''", patient);
    while (hands.step()) files.hands.push_back(hands.text(0));
  }
  db.change("DELETE FROM visit WHERE patient = ?", patient);  // its trials and notes are deleted
                                                              // with it
  db.change("DELETE FROM patient WHERE id = ?", patient);
  db.run("DELETE FROM answer");
  return files;
}

std::vector<std::string> removeFiles(const std::string& folder, const std::string& recordings,
                                     const ErasedFiles& files) {
  std::vector<std::string> left;
  std::error_code error;
  for (const std::string& hand : files.hands) fs::remove(folder + "/hands/" + hand, error);
  if (recordings.empty()) return files.recordings;
  for (const std::string& name : files.recordings) {
    const std::string stem = fs::path(name).stem().string();
    std::vector<fs::path> parts;  // the recording, its JSON file and its input journal
    for (fs::directory_iterator it(recordings, error), end; !error && it != end;
         it.increment(error)) {
      if (it->path().filename().string().starts_with(stem + ".")) parts.push_back(it->path());
    }
    for (const fs::path& part : parts) fs::remove(part, error);
    const std::string report = stem + "-report";  // report page that the station made
    fs::remove_all(fs::path(recordings) / report, error);
    for (const std::string& removed : {name, report}) {
      if (fs::exists(fs::path(recordings) / removed, error)) left.push_back(removed);
    }
  }
  return left;
}

void compact(Database& db) {
  db.run("VACUUM");
  db.run("PRAGMA wal_checkpoint(TRUNCATE)");
}

std::int64_t drawnVisitNumber() {
  return std::int64_t{randomBelow(0xFFFF'FFFEU) + 1U} * kVisitsPerBlock + 1;
}

}  // namespace wholehand::clinic
