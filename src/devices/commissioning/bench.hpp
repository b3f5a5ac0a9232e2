#pragma once

#include "devices/commissioning/identification/identify_axis.hpp"
#include "devices/host/effort_guard.hpp"
#include "devices/plugin/device_driver.hpp"
#include "devices/plugin/transport.hpp"
#include "loop/core/expected.hpp"
#include "loop/model/device_model.hpp"
#include "vocabulary/operator.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <utility>
#include <vector>

/// Motions of the commissioning steps. Every motion holds the other axes in place with soft
/// springs.
namespace wholehand {

/// Checks by motion whether efforts reach the motors, whatever the drive's status bits say. Every
/// axis is pushed against its weight, or towards the middle of its travel if it has no weight. The
/// acting effort follows from the motion and the device file: m q̈ + b q̇ + f_c sign q̇. For an
/// axis that falls by its weight or is held by a brake, this effort has the opposite sign or is
/// zero.
class ReleaseCheck {
 public:
  /// @param lasts_s a push that does not end stays below half the speed limit for this time
  /// @param share largest share of an effort limit
  ReleaseCheck(const DeviceModel& model, double lasts_s, double share);

  /// Effort of each axis [N or N·m]. The positions of the first call set the directions.
  [[nodiscard]] const std::vector<double>& push(const std::vector<double>& position);
  /// Adds positions to the part that is evaluated.
  /// @param at_s the sample's own time
  void addSample(double at_s, const std::vector<double>& position);
  /// Begins the next part.
  void forget() { seen_.clear(); }

  /// True when every axis has moved by enough encoder steps to be evaluated.
  [[nodiscard]] bool moved() const;
  /// Errors for axes that the push did not move: for them, nothing would show whether the push
  /// ends.
  [[nodiscard]] Diagnostics still() const;
  /// Errors for axes on which more than half of the push still acts.
  /// @param when used in the error text: "after its watchdog let go"
  [[nodiscard]] Diagnostics acting(const std::string& when) const;

 private:
  struct Observation {
    double at_s = 0.0;
    std::vector<double> position;
  };
  [[nodiscard]] double shareActing(std::size_t axis) const;

  const DeviceModel* model_;
  double lasts_s_, share_;
  std::vector<double> push_, effort_;
  std::vector<Observation> seen_;
};

/// Checks every sample of a device that moves under supervision, from the beginning of a motion to
/// its end. Axes are in the order of the device file.
class SampleWatch {
 public:
  /// @param place for each axis of the file, the index of the driver's axis
  /// @param period_s time between two samples
  SampleWatch(const DeviceModel& model, std::vector<std::size_t> place, double period_s);

  /// Begins a motion and clears the history.
  void begin();
  /// Positions of a sample. Refused: an axis without a finite position.
  [[nodiscard]] Expected<std::vector<double>> positions(const wh_sample& sample) const;
  /// Checks a sample and returns its positions. Refused, each with its own message: a drive in
  /// fault; a released watchdog; a device that is not enabled or not homed; samples that stand
  /// still for longer than longestStill_s(), that are older than this time and than the stall of
  /// this machine, or whose times lie in the future or go back; an axis without a position, out of
  /// its range, with a jump of its encoder, or faster than its speed limit by the samples' own
  /// times.
  /// @param now_ns time of the reading, CLOCK_MONOTONIC or simulated
  [[nodiscard]] Expected<std::vector<double>> check(const wh_sample& sample, std::int64_t now_ns);

 private:
  struct Observation {
    std::int64_t taken_ns = 0;
    std::vector<double> position;
  };

  [[nodiscard]] Diagnostic no(const std::string& axis, const std::string& problem,
                              const std::string& remedy) const;
  [[nodiscard]] Expected<Done> checkStatus(const wh_sample& sample) const;
  [[nodiscard]] Expected<Done> checkAge(const wh_sample& sample, std::int64_t now_ns);
  [[nodiscard]] Expected<Done> checkMotion(std::size_t i, const Observation& now) const;

  const DeviceModel* model_;
  std::vector<std::size_t> place_;
  double period_s_;
  std::vector<double> start_;     ///< positions at the beginning of the motion
  std::deque<Observation> seen_;  ///< the front is the newest sample that is kSpeedOver_s old,
                                  ///< if there is one
  std::size_t tick_ = 0, still_ = 0;
  std::uint64_t sequence_ = 0;
  std::int64_t taken_ns_ = 0, now_ns_ = 0, longest_gap_ns_ = 0;
};

/// Largest share of the device file's effort limit used in commissioning.
inline constexpr double kCommissioningShare = 0.2;
/// Ramp to neutral, from any share [s]. From kCommissioningShare the effort falls no faster than in
/// rendering, whose ramp takes 80 ms from the whole limit. In the climb it falls faster, within the
/// slew limit: nobody is attached, and a released key ends all effort within 150 ms.
inline constexpr double kCommissioningRamp_s = 0.02;

/// A device that moves under supervision: no person is attached, and somebody holds a key. Every
/// effort passes the device host's guard (effort_guard.hpp) with a fifth of the file's effort
/// limits, or the share that a ShareInForce allows, and the full slew limits. The device is enabled
/// only while the key is held. A released key, a fault, a runaway or the end of a motion ramps it
/// to neutral within kCommissioningRamp_s, with the shape of the ramp in rendering, and disables it
/// (WH_DISABLE). One thread. Axes are in the order of the device file.
class Bench {
 public:
  /// Input and output of a law of motion.
  struct Now {
    double time_s = 0.0;           ///< since the motion began, counted in ticks of one period
    double taken_s = 0.0;          ///< since the motion began, by the clock; includes delays
    std::vector<double> position;  ///< [m or rad]
    std::vector<double> effort;    ///< effort to send: neutral unless the law sets it [N or N·m]
    bool silent = false;           ///< set by the law: send nothing in this tick
  };
  /// The effort sent to the device, and the newest sample before it.
  struct Tick {
    std::int64_t monotonic_ns = 0;
    const wh_sample& sample;
    const wh_command& command;
    HostPhase phase = HostPhase::kIdle;
    ReleaseReason reason = ReleaseReason::kNone;  ///< why the guard ended the motion; kNone: it did
                                                  ///< not
  };
  /// Law of motion, called every tick. Returns false when the motion is done.
  using Law = std::function<Expected<bool>(Now&)>;
  /// What to do with a sample: check it; wait for a better one; pass it to the law unchecked,
  /// because the drive reports a release; end the motion.
  enum class SampleUse { kCheck, kWait, kProve, kOver };
  /// Receives the result and the sample of each read() before the sample is checked.
  using Look = std::function<SampleUse(int result, const wh_sample&)>;

  /// Prepares a bench. Refused: an axis that the driver lacks, and a neutral effort above
  /// kCommissioningShare.
  [[nodiscard]] static Expected<Bench> make(DeviceDriver& driver, const DeviceModel& model,
                                            Operator& person, TickClock& clock, double period_s);

  /// Waits for the key, enables the device, moves it by the law, ramps to neutral and disables it.
  /// Refused, each with its own message: nobody confirmed that no person is attached; the key is
  /// not pressed or was released, also while enabling; and everything that SampleWatch refuses.
  [[nodiscard]] Expected<Done> move(const Motion& motion, const Law& law);
  /// Moves in the same way until `look` ends the motion.
  [[nodiscard]] Expected<Done> move(const Motion& motion, const Look& look, const Law& law);
  /// Asks the person while the device is disabled and is moved by hand. Refused: the person gave
  /// up, or the device gave no sample.
  /// @param look receives the positions of every sample
  [[nodiscard]] Expected<std::string> askWhile(
      const Question& question,
      const std::function<void(const std::vector<double>& position)>& look);
  /// Homes the device (WH_HOME), which may move it. The key must be held when homing begins. A
  /// device without that verb has absolute encoders. Refused: homing fails, or no sample afterwards
  /// has WH_HOMED.
  [[nodiscard]] Expected<Done> home();
  /// Tests the drive's watchdog. Pushes every axis, stops feeding the watchdog, and waits until the
  /// drive releases the axes. If the driver cannot stop feeding it, nothing more is sent. Returns
  /// the time to the release [s]. Refused: a time above `longest_s`, a device that was not enabled
  /// when the silence began, an axis that is still pushed afterwards (ReleaseCheck), and everything
  /// for which move() is refused.
  [[nodiscard]] Expected<double> dropWatchdog(double longest_s);

  /// Sets a listener that is called after every sent effort. It must not block.
  void listen(std::function<void(const Tick&)> listener) { listener_ = std::move(listener); }
  /// Axis of the file → index in samples and commands.
  [[nodiscard]] const std::vector<std::size_t>& places() const { return place_; }
  /// Records that no person is attached. The device is not enabled without this confirmation.
  void confirmNobodyAttached(bool nobody) { nobody_attached_ = nobody; }
  [[nodiscard]] Expected<std::vector<double>> position();

  [[nodiscard]] DeviceDriver& driver() { return *driver_; }
  [[nodiscard]] const DeviceModel& model() const { return *model_; }
  [[nodiscard]] Operator& person() { return *person_; }
  [[nodiscard]] double period_s() const { return config_.period_s; }
  /// Allows this share of the file's effort limits, for the climb. @pre the device is not enabled
  void allow(double share);
  /// Effort limit of an axis in commissioning but the climb [N or N·m].
  [[nodiscard]] double limit(std::size_t axis) const;
  /// Effort sent to an axis in the last tick [N or N·m].
  [[nodiscard]] double sent(std::size_t axis) const { return command_.effort[place_[axis]]; }
  /// Adds the newest sample and the newest command to a log of the transport.
  void note(TransportLog& log) const { log.add(newest_, driver_->way(), clock_->now_ns()); }
  /// Effort of an axis in the newest sample [N or N·m]; NaN: not measured.
  [[nodiscard]] double measuredEffort(std::size_t axis) const {
    return newest_.effort[place_[axis]];
  }
  /// Largest effort sent so far, relative to the limit of its axis in the file.
  [[nodiscard]] double largestShare() const { return largest_share_; }

 private:
  Bench(DeviceDriver& driver, const DeviceModel& model, Operator& person, TickClock& clock);
  [[nodiscard]] Diagnostic no(const std::string& axis, const std::string& problem,
                              const std::string& remedy) const;
  [[nodiscard]] Expected<wh_sample> sample();
  [[nodiscard]] std::vector<double> neutral() const;  ///< neutral efforts of the file [N or N·m]
  [[nodiscard]] Expected<Done> awaitKey(const Motion& motion);
  [[nodiscard]] Expected<Done> keyStillHeld();
  [[nodiscard]] Expected<Done> enable();
  [[nodiscard]] Expected<Done> guarded(const Look& look, const Law& law);
  [[nodiscard]] Expected<Done> send(const std::vector<double>& effort, ReleaseReason let_go);
  [[nodiscard]] Expected<Done> letGo();

  DeviceDriver* driver_;
  const DeviceModel* model_;
  Operator* person_;
  TickClock* clock_;
  GuardConfig config_;
  AxisEffort whole_limit_;  ///< the file's effort limits, in the driver's order
  GuardState guard_;
  wh_command command_{};
  std::vector<std::size_t> place_;  ///< for each axis of the file, the index of the driver's axis
  SampleWatch watch_;
  bool nobody_attached_ = false;
  std::function<void(const Tick&)> listener_;
  wh_sample newest_{};
  std::uint64_t sessions_ = 0;
  double largest_share_ = 0.0;
};

/// Allows a share of the effort limits for its lifetime, and then a fifth again.
class ShareInForce {
 public:
  ShareInForce(Bench& bench, double share) : bench_(bench) { bench_.allow(share); }
  ~ShareInForce() { bench_.allow(kCommissioningShare); }
  ShareInForce(const ShareInForce&) = delete;
  ShareInForce& operator=(const ShareInForce&) = delete;

 private:
  Bench& bench_;
};

/// Natural frequency of the springs that hold axes, for the mass of the device file [Hz].
inline constexpr double kSpring_hz = 2.0;

/// Holds axes by springs about their target positions.
class SoftHold {
 public:
  /// @param offset effort that balances gravity on each axis [N or N·m]
  SoftHold(const Bench& bench, std::vector<double> offset);

  /// Target of each axis [m or rad]; initialised by the first hold() unless set.
  std::vector<double> target;
  /// Sets the effort of every axis.
  void hold(Bench::Now& now);
  [[nodiscard]] double effort(std::size_t axis, double target_speed = 0.0) const;

 private:
  const Bench* bench_;
  std::vector<double> offset_, speed_, last_, position_;
  double last_s_ = 0.0;
};

/// Result of a slow push.
struct Push {
  std::size_t axis = 0;  ///< axis that moved most, relative to its range
  double moved = 0.0;    ///< signed share of its range; 0: nothing moved
  double share = 0.0;    ///< share of the effort limit that was needed
};

/// Raises the effort of one axis in the direction of `sign` until something moves by 2 % of its
/// range; `moved` is 0 if nothing moves up to kCommissioningShare. No springs hold the axes,
/// because the signs are not known yet.
[[nodiscard]] Expected<Push> pushSlowly(Bench& bench, std::size_t axis, double sign);

/// Effort that balances an axis at its present position [N or N·m]. Sweeps slowly to and fro and
/// takes the mean of both directions, which cancels dry friction.
[[nodiscard]] Expected<double> carryingEffort(Bench& bench, std::size_t axis,
                                              const std::vector<double>& offset);

/// Moves one axis slowly to a position. Refused if it does not arrive.
[[nodiscard]] Expected<Done> driveTo(Bench& bench, std::size_t axis, double position,
                                     const std::vector<double>& offset);

/// Result of the excitation of one axis (identification/identify_axis.hpp).
struct AxisExcitation {
  AxisTrace trace;
  std::vector<double> given;    ///< effort that the drive measured at each tick; NaN: none
  std::vector<double> taken_s;  ///< actual time of each tick
  double transport_s = 0.0;     ///< median of the transport
  /// Response of every axis: acceleration times the root of its mass, relative to the excited axis
  /// (1). Two axes coupled by an inertia c respond with c / √(m₁ m₂).
  std::vector<double> response;
};
[[nodiscard]] Expected<AxisExcitation> excite(Bench& bench, std::size_t axis,
                                              const std::vector<double>& offset, double duration_s);

}  // namespace wholehand
