// Kills the process before every change of a file in every action over rows and files. Afterwards
// the action has not happened, or the next start completes it.
#include "clinic/backup.hpp"
#include "clinic_bench.hpp"
#include "support/seed.hpp"

#include <csignal>
#include <fcntl.h>
#include <map>
#include <numeric>
#include <set>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

namespace wholehand::clinic {
namespace {
namespace fs = std::filesystem;

using Action = std::function<void(Bench&)>;

/// True for a system call that changes a file or a folder.
bool changesFiles(const __ptrace_syscall_info& info) {
  static const std::set<std::uint64_t> kChanges = {
      SYS_write,    SYS_pwrite64, SYS_writev,  SYS_pwritev, SYS_ftruncate, SYS_fallocate,
      SYS_renameat, SYS_unlinkat, SYS_mkdirat, SYS_linkat,
#ifdef SYS_rename
      SYS_rename,   SYS_unlink,   SYS_mkdir,   SYS_rmdir,   SYS_renameat2
#endif
  };
  if (info.entry.nr == SYS_openat) return (info.entry.args[2] & (O_CREAT | O_TRUNC)) != 0;
  return kChanges.contains(info.entry.nr);
}

/// Runs an action in a child process and kills it before its change number `at`; -1: not.
/// @return number of changes made
int runKilled(Bench& b, const Action& action, int at) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::ptrace(PTRACE_TRACEME, 0, nullptr, nullptr);
    b.restart();
    ::raise(SIGSTOP);
    action(b);
    ::raise(SIGSTOP);
    ::_exit(0);
  }
  const auto end = [child] {
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
  };
  int status = 0, changes = 0, signal = 0;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSTOPPED(status) && WSTOPSIG(status) == SIGSTOP) << "this system refuses ptrace";
  ::ptrace(PTRACE_SETOPTIONS, child, nullptr, PTRACE_O_TRACESYSGOOD | PTRACE_O_EXITKILL);
  while (true) {
    ::ptrace(PTRACE_SYSCALL, child, nullptr, signal);
    ::waitpid(child, &status, 0);
    if (!WIFSTOPPED(status)) {
      ADD_FAILURE() << "the action ended the process, status " << status;
      return changes;
    }
    signal = 0;
    if (WSTOPSIG(status) == SIGSTOP) break;
    if (WSTOPSIG(status) != (SIGTRAP | 0x80)) {
      signal = WSTOPSIG(status);
      continue;
    }
    __ptrace_syscall_info info{};
    ::ptrace(PTRACE_GET_SYSCALL_INFO, child, sizeof info, &info);
    if (info.op != PTRACE_SYSCALL_INFO_ENTRY || !changesFiles(info)) continue;
    if (changes == at) break;
    ++changes;
  }
  end();
  return changes;
}

void write(const Bench& b, const std::string& path, const std::string& text) {
  fs::create_directories(fs::path(b.folder.path() + "/" + path).parent_path());
  std::ofstream(b.folder.path() + "/" + path) << text;
}

Json measuresOf(std::int64_t visit, const std::string& sha256) {
  return {{"visit", visit},
          {"measures", 1},
          {"recording",
           {{"sha256", sha256},
            {"ticks", 5},
            {"duration_s", 1.0},
            {"began_utc", "2026-11-28T12:00:05Z"}}}};
}

/// A clinic in which every kind of thing exists.
struct FullClinic {
  Bench b;
  std::int64_t gone = 0, stays = 0, twin = 0, mistyped = 0, guest = 0, kept_visit = 0;
  std::string backup = b.options.backups + "/old.db";
  std::vector<std::string> needles;  ///< bytes of the person to be erased

  FullClinic() {
    gone = b.post("/api/patients", [] {
      Json body = patientOf("GONE-1", "Anna Gone");
      body["hands"]["right"] = {{"length_m", 0.21}, {"breadth_m", 0.115}};  // needs a hand file
      return body;
    }())["id"];
    stays = b.addPatient("P-002", "Karl Stays");
    twin = b.addPatient("P-003", "Karl Twin");
    mistyped = b.addPatient("P-004", "Nobody");
    b.post(fmt::format("/api/patients/{}/notes", mistyped), {{"text", "mistyped"}});
    std::map<std::string, Json> results;
    const auto record = [&](const std::string& stem, std::int64_t visit) {
      write(b, "recordings/" + stem + ".h5", stem + " Anna-Gone-bytes");
      write(b, "recordings/" + stem + ".h5.json", "{}");
      write(b, "recordings/" + stem + ".wbb", "black box");
      write(b, "recordings/" + stem + "-report/index.html", "a report");
      results[stem + ".h5"] = measuresOf(visit, "sha-of-" + stem);
    };
    for (int i = 0; i < 2; ++i) {
      const std::int64_t visit = b.beginVisit(gone);
      b.post(fmt::format("/api/visits/{}/notes", visit), {{"text", "a note"}});
      record(fmt::format("2026-visit-{}-bar-level-1", visit), visit);
      b.finish(visit);
    }
    kept_visit = b.beginVisit(stays);
    record(fmt::format("2026-visit-{}-bar", kept_visit), kept_visit);
    b.finish(kept_visit);
    guest = b.post("/api/guest_visits", {{"side", "right"}})["id"];
    record(fmt::format("2026-visit-{}-bar", guest), guest);
    b.finish(guest);
    record("nobodys", 0);
    for (int i = 0; i < 2; ++i, b.clock.pass(3 * kSecond_us)) {
      b.clinic->lookAtRecordings(
          [&](const std::string& path, std::string&) -> std::optional<Json> {
            return results.at(fs::path(path).filename().string());
          },
          {});
    }
    b.clinic->carryOut();
    EXPECT_TRUE(backUp(b.options.folder, backup, b.clock.now).ok());
    fs::copy_file(backup, b.options.folder + "/clinic.db.replaced-0000");
    Database db(b.database(), Database::Mode::kReadWrite);
    Statement rows = db.query(
        "SELECT secret FROM patient WHERE id = ?1 UNION ALL SELECT text FROM note WHERE visit IN"
        " (SELECT id FROM visit WHERE patient = ?1)",
        gone);
    while (rows.step()) needles.push_back(rows.text(0));
    needles.emplace_back("GONE-1");
    // A recording that the table does not know yet.
    const std::int64_t last = db.number("SELECT MAX(id) FROM visit WHERE patient = ?", gone);
    write(b, fmt::format("recordings/2026-visit-{}-bar-level-2.h5", last), "unknown");
    b.clinic.reset();
  }
};

/// Copies a clinic into a folder of its own.
void copyInto(Bench& to, const Bench& from) {
  to.clinic.reset();
  fs::remove_all(to.folder.path());
  fs::copy(from.folder.path(), to.folder.path(), fs::copy_options::recursive);
  to.clock = from.clock;
  to.keys = from.keys;  // a key is not used twice
}

/// All that the pages and the folders show.
std::string stateOf(Bench& b) {
  const Json list = b.get("/api/patients");
  EXPECT_EQ(b.status, 200) << list;
  std::string out = list.dump(1);
  for (const Json& row : list["patients"]) {
    out += b.get(fmt::format("/api/patients/{}", row["id"].get<std::int64_t>())).dump(1);
  }
  out += b.get("/api/sessions").dump(1);
  std::set<std::string> names;
  for (const std::string& folder : {b.options.recordings, b.options.folder + "/hands"}) {
    for (const auto& file : fs::recursive_directory_iterator(folder)) {
      names.insert(file.path().string().substr(b.folder.path().size()));
    }
  }
  for (const std::string& name : names) out += name + "\n";
  return out;
}

/// A file below the folder that holds one of the texts; empty: none does.
std::string fileWith(const std::string& folder, const std::vector<std::string>& needles) {
  for (const auto& file : fs::recursive_directory_iterator(folder)) {
    if (!file.is_regular_file()) continue;
    const std::string bytes = textOf(file.path().string());
    for (const std::string& needle : needles) {
      if (bytes.find(needle) != std::string::npos) return file.path().string();
    }
  }
  return {};
}

/// Kills the action before its changes, one in each run, and judges each end.
/// @param needles bytes that no file holds after the action
void killAtEveryChange(const FullClinic& base, const Action& action,
                       const std::vector<std::string>& needles = {}) {
  Bench b(false);
  const auto reopen = [&] {
    b.restart();
    b.clinic->carryOut();
    return stateOf(b);
  };
  copyInto(b, base.b);
  const std::string before = reopen();
  copyInto(b, base.b);
  const int changes = runKilled(b, action, -1);
  const std::string after = reopen();
  ASSERT_TRUE(before != after) << "the action had no effect";
  ASSERT_GT(changes, 5);
  std::vector<int> kills(static_cast<std::size_t>(changes));
  std::iota(kills.begin(), kills.end(), 0);
  if (!test::fullCounts()) {  // half of them near the end, where files are renamed
    auto random = test::seededRandom(5901);
    const int sample = test::kSanitized       ? 1
                       : test::kReducedCounts ? 2
                                              : 12,
              near = std::min(changes, 10);
    kills.clear();
    for (int i = 0; i < sample; ++i) {
      const auto range = static_cast<std::uint64_t>(i % 2 == 0 ? near : changes);
      kills.push_back(changes - 1 - static_cast<int>(random() % range));
    }
  }
  int done = 0;
  for (const int kill : kills) {
    SCOPED_TRACE(fmt::format("killed before change {} of {}", kill, changes));
    copyInto(b, base.b);
    ASSERT_EQ(runKilled(b, action, kill), kill);
    const std::string now = reopen();
    if (now == after) {
      ++done;
      EXPECT_EQ(fileWith(b.folder.path(), needles), "");
    } else {
      ASSERT_TRUE(now == before) << now;
    }
    EXPECT_TRUE(verifyClinic(b.options.folder).ok());
  }
  fmt::print("figure: {} kills, {} completed at the next start, {} without effect\n", kills.size(),
             done, kills.size() - static_cast<std::size_t>(done));
}

TEST(Intents, KilledErase_IsCompletedAtTheNextStartOrHasNotBegun) {
  const FullClinic base;
  std::vector<std::string> needles = base.needles;
  killAtEveryChange(
      base,
      [&](Bench& b) {
        b.post(fmt::format("/api/patients/{}/erase", base.gone), {{"code", "GONE-1"}});
        b.clinic->carryOut();
      },
      needles);
}

TEST(Intents, KilledDeletions_AreCompletedAtTheNextStartOrHaveNotBegun) {
  const FullClinic base;
  killAtEveryChange(base, [&](Bench& b) {
    b.ask("DELETE", fmt::format("/api/visits/{}", base.guest));
    b.clinic->carryOut();
  });
  killAtEveryChange(base, [&](Bench& b) {
    b.ask("DELETE", fmt::format("/api/patients/{}", base.mistyped));
    b.clinic->carryOut();
  });
  killAtEveryChange(base, [&](Bench& b) {
    const Json list = b.get("/api/sessions")["sessions"];
    b.ask("DELETE", fmt::format("/api/sessions/{}", list[0]["id"].get<std::int64_t>()));
    b.clinic->carryOut();
  });
}

TEST(Intents, KilledMoveMergeOrGift_IsCompletedAtTheNextStartOrHasNotBegun) {
  const FullClinic base;
  killAtEveryChange(base, [&](Bench& b) {
    b.post(fmt::format("/api/visits/{}/move", base.kept_visit), {{"patient", base.twin}});
    b.clinic->carryOut();
  });
  killAtEveryChange(base, [&](Bench& b) {
    b.post(fmt::format("/api/patients/{}/merge", base.stays), {{"from", base.twin}});
    b.clinic->carryOut();
  });
  killAtEveryChange(base, [&](Bench& b) {
    const Json list = b.get("/api/sessions")["sessions"];
    b.post("/api/sessions/give", {{"patient", base.stays}, {"sessions", {list[0]["id"]}}});
    b.clinic->carryOut();
  });
}

TEST(Intents, KilledRestore_IsCompletedAtTheNextStartOrHasNotBegun) {
  FullClinic base;
  base.b.restart();
  base.b.post(fmt::format("/api/patients/{}/merge", base.stays), {{"from", base.twin}});
  base.b.clinic->carryOut();
  base.b.clinic.reset();
  killAtEveryChange(base, [&](Bench& b) {
    b.clinic.reset();
    const auto restored =
        restoreBackup(b.options.backups + "/old.db", b.options.folder, b.clock.now);
    if (!restored) fmt::print("{}\n", format(restored.errors()));
  });
}

TEST(Intents, EraseBesideAReaderOrADamagedBackup_IsShownUntilItIsDone) {
  Bench b;
  const std::int64_t id = b.addPatient("GONE-1");
  ASSERT_TRUE(backUp(b.options.folder, b.options.backups + "/a.db", b.clock.now).ok());
  const std::string damaged = b.options.backups + "/b.db";
  std::ofstream(damaged) << "GONE-1 in half a backup";
  auto reader = std::make_unique<Database>(b.database(), Database::Mode::kReadOnly);
  reader->run("BEGIN");
  EXPECT_EQ(reader->number("SELECT COUNT(*) FROM patient"), 1);
  b.post(fmt::format("/api/patients/{}/erase", id), {{"code", "GONE-1"}});
  ASSERT_EQ(b.status, 200);
  const auto problem = [&] {
    b.clock.pass(61 * kSecond_us);
    b.clinic->carryOut();
    const Json under_way = b.get("/api/patients")["under_way"];
    return under_way.empty() ? "" : under_way.back()["problem"].get<std::string>();
  };
  EXPECT_NE(problem().find("another program reads it"), std::string::npos);
  reader.reset();
  b.restart();  // the next start goes on
  EXPECT_NE(problem().find("b.db"), std::string::npos);
  fs::remove(damaged);
  EXPECT_EQ(problem(), "");
  EXPECT_EQ(fileWith(b.folder.path(), {"GONE-1"}), "");
}

TEST(Intents, RecordingOfAnErasedVisit_IsRemovedWheneverItIsFound) {
  Bench b;
  const std::int64_t id = b.addPatient("GONE-1"), visit = b.beginVisit(id);
  b.finish(visit);
  b.post(fmt::format("/api/patients/{}/erase", id), {{"code", "GONE-1"}});
  b.clinic->carryOut();
  const std::string named = fmt::format("recordings/2026-visit-{}-bar.h5", visit);
  write(b, named, "cut off");                     // cannot be read: its name says the visit
  write(b, "recordings/renamed.h5", "readable");  // its content does
  write(b, "recordings/renamed.h5.json", "{}");
  write(b, "recordings/others.h5", "of nobody");
  for (int i = 0; i < 2; ++i, b.clock.pass(3 * kSecond_us)) {
    b.clinic->lookAtRecordings(
        [&](const std::string& path, std::string& why) -> std::optional<Json> {
          why = "is truncated";
          if (path.ends_with("renamed.h5")) return measuresOf(visit, "aa");
          if (path.ends_with("others.h5")) return measuresOf(0, "bb");
          return {};
        },
        {});
  }
  std::set<std::string> left;
  for (const auto& file : fs::directory_iterator(b.options.recordings)) {
    left.insert(file.path().filename().string());
  }
  EXPECT_EQ(left, std::set<std::string>{"others.h5"});
}

}  // namespace
}  // namespace wholehand::clinic
