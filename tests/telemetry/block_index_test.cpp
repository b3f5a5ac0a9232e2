// A recording's index repeats what its ticks say. Without the index, the reader takes the ticks'
// own columns: every expected value here is what was written, or what that other way reads.
#include "support/python.hpp"
#include "support/says.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"
#include "telemetry/recording.hpp"
#include "telemetry/recording_view.hpp"
#include "telemetry/synthetic_recording.hpp"

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

/// 64 chunks of 250 ticks are described at once; behind them stand ticks that no index describes.
constexpr std::uint64_t kBlockTicks = 64 * 250 + 1200;

/// A third of a second in a row, and every 50th tick, do not exist; 100 more were lost.
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

struct BlockIndexTest : testing::Test {
  static void SetUpTestSuite() {
    folder = std::make_unique<Folder>();
    ticks = ticksWithGaps(kBlockTicks);
    synthetic::writeRecording(folder->file("a.h5"), ticks);
  }
  static void TearDownTestSuite() {
    ticks.clear();
    folder.reset();
  }
  /// A copy of the recording after `edit`, a few lines of h5py: f is the file, index its dataset,
  /// spoil(dataset, chunk) overwrites the middle of a chunk.
  static std::string edited(const std::string& name, const std::string& edit) {
    const std::string path = folder->file(name);
    std::filesystem::copy_file(folder->file("a.h5"), path);
    const std::string script = R"(
import h5py
def spoil(dataset, chunk):
  where = f[dataset].id.get_chunk_info(chunk)
  places.append((where.byte_offset, where.size))
places = []
with h5py.File(path, 'r+') as f:
  index = f['index/blocks']
  EDIT
with open(path, 'r+b') as raw:
  for offset, size in places:
    raw.seek(offset + size // 3)
    raw.write(b'spoiled' * (size // 21)))";
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
    ASSERT_EQ(reader.size(), kBlockTicks);
    ASSERT_EQ(reader.outline().numbers.size(), kBlockTicks);
    for (std::uint64_t i = 0; i < kBlockTicks; ++i) {
      ASSERT_EQ(reader.outline().numbers[i], ticks[i].tick) << "row " << i;
    }
    EXPECT_EQ(reader.outline().missing, 100U);  // 334 on from the last, of which 234 did not exist
  }
  /// Reads ticks at random, those at the edges of blocks and block 5: how many could not be read.
  /// No other than what was written is given.
  static int readAtRandom(RecordingReader& reader) {
    auto random = test::seededRandom(35);
    std::vector<std::uint64_t> rows = {0, 249, 250, 15'999, 16'000, kBlockTicks - 1};
    for (int i = 0; i < test::cases(150); ++i) rows.push_back(random() % kBlockTicks);
    for (std::uint64_t row = 1200; row < 1550; ++row) rows.push_back(row);
    int refused = 0;
    TickRecord got;
    for (const std::uint64_t row : rows) {
      if (!reader.read(row, got)) {
        ++refused;
      } else {
        EXPECT_TRUE(identical(got, ticks[row])) << "row " << row;
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

  /// Chunk 28 holds the gap behind row 7000; as h5py prints it, and the sums of the counts.
  static std::string describedBlock28() {
    std::uint64_t contacts = 0, events = 0, commands = 0;
    for (std::uint64_t i = 0; i < 29 * 250; ++i) {
      contacts += static_cast<std::uint64_t>(ticks[i].contact_count);
      events += static_cast<std::uint64_t>(ticks[i].exercise.event_count);
      commands += static_cast<std::uint64_t>(ticks[i].command_count);
    }
    const std::string counts = std::to_string(contacts) + " " + std::to_string(events) + " " +
                               std::to_string(commands) + "\n";
    return std::to_string(7000 + 5 + 333) + " " + std::to_string(7249 + 5 + 333) + " 100 " +
           counts + counts;
  }

  static std::unique_ptr<Folder> folder;
  static std::vector<TickRecord> ticks;
};
std::unique_ptr<Folder> BlockIndexTest::folder;
std::vector<TickRecord> BlockIndexTest::ticks;

/// What somebody may have made of the index; the ticks are read all the same.
constexpr const char* kEdits[] = {"del f['index']",  // as files from before it are
                                  "index.resize(37, axis=0)",
                                  "spoil('index/blocks', 0)",
                                  "index[9, 0] = 3",
                                  "index[9, 1] = 2**64 - 1",
                                  "index[60, 3] = 2**40",
                                  "index[60, 4] = 0",
                                  "index[40, 2] = 9",
                                  "index.resize(100000, axis=0)",
                                  "del f['index/blocks']; f['index/blocks'] = [1, 2, 3]"};

TEST_F(BlockIndexTest, RandomTicks_AreThoseWrittenWithItWithoutItAndWithWhatCannotBe) {
  expectWhole(folder->file("a.h5"));
  for (std::size_t i = 0; i < std::size(kEdits); ++i) {
    if (test::kFew && i != test::seed() % std::size(kEdits)) continue;
    SCOPED_TRACE(kEdits[i]);
    expectWhole(edited("edited" + std::to_string(i) + ".h5", kEdits[i]));
  }
}

TEST_F(BlockIndexTest, WrittenFile_DescribesEachWholeChunkOfTicks) {
  EXPECT_EQ(python("path = '" + folder->file("a.h5") + R"('
import h5py
f = h5py.File(path, 'r')
print(len(f['index/blocks']), *f['index/blocks'].attrs['labels'])
rows, block = 29 * 250, f['index/blocks'][28]
owners = f['contacts/row'][:block[3]]  # between chunks there are rows of none
assert owners[-1] < rows and f['contacts/row'][block[3]] >= rows
print(*block[:3], sum(owners < rows), *block[4:])
print(*[sum(f['ticks/' + n][:rows]) for n in ('contact_count', 'event_count', 'command_count')]))"),
            "64 b'first_tick' b'last_tick' b'missing' b'contacts' b'events' b'commands'\n" +
                describedBlock28());
}

// Block 5 is rows 1250 to 1499. What it says can be true; the ticks say something else.
TEST_F(BlockIndexTest, NumbersThatAreWrong_GiveNoWrongTick) {
  const char* const edits[] = {"index[5, 3] -= 100", "index[5, 4] -= 20", "index[5, 5] += 9"};
  for (const char* edit : edits) {
    if (test::kFew && edit != edits[test::seed() % std::size(edits)]) continue;
    const auto reader = opened(edited(std::string("wrong") + edit[9] + ".h5", edit));
    ASSERT_NE(reader, nullptr);
    const int refused = readAtRandom(*reader);
    EXPECT_GT(refused, 0) << edit;
    EXPECT_LT(refused, 300) << edit;
  }
}

// The index spares the reader the columns of the whole file: where a chunk of one of them is
// damaged, only its ticks are lost. Without it, nothing of the file could be read.
TEST_F(BlockIndexTest, DamagedCountOfContacts_CostsItsQuarterOfASecond) {
  const auto reader = opened(edited("counts.h5", "spoil('ticks/contact_count', 5)"));
  ASSERT_NE(reader, nullptr);
  expectOutline(*reader);
  TickRecord got;
  EXPECT_TRUE(reader->read(1249, got));
  EXPECT_FALSE(reader->read(1250, got));
  EXPECT_FALSE(reader->read(1499, got));
  EXPECT_TRUE(reader->read(1500, got));
  const auto plain = RecordingReader::open(
      edited("counts_only.h5", "spoil('ticks/contact_count', 5); del f['index']"));
  EXPECT_TRUE(test::refusedWith(plain, "its ticks cannot be read"));
}

/// A process that writes the first ticks and waits for its end with the file open.
pid_t startWriting(const std::string& path, const std::vector<TickRecord>& ticks) {
  std::array<int, 2> ends{};
  EXPECT_EQ(::pipe(ends.data()), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    ::alarm(300);  // where nobody ends it
    auto* const writer = RecordingWriter::create(path, synthetic::meta()).value().release();
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

TEST_F(BlockIndexTest, RecordingThatIsWrittenAndThenKilled_IsReadAsFarAsItIsThere_slow) {
  const std::string path = folder->file("growing.h5");
  const pid_t child = startWriting(path, ticks);
  {
    const auto viewed = viewRecording(path, 16);
    ASSERT_TRUE(viewed.ok()) << format(viewed.errors());
    EXPECT_TRUE(viewed->reader->outline().being_written);
    expectOutline(*viewed->reader);
    EXPECT_EQ(readAtRandom(*viewed->reader), 0);
  }
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  expectWhole(path);
}

TEST_F(BlockIndexTest, TicksThatDoNotRise_AreReadWithoutIt_slow) {
  const std::string path = folder->file("falling.h5");
  std::swap(ticks[600], ticks[610]);
  synthetic::writeRecording(path, ticks);
  const auto reader = RecordingReader::open(path).value();
  ASSERT_EQ(reader->size(), ticks.size());
  TickRecord got;
  for (const std::uint64_t row : {599, 600, 605, 610, 611, 16'999}) {
    ASSERT_TRUE(reader->read(row, got)) << "row " << row;
    EXPECT_TRUE(identical(got, ticks[row])) << "row " << row;
  }
  std::swap(ticks[600], ticks[610]);
}

}  // namespace
}  // namespace wholehand
