// The program's side of the frame with the reference firmware, on a simulated clock.
#include "frame_bench.hpp"
#include "loop/realtime/allocation_counter.hpp"
#include "support/contains.hpp"
#include "support/seed.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace wholehand::test {
namespace {

class FrameLine : public testing::Test {
 protected:
  void SetUp() override {
    device_ = orThrow(bench_.open());
    ASSERT_TRUE(device_->control(WH_ENABLE, 0.0, bench_.wait()));
  }
  // One tick of a loop: sends a command, waits a millisecond, reads a sample.
  int tick(const std::vector<double>& efforts) {
    (void)device_->write(commandOf(efforts));
    device_->pump(bench_.now_ns());
    bench_.pass();
    device_->pump(bench_.now_ns());
    return device_->read(sample_);
  }

  BenchBoard bench_;
  std::unique_ptr<FrameDevice> device_;
  wh_sample sample_ = emptySample();
};

TEST_F(FrameLine, Opened_KnowsTheAxesAsTheDeviceStatesThem) {
  ASSERT_EQ(device_->axes().size(), 3U);
  const wh_axis& y = device_->axes()[1];
  EXPECT_STREQ(y.name, "y");
  EXPECT_EQ(y.kind, static_cast<std::uint32_t>(WH_TRANSLATION));
  EXPECT_EQ(y.upper, static_cast<double>(0.1F));
  EXPECT_EQ(y.effort_limit, 8.0);
  EXPECT_EQ(y.silence_s, static_cast<double>(0.02F));
  EXPECT_EQ(device_->name(), "bench");
  const FrameCounters counted = device_->counters();
  EXPECT_EQ(counted.broken + counted.crc_errors + counted.foreign + counted.stale, 0U);
}

TEST_F(FrameLine, CommandAndSample_ArriveWithinOneTick) {
  bench_.state.position[2] = 0.015625F;
  bench_.state.effort[0] = 0.5F;
  bench_.state.vendor_code = 17;
  ASSERT_EQ(tick({1.0, -2.0, 8.0}), WH_OK);
  EXPECT_EQ(bench_.given[1], -2.0F);
  EXPECT_EQ(sample_.position[2], 0.015625);
  EXPECT_EQ(sample_.effort[0], 0.5);
  EXPECT_TRUE(std::isnan(sample_.temperature_c[0]));
  EXPECT_EQ(sample_.vendor_code, 17);
  EXPECT_EQ(sample_.valid, 7U);
  EXPECT_EQ(sample_.status, static_cast<std::uint32_t>(WH_ENABLED | WH_HOMED));
  EXPECT_EQ(sample_.monotonic_ns, bench_.now_ns());
  EXPECT_EQ(device_->read(sample_), WH_NOTHING_NEW);
  EXPECT_EQ(sample_.position[2], 0.015625);
}

TEST_F(FrameLine, EachCommand_IsSentOnce) {
  ASSERT_EQ(tick({1.0, 0.0, 0.0}), WH_OK);
  const std::uint32_t heard = bench_.fw.heard;
  for (int i = 0; i < 30; ++i) {
    device_->pump(bench_.now_ns());
    bench_.pass();
  }
  EXPECT_EQ(bench_.fw.heard, heard);
  EXPECT_EQ(bench_.fw.phase, FW_RAMPING)
      << "a loop that stands still is silent, though its bus lives";
}

TEST_F(FrameLine, EnableAgain_SendsNoEarlierCommand) {
  ASSERT_EQ(tick({5.0, 0.0, 0.0}), WH_OK);
  ASSERT_EQ(device_->write(commandOf({7.0, 7.0, 7.0})), WH_OK);  // it is not pumped to the line
  ASSERT_TRUE(device_->control(WH_DISABLE, 0.0, bench_.wait()));
  EXPECT_FALSE(bench_.on);
  ASSERT_TRUE(device_->control(WH_ENABLE, 0.0, bench_.wait()));
  device_->pump(bench_.now_ns());
  bench_.pass();
  EXPECT_EQ(bench_.given[0], 0.0F);
  ASSERT_EQ(tick({1.0, 0.0, 0.0}), WH_OK);
  EXPECT_EQ(bench_.given[0], 1.0F);
}

// The board answers between two of its ticks; a sample from before the answer does not show its
// effect.
TEST_F(FrameLine, Enable_IsReportedInTheFirstSampleRead) {
  ASSERT_TRUE(device_->control(WH_DISABLE, 0.0, bench_.wait()));
  ASSERT_EQ(tick({}), WH_OK);
  ASSERT_EQ(sample_.status, static_cast<std::uint32_t>(WH_HOMED));
  bool ticks = true;
  const auto answersInOneWaitAndTicksInTheNext = [&] {
    bench_.now_us += 500;
    ticks = !ticks;
    if (ticks) {
      firmware_tick(&bench_.fw, bench_.now_us);
    } else {
      bench_.receiveAll();
    }
    return bench_.now_ns();
  };
  ASSERT_TRUE(device_->control(WH_ENABLE, 0.0, answersInOneWaitAndTicksInTheNext));
  EXPECT_EQ(device_->read(sample_), WH_OK);
  EXPECT_EQ(sample_.status, static_cast<std::uint32_t>(WH_ENABLED | WH_HOMED));
}

TEST_F(FrameLine, EnableOfABoardInFault_Waits20msAtMost) {
  ASSERT_TRUE(device_->control(WH_DISABLE, 0.0, bench_.wait()));
  bench_.state.status = WH_HOMED | WH_DRIVE_FAULT;
  const std::int64_t begun_ns = bench_.now_ns();
  ASSERT_TRUE(device_->control(WH_ENABLE, 0.0, bench_.wait()));
  EXPECT_LE(bench_.now_ns() - begun_ns, 25'000'000);
  EXPECT_EQ(device_->read(sample_), WH_OK);
  EXPECT_EQ(sample_.status, static_cast<std::uint32_t>(WH_HOMED | WH_DRIVE_FAULT));
}

TEST_F(FrameLine, Disabled_RefusesWrites) {
  ASSERT_TRUE(device_->control(WH_DISABLE, 0.0, bench_.wait()));
  EXPECT_EQ(device_->write(commandOf({1.0, 1.0, 1.0})), WH_FAILED);
}

TEST_F(FrameLine, CommandOfOtherAxes_IsRefused) {
  EXPECT_EQ(device_->write(commandOf({1.0, 1.0})), WH_FAILED);
}

TEST_F(FrameLine, WatchdogDropped_SilencesTheDevice) {
  ASSERT_EQ(tick({5.0, 0.0, 0.0}), WH_OK);
  ASSERT_TRUE(device_->control(WH_DROP_WATCHDOG, 0.0, bench_.wait()));
  for (int i = 0; i < 120; ++i) (void)tick({5.0, 0.0, 0.0});
  EXPECT_NE(sample_.status & WH_SILENCED, 0U);
  EXPECT_EQ(bench_.given[0], 0.0F);
}

TEST_F(FrameLine, VerbsOfTheBoard_AreForwardedAndAnswered) {
  EXPECT_TRUE(device_->control(WH_IDENTIFY, 0.0, bench_.wait()));
  const auto tared = device_->control(WH_TARE, 0.0, bench_.wait());
  EXPECT_TRUE(refusedWith(tared, "cannot do it"));
  EXPECT_EQ(bench_.verbs, (std::vector<int>{WH_IDENTIFY, WH_TARE}));
}

TEST_F(FrameLine, LostAnswer_IsRequestedAgain) {
  int passes = 0;
  const auto lossy = [&] {
    bench_.pass();
    if (++passes < 50) bench_.wires->from_device.clear();
    return bench_.now_ns();
  };
  EXPECT_TRUE(device_->control(WH_IDENTIFY, 0.0, lossy));
}

// On a line that loses, corrupts, repeats and invents bytes, only intact samples of the device are
// accepted.
TEST_F(FrameLine, Damage_IsCountedAndNoCorruptSampleIsAccepted) {
  auto random = seededRandom(1221);
  device_->pump(bench_.now_ns());  // reads the samples from before the first damage
  (void)device_->read(sample_);
  std::uint64_t sequence = sample_.sequence;
  std::map<std::uint64_t, double> reported;  // position by sample number
  int fresh = 0;
  for (int k = 0; k < 5000; ++k) {
    bench_.state.position[0] = static_cast<float>(k % 7) * 0.01F;
    (void)device_->write(commandOf({1.0, 1.0, 1.0}));
    device_->pump(bench_.now_ns());
    bench_.pass();
    reported[bench_.fw.samples] = static_cast<double>(bench_.state.position[0]);
    Line& line = bench_.wires->from_device;
    const auto how = random() % 6;
    const Line once = line;
    if (how == 0) line[random() % line.size()] ^= static_cast<std::uint8_t>(1 + random() % 255);
    if (how == 1) line.resize(random() % line.size());
    if (how == 2) line.insert(line.end(), once.begin(), once.end());  // doubled: the copy is stale
    if (how == 3) line.push_front(static_cast<std::uint8_t>(random()));
    device_->pump(bench_.now_ns());
    const int result = device_->read(sample_);
    ASSERT_GE(result, 0);
    if (result == WH_OK) {
      ++fresh;
      ASSERT_EQ(sample_.position[0], reported.at(sample_.sequence));
      ASSERT_GT(sample_.sequence, sequence);
    }
    ASSERT_EQ(sample_.valid, 7U);
    sequence = sample_.sequence;
  }
  const FrameCounters counted = device_->counters();
  EXPECT_GT(fresh, 2500);
  EXPECT_GT(counted.broken + counted.crc_errors, 500U);
  EXPECT_GT(counted.stale, 500U);
}

TEST_F(FrameLine, ForeignSession_IsCountedAndIgnored) {
  ASSERT_EQ(tick({0.0, 0.0, 0.0}), WH_OK);
  wf_frame frame{};
  frame.kind = WF_SAMPLE;
  frame.axes = 3;
  frame.session = 99;
  frame.sequence = 1'000'000;
  frame.position[0] = 0.5F;
  std::array<std::uint8_t, WF_MAX_WIRE> wire{};
  const std::size_t count = wf_encode(&frame, wire.data());
  bench_.wires->from_device.insert(bench_.wires->from_device.end(), wire.begin(),
                                   wire.begin() + static_cast<std::ptrdiff_t>(count));
  device_->pump(bench_.now_ns());
  EXPECT_EQ(device_->counters().foreign, 1U);
  EXPECT_EQ(device_->read(sample_), WH_NOTHING_NEW);
}

TEST_F(FrameLine, SequenceWrapAround_ContinuesWithoutAGap) {
  for (const std::uint32_t samples : {UINT32_C(0x70000000), UINT32_C(0xE0000000), UINT32_MAX - 3}) {
    bench_.fw.samples = samples;  // a step that still counts as newer
    ASSERT_EQ(tick({0.0, 0.0, 0.0}), WH_OK);
  }
  std::uint64_t last = sample_.sequence;
  for (int i = 0; i < 10; ++i) {
    ASSERT_EQ(tick({0.0, 0.0, 0.0}), WH_OK);
    ASSERT_EQ(sample_.sequence, last + 1);
    last = sample_.sequence;
  }
}

TEST_F(FrameLine, LineUnpluggedInMidFrame_FailsReadsWritesAndVerbs) {
  (void)device_->write(commandOf({1.0, 1.0, 1.0}));
  device_->pump(bench_.now_ns());
  bench_.pass();
  bench_.wires->from_device.resize(bench_.wires->from_device.size() / 2);
  device_->pump(bench_.now_ns());
  bench_.wires->gone = true;
  device_->pump(bench_.now_ns());
  EXPECT_EQ(device_->read(sample_), WH_FAILED);
  EXPECT_EQ(device_->write(commandOf({1.0, 1.0, 1.0})), WH_FAILED);
  const auto enabled = device_->control(WH_ENABLE, 0.0, bench_.wait());
  EXPECT_TRUE(refusedWith(enabled, "the line is gone"));
}

TEST_F(FrameLine, ReadsAndWrites_AllocateNothing) {
  const wh_command command = commandOf({1.0, 1.0, 1.0});
  const std::uint64_t before = threadAllocations();
  for (int i = 0; i < 1000; ++i) {
    (void)device_->read(sample_);
    (void)device_->write(command);
  }
  EXPECT_EQ(threadAllocations(), before);
}

/// A line of limited speed [bytes/ms] with a buffer before it; it may report the fill of the
/// buffer.
struct SlowLine {
  Line queue;
  double bytes_per_ms = 1e9, credit = 0.0;
  bool reports_queue = true;

  void pass(Wires& wires) {
    credit = std::min(credit + bytes_per_ms, bytes_per_ms + 1.0);
    for (; credit >= 1.0 && !queue.empty(); credit -= 1.0) {
      wires.to_device.push_back(queue.front());
      queue.pop_front();
    }
  }
};

class SlowCarrier final : public Carrier {
 public:
  SlowCarrier(std::shared_ptr<Wires> wires, SlowLine& line)
      : inner_(std::move(wires)), line_(line) {}
  [[nodiscard]] bool send(const std::uint8_t* bytes, std::size_t count) noexcept override {
    line_.queue.insert(line_.queue.end(), bytes, bytes + count);
    return true;
  }
  [[nodiscard]] std::size_t waiting() const noexcept override {
    return line_.reports_queue ? line_.queue.size() : 0;
  }
  [[nodiscard]] int receive(std::uint8_t* bytes, std::size_t capacity) noexcept override {
    return inner_.receive(bytes, capacity);
  }
  [[nodiscard]] int descriptor() const noexcept override { return -1; }

 private:
  MemoryCarrier inner_;
  SlowLine& line_;
};

/// Largest age of the acting command [ms], and the largest part of it that the samples do not show
/// [ms].
struct Lateness {
  int most_ms = 0, most_unreported_ms = 0;
};

Lateness commandEveryMillisecond(double percent, bool reports_queue) {
  BenchBoard bench(6);
  SlowLine line;
  line.reports_queue = reports_queue;
  const auto wait = [&] {
    line.pass(*bench.wires);
    bench.pass();
    return bench.now_ns();
  };
  const auto device =
      orThrow(FrameDevice::open(std::make_unique<SlowCarrier>(bench.wires, line), 5, wait));
  EXPECT_TRUE(device->control(WH_ENABLE, 0.0, wait));
  wf_frame frame{};  // a frame as large as a command
  frame.kind = WF_COMMAND;
  frame.axes = 6;
  std::array<std::uint8_t, WF_MAX_WIRE> wire{};
  line.bytes_per_ms = 100.0 / percent * static_cast<double>(wf_encode(&frame, wire.data()));
  Lateness out;
  wh_sample sample = emptySample();
  for (int k = 1; k <= 500; ++k) {
    (void)device->write(commandOf(std::vector<double>(6, 1e-3 * k)));
    device->pump(bench.now_ns());
    (void)wait();
    device->pump(bench.now_ns());
    (void)device->read(sample);
    if (bench.fw.phase != FW_RENDERING) continue;  // no command received yet, or released
    const int late_ms = k - static_cast<int>(std::lround(1e3 * bench.given[0]));
    const auto said_ms = static_cast<int>((bench.now_ns() - sample.monotonic_ns) / 1'000'000);
    out.most_ms = std::max(out.most_ms, late_ms);
    if (said_ms < 200) out.most_unreported_ms = std::max(out.most_unreported_ms, late_ms - said_ms);
  }
  return out;
}

// Rule: on a line that reports its fill, the newest command waits for one frame at most. On any
// other line the samples are at least as old as the acting command, so the loop stops by their age.
TEST(FrameOnASlowLine, LateCommandAtAnyLoad_IsShownByTheSamplesAge) {
  for (const double percent : {10.0, 50.0, 80.0, 100.0, 130.0, 200.0, 300.0}) {
    SCOPED_TRACE(percent);
    const int frame_ms = static_cast<int>(std::ceil(percent / 100.0));
    const Lateness reported = commandEveryMillisecond(percent, true);
    EXPECT_LE(reported.most_ms, 2 * frame_ms);
    const Lateness unreported = commandEveryMillisecond(percent, false);
    if (percent > 100.0) {
      EXPECT_GT(unreported.most_ms, 20) << "the line is overfull";
    }
    // A frame on the line counts from its start.
    EXPECT_LE(std::max(reported.most_unreported_ms, unreported.most_unreported_ms), frame_ms + 1);
  }
}

TEST(FrameOpen, SilentDevice_IsRefused) {
  BenchBoard bench;
  bench.silent = true;
  const auto device = bench.open();
  EXPECT_TRUE(refusedWith(device, "nobody answers"));
}

TEST(FrameOpen, DeviceInUseByAnotherProgram_IsRefused) {
  BenchBoard bench;
  const auto first = orThrow(bench.open(5));
  ASSERT_TRUE(first->control(WH_ENABLE, 0.0, bench.wait()));
  const auto alive = [&] {
    bench.fw.heard_us = bench.now_us;  // as if the first program still sent commands
    bench.pass();
    return bench.now_ns();
  };
  const auto second = FrameDevice::open(std::make_unique<MemoryCarrier>(bench.wires), 6, alive);
  EXPECT_TRUE(refusedWith(second, "renders for another program"));
  EXPECT_EQ(bench.fw.session, 5U);
  EXPECT_EQ(bench.fw.phase, FW_WAITING);
}

TEST(FrameOpen, OtherVersion_IsRefusedWithBothVersions) {
  auto wires = std::make_shared<Wires>();
  // A device of version 2 answers in its own format.
  const auto answer = [&wires] {
    std::vector<std::uint8_t> frame = {2, WF_WELCOME, 1, 0, 5, 0, 0, 0, 1, 0, 0, 0, 42};
    const std::uint16_t crc = wf_crc16(frame.data(), frame.size());
    frame.push_back(static_cast<std::uint8_t>(crc));
    frame.push_back(static_cast<std::uint8_t>(crc >> 8));
    std::vector<std::uint8_t> coded(frame.size() + 2);
    coded.resize(wf_cobs_encode(frame.data(), frame.size(), coded.data()));
    wires->from_device.insert(wires->from_device.end(), coded.begin(), coded.end());
    wires->from_device.push_back(0);
  };
  std::int64_t now_ns = 0;
  const auto device = FrameDevice::open(std::make_unique<MemoryCarrier>(wires), 5, [&] {
    answer();
    return now_ns += 1'000'000;
  });
  EXPECT_TRUE(refusedWith(device, "speaks version 2 of the frame, this is 1"));
}

TEST(FrameOpen, ImpossibleAxes_AreRefusedByName) {
  BenchBoard twice;
  std::strcpy(twice.board.axis[2].name, "x");
  auto device = twice.open();
  EXPECT_TRUE(refusedWith(device, "axis 2 (x) has the name of axis 0"));
  BenchBoard kind;
  kind.board.axis[1].kind = 7;
  device = kind.open();
  EXPECT_TRUE(refusedWith(device, "axis 1 (y) is of a kind"));
}

TEST(Locator, LocatorWithoutACarrier_IsRefusedWithTheValidForms) {
  for (const char* locator :
       {"", "tcp:here:1", "udp:here", "udp::1", "udp:here:", "serial:", "7777"}) {
    const auto carrier = openCarrier(locator);
    EXPECT_TRUE(refusedWith(carrier, "serial:/dev/ttyX:BAUD"));
  }
}

struct Named {
  const char* locator;
  const char* expected;
};

TEST(Locator, LocatorWithoutATarget_IsRefusedWithTheReason) {
  for (const Named& named : {Named{"serial:/dev/none", "/dev/none cannot be opened: No such file"},
                             Named{"serial:/dev/null", "is no serial line"},
                             Named{"serial:/dev/none:12345", "12345 baud is not known"},
                             Named{"udp:127.0.0.1:99999", "99999 is no port"},
                             Named{"udp:no.such.host.invalid:7", "leads nowhere"},
                             Named{"shm:Not-A-Name", "names no shared memory"},
                             Named{"shm:nobody-made-this", "No such file"}}) {
    const auto carrier = openCarrier(named.locator);
    EXPECT_TRUE(refusedWith(carrier, named.expected));
    EXPECT_TRUE(refusedWith(carrier, named.locator));
  }
}

}  // namespace
}  // namespace wholehand::test
