#include "clinic/trials.hpp"

#include "clinic/intents.hpp"
#include "clinic/row_digests.hpp"
#include "clinic/rows.hpp"
#include "clinic/text.hpp"
#include "files/process/child_process.hpp"
#include "loop/core/printable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <sys/stat.h>

namespace wholehand::clinic {
namespace {
namespace fs = std::filesystem;

constexpr std::int64_t kSettled_us = 2 * kSecond_us;  // a recording in progress changes more often
/// Intervals of further attempts after a failure, because memory, disk or program may be available
/// again.
constexpr std::int64_t kAgain_us = 30 * kSecond_us, kLongestAgain_us = 3600 * kSecond_us;
constexpr int kMostDoublings = 7;
constexpr std::size_t kLongestReason = 300;
constexpr std::uint64_t kOutput_bytes = 1 << 20;

struct FileEntry {
  std::string name;
  std::int64_t size = 0, modified_ns = 0;
};

std::vector<FileEntry> recordingsOf(const std::string& folder) {
  std::vector<FileEntry> out;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (it->path().extension() != ".h5") continue;
    struct stat file {};
    if (::lstat(it->path().c_str(), &file) != 0 || !S_ISREG(file.st_mode)) continue;
    out.push_back({it->path().filename().string(), file.st_size,
                   file.st_mtim.tv_sec * std::int64_t{1'000'000'000} + file.st_mtim.tv_nsec});
  }
  return out;
}

/// Result of measuring a recording, for its row.
struct Outcome {
  std::string state, why;
  std::optional<std::int64_t> visit;
  std::int64_t item = 0, began_us = 0, version = 0;
  std::string sha256, measures = "{}";
};

std::int64_t integerOf(const Json& json, const char* key) {
  const Json value = json.value(key, Json());
  return value.is_number_integer() ? value.get<std::int64_t>() : 0;
}

bool isVisit(Database& db, std::int64_t id) {
  return db.number("SELECT COUNT(*) FROM visit WHERE id = ?", id) != 0;
}

/// Outcome for a recording that cannot be read. Its file name names the visit, if the station gave
/// the name.
Outcome failed(Database& db, const std::string& name, const std::string& why) {
  Outcome out;
  out.state = "failed";
  out.why = why;
  const std::int64_t visit = visitInName(name);
  if (isVisit(db, visit)) out.visit = visit;
  return out;
}

Outcome outcomeOf(Database& db, const std::string& name, const Json& json) {
  Outcome out;
  const Json recording = json.value("recording", Json::object());
  out.sha256 = recording.value("sha256", "");
  out.began_us = timeOf(recording.value("began_utc", "")).value_or(0);
  out.version = integerOf(json, "measures");
  out.item = integerOf(json, "item");
  out.measures = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  const std::int64_t visit = integerOf(json, "visit");
  if (visit != 0 && isVisit(db, visit)) {
    out.visit = visit;
  } else if (visit != 0 && !isDrawnHere(db, visit)) {
    out.state = "ignored";
    out.why = fmt::format("visit {} is not of this clinic", visit);
    return out;
  } else {
    // The session was recorded outside a visit, or in one that a restored backup does not know;
    // somebody may have assigned it to one since.
    const std::int64_t given = db.number("SELECT visit FROM trial WHERE recording = ?", name);
    if (given != 0) out.visit = given;
  }
  const bool ticks = integerOf(recording, "ticks") > 0;
  out.state = ticks ? "measured" : "failed";
  if (!ticks) {
    out.why = "the recording has no tick";
  } else if (json.value("ended_by", "") == "broken_off") {
    out.why = "the session was broken off: the program or the machine failed";
  } else if (!recording.value("complete", true)) {
    out.why = "the recording is not whole: its measures are of a part";
  } else if (visit != 0 && !out.visit) {
    out.why = fmt::format("visit {} is not in these records, which were restored", visit);
  }
  return out;
}

/// Finds the same recording under another name. A renamed recording takes over the old row; a copy
/// is ignored.
void findUnderAnotherName(Database& db, const std::string& recordings, const std::string& name,
                          Outcome& out) {
  if (out.sha256.empty() || out.state == "ignored") return;
  Statement same = db.query(
      "SELECT id, recording, visit FROM trial WHERE sha256 = ? AND recording <> ? AND state <>"
      " 'ignored'",
      out.sha256, name);
  if (!same.step()) return;
  std::error_code error;
  if (!fs::exists(fs::path(recordings) / same.text(1), error)) {
    if (!same.isNull(2)) out.visit = same.integer(2);
    db.change("DELETE FROM trial WHERE id = ?", same.integer(0));
  } else if (!out.visit || !same.isNull(2)) {  // a recording that was assigned to a visit stays
                                               // there
    out.state = "ignored";
    out.why = "is a copy of " + same.text(1);
    out.visit.reset();
  }
}

/// True for a recording that a mark names, or whose visit one names. A recording that was given to
/// somebody is of that visit.
bool isErased(Database& db, const std::string& name, const std::optional<Json>& json) {
  if (db.number("SELECT visit FROM trial WHERE recording = ?", name) != 0) return false;
  if (!json) return isErasedVisit(db, visitInName(name));
  const std::string sha256 = json->value("recording", Json::object()).value("sha256", "");
  return isErasedRecording(db, sha256) ||
         (isErasedVisit(db, integerOf(*json, "visit")) && !isGivenAway(db, sha256));
}

void insertOrUpdate(Database& db, const FileEntry& file, const Outcome& out) {
  db.change(
      "INSERT INTO trial (recording, size, modified_ns, state, why, visit, item, began_us, sha256,"
      " measures_version, measures) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)"
      " ON CONFLICT (recording) DO UPDATE SET size = excluded.size, modified_ns ="
      " excluded.modified_ns, state = excluded.state, why = excluded.why,"
      " visit = COALESCE(excluded.visit, CASE WHEN excluded.state = 'failed' THEN visit END),"
      " item = CASE WHEN excluded.state = 'failed' THEN item ELSE excluded.item END,"
      " began_us = CASE WHEN excluded.began_us = 0 THEN began_us ELSE excluded.began_us END,"
      " sha256 = excluded.sha256, measures_version = excluded.measures_version,"
      " measures = excluded.measures",
      file.name, file.size, file.modified_ns, out.state, out.why, out.visit, out.item, out.began_us,
      out.sha256, out.version, out.measures);
}

/// Replaces rows whose digest is wrong by empty ones, which are measured again. A visit is kept if
/// a mark says that the recording was given to its patient.
void replaceDamaged(Database& db) {
  struct Damaged {
    std::string recording, sha256;
    std::int64_t id, visit;
  };
  std::vector<Damaged> rows;
  Statement query = db.query("SELECT recording, sha256, id, visit FROM trial WHERE NOT " +
                             soundness(db, "trial", "trial"));
  while (query.step()) {
    Damaged& row = rows.emplace_back();
    query.read(row.recording, row.sha256, row.id, row.visit);
  }
  Transaction transaction(db);
  for (const Damaged& row : rows) {
    db.change("DELETE FROM trial WHERE id = ?", row.id);
    const std::string owner = ownerOf(db, row.sha256);
    const std::int64_t patient = db.number("SELECT patient FROM visit WHERE id = ?", row.visit);
    if (owner.empty() || markOf(db, patient) != owner) continue;
    insertWaitingTrial(db, row.recording, row.visit, 0, 0, row.sha256);
  }
  transaction.commit();
}

}  // namespace

void Trials::store(const std::string& name, const FileState& file, const std::optional<Json>& json,
                   const std::string& why) {
  const std::lock_guard lock(mutex_);
  if (isErased(records_.db(), name, json)) {
    removeRecording(records_.options().recordings, name);
    records_.db().change("DELETE FROM trial WHERE recording = ?", name);
    return;
  }
  Transaction transaction(records_.db());
  Outcome out = json ? outcomeOf(records_.db(), name, *json) : failed(records_.db(), name, why);
  findUnderAnotherName(records_.db(), records_.options().recordings, name, out);
  insertOrUpdate(records_.db(), {name, file.size, file.modified_ns}, out);
  transaction.commit();
}

/// Marks recordings that are in the table but no longer in the folder.
void Trials::noteMissing(std::set<std::string> present) {
  const std::lock_guard lock(mutex_);
  if (present == present_) return;
  Transaction transaction(records_.db());
  std::vector<std::int64_t> gone;
  {
    Statement rows = records_.db().query(
        "SELECT id, recording FROM trial WHERE visit IS NOT NULL AND why <> 'the recording is "
        "gone'");
    while (rows.step()) {
      const std::string name = rows.text(1);
      if (present.contains(name)) continue;
      gone.push_back(rows.integer(0));
      files_.erase(name);
    }
  }
  for (const std::int64_t id : gone) {
    records_.db().change(
        "UPDATE trial SET why = 'the recording is gone', state = CASE WHEN state ="
        " 'measured' THEN state ELSE 'failed' END WHERE id = ?",
        id);
  }
  for (const std::string& name :
       records_.db().all<std::string>("SELECT recording FROM trial WHERE visit IS NULL")) {
    if (present.contains(name)) continue;
    records_.db().change("DELETE FROM trial WHERE recording = ?", name);
    files_.erase(name);
  }
  transaction.commit();
  present_ = std::move(present);
}

void Trials::look(const Measure& measure, const std::function<bool()>& stop) {
  if (records_.options().recordings.empty()) return;
  try {
    {
      const std::lock_guard lock(mutex_);
      records_.open();
    }
    // Lists the folder, and marks recordings that are gone.
    const std::vector<FileEntry> found = recordingsOf(records_.options().recordings);
    std::set<std::string> present;
    for (const FileEntry& file : found) present.insert(file.name);
    const std::string written = fs::path(station_.scene().recording).filename().string();
    if (!written.empty()) present.insert(written);
    std::error_code error;
    if (fs::is_directory(records_.options().recordings, error)) noteMissing(present);
    for (const FileEntry& file : found) {
      if (file.name == written) continue;
      // Skips a file that is known, was changed a moment ago, or has to wait after a failure.
      FileState seen;
      {
        const std::lock_guard lock(mutex_);
        const std::int64_t now_us = records_.clock().steady_us();
        auto [at, is_new] = files_.try_emplace(file.name);
        FileState& known = at->second;
        if (is_new || known.size != file.size || known.modified_ns != file.modified_ns) {
          Statement row = records_.db().query(
              "SELECT 1 FROM trial WHERE recording = ? AND size = ? AND modified_ns = ? AND state "
              "IN ('measured', 'ignored') AND why <> 'the recording is gone'",
              file.name, file.size, file.modified_ns);
          known = {file.size, file.modified_ns, now_us + kSettled_us, 0, row.step()};
        }
        if (known.known || now_us < known.due_us) continue;
        seen = known;
      }
      // Measures without the lock, then stores the result.
      std::string why;
      const std::optional<Json> json =
          measure((fs::path(records_.options().recordings) / file.name).string(), why);
      if (stop && stop()) return;
      store(file.name, seen, json, why);
      const std::lock_guard lock(mutex_);
      FileState& known = files_[file.name];
      known.known = json.has_value();
      known.due_us =
          records_.clock().steady_us() + std::min(kAgain_us << known.failed, kLongestAgain_us);
      known.failed = std::min(known.failed + 1, kMostDoublings);
    }
  } catch (const DatabaseError&) {  // the next call finds the recordings missed now
  } catch (const Json::exception&) {
  } catch (const RequestRefusal&) {
  }
}

Measure measureByChild(std::string program, std::function<bool()> stop) {
  return [program = std::move(program), stop = std::move(stop)](
             const std::string& path, std::string& why) -> std::optional<Json> {
    ChildLimits limits;
    limits.time = std::chrono::seconds(120);
    limits.output_bytes = kOutput_bytes;
    limits.idle_disk = true;
    // The child writes the reason as one line to standard error.
    const ChildResult result =
        runChild("/bin/sh", {"-c", R"(exec nice -n 19 "$0" measures "$1" 2>&1)", program, path},
                 limits, stop);
    if (result.ending == ChildEnding::kExited && result.code == 0) {
      Json json = Json::parse(result.output, nullptr, false);
      if (json.is_object()) return json;
      why = "what `wholehand measures` printed is no JSON";
    } else if (result.ending == ChildEnding::kExited) {
      why = printable(result.output.substr(0, result.output.find('\n')), kLongestReason);
      if (why.empty()) why = fmt::format("`wholehand measures` ended with code {}", result.code);
    } else if (result.ending == ChildEnding::kLate) {
      why = "`wholehand measures` took longer than 120 s";
    } else {
      why = fmt::format("`wholehand measures` was ended by signal {}", result.code);
    }
    return {};
  };
}

Expected<std::string> rebuildTrials(const std::string& folder, const std::string& recordings,
                                    const Measure& measure) {
  try {
    Database db(folder + "/clinic.db", Database::Mode::kReadWrite);
    migrate(db);
    guardByKeys(db, folder);
    replaceDamaged(db);
    int measured = 0, others = 0;
    const std::vector<FileEntry> found = recordingsOf(recordings);
    for (const FileEntry& file : found) {
      std::string why;
      const auto json = measure((fs::path(recordings) / file.name).string(), why);
      if (isErased(db, file.name, json)) {
        removeRecording(recordings, file.name);
        db.change("DELETE FROM trial WHERE recording = ?", file.name);
        ++others;
        continue;
      }
      Transaction transaction(db);
      Outcome out = json ? outcomeOf(db, file.name, *json) : failed(db, file.name, why);
      findUnderAnotherName(db, recordings, file.name, out);
      ++(out.state == "measured" ? measured : others);
      insertOrUpdate(db, file, out);
      transaction.commit();
    }
    return fmt::format("{} recordings: {} are trials of this clinic's visits, {} are not",
                       found.size(), measured, others);
  } catch (const DatabaseError& error) {
    return fileFault("", error.what(), "run wholehand-clinic verify");
  } catch (const Json::exception& error) {
    return fileFault("", error.what(), "give the matching --program");
  }
}

}  // namespace wholehand::clinic
