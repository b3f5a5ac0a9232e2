#include "record/recording.hpp"
#include "record/synthetic_recording.hpp"
#include "support/file_bytes.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <signal.h>
#include <string>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

namespace wholehand {
namespace {

using synthetic::Folder;
using test::bytesOfFile;
using test::seed;
using test::writeBytes;

/// Changes one byte (half of the trials) or up to eight places of up to 64 bytes.
void corrupt(std::string& bytes, std::mt19937_64& random) {
  const bool one = random() % 2 == 0;
  for (std::uint64_t n = one ? 1 : 1 + random() % 8; n > 0; --n) {
    const std::size_t at = random() % bytes.size();
    const std::size_t end = one ? at + 1 : std::min(bytes.size(), at + 1 + random() % 64);
    const bool zero = random() % 4 == 0;
    for (std::size_t i = at; i < end; ++i) bytes[i] = zero ? '\0' : static_cast<char>(random());
  }
}

/// Progress that a process reading damaged files reports to its parent.
struct CopyProgress {
  int trial = 0, refused = 0, read = 0, silent = 0;
};

/// Reads everything that can be read and counts the outcome.
void readAll(const std::string& path, CopyProgress& progress) {
  const auto opened = RecordingReader::open(path);
  if (!opened) {
    ++progress.refused;
    const Diagnostic& why = opened.errors().front();
    if (why.file != path || why.problem.empty() || why.remedy.empty()) ++progress.silent;
    return;
  }
  TickRecord record;
  for (std::uint64_t i = 0; i < opened.value()->size(); ++i) {
    (void)opened.value()->read(i, record);  // false where its chunk is damaged
  }
  ++progress.read;
}

/// Repeatedly corrupts and reads `whole` in a separate process, so that a crash ends only that
/// process and is reported.
void expectReadsOrRefuses(const std::string& whole, const std::string& path, int count) {
  auto* const progress = static_cast<CopyProgress*>(::mmap(
      nullptr, sizeof(CopyProgress), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
  ASSERT_NE(static_cast<void*>(progress), MAP_FAILED);
  const pid_t child = ::fork();
  if (child == 0) {
    for (int i = 0; i < count; ++i) {
      progress->trial = i;
      std::mt19937_64 random(seed() + static_cast<std::uint64_t>(i));
      std::string bytes = whole;
      corrupt(bytes, random);
      writeBytes(path, bytes);
      ::alarm(20);  // also ends a hang; a read takes milliseconds
      readAll(path, *progress);
    }
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  const CopyProgress seen = *progress;
  ::munmap(progress, sizeof(CopyProgress));
  EXPECT_TRUE(WIFEXITED(status)) << "signal " << WTERMSIG(status) << "; again with WHOLEHAND_SEED="
                                 << seed() + static_cast<std::uint64_t>(seen.trial);
  EXPECT_EQ(seen.refused + seen.read, count);
  EXPECT_EQ(seen.silent, 0);  // every refusal names file, problem and remedy
  EXPECT_GE(seen.refused, count / 20);
  std::cout << "seed " << seed() << ": " << seen.refused << " refused, " << seen.read << " read\n";
}

/// A recording that was closed properly.
std::string wholeRecording(const std::string& path, std::uint64_t ticks) {
  synthetic::writeRecording(path, synthetic::noisyTicks(ticks));
  return bytesOfFile(path);
}

TEST(RecordingReader, RandomDamage_IsReadOrRefusedWithoutACrash) {
  const Folder folder;
  const std::string path = folder.file("a.h5"), corrupted = folder.file("corrupted.h5");
  // Most of the first file is meta, most of the second ticks.
  expectReadsOrRefuses(wholeRecording(path, 60), corrupted, test::cases(300));
  expectReadsOrRefuses(wholeRecording(path, 600), corrupted, test::cases(60));
}

TEST(RecordingReader, RandomDamageAfterAKill_IsReadOrRefusedWithoutACrash) {
  const Folder folder;
  const std::string path = folder.file("whole.h5");
  const pid_t child = ::fork();
  if (child == 0) {
    auto writer = RecordingWriter::create(path, synthetic::meta()).value().release();
    for (const TickRecord& tick : synthetic::noisyTicks(60)) writer->append(tick);
    writer->flush();
    ::kill(::getpid(), SIGKILL);
  }
  ::waitpid(child, nullptr, 0);
  ASSERT_EQ(RecordingReader::open(path).value()->size(), 60U);
  expectReadsOrRefuses(bytesOfFile(path), folder.file("corrupted.h5"), test::cases(60));
}

// Damages every byte of texts that the file holds once. The reader of HDF5 would crash on damaged
// texts of variable length (HDF5 1.10, H5HG_read).
TEST(RecordingReader, DamageToEveryTextOfTheDescription_IsRefused) {
  const Folder folder;
  const std::string path = folder.file("whole.h5"), corrupted = folder.file("corrupted.h5");
  const RecordingMeta meta = synthetic::meta();
  RecordingWriter::create(path, meta).value()->close();
  const std::string whole = bytesOfFile(path);
  for (const std::string& text : {meta.title, meta.git_version, meta.created_utc}) {
    const std::size_t at = whole.find(text);
    ASSERT_NE(at, std::string::npos) << text;
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x20);
    writeBytes(corrupted, bytes);
    EXPECT_FALSE(RecordingReader::open(corrupted).ok()) << text;
  }
}

}  // namespace
}  // namespace wholehand
