// The record of a commissioning, kept by the recorder and the black box file of every run.
#include "rig/run/commissioning_record.hpp"

#include "files/device/device_file.hpp"
#include "record/black_box/child_tools.hpp"
#include "support/figure.hpp"
#include "support/folder.hpp"

#include <csignal>
#include <memory>

namespace wholehand::test {
namespace {

constexpr int kRecordTicks = 300;
constexpr std::int64_t kPeriod_ns = 1'000'000, kStart_ns = 5'000'000'000;

DeviceModel desktop() {
  return orThrow(loadDeviceFile(WHOLEHAND_SOURCE_DIR "/config/devices/desktop-3axis.toml"));
}

std::unique_ptr<CommissioningRecord> beginIn(const Folder& folder, const DeviceModel& model) {
  CommissioningRecord::Plan plan;
  plan.path = folder.file("commissioning.h5");
  plan.title = "Commissioning of a desktop device";
  plan.device_text = "its file";
  return orThrow(CommissioningRecord::begin(model, plan));
}

CommissioningRecord::Tick tickAt(int number, int gap) {
  CommissioningRecord::Tick tick;
  tick.monotonic_ns = kStart_ns + (number + (number >= kRecordTicks / 2 ? gap : 0)) * kPeriod_ns;
  tick.position = AxisPosition(3);
  tick.sent = AxisEffort(3);
  tick.position[0] = 1e-4 * number;
  tick.sent[1] = 0.5;
  tick.status = 3;
  tick.rendering = number < kRecordTicks - 10;
  tick.let_go = tick.rendering ? 0 : 4;
  return tick;
}

void keepAll(CommissioningRecord& record, int gap) {
  for (int i = 0; i < kRecordTicks; ++i) {
    record.setStep(i < 100 ? 2 : 4);
    record.keep(tickAt(i, gap));
  }
}

void expectTicks(const std::string& path, int gap) {
  const auto reader = orThrow(RecordingReader::open(path));
  ASSERT_EQ(reader->size(), kRecordTicks);
  EXPECT_EQ(reader->meta().value_names, CommissioningRecord::valueNames());
  TickRecord tick;
  ASSERT_TRUE(reader->read(120, tick));
  EXPECT_EQ(tick.q_m[0], tickAt(120, gap).position[0]);
  EXPECT_EQ(tick.sent[1], 0.5);
  EXPECT_EQ(tick.exercise.values[0], 4.0) << "the step";
  EXPECT_EQ(tick.exercise.values[1], 3.0) << "the device's status";
  ASSERT_TRUE(reader->read(kRecordTicks - 1, tick));
  EXPECT_EQ(tick.tick, static_cast<std::uint64_t>(kRecordTicks - 1 + gap))
      << "a pause between moves";
  EXPECT_EQ(tick.safety_state, SafetyState::kFaulted);
  EXPECT_EQ(tick.exercise.values[2], 4.0) << "why the guard let go";
}

TEST(CommissioningRecord, RecordedTicks_AreReadBackUnchanged) {
  const Folder folder;
  const DeviceModel model = desktop();
  {
    const auto record = beginIn(folder, model);
    keepAll(*record, 700);
    EXPECT_EQ(record->kept(), static_cast<std::uint64_t>(kRecordTicks));
  }
  expectTicks(folder.file("commissioning.h5"), 700);
  EXPECT_FALSE(std::filesystem::exists(folder.file("commissioning.wbb"))) << "nothing crashed";
}

TEST(CommissioningRecord, NoTick_LeavesNoFile) {
  const Folder folder;
  const DeviceModel model = desktop();
  beginIn(folder, model).reset();
  EXPECT_FALSE(std::filesystem::exists(folder.file("commissioning.h5")));
}

TEST(CommissioningRecord, ProcessThatCrashes_LeavesTheRecordInItsBlackBox) {
  const Folder folder;
  const DeviceModel model = desktop();
  const int status = inChild([&] {
    const auto record = beginIn(folder, model);
    keepAll(*record, 0);
    (void)::raise(SIGSEGV);
  });
  expectDiedOf(SIGSEGV, status);
  expectTicks(folder.file("commissioning.wbb"), 0);
}

}  // namespace
}  // namespace wholehand::test
