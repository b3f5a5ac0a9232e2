#include "telemetry/recording.hpp"

#include "support/python.hpp"
#include "telemetry/synthetic_recording.hpp"

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

std::string refusal(const std::string& path) {
  const auto opened = RecordingReader::open(path);
  return opened.ok() ? "opened" : format(opened.errors());
}

void writeTicks(RecordingWriter& w, std::uint64_t count, std::uint64_t seed = 1) {
  std::mt19937_64 random(seed);
  for (std::uint64_t i = 0; i < count; ++i) ASSERT_TRUE(w.append(synthetic::noisy(i, random)));
}

TEST(Recording, EveryField_ComesBackBitForBit) {
  const Folder folder;
  const std::string path = folder.file("a.h5");
  constexpr std::uint64_t kTicks = 1103;  // no multiple of a chunk
  auto w = writer(path);
  writeTicks(*w, kTicks);
  w->close();
  EXPECT_EQ(w->written(), kTicks);
  EXPECT_EQ(w->dropped(), 0U);

  auto r = reader(path);
  ASSERT_EQ(r->size(), kTicks);
  std::mt19937_64 random(1);
  TickRecord got;
  for (std::uint64_t i = 0; i < kTicks; ++i) {
    const TickRecord want = synthetic::noisy(i, random);
    ASSERT_TRUE(r->read(i, got));
    ASSERT_TRUE(identical(want, got)) << "tick " << i;
  }
  EXPECT_FALSE(r->read(kTicks, got));
  ASSERT_TRUE(r->read(3, got)) << "backwards";
  EXPECT_EQ(got.tick, 3U);
}

TEST(Recording, Meta_ComesBackWithFilesByteForByte) {
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
  EXPECT_EQ(got.value_steps, want.value_steps);
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
  EXPECT_EQ(got.armed_position, want.armed_position);
  EXPECT_EQ(got.joint_names, want.joint_names);
  EXPECT_EQ(got.body_names, want.body_names);
  EXPECT_EQ(got.capsule_names, want.capsule_names);
  EXPECT_EQ(got.files, want.files);  // one holds zeros and 0xFF, one is empty
  EXPECT_EQ(r->size(), 0U);
}

TEST(Recording, SceneWithoutBodiesOrJoints_RoundTrips) {
  const Folder folder;
  RecordingMeta meta = synthetic::meta();
  meta.body_names.clear();
  meta.joint_names.clear();
  meta.law = {};
  meta.axis_names = {"x"};
  meta.armed_position = {0.0};
  meta.axis_units = {"m"};
  meta.effort_limits = {20};
  meta.lever_arms_m = {0};
  meta.parameter_names.clear();
  meta.parameter_values.clear();
  meta.value_names.clear();
  meta.value_steps.clear();
  TickRecord want;
  want.q_m = AxisPosition(1, 0.25);
  want.palm_distance_m = std::numeric_limits<double>::infinity();
  auto w = writer(folder.file("a.h5"), meta);
  ASSERT_TRUE(w->append(want));
  w->close();
  TickRecord got;
  ASSERT_TRUE(reader(folder.file("a.h5"))->read(0, got));
  EXPECT_TRUE(identical(want, got));
}

/// Runs `body` in a child process and returns how it ended.
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
  while (::read(pipe_ends[0], &last, sizeof last) == sizeof last) {  // what it did until the kill
  }
  ::close(pipe_ends[0]);

  auto r = reader(path);
  ASSERT_NE(r, nullptr);
  EXPECT_GE(r->size() + 1000, last + 1);
  EXPECT_GT(r->size(), 600U);
  std::mt19937_64 random(1);
  TickRecord got;
  for (std::uint64_t i = 0; i < r->size(); ++i) {
    ASSERT_TRUE(r->read(i, got));
    ASSERT_TRUE(identical(synthetic::noisy(i, random), got)) << "tick " << i;
  }
}

TEST(Recording, SlowTicksThenKill_PartialChunkIsThere) {
  const Folder folder;
  const std::string path = folder.file("a.h5");
  endOfChild([&path] {
    auto w = RecordingWriter::create(path, synthetic::meta()).value().release();
    std::mt19937_64 random(1);
    for (std::uint64_t i = 0; i < 30; ++i) {  // 30 ticks in 0.6 s or more: no chunk of 250
      w->append(synthetic::noisy(i, random));
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    ::kill(::getpid(), SIGKILL);
  });
  const std::uint64_t there = reader(path)->size();  // how many, a busy machine decides
  EXPECT_GE(there, 1U);
  EXPECT_LT(there, 250U);
}

TEST(Recording, WhileItIsWritten_AnotherProcessReads) {
  const Folder folder;
  const std::string path = folder.file("a.h5");
  auto w = writer(path);
  writeTicks(*w, 500);
  w->flush();
  const int status = endOfChild([&path] {
    auto opened = RecordingReader::open(path);
    ::_exit(opened.ok() && opened.value()->size() == 500 ? 0 : 1);
  });
  EXPECT_EQ(status, 0);
}

/// Appends until ticks are refused, then makes room by `relieve`, and goes on.
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
  std::this_thread::sleep_for(std::chrono::milliseconds(150));  // it tries again after 100 ms
  for (const std::uint64_t end = i + 600; i < end; ++i) {
    result.after += w.append(synthetic::noisy(i, random)) ? 1 : 0;
  }
  w.close();
  result.written = w.written();
  result.dropped = w.dropped();
  return result;
}

/// The file holds what the writer says, and nothing but true ticks in rising order.
void expectSound(const std::string& path, const FullDisk& disk) {
  EXPECT_GE(disk.refused, 300U);
  EXPECT_EQ(disk.after, 600U);
  EXPECT_EQ(disk.written, disk.accepted + disk.after);
  EXPECT_EQ(disk.dropped, disk.refused);
  auto r = reader(path);
  ASSERT_NE(r, nullptr);
  ASSERT_EQ(r->size(), disk.written);
  std::mt19937_64 random(1);
  TickRecord got, want;
  for (std::uint64_t i = 0, tick = 0; i < r->size(); ++i) {
    ASSERT_TRUE(r->read(i, got));
    do want = synthetic::noisy(tick, random);
    while (tick++ < got.tick);
    ASSERT_TRUE(identical(want, got)) << "row " << i;
  }
}

TEST(Recording, FileSizeLimit_DropsCountsAndGoesOnSilently) {
  const Folder folder;
  const std::string path = folder.file("a.h5");
  ::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  rlimit tight = before;
  tight.rlim_cur = std::uint64_t{4} << 20U;
  testing::internal::CaptureStderr();
  auto w = writer(path);
  ::setrlimit(RLIMIT_FSIZE, &tight);
  const FullDisk disk = fillDisk(*w, [&before] { ::setrlimit(RLIMIT_FSIZE, &before); });
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  expectSound(path, disk);
}

TEST(Recording, FullFileSystem_DropsCountsAndGoesOnSilently) {
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

TEST(RecordingWriter, FolderMissing_SaysSoAndLeavesNothing) {
  const Folder folder;
  const auto created = RecordingWriter::create(folder.file("none/a.h5"), synthetic::meta());
  ASSERT_FALSE(created.ok());
  EXPECT_NE(format(created.errors()).find("none/a.h5"), std::string::npos);
  EXPECT_NE(format(created.errors()).find("No such file or directory"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder.file("none")));
}

TEST(RecordingWriter, NoRoomForTheDescription_KeepsTheOldFile) {
  const Folder folder;
  const std::string path = folder.file("a.h5");
  writer(path)->close();
  std::ifstream old(path);
  const std::string before_it(std::istreambuf_iterator<char>(old), {});
  RecordingMeta meta = synthetic::meta();
  ::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  rlimit tight = before;
  tight.rlim_cur = 4096;
  ::setrlimit(RLIMIT_FSIZE, &tight);
  const auto created = RecordingWriter::create(path, meta);
  ::setrlimit(RLIMIT_FSIZE, &before);
  ASSERT_FALSE(created.ok());
  EXPECT_NE(format(created.errors()).find("disk is full"), std::string::npos);
  std::ifstream in(path);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), before_it);
  EXPECT_FALSE(std::filesystem::exists(path + ".part"));
}

TEST(RecordingReader, ForeignFiles_AreRefusedWithTheReason) {
  const Folder folder;
  EXPECT_NE(refusal(folder.file("none.h5")).find("No such file"), std::string::npos);
  EXPECT_NE(refusal(folder.path()).find("no regular file"), std::string::npos);
  std::ofstream(folder.file("empty.h5"));
  EXPECT_NE(refusal(folder.file("empty.h5")).find("is empty"), std::string::npos);
  std::ofstream(folder.file("text.h5")) << "time,x,y\n0,1,2\n";
  EXPECT_NE(refusal(folder.file("text.h5")).find("is no HDF5 file"), std::string::npos);
}

TEST(RecordingReader, TruncatedAtAnyPlace_IsRefused) {
  const Folder folder;
  const std::string whole = folder.file("whole.h5"), cut = folder.file("cut.h5");
  auto w = writer(whole);
  writeTicks(*w, 700);
  w->close();
  const auto bytes = std::filesystem::file_size(whole);
  for (const double share : {0.0001, 0.01, 0.3, 0.6, 0.9, 0.999}) {
    std::filesystem::copy_file(whole, cut, std::filesystem::copy_options::overwrite_existing);
    std::filesystem::resize_file(cut,
                                 static_cast<std::uintmax_t>(share * static_cast<double>(bytes)));
    EXPECT_NE(refusal(cut).find("truncated"), std::string::npos) << share << ": " << refusal(cut);
  }
  std::filesystem::resize_file(cut, 6);
  EXPECT_NE(refusal(cut).find("is no HDF5 file"), std::string::npos) << refusal(cut);
}

TEST(RecordingReader, KilledAndTruncated_IsRefused) {
  const Folder folder;
  const std::string path = folder.file("a.h5"), cut = folder.file("cut.h5");
  endOfChild([&path] {
    auto w = RecordingWriter::create(path, synthetic::meta()).value().release();
    std::mt19937_64 random(1);
    for (std::uint64_t i = 0; i < 1000; ++i) w->append(synthetic::noisy(i, random));
    ::kill(::getpid(), SIGKILL);
  });
  EXPECT_EQ(reader(path)->size(), 1000U);
  const auto bytes = std::filesystem::file_size(path);
  for (const double share : {0.05, 0.4, 0.8}) {
    std::filesystem::copy_file(path, cut, std::filesystem::copy_options::overwrite_existing);
    std::filesystem::resize_file(cut,
                                 static_cast<std::uintmax_t>(share * static_cast<double>(bytes)));
    EXPECT_NE(refusal(cut).find("truncated"), std::string::npos) << share << ": " << refusal(cut);
  }
}

TEST(RecordingReader, OtherHdf5AndNewerSchema_AreRefused) {
  const Folder folder;
  const std::string other = folder.file("other.h5"), newer = folder.file("newer.h5");
  writer(newer)->close();
  ASSERT_EQ(python("import h5py\nh5py.File('" + other +
                   "', 'w')['x'] = 1\n"
                   "h5py.File('" +
                   newer + "', 'r+')['meta'].attrs['schema_version'] = 9"),
            "");
  EXPECT_NE(refusal(other).find("no Wholehand recording"), std::string::npos) << refusal(other);
  EXPECT_NE(refusal(newer).find("schema_version = 9: was written by a newer Wholehand"),
            std::string::npos)
      << refusal(newer);
}

// What a program of before schema 3 wrote: the same file without what schema 3 brought.
TEST(RecordingReader, Schema2_IsReadWithoutSafetyStateAndFaultAxis) {
  const Folder folder;
  const std::string path = folder.file("old.h5");
  RecordingMeta plain = synthetic::meta();
  plain.schema = kPackedSchema - 1;
  auto w = writer(path, plain);
  writeTicks(*w, 300);
  w->close();
  ASSERT_EQ(python("import h5py\n"
                   "f = h5py.File('" +
                   path +
                   "', 'r+')\n"
                   "f['meta'].attrs['schema_version'] = 2\n"
                   "del f['meta'].attrs['simulated_device']\n"
                   "del f['ticks/safety_state'], f['ticks/fault_axis']"),
            "");
  auto r = reader(path);
  ASSERT_NE(r, nullptr);
  EXPECT_EQ(r->meta().schema, 2U);
  EXPECT_TRUE(r->meta().simulated_device);
  ASSERT_EQ(r->size(), 300U);
  std::mt19937_64 random(1);
  TickRecord got;
  for (std::uint64_t i = 0; i < 300; ++i) {
    TickRecord want = synthetic::noisy(i, random);
    want.safety_state = SafetyState::kDisarmed;
    want.fault_axis = -1;
    ASSERT_TRUE(r->read(i, got));
    ASSERT_TRUE(identical(want, got)) << "tick " << i;
  }
}

TEST(RecordingReader, Schema1_IsRefusedWithWhatIsRead) {
  const Folder folder;
  const std::string path = folder.file("old.h5");
  writer(path)->close();
  ASSERT_EQ(python("import h5py\n"
                   "h5py.File('" +
                   path + "', 'r+')['meta'].attrs['schema_version'] = 1"),
            "");
  EXPECT_NE(refusal(path).find("this program reads schema versions 2 to 8; record anew"),
            std::string::npos)
      << refusal(path);
}

TEST(RecordingReader, TextsOfVariableLengthAndEndlessTicks_AreRefused) {
  const Folder folder;
  const std::string edited = folder.file("edited.h5"), endless = folder.file("endless.h5");
  writer(edited)->close();
  writer(endless)->close();
  ASSERT_EQ(python("import h5py, numpy\n"
                   "f = h5py.File('" +
                   edited +
                   "', 'r+')\n"
                   "f['meta'].attrs['title'] = 'Edited'\n"  // h5py writes it with variable length
                   "f = h5py.File('" +
                   endless +
                   "', 'r+')\n"
                   "[t.resize(2**50, axis=0) for t in f['ticks'].values()]"),
            "");
  EXPECT_NE(refusal(edited).find("texts of variable length"), std::string::npos) << refusal(edited);
  EXPECT_NE(refusal(endless).find("claims more ticks"), std::string::npos) << refusal(endless);
  ASSERT_EQ(python("import h5py, numpy\nh5py.File('" + edited +
                   "', 'r+')['meta'].attrs['title'] = numpy.bytes_('Edited')"),
            "");
  EXPECT_EQ(reader(edited)->meta().title, "Edited");  // as docs/recording.md advises
}

/// The lines that docs/recording.md gives to users of h5py, taken from that file.
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
  auto w = writer(folder.file("run.h5"));
  std::mt19937_64 random(1);
  double sum = 0.0;
  for (std::uint64_t i = 0; i < 400; ++i) {
    const TickRecord r = synthetic::noisy(i, random);
    sum += r.sent[3];
    ASSERT_TRUE(w->append(r));
  }
  w->close();
  const std::string lines = documentedPython();
  ASSERT_NE(lines.find("wholehand.open("), std::string::npos);
  const std::string out = python(
      "import os, sys\nsys.path.insert(0, '" WHOLEHAND_SOURCE_DIR "/clients/python')\nos.chdir('" +
      folder.path() + "')\n" + lines +
      "\nprint('%.9f' % sent[:, 3].sum(), len(time_s), names[3], units[3])\n"
      "print(f['meta'].attrs['title'].decode(), f['meta/files/0'][()].decode().split()[0])");
  std::array<char, 64> expected{};
  std::snprintf(expected.data(), expected.size(), "%.9f 400 finger_flexion N·m\n", sum);
  EXPECT_EQ(out, std::string(expected.data()) + "Reach and grasp kind\n");
}

}  // namespace
}  // namespace wholehand
