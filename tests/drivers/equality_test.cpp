// The same virtual patient behind the built-in simulated device and behind the frame: driver, line
// and reference firmware in lock-step on a simulated clock, without threads.
#include "devices/plugin/plugin_device.hpp"
#include "frame_bench.hpp"
#include "loop/device/simulated/simulated_device.hpp"
#include "rig/models.hpp"
#include "support/rig_tools.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace wholehand::test {
namespace {

constexpr double kEqualPeriod_s = 1e-3;
// The torque of the drive has 12 bits, sign included.
constexpr double kTorqueSteps = 2048.0;

/// A firmware whose board is the simulated device.
class PatientBoard : public BenchBoard {
 public:
  PatientBoard(const Models& models, const Intention& intention)
      : BenchBoard(models.device.axisCount()),
        device(models.device, models.patient, intention, kEqualPeriod_s) {
    for (int a = 0; a < models.device.axisCount(); ++a) {
      const DeviceAxis& has = models.device.axes[a];
      wf_axis& axis = board.axis[a];
      axis = {};
      has.name.copy(axis.name, WF_NAME - 1);
      axis.kind = has.kind == AxisKind::kRotation ? WH_ROTATION : WH_TRANSLATION;
      axis.lower = static_cast<float>(has.lower), axis.upper = static_cast<float>(has.upper);
      axis.effort_limit = static_cast<float>(has.effort_limit);
      axis.resolution = static_cast<float>(has.encoder_step);
      axis.silence_s = 0.02F;
      board.neutral[a] = static_cast<float>(has.neutral_effort);
    }
    board.drive = [](void* self, const float* effort, int) {
      auto& patient = static_cast<PatientBoard&>(*static_cast<BenchBoard*>(self));
      AxisEffort asked(patient.board.axes);
      for (int a = 0; a < asked.size(); ++a) {
        asked[a] = static_cast<double>(effort[a]);
        patient.state.effort[a] = effort[a];
      }
      (void)patient.device.write(asked);
    };
    board.measure = [](void* self, fw_state* to) {
      auto& patient = static_cast<PatientBoard&>(*static_cast<BenchBoard*>(self));
      if (std::exchange(patient.period_passes, false)) {
        DeviceReading reading;
        (void)patient.device.read(reading, 1);
        for (int a = 0; a < reading.q_m.size(); ++a) {
          patient.state.position[a] = static_cast<float>(reading.q_m[a]);
        }
      }
      *to = patient.state;
    };
    firmware_init(&fw, &board);
  }

  SimulatedDevice device;
  bool period_passes = false;  ///< whether a period passes with the firmware's next tick
};

/// The board that gives the clock of the samples.
const BenchBoard* g_board = nullptr;

/// A device that pumps the line at each read and write of the loop.
class LockStep final : public HapticDevice {
 public:
  explicit LockStep(const Models& models, const Intention& intention)
      : board_(models, intention), driver_(std::make_shared<BenchDriver>(board_)) {
    g_board = &board_;
    plugin_ = orThrow(PluginDevice::make(driver_, models.device, kEqualPeriod_s, std::nullopt,
                                         []() noexcept { return g_board->now_ns(); }));
  }
  [[nodiscard]] Expected<Done> open() override {
    (void)board_.device.open();
    return plugin_->open();
  }
  [[nodiscard]] Expected<Done> ready() override { return plugin_->ready(); }
  [[nodiscard]] Expected<Done> enable() override { return plugin_->enable(); }
  [[nodiscard]] bool simulated() const noexcept override { return true; }
  [[nodiscard]] Fault read(DeviceReading& reading, int elapsed_periods) noexcept override {
    board_.period_passes = true;
    board_.pass();
    driver_->pump();
    return plugin_->read(reading, elapsed_periods);
  }
  [[nodiscard]] Fault write(const AxisEffort& effort) noexcept override {
    const Fault fault = plugin_->write(effort);
    driver_->pump();
    return fault;
  }
  void close() noexcept override { plugin_->close(); }

 private:
  PatientBoard board_;
  std::shared_ptr<BenchDriver> driver_;
  std::unique_ptr<HapticDevice> plugin_;
};

TEST(FramePath, PathOfOnePatient_EqualsThatOfTheBuiltInDeviceWithinOneStep) {
  constexpr int kTicks = 4000;
  Models models = load(shippedFiles());
  const AxisPosition rest = restPose(models);
  AxisPosition ahead = rest;
  for (int i = 1; i < ahead.size(); ++i) {
    const DeviceAxis& axis = models.device.axes[i];
    ahead[i] += 0.2 * (axis.upper - rest[i]);
  }
  ahead[0] += 0.08;
  const double face_m = reach(models.hand, rest, Eigen::Vector3d::UnitX()) + 0.03;
  models.scene.bodies.push_back(wall(Eigen::Vector3d::UnitX(), face_m));
  const Intention intention =
      Intention::throughWaypoints({{0.5, rest}, {1.5, ahead}, {2.5, ahead}, {3.5, rest}});
  auto built_in = orThrow(buildRig(models, intention, {}));
  auto framed =
      orThrow(buildRigWithoutPerson(models, std::make_unique<LockStep>(models, intention), {}));
  ASSERT_TRUE(built_in->renderer->arm());
  ASSERT_TRUE(framed->renderer->arm());
  TickRecord a, b;
  double q_steps = 0.0, effort_steps = 0.0, moved_steps = 0.0, pushed = 0.0;
  AxisPosition start;
  for (int tick = 0; tick < kTicks; ++tick) {
    for (TickRecord* record : {&a, &b}) {
      record->tick = static_cast<std::uint64_t>(tick);
      record->time_s = tick * kEqualPeriod_s;
      record->command_count = 0;
    }
    built_in->renderer->tick(1, a);
    framed->renderer->tick(1, b);
    ASSERT_EQ(a.faults & kStoppingFaults, Fault::kNone) << tick;
    ASSERT_EQ(b.faults & kStoppingFaults, Fault::kNone) << tick;
    if (tick == 0) start = a.q_m;
    for (int i = 0; i < a.q_m.size(); ++i) {
      const DeviceAxis& axis = models.device.axes[i];
      q_steps = std::max(q_steps, std::abs(a.q_m[i] - b.q_m[i]) / axis.encoder_step);
      moved_steps = std::max(moved_steps, std::abs(a.q_m[i] - start[i]) / axis.encoder_step);
      effort_steps = std::max(effort_steps,
                              std::abs(a.sent[i] - b.sent[i]) / (axis.effort_limit / kTorqueSteps));
      pushed = std::max(pushed, std::abs(a.sent[i]) / axis.effort_limit);
    }
  }
  // float32 rounds a position by less than a thousandth of these steps.
  EXPECT_LE(q_steps, 1.0 + 1e-3);
  EXPECT_LE(effort_steps, 1.0);
  EXPECT_GT(moved_steps, 1000.0) << "nobody moved: the test proves nothing";
  EXPECT_GT(pushed, 0.05) << "nothing was felt: the test proves nothing";
  figure("frame path against built-in device, 4 s, positions apart at most", q_steps,
         "encoder steps");
  figure("frame path against built-in device, 4 s, efforts apart at most", effort_steps,
         "2048ths of the limit");
  figure("largest effort meanwhile", pushed, "of its limit");
}

}  // namespace
}  // namespace wholehand::test
