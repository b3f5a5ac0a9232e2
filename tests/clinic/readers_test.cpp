// Erasures beside readers of the database: they end, whoever reads.
#include "clinic/row_digests.hpp"
#include "clinic_bench.hpp"

#include <atomic>
#include <csignal>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace wholehand::clinic {
namespace {
namespace fs = std::filesystem;

/// Adds visits with long results, so that an export takes a while.
void addLongVisits(const Bench& b, std::int64_t patient, int visits) {
  Json results = Json::array();
  for (int i = 0; i < 100; ++i) {
    results.push_back({{"name", fmt::format("measure_{}", i)}, {"value", i}, {"unit", "s"}});
  }
  const std::string measures = Json({{"exercise", "cocktail-bar"}, {"results", results}}).dump();
  Database db(b.database(), Database::Mode::kReadWrite);
  guardByKeys(db, b.options.folder);
  Transaction transaction(db);
  for (int i = 1; i <= visits; ++i) {
    db.change(
        "INSERT INTO visit (id, patient, account, side, hand, hand_file, began_us, ended_us,"
        " offset_min, state, plan, item) VALUES (?1, ?2, 1, 'right', '', '', ?1, ?1, 0, 'done',"
        " '[]', 0)",
        i, patient);
    db.change(
        "INSERT INTO trial (recording, size, modified_ns, state, why, visit, item, began_us, "
        "sha256,"
        " measures_version, measures) VALUES (?, 1, 1, 'measured', '', ?, 0, 0, ?, 3, ?)",
        fmt::format("{}.h5", i), i, fmt::format("sha-{}", i), measures);
  }
  transaction.commit();
}

bool isHeldIn(const std::string& folder, const std::string& text) {
  for (const auto& file : fs::recursive_directory_iterator(folder)) {
    if (file.is_regular_file() && textOf(file.path().string()).find(text) != std::string::npos) {
      return true;
    }
  }
  return false;
}

TEST(Readers, EraseBesideAnExport_EndsTheReadingAndTheExportBeginsAnew) {
  Bench b;
  const std::int64_t gone = b.addPatient("GONE-1"), stays = b.addPatient("P-002");
  addLongVisits(b, stays, 150);
  b.restart();
  const Request all{"GET", "/api/export/all.csv", "", b.token, "", ""};
  const Request progress{"GET", "/api/export/progress", "", b.token, "", ""};
  const auto visits_done = [&] {
    return Json::parse(b.clinic->answer(progress).body).value("done", 0);
  };
  Answer answer;
  std::atomic<bool> ended{false};
  std::thread exporting([&] {
    answer = b.clinic->answer(all);
    ended = true;
  });
  while (visits_done() == 0 && !ended) std::this_thread::yield();
  const bool amid = !ended;
  b.post(fmt::format("/api/patients/{}/erase", gone), {{"code", "GONE-1"}});
  EXPECT_EQ(b.status, 200);
  const bool still = !ended;
  b.clinic->carryOut();
  EXPECT_EQ(b.get("/api/patients")["under_way"], Json::array());
  EXPECT_FALSE(isHeldIn(b.options.folder, "GONE-1"));
  exporting.join();
  EXPECT_EQ(answer.status, 200);
  EXPECT_TRUE(answer.body.ends_with("measure_99,99,s\r\n"));
  // One line of titles, 150 visits with 100 values each.
  EXPECT_EQ(std::count(answer.body.begin(), answer.body.end(), '\n'), 1 + 150 * 100);
  if (amid && still) EXPECT_EQ(answer.body.find("GONE-1"), std::string::npos);
  std::printf("the erasure began %s the export\n", amid && still ? "amid" : "behind");
}

TEST(Readers, ProgramThatReadsTheDatabase_IsNamedAndTheEraseGoesOnWhenItIsGone) {
  Bench b;
  const std::int64_t gone = b.addPatient("GONE-1");
  b.clinic.reset();  // no connection goes over the fork
  int line[2];
  ASSERT_EQ(::pipe(line), 0);
  const pid_t reader = ::fork();
  if (reader == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    const Database db = [&] {
      Database opened(b.database(), Database::Mode::kReadOnly);
      opened.run("BEGIN");
      (void)opened.number("SELECT COUNT(*) FROM patient");
      return opened;
    }();
    (void)!::write(line[1], "r", 1);
    while (true) ::pause();
  }
  char byte = 0;
  ASSERT_EQ(::read(line[0], &byte, 1), 1);
  b.restart();
  b.post(fmt::format("/api/patients/{}/erase", gone), {{"code", "GONE-1"}});
  EXPECT_EQ(b.status, 200);
  const auto under_way = [&] { return b.get("/api/patients")["under_way"]; };
  std::uintmax_t log_bytes = 0;
  for (int minute = 0; minute < 5; ++minute) {
    b.clock.pass(61 * kSecond_us);
    b.clinic->carryOut();
    ASSERT_FALSE(under_way().empty());
    EXPECT_NE(under_way().back()["problem"].get<std::string>().find(
                  fmt::format(" (process {}) reads it", reader)),
              std::string::npos)
        << under_way();
    // Further tries do not lengthen the log.
    const auto bytes = fs::file_size(b.database() + "-wal");
    if (minute > 0) EXPECT_EQ(bytes, log_bytes);
    log_bytes = bytes;
  }
  ::kill(reader, SIGKILL);
  ::waitpid(reader, nullptr, 0);
  b.clinic->carryOut();  // at the next second, without a request and without a start
  EXPECT_EQ(under_way(), Json::array());
  EXPECT_FALSE(isHeldIn(b.options.folder, "GONE-1"));
  for (const int end : line) ::close(end);
}

}  // namespace
}  // namespace wholehand::clinic
