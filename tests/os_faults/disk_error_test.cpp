// A disk that fails for a while and then works again.
#include "record/recording.hpp"
#include "record/synthetic_recording.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <dlfcn.h>
#include <filesystem>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <sys/stat.h>
#include <sys/types.h>
#include <thread>
#include <vector>

namespace {
// Shared by the tests and the replaced functions below.
std::atomic<bool> disk_fails{false};  // NOLINT
std::atomic<int> writes_before{0};    // NOLINT: writes that still succeed
std::atomic<int> writes_lost{0};      // NOLINT: writes that fail then, before the disk works again
std::atomic<bool> unsynced{false};    // NOLINT: whether bytes were written since the last sync
}  // namespace

// HDF5's calls reach this function, because symbols of the program precede those of the C library.
extern "C" ssize_t pwrite(int fd, const void* bytes, size_t count, off_t at) {
  using Function = ssize_t (*)(int, const void*, size_t, off_t);
  static const auto real = reinterpret_cast<Function>(::dlsym(RTLD_NEXT, "pwrite"));
  unsynced = true;
  const bool fails = disk_fails && writes_before-- <= 0 && writes_lost-- > 0;
  if (!fails) return real(fd, bytes, count, at);
  errno = EIO;
  return -1;
}

extern "C" int fsync(int fd) {
  static const auto kReal = reinterpret_cast<int (*)(int)>(::dlsym(RTLD_NEXT, "fsync"));
  struct stat about {};
  if (::fstat(fd, &about) == 0 && S_ISREG(about.st_mode)) unsynced = false;
  return kReal(fd);
}

// HDF5 1.10 leaks one of its objects if a write fails.
extern "C" const char* __lsan_default_suppressions();  // NOLINT: the sanitizer's name
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libhdf5_serial";
}

namespace wholehand {
namespace {

using namespace std::chrono_literals;
using synthetic::Folder;

/// Reads a recording and its parts: how often each tick occurs.
std::map<std::uint64_t, int> ticksOf(const std::vector<std::string>& paths) {
  std::map<std::uint64_t, int> seen;
  for (const std::string& path : paths) {
    const auto recording = RecordingReader::open(path);
    if (!recording) {
      ADD_FAILURE() << format(recording.errors());
      continue;
    }
    TickRecord record;
    for (std::uint64_t i = 0; i < recording.value()->size(); ++i) {
      EXPECT_TRUE(recording.value()->read(i, record)) << path << " " << i;
      ++seen[record.tick];
    }
  }
  return seen;
}

struct DiskErrorTest : testing::Test {
  ~DiskErrorTest() override { disk_fails = false; }
  static void failAfter(int writes, int lost) {
    writes_before = writes;
    writes_lost = lost;
    disk_fails = true;
  }
  void append(std::uint64_t count) {
    for (std::uint64_t i = 0; i < count; ++i) writer->append(synthetic::noisy(appended++, random));
  }
  const Folder folder;
  const std::string path = folder.file("run.h5");
  std::unique_ptr<RecordingWriter> writer =
      RecordingWriter::create(path, synthetic::meta()).value();
  std::mt19937_64 random{1};
  std::uint64_t appended = 0;
};

TEST_F(DiskErrorTest, ErrorThatPasses_BeginsANewPartAndLosesNothingBeforeOrAfter) {
  append(1000);
  failAfter(0, 1 << 30);
  append(1600);  // a chunk of 1000 stays in memory, the other ticks are lost
  const std::uint64_t dropped = writer->dropped();
  EXPECT_GT(dropped, 0U);
  disk_fails = false;
  std::this_thread::sleep_for(150ms);  // the writer retries after 100 ms
  append(2000);
  writer->close();
  EXPECT_EQ(writer->dropped(), dropped) << "nothing is lost once the disk answers";
  EXPECT_EQ(writer->written() + writer->dropped(), appended);
  ASSERT_EQ(recordingParts(path), std::vector<std::string>{folder.file("run.part2.h5")});
  const auto seen = ticksOf({path, folder.file("run.part2.h5")});
  EXPECT_GE(seen.size(), writer->written());
  for (std::uint64_t tick = 0; tick < 1000; ++tick) ASSERT_TRUE(seen.contains(tick)) << tick;
  for (std::uint64_t tick = 2600; tick < appended; ++tick) ASSERT_TRUE(seen.contains(tick)) << tick;
}

// Ticks that are reported as recorded must survive a power cut.
TEST_F(DiskErrorTest, ClosedRecording_IsSyncedToTheDisk) {
  append(600);
  EXPECT_TRUE(unsynced);
  writer->close();
  EXPECT_FALSE(unsynced);
}

// Rows that extended a table but never reached the disk must not count as rows of tick 0.
TEST(DiskErrors, ErrorAtAnyWriteOfAFlush_KeepsEveryEarlierTick) {
  int refused = 0;
  for (int before = 0; before < 60; ++before) {
    const Folder folder;
    const std::string path = folder.file("run.h5");
    auto writer = RecordingWriter::create(path, synthetic::meta()).value();
    std::mt19937_64 noise(1);
    std::uint64_t appended = 0;
    const auto append = [&](std::uint64_t to) {
      while (appended < to) writer->append(synthetic::noisy(appended++, noise));
      writer->flush();
    };
    append(100);
    ASSERT_EQ(writer->written(), 100U);
    DiskErrorTest::failAfter(before, 1 << 30);
    append(200);
    refused += writer->written() == 100 ? 1 : 0;
    disk_fails = false;
    writer->close();  // tries to write once more
    EXPECT_EQ(writer->written(), 200U);
    std::vector<std::string> files = recordingParts(path);
    files.insert(files.begin(), path);
    EXPECT_EQ(ticksOf(files).size(), 200U) << before << " writes before the disk failed";
  }
  EXPECT_GT(refused, 20) << "else the test is about nothing";
}

TEST(DiskErrors, ErrorsOfAnyNumberOfWrites_KeepWrittenTicksAndCountTheOthers) {
  auto random = test::seededRandom(15);
  std::uint64_t lost = 0, parts = 0;
  const int runs = test::cases(7);  // 210 in a full run
  for (int run = 0; run < runs; ++run) {
    const Folder folder;
    const std::string path = folder.file("run.h5");
    auto writer = RecordingWriter::create(path, synthetic::meta()).value();
    const auto before = static_cast<int>(random() % 300), failing = static_cast<int>(random() % 6);
    DiskErrorTest::failAfter(before, 1 + failing);
    std::mt19937_64 noise(1);
    std::uint64_t appended = 0;
    for (int block = 0; block < 10; ++block) {
      for (int i = 0; i < 250; ++i) writer->append(synthetic::noisy(appended++, noise));
      std::this_thread::sleep_for(60ms);
    }
    disk_fails = false;
    writer->close();
    EXPECT_EQ(writer->written() + writer->dropped(), appended);
    std::vector<std::string> files = recordingParts(path);
    parts += files.size();
    files.insert(files.begin(), path);
    const auto seen = ticksOf(files);
    EXPECT_GE(seen.size(), writer->written())
        << before << " writes, then " << 1 + failing << " lost; " << files.size() << " files";
    lost += writer->dropped();
  }
  std::printf("figure: %d runs, %llu parts, %llu ticks lost\n", runs,
              static_cast<unsigned long long>(parts), static_cast<unsigned long long>(lost));
  EXPECT_GT(parts, 0U);
}

}  // namespace
}  // namespace wholehand
