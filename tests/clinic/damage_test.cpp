#include "clinic/backup.hpp"
#include "clinic/row_digests.hpp"
#include "clinic_bench.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"

namespace wholehand::clinic {
namespace {
namespace fs = std::filesystem;

/// Changes a database as another program does, which has no key.
void tamper(const Bench& b, const std::string& sql) {
  Database(b.database(), Database::Mode::kReadWrite).run(sql);
}

std::string faultsOf(const std::string& folder) {
  const auto verified = verifyClinic(folder);
  return verified ? std::string{} : format(verified.errors());
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Measures every recording as a session of the visit that its name names.
Json measured(const std::string& path) {
  const std::string name = fs::path(path).filename().string();
  return {{"measures", 3},
          {"visit", std::stoll(name.substr(name.find('-') + 1))},
          {"item", 0},
          {"exercise", "cocktail-bar"},
          {"level", 1},
          {"hand", "adult-median-right"},
          {"active_s", 100.0},
          {"ended_by", "stop"},
          {"recording",
           {{"sha256", name},
            {"began_utc", "2026-11-28T12:00:00Z"},
            {"ticks", 1000},
            {"complete", true},
            {"duration_s", 120.0}}}};
}

/// A clinic with rows in each table, some of them in the write-ahead log only.
void fill(Bench& b, int patients) {
  for (int i = 0; i < patients; ++i) {
    const std::int64_t id = b.addPatient(fmt::format("P-{}", i), fmt::format("Person {}", i));
    const std::int64_t visit = b.beginVisit(id);
    b.post(fmt::format("/api/visits/{}/notes", visit), {{"text", "cue given"}});
    std::ofstream(b.options.recordings + fmt::format("/visit-{}-a.h5", visit)) << i;
    b.station.now.values["effort_limit_arm_n"] = 5.0;
    b.finish(visit);
    b.post(fmt::format("/api/patients/{}/notes", id), {{"text", "calls on Monday"}});
  }
  const Measure measure = [](const std::string& path, std::string&) {
    return std::optional<Json>(measured(path));
  };
  b.clinic->lookAtRecordings(measure, {});
  b.clock.pass(10 * kSecond_us);
  b.clinic->lookAtRecordings(measure, {});
}

TEST(Damage, ChangedLimit_IsNamedAndNotServed) {
  Bench b;
  const std::int64_t id = b.addPatient("P-001"), other = b.addPatient("P-002");
  ASSERT_EQ(faultsOf(b.options.folder), "");
  tamper(b, "UPDATE patient SET parameters = '{\"effort_limit_arm_n\":9.0}' WHERE code = 'P-001'");
  EXPECT_TRUE(has(faultsOf(b.options.folder), "patient 1 of P-001: the row is damaged"))
      << faultsOf(b.options.folder);
  for (const bool restarted : {false, true}) {
    if (restarted) b.restart();
    EXPECT_EQ(b.get(fmt::format("/api/patients/{}", id))["refused"], "damaged");
    const Json body = {{"side", "right"}, {"plan", planOf()}};
    const Json said = b.post(fmt::format("/api/patients/{}/visits", id), body);
    EXPECT_EQ(said["refused"], "damaged");
    EXPECT_TRUE(has(said["why"], "patient 1: its row in clinic.db is damaged")) << said;
    EXPECT_TRUE(has(said["why"], "gentle preset")) << said;
    // Everybody else, and a visit under the gentle preset, go on.
    EXPECT_EQ(b.get(fmt::format("/api/patients/{}", other))["code"], "P-002");
    const Json guest = b.post("/api/guest_visits", {{"side", "right"}});
    ASSERT_EQ(b.status, 200) << guest;
    b.finish(guest["id"]);
  }
  EXPECT_EQ(b.get("/api/patients")["damaged"], Json::array({"patient 1 of P-001"}));
}

TEST(Damage, DamagedPatient_IsShownInPartAndSignedAgainByATherapist) {
  Bench b;
  const std::int64_t id = b.addPatient("P-001");
  const std::int64_t visit = b.beginVisit(id);
  b.finish(visit);
  const std::string path = fmt::format("/api/patients/{}", id);
  EXPECT_EQ(b.get(path + "/damaged")["refused"], "changed");  // nothing is damaged
  for (const std::string set :
       {"parameters = '{\"effort_limit_arm_n\":9.0}', side = 'left'", "secret = x'00'",
        "hands = '{', plan = 7, code = 'P-OO1'", "row_digest = NULL"}) {
    SCOPED_TRACE(set);
    tamper(b, "UPDATE patient SET " + set);
    b.restart();
    const Json shown = b.get(path + "/damaged");
    ASSERT_EQ(b.status, 200) << shown;
    // Nothing that bounds a force, and no side, is taken from the damaged row.
    EXPECT_EQ(shown["side"], "");
    EXPECT_EQ(shown["hands"], Json::object());
    EXPECT_EQ(shown["parameters"], Json::object());
    EXPECT_EQ(shown["preset"], "gentle");
    EXPECT_EQ(shown["name"], has(set, "secret") ? "" : "Anna Keller");
    EXPECT_EQ(shown["unreadable"], has(set, "secret")  ? Json::array({"name"})
                                   : has(set, "hands") ? Json::array({"plan", "hands"})
                                                       : Json::array());
    EXPECT_EQ(shown["was"]["side"], has(set, "left") ? "left" : "right");
    if (has(set, "arm_n")) EXPECT_EQ(shown["was"]["parameters"]["effort_limit_arm_n"], 9.0);
    Json body = patientOf("P-001");
    EXPECT_EQ(b.post(path + "/sign_again", body)["field"], "confirmed");
    EXPECT_EQ(b.get(path)["refused"], "damaged");
    body["confirmed"] = true;
    const Json whole = b.post(path + "/sign_again", body);
    ASSERT_EQ(b.status, 200) << whole;
    EXPECT_EQ(whole["parameters"], Json::object());
    EXPECT_EQ(whole["visits"][0]["id"], visit);
    EXPECT_EQ(b.refused(path + "/sign_again", body), "changed");
    EXPECT_EQ(b.get("/api/patients")["damaged"], Json::array());
    EXPECT_EQ(faultsOf(b.options.folder), "");
    EXPECT_EQ(b.get("/api/log")["log"][0]["what"], "signed a damaged patient again");
  }
  b.restart();
  EXPECT_NE(b.beginVisit(id), 0);
  EXPECT_LE(b.station.orders.back().parameters.at("effort_limit_arm_n"), 6.0);
}

TEST(Damage, PatientWithADamagedMark_IsErasedFromBackupsAfterItWasSignedAgain) {
  Bench b;
  const std::int64_t id = b.addPatient("GONE-1");
  const std::string backup = b.options.backups + "/old.db";
  ASSERT_TRUE(backUp(b.options.folder, backup, b.clock.now).ok());
  tamper(b, "UPDATE patient SET mark = 'another'");
  Json body = patientOf("GONE-1");
  body["confirmed"] = true;
  b.post(fmt::format("/api/patients/{}/sign_again", id), body);
  ASSERT_EQ(b.status, 200);
  b.post(fmt::format("/api/patients/{}/erase", id), {{"code", "GONE-1"}});
  b.clinic->carryOut();
  EXPECT_EQ(b.get("/api/patients")["under_way"], Json::array());
  EXPECT_FALSE(has(textOf(backup), "GONE-1"));
}

TEST(Damage, VisitWithAWrongOrMissingDigest_IsNamedAndCanBeEnded) {
  Bench b;
  const std::int64_t id = b.addPatient("P-001"), visit = b.beginVisit(id);
  tamper(b, "UPDATE visit SET row_digest = NULL");
  EXPECT_EQ(b.get(fmt::format("/api/visits/{}", visit))["refused"], "damaged");
  EXPECT_EQ(b.refused(fmt::format("/api/visits/{}/item", visit), {{"item", 0}}), "damaged");
  const Json ended = b.post(fmt::format("/api/visits/{}/finish", visit), {{"state", "done"}});
  EXPECT_EQ(ended["state"], "damaged") << ended;
  EXPECT_EQ(b.station.now.visit, 0U);
  EXPECT_EQ(b.get("/api/state")["visit"], 0);
  EXPECT_TRUE(has(faultsOf(b.options.folder), fmt::format("visit {} of P-001", visit)));
  EXPECT_EQ(b.get(fmt::format("/api/patients/{}", id))["visits"][0]["state"], "damaged");
}

TEST(Damage, DigestOfAnotherRow_IsWrong) {
  Bench b;
  (void)b.addPatient("P-001"), (void)b.addPatient("P-002");
  tamper(b,
         "UPDATE patient SET row_n = (SELECT row_n FROM patient WHERE id = 1), row_digest ="
         " (SELECT row_digest FROM patient WHERE id = 1) WHERE id = 2");
  EXPECT_TRUE(has(faultsOf(b.options.folder), "patient 2 of P-002"));
}

TEST(Damage, MergeMoveEraseAndRestore_RenewTheDigests) {
  Bench b;
  fill(b, 4);
  const Json visits = b.get("/api/patients/1")["visits"];
  b.post(fmt::format("/api/visits/{}/move", visits[0]["id"].get<std::int64_t>()), {{"patient", 2}});
  b.post("/api/patients/2/merge", {{"from", 3}});
  const std::string backup = b.options.backups + "/clinic-1.db";
  ASSERT_TRUE(backUp(b.options.folder, backup, b.clock.now).ok());
  b.post("/api/patients/4/erase", {{"code", "P-3"}});
  ASSERT_EQ(b.status, 200);
  b.clinic->carryOut();
  EXPECT_EQ(faultsOf(b.options.folder), "");
  b.clinic.reset();
  const auto restored = restoreBackup(backup, b.options.folder, b.clock.now);
  ASSERT_TRUE(restored.ok()) << format(restored.errors());
  EXPECT_EQ(faultsOf(b.options.folder), "");
  b.restart();
  EXPECT_EQ(b.get("/api/patients")["damaged"], Json::array());
  EXPECT_EQ(b.get("/api/patients/2")["visits"].size(), 3U);
}

TEST(Damage, LostFramesOfTheLog_AreNamedUntilSomebodyConfirms) {
  Bench b;
  const std::int64_t id = b.addPatient("P-001");
  const auto size = fs::file_size(b.database() + "-wal");
  (void)b.addPatient("P-002");
  test::Folder copy;
  fs::copy(b.options.folder, copy.path() + "/clinic", fs::copy_options::recursive);
  {
    std::fstream log(copy.path() + "/clinic/clinic.db-wal",
                     std::ios::in | std::ios::out | std::ios::binary);
    log.seekp(static_cast<std::streamoff>(size) + 100);
    log.put('?');
  }
  b.clinic.reset();
  fs::remove_all(b.options.folder);
  fs::copy(copy.path() + "/clinic", b.options.folder, fs::copy_options::recursive);
  EXPECT_TRUE(has(faultsOf(copy.path() + "/clinic"), "changes of rows are lost"));
  b.restart();
  EXPECT_GT(b.get("/api/patients")["lost"], 0);
  const Json body = {{"side", "right"}, {"plan", planOf()}};
  EXPECT_EQ(b.refused(fmt::format("/api/patients/{}/visits", id), body), "damaged");
  b.restart();
  EXPECT_GT(b.get("/api/patients")["lost"], 0);
  b.post("/api/lost/done");
  EXPECT_EQ(b.get("/api/patients")["lost"], 0);
  EXPECT_NE(b.beginVisit(id), 0);
  EXPECT_EQ(faultsOf(b.options.folder), "");
}

TEST(Damage, EarlierVersion_GetsItsDigestsWhenItIsUnlocked) {
  Bench b;
  (void)b.addPatient("P-001");
  b.clinic.reset();
  const std::string keys = b.options.folder + "/keys";
  const auto file = readKeyFile(keys);
  ASSERT_TRUE(file && !file->rows.empty());
  ASSERT_TRUE(writeKeyFile(keys, {file->clinic, file->by_phrase, file->by_recovery, {}}));
  fs::remove(counterIn(b.options.folder));
  for (const char* table : {"clinic", "account", "patient", "visit", "trial", "note", "tries",
                            "answer", "intent", "mark", "log"}) {
    tamper(b, fmt::format("UPDATE {} SET row_n = 0, row_digest = NULL", table));
  }
  tamper(b, "DELETE FROM counter");
  b.restart();
  EXPECT_EQ(b.get("/api/patients/1")["code"], "P-001");
  tamper(b, "UPDATE patient SET side = 'left'");
  EXPECT_TRUE(has(faultsOf(b.options.folder), "patient 1 of P-001"));
  EXPECT_EQ(readKeyFile(keys)->rows, file->rows);
}

/// Every value of every table.
std::string dumpOf(const std::string& path) {
  Database db(path, Database::Mode::kReadWrite);
  std::vector<std::string> tables;
  Statement names = db.query("SELECT name FROM sqlite_schema WHERE type = 'table' ORDER BY name");
  while (names.step()) tables.push_back(names.text(0));
  std::string out;
  for (const std::string& table : tables) {
    std::string columns;
    Statement info = db.query(fmt::format("SELECT name FROM pragma_table_info('{}')", table));
    while (info.step()) columns += fmt::format("|| quote(\"{}\") || ','", info.text(0));
    Statement rows = db.query(
        fmt::format("SELECT '' {} FROM \"{}\" NOT INDEXED ORDER BY rowid", columns, table));
    while (rows.step()) out += table + ": " + rows.text(0) + "\n";
  }
  return out;
}

/// Answers that show patients and visits.
std::vector<std::string> answersOf(Bench& b, const std::vector<std::int64_t>& visits) {
  std::vector<std::string> out = {b.raw("GET", "/api/patients", "").body};
  for (int id = 1; id <= 3; ++id) {
    out.push_back(b.raw("GET", fmt::format("/api/patients/{}", id), "").body);
  }
  for (const std::int64_t id : visits) {
    out.push_back(b.raw("GET", fmt::format("/api/visits/{}", id), "").body);
  }
  out.push_back(b.raw("GET", "/api/sessions", "").body);
  out.push_back(b.raw("GET", "/api/export/all.csv", "").body);
  return out;
}

// Draws: 10,000 with all counts.
TEST(Damage, OneChangedByte_IsNamedOrWithoutEffect) {
  Bench b;
  fill(b, 3);
  std::vector<std::int64_t> visits;
  for (int id = 1; id <= 3; ++id) {
    visits.push_back(b.get(fmt::format("/api/patients/{}", id))["visits"][0]["id"]);
  }
  // The copy is of a running clinic: a part is in the write-ahead log only.
  test::Folder base;
  const std::string sound = base.path() + "/sound", broken = base.path() + "/broken";
  const auto renew = [&](const std::string& from, const std::string& to) {
    fs::remove_all(to);
    fs::copy(from, to, fs::copy_options::recursive);
  };
  {
    Database db(b.database(), Database::Mode::kReadWrite);
    db.run("PRAGMA wal_checkpoint(TRUNCATE)");
  }
  b.post("/api/patients/1/notes", {{"text", "newest"}});
  b.post("/api/patients/2/notes", {{"text", "newest"}});
  renew(b.options.folder, sound);
  renew(sound, broken);
  ASSERT_EQ(faultsOf(broken), "");
  const std::string whole = dumpOf(broken + "/clinic.db");
  b.clinic.reset();
  renew(sound, b.options.folder);
  b.restart();
  const std::vector<std::string> answers = answersOf(b, visits);
  auto random = test::seededRandom(590);
  const int draws = test::underFull() ? 10'000 : test::cases(1000);
  int named = 0, without_effect = 0, served = 0;
  const char* const names[] = {"clinic.db", "clinic.db-wal", "keys"};
  for (int draw = 0; draw < draws; ++draw) {
    const std::string name = names[random() % 3];
    const std::size_t at = random() % fs::file_size(sound + "/" + name);
    const auto with = static_cast<char>(1 + random() % 255);
    SCOPED_TRACE(fmt::format("draw {}: byte {} of {}, changed by {}", draw, at, name, int{with}));
    const auto damage = [&](const std::string& folder) {
      renew(sound, folder);
      std::string bytes = textOf(folder + "/" + name);
      bytes[at] = static_cast<char>(bytes[at] ^ with);
      std::ofstream(folder + "/" + name, std::ios::binary) << bytes;
    };
    damage(broken);
    if (!faultsOf(broken).empty()) {
      ++named;
    } else {
      ++without_effect;
      ASSERT_EQ(dumpOf(broken + "/clinic.db"), whole);
      ASSERT_TRUE(readKeyFile(broken + "/keys"));
    }
    if (draw % 4 != 0) continue;
    // What is served is right, or names the damage.
    ++served;
    b.clinic.reset();
    damage(b.options.folder);
    b.restart();
    const std::vector<std::string> now = answersOf(b, visits);
    const Json list = Json::parse(now[0]);
    if (list.contains("refused") || list["lost"] != 0) continue;
    for (std::size_t i = 0; i < now.size(); ++i) {
      if (now[i] != answers[i]) ASSERT_TRUE(has(now[i], "damaged")) << answers[i] << "\n" << now[i];
    }
  }
  std::printf("%d draws: %d named, %d without effect; %d served\n", draws, named, without_effect,
              served);
  EXPECT_GT(named, draws / 10);
}

}  // namespace
}  // namespace wholehand::clinic
