#pragma once

#include "devices/commissioning/identification/identify_axis.hpp"
#include "devices/host/effort_guard.hpp"
#include "devices/plugin/device_driver.hpp"
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

/// Moves of the commissioning steps. Every move holds the other axes in place by soft springs.
namespace wholehand {

/// Shows by motion whether efforts reach the motors, whatever the drive's bits say. Every axis is
/// pushed against its weight, or towards the middle of its travel where it has none. What acts on
/// it follows from its motion and the device file: m q̈ + b q̇ + f_c sign q̇, of which a weight that
/// falls and a brake have the other sign or nothing.
class LetGoProof {
 public:
  /// @param lasts_s a push that never ends stays below half the speed limit for so long
  /// @param share largest share of an effort limit
  LetGoProof(const DeviceModel& model, double lasts_s, double share);

  /// Effort of each axis [N or N·m]; the first positions choose the direction.
  [[nodiscard]] const std::vector<double>& push(const std::vector<double>& position);
  /// One more place of the part that is judged; `at_s` by the sample's own time.
  void see(double at_s, const std::vector<double>& position);
  /// The next part begins.
  void forget() { seen_.clear(); }

  /// Whether every axis has moved by enough steps of its encoder to be judged.
  [[nodiscard]] bool moved() const;
  /// Axes that the push did not move: nothing would show whether it ends.
  [[nodiscard]] Diagnostics still() const;
  /// Axes on which more than half of the push acts.
  /// @param when "after its watchdog let go"
  [[nodiscard]] Diagnostics acting(const std::string& when) const;

 private:
  struct Seen {
    double at_s = 0.0;
    std::vector<double> position;
  };
  [[nodiscard]] double shareActing(std::size_t axis) const;

  const DeviceModel* model_;
  double lasts_s_, share_;
  std::vector<double> push_, effort_;
  std::vector<Seen> seen_;
};

/// Checks every sample of a device that is moved under supervision, from the beginning of a move to
/// its end. Axes are in the order of the device file.
class SampleWatch {
 public:
  /// @param place axis of the file → axis of the driver
  /// @param period_s between two samples
  SampleWatch(const DeviceModel& model, std::vector<std::size_t> place, double period_s);

  /// Begins a move and clears the history.
  void begin();
  /// Positions of a sample. Refused: an axis without a finite position.
  [[nodiscard]] Expected<std::vector<double>> positions(const wh_sample& sample) const;
  /// Checks a sample and returns its positions. Refused, each with its own message: a drive in
  /// fault, a watchdog that let go, a device that is not enabled or not homed, samples that stand
  /// still for longer than longestStill_s(), are older than that and than this machine stood still,
  /// lie in the future or go back in time, an axis without a position, beyond its range, whose
  /// encoder jumps, or that is faster than its speed limit by the samples' own times.
  /// @param now_ns CLOCK_MONOTONIC, or simulated, when it was read
  [[nodiscard]] Expected<std::vector<double>> judge(const wh_sample& sample, std::int64_t now_ns);

 private:
  struct Seen {
    std::int64_t taken_ns = 0;
    std::vector<double> position;
  };

  [[nodiscard]] Diagnostic no(const std::string& axis, const std::string& problem,
                              const std::string& remedy) const;
  [[nodiscard]] Expected<Done> judgeStatus(const wh_sample& sample) const;
  [[nodiscard]] Expected<Done> judgeAge(const wh_sample& sample, std::int64_t now_ns);
  [[nodiscard]] Expected<Done> judgeMotion(std::size_t i, const Seen& now) const;

  const DeviceModel* model_;
  std::vector<std::size_t> place_;
  double period_s_;
  std::vector<double> start_;  ///< position at the beginning of the move
  std::deque<Seen> seen_;      ///< the first: the newest that is kSpeedOver_s old, if there is one
  std::size_t tick_ = 0, still_ = 0;
  std::uint64_t sequence_ = 0;
  std::int64_t taken_ns_ = 0, now_ns_ = 0, longest_gap_ns_ = 0;
};

/// Largest share of the device file's effort limit used in commissioning.
inline constexpr double kCommissioningShare = 0.2;
/// From there to neutral [s]. Nobody is attached, and the effort falls no faster than in rendering,
/// whose ramp takes 80 ms from the whole limit.
inline constexpr double kCommissioningRamp_s = 0.02;

/// A device that is moved under supervision: no person attached, a key held. Every effort passes
/// the device host's guard (effort_guard.hpp) with a fifth of the file's limits and its full slew
/// limits. It is enabled only while the key is held: a released key, a fault, a runaway or the end
/// of a move leads to neutral within kCommissioningRamp_s, by the shape of the ramp in rendering,
/// and to WH_DISABLE. One thread. Axes are in the order of the device file.
class Bench {
 public:
  /// Input and output of a law of motion.
  struct Now {
    double time_s = 0.0;           ///< since the move began, by ticks of one period each
    double taken_s = 0.0;          ///< since the move began, by the clock; includes late ticks
    std::vector<double> position;  ///< [m or rad]
    std::vector<double> effort;    ///< effort to send: neutral unless the law sets it [N or N·m]
    bool silent = false;           ///< set by the law: nothing is sent in this tick
  };
  /// The effort sent to the device, and the newest sample before it.
  struct Tick {
    std::int64_t monotonic_ns = 0;
    const wh_sample& sample;
    const wh_command& command;
    HostPhase phase = HostPhase::kIdle;
    ReleaseReason reason = ReleaseReason::kNone;  ///< why the guard let go
  };
  /// Called every tick; returns false when the move is done.
  using Law = std::function<Expected<bool>(Now&)>;
  /// What is done with a sample: it is judged, waited for a better one, given to the law unjudged
  /// (the drive says that it let go), or the end of the move.
  enum class Seen { kJudge, kWait, kProve, kOver };
  /// Sees the result and the sample of each read() before it is judged.
  using Look = std::function<Seen(int result, const wh_sample&)>;

  /// Refused: an axis that the driver lacks, and a neutral effort beyond kCommissioningShare.
  [[nodiscard]] static Expected<Bench> make(DeviceDriver& driver, const DeviceModel& model,
                                            Operator& person, TickClock& clock, double period_s);

  /// Waits for the key, enables, moves by the law, ramps to neutral and disables. Refused, each
  /// with its own message: nobody confirmed that no person is attached, the key is not pressed or
  /// was released (also while enabling), and everything that SampleWatch refuses.
  [[nodiscard]] Expected<Done> move(const Motion& motion, const Law& law);
  /// The same, until `look` says that it is over.
  [[nodiscard]] Expected<Done> move(const Motion& motion, const Look& look, const Law& law);
  /// Asks the person while the device is disabled and moved by hand. Refused: the person gave up,
  /// or the device gave no sample.
  /// @param look receives every sample
  [[nodiscard]] Expected<std::string> askWhile(
      const Question& question,
      const std::function<void(const std::vector<double>& position)>& look);
  /// Carries out WH_HOME, which may move the device: only with the key held when it begins. A
  /// device without that verb has absolute encoders. Refused: it fails, or no sample then has
  /// WH_HOMED.
  [[nodiscard]] Expected<Done> home();
  /// As a move: pushes every axis, stops the feeding of the watchdog (where the driver cannot,
  /// sends nothing more), and waits until the drive lets go. Returns that time [s]. Refused: longer
  /// than `longest_s`, not enabled when the silence began, an axis that is pushed on (LetGoProof),
  /// and what a move is refused for.
  [[nodiscard]] Expected<double> dropWatchdog(double longest_s);

  /// Sets a listener, called after every effort that is sent. It must not block.
  void listen(std::function<void(const Tick&)> listener) { listener_ = std::move(listener); }
  /// Axis of the file → index in samples and commands.
  [[nodiscard]] const std::vector<std::size_t>& places() const { return place_; }
  /// Confirms that no person is attached. Without it nothing is enabled.
  void confirmNobodyAttached(bool nobody) { nobody_attached_ = nobody; }
  [[nodiscard]] Expected<std::vector<double>> position();

  [[nodiscard]] DeviceDriver& driver() { return *driver_; }
  [[nodiscard]] const DeviceModel& model() const { return *model_; }
  [[nodiscard]] Operator& person() { return *person_; }
  [[nodiscard]] double period_s() const { return config_.period_s; }
  /// Effort limit of an axis in commissioning [N or N·m].
  [[nodiscard]] double limit(std::size_t axis) const;
  /// Effort sent to an axis in the last tick [N or N·m].
  [[nodiscard]] double sent(std::size_t axis) const { return command_.effort[place_[axis]]; }
  /// The largest effort sent so far over the limit of its axis in the file.
  [[nodiscard]] double largestShare() const { return largest_share_; }

 private:
  Bench(DeviceDriver& driver, const DeviceModel& model, Operator& person, TickClock& clock);
  [[nodiscard]] Diagnostic no(const std::string& axis, const std::string& problem,
                              const std::string& remedy) const;
  [[nodiscard]] Expected<wh_sample> sample();
  [[nodiscard]] std::vector<double> neutral() const;  ///< neutral effort of the file [N or N·m]
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

/// Natural frequency of those springs, by the mass of the device file.
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
/// range; `moved` is 0 where nothing does at kCommissioningShare. No springs hold the axes, because
/// the signs are not known yet.
[[nodiscard]] Expected<Push> pushSlowly(Bench& bench, std::size_t axis, double sign);

/// Effort that balances an axis where it is [N or N·m]: sweeps slowly to and fro and takes the mean
/// of both directions, which cancels dry friction.
[[nodiscard]] Expected<double> carryingEffort(Bench& bench, std::size_t axis,
                                              const std::vector<double>& offset);

/// Drives one axis slowly to a position. Refused: it does not arrive.
[[nodiscard]] Expected<Done> driveTo(Bench& bench, std::size_t axis, double position,
                                     const std::vector<double>& offset);

/// Result of the excitation of one axis (identification/identify_axis.hpp).
struct Excited {
  AxisTrace trace;
  std::vector<double> taken_s;  ///< actual time of each tick
  /// Response of every axis: acceleration times the root of its mass, relative to the excited axis
  /// (1). Two axes coupled by an inertia c respond with c / √(m₁ m₂).
  std::vector<double> response;
};
[[nodiscard]] Expected<Excited> excite(Bench& bench, std::size_t axis,
                                       const std::vector<double>& offset, double duration_s);

}  // namespace wholehand
