// Checks a clinic's database after power cuts, and after disk writes that fail.
#include "clinic/backup.hpp"
#include "clinic_bench.hpp"
#include "support/seed.hpp"

#include <map>
#include <memory>
#include <set>
#include <sqlite3.h>

namespace wholehand::clinic {
namespace {

/// Records the writes and syncs of SQLite. A disk that loses power keeps all synced bytes, and any
/// part of the others.
class Disk {
 public:
  struct Step {
    enum class Kind { kWrite, kTruncate, kSync, kDelete };
    Kind what;
    std::string file;  ///< name
    std::int64_t at = 0;
    std::string bytes = {};
  };
  std::vector<Step> steps;
  int writes_left = -1;  ///< number of writes until the disk is full; negative: never full

  Disk() {
    sqlite3_vfs_register(&own_, 1);
    current = this;
  }
  ~Disk() {
    sqlite3_vfs_register(real_, 1);
    sqlite3_vfs_unregister(&own_);
    current = nullptr;
  }
  Disk(const Disk&) = delete;
  Disk& operator=(const Disk&) = delete;

  /// Contents of the disk if the power fails before step `moment`.
  template <class Random>
  std::map<std::string, std::string> after(std::size_t moment, Random& random) const {
    std::map<std::string, std::size_t>
        synced;  // by file: the last sync; all earlier writes are kept
    for (std::size_t i = 0; i < moment; ++i) {
      if (steps[i].what == Step::Kind::kSync) synced[steps[i].file] = i;
    }
    std::map<std::string, std::string> files;
    for (std::size_t i = 0; i < moment; ++i) {
      const Step& step = steps[i];
      const auto at = static_cast<std::size_t>(step.at);
      const std::string& by = step.what == Step::Kind::kDelete ? kFolder : step.file;
      const bool kept = synced.contains(by) && i < synced[by];
      if (!kept && random() % 2 == 0) continue;
      if (step.what == Step::Kind::kDelete) files.erase(step.file);
      if (step.what == Step::Kind::kTruncate) files[step.file].resize(at);
      if (step.what != Step::Kind::kWrite) continue;
      std::string bytes = step.bytes;
      if (!kept && random() % 2 == 0)
        bytes.resize(random() % (bytes.size() / kSector + 1) * kSector);
      std::string& file = files[step.file];
      file.resize(std::max(file.size(), at + bytes.size()));
      file.replace(at, bytes.size(), bytes);
    }
    return files;
  }

 private:
  static constexpr std::size_t kSector = 512;
  inline static const std::string kFolder;  // the folder has no name in the steps
  /// Wraps SQLite's own file.
  struct File : sqlite3_file {
    sqlite3_file* real;
    Disk* disk;        ///< null: a temporary file
    const char* path;  ///< SQLite keeps the text while the file is open
    bool is_new;       ///< a new log: its first sync also syncs the folder
    [[nodiscard]] std::string name() const {
      return std::filesystem::path(path).filename().string();
    }
    void note(Step::Kind what, std::int64_t at = 0, std::string bytes = {}) const {
      if (disk != nullptr) disk->steps.push_back({what, name(), at, std::move(bytes)});
    }
  };
  static File& of(sqlite3_file* file) { return *static_cast<File*>(file); }
  static sqlite3_file* realOf(sqlite3_file* file) { return of(file).real; }
  static bool isFull() {
    if (current->writes_left < 0) return false;
    if (current->writes_left == 0) return true;
    --current->writes_left;
    return false;
  }

  static int open(sqlite3_vfs*, const char* path, sqlite3_file* file, int flags, int* out) {
    File& own = of(file);
    own.pMethods = nullptr;
    own.real = reinterpret_cast<sqlite3_file*>(&own + 1);
    constexpr int kLasting = SQLITE_OPEN_MAIN_DB | SQLITE_OPEN_WAL | SQLITE_OPEN_MAIN_JOURNAL;
    own.disk = (flags & kLasting) != 0 && path != nullptr ? current : nullptr;
    own.path = path;
    own.is_new = (flags & SQLITE_OPEN_CREATE) != 0 && (flags & SQLITE_OPEN_MAIN_DB) == 0;
    const int code = real_->xOpen(real_, path, own.real, flags, out);
    if (code == SQLITE_OK) own.pMethods = &kMethods;
    return code;
  }
  static int remove(sqlite3_vfs*, const char* path, int sync) {
    const std::string name = std::filesystem::path(path).filename().string();
    current->steps.push_back({Step::Kind::kDelete, name});
    if (sync != 0) current->steps.push_back({Step::Kind::kSync, kFolder});
    return real_->xDelete(real_, path, 0);
  }
  static int write(sqlite3_file* file, const void* bytes, int size, sqlite3_int64 at) {
    if (isFull()) return SQLITE_FULL;
    of(file).note(Step::Kind::kWrite, at,
                  {static_cast<const char*>(bytes), static_cast<std::size_t>(size)});
    return realOf(file)->pMethods->xWrite(realOf(file), bytes, size, at);
  }
  static int truncate(sqlite3_file* file, sqlite3_int64 size) {
    of(file).note(Step::Kind::kTruncate, size);
    return realOf(file)->pMethods->xTruncate(realOf(file), size);
  }
  static int sync(sqlite3_file* file, int) {
    if (isFull()) return SQLITE_IOERR_FSYNC;
    of(file).note(Step::Kind::kSync);
    if (std::exchange(of(file).is_new, false))
      current->steps.push_back({Step::Kind::kSync, kFolder});
    return SQLITE_OK;  // this wrapper is the disk of the test
  }

  template <auto kMethod>
  struct Forward;
  template <class R, class... Values, R (*sqlite3_io_methods::*kMethod)(sqlite3_file*, Values...)>
  struct Forward<kMethod> {
    static R call(sqlite3_file* file, Values... values) {
      return (realOf(file)->pMethods->*kMethod)(realOf(file), values...);
    }
  };
  using M = sqlite3_io_methods;
  // No xFetch: files are not mapped into memory, and no page is read without a request.
  static constexpr M kMethods = {2,
                                 Forward<&M::xClose>::call,
                                 Forward<&M::xRead>::call,
                                 write,
                                 truncate,
                                 sync,
                                 Forward<&M::xFileSize>::call,
                                 Forward<&M::xLock>::call,
                                 Forward<&M::xUnlock>::call,
                                 Forward<&M::xCheckReservedLock>::call,
                                 Forward<&M::xFileControl>::call,
                                 Forward<&M::xSectorSize>::call,
                                 Forward<&M::xDeviceCharacteristics>::call,
                                 Forward<&M::xShmMap>::call,
                                 Forward<&M::xShmLock>::call,
                                 Forward<&M::xShmBarrier>::call,
                                 Forward<&M::xShmUnmap>::call,
                                 nullptr,
                                 nullptr};
  inline static Disk* current = nullptr;
  inline static sqlite3_vfs* real_ = sqlite3_vfs_find(nullptr);
  sqlite3_vfs own_ = [] {
    sqlite3_vfs own = *real_;
    own.pNext = nullptr;
    own.zName = "disk-of-a-test";
    own.szOsFile += static_cast<int>(sizeof(File));
    own.xOpen = open;
    own.xDelete = remove;
    return own;
  }();
};

/// A change that was answered, and the number of disk steps until then.
struct AnsweredRequest {
  std::size_t steps;
  std::string note, code, erased;
};

TEST(PowerCut, PowerCutAtRandomMoments_LosesNoAnsweredChangeAndKeepsTheDatabaseSound) {
  Disk disk;
  Bench b;
  std::vector<AnsweredRequest> answered;
  const std::size_t begun = disk.steps.size();
  for (int round = 0; round < 4; ++round) {
    const std::string code = fmt::format("P-{:03}", round);
    const std::int64_t id = b.addPatient(code);
    answered.push_back({disk.steps.size(), "", code, ""});
    const std::int64_t visit = b.beginVisit(id);
    for (int n = 0; n < 60; ++n) {
      const std::string text = fmt::format("{}/{}", round, n);
      b.post(fmt::format("/api/visits/{}/notes", visit), {{"text", text}});
      ASSERT_EQ(b.status, 200);
      answered.push_back({disk.steps.size(), text, "", ""});
    }
    b.finish(visit);
    if (round == 1) b.restart();  // writes the log into the database and removes it
    if (round != 2) continue;
    const std::int64_t gone = b.addPatient("GONE");
    b.post(fmt::format("/api/patients/{}/erase", gone), {{"code", "GONE"}});
    ASSERT_EQ(b.status, 200);
    answered.push_back({disk.steps.size(), "", "", "GONE"});
  }
  auto random = test::seededRandom(4010);
  const std::size_t end = disk.steps.size();
  int lost = 0;
  const int cuts = test::kReducedCounts ? 10 : 100;
  for (int cut = 0; cut < cuts; ++cut) {
    const std::size_t moment = begun + random() % (end - begun + 1);
    SCOPED_TRACE(fmt::format("cut {} before step {} of {}", cut, moment, end));
    Bench after(false);
    after.clinic.reset();
    std::filesystem::create_directories(after.options.folder);
    std::filesystem::copy_file(b.options.folder + "/keys", after.options.folder + "/keys");
    for (const auto& [name, bytes] : disk.after(moment, random)) {
      std::ofstream(after.options.folder + "/" + name, std::ios::binary) << bytes;
    }
    const auto sound = verifyClinic(after.options.folder);
    ASSERT_TRUE(sound.ok()) << format(sound.errors());
    after.restart();
    std::set<std::string> notes, codes;
    const Json rows = after.get("/api/patients");
    for (const Json& row : rows["patients"]) {
      codes.insert(row["code"]);
      const auto id = row["id"].get<std::int64_t>();
      const Json patient = after.get(fmt::format("/api/patients/{}", id));
      for (const Json& visit : patient["visits"]) {
        for (const Json& note : visit["notes"]) notes.insert(note["text"]);
      }
    }
    for (const AnsweredRequest& a : answered) {
      if (a.steps > moment) break;
      const bool here = (a.note.empty() || notes.contains(a.note)) &&
                        (a.code.empty() || codes.contains(a.code)) &&
                        (a.erased.empty() || !codes.contains(a.erased));
      if (here) continue;
      ++lost;
      ADD_FAILURE() << "lost: " << a.note << a.code << a.erased;
    }
    disk.steps.resize(end);  // drops the steps of the copy
  }
  fmt::print("figure: {} answered changes, {} power cuts, {} lost\n", answered.size(), cuts, lost);
}

// The disk becomes full at the next write, the one after it, and so on.
TEST(PowerCut, DiskFullAtAnyWrite_RefusesTheWholeRequestByName) {
  Disk disk;
  Bench b;
  const std::int64_t id = b.addPatient("P-001");
  const std::int64_t visit = b.beginVisit(id);
  const auto one = [&](const char* path) { return fmt::format(fmt::runtime(path), id, visit); };
  const auto everything = [&] {
    return b.raw("GET", "/api/patients", "").body +
           b.raw("GET", fmt::format("/api/patients/{}", id), "").body;
  };
  struct Request {
    const char *method, *path;
    Json body;
  };
  Json changed = patientOf("P-001", "Another Name");
  changed["version"] = 1;
  const std::vector<Request> requests = {
      {"POST", "/api/patients", patientOf("P-002")},
      {"PUT", "/api/patients/{0}", changed},
      {"POST", "/api/patients/{0}/notes", {{"text", "a note"}}},
      {"POST", "/api/visits/{1}/pain", {{"when", "before"}, {"value", 0}}},
      {"PUT", "/api/notes/77", {{"visit", visit}, {"text", "a note"}}},
      {"POST", "/api/patients/{0}/no_show", Json::object()}};
  for (const Request& request : requests) {
    const std::string before = everything();
    int refused = 0;
    for (;; ++refused) {
      disk.writes_left = refused;
      const Json said = b.ask(request.method, one(request.path), request.body);
      disk.writes_left = -1;
      if (b.status == 200) break;
      ASSERT_EQ(said["refused"], "database") << said;
      EXPECT_NE(said["why"].get<std::string>().find("clinic.db"), std::string::npos) << said;
      EXPECT_EQ(everything(), before) << request.path << " after " << refused << " writes";
    }
    EXPECT_GT(refused, 1) << request.path;
    EXPECT_NE(everything(), before) << request.path;
  }
  b.finish(visit);
  // An erased patient stays erased even without room to compact the file.
  const std::int64_t gone = b.addPatient("GONE");
  for (int writes = 0; writes < 100; ++writes) {
    disk.writes_left = writes;
    b.post(fmt::format("/api/patients/{}/erase", gone), {{"code", "GONE"}});
    disk.writes_left = -1;
    const bool answered = b.status == 200;
    EXPECT_EQ(b.get(fmt::format("/api/patients/{}", gone)).contains("refused"), answered);
    if (answered) break;
    ASSERT_LT(writes, 99);
  }
  b.clinic->carryOut();
  EXPECT_EQ(b.get("/api/patients")["under_way"], Json::array());
  EXPECT_EQ(textOf(b.database() + "-wal").find("GONE"), std::string::npos);
  // A refused visit is open neither in the clinic nor in the station, or in both.
  for (int writes = 0; writes < 100; ++writes) {
    disk.writes_left = writes;
    b.post(fmt::format("/api/patients/{}/visits", id), {{"side", "right"}, {"plan", planOf()}});
    const int status = b.status;
    disk.writes_left = -1;
    const Json open = b.get("/api/visits/open")["visit"];
    EXPECT_EQ(open.is_null() ? 0 : open["id"].get<std::uint64_t>(), b.station.now.visit);
    if (!open.is_null()) b.finish(open["id"]);
    if (status == 200) break;
    ASSERT_LT(writes, 99);
  }
  EXPECT_TRUE(verifyClinic(b.options.folder).ok());
}

}  // namespace
}  // namespace wholehand::clinic
