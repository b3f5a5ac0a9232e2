// Random histories of a clinic with backups, erasures and restores, against a model in memory.
#include "clinic/backup.hpp"
#include "clinic_bench.hpp"
#include "support/seed.hpp"

#include <map>
#include <set>

namespace wholehand::clinic {
namespace {
namespace fs = std::filesystem;

/// What the database says, by codes, numbers and texts that are never used twice.
struct Rows {
  struct Visit {
    std::string patient;  ///< code; empty: a guest
    std::set<std::string> notes;
    auto operator<=>(const Visit&) const = default;
  };
  std::map<std::string, std::set<std::string>> patients;  ///< code → notes
  std::map<std::string, std::set<std::string>> joined;    ///< code → codes that became part of it
  std::map<std::int64_t, Visit> visits;
  std::map<std::string, std::int64_t> given;  ///< recording → visit
};

/// A clinic and what it should be.
class History {
 public:
  History() {
    fs::create_directories(stick_);
    addPatient();
  }

  template <class Random>
  void act(Random& random) {
    switch (random() % 12) {
      case 0:
        return addPatient();
      case 1:
      case 2:
        return visit(anyPatient(random), random() % 3);
      case 3:
        return guestVisit();
      case 4:
        return move(anyVisit(random), anyPatient(random));
      case 5:
        return merge(anyPatient(random), anyPatient(random));
      case 6:
        return record(random() % 2 == 0 ? 0 : anyVisit(random));
      case 7:
        return give(anySession(random), anyPatient(random));
      case 8:
        return random() % 2 == 0 ? erase(anyPatient(random)) : deleteGuest(random);
      case 9:
        return deleteSession(random);
      case 10:
        return backUpNow(random() % 2 == 0);
      default:
        return copies_.empty() ? backUpNow(true) : restore(random() % copies_.size());
    }
  }

  /// Compares everything that the pages show, and the recordings that are there.
  void compare() {
    b_.clinic->carryOut();
    look();
    Rows seen;
    std::map<std::string, std::int64_t> trials;  // recording → visit
    const auto take = [&](const Json& visit, const std::string& code) {
      auto& one = seen.visits[visit["id"]];
      one.patient = code;
      for (const Json& note : visit["notes"]) one.notes.insert(note["text"]);
      for (const Json& trial : visit["trials"]) trials[trial["recording"]] = visit["id"];
    };
    const Json list = b_.get("/api/patients");
    for (const Json& row : list["patients"]) {
      const Json patient = person(row["id"]);
      auto& notes = seen.patients[row["code"]];
      for (const Json& note : patient["notes"]) notes.insert(note["text"]);
      for (const Json& visit : patient["visits"]) take(visit, row["code"]);
    }
    for (const Json& visit : list["guests"]) take(visit, "");
    EXPECT_EQ(list["under_way"], Json::array());
    EXPECT_EQ(seen.patients, rows_.patients);
    EXPECT_EQ(seen.visits, rows_.visits);
    std::set<std::string> sessions, files, nobodys, there;
    const Json loose = b_.get("/api/sessions")["sessions"];
    for (const Json& session : loose) {
      sessions.insert(session["recording"]);
      EXPECT_EQ(session["state"], "measured") << session;
      EXPECT_EQ(session["began_us"], kNoon_us + 5 * kSecond_us);
    }
    for (const auto& file : fs::directory_iterator(b_.options.recordings)) {
      files.insert(file.path().filename().string());
    }
    std::map<std::string, std::int64_t> of_visits;
    for (const auto& [name, visit] : recordings_) {
      there.insert(name);
      if (const std::int64_t owner = ownerOf(rows_, name); owner != 0) {
        of_visits[name] = owner;
      } else {
        nobodys.insert(name);
      }
    }
    EXPECT_EQ(files, there);
    EXPECT_EQ(trials, of_visits);
    EXPECT_EQ(sessions, nobodys);
  }

 private:
  struct Copy {
    std::string path;  ///< empty: a database that a restore replaced
    bool known;        ///< in the folder of backups: erasures reach it
    Rows rows;
  };

  Json person(std::int64_t id) { return b_.get(fmt::format("/api/patients/{}", id)); }
  std::int64_t idOf(const std::string& code) {
    const Json list = b_.get("/api/patients");
    for (const Json& row : list["patients"]) {
      if (row["code"] == code) return row["id"];
    }
    ADD_FAILURE() << "no patient " << code;
    return 0;
  }
  template <class Random>
  std::string anyPatient(Random& random) {
    return any(rows_.patients, random).first;
  }
  template <class Random>
  std::int64_t anyVisit(Random& random) {
    return any(rows_.visits, random).first;
  }
  template <class Random>
  std::string anySession(Random& random) {
    std::map<std::string, int> sessions;
    for (const auto& [name, visit] : recordings_) {
      if (ownerOf(rows_, name) == 0) sessions[name] = 0;
    }
    return any(sessions, random).first;
  }
  template <class Map, class Random>
  static typename Map::value_type any(const Map& map, Random& random) {
    if (map.empty()) return {};
    auto at = map.begin();
    std::advance(at, static_cast<std::ptrdiff_t>(random() % map.size()));
    return *at;
  }
  /// Visit of a recording; 0: none.
  std::int64_t ownerOf(const Rows& rows, const std::string& name) const {
    if (const auto given = rows.given.find(name);
        given != rows.given.end() && rows.visits.contains(given->second)) {
      return given->second;
    }
    const std::int64_t visit = recordings_.at(name);
    return rows.visits.contains(visit) ? visit : 0;
  }
  std::set<std::string> recordingsOf(const Rows& rows, std::int64_t visit) const {
    std::set<std::string> out;
    for (const auto& [name, number] : recordings_) {
      if (ownerOf(rows, name) == visit) out.insert(name);
    }
    return out;
  }
  void look() {
    const Measure measure = [](const std::string& path, std::string&) {
      return Json{{"visit", std::stoll(textOf(path))},
                  {"measures", 1},
                  {"recording",
                   {{"sha256", "of-" + fs::path(path).filename().string()},
                    {"ticks", 5},
                    {"began_utc", "2026-11-28T12:00:05Z"}}}};
    };
    for (int i = 0; i < 2; ++i, b_.clock.pass(3 * kSecond_us)) {
      b_.clinic->lookAtRecordings(measure, {});
    }
  }
  std::string newText(const char* word) { return fmt::format("{}-{}", word, ++texts_); }

  void addPatient() {
    const std::string code = newText("P");
    const std::int64_t id = b_.addPatient(code);
    const std::string note = newText("note");
    b_.post(fmt::format("/api/patients/{}/notes", id), {{"text", note}});
    rows_.patients[code] = {note};
  }
  void visit(const std::string& code, std::uint64_t notes) {
    if (code.empty()) return;
    const std::int64_t id = b_.beginVisit(idOf(code));
    ASSERT_NE(id, 0);
    rows_.visits[id].patient = code;
    for (std::uint64_t i = 0; i < notes; ++i) {
      const std::string note = newText("note");
      b_.post(fmt::format("/api/visits/{}/notes", id), {{"text", note}});
      rows_.visits[id].notes.insert(note);
    }
    record(id);
    b_.finish(id);
  }
  void guestVisit() {
    const std::int64_t id = b_.post("/api/guest_visits", {{"side", "right"}})["id"];
    rows_.visits[id] = {};
    record(id);
    b_.finish(id);
  }
  void record(std::int64_t visit) {
    const std::string name = newText("recording") + ".h5";
    std::ofstream(b_.options.recordings + "/" + name) << visit;
    recordings_[name] = visit;
    look();
  }
  void move(std::int64_t visit, const std::string& code) {
    if (visit == 0 || code.empty()) return;
    b_.post(fmt::format("/api/visits/{}/move", visit), {{"patient", idOf(code)}});
    ASSERT_EQ(b_.status, 200);
    rows_.visits[visit].patient = code;
    moved_[visit] = code;
  }
  void merge(const std::string& into, const std::string& from) {
    if (into == from || into.empty()) return;
    b_.post(fmt::format("/api/patients/{}/merge", idOf(into)), {{"from", idOf(from)}});
    ASSERT_EQ(b_.status, 200);
    for (auto& [id, visit] : rows_.visits) {
      if (visit.patient == from) visit.patient = into;
    }
    rows_.patients[into].merge(rows_.patients[from]);
    rows_.joined[into].insert(from);
    rows_.joined[into].merge(rows_.joined[from]);
    rows_.patients.erase(from);
    rows_.joined.erase(from);
  }
  void give(const std::string& name, const std::string& code) {
    if (name.empty() || code.empty()) return;
    const Json list = b_.get("/api/sessions");
    for (const Json& session : list["sessions"]) {
      if (session["recording"] != name) continue;
      const Json visit =
          b_.post("/api/sessions/give", {{"patient", idOf(code)}, {"sessions", {session["id"]}}});
      ASSERT_EQ(b_.status, 200) << visit;
      rows_.visits[visit["id"]].patient = code;
      rows_.given[name] = visit["id"];
      given_[name] = code;
    }
  }

  /// Erases visits with their recordings.
  void forget(Rows& rows, std::int64_t visit, const std::set<std::string>& recordings) {
    gone_visits_.insert(visit);
    rows.visits.erase(visit);
    for (const std::string& name : recordings) recordings_.erase(name);
  }
  void erase(const std::string& code) {
    if (code.empty()) return;
    b_.post(fmt::format("/api/patients/{}/erase", idOf(code)), {{"code", code}});
    ASSERT_EQ(b_.status, 200);
    b_.clinic->carryOut();
    std::set<std::string> codes = rows_.joined[code];
    codes.insert(code);
    gone_patients_.insert(codes.begin(), codes.end());
    for (const auto& [id, visit] : Rows(rows_).visits) {
      if (visit.patient == code) forget(rows_, id, recordingsOf(rows_, id));
    }
    rows_.patients.erase(code);
    rows_.joined.erase(code);
    eraseFromCopies();
  }
  /// Erases what belongs to an erased patient in an older state. What was moved or given to
  /// somebody else since is that person's, and so is what the clinic's database has.
  void eraseFrom(Rows& rows, const Rows& kept) {
    const auto isOthers = [&](const auto& owners, const auto& key) {
      const auto owner = owners.find(key);
      return owner != owners.end() && !gone_patients_.contains(owner->second);
    };
    for (const auto& [id, visit] : Rows(rows).visits) {
      if (gone_visits_.contains(id)) {
        rows.visits.erase(id);
      } else if (gone_patients_.contains(visit.patient)) {
        if (isOthers(moved_, id) || kept.visits.contains(id)) {
          rows.visits[id].patient.clear();
          continue;
        }
        std::set<std::string> erased;
        for (const std::string& name : recordingsOf(rows, id)) {
          if (!isOthers(given_, name) && ownerOf(kept, name) == 0) erased.insert(name);
        }
        forget(rows, id, erased);
      }
    }
    for (const std::string& code : gone_patients_) {
      rows.patients.erase(code);
      rows.joined.erase(code);
    }
    // A recording of an erased visit that is nobody's goes with the visit.
    for (const auto& [name, visit] : std::map(recordings_)) {
      if (!gone_visits_.contains(visit) || isOthers(given_, name)) continue;
      if (ownerOf(rows_, name) == 0) recordings_.erase(name);
    }
  }
  void eraseFromCopies() {
    for (std::size_t before = 0; before != gone_visits_.size() + 1;) {
      before = gone_visits_.size() + 1;
      for (Copy& copy : copies_) {
        if (copy.known) eraseFrom(copy.rows, rows_);
      }
    }
  }
  template <class Random>
  void deleteGuest(Random& random) {
    std::map<std::int64_t, Rows::Visit> guests;
    for (const auto& [id, visit] : rows_.visits) {
      if (visit.patient.empty()) guests[id] = visit;
    }
    const std::int64_t id = any(guests, random).first;
    if (id == 0) return;
    b_.ask("DELETE", fmt::format("/api/visits/{}", id));
    ASSERT_EQ(b_.status, 200);
    b_.clinic->carryOut();
    forget(rows_, id, recordingsOf(rows_, id));
    eraseFromCopies();
  }
  template <class Random>
  void deleteSession(Random& random) {
    const std::string name = anySession(random);
    if (name.empty()) return;
    const Json list = b_.get("/api/sessions");
    for (const Json& session : list["sessions"]) {
      if (session["recording"] != name) continue;
      b_.ask("DELETE", fmt::format("/api/sessions/{}", session["id"].get<std::int64_t>()));
      ASSERT_EQ(b_.status, 200);
    }
    b_.clinic->carryOut();
    recordings_.erase(name);
  }
  void backUpNow(bool known) {
    const std::string path = (known ? b_.options.backups : stick_) + "/" + newText("b") + ".db";
    ASSERT_TRUE(backUp(b_.options.folder, path, b_.clock.now).ok());
    copies_.push_back({path, known, rows_});
  }
  void restore(std::size_t which) {
    if (copies_[which].path.empty()) return;
    b_.clinic.reset();
    b_.station.now.visit = 0;
    const auto restored = restoreBackup(copies_[which].path, b_.options.folder, b_.clock.now);
    ASSERT_TRUE(restored.ok()) << format(restored.errors());
    b_.restart();
    copies_.push_back({"", true, rows_});
    rows_ = copies_[which].rows;
    eraseFrom(rows_, copies_.back().rows);
    b_.clinic->carryOut();
    eraseFromCopies();
    look();
  }

  Bench b_;
  const std::string stick_ = b_.folder.path() + "/stick";
  Rows rows_;
  std::vector<Copy> copies_;
  std::map<std::string, std::int64_t> recordings_;  ///< that are there → visit in the file
  std::set<std::string> gone_patients_;
  std::set<std::int64_t> gone_visits_;
  std::map<std::int64_t, std::string> moved_;  ///< visit → to whom at last
  std::map<std::string, std::string> given_;   ///< recording → to whom at last
  int texts_ = 0;
};

void judgeHistories(int histories) {
  auto random = test::seededRandom(5902);
  for (int i = 0; i < histories && !testing::Test::HasFailure(); ++i) {
    const auto seed = random();
    SCOPED_TRACE(fmt::format("history {}, seed {}", i, seed));
    std::mt19937_64 draws(seed);
    History history;
    for (int step = 0; step < 25 && !testing::Test::HasFailure(); ++step) {
      history.act(draws);
      if (step % 5 == 4) history.compare();
    }
  }
  fmt::print("figure: {} random histories\n", histories);
}

TEST(Restore, RandomHistories_AreTheBackupWithoutAllErasures) {
  judgeHistories(test::kReducedCounts ? 3 : 30);
}

TEST(Restore, TenThousandHistories_AreTheBackupWithoutAllErasures_slow) {
  judgeHistories(10'000);
}

TEST(Restore, NotesAfterARestore_HaveNumbersThatNoErasedNoteHad) {
  Bench b;
  const std::int64_t stays = b.addPatient("P-001");
  b.post(fmt::format("/api/patients/{}/notes", stays), {{"text", "first"}});
  const std::string backup = b.options.backups + "/old.db";
  ASSERT_TRUE(backUp(b.options.folder, backup, b.clock.now).ok());
  std::int64_t largest = 0;
  for (int i = 0; i < 6; ++i) {
    const std::int64_t gone = b.addPatient("GONE-1");
    b.post(fmt::format("/api/patients/{}/notes", gone), {{"text", "erased"}});
    const Json notes = b.get(fmt::format("/api/patients/{}", gone))["notes"];
    ASSERT_EQ(notes.size(), 1U) << "restore " << i;
    EXPECT_GT(notes[0]["id"], largest);
    largest = notes[0]["id"];
    b.post(fmt::format("/api/patients/{}/erase", gone), {{"code", "GONE-1"}});
    b.clinic->carryOut();
    b.clinic.reset();
    ASSERT_TRUE(restoreBackup(backup, b.options.folder, b.clock.now).ok());
    b.restart();
  }
  EXPECT_EQ(b.get(fmt::format("/api/patients/{}", stays))["notes"].size(), 1U);
}

TEST(Restore, MovedVisitOfAnErasedPerson_StaysErasedWithItsNoteAndRecording) {
  Bench b;
  const std::int64_t a = b.addPatient("A-1"), gone = b.addPatient("B-1");
  const std::int64_t visit = b.beginVisit(a);
  b.post(fmt::format("/api/visits/{}/notes", visit), {{"text", "of B"}});
  b.station.now.values["effort_limit_arm_n"] = 15.0;  // a setting of B's that A must not keep
  b.finish(visit);
  const std::string backup = b.folder.path() + "/stick.db";  // no known folder: not erased from
  ASSERT_TRUE(backUp(b.options.folder, backup, b.clock.now).ok());
  b.post(fmt::format("/api/visits/{}/move", visit), {{"patient", gone}});
  b.post(fmt::format("/api/patients/{}/erase", gone), {{"code", "B-1"}});
  ASSERT_EQ(b.status, 200);
  b.clinic->carryOut();
  b.clinic.reset();
  ASSERT_TRUE(restoreBackup(backup, b.options.folder, b.clock.now).ok());
  b.restart();
  const Json list = b.get("/api/patients");
  ASSERT_EQ(list["patients"].size(), 1U);
  const Json patient = b.get(fmt::format("/api/patients/{}", a));
  EXPECT_EQ(patient["visits"], Json::array());
  EXPECT_EQ(patient["parameters"], Json::object());
  EXPECT_TRUE(list["restored"].is_null()) << list["restored"];
  for (const char* tail : {"", "-wal"}) {
    EXPECT_EQ(textOf(b.database() + tail).find("B-1"), std::string::npos);
  }
}

TEST(Restore, WhatWasDoneSinceTheBackup_IsListedUntilItIsDoneAgain) {
  Bench b;
  const std::int64_t a = b.addPatient("A-1"), other = b.addPatient("B-1"),
                     twin = b.addPatient("C-1");
  const std::int64_t visit = b.beginVisit(a);
  b.finish(visit);
  const std::string backup = b.options.backups + "/old.db";
  ASSERT_TRUE(backUp(b.options.folder, backup, b.clock.now).ok());
  b.post(fmt::format("/api/visits/{}/move", visit), {{"patient", twin}});
  b.post(fmt::format("/api/visits/{}/move", visit), {{"patient", other}});
  b.post(fmt::format("/api/patients/{}/merge", a), {{"from", twin}});
  b.clinic.reset();
  ASSERT_TRUE(restoreBackup(backup, b.options.folder, b.clock.now).ok());
  b.restart();
  const Json again = b.get("/api/patients")["restored"]["again"];
  ASSERT_EQ(again.size(), 2U) << again;
  EXPECT_EQ(again[0]["what"], "moved");
  EXPECT_EQ(again[0]["visit"], visit);
  EXPECT_EQ(again[0]["from"], "A-1");
  EXPECT_EQ(again[0]["to"], "B-1");
  EXPECT_EQ(again[1], (Json{{"what", "joined"}, {"from", "C-1"}, {"to", "A-1"}}));
  b.post("/api/restored/done");
  EXPECT_TRUE(b.get("/api/patients")["restored"].is_null());
}

TEST(Restore, CopyWithoutItsList_SaysUntilWhichDayItsMarksReach) {
  Bench b;
  const std::int64_t gone = b.addPatient("A-1");
  const std::string folder = b.folder.path() + "/elsewhere", stick = folder + "/stick.db";
  ASSERT_TRUE(backUp(b.options.folder, b.options.backups + "/old.db", b.clock.now).ok());
  fs::create_directories(folder);
  for (const char* tail : {"", ".keys"}) {
    fs::copy_file(b.options.backups + "/old.db" + tail, stick + tail);
  }
  const std::int64_t then = b.clock.now;
  b.clock.pass(3 * kDay_us);
  b.post(fmt::format("/api/patients/{}/erase", gone), {{"code", "A-1"}});
  b.clinic.reset();
  b.options.folder = folder + "/clinic";
  const auto restored = restoreBackup(stick, b.options.folder, b.clock.now);
  ASSERT_TRUE(restored.ok()) << format(restored.errors());
  EXPECT_NE(fmt::format("{}", fmt::join(*restored, "\n")).find("reach until 2026-11-28T12:00:00Z"),
            std::string::npos);
  b.restart();
  const Json list = b.get("/api/patients");
  EXPECT_EQ(list["patients"].size(), 1U);  // nothing here knows of the erasure
  EXPECT_EQ(list["restored"]["until_us"], then);
  EXPECT_EQ(list["restored"]["at_us"], b.clock.now);
}

}  // namespace
}  // namespace wholehand::clinic
