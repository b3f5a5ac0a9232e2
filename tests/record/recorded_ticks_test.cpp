// The ticks of a long recording with gaps, and of a damaged one. Every expected value is the
// written one.
#include "record/recording.hpp"
#include "record/synthetic_recording.hpp"
#include "support/python.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <random>
#include <signal.h>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace wholehand {
namespace {

using synthetic::Folder;
using synthetic::identical;
using test::python;

/// 68 chunks of 250 ticks and a part of one.
constexpr std::uint64_t kTicks = 68 * 250 + 200;

/// Ticks with gaps: a third of a second in a row and every 50th tick do not exist; 100 more were
/// lost.
std::vector<TickRecord> ticksWithGaps(std::uint64_t count) {
  const std::vector<TickRecord> noisy = synthetic::noisyTicks(990);
  std::vector<TickRecord> ticks;
  std::uint64_t number = 5;
  for (std::uint64_t i = 0; i < count; ++i, ++number) {
    if (i == 7000) number += 333;
    const bool skips = i >= 12'000 && i < 14'000 && i % 50 == 0;
    if (skips) ++number;
    ticks.push_back(noisy[i % noisy.size()]);
    ticks.back().tick = number;
    ticks.back().time_s = static_cast<double>(number) * 1e-3;
    ticks.back().elapsed_periods = skips ? 2 : i == 7000 ? 234 : 1;
  }
  return ticks;
}

/// A description with 250 Hz, so that a chunk has 250 ticks.
RecordingMeta quarterRate() {
  RecordingMeta meta = synthetic::meta();
  meta.period_s = 4e-3;
  return meta;
}

struct RecordedTicks : testing::Test {
  static void SetUpTestSuite() {
    folder = std::make_unique<Folder>();
    ticks = ticksWithGaps(kTicks);
    synthetic::writeRecording(folder->file("a.h5"), ticks, quarterRate());
  }
  static void TearDownTestSuite() {
    ticks.clear();
    folder.reset();
  }
  /// A copy of the recording after `edit`, some lines of h5py: f is the file, corrupt(dataset,
  /// chunk) overwrites the middle of a chunk.
  static std::string edited(const std::string& name, const std::string& edit) {
    const std::string path = folder->file(name);
    std::filesystem::copy_file(folder->file("a.h5"), path);
    const std::string script = R"(
import h5py
def corrupt(dataset, chunk):
  where = f[dataset].id.get_chunk_info(chunk)
  places.append((where.byte_offset, where.size))
places = []
with h5py.File(path, 'r+') as f:
  EDIT
with open(path, 'r+b') as raw:
  for offset, size in places:
    raw.seek(offset + size // 3)
    raw.write(b'corrupt' * (size // 21)))";
    const std::size_t at = script.find("EDIT");
    EXPECT_EQ(python("path = '" + path + "'" + std::string(script).replace(at, 4, edit)), "");
    return path;
  }
  static std::unique_ptr<RecordingReader> opened(const std::string& path) {
    auto reader = RecordingReader::open(path);
    EXPECT_TRUE(reader.ok()) << (reader.ok() ? "" : format(reader.errors()));
    return reader.ok() ? std::move(reader).value() : nullptr;
  }
  static void expectOutline(const RecordingReader& reader) {
    ASSERT_EQ(reader.size(), kTicks);
    ASSERT_EQ(reader.outline().numbers.size(), kTicks);
    for (std::uint64_t i = 0; i < kTicks; ++i) {
      ASSERT_EQ(reader.outline().numbers[i], ticks[i].tick) << "row " << i;
    }
    EXPECT_EQ(reader.outline().missing,
              100U);  // 334 after the last one, of which 234 did not exist
  }
  /// Reads random ticks, those at the edges of chunks, and chunk 5, and checks that only written
  /// ticks are returned. @return how many could not be read
  static int readAtRandom(RecordingReader& reader) {
    auto random = test::seededRandom(35);
    std::vector<std::uint64_t> rows = {0, 249, 250, 15'999, 16'000, kTicks - 1};
    for (int i = 0; i < test::cases(150); ++i) rows.push_back(random() % kTicks);
    for (std::uint64_t row = 1200; row < 1550; ++row) rows.push_back(row);
    int refused = 0;
    TickRecord got;
    for (const std::uint64_t row : rows) {
      if (!reader.read(row, got)) {
        ++refused;
      } else {
        EXPECT_TRUE(identical(got, reader.digest(), ticks[row])) << "row " << row;
      }
    }
    return refused;
  }
  static void expectWhole(const std::string& path) {
    const auto reader = opened(path);
    ASSERT_NE(reader, nullptr);
    expectOutline(*reader);
    EXPECT_EQ(readAtRandom(*reader), 0);
  }

  static std::unique_ptr<Folder> folder;
  static std::vector<TickRecord> ticks;
};
std::unique_ptr<Folder> RecordedTicks::folder;
std::vector<TickRecord> RecordedTicks::ticks;

TEST_F(RecordedTicks, RandomTicks_AreThoseWritten) {
  expectWhole(folder->file("a.h5"));
}

// Chunk 5 is rows 1250 to 1499.
TEST_F(RecordedTicks, DamagedChunkOfACount_LosesOnlyItsTicks) {
  const auto reader = opened(edited("counts.h5", "corrupt('ticks/contact_count', 5)"));
  ASSERT_NE(reader, nullptr);
  expectOutline(*reader);
  TickRecord got;
  EXPECT_TRUE(reader->read(1249, got));
  EXPECT_FALSE(reader->read(1250, got));
  EXPECT_FALSE(reader->read(1499, got));
  EXPECT_TRUE(reader->read(1500, got));
}

TEST_F(RecordedTicks, DamagedChunkOfTickNumbers_LosesOnlyItsTicks) {
  const auto reader = opened(edited("numbers.h5", "corrupt('ticks/tick', 5)"));
  ASSERT_NE(reader, nullptr);
  ASSERT_EQ(reader->size(), kTicks - 250);
  EXPECT_EQ(reader->outline().missing, 100U + 250U);
  EXPECT_EQ(reader->outline().flaw, "/ticks has 250 rows of 'tick' that cannot be read");
  EXPECT_EQ(reader->outline().numbers[1249], ticks[1249].tick);
  EXPECT_EQ(reader->outline().numbers[1250], ticks[1500].tick);
  TickRecord got;
  ASSERT_TRUE(reader->read(1250, got));
  EXPECT_TRUE(identical(got, reader->digest(), ticks[1500]));
}

// 256 rows of /contacts belong to ticks of at most two chunks: only these are lost.
TEST_F(RecordedTicks, DamagedOwnersOfContacts_LoseOnlyTheirChunks) {
  const auto reader = opened(edited("owners.h5", "corrupt('contacts/row', 1)"));
  ASSERT_NE(reader, nullptr);
  ASSERT_TRUE(reader->outline().contradicted_tick.has_value());
  EXPECT_NE(reader->outline().contradiction.find("in /contacts, its contact_count says"),
            std::string::npos);
  TickRecord got;
  std::uint64_t at = 0, read = 0;
  for (std::uint64_t i = 0; i < reader->size(); ++i) {
    if (!reader->read(i, got)) continue;
    while (ticks[at].tick < got.tick) ++at;
    EXPECT_TRUE(identical(got, reader->digest(), ticks[at])) << "tick " << got.tick;
    ++read;
  }
  EXPECT_LT(read, kTicks);
  EXPECT_GE(read, kTicks - 2 * 250);
}

/// Starts a process that writes the first ticks and waits for its end with the file open.
pid_t startWriting(const std::string& path, const std::vector<TickRecord>& ticks) {
  std::array<int, 2> ends{};
  EXPECT_EQ(::pipe(ends.data()), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    ::alarm(300);  // in case nobody ends it
    auto* const writer = RecordingWriter::create(path, quarterRate()).value().release();
    for (const TickRecord& record : ticks) writer->append(record);
    writer->flush();
    (void)!::write(ends[1], "!", 1);
    for (;;) ::pause();
  }
  char written = 0;
  EXPECT_EQ(::read(ends[0], &written, 1), 1);
  ::close(ends[0]);
  ::close(ends[1]);
  return child;
}

TEST_F(RecordedTicks, FileBeingWrittenThenKilled_IsReadAsFarAsItWasWritten_slow) {
  const std::string path = folder->file("growing.h5");
  const pid_t child = startWriting(path, ticks);
  {
    const auto viewed = viewRecording(path);
    ASSERT_TRUE(viewed.ok()) << format(viewed.errors());
    EXPECT_TRUE(viewed->reader->outline().being_written);
    expectOutline(*viewed->reader);
    EXPECT_EQ(readAtRandom(*viewed->reader), 0);
  }
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  expectWhole(path);
}

TEST_F(RecordedTicks, UnorderedTicks_AreRead_slow) {
  const std::string path = folder->file("falling.h5");
  std::swap(ticks[600], ticks[610]);
  synthetic::writeRecording(path, ticks, quarterRate());
  const auto reader = RecordingReader::open(path).value();
  ASSERT_EQ(reader->size(), ticks.size());
  TickRecord got;
  for (const std::uint64_t row : {599, 600, 605, 610, 611, 16'999}) {
    ASSERT_TRUE(reader->read(row, got)) << "row " << row;
    EXPECT_TRUE(identical(got, reader->digest(), ticks[row])) << "row " << row;
  }
  std::swap(ticks[600], ticks[610]);
}

}  // namespace
}  // namespace wholehand
