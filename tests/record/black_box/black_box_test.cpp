#include "record/black_box.hpp"

#include "record/black_box/box_tools.hpp"
#include "record/black_box_layout.hpp"
#include "support/contains.hpp"
#include "support/cpu_time.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <limits>
#include <set>
#include <sys/resource.h>
#include <sys/stat.h>
#include <thread>

namespace wholehand::test {
namespace {

using synthetic::Folder;

std::mt19937_64 randomOf(std::uint64_t tick) {
  return std::mt19937_64(tick * 7919 + 1);
}
TickRecord tickNumber(std::uint64_t tick) {
  auto random = randomOf(tick);
  return tickAt(tick, random);
}

TEST(BlackBox, LongRun_KeepsTheLastFiveSecondsAndAllInputs) {
  const Folder folder;
  const std::string path = folder.file("deep/down/a.wbb");
  constexpr std::uint64_t kTicks =
      13'000;  // of one millisecond: two and a half rounds of the memory
  auto box = armed(planFor(path));
  for (std::uint64_t i = 0; i < kTicks; ++i) giveTick(*box, tickNumber(i));
  ASSERT_TRUE(box->write().ok());
  EXPECT_FALSE(std::filesystem::exists(path + ".part"));

  const auto read = opened(path);
  ASSERT_NE(read, nullptr);
  EXPECT_GE(read->size(), 5000U);
  TickRecord got;
  for (std::uint64_t i = 0; i < read->size(); ++i) {
    ASSERT_TRUE(read->read(i, got));
    ASSERT_EQ(got.tick, kTicks - read->size() + i);
    ASSERT_EQ(bytesOf(got), bytesOf(tickNumber(got.tick)));
  }
  EXPECT_FALSE(read->read(read->size(), got));
  EXPECT_TRUE(read->inputsWhole());
  ASSERT_EQ(read->inputTicks(), kTicks);
  TickInput input;
  for (std::uint64_t i = 0; i < kTicks; ++i) {
    ASSERT_TRUE(read->nextInput(input));
    const TickRecord want = tickNumber(i);
    ASSERT_TRUE(std::equal(want.q_m.begin(), want.q_m.end(), input.q_m.begin())) << i;
    ASSERT_EQ(input.command_count, want.command_count);
  }
  EXPECT_FALSE(read->nextInput(input));
}

TEST(BlackBox, Description_ComesBackWithIdenticalFiles) {
  const Folder folder;
  auto box = armed(planFor(folder.file("a.wbb")));
  giveTick(*box, tickNumber(0));
  ASSERT_TRUE(box->write().ok());
  const RecordingMeta want = synthetic::meta();
  const RecordingMeta got = opened(folder.file("a.wbb"))->meta();
  EXPECT_EQ(got.files, want.files);  // one file holds zeros and 0xFF, one is empty
  EXPECT_EQ(got.armed_position, want.armed_position);
  EXPECT_EQ(got.parameter_values, want.parameter_values);
  EXPECT_EQ(got.seed, want.seed);
  EXPECT_EQ(got.engine, want.engine);
  EXPECT_EQ(got.level, want.level);
  EXPECT_EQ(got.git_version, want.git_version);
  EXPECT_EQ(got.body_names, want.body_names);
}

// Six axes are described; the reader of a tick relies on it.
TEST(BlackBox, TicksThatDoNotFitTheDescription_AreRefused) {
  const Folder folder;
  const auto corrupt = [](int which, TickRecord& r) {
    if (which == 0) r.sent = AxisEffort(9, 1.0);
    if (which == 1) r.q_m = AxisPosition(5, 1.0);
    if (which == 2) r.theta = JointPosition(kMaxJoints, 0.0);
    if (which == 3) r.body_count = 9;
    if (which == 4) r.parameter_count = kMaxLiveParameters;
    if (which == 5) r.time_s = std::numeric_limits<double>::quiet_NaN();
    if (which == 6) r.contacts_dropped = std::numeric_limits<std::int32_t>::max();
  };
  for (int which = 0; which < 7; ++which) {
    const std::string path = folder.file(std::to_string(which) + ".wbb");
    auto box = armed(planFor(path));
    for (std::uint64_t i = 0; i < 5; ++i) {
      TickRecord record = tickNumber(i);
      if (i == 3) corrupt(which, record);
      giveTick(*box, record);
    }
    ASSERT_TRUE(box->write().ok());
    EXPECT_NE(refusalOf(path).find("its ticks are not those of its description"), std::string::npos)
        << which << ": " << refusalOf(path);
  }
}

TEST(BlackBox, StoppingFault_IsTheCauseWithItsAxisAndTick) {
  const Folder folder;
  auto box = armed(planFor(folder.file("a.wbb")));
  for (std::uint64_t i = 0; i < 30; ++i) {
    TickRecord record = tickNumber(i);
    record.faults = Fault::kLateTick;  // not a cause
    if (i == 20) {
      record.faults = Fault::kSpeedLimit;
      record.fault_axis = 4;
    }
    if (i == 25) record.faults = Fault::kDeviceRead;
    EXPECT_EQ(box->wanted(), i > 20);
    giveTick(*box, record);
  }
  ASSERT_TRUE(box->write().ok());
  const BlackBoxCause cause = opened(folder.file("a.wbb"))->cause();
  EXPECT_EQ(cause.faults, Fault::kSpeedLimit | Fault::kDeviceRead);
  EXPECT_EQ(cause.fault_tick, 20U);
  EXPECT_EQ(cause.fault_axis, 4);
  EXPECT_EQ(cause.signal, 0);
  EXPECT_FALSE(cause.within_tick);
  EXPECT_NEAR(static_cast<double>(cause.unix_ns) * 1e-9, static_cast<double>(std::time(nullptr)),
              60.0);
}

auto filled(const BlackBoxPlan& plan, std::uint64_t ticks) {
  auto box = armed(plan);
  for (std::uint64_t i = 0; i < ticks; ++i) giveTick(*box, tickNumber(i));
  return box;
}

TEST(BlackBox, FullInputMemory_KeepsTicksAndReportsIncompleteInputs) {
  const Folder folder;
  BlackBoxPlan plan = planFor(folder.file("a.wbb"));
  plan.input_bytes = 20'000;
  const auto box = filled(plan, 3000);
  EXPECT_FALSE(box->inputsWhole());
  ASSERT_TRUE(box->write().ok());
  const auto read = opened(plan.path);
  ASSERT_NE(read, nullptr);
  EXPECT_FALSE(read->inputsWhole());
  EXPECT_GT(read->inputTicks(), 100U);
  EXPECT_LT(read->inputTicks(), 3000U);
  EXPECT_EQ(read->size(), 3000U);
}

// Expected: no page fault of the box, however long the session, while another thread provides. What
// was not mapped ahead would take one a page, 512 in the last 2 MB; the machine itself may cause a
// few. A sanitizer's own memory causes more, and is not judged.
TEST(BlackBox, InputsBeyondTheFirstMemory_CauseNoPageFault) {
  const Folder folder;
  BlackBoxPlan plan = planFor(folder.file("a.wbb"));
  plan.most_ticks = 10'000'000;
  const auto box = armed(plan);
  std::vector<TickRecord> records;
  for (std::uint64_t i = 0; i < 20; ++i) records.push_back(tickNumber(i));
  giveTick(*box, records[0]);
  constexpr std::uint64_t kEnough_bytes = std::uint64_t{6} << 20U;
  rusage before{}, after{};
  std::int64_t faults = 0;
  for (std::uint64_t i = 1; i < 400'000 && box->inputBytes() < kEnough_bytes; ++i) {
    TickRecord& record = records[i % records.size()];
    record.tick = i;
    box->provideMemory();
    ::getrusage(RUSAGE_THREAD, &before);
    giveTick(*box, record);
    ::getrusage(RUSAGE_THREAD, &after);
    faults += after.ru_minflt - before.ru_minflt;
  }
  if (!test::kSanitized) EXPECT_LE(faults, 16);
  EXPECT_GE(box->inputBytes(), kEnough_bytes);
  EXPECT_TRUE(box->inputsWhole());
}

TEST(BlackBox, TickMemoryTooSmall_KeepsTheLastTicks) {
  const Folder folder;
  BlackBoxPlan plan = planFor(folder.file("a.wbb"));
  plan.most_tick_bytes = 500'000;
  const auto box = filled(plan, 4000);
  ASSERT_TRUE(box->write().ok());
  const auto read = opened(plan.path);
  ASSERT_NE(read, nullptr);
  ASSERT_GT(read->size(), 50U);
  EXPECT_LT(read->size(), 1000U);
  TickRecord got;
  for (std::uint64_t i = 0; i < read->size(); ++i) {
    ASSERT_TRUE(read->read(i, got));
    ASSERT_EQ(got.tick, 4000 - read->size() + i);
    ASSERT_EQ(bytesOf(got), bytesOf(tickNumber(got.tick)));
  }
}

// As in a crash of another thread: the loop keeps ticking while the black box file is written.
TEST(BlackBox, TicksDuringTheWrite_AreCompleteOrLeftOut) {
  const Folder folder;
  BlackBoxPlan plan = planFor(folder.file("a.wbb"));
  plan.keep_s = 0.05;  // the memory is overwritten many times a second
  plan.most_ticks = 1'000'000;
  std::vector<TickRecord> ticks;
  for (std::uint64_t i = 0; i < 64; ++i) ticks.push_back(tickNumber(i));
  std::vector<std::string> want;
  for (const TickRecord& tick : ticks) want.push_back(bytesOf(tick));
  auto box = armed(plan);
  std::atomic<bool> done{false};
  std::atomic<std::uint64_t> given{0};
  std::thread loop([&] {
    for (std::uint64_t i = 0; !done; ++i) {
      giveTick(*box, ticks[i % ticks.size()]);
      given = i + 1;
      if (i % 16 == 0) std::this_thread::yield();
    }
  });
  while (given < 200) std::this_thread::yield();
  std::uint64_t whole = 0;
  const int rounds = kReducedCounts ? 8 : 40;
  for (int round = 0; round < rounds; ++round) {
    ASSERT_TRUE(box->write().ok());
    const auto read = opened(plan.path);
    ASSERT_NE(read, nullptr);
    TickRecord got;
    for (std::uint64_t i = 0; i < read->size(); ++i, ++whole) {
      ASSERT_TRUE(read->read(i, got));
      ASSERT_EQ(bytesOf(got), want[got.tick]) << "tick " << got.tick;
    }
  }
  done = true;
  loop.join();
  std::printf("%d boxes written beside %llu ticks: %llu whole ones in them\n", rounds,
              static_cast<unsigned long long>(given.load()),
              static_cast<unsigned long long>(whole));
}

TEST(BlackBox, FifthAtTheSameTime_IsRefused) {
  const Folder folder;
  std::vector<std::unique_ptr<BlackBox>> boxes;
  BlackBoxPlan plan = planFor(folder.file("a.wbb"));
  plan.most_ticks = 100;
  for (int i = 0; i < 4; ++i) boxes.push_back(armed(plan));
  const auto fifth = BlackBox::arm(synthetic::meta(), plan);
  EXPECT_TRUE(refusedWith(fifth, "4 of them are"));
  boxes.pop_back();
  EXPECT_TRUE(BlackBox::arm(synthetic::meta(), plan).ok());
}

TEST(BlackBox, NoSpaceOrNoFolder_IsReportedAndLeavesNothing) {
  const Folder folder;
  overwrite(folder.file("file"), "in the way");
  auto box = armed(planFor(folder.file("file/a.wbb")));
  giveTick(*box, tickNumber(0));
  const auto written = box->write();
  EXPECT_TRUE(refusedWith(written, "Not a directory"));
  auto full = armed(planFor(folder.file("b.wbb")));
  for (std::uint64_t i = 0; i < 100; ++i) giveTick(*full, tickNumber(i));
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit little{4096, before.rlim_max};  // as on a full disk
  auto* const then = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &little), 0);
  const auto refused = full->write();
  ::setrlimit(RLIMIT_FSIZE, &before);
  (void)std::signal(SIGXFSZ, then);
  EXPECT_TRUE(refusedWith(refused, "too large"));
  std::set<std::string> left;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    left.insert(entry.path().filename().string());
  }
  EXPECT_EQ(left, std::set<std::string>{"file"});
}

// In a shared folder another user may have placed a link where the file is first written.
TEST(BlackBox, SymbolicLinkAtItsPath_IsNotFollowed) {
  const Folder folder;
  overwrite(folder.file("precious"), "mine");
  for (const char* name : {"a.wbb", "a.wbb.part"}) {
    std::filesystem::create_symlink(folder.file("precious"), folder.file(name));
  }
  auto box = armed(planFor(folder.file("a.wbb")));
  giveTick(*box, tickNumber(0));
  ASSERT_TRUE(box->write().ok());
  EXPECT_EQ(contents(folder.file("precious")), "mine");
  EXPECT_FALSE(std::filesystem::is_symlink(folder.file("a.wbb")));
  EXPECT_NE(opened(folder.file("a.wbb")), nullptr);
}

/// Bytes of a small black box file.
std::string smallBox(const Folder& folder) {
  auto box = armed(planFor(folder.file("whole.wbb")));
  for (std::uint64_t i = 0; i < 20; ++i) giveTick(*box, tickNumber(i));
  EXPECT_TRUE(box->write().ok());
  return contents(folder.file("whole.wbb"));
}

TEST(BlackBoxReader, FileTruncatedAnywhere_IsRefused) {
  const Folder folder;
  const std::string whole = smallBox(folder), path = folder.file("cut.wbb");
  ASSERT_EQ(refusalOf(folder.file("whole.wbb")), "opened");
  auto random = seededRandom(4105);
  std::vector<std::size_t> sizes = {8, 9, 100, whole.size() - 1, whole.size() - 5};
  for (int i = 0; i < 200; ++i) sizes.push_back(8 + random() % (whole.size() - 8));
  for (const std::size_t size : sizes) {
    overwrite(path, whole.substr(0, size));
    ASSERT_NE(refusalOf(path).find("cut off"), std::string::npos) << size << refusalOf(path);
  }
  overwrite(path, whole + "x");
  EXPECT_NE(refusalOf(path).find("damaged"), std::string::npos);
}

// One changed byte anywhere: CRC-32 detects every burst of up to 32 bits.
TEST(BlackBoxReader, OneCorruptedByte_IsAlwaysDetected) {
  const Folder folder;
  const std::string whole = smallBox(folder), path = folder.file("corrupted.wbb");
  auto random = seededRandom(4106);
  for (int i = 0; i < 400; ++i) {
    std::string corrupted = whole;
    const std::size_t at = i < 200 ? static_cast<std::size_t>(i) : random() % whole.size();
    corrupted[at] = static_cast<char>(corrupted[at] ^ static_cast<char>(1 + random() % 255));
    overwrite(path, corrupted);
    ASSERT_NE(refusalOf(path), "opened") << "byte " << at;
  }
}

TEST(BlackBoxReader, FileOfAnotherVersion_IsRefusedWithThatVersion) {
  const Folder folder;
  const std::string whole = smallBox(folder), path = folder.file("other.wbb");
  for (const std::size_t at : {8UL, 12UL}) {  // its format and the size of its header
    std::string other = whole;
    other[at] = static_cast<char>(other[at] + 1);
    overwrite(path, other);
    EXPECT_NE(refusalOf(path).find("another version of Wholehand: 7c1e90a"), std::string::npos)
        << refusalOf(path);
    EXPECT_NE(refusalOf(path).find("with the program that wrote it"), std::string::npos);
  }
}

TEST(BlackBoxReader, ForeignFiles_AreRefused) {
  const Folder folder;
  overwrite(folder.file("text.wbb"), "time,x\n0,1\n");
  overwrite(folder.file("empty.wbb"), "");
  ASSERT_EQ(::mkfifo(folder.file("pipe.wbb").c_str(), 0600), 0);  // nobody writes into it
  for (const char* name : {"text.wbb", "empty.wbb", "missing.wbb", "pipe.wbb"}) {
    EXPECT_NE(refusalOf(folder.file(name)).find("is no black box"), std::string::npos);
  }
  EXPECT_NE(refusalOf(folder.path()).find("is no black box"), std::string::npos);
}

// A black box file reads like a recording: replay, report and picture accept it.
TEST(RecordingReader, BlackBox_IsReadAsARecording) {
  const Folder folder;
  smallBox(folder);
  const auto read = RecordingReader::open(folder.file("whole.wbb"));
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(read.value()->size(), 20U);
  EXPECT_EQ(read.value()->meta().title, synthetic::meta().title);
}

// 20 contacts, 10 bodies: a hand around a glass in the bar. Prints a figure; the bound is far above
// it.
TEST(BlackBox, TickInTheBar_CostsFarLessThanATick_slow) {
  const Folder folder;
  RecordingMeta meta = synthetic::meta();
  meta.body_names.assign(10, "body");
  BlackBoxPlan plan = planFor(folder.file("a.wbb"));
  meta.encoder_step[3] = 1e-4;  // as for every axis of a robot
  auto armed_box = BlackBox::arm(meta, plan);
  ASSERT_TRUE(armed_box.ok());
  BlackBox& box = **armed_box;
  TickRecord record = tickNumber(1);
  record.body_count = 10;
  record.contact_count = 20;
  record.command_count = 0;
  giveTick(box, record);
  constexpr int kTicks = 20'000;
  const std::uint64_t bytes_before = box.inputBytes();
  const double began_ns = 1e9 * cpu_s();
  for (int i = 0; i < kTicks; ++i) {
    for (int a = 0; a < 6; ++a) record.q_m[a] = meta.encoder_step[a] * (i / 2);
    giveTick(box, record);
  }
  const double per_tick_ns = (1e9 * cpu_s() - began_ns) / kTicks;
  std::printf("black box: %.0f ns a tick, %zu bytes of it kept whole, %.1f bytes of inputs\n",
              per_tick_ns, bytesOf(record).size(),
              static_cast<double>(box.inputBytes() - bytes_before) / kTicks);
  EXPECT_LT(per_tick_ns, 50'000.0);  // of CPU time, so that sanitizers also pass
}

// The loop starts a tick in the slot of the oldest one while the file is being described. If that
// slot were the first of the file, the start of its data would be read from the new tick and nearly
// all would be lost.
TEST(BlackBox, SlotsThatTheLoopWritesNext_AreNotPartOfAFullRingsFile) {
  constexpr std::uint64_t kSlots = 108, kBegunMeanwhile = 2;
  for (std::uint64_t end = 0; end < 3 * kSlots; ++end) {
    const std::uint64_t first = firstKept(end, kSlots);
    EXPECT_EQ(end - first, std::min<std::uint64_t>(end, 100));
    for (std::uint64_t kept = first; kept < end; ++kept) {
      for (std::uint64_t next = end; next < end + kBegunMeanwhile; ++next) {
        ASSERT_NE(kept % kSlots, next % kSlots) << end;
      }
    }
  }
}

TEST(BlackBox, WrittenWhileTheLoopFillsTheRing_KeepsAllTicksNotOverwritten) {
  const Folder folder;
  BlackBoxPlan plan = planFor(folder.file("a.wbb"));
  plan.most_ticks = std::uint64_t{1} << 40U;
  plan.input_bytes = 1 << 16;
  plan.keep_s = 1.0;
  constexpr std::uint64_t kKept = 1100;  // a tenth more than required
  const auto box = armed(plan);
  std::atomic<std::uint64_t> ticks{0};
  std::atomic<bool> stop{false};
  std::thread loop([&] {
    std::mt19937_64 random(1);
    for (TickRecord record = tickAt(0, random); !stop; ++record.tick, ++ticks) {
      giveTick(*box, record);
      if (record.tick % 4 == 3) std::this_thread::yield();
    }
  });
  while (ticks < 2 * kKept) std::this_thread::yield();
  int judged = 0;
  for (int i = 0; i < cases(20); ++i) {
    const std::uint64_t before = ticks;
    ASSERT_TRUE(box->write());
    // Ticks that the ring has overwritten meanwhile are rightly lost; a tick takes its largest size
    // before it is packed.
    const std::uint64_t during = ticks - before + 20;
    const auto read = opened(plan.path);
    ASSERT_NE(read, nullptr);
    if (during > kKept / 2) continue;  // this thread was suspended
    ++judged;
    EXPECT_GE(read->size() + during, kKept) << i;
  }
  stop = true;
  loop.join();
  std::printf("figure: %d boxes judged\n", judged);
}

}  // namespace
}  // namespace wholehand::test
