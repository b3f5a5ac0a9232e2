#pragma once

#include "commissioning/operator.hpp"
#include "commissioning/sample_watch.hpp"
#include "core/expected.hpp"
#include "device/host/effort_guard.hpp"
#include "device/plugin/device_driver.hpp"
#include "model/device_model.hpp"

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {

/// No effort of commissioning exceeds this share of the device file's limit.
inline constexpr double kCommissioningShare = 0.2;

/// A device that is moved under supervision: nobody attached, a key held. Every effort goes through
/// the device host's guard (effort_guard.hpp) with a fifth of the file's limits and all of its slew
/// limits; letting go of the key, a fault, a runaway or the end of a move take it to neutral by the
/// ramp that rendering uses. One thread. Axes are in the order of the device file.
class Bench {
 public:
  /// What a law of motion sees, and what it may set.
  struct Now {
    double time_s = 0.0;           ///< since the move began, in ticks of one period each
    double taken_s = 0.0;          ///< the same by the clock: late ticks are late
    std::vector<double> position;  ///< [m or rad]
    std::vector<double> effort;    ///< to be sent: neutral unless the law sets it [N or N·m]
  };
  /// What the device was sent, and the newest sample before it.
  struct Tick {
    std::int64_t monotonic_ns = 0;
    const wh_sample& sample;
    const wh_command& command;
    HostPhase phase = HostPhase::kIdle;
    HostReason reason = HostReason::kNone;  ///< why the guard let go
  };
  /// Called every tick; false: the move is done.
  using Law = std::function<Expected<bool>(Now&)>;

  /// Refused: an axis that the driver has not, and a neutral effort beyond kCommissioningShare.
  [[nodiscard]] static Expected<Bench> make(DeviceDriver& driver, const DeviceModel& model,
                                            Operator& person, TickClock& clock, double period_s);

  /// Waits for the key, enables, moves by the law, takes it to neutral and disables. Refused, by
  /// name: nobody confirmed that nobody is attached, the key is not pressed or let go, also while
  /// the device was being enabled, and whatever SampleWatch refuses.
  [[nodiscard]] Expected<Done> move(const Motion& motion, const Law& law);
  /// The same without effort and without key, the device disabled: an answer of the person, who
  /// moves it by hand meanwhile. Nothing: the person gave up, or the device gave no sample.
  /// @param look sees every sample
  [[nodiscard]] Expected<std::string> askWhile(
      const Question& question,
      const std::function<void(const std::vector<double>& position)>& look);
  /// The same with the device enabled at its neutral effort; the person may cut it off.
  /// @param look sees what each read() gives: its result and the sample
  [[nodiscard]] Expected<std::string> askEnabled(
      const Question& question, const std::function<void(int result, const wh_sample&)>& look);
  /// WH_HOME, which may move the device by itself: only with the key held when it begins. A device
  /// without that verb has absolute encoders. Refused: it fails, or no sample says WH_HOMED then.
  [[nodiscard]] Expected<Done> home();
  /// Enables, lets the driver stop feeding the watchdog (where it cannot, sends nothing more), and
  /// waits for the drive to let go: how long that took [s].
  /// Refused: it did not within `longest_s`, or was not enabled when the silence began.
  [[nodiscard]] Expected<double> dropWatchdog(double longest_s);

  /// Is told of every effort that is sent, after it; takes no time.
  void listen(std::function<void(const Tick&)> listener) { listener_ = std::move(listener); }
  /// Axis of the file → place in samples and commands.
  [[nodiscard]] const std::vector<std::size_t>& places() const { return place_; }
  /// Without it nothing is enabled.
  void confirmNobodyAttached(bool nobody) { nobody_attached_ = nobody; }
  [[nodiscard]] Expected<std::vector<double>> position();

  [[nodiscard]] DeviceDriver& driver() { return *driver_; }
  [[nodiscard]] const DeviceModel& model() const { return *model_; }
  [[nodiscard]] Operator& person() { return *person_; }
  [[nodiscard]] double period_s() const { return config_.period_s; }
  /// Of an axis: what commissioning may use [N or N·m].
  [[nodiscard]] double limit(std::size_t axis) const;
  /// Of an axis: what the device was given in the last tick [N or N·m].
  [[nodiscard]] double sent(std::size_t axis) const { return command_.effort[place_[axis]]; }
  /// The largest effort sent so far over the limit of its axis in the file.
  [[nodiscard]] double largestShare() const { return largest_share_; }

 private:
  Bench(DeviceDriver& driver, const DeviceModel& model, Operator& person, TickClock& clock);
  [[nodiscard]] Diagnostic no(const std::string& axis, const std::string& problem,
                              const std::string& remedy) const;
  [[nodiscard]] Expected<wh_sample> sample();
  [[nodiscard]] std::vector<double> neutral() const;  ///< of the file [N or N·m]
  [[nodiscard]] Expected<Done> awaitKey(const Motion& motion);
  [[nodiscard]] Expected<Done> keyStillHeld();
  [[nodiscard]] Expected<Done> enable();
  [[nodiscard]] Expected<Done> guarded(const Law& law);
  [[nodiscard]] Expected<Done> send(const std::vector<double>& effort, HostReason let_go);
  void letGo();

  DeviceDriver* driver_;
  const DeviceModel* model_;
  Operator* person_;
  TickClock* clock_;
  GuardConfig config_;
  GuardState guard_;
  wh_command command_{};
  std::vector<std::size_t> place_;  ///< axis of the file → axis of the driver
  SampleWatch watch_;
  bool nobody_attached_ = false;
  std::function<void(const Tick&)> listener_;
  wh_sample newest_{};
  std::uint64_t sessions_ = 0;
  double largest_share_ = 0.0;
};

}  // namespace wholehand
