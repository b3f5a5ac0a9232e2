// Content of a recording after a power cut or a kill: its inputs, up to the last complete block.
#include "record/black_box/box_tools.hpp"
#include "record/input_log.hpp"
#include "support/contains.hpp"
#include "support/file_bytes.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"

#include <bit>
#include <filesystem>

namespace wholehand {
namespace {

using test::Folder;
namespace fs = std::filesystem;

std::vector<TickRecord> ticksOf(std::mt19937_64& random, int count) {
  std::vector<TickRecord> ticks;
  for (int i = 0; i < count; ++i) {
    ticks.push_back(test::tickAt(static_cast<std::uint64_t>(i), random));
  }
  return ticks;
}

bool sameBits(const AxisPosition& a, const AxisPosition& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](double x, double y) {
           return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
         });
}

/// Number of inputs that the journal gives; checks that they are those of the ticks.
std::size_t readsOf(const std::string& path, const std::vector<TickRecord>& ticks) {
  const auto journal = InputJournalReader::open(path);
  if (!journal) return 0;
  TickInput input;
  std::size_t n = 0;
  for (; (*journal)->next(input); ++n) {
    if (n == ticks.size()) {
      ADD_FAILURE() << "more inputs than ticks";
      return n;
    }
    const TickRecord& wrote = ticks[n];
    EXPECT_TRUE(sameBits(input.q_m, wrote.q_m)) << n;
    EXPECT_EQ(input.elapsed_periods, wrote.elapsed_periods);
    EXPECT_EQ(input.faults, wrote.faults & kInputFaults);
    EXPECT_EQ(input.moved_by, wrote.moved_by);
    EXPECT_EQ(input.help, wrote.help);
    EXPECT_EQ(input.command_count, wrote.command_count);
  }
  return n;
}

TEST(InputJournal, RecordingNotClosed_LeavesEveryInput) {
  std::mt19937_64 random(test::seed());
  const auto ticks = ticksOf(random, 1000);
  const Folder folder;
  std::unique_ptr<InputJournal> journal;
  ASSERT_EQ(InputJournal::create(folder.file("a.inputs"), synthetic::meta(), journal), "");
  for (const TickRecord& tick : ticks) journal->append(tick);
  journal->flush();
  journal.reset();
  EXPECT_EQ(readsOf(folder.file("a.inputs"), ticks), ticks.size());
  EXPECT_EQ((*InputJournalReader::open(folder.file("a.inputs")))->meta().files,
            synthetic::meta().files);
  EXPECT_EQ((*InputJournalReader::open(folder.file("a.inputs")))->meta().clinic_visit,
            synthetic::meta().clinic_visit);
}

TEST(InputJournal, TruncatedOrDamagedAnywhere_GivesCorrectInputsUpToThere) {
  std::mt19937_64 random(test::seed());
  const auto ticks = ticksOf(random, 1000);
  const Folder folder;
  const std::string path = folder.file("a.inputs"), cut = folder.file("cut.inputs");
  std::unique_ptr<InputJournal> journal;
  ASSERT_EQ(InputJournal::create(path, synthetic::meta(), journal), "");
  for (const TickRecord& tick : ticks) journal->append(tick);
  journal->flush();
  const std::string whole = test::bytesOfFile(path);
  constexpr std::size_t kLengths = 10;
  std::size_t before = 0;
  for (std::size_t tenth = 0; tenth <= kLengths; ++tenth) {
    test::writeBytes(cut, whole.substr(0, whole.size() * tenth / kLengths));
    const std::size_t read = readsOf(cut, ticks);
    EXPECT_GE(read, before) << "a longer part gives fewer inputs";
    before = read;
  }
  EXPECT_EQ(before, ticks.size());
  for (int i = 0; i < test::cases(200); ++i) {
    std::string bytes = whole.substr(0, random() % (whole.size() + 1));
    if (random() % 2 == 0 && !bytes.empty()) {
      bytes[random() % bytes.size()] = static_cast<char>(random());
    }
    test::writeBytes(cut, bytes);
    readsOf(cut, ticks);
  }
}

// A full queue has dropped 100 ticks. A simulation of the remaining inputs would not be the run.
TEST(InputJournal, MissingTicks_EndTheJournal) {
  std::mt19937_64 random(test::seed());
  const auto ticks = ticksOf(random, 1000);
  const Folder folder;
  const std::string path = folder.file("a.inputs");
  for (const std::size_t first : {500, 0}) {
    std::unique_ptr<InputJournal> journal;
    ASSERT_EQ(InputJournal::create(path, synthetic::meta(), journal), "");
    for (std::size_t i = 0; i < ticks.size(); ++i) {
      if (i < first || i >= first + 100) journal->append(ticks[i]);
    }
    journal->flush();
    journal.reset();
    EXPECT_EQ(readsOf(path, ticks), first);
  }
}

TEST(InputJournal, ClosedRecording_HasNoJournal) {
  const Folder folder;
  const std::string path = folder.file("a.h5"), inputs = InputJournal::pathOf(path);
  auto writer = RecordingWriter::create(path, synthetic::meta()).value();
  EXPECT_TRUE(fs::exists(inputs));
  for (const TickRecord& tick : synthetic::noisyTicks(10)) ASSERT_TRUE(writer->append(tick));
  writer->close();
  EXPECT_FALSE(fs::exists(inputs));
}

TEST(InputJournal, PathOfAnotherFile_IsNotReplaced) {
  const Folder folder;
  const std::string path = folder.file("a.h5"), inputs = InputJournal::pathOf(path);
  test::writeBytes(inputs, "notes");
  EXPECT_TRUE(test::refusedWith(RecordingWriter::create(path, synthetic::meta()), "a.inputs"));
  EXPECT_EQ(test::bytesOfFile(inputs), "notes");
  EXPECT_FALSE(fs::exists(path));
  fs::remove(inputs);
  fs::create_symlink(folder.file("elsewhere"), inputs);
  EXPECT_TRUE(test::refusedWith(RecordingWriter::create(path, synthetic::meta()), "a.inputs"));
  EXPECT_FALSE(fs::exists(folder.file("elsewhere")));
}

}  // namespace
}  // namespace wholehand
