#include "devices/fault_table_adapters.hpp"

#include "devices/host/hosted_driver.hpp"
#include "devices/host_tools.hpp"
#include "devices/plain_driver.hpp"
#include "drivers/composite/composite.hpp"
#include "drivers/force_dimension/fake_sdk.hpp"
#include "drivers/frame_bench.hpp"
#include "drivers/moteus/moteus_in_step.hpp"
#include "files/device/device_file.hpp"
#include "loop/realtime/monotonic_clock.hpp"
#include "support/rig_tools.hpp"

#include <atomic>
#include <cstring>

namespace wholehand::test {
namespace {

DeviceModel desktopModel() {
  return orThrow(
      loadDeviceFile(std::string(WHOLEHAND_SOURCE_DIR) + "/config/devices/desktop-3axis.toml"));
}

/// A driver of three axes that obeys every command.
class Obedient final : public PlainDriver {
 public:
  explicit Obedient(const std::vector<const char*>& names) : PlainDriver(names, axis()) {}
  [[nodiscard]] int read(wh_sample& sample) noexcept override {
    const auto is = [this](const char* word) { return std::strcmp(kind.load(), word) == 0; };
    if (is("unplug")) return WH_FAILED;
    const bool nothing_new = is("nothing_new");
    if (!is("frozen")) {
      if (!nothing_new) ++samples_;
      taken_ns_ = clock != nullptr ? clock->now_ns() : monotonicNow_ns();
    }
    sample.sequence = is("backwards") ? 1'000'000 - samples_ : 1'000'000 + samples_;
    sample.monotonic_ns = is("clock") ? 1 : taken_ns_;
    sample.status = WH_HOMED | (enabled ? static_cast<std::uint32_t>(WH_ENABLED) : 0U);
    if (is("unhomed")) sample.status &= ~static_cast<std::uint32_t>(WH_HOMED);
    if (is("enable")) sample.status &= ~static_cast<std::uint32_t>(WH_ENABLED);
    if (is("drive")) sample.status |= WH_DRIVE_FAULT;
    if (is("silenced")) sample.status |= WH_SILENCED;
    sample.valid = (1U << axes().size()) - 1U;
    if (is("missing")) sample.valid &= ~1U;
    return nothing_new ? WH_NOTHING_NEW : WH_OK;
  }
  [[nodiscard]] int write(const wh_command&) noexcept override {
    return !enabled || std::strcmp(kind.load(), "refuse") == 0 ? WH_FAILED : WH_OK;
  }

  std::atomic<const char*> kind{""};    ///< kind of the injected fault
  const FaultAdapter* clock = nullptr;  ///< clock of its samples; null: real time

 private:
  static wh_axis axis() {
    wh_axis axis = plainAxis();
    axis.resolution = 1e-5;
    axis.delay_s = 0.0005;
    return axis;
  }

  std::uint64_t samples_ = 0;
  std::int64_t taken_ns_ = 0;
};

// Returns a permanent copy of a fault name of the table.
const char* lasting(const std::string& kind) {
  for (const char* known : {"unplug", "missing", "drive", "enable", "unhomed", "silenced",
                            "backwards", "clock", "frozen", "nothing_new", "refuse"}) {
    if (kind == known) return known;
  }
  throw std::runtime_error("no such fault: " + kind);
}

class Direct final : public FaultAdapter {
 public:
  Direct() : FaultAdapter(desktopModel()) { driver_->clock = this; }
  [[nodiscard]] std::shared_ptr<DeviceDriver> driver() override { return driver_; }
  void injectFault(const std::string& kind) override { driver_->kind = lasting(kind); }

 private:
  std::shared_ptr<Obedient> driver_ =
      std::make_shared<Obedient>(std::vector<const char*>{"z", "y", "x"});
};

/// The composite of two drivers, as one driver.
class Pair final : public DeviceDriver {
 public:
  Pair(const Composite::Parts& parts, std::int64_t (*now_ns)() noexcept) {
    CompositeConfig config;
    config.parts[0].axes = {"x", "y"};
    config.parts[1].axes = {"z"};
    whole_ = orThrow(Composite::make(config, parts, now_ns));
  }
  [[nodiscard]] std::string where() const override { return "the pair"; }
  [[nodiscard]] std::string name() const override { return "pair"; }
  [[nodiscard]] const std::vector<wh_axis>& axes() const noexcept override {
    return whole_->axes();
  }
  [[nodiscard]] Expected<Done> control(std::uint32_t verb, double argument) override {
    return whole_->control(verb, argument);
  }
  [[nodiscard]] int read(wh_sample& sample) noexcept override { return whole_->read(sample); }
  [[nodiscard]] int write(const wh_command& command) noexcept override {
    return whole_->write(command);
  }

 private:
  std::unique_ptr<Composite> whole_;
};

class OfTwo final : public FaultAdapter {
 public:
  OfTwo() : FaultAdapter(desktopModel()) { base_->clock = hand_->clock = this; }
  [[nodiscard]] std::shared_ptr<DeviceDriver> driver() override {
    static const FaultAdapter* clock = nullptr;
    clock = this;
    return std::make_shared<Pair>(Composite::Parts{base_, hand_},
                                  []() noexcept { return clock->now_ns(); });
  }
  void injectFault(const std::string& kind) override {
    static int turn = 0;
    (++turn % 2 == 0 ? base_ : hand_)->kind = lasting(kind);
  }

 private:
  std::shared_ptr<Obedient> base_ = std::make_shared<Obedient>(std::vector<const char*>{"x", "y"});
  std::shared_ptr<Obedient> hand_ = std::make_shared<Obedient>(std::vector<const char*>{"z"});
};

/// Firmware, line and frame device advanced in lock-step.
class FrameDriver final : public BenchDriver {
 public:
  using BenchDriver::BenchDriver;
  [[nodiscard]] int read(wh_sample& sample) noexcept override {
    pump();
    return BenchDriver::read(sample);
  }
  [[nodiscard]] int write(const wh_command& command) noexcept override {
    const int result = BenchDriver::write(command);
    pump();
    return result;
  }
};

class OverTheFrame final : public FaultAdapter {
 public:
  OverTheFrame() : FaultAdapter(desktopModel()), driver_(std::make_shared<FrameDriver>(bench_)) {}
  [[nodiscard]] std::shared_ptr<DeviceDriver> driver() override { return driver_; }
  void pass() override {
    if (bench_.silent) {
      bench_.now_us += 1000;
    } else {
      bench_.pass();
    }
  }
  [[nodiscard]] std::int64_t now_ns() const override { return bench_.now_ns(); }
  void injectFault(const std::string& kind) override {
    if (kind == "unplug") bench_.wires->gone = true;
    if (kind == "missing") bench_.state.valid &= ~1U;
    if (kind == "drive") bench_.state.status |= WH_DRIVE_FAULT;
    if (kind == "unhomed") bench_.state.status &= ~static_cast<std::uint32_t>(WH_HOMED);
    if (kind == "frozen") bench_.silent = true;
    if (kind == "silenced") bench_.now_us += 25'000;  // its watchdog allows 20 ms
  }

 private:
  BenchBoard bench_;
  std::shared_ptr<FrameDriver> driver_;
};

DeviceModel handModel() {
  static const DeviceModel kModel = [] {
    Models models = load(shippedFiles());
    keepAxes(models, {"finger_flexion", "thumb_circumduction", "thumb_flexion"});
    models.device.watch.longest_gap_s = 0.02;
    return models.device;
  }();
  return kModel;
}

class OnTheBus final : public FaultAdapter {
 public:
  OnTheBus() : FaultAdapter(handModel()) {
    for (int id = 1; id <= 3; ++id) bus_.drives.emplace_back(id);
    driver_ = std::make_shared<MoteusInStep>(bus_, time_);
  }
  [[nodiscard]] std::shared_ptr<DeviceDriver> driver() override { return driver_; }
  void pass() override {
    time_.now_ns += 1'000'000;
    bus_.deliver(time_.now_ns);
  }
  [[nodiscard]] std::int64_t now_ns() const override { return time_.now_ns; }
  void injectFault(const std::string& kind) override {
    FakeDrive& drive = bus_.drives[1];
    if (kind == "unplug") bus_.unplugged = true;
    if (kind == "drive") drive.mode = 1, drive.fault = 33;
    if (kind == "unhomed") drive.home = 0;
    if (kind == "silenced") drive.mode = 11;
    if (kind == "frozen") drive.answers = false;
  }

 private:
  SimulatedTime time_;
  FakeBusState bus_;
  std::shared_ptr<MoteusInStep> driver_;
};

class WithTheSdk final : public FaultAdapter {
 public:
  WithTheSdk() : FaultAdapter(desktopModel()), driver_(orThrow(at_.load("", kForceSettings))) {}
  [[nodiscard]] std::shared_ptr<DeviceDriver> driver() override { return driver_; }
  [[nodiscard]] std::int64_t now_ns() const override { return monotonicNow_ns(); }
  void injectFault(const std::string& kind) override {
    if (kind == "unplug") at_.fake->connected = 0;
    if (kind == "drive") at_.fake->error = 1;
    if (kind == "enable") at_.fake->force_on = 0, at_.fake->cause = 1;
    if (kind == "silenced") at_.fake->force_on = 0, at_.fake->cause = 3;
    if (kind == "unhomed") at_.fake->reset = 1;
    if (kind == "refuse") at_.fake->force_returns = -1;
  }

 private:
  ForceDimensionDriver at_;
  std::shared_ptr<PluginDriver> driver_;
};

DeviceModel hostedModel() {
  DeviceModel model = desktopModel();
  model.output_delay_ticks = 2;
  return model;
}

/// A device behind shared memory and a host thread, in real time.
class Hosted final : public FaultAdapter {
 public:
  Hosted()
      : FaultAdapter(hostedModel()),
        host_(hostName("table"), behind_, model_),
        driver_(orThrow(HostedDriver::connect(hostName("table")))) {}
  [[nodiscard]] std::shared_ptr<DeviceDriver> driver() override { return driver_; }
  void pass() override { std::this_thread::sleep_for(std::chrono::milliseconds(1)); }
  void injectFault(const std::string& kind) override { behind_->kind = lasting(kind); }
  [[nodiscard]] std::int64_t now_ns() const override { return monotonicNow_ns(); }
  [[nodiscard]] bool inRealTime() const override { return true; }

 private:
  std::shared_ptr<Obedient> behind_ =
      std::make_shared<Obedient>(std::vector<const char*>{"x", "y", "z"});
  HostThread host_;
  std::shared_ptr<HostedDriver> driver_;
};

}  // namespace

std::unique_ptr<FaultAdapter> makeDirect() {
  return std::make_unique<Direct>();
}
std::unique_ptr<FaultAdapter> makeComposite() {
  return std::make_unique<OfTwo>();
}
std::unique_ptr<FaultAdapter> makeFrame() {
  return std::make_unique<OverTheFrame>();
}
std::unique_ptr<FaultAdapter> makeMoteus() {
  return std::make_unique<OnTheBus>();
}
std::unique_ptr<FaultAdapter> makeForceDimension() {
  return std::make_unique<WithTheSdk>();
}
std::unique_ptr<FaultAdapter> makeHosted() {
  return std::make_unique<Hosted>();
}

}  // namespace wholehand::test
