#include "record/recording.hpp"

#include "record/synthetic_recording.hpp"
#include "support/contains.hpp"
#include "support/file_bytes.hpp"
#include "support/python.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"
#include "support/watched_main.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <fstream>
#include <signal.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace wholehand {
namespace {

using synthetic::Folder;
using synthetic::identical;
using synthetic::noisyTicks;
using test::python;

std::unique_ptr<RecordingWriter> writer(const std::string& path,
                                        const RecordingMeta& meta = synthetic::meta()) {
  auto created = RecordingWriter::create(path, meta);
  EXPECT_TRUE(created.ok()) << (created.ok() ? "" : format(created.errors()));
  return created.ok() ? std::move(created).value() : nullptr;
}

std::unique_ptr<RecordingReader> reader(const std::string& path) {
  auto opened = RecordingReader::open(path);
  EXPECT_TRUE(opened.ok()) << (opened.ok() ? "" : format(opened.errors()));
  return opened.ok() ? std::move(opened).value() : nullptr;
}

void expectRefused(const std::string& path, const std::string& why) {
  const auto opened = RecordingReader::open(path);
  EXPECT_TRUE(test::refusedWith(opened, why)) << path;
}

/// Checks that there are `rows` rows, all of synthetic::noisy() in rising order.
void expectTrueTicks(RecordingReader& r, std::uint64_t rows) {
  ASSERT_EQ(r.size(), rows);
  std::mt19937_64 random(1);
  TickRecord got, want;
  for (std::uint64_t i = 0, tick = 0; i < rows; ++i) {
    ASSERT_TRUE(r.read(i, got));
    do want = synthetic::noisy(tick, random);
    while (tick++ < got.tick);
    ASSERT_TRUE(identical(got, r.digest(), want)) << "row " << i;
  }
}

TEST(Recording, EveryTick_IsReadBack) {
  const Folder folder;
  const std::string path = folder.file("a.h5");
  constexpr std::uint64_t kTicks = 1103;  // no multiple of a chunk
  auto w = writer(path);
  for (const TickRecord& tick : noisyTicks(kTicks)) ASSERT_TRUE(w->append(tick));
  w->close();
  EXPECT_EQ(w->written(), kTicks);
  EXPECT_EQ(w->dropped(), 0U);
  auto r = reader(path);
  expectTrueTicks(*r, kTicks);
  TickRecord got;
  EXPECT_FALSE(r->read(kTicks, got));
  ASSERT_TRUE(r->read(3, got)) << "backwards";
  EXPECT_EQ(got.tick, 3U);
}

TEST(Recording, Description_ComesBackWithIdenticalFiles) {
  const Folder folder;
  const std::string path = folder.file("a.h5");
  RecordingMeta want = synthetic::meta();
  want.paper = true;
  want.simulated_device = false;
  want.capsule_names.clear();
  writer(path, want)->close();
  const auto r = reader(path);
  const RecordingMeta& got = r->meta();
  EXPECT_EQ(got.created_utc, want.created_utc);
  EXPECT_EQ(got.git_version, want.git_version);
  EXPECT_EQ(got.seed, want.seed);
  EXPECT_EQ(got.exercise, want.exercise);
  EXPECT_EQ(got.level, want.level);
  EXPECT_EQ(got.parameter_names, want.parameter_names);
  EXPECT_EQ(got.parameter_values, want.parameter_values);
  EXPECT_EQ(got.value_names, want.value_names);
  EXPECT_EQ(got.event_names, want.event_names);
  EXPECT_EQ(got.period_s, want.period_s);
  EXPECT_EQ(got.engine, want.engine);
  EXPECT_EQ(got.title, want.title);
  EXPECT_TRUE(got.paper);
  EXPECT_FALSE(got.simulated_device);
  EXPECT_TRUE(got.models_changed);
  EXPECT_EQ(got.passport, "0123");
  EXPECT_FALSE(got.uncertified);
  EXPECT_FALSE(got.simulated_clock);
  EXPECT_EQ(got.axis_names, want.axis_names);
  EXPECT_EQ(got.axis_units, want.axis_units);
  EXPECT_EQ(got.effort_limits, want.effort_limits);
  EXPECT_EQ(got.lever_arms_m, want.lever_arms_m);
  EXPECT_EQ(got.encoder_step, want.encoder_step);
  EXPECT_EQ(got.profile, want.profile);
  EXPECT_EQ(got.game_slots, want.game_slots);
  EXPECT_EQ(got.armed_position, want.armed_position);
  EXPECT_EQ(got.joint_names, want.joint_names);
  EXPECT_EQ(got.body_names, want.body_names);
  EXPECT_EQ(got.capsule_names, want.capsule_names);
  EXPECT_EQ(got.files, want.files);  // one file holds zeros and 0xFF, one is empty
  EXPECT_EQ(r->size(), 0U);
}

TEST(Recording, SceneWithoutBodiesOrJoints_IsReadBack) {
  const Folder folder;
  RecordingMeta meta = synthetic::meta();
  for (auto* names : {&meta.body_names, &meta.body_joint_names, &meta.body_joint_units}) {
    names->clear();
  }
  meta.joint_names.clear();
  meta.axis_names = {"x"};
  meta.armed_position = {0.0};
  meta.axis_units = {"m"};
  meta.effort_limits = {20};
  meta.lever_arms_m = {0};
  meta.encoder_step = {0};
  meta.parameter_names.clear();
  meta.parameter_values.clear();
  meta.value_names.clear();
  TickRecord want;
  want.q_m = AxisPosition(1, 0.25);
  want.palm_distance_m = std::numeric_limits<double>::infinity();
  auto w = writer(folder.file("a.h5"), meta);
  ASSERT_TRUE(w->append(want));
  w->close();
  TickRecord got;
  const auto r = reader(folder.file("a.h5"));
  ASSERT_TRUE(r->read(0, got));
  EXPECT_TRUE(identical(got, r->digest(), want));
}

/// Runs `body` in a child process. @return its wait status
template <class Body>
int endOfChild(Body body) {
  const pid_t child = ::fork();
  if (child == 0) {
    body();
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return status;
}

TEST(Recording, KillMinusNine_LosesLessThanASecond) {
  test::seesRealTime();
  const Folder folder;
  const std::string path = folder.file("a.h5");
  int pipe_ends[2];
  ASSERT_EQ(::pipe(pipe_ends), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    auto w = RecordingWriter::create(path, synthetic::meta()).value().release();
    std::mt19937_64 random(1);
    for (std::uint64_t i = 0;; ++i) {  // 1 kHz, in bursts of 10
      w->append(synthetic::noisy(i, random));
      if (::write(pipe_ends[1], &i, sizeof i) != sizeof i) ::_exit(1);
      if (i % 10 == 9) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  ::close(pipe_ends[1]);
  std::uint64_t last = 0;
  while (last < 1637 && ::read(pipe_ends[0], &last, sizeof last) == sizeof last) {
  }
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  while (::read(pipe_ends[0], &last, sizeof last) == sizeof last) {  // its progress until the kill
  }
  ::close(pipe_ends[0]);

  auto r = reader(path);
  ASSERT_NE(r, nullptr);
  EXPECT_GE(r->size() + 1000, last + 1);
  EXPECT_GT(r->size(), 600U);
  expectTrueTicks(*r, r->size());
}

TEST(Recording, SlowTicksThenKill_PartialChunkIsKept) {
  const Folder folder;
  const std::string path = folder.file("a.h5");
  endOfChild([&path] {
    auto w = RecordingWriter::create(path, synthetic::meta()).value().release();
    for (const TickRecord& tick : noisyTicks(50)) {  // in 1.5 s or more: no chunk of 1000
      w->append(tick);
      std::this_thread::sleep_for(std::chrono::milliseconds(30));
    }
    ::kill(::getpid(), SIGKILL);
  });
  const std::uint64_t there =
      reader(path)->size();  // the number depends on the load of the machine
  EXPECT_GE(there, 1U);
  EXPECT_LT(there, 1000U);
}

TEST(Recording, DuringWriting_AnotherProcessCanRead) {
  const Folder folder;
  const std::string path = folder.file("a.h5");
  auto w = writer(path);
  for (const TickRecord& tick : noisyTicks(500)) ASSERT_TRUE(w->append(tick));
  w->flush();
  const int status = endOfChild([&path] {
    auto opened = RecordingReader::open(path);
    ::_exit(opened.ok() && opened.value()->size() == 500 ? 0 : 1);
  });
  EXPECT_EQ(status, 0);
}

/// Appends until ticks are refused, then makes space by `relieve` and continues.
struct FullDisk {
  std::uint64_t refused = 0, accepted = 0, after = 0, written = 0, dropped = 0;
};
template <class Relieve>
FullDisk fillDisk(RecordingWriter& w, Relieve relieve) {
  FullDisk result;
  std::mt19937_64 random(1);
  std::uint64_t i = 0;
  for (; i < 40000 && result.refused < 300; ++i) {
    ++(w.append(synthetic::noisy(i, random)) ? result.accepted : result.refused);
  }
  relieve();
  std::this_thread::sleep_for(std::chrono::milliseconds(150));  // the writer retries after 100 ms
  for (const std::uint64_t end = i + 600; i < end; ++i) {
    result.after += w.append(synthetic::noisy(i, random)) ? 1 : 0;
  }
  w.close();
  result.written = w.written();
  result.dropped = w.dropped();
  return result;
}

/// Checks that the file holds as many ticks as the writer reports, all correct and in rising order.
void expectSound(const std::string& path, const FullDisk& disk) {
  EXPECT_GE(disk.refused, 300U);
  EXPECT_EQ(disk.after, 600U);
  EXPECT_EQ(disk.written, disk.accepted + disk.after);
  EXPECT_EQ(disk.dropped, disk.refused);
  const auto r = reader(path);
  ASSERT_NE(r, nullptr);
  expectTrueTicks(*r, disk.written);
}

/// Limits the size of files that this process writes, until it is lifted.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    ::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit tight{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &tight);
  }
  ~FileSizeLimit() { lift(); }
  void lift() const { ::setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  rlimit before_{};
};

TEST(Recording, FileSizeLimit_DropsAndCountsTicksSilently) {
  const Folder folder;
  const std::string path = folder.file("a.h5");
  testing::internal::CaptureStderr();
  auto w = writer(path);
  const FileSizeLimit limit(rlim_t{4} << 20U);
  const FullDisk disk = fillDisk(*w, [&limit] { limit.lift(); });
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  expectSound(path, disk);
}

TEST(Recording, FullFileSystem_DropsAndCountsTicksSilently) {
  const Folder folder;
  const char* const options = "size=6m";
  if (::mount("tmpfs", folder.path().c_str(), "tmpfs", 0, options) != 0) {
    GTEST_SKIP() << "only root may mount a small file system";
  }
  const std::string path = folder.file("a.h5");
  const std::string filler = folder.file("filler");
  std::ofstream(filler) << std::string(std::size_t{3} << 20U, 'x');
  testing::internal::CaptureStderr();
  auto w = writer(path);
  const FullDisk disk = fillDisk(*w, [&filler] { ::unlink(filler.c_str()); });
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  expectSound(path, disk);
  EXPECT_EQ(::umount2(folder.path().c_str(), MNT_DETACH), 0);
}

TEST(RecordingWriter, MissingFolder_IsReportedAndLeavesNothing) {
  const Folder folder;
  const auto created = RecordingWriter::create(folder.file("none/a.h5"), synthetic::meta());
  EXPECT_TRUE(test::refusedWith(created, "none/a.h5"));
  EXPECT_TRUE(test::refusedWith(created, "No such file or directory"));
  EXPECT_FALSE(std::filesystem::exists(folder.file("none")));
}

TEST(RecordingWriter, NoSpaceForTheDescription_KeepsTheOldFile) {
  const Folder folder;
  const std::string path = folder.file("a.h5");
  writer(path)->close();
  const std::string before_it = test::bytesOfFile(path);
  const FileSizeLimit limit(4096);
  const auto created = RecordingWriter::create(path, synthetic::meta());
  limit.lift();
  EXPECT_TRUE(test::refusedWith(created, "disk is full"));
  EXPECT_EQ(test::bytesOfFile(path), before_it);
  EXPECT_FALSE(std::filesystem::exists(path + ".part"));
}

TEST(RecordingReader, ForeignFiles_AreRefusedWithTheReason) {
  const Folder folder;
  expectRefused(folder.file("none.h5"), "No such file");
  expectRefused(folder.path(), "no regular file");
  test::writeBytes(folder.file("empty.h5"), "");
  expectRefused(folder.file("empty.h5"), "is empty");
  test::writeBytes(folder.file("text.h5"), "time,x,y\n0,1,2\n");
  expectRefused(folder.file("text.h5"), "is no HDF5 file");
}

/// A copy of the file without its end.
std::string cutAt(double share, const std::string& whole) {
  const auto bytes = static_cast<double>(std::filesystem::file_size(whole));
  std::filesystem::copy_file(whole, whole + ".cut",
                             std::filesystem::copy_options::overwrite_existing);
  std::filesystem::resize_file(whole + ".cut", static_cast<std::uintmax_t>(share * bytes));
  return whole + ".cut";
}

TEST(RecordingReader, FileTruncatedAnywhere_IsRefused) {
  const Folder folder;
  const std::string whole = folder.file("whole.h5"), killed = folder.file("killed.h5");
  synthetic::writeRecording(whole, noisyTicks(700));
  endOfChild([&killed] {
    auto w = RecordingWriter::create(killed, synthetic::meta()).value().release();
    for (const TickRecord& tick : noisyTicks(1000)) w->append(tick);
    ::kill(::getpid(), SIGKILL);
  });
  EXPECT_EQ(reader(killed)->size(), 1000U);
  for (const double share : {0.0001, 0.01, 0.3, 0.6, 0.9, 0.999}) {
    expectRefused(cutAt(share, whole), "truncated");
  }
  for (const double share : {0.05, 0.4, 0.8}) expectRefused(cutAt(share, killed), "truncated");
  std::filesystem::resize_file(whole, 6);
  expectRefused(whole, "is no HDF5 file");
}

/// Python's output for lines of h5py; f is the file.
std::string withH5py(const std::string& path, const std::string& lines, const char* mode = "r+") {
  return python("import h5py, numpy\nf = h5py.File('" + path + "', '" + mode + "')\n" + lines);
}

TEST(RecordingReader, OtherHdf5AndOtherSchemas_AreRefused) {
  const Folder folder;
  const std::string other = folder.file("other.h5"), path = folder.file("a.h5");
  writer(path)->close();
  ASSERT_EQ(withH5py(other, "f['x'] = 1", "w"), "");
  expectRefused(other, "no Wholehand recording");
  ASSERT_EQ(withH5py(path, "f['meta'].attrs['schema_version'] = 12"), "");
  expectRefused(path, "schema_version = 12: was written by a newer Wholehand");
  ASSERT_EQ(withH5py(path, "f['meta'].attrs['schema_version'] = 8"), "");
  expectRefused(
      path,
      "this program reads schema versions 9 to 11; record anew, or read it with a program "
      "of its time: 7c1e90a");
}

TEST(RecordingReader, TextsWrittenByH5py_AreRead) {
  const Folder folder;
  const std::string path = folder.file("edited.h5");
  writer(path)->close();
  ASSERT_EQ(withH5py(path,
                     "f['meta'].attrs['title'] = 'Edited'\n"  // of variable length
                     "f['meta'].attrs['event_names'] = ['one', 'two']\n"
                     "f['meta'].attrs['level'] = 2\n"
                     "del f['meta/files/0']; f['meta/files/0'] = 'kind = 1'\n"
                     "f['meta/files/0'].attrs['name'] = 'config/a.toml'"),
            "");
  const auto r = reader(path);
  ASSERT_NE(r, nullptr);
  EXPECT_EQ(r->meta().title, "Edited");
  EXPECT_EQ(r->meta().level, 2);
  EXPECT_EQ(r->meta().event_names, (std::vector<std::string>{"one", "two"}));
  EXPECT_EQ(r->meta().files.front().first, "config/a.toml");
  EXPECT_EQ(r->meta().files.front().second, "kind = 1");
}

// HDF5 1.10 keeps texts of variable length in heaps ("GCOL") without a checksum.
TEST(RecordingReader, DamagedTextsOfVariableLength_AreRefusedOrRead) {
  const Folder folder;
  const std::string path = folder.file("edited.h5"), damaged = folder.file("damaged.h5");
  writer(path)->close();
  ASSERT_EQ(withH5py(path, "f['meta'].attrs['title'] = 'Edited'"), "");
  std::ifstream in(path, std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(in), {}};
  const std::size_t heap = whole.find("GCOL");
  ASSERT_NE(heap, std::string::npos);
  std::mt19937_64 random(test::seed());
  for (int i = 0; i < test::cases(100); ++i) {
    std::string bytes = whole;
    for (int k = 0; k < 4; ++k) bytes[heap + random() % 64] = static_cast<char>(random());
    std::ofstream(damaged, std::ios::binary) << bytes;
    const auto opened = RecordingReader::open(damaged);  // the process continues
    if (!opened) EXPECT_TRUE(test::contains(format(opened.errors()), "damaged"));
  }
}

TEST(RecordingReader, AttributeOfAnotherTypeOrUnlimitedTicks_AreRefusedByName) {
  const Folder folder;
  const std::string path = folder.file("edited.h5"), endless = folder.file("endless.h5");
  writer(path)->close();
  writer(endless)->close();
  ASSERT_EQ(withH5py(path, "f['meta'].attrs['title'] = 3"), "");
  expectRefused(path, "'title' of /meta cannot be read");
  ASSERT_EQ(withH5py(endless, "[t.resize(2**50, axis=0) for t in f['ticks'].values()]"), "");
  expectRefused(endless, "claims more ticks");
}

/// The h5py example of docs/recording.md, read from that file.
std::string documentedPython() {
  std::ifstream in(WHOLEHAND_SOURCE_DIR "/docs/recording.md");
  std::string line, lines;
  bool inside = false;
  while (std::getline(in, line)) {
    if (inside && line == "```") return lines;
    if (inside) lines += line + "\n";
    inside = inside || line == "```python";
  }
  return lines;
}

TEST(Recording, DocumentedPythonLines_ReadWhatWasWritten) {
  const Folder folder;
  const std::vector<TickRecord> ticks = noisyTicks(400);
  synthetic::writeRecording(folder.file("run.h5"), ticks);
  double sum = 0.0;
  for (const TickRecord& tick : ticks) sum += tick.sent[3];
  const std::string lines = documentedPython();
  ASSERT_TRUE(test::contains(lines, "h5py.File("));
  const std::string out = python(
      "import os, sys\nsys.path.insert(0, '" WHOLEHAND_SOURCE_DIR "/clients/python')\nos.chdir('" +
      folder.path() + "')\n" + lines +
      "\nprint('%.4f' % sent[:, 3].sum(dtype=float), len(time_s), names[3], units[3])\n"
      "print(f['meta'].attrs['title'].decode(), f['meta/files/0'][()].decode().split()[0])");
  std::array<char, 64> expected{};
  std::snprintf(expected.data(), expected.size(), "%.4f 400 finger_flexion N·m\n", sum);
  EXPECT_EQ(out, std::string(expected.data()) + "Reach and grasp kind\n");
}

}  // namespace
}  // namespace wholehand
