#include "devices/commissioning/bench.hpp"

#include "devices/commissioning/identification/identify_axis.hpp"
#include "devices/host/device_host.hpp"
#include "devices/plugin/plugin_device.hpp"

#include <Eigen/QR>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <utility>

namespace wholehand {

namespace {

constexpr double kOfSpeed = 0.5, kOfRange = 0.25;
constexpr double kOverFriction = 2.5;          // a push is this many times the dry friction
constexpr double kActing = 0.5, kMoves = 0.3;  // shares of the push: still acting; shown to act
constexpr std::size_t kLeastPlaces = 8;
constexpr double kStepsMoved = 15.0;

}  // namespace

ReleaseCheck::ReleaseCheck(const DeviceModel& model, double lasts_s, double share)
    : model_(&model), lasts_s_(lasts_s), share_(share) {}

const std::vector<double>& ReleaseCheck::push(const std::vector<double>& position) {
  if (!effort_.empty()) return effort_;
  for (std::size_t i = 0; i < position.size(); ++i) {
    const DeviceAxis& a = model_->axes[i];
    const bool has_weight = std::abs(a.neutral_effort) > 0.01 * a.effort_limit;
    const double towards = has_weight ? a.neutral_effort : 0.5 * (a.lower + a.upper) - position[i];
    const double slow = a.mass * kOfSpeed * a.speed_limit / lasts_s_;
    const double near = a.mass * kOfRange * (a.upper - a.lower) * 2.0 / (lasts_s_ * lasts_s_);
    const double room = share_ * a.effort_limit - std::abs(a.neutral_effort);
    const double most = std::min(std::max(kOverFriction * a.coulomb, std::min(slow, near)), room);
    push_.push_back(std::copysign(most, towards));
    effort_.push_back(a.neutral_effort + push_.back());
  }
  return effort_;
}

void ReleaseCheck::addSample(double at_s, const std::vector<double>& position) {
  if (seen_.empty() || at_s > seen_.back().at_s) seen_.push_back({at_s, position});
}

bool ReleaseCheck::moved() const {
  for (std::size_t i = 0; i < push_.size(); ++i) {
    if (seen_.empty()) return false;
    const double gone = seen_.back().position[i] - seen_.front().position[i];
    if (std::abs(gone) < kStepsMoved * model_->axes[i].encoder_step) return false;
  }
  return true;
}

// Share of the push that acts on the axis, from a parabola fitted through all positions.
double ReleaseCheck::shareActing(std::size_t axis) const {
  const DeviceAxis& a = model_->axes[axis];
  const double middle_s = 0.5 * (seen_.front().at_s + seen_.back().at_s);
  Eigen::MatrixX3d m(static_cast<Eigen::Index>(seen_.size()), 3);
  Eigen::VectorXd q(m.rows());
  for (Eigen::Index k = 0; k < m.rows(); ++k) {
    const Observation& seen = seen_[static_cast<std::size_t>(k)];
    const double t = seen.at_s - middle_s;
    m.row(k) << 1.0, t, 0.5 * t * t;
    q[k] = seen.position[axis] - seen_.front().position[axis];
  }
  const Eigen::Vector3d found = m.colPivHouseholderQr().solve(q);
  const double moved = std::abs(q[q.size() - 1]);
  const double rubs = moved > a.encoder_step ? std::copysign(a.coulomb, found[1]) : 0.0;
  return (a.mass * found[2] + a.damping * found[1] + rubs) / push_[axis];
}

Diagnostics ReleaseCheck::still() const {
  Diagnostics out;
  for (std::size_t i = 0; i < push_.size(); ++i) {
    if (seen_.size() >= kLeastPlaces && shareActing(i) > kMoves) continue;
    const DeviceAxis& a = model_->axes[i];
    out.push_back({model_->path, 0, "axes", a.name,
                   fmt::format("was pushed with {:.3g} {} and did not move with it: nothing would "
                               "show whether that ends",
                               push_[i], a.effortUnit()),
                   "bring it between its ends, look for a brake, and repeat the step"});
  }
  return out;
}

Diagnostics ReleaseCheck::acting(const std::string& when) const {
  Diagnostics out;
  for (std::size_t i = 0; i < push_.size(); ++i) {
    const DeviceAxis& a = model_->axes[i];
    if (seen_.size() < kLeastPlaces) {
      out.push_back(keyFault(model_->path, "axes", a.name, "gave no samples " + when,
                             "let the controller run on, and repeat the step"));
      continue;
    }
    const double share = shareActing(i);
    if (share <= kActing) continue;
    out.push_back(
        keyFault(model_->path, "axes", a.name,
                 fmt::format("is still pushed with about {:.2g} {} {}: only its bits say that its "
                             "motor is off",
                             share * std::abs(push_[i]), a.effortUnit(), when),
                 "let the drive itself take the effort away, and repeat the step"));
  }
  return out;
}

namespace {

constexpr double kSpeedOver_s = 0.01;  // window of the speed check
constexpr double kJump = 3.0;          // times the speed limit; no mechanism is that fast
constexpr std::int64_t kAhead_ns = 1'000'000;

double inSeconds(std::int64_t ns) {
  return static_cast<double>(ns) * 1e-9;
}

constexpr double kKeyWithin_s = 60.0;
constexpr double kKeySeen_s = 0.15;  // timeout until a held key is reported again
constexpr double kPush_s = 0.06;     // shortest push before the watchdog is dropped
constexpr double kLongestPush_s = 0.5;
constexpr double kProve_s = 0.08;    // shortest check after the drive let go
constexpr double kSettles_s = 0.02;  // skipped at the beginning of each part: delay and ramp
constexpr int kRefusedWrites = 20;   // ticks after a refused write in which a sample may give the
                                     // reason

// Informs the person when a motion is over, whatever its result.
class MotionEnd {
 public:
  MotionEnd(Operator& person, const Motion& motion) : person_(person), motion_(motion) {}
  ~MotionEnd() { person_.reportMotion(motion_, MotionState::kOver); }
  MotionEnd(const MotionEnd&) = delete;
  MotionEnd& operator=(const MotionEnd&) = delete;

 private:
  Operator& person_;
  Motion motion_;
};

}  // namespace

SampleWatch::SampleWatch(const DeviceModel& model, std::vector<std::size_t> place, double period_s)
    : model_(&model), place_(std::move(place)), period_s_(period_s) {
  begin();
}

void SampleWatch::begin() {
  seen_.clear();
  start_.clear();
  tick_ = still_ = 0;
  longest_gap_ns_ = 0;
}

Diagnostic SampleWatch::no(const std::string& axis, const std::string& problem,
                           const std::string& remedy) const {
  return {model_->path, 0, axis.empty() ? "" : "axes", axis, problem, remedy};
}

Expected<std::vector<double>> SampleWatch::positions(const wh_sample& sample) const {
  std::vector<double> out;
  for (std::size_t i = 0; i < place_.size(); ++i) {
    const bool valid = (sample.valid >> place_[i] & 1U) != 0;
    if (!valid || !std::isfinite(sample.position[place_[i]])) {
      return no(model_->axes[i].name, "the device gives no position", "look at its encoder");
    }
    out.push_back(sample.position[place_[i]]);
  }
  return out;
}

Expected<Done> SampleWatch::checkStatus(const wh_sample& sample) const {
  if ((sample.status & WH_DRIVE_FAULT) != 0) {
    return no("", fmt::format("a drive is in fault, code {}", sample.vendor_code),
              "clear it as its maker says");
  }
  if ((sample.status & WH_SILENCED) != 0) {
    return no("",
              fmt::format("its watchdog let go; this program was silent for {:.1f} ms at most",
                          1e3 * inSeconds(longest_gap_ns_)),
              "let nothing else run on this machine, and repeat the step");
  }
  if ((sample.status & WH_HOMED) == 0) {
    return no("", "it is not homed any more", "repeat from the step `home` on");
  }
  if ((sample.status & WH_ENABLED) == 0) {
    return no("", "efforts do not reach the motors",
              "release its stop button, and repeat the step");
  }
  return Done{};
}

// A standstill of the samples is counted in ticks, not in time: a stall of this machine is not a
// stall of the device.
Expected<Done> SampleWatch::checkAge(const wh_sample& sample, std::int64_t now_ns) {
  const bool first = tick_ == 0;
  const std::int64_t gap_ns = first ? 0 : now_ns - now_ns_;
  longest_gap_ns_ = std::max(longest_gap_ns_, gap_ns);
  const bool backwards = !first && (sample.sequence < sequence_ || sample.monotonic_ns < taken_ns_);
  const bool fresh = first || sample.sequence > sequence_;
  still_ = fresh ? 0 : still_ + 1;
  sequence_ = sample.sequence;
  taken_ns_ = sample.monotonic_ns;
  now_ns_ = now_ns;
  if (backwards) return no("", "its samples run backwards", "look at the driver");
  if (sample.monotonic_ns > now_ns + kAhead_ns) {
    return no("", "its samples' times lie in the future", "let the driver use CLOCK_MONOTONIC");
  }
  const double old_s = inSeconds(now_ns - sample.monotonic_ns);
  if (fresh && old_s > longestStill_s(*model_) + inSeconds(gap_ns)) {
    return no("", fmt::format("its samples are {:.0f} ms old when they come", 1e3 * old_s),
              "let the driver state when a sample was taken, or use a faster line");
  }
  if (static_cast<double>(still_) * period_s_ <= longestStill_s(*model_)) return Done{};
  return no("", "its samples stand still: nobody knows where it is",
            "look at its cable, and repeat the step");
}

Expected<Done> SampleWatch::checkMotion(std::size_t i, const Observation& now) const {
  const DeviceAxis& axis = model_->axes[i];
  // A person may have left the axis at a stop; it may return from there.
  const double lower = std::min(axis.lower, start_[i]), upper = std::max(axis.upper, start_[i]);
  const double at = now.position[i];
  if (std::max(at - upper, lower - at) > axis.workspace_margin) {
    return no(axis.name, "is beyond its range", "bring it back by hand, and repeat the step");
  }
  if (seen_.empty()) return Done{};
  // Motion since an earlier sample beyond the distance that the speed limit allows between the two
  // times.
  const auto excess = [&](const Observation& then, double times) {
    const double most = times * axis.speed_limit * inSeconds(now.taken_ns - then.taken_ns);
    return std::abs(at - then.position[i]) - most - 3.0 * axis.encoder_step;
  };
  if (excess(seen_.back(), kJump) > 0.0) {
    return no(axis.name, "its encoder jumps", "look at its encoder and the cable");
  }
  const bool long_enough = inSeconds(now.taken_ns - seen_.front().taken_ns) >= kSpeedOver_s;
  if (long_enough && excess(seen_.front(), 1.0) > 0.0) {
    return no(axis.name, "is faster than its speed limit: it runs away",
              "look at its signs, and repeat from the step `signs` on");
  }
  return Done{};
}

Expected<std::vector<double>> SampleWatch::check(const wh_sample& sample, std::int64_t now_ns) {
  const bool same = tick_ > 0 && sample.monotonic_ns == taken_ns_;
  if (auto good = checkAge(sample, now_ns); !good) return good.errors();
  if (auto good = checkStatus(sample); !good) return good.errors();
  Expected<std::vector<double>> position = positions(sample);
  if (!position) return position;
  if (start_.empty()) start_ = *position;
  ++tick_;
  if (same) return position;
  const Observation now{sample.monotonic_ns, *position};
  for (std::size_t i = 0; i < place_.size(); ++i) {
    if (auto good = checkMotion(i, now); !good) return good.errors();
  }
  const auto old = [&](const Observation& then) {
    return inSeconds(now.taken_ns - then.taken_ns) >= kSpeedOver_s;
  };
  seen_.push_back(now);
  while (seen_.size() > 1 && old(seen_[1])) seen_.pop_front();
  return position;
}

Bench::Bench(DeviceDriver& driver, const DeviceModel& model, Operator& person, TickClock& clock)
    : driver_(&driver), model_(&model), person_(&person), clock_(&clock), watch_(model, {}, 1e-3) {}

Diagnostic Bench::no(const std::string& axis, const std::string& problem,
                     const std::string& remedy) const {
  return {model_->path, 0, axis.empty() ? "" : "axes", axis, problem, remedy};
}

Expected<Bench> Bench::make(DeviceDriver& driver, const DeviceModel& model, Operator& person,
                            TickClock& clock, double period_s) {
  Bench bench(driver, model, person, clock);
  Diagnostics out;
  for (const DeviceAxis& axis : model.axes) {
    const auto found = std::find_if(driver.axes().begin(), driver.axes().end(),
                                    [&](const wh_axis& has) { return axis.name == has.name; });
    if (found == driver.axes().end()) {
      out.push_back(bench.no(axis.name, driver.where() + " has no such axis",
                             "name the axes as the driver does"));
    }
    bench.place_.push_back(found - driver.axes().begin());
    if (std::abs(axis.neutral_effort) > kCommissioningShare * axis.effort_limit) {
      out.push_back(bench.no(axis.name,
                             "its neutral effort is more than a fifth of its effort limit",
                             "balance the axis: commissioning may not use more"));
    }
  }
  if (!out.empty()) return out;
  bench.config_ = guardConfig(driver, model, period_s);
  bench.whole_limit_ = bench.config_.limit;
  bench.allow(kCommissioningShare);
  bench.config_.ramp.ramp_s = kCommissioningRamp_s;
  bench.watch_ = SampleWatch(model, bench.place_, period_s);
  bench.guard_ = endSession(bench.guard_, bench.config_);
  bench.command_.size = sizeof(bench.command_);
  bench.command_.axes = static_cast<std::uint32_t>(driver.axes().size());
  return bench;
}

void Bench::allow(double share) {
  for (int i = 0; i < config_.limit.size(); ++i) config_.limit[i] = share * whole_limit_[i];
}

double Bench::limit(std::size_t axis) const {
  return kCommissioningShare * model_->axes[axis].effort_limit;
}

Expected<wh_sample> Bench::sample() {
  wh_sample sample{};
  if (driver_->read(sample) < 0) return no("", "the device gives no sample", "look at its cable");
  newest_ = sample;
  return sample;
}

std::vector<double> Bench::neutral() const {
  std::vector<double> out;
  for (const DeviceAxis& axis : model_->axes) out.push_back(axis.neutral_effort);
  return out;
}

Expected<std::vector<double>> Bench::position() {
  const Expected<wh_sample> now = sample();
  if (!now) return now.errors();
  return watch_.positions(*now);
}

Expected<Done> Bench::awaitKey(const Motion& motion) {
  if (!nobody_attached_) {
    return no("", "nobody has confirmed that nobody is attached", "do the step `home` first");
  }
  if (!person_->holdsKey()) person_->reportMotion(motion, MotionState::kAwaitsKey);
  for (double waited_s = 0.0; !person_->holdsKey(); waited_s += config_.period_s) {
    if (person_->gaveUp()) {
      return no("", "no key can be held: the person gave up, or there is no terminal",
                "repeat the step at a terminal");
    }
    if (waited_s > kKeyWithin_s) return no("", "the key was not held", "repeat the step");
    clock_->waitForTick();
  }
  person_->reportMotion(motion, MotionState::kMoves);
  return Done{};
}

// Enabling may take long, so a key press from before it no longer counts.
Expected<Done> Bench::keyStillHeld() {
  for (double waited_s = 0.0; !person_->holdsKey(); waited_s += config_.period_s) {
    if (waited_s > kKeySeen_s || person_->gaveUp()) {
      return no("", "the key was let go", "repeat the step");
    }
    if (auto sent = send(neutral(), ReleaseReason::kNone); !sent) return sent;
    clock_->waitForTick();
  }
  return Done{};
}

Expected<Done> Bench::enable() {
  if (!nobody_attached_) {
    return no("", "nobody has confirmed that nobody is attached", "do the step `home` first");
  }
  if (auto done = driver_->enable(neutralOf(config_)); !done) {
    (void)driver_->control(WH_DISABLE, 0.0);  // it may be partly enabled
    return done;
  }
  guard_ = beginSession(++sessions_, clock_->now_ns(), config_);
  return Done{};
}

Expected<Done> Bench::send(const std::vector<double>& effort, ReleaseReason let_go) {
  HostCommand command{};
  command.session = guard_.session;
  command.sequence = guard_.sequence + 1;
  command.monotonic_ns = clock_->now_ns();
  command.axes = command_.axes;
  for (std::size_t i = 0; i < place_.size(); ++i) command.effort[place_[i]] = effort[i];
  guard_ = advanceGuard(guard_, &command, let_go, 1, clock_->now_ns(), config_);
  ++command_.sequence;
  for (int i = 0; i < config_.neutral.size(); ++i) {
    command_.effort[i] = guard_.ramp.sent[i];
  }
  for (std::size_t i = 0; i < place_.size(); ++i) {
    largest_share_ = std::max(largest_share_,
                              std::abs(command_.effort[place_[i]]) / model_->axes[i].effort_limit);
  }
  const bool taken = driver_->write(command_) >= 0;
  if (listener_) listener_({clock_->now_ns(), newest_, command_, guard_.phase, guard_.reason});
  if (!taken) {
    return no("", "the device refuses an effort", "look at the device, and repeat the step");
  }
  if (guard_.phase != HostPhase::kRendering && let_go == ReleaseReason::kNone) {
    return no("", fmt::format("the guard let go: {}", describe(guard_.reason)),
              "let nothing else run on this machine, and repeat the step");
  }
  return Done{};
}

Expected<Done> Bench::letGo() {
  for (int i = 0; guard_.phase != HostPhase::kLatched && i < 1000; ++i) {
    if (!send(neutral(), ReleaseReason::kLoopEnded)) break;
    clock_->waitForTick();
  }
  guard_ = endSession(guard_, config_);
  return driver_->control(WH_DISABLE, 0.0);
}

Expected<Done> Bench::guarded(const Look& look, const Law& law) {
  if (auto held = keyStillHeld(); !held) return held;
  watch_.begin();
  const std::int64_t began_ns = clock_->now_ns();
  int refused = 0;
  for (std::size_t tick = 0;; ++tick) {
    if (!person_->holdsKey()) return no("", "the key was let go", "repeat the step");
    Now now;
    now.time_s = static_cast<double>(tick) * config_.period_s;
    now.taken_s = static_cast<double>(clock_->now_ns() - began_ns) * 1e-9;
    now.effort = neutral();
    const Expected<wh_sample> read = sample();
    const SampleUse seen = look(read ? WH_OK : WH_FAILED, newest_);
    if (seen == SampleUse::kOver) return Done{};
    if (seen == SampleUse::kCheck || seen == SampleUse::kProve) {
      if (!read) return read.errors();
      Expected<std::vector<double>> position = seen == SampleUse::kCheck
                                                   ? watch_.check(*read, clock_->now_ns())
                                                   : watch_.positions(*read);
      if (!position) return position.errors();
      now.position = std::move(*position);
      const Expected<bool> goes_on = law(now);
      if (!goes_on) return goes_on.errors();
      if (!*goes_on) return Done{};
    }
    Expected<Done> sent = now.silent ? Done{} : send(now.effort, ReleaseReason::kNone);
    refused = sent || seen == SampleUse::kProve ? 0 : refused + 1;
    if (refused > kRefusedWrites) return sent;
    clock_->waitForTick();
  }
}

Expected<Done> Bench::move(const Motion& motion, const Look& look, const Law& law) {
  const MotionEnd end(*person_, motion);
  if (auto held = awaitKey(motion); !held) return held;
  if (auto enabled = enable(); !enabled) return enabled;
  Expected<Done> done = guarded(look, law);
  const Expected<Done> off = letGo();
  if (off) return done;
  Diagnostics all = done ? Diagnostics{} : done.errors();
  all.push_back(
      no("", "it may still be enabled: " + format(off.errors()), "press its emergency stop"));
  return all;
}

Expected<Done> Bench::move(const Motion& motion, const Law& law) {
  return move(
      motion, [](int, const wh_sample&) { return SampleUse::kCheck; }, law);
}

Expected<std::string> Bench::askWhile(
    const Question& question,
    const std::function<void(const std::vector<double>& position)>& look) {
  Expected<Done> seen = Done{};
  const auto answer = person_->ask(question, [&] {
    const Expected<std::vector<double>> now = position();
    if (!now) seen = now.errors();
    if (now) look(*now);
  });
  if (!answer) return no("", "the person gave up", "repeat the step");
  if (!seen) return seen.errors();
  return *answer;
}

Expected<Done> Bench::home() {
  const Motion motion{MotionKind::kHoming,
                      "it may home itself; then only its emergency stop ends that", "", 0.0};
  const MotionEnd end(*person_, motion);
  if (auto held = awaitKey(motion); !held) return held;
  Expected<Done> homed = driver_->control(WH_HOME, 0.0);
  const auto has_no_way = [](const Diagnostic& d) {
    return d.problem.find(kUnsupportedPrefix) != std::string::npos;
  };
  if (!homed && !std::all_of(homed.errors().begin(), homed.errors().end(), has_no_way)) {
    return homed;
  }
  const Expected<wh_sample> now = sample();
  if (!now) return now.errors();
  if ((now->status & WH_HOMED) != 0) return Done{};
  return no("", "it does not say that it is homed", "home it as its maker says");
}

Expected<double> Bench::dropWatchdog(double longest_s) {
  ReleaseCheck proof(*model_, kPush_s + longest_s + kProve_s, kCommissioningShare);
  bool begun = false, dropped = false, let_go = false;
  std::int64_t began_ns = 0, let_go_ns = 0;
  double passed_s = 0.0, prove_s = kProve_s;
  const auto since_s = [&](std::int64_t then_ns) {
    return static_cast<double>(clock_->now_ns() - then_ns) * 1e-9;
  };
  const Look look = [&](int result, const wh_sample& now) {
    if (!begun) return SampleUse::kCheck;
    if (let_go) return result < 0 ? SampleUse::kOver : SampleUse::kProve;
    // Measured by the clock, not in ticks: this machine may be late, and the measured silence must
    // not be too short.
    passed_s = since_s(began_ns);
    if (result < 0 || passed_s > longest_s) return SampleUse::kOver;
    let_go = (now.status & WH_SILENCED) != 0 || (now.status & WH_ENABLED) == 0;
    if (let_go) let_go_ns = clock_->now_ns();
    return let_go ? SampleUse::kProve : SampleUse::kCheck;
  };
  const Law law = [&](Now& now) -> Expected<bool> {
    const double sample_s = static_cast<double>(newest_.monotonic_ns) * 1e-9;
    now.effort = proof.push(now.position);
    if (let_go) {
      now.silent = true;
      if (since_s(let_go_ns) > kSettles_s) proof.addSample(sample_s, now.position);
      return since_s(let_go_ns) < prove_s;
    }
    // If the driver cannot stop feeding the watchdog, sending nothing has the same effect.
    now.silent = begun && !dropped;
    if (!begun && now.taken_s > kSettles_s) proof.addSample(sample_s, now.position);
    if (begun || now.taken_s < kPush_s) return true;
    if (!proof.moved() && now.taken_s < kLongestPush_s) return true;
    prove_s = std::max(kProve_s, now.taken_s);  // at least as long as the push took to show motion
    if (Diagnostics still = proof.still(); !still.empty()) return still;
    proof.forget();
    begun = true;
    dropped = driver_->control(WH_DROP_WATCHDOG, 0.0).ok();
    began_ns = clock_->now_ns();
    if (dropped || !driver_->holds()) return true;
    return no("", "the driver cannot drop its watchdog, and behind a host silence is the host's",
              "let the driver know WH_DROP_WATCHDOG, or commission it with --driver");
  };
  const Motion motion{MotionKind::kWatchdog, "the watchdog is pulled", "", 0.0};
  if (auto held = move(motion, look, law); !held) return held.errors();
  if (let_go) {
    Diagnostics acting = proof.acting("after its watchdog let go");
    if (!acting.empty()) return acting;
    return passed_s;
  }
  return no("", fmt::format("the drive's watchdog did not let go within {:.3f} s", longest_s),
            "switch it on in the drive: without it the last effort stays when the program dies");
}

namespace {

constexpr double kDampingRatio = 0.7;
constexpr double kFilter_s = 0.004;   // time constant of the speed filter
constexpr double kPushGrows_s = 1.5;  // time from zero to the allowed share
constexpr double kMoved = 0.02;       // share of the range that counts as motion
constexpr double kSweep = 0.04;       // amplitude as a share of the range
constexpr double kSweep_s = 1.2;      // time for each direction
constexpr double kDrive_s = 2.5;      // time to drive over the whole range
constexpr double kArrived = 0.02;     // share of the range
constexpr double kArrive_s = 3.0;     // timeout for the arrival at the target
constexpr double kIntegral_per_s = 3.0;
constexpr double kSmooth = 0.1;  // filter share per tick

double rangeOf(const DeviceAxis& axis) {
  return axis.upper - axis.lower;
}

Diagnostic refuse(const Bench& bench, std::size_t axis, const std::string& problem,
                  const std::string& remedy) {
  return {bench.model().path, 0, "axes", bench.model().axes[axis].name, problem, remedy};
}

}  // namespace

SoftHold::SoftHold(const Bench& bench, std::vector<double> offset)
    : bench_(&bench), offset_(std::move(offset)), speed_(offset_.size(), 0.0) {}

double SoftHold::effort(std::size_t axis, double target_speed) const {
  const double w = 2.0 * std::numbers::pi * kSpring_hz;
  const double mass = bench_->model().axes[axis].mass;
  return offset_[axis] + mass * w * w * (target[axis] - position_[axis]) +
         2.0 * kDampingRatio * mass * w * (target_speed - speed_[axis]);
}

void SoftHold::hold(Bench::Now& now) {
  if (target.empty()) target = now.position;
  if (last_.empty()) last_ = now.position;
  // A late tick covers a longer motion.
  const double t = std::max(bench_->period_s(), now.taken_s - last_s_);
  last_s_ = now.taken_s;
  position_ = now.position;
  for (std::size_t i = 0; i < position_.size(); ++i) {
    speed_[i] = (kFilter_s * speed_[i] + (position_[i] - last_[i])) / (kFilter_s + t);
    now.effort[i] = effort(i);
  }
  last_ = position_;
}

Expected<Push> pushSlowly(Bench& bench, std::size_t axis, double sign) {
  std::vector<double> start;
  Push push;
  const auto done = bench.move(
      {MotionKind::kPush,
       fmt::format("axis {} is pushed in {} direction", bench.model().axes[axis].name,
                   sign > 0.0 ? '+' : '-'),
       bench.model().axes[axis].name, kPushGrows_s},
      [&](Bench::Now& now) -> Expected<bool> {
        if (start.empty()) start = now.position;
        push.moved = 0.0;
        for (std::size_t i = 0; i < start.size(); ++i) {
          const double moved = (now.position[i] - start[i]) / rangeOf(bench.model().axes[i]);
          if (std::abs(moved) > std::abs(push.moved)) push.axis = i, push.moved = moved;
        }
        if (std::abs(push.moved) > kMoved) return false;
        push.share = kCommissioningShare * now.time_s / kPushGrows_s;
        if (push.share > kCommissioningShare) {
          push.moved = 0.0;
          return false;
        }
        now.effort[axis] += sign * push.share * bench.model().axes[axis].effort_limit;
        return true;
      });
  if (!done) return done.errors();
  return push;
}

Expected<double> carryingEffort(Bench& bench, std::size_t axis, const std::vector<double>& offset) {
  SoftHold hold(bench, offset);
  double integral = 0.0, centre = 0.0;
  std::array<double, 2> sum{};
  std::array<int, 2> count{};
  const DeviceAxis& a = bench.model().axes[axis];
  const double reach = kSweep * rangeOf(a);
  const auto done = bench.move(
      {MotionKind::kCarry, "what carries axis " + a.name + " is measured", a.name, 5.0 * kSweep_s},
      [&](Bench::Now& now) -> Expected<bool> {
        hold.hold(now);
        if (now.time_s == 0.0) {
          centre = std::clamp(now.position[axis], a.lower + 2.0 * reach, a.upper - 2.0 * reach);
        }
        // Settle, up, down, up, down; the second half of each leg is evaluated.
        const double legs = now.time_s / kSweep_s - 1.0;
        if (legs >= 4.0) return false;
        const int leg = static_cast<int>(std::floor(legs));
        const bool up = leg % 2 == 0;
        const double part = legs - leg;
        const double goal =
            centre + (leg < 0 ? -reach : (up ? 2.0 * part - 1.0 : 1.0 - 2.0 * part) * reach);
        const double wanted_speed = leg < 0 ? 0.0 : (up ? 2.0 : -2.0) * reach / kSweep_s;
        // Begins at the present position, so that the target does not jump.
        hold.target[axis] += (goal - hold.target[axis]) * std::min(1.0, bench.period_s() / 0.05);
        const double w = 2.0 * std::numbers::pi * kSpring_hz;
        integral += kIntegral_per_s * a.mass * w * w * (hold.target[axis] - now.position[axis]) *
                    bench.period_s();
        integral = std::clamp(integral, -bench.limit(axis), bench.limit(axis));
        const double effort = std::clamp(hold.effort(axis, wanted_speed) + integral,
                                         -bench.limit(axis), bench.limit(axis));
        now.effort[axis] = effort;
        if (leg >= 0 && part > 0.5) {
          sum.at(up ? 0 : 1) += effort;
          ++count.at(up ? 0 : 1);
        }
        return true;
      });
  if (!done) return done.errors();
  return 0.5 * (sum[0] / count[0] + sum[1] / count[1]);
}

Expected<Done> driveTo(Bench& bench, std::size_t axis, double position,
                       const std::vector<double>& offset) {
  SoftHold hold(bench, offset);
  double integral = 0.0, arrived_s = 0.0;
  const DeviceAxis& a = bench.model().axes[axis];
  return bench.move(
      {MotionKind::kDrive,
       fmt::format("axis {} is driven to {:.4g} {}", a.name, position, a.positionUnit()), a.name,
       0.0},
      [&](Bench::Now& now) -> Expected<bool> {
        hold.hold(now);
        const double speed = rangeOf(a) / kDrive_s, step = speed * bench.period_s();
        const double left = position - hold.target[axis];
        hold.target[axis] += std::clamp(left, -step, step);
        const double w = 2.0 * std::numbers::pi * kSpring_hz;
        integral += kIntegral_per_s * a.mass * w * w * (hold.target[axis] - now.position[axis]) *
                    bench.period_s();
        integral = std::clamp(integral, -0.5 * bench.limit(axis), 0.5 * bench.limit(axis));
        const double towards = std::abs(left) > step ? std::copysign(speed, left) : 0.0;
        now.effort[axis] = hold.effort(axis, towards) + integral;
        if (std::abs(now.position[axis] - position) < kArrived * rangeOf(a)) return false;
        if (std::abs(left) < step) arrived_s += bench.period_s();
        if (arrived_s < kArrive_s) return true;
        return refuse(bench, axis,
                      fmt::format("does not get to {:.4g} {}: it stops at {:.4g}", position,
                                  a.positionUnit(), now.position[axis]),
                      "state the range that it has, or clear its way");
      });
}

Expected<AxisExcitation> excite(Bench& bench, std::size_t axis, const std::vector<double>& offset,
                                double duration_s) {
  const DeviceAxis& a = bench.model().axes[axis];
  ExcitationPlan plan{bench.period_s(),  a.lower,      a.upper,   a.mass,
                      bench.limit(axis), offset[axis], duration_s};
  Excitation excitation(plan);
  SoftHold hold(bench, offset);
  AxisExcitation out;
  TransportLog transport(bench.period_s());
  out.trace.period_s = bench.period_s();
  const std::size_t axes = offset.size();
  std::vector<double> before, filtered(axes, 0.0);
  out.response.assign(axes, 0.0);
  const auto done = bench.move(
      {MotionKind::kMeasure, fmt::format("axis {} is measured for {:.0f} s", a.name, duration_s),
       a.name, duration_s},
      [&](Bench::Now& now) -> Expected<bool> {
        hold.hold(now);
        bench.note(transport);
        if (!out.trace.position.empty()) out.trace.effort.push_back(bench.sent(axis));
        if (excitation.done()) return false;
        out.trace.posture.push_back(excitation.posture());
        now.effort[axis] = excitation.next(now.position[axis]);
        out.trace.position.push_back(now.position[axis]);
        out.taken_s.push_back(now.taken_s);
        out.given.push_back(bench.measuredEffort(axis));
        if (before.empty()) before = now.position;
        // Compares accelerations, which show inertial coupling.
        for (std::size_t i = 0; i < axes; ++i) {
          const double change = kSmooth * (now.position[i] - before[i] - filtered[i]);
          filtered[i] += change;
          out.response[i] += bench.model().axes[i].mass * change * change;
        }
        before = now.position;
        return true;
      });
  if (!done) return done.errors();
  out.transport_s = transport.within(0.5).both_s();
  const double own = std::max(out.response[axis], 1e-300);
  for (double& r : out.response) r = std::sqrt(r / own);
  return out;
}

}  // namespace wholehand
