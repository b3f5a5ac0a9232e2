#include "clinic/intents.hpp"

#include "clinic/readers.hpp"
#include "clinic/request.hpp"
#include "clinic/row_digests.hpp"
#include "clinic/rows.hpp"
#include "files/text/text_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <functional>
#include <set>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace wholehand::clinic {
namespace {
namespace fs = std::filesystem;

constexpr std::string_view kReport = "-report";

void append(Lines& lines, const Lines& more) {
  lines.insert(lines.end(), more.begin(), more.end());
}

std::vector<fs::path> filesIn(const std::string& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    files.push_back(it->path());
  }
  return files;
}

/// Makes removals durable.
void syncFolder(const std::string& folder) {
  const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return;
  (void)::fsync(file);
  ::close(file);
}

/// True for the end of a file name that accompanies a recording: "h5", "h5.json", "wbb",
/// "part2.h5"; not for "h5.h5", another recording.
bool accompanies(std::string_view end) {
  if (end == "h5" || !end.ends_with(".h5")) return true;
  end.remove_suffix(3);
  if (!end.starts_with("part")) return false;
  end.remove_prefix(4);
  return !end.empty() && end.find_first_not_of("0123456789") == std::string_view::npos;
}

/// True when a file of the recordings' folder belongs to a recording with one of these stems.
bool belongsTo(const std::string& name, const std::set<std::string>& stems) {
  if (name.ends_with(kReport) && stems.contains(name.substr(0, name.size() - kReport.size()))) {
    return true;
  }
  for (std::size_t dot = name.find('.'); dot != std::string::npos; dot = name.find('.', dot + 1)) {
    if (stems.contains(name.substr(0, dot)) &&
        accompanies(std::string_view(name).substr(dot + 1))) {
      return true;
    }
  }
  return false;
}

/// Removes files of the recordings' folder. @return those that could not be removed
std::vector<std::string> removeFiles(const std::string& recordings,
                                     const std::function<bool(const std::string&)>& wanted) {
  std::vector<std::string> left;
  for (const fs::path& path : filesIn(recordings)) {
    const std::string name = path.filename().string();
    if (!wanted(name)) continue;
    std::error_code error;
    fs::remove_all(path, error);
    const bool shown = path.extension() == ".h5" || name.ends_with(kReport);
    if (fs::exists(fs::symlink_status(path, error)) && shown) left.push_back(name);
  }
  syncFolder(recordings);
  return left;
}

std::string stemOf(const std::string& name) {
  return fs::path(name).stem().string();
}

/// Recording that a file accompanies.
std::string recordingOf(const std::string& name) {
  const std::string stem = name.ends_with(kReport) ? name.substr(0, name.size() - kReport.size())
                                                   : name.substr(0, name.find('.'));
  return stem + ".h5";
}

bool isTail(const fs::path& path) {
  const std::string name = path.filename().string();
  return name.ends_with("-wal") || name.ends_with("-shm") || name.ends_with("-journal");
}

/// Backups and replaced databases. Removes what an action that was broken off left beside them.
std::vector<std::string> copiesOf(const Places& places) {
  std::vector<std::string> copies;
  for (const std::string& folder : {places.backups, places.folder}) {
    if (folder.empty()) continue;
    for (const fs::path& path : filesIn(folder)) {
      const std::string name = path.filename().string();
      std::error_code error;
      const bool unfinished =
          name.find(".db.part") != std::string::npos || name.find(".erasing") != std::string::npos;
      if (unfinished) fs::remove(path, error);
      if (unfinished || isTail(path) || !fs::is_regular_file(path, error)) continue;
      const bool backup = folder == places.backups && path.extension() == ".db";
      if (backup && path.filename() != "clinic.db") copies.push_back(path.string());
      if (name.starts_with("clinic.db.replaced-")) copies.push_back(path.string());
    }
  }
  std::sort(copies.begin(), copies.end());
  copies.erase(std::unique(copies.begin(), copies.end()), copies.end());
  return copies;
}

/// Erases from a database that nobody has open. @return its marks; empty: it has no such row
Lines eraseFromCopy(const std::string& folder, const std::string& path, const Lines& lines,
                    const Kept& kept) {
  const std::string part = path + ".erasing";
  std::error_code error;
  // The log of a replaced database becomes a part of it: it would be read into the new file.
  if (fs::exists(path + "-wal", error)) {
    Database(path, Database::Mode::kReadWrite).run("PRAGMA journal_mode = DELETE");
  }
  {
    Database db(path, Database::Mode::kReadOnly);
    if (!hasMarked(db, lines)) return {};
    db.copyTo(part);
  }
  Lines after;
  {
    Database db(part, Database::Mode::kReadWrite);
    migrate(db);
    guardByKeys(db, folder, true);
    Transaction transaction(db);
    addLines(db, lines);
    (void)eraseMarked(db, lines, kept);
    transaction.commit();
    checkIntegrity(db);
    after = linesOf(db);
    if (hasMarked(db, after)) throw DatabaseError(part + ": still has what was to be erased");
    compact(db);
    db.run("PRAGMA journal_mode = DELETE");
  }
  fs::last_write_time(part, fs::last_write_time(path, error), error);  // the age of a backup
  if (const int failure = renameDurably(part, path); failure != 0) {
    throw DatabaseError(path + ": cannot be written: " + std::strerror(failure));
  }
  return after;
}

void emptyLog(Database& db) {
  std::vector<std::string> readers = otherReaders(db.path());
  if (readers.empty()) {
    // With a reader, SQLite answers a row and no error.
    Statement row = db.query("PRAGMA wal_checkpoint(TRUNCATE)");
    if (row.step() && row.integer(0) == 0) return;
    readers = otherReaders(db.path());
    if (readers.empty()) readers.emplace_back("another program");
  }
  throw ReadByOthers(
      fmt::format("{}: {} {} it, so that its write-ahead log still holds what was"
                  " erased: end that program",
                  db.path(), fmt::join(readers, ", "), readers.size() == 1 ? "reads" : "read"));
}

}  // namespace

void removeDatabase(const std::string& path) {
  std::error_code ignored;
  for (const char* tail : {"", "-wal", "-shm", "-journal"}) fs::remove(path + tail, ignored);
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

Erasure erasureOfVisit(Database& db, std::int64_t visit) {
  Erasure out;
  out.lines = linesOfVisit(db, visit);
  append(out.lines,
         db.all<std::string>("SELECT 'note ' || id FROM note WHERE visit = ? ORDER BY id", visit));
  // The visit's number in the file, else the table.
  out.recordings = db.all<std::string>(
      "SELECT recording FROM trial WHERE visit = ?1 OR json_extract(measures, '$.visit') ="
      " ?1 OR sha256 IN (SELECT sha256 FROM trial WHERE visit = ?1 AND sha256 <> '')",
      visit);
  return out;
}

Erasure erasureOfPatient(Database& db, std::int64_t patient) {
  Erasure out;
  out.lines = db.all<std::string>(
      "SELECT 'patient ' || mark FROM patient WHERE id = ?1 UNION"
      " SELECT 'patient ' || mark FROM merged WHERE patient = ?1",
      patient);
  append(out.lines, db.all<std::string>(
                        "SELECT 'note ' || id FROM note WHERE patient = ? ORDER BY id", patient));
  for (const std::int64_t visit :
       db.all<std::int64_t>("SELECT id FROM visit WHERE patient = ? ORDER BY id", patient)) {
    const Erasure one = erasureOfVisit(db, visit);
    append(out.lines, one.lines);
    append(out.recordings, one.recordings);
  }
  return out;
}

Erasure erasureOfSession(Database& db, std::int64_t trial) {
  Erasure out;
  Statement row = db.query("SELECT recording, sha256, state FROM trial WHERE id = ?", trial);
  if (!row.step()) return out;
  const bool original = row.text(2) == "measured" && !row.text(1).empty();
  out.lines = {original ? "recording " + row.text(1) : "trial " + row.text(0)};
  out.recordings = {row.text(0)};
  return out;
}

void storeIntent(Database& db, std::int64_t now_us, const std::string& what,
                 const Erasure& erasure) {
  db.change("INSERT INTO intent (at_us, what, recordings) VALUES (?, ?, ?)", now_us, what,
            Json(erasure.recordings).dump(-1, ' ', false, Json::error_handler_t::replace));
  addLines(db, erasure.lines);
  if (what == "erase" || what == "delete") (void)eraseMarked(db, erasure.lines);
}

std::int64_t lastIntent(Database& db) {
  return db.number("SELECT COALESCE(MAX(n), 0) FROM intent");
}

bool erases(Database& db, std::int64_t up_to) {
  return db.number("SELECT COUNT(*) FROM intent WHERE n <= ? AND what <> 'list'", up_to) != 0;
}

std::vector<std::string> removeErasedFiles(Database& db, const Places& places,
                                           std::int64_t now_us) {
  const MarkList list{linesOf(db), now_us};
  extendMarkList(markListIn(places.folder), list);
  if (!places.backups.empty()) {
    std::error_code ignored;
    fs::create_directories(places.backups, ignored);
    extendMarkList(markListIn(places.backups), list);
  }
  std::set<std::string> names, stems;
  bool removes = false;
  {
    Statement rows = db.query("SELECT recordings FROM intent WHERE what <> 'list'");
    for (; rows.step(); removes = true) {
      for (const Json& name : Json::parse(rows.text(0))) names.insert(name.get<std::string>());
    }
  }
  if (!removes) return {};
  removeUnnamedHandFiles(db, places.folder);
  // Sessions without a patient that turned out to be of an erased visit.
  Statement loose = db.query(
      "SELECT recording, sha256, 'recording ' || sha256 IN (SELECT line FROM mark) AS named FROM"
      " trial WHERE visit IS NULL AND (named OR 'visit ' || json_extract(measures, '$.visit') IN"
      " (SELECT line FROM mark))");
  while (loose.step()) {
    if (loose.integer(2) != 0 || !isGivenAway(db, loose.text(1))) names.insert(loose.text(0));
  }
  if (places.recordings.empty()) return {names.begin(), names.end()};
  for (const std::string& name : names) stems.insert(stemOf(name));
  return removeFiles(places.recordings, [&](const std::string& name) {
    if (belongsTo(name, stems)) return true;
    if (!isErasedVisit(db, visitInName(name))) return false;
    // A recording that was given to somebody is of that visit, whatever its name says.
    Statement row =
        db.query("SELECT visit, sha256 FROM trial WHERE recording = ?", recordingOf(name));
    return !row.step() || (row.isNull(0) && !isGivenAway(db, row.text(1)));
  });
}

void removeRecording(const std::string& recordings, const std::string& name) {
  const std::set<std::string> stems = {stemOf(name)};
  (void)removeFiles(recordings, [&](const std::string& other) { return belongsTo(other, stems); });
}

void removeUnnamedHandFiles(Database& db, const std::string& folder) {
  for (const fs::path& path : filesIn(folder + "/hands")) {
    const std::string name = path.filename().string();
    if (visitInName(name) == 0) continue;
    // The limits of an open visit are read again at its next item.
    if (db.number("SELECT COUNT(*) FROM visit WHERE hand_file = ? OR (id = ? AND state = 'open')",
                  name, static_cast<std::int64_t>(visitInName(name))) != 0) {
      continue;
    }
    std::error_code ignored;
    fs::remove(path, ignored);
  }
}

void compact(Database& db) {
  // While somebody reads, each VACUUM would lengthen the log by the whole database.
  emptyLog(db);
  db.run("VACUUM");
  emptyLog(db);
}

Lines eraseFromCopies(const Places& places, const Lines& lines, const Kept& kept) {
  Lines more;
  std::string problem;
  for (const std::string& path : copiesOf(places)) {
    try {
      append(more, eraseFromCopy(places.folder, path, lines, kept));
    } catch (const DatabaseError& error) {
      removeDatabase(path + ".erasing");
      problem = error.what();
    }
  }
  if (problem.empty()) return more;
  throw DatabaseError(problem + "; what was erased is still in this copy: delete it, or mend it");
}

std::vector<std::string> marksInCopies(const Places& places, std::int64_t patient,
                                       std::int64_t created_us) {
  std::vector<std::string> out;
  for (const std::string& path : copiesOf(places)) {
    try {
      Database copy(path, Database::Mode::kReadOnly);
      guardByKeys(copy, places.folder, true);
      if (!isSound(copy, "patient", patient)) continue;
      const std::vector<std::string> marks = copy.all<std::string>(
          "SELECT mark FROM patient WHERE id = ? AND created_us = ?", patient, created_us);
      out.insert(out.end(), marks.begin(), marks.end());
    } catch (const DatabaseError&) {  // a damaged copy: an erasure names it
    }
  }
  return out;
}

bool addLinesOfCopies(Database& db, const Lines& lines) {
  Transaction transaction(db);
  const bool known = std::all_of(lines.begin(), lines.end(),
                                 [&](const std::string& line) { return hasLine(db, line); });
  if (known) return false;
  addLines(db, lines);
  transaction.commit();
  return true;
}

std::string notRemoved(const std::vector<std::string>& left) {
  return fmt::format("{} cannot be removed: remove it, or free the recordings' folder for writing",
                     fmt::join(left, ", "));
}

void finishIntents(Database& db, std::int64_t up_to, std::int64_t now_us) {
  Transaction transaction(db);
  if (erases(db, up_to)) {
    writeLog(db, now_us, 0, "erased from files and backups");
  }
  db.change("DELETE FROM intent WHERE n <= ?", up_to);
  transaction.commit();
}

void noteProblem(Database& db, std::int64_t up_to, const std::string& problem) {
  if (db.number("SELECT COUNT(*) FROM intent WHERE n <= ? AND problem <> ?", up_to, problem) == 0) {
    return;
  }
  Transaction transaction(db);
  db.change("UPDATE intent SET problem = ? WHERE n <= ?", problem, up_to);
  transaction.commit();
}

std::vector<std::string> carryOutIntents(Database& db, const Places& places, std::int64_t now_us) {
  const std::int64_t last = lastIntent(db);
  std::vector<std::string> left;
  try {
    do {
      left = removeErasedFiles(db, places, now_us);
      if (!erases(db, last)) break;
      compact(db);
    } while (addLinesOfCopies(db, eraseFromCopies(places, linesOf(db), keptOf(db))));
  } catch (const DatabaseError& error) {
    noteProblem(db, last, error.what());
    throw;
  }
  if (left.empty()) {
    finishIntents(db, last, now_us);
  } else {
    noteProblem(db, last, notRemoved(left));
  }
  return left;
}

}  // namespace wholehand::clinic
