// wholehand-clinic: keeps a clinic's patients, visits and results (docs/clinic.md).
#include "clinic/backup.hpp"
#include "clinic/clinic.hpp"
#include "clinic/http_server.hpp"
#include "clinic/intents.hpp"
#include "clinic/row_digests.hpp"
#include "clinic/station_client.hpp"
#include "clinic/trials.hpp"
#include "loop/core/expected.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <functional>
#include <iostream>
#include <malloc.h>
#include <mutex>
#include <string>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <termios.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace {

using namespace wholehand;          // NOLINT(google-build-using-namespace): the program's own main
using namespace wholehand::clinic;  // NOLINT(google-build-using-namespace)
namespace fs = std::filesystem;

constexpr int kExitDone = 0, kExitFailed = 1, kExitBadInput = 2;
constexpr const char* kToken = "WHOLEHAND_CLINIC_STATION_TOKEN";

int refuse(const Diagnostics& faults) {
  std::fprintf(stderr, "%s\n", format(faults).c_str());
  return kExitBadInput;
}

/// Folder of the shipped config/: in the working directory, else next to or above the program.
std::string shippedConfig() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  for (fs::path folder = program.parent_path(); !folder.empty(); folder = folder.parent_path()) {
    for (const fs::path& share : {folder, folder / "share" / "wholehand"}) {
      if (fs::exists(share / "config/clinic", error)) return (share / "config").string();
    }
    if (folder == folder.root_path()) break;
  }
  return "config";
}

/// Disables core dumps, which could contain names, and keeps other programs from reading this
/// memory.
void keepToOneself() {
  const rlimit none{0, 0};
  (void)::setrlimit(RLIMIT_CORE, &none);
  (void)::prctl(PR_SET_DUMPABLE, 0);
  ::umask(0077);
}

/// Runs a function repeatedly until it is told to end.
class PeriodicTask {
 public:
  PeriodicTask(std::chrono::milliseconds pause, std::function<void()> work)
      : thread_([this, pause, work = std::move(work)] {
          std::unique_lock lock(mutex_);
          while (!ends_.wait_for(lock, pause, [this] { return ended_; })) {
            lock.unlock();
            work();
            lock.lock();
          }
        }) {}
  ~PeriodicTask() {
    {
      const std::lock_guard lock(mutex_);
      ended_ = true;
    }
    ends_.notify_all();
    thread_.join();
  }
  PeriodicTask(const PeriodicTask&) = delete;
  PeriodicTask& operator=(const PeriodicTask&) = delete;

 private:
  std::mutex mutex_;
  std::condition_variable ends_;
  bool ended_ = false;
  std::thread thread_;  // last member: it uses the others
};

struct ServeOptions {
  ClinicOptions clinic;
  std::uint16_t port = 0, station = 8787;
  std::vector<std::string> origins;
  std::string program = "wholehand";
};

int serve(ServeOptions o) {
  const auto lock = FolderLock::take(o.clinic.folder);
  if (!lock) return refuse(lock.errors());
  if (o.origins.empty()) {
    o.origins = {fmt::format("http://127.0.0.1:{}", o.station),
                 fmt::format("http://localhost:{}", o.station)};
  }
  const char* token = std::getenv(kToken);  // NOLINT(concurrency-mt-unsafe): no other thread yet
  const SystemClock clock;
  StationClient station(o.station, token == nullptr ? "" : token);
  ::unsetenv(kToken);  // NOLINT(concurrency-mt-unsafe): children need none
  Clinic clinic(o.clinic, clock, station);
  auto server = HttpServer::start(clinic, o.port, o.origins);
  if (!server) return refuse(server.errors());
  std::printf("listening on http://127.0.0.1:%u\n", (*server)->port());
  std::fflush(stdout);
  std::atomic<bool> ending{false};
  const auto stop = [&ending] { return ending.load(); };
  const Measure measure = measureByChild(o.program, stop);
  {
    using std::chrono::seconds;
    const PeriodicTask look_at_station(seconds(1), [&] { clinic.lookAtStation(); });
    const PeriodicTask look_at_recordings(seconds(4),
                                          [&] { clinic.lookAtRecordings(measure, stop); });
    const PeriodicTask back_up(seconds(60), [&] { clinic.backUpIfDue(); });
    const PeriodicTask carry_out(seconds(1), [&] { clinic.carryOut(); });
    std::array<char, 256> ignored{};
    while (::read(STDIN_FILENO, ignored.data(), ignored.size()) > 0) {
    }
    ending = true;
  }
  return kExitDone;
}

/// Asks for a line of standard input. The typed text is hidden if `hidden`.
std::string asked(const char* question, bool hidden) {
  const bool typed = ::isatty(STDIN_FILENO) == 1;
  termios before{};
  if (typed) {
    std::fprintf(stderr, "%s: ", question);
    ::tcgetattr(STDIN_FILENO, &before);
    termios quiet = before;
    if (hidden) quiet.c_lflag &= ~static_cast<tcflag_t>(ECHO);
    ::tcsetattr(STDIN_FILENO, TCSANOW, &quiet);
  }
  std::string line;
  std::getline(std::cin, line);
  if (typed) {
    ::tcsetattr(STDIN_FILENO, TCSANOW, &before);
    if (hidden) std::fputc('\n', stderr);
  }
  return line;
}

int init(const ClinicOptions& options) {
  const auto lock = FolderLock::take(options.folder);
  if (!lock) return refuse(lock.errors());
  const Json body = {
      {"pass_phrase", asked("Pass phrase of the clinic, 8 characters at least", true)},
      {"tile",
       {{"name", asked("Name on the first tile", false)},
        {"pin", asked("Its PIN, 4 to 8 digits", true)},
        {"colour", "#0d6b5a"}}}};
  const SystemClock clock;
  NoStation station;
  Clinic clinic(options, clock, station);
  const Answer answer = clinic.answer(
      {"POST", "/api/init", {}, {}, {}, body.dump(-1, ' ', false, Json::error_handler_t::replace)});
  const Json said = Json::parse(answer.body);
  if (answer.status != 200) {
    std::fprintf(stderr, "%s\n", said.value("why", "failed").c_str());
    return kExitBadInput;
  }
  std::printf("recovery code, to be printed and locked away: %s\n",
              said.value("recovery_code", "").c_str());
  return kExitDone;
}

int eraseByCode(const ClinicOptions& options, const std::string& code) {
  const auto lock = FolderLock::take(options.folder);
  if (!lock) return refuse(lock.errors());
  Database db(options.folder + "/clinic.db", Database::Mode::kReadWrite);
  migrate(db);
  guardByKeys(db, options.folder);
  Statement row = db.query("SELECT id FROM patient WHERE code = ?", code);
  if (!row.step()) return refuse({{options.folder, 0, "CODE", code, "is no patient's", ""}});
  const std::int64_t id = row.integer(0);
  if (db.number("SELECT COUNT(*) FROM visit WHERE patient = ? AND state = 'open'", id) != 0) {
    return refuse({{options.folder, 0, "CODE", code, "has a visit open", "finish it first"}});
  }
  const std::int64_t now_us = SystemClock().now_us();
  {
    Transaction transaction(db);
    storeIntent(db, now_us, "erase", erasureOfPatient(db, id));
    db.change(
        "INSERT INTO log (at_us, account, what, patient, visit, detail) VALUES (?, 0, 'erased',"
        " ?, 0, 'by the command line')",
        now_us, id);
    transaction.commit();
  }
  row = db.query("SELECT 1");
  const Places places{options.folder, options.recordings, options.backups};
  for (const std::string& left : carryOutIntents(db, places, now_us)) {
    std::fprintf(stderr, "%s is still there: remove it, or give --recordings\n", left.c_str());
  }
  std::printf("erased\n");
  return kExitDone;
}

/// Prints the value of a command, or the reason why there is none.
template <class T>
int printResult(const Expected<T>& result, const std::function<std::string(const T&)>& words) {
  if (!result) return refuse(result.errors());
  std::printf("%s\n", words(*result).c_str());
  return kExitDone;
}

int runProgram(int argc, char** argv) {
  CLI::App app{"Keeps a clinic's patients, visits and results for Wholehand (docs/clinic.md)."};
  app.require_subcommand(1);
  ServeOptions o;
  o.clinic.config = shippedConfig();
  std::string file, code;
  int exit_code = kExitDone;
  // Options that several commands share.
  const auto add = [&](const char* name, const char* what) {
    CLI::App* command = app.add_subcommand(name, what);
    command->add_option("FOLDER", o.clinic.folder, "The clinic's folder")->required();
    command->add_option("--config", o.clinic.config, "The shipped config/");
    return command;
  };
  const auto recordings = [&](CLI::App* command) {
    return command->add_option("--recordings", o.clinic.recordings, "The station's recordings");
  };
  // The service for the station's pages.
  CLI::App* s = add("serve", "Answer the station's pages until standard input closes");
  s->add_option("--port", o.port, "Port on 127.0.0.1; 0: any free one");
  s->add_option("--station", o.station, "Port of the station");
  s->add_option("--origin", o.origins,
                "Origin of the pages, http://127.0.0.1:PORT; may be repeated");
  s->add_option("--program", o.program, "The program wholehand, which measures recordings");
  recordings(s);
  CLI::Option* backups = s->add_option("--backups", o.clinic.backups,
                                       "Folder of the daily backup (default: FOLDER/backups)");
  s->footer(fmt::format("The station's therapist token is read from {}.", kToken));
  s->callback([&] {
    if (backups->count() == 0) o.clinic.backups = o.clinic.folder + "/backups";
    exit_code = serve(o);
  });
  add("init", "Begin a clinic: pass phrase, first tile, recovery code")->callback([&] {
    exit_code = init(o.clinic);
  });
  // Backups.
  CLI::App* b = add("backup", "Copy a clinic while it runs, and compare the copy");
  b->add_option("--to", file, "New file")->required();
  b->callback([&] {
    exit_code = printResult<std::int64_t>(
        backUp(o.clinic.folder, file, SystemClock().now_us()), [&](const std::int64_t& rows) {
          return fmt::format("{}: {} rows, compared; its keys are in {}.keys", file, rows, file);
        });
  });
  CLI::App* r = app.add_subcommand("restore", "Make a backup the clinic of a folder");
  r->add_option("FILE", file, "The backup")->required();
  r->add_option("--to", o.clinic.folder, "The clinic's folder")->required();
  r->callback([&] {
    using Lines = std::vector<std::string>;
    exit_code = printResult<Lines>(
        restoreBackup(file, o.clinic.folder, SystemClock().now_us()),
        [](const Lines& lines) { return fmt::format("{}", fmt::join(lines, "\n")); });
  });
  add("verify", "Check database and keys")->callback([&] {
    exit_code = printResult<std::int64_t>(
        verifyClinic(o.clinic.folder),
        [](const std::int64_t& rows) { return fmt::format("sound: {} rows", rows); });
  });
  // Repair and erasure.
  CLI::App* again = add("rebuild", "Make the list of trials from the recordings alone");
  recordings(again)->required();
  again->add_option("--program", o.program, "The program wholehand");
  again->callback([&] {
    const auto lock = FolderLock::take(o.clinic.folder);
    if (!lock) {
      exit_code = refuse(lock.errors());
      return;
    }
    const auto done =
        rebuildTrials(o.clinic.folder, o.clinic.recordings, measureByChild(o.program, {}));
    exit_code = printResult<std::string>(done, [](const std::string& words) { return words; });
  });
  CLI::App* e = add("erase", "Delete everything of one patient, and keep it from coming back");
  e->add_option("CODE", code, "The patient's code")->required();
  e->add_option("--backups", o.clinic.backups, "Folder of the daily backup");
  recordings(e);
  e->callback([&] {
    if (o.clinic.backups.empty()) o.clinic.backups = o.clinic.folder + "/backups";
    exit_code = eraseByCode(o.clinic, code);
  });
  add("export", "Print all values as CSV, by code, without names")->callback([&] {
    Database db(o.clinic.folder + "/clinic.db", Database::Mode::kReadWrite);
    migrate(db);
    guardByKeys(db, o.clinic.folder);
    std::fputs(csvOf(db, 0).c_str(), stdout);
  });
  CLI11_PARSE(app, argc, argv);
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);
  keepToOneself();
  // An arena of each thread would reserve 64 MB of the address space, of which the station allows
  // 1 GB; then no key could be derived.
  mallopt(M_ARENA_MAX, 2);
  try {
    return runProgram(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "wholehand-clinic: %s\n", error.what());
  }
  return kExitFailed;
}
