#include "clinic/backup.hpp"
#include "clinic/rows.hpp"
#include "clinic_bench.hpp"

namespace wholehand::clinic {
namespace {

constexpr std::int64_t kMinute_us = 60 * kSecond_us;

std::string signIn(Bench& b) {
  return b.ask("POST", "/api/sign_in", {{"account", 1}, {"pin", "1234"}}).value("token", "");
}

TEST(Accounts, StoredAnswer_IsRepeatedOnlyToASessionThatSeesAsMuch) {
  Bench b;
  const std::int64_t visit = b.beginVisit(b.addPatient("P-001"));
  const std::string notes = fmt::format("/api/visits/{}/notes", visit);
  const Json body = {{"text", "cue given to Anna"}};
  const Json shown = b.ask("POST", notes, body, "page-1");
  ASSERT_EQ(b.status, 200);
  b.post("/api/hide");
  EXPECT_EQ(b.ask("POST", notes, body, "page-1")["refused"], "hidden");
  // What was answered to a hidden session is repeated to it.
  const Json hidden = b.ask("POST", notes, {{"text", "again"}}, "page-2");
  EXPECT_EQ(b.ask("POST", notes, {{"text", "again"}}, "page-2"), hidden);
  b.post("/api/show", {{"pin", "1234"}});
  EXPECT_EQ(b.ask("POST", notes, body, "page-1"), shown);
  EXPECT_EQ(b.get(fmt::format("/api/visits/{}", visit))["notes"].size(), 2U);
}

TEST(Accounts, NumbersOfPostedAndPutNotes_NeverMeet) {
  Bench b;
  const std::int64_t id = b.addPatient("P-001");
  for (int i = 0; i < 3; ++i) {
    b.post(fmt::format("/api/patients/{}/notes", id), {{"text", "posted"}});
    ASSERT_EQ(b.status, 200);
    b.ask("PUT", fmt::format("/api/notes/{}", kLastDrawnNote - i),
          {{"patient", id}, {"text", "put"}});
    ASSERT_EQ(b.status, 200);
    b.restart();
  }
  EXPECT_EQ(
      b.ask("PUT", fmt::format("/api/notes/{}", kLastDrawnNote + 1), {{"patient", id}})["refused"],
      "bad_value");
  int posted = 0;
  const Json patient = b.get(fmt::format("/api/patients/{}", id));
  for (const Json& note : patient["notes"]) {
    const bool drawn = note["id"].get<std::int64_t>() <= kLastDrawnNote;
    EXPECT_EQ(note["text"], drawn ? "put" : "posted");
    posted += drawn ? 0 : 1;
  }
  EXPECT_EQ(posted, 3);
}

TEST(Accounts, WaitAfterWrongPins_SurvivesARestart) {
  Bench b;
  for (int i = 0; i < 5; ++i)
    (void)b.ask("POST", "/api/sign_in", {{"account", 1}, {"pin", "0000"}});
  const Json right = {{"account", 1}, {"pin", "1234"}};
  b.restart(false);
  b.post("/api/unlock", {{"pass_phrase", "correct horse"}});
  EXPECT_EQ(b.refused("/api/sign_in", right), "too_many_tries");
  b.clock.pass(20 * kSecond_us);
  b.restart(false);
  b.post("/api/unlock", {{"pass_phrase", "correct horse"}});
  EXPECT_EQ(b.post("/api/sign_in", right)["wait_s"], 10);
  b.clock.pass(10 * kSecond_us);
  EXPECT_EQ(b.refused("/api/sign_in", right), "");
}

TEST(Accounts, WaitAfterWrongPassPhrases_SurvivesARestart) {
  Bench b;
  b.restart(false);
  for (int i = 0; i < 5; ++i) b.post("/api/unlock", {{"pass_phrase", "wrong phrase"}});
  b.restart(false);
  EXPECT_EQ(b.refused("/api/unlock", {{"pass_phrase", "correct horse"}}), "too_many_tries");
  b.clock.pass(30 * kSecond_us);
  EXPECT_EQ(b.refused("/api/unlock", {{"pass_phrase", "correct horse"}}), "");
}

TEST(Accounts, SignInBeyond64_EndsTheOldestIdleSession) {
  Bench b;
  const std::string working = b.token, training = signIn(b), idle = signIn(b);
  std::vector<std::string> others;
  for (int i = 0; i < 61; ++i) {
    b.clock.pass(kSecond_us);
    others.push_back(signIn(b));
  }
  // One works, one only polls for its open visit, the oldest other one rests.
  for (int i = 0; i < 12; ++i) {
    b.clock.pass(30 * kSecond_us);
    b.token = training;
    (void)b.get("/api/visits/open");
    b.token = working;
    (void)b.get("/api/patients");
  }
  const std::string newest = signIn(b);
  const auto knows = [&](const std::string& token) {
    b.token = token;
    (void)b.get("/api/visits/open");
    return b.status == 200;
  };
  EXPECT_TRUE(knows(working));
  EXPECT_TRUE(knows(training));
  EXPECT_TRUE(knows(others[0]));
  EXPECT_TRUE(knows(newest));
  EXPECT_FALSE(knows(idle));
}

TEST(Accounts, PassPhraseAndRecoveryCode_AreChangedWhileTheKeyStays) {
  Bench b;
  const std::int64_t id = b.addPatient("P-001", "Anna Keller");
  const std::string backup = b.options.backups + "/clinic-1.db", old_code = b.recovery_code;
  ASSERT_TRUE(backUp(b.options.folder, backup, b.clock.now).ok());
  EXPECT_EQ(b.refused("/api/phrase",
                      {{"pass_phrase", "wrong phrase"}, {"new_pass_phrase", "battery staple"}}),
            "wrong_phrase");
  EXPECT_EQ(b.post("/api/phrase",
                   {{"pass_phrase", "correct horse"}, {"new_pass_phrase", "short"}})["field"],
            "new_pass_phrase");
  const Json said =
      b.post("/api/phrase", {{"recovery_code", old_code}, {"new_pass_phrase", "battery staple"}});
  EXPECT_EQ(said["old_copies"], Json::array()) << said;
  const std::string code =
      b.post("/api/recovery_code", {{"pass_phrase", "battery staple"}})["recovery_code"];
  EXPECT_NE(code, old_code);
  const auto unlocks = [&](const Json& words) {
    b.restart(false);
    b.clock.pass(kMinute_us);
    const bool ok = b.refused("/api/unlock", words).empty();
    if (ok) {
      b.token = signIn(b);
      EXPECT_EQ(b.get(fmt::format("/api/patients/{}", id))["name"], "Anna Keller");
    }
    return ok;
  };
  EXPECT_FALSE(unlocks({{"pass_phrase", "correct horse"}}));
  EXPECT_FALSE(unlocks({{"recovery_code", old_code}}));
  EXPECT_TRUE(unlocks({{"pass_phrase", "battery staple"}}));
  EXPECT_TRUE(unlocks({{"recovery_code", code}}));
  // The backup opens with the new words, too.
  b.clinic.reset();
  std::filesystem::remove_all(b.options.folder);
  ASSERT_TRUE(restoreBackup(backup, b.options.folder, b.clock.now).ok());
  EXPECT_TRUE(unlocks({{"pass_phrase", "battery staple"}}));
}

}  // namespace
}  // namespace wholehand::clinic
