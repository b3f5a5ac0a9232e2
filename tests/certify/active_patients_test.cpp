// Certified gains with patients who are not passive. One axis of the renderer, built from the
// functions of the tick, runs on a device that a spastic or a fighting arm pushes about. The test
// does not claim that the arm comes to rest: the efforts stay within their limits and fall to
// neutral when they must.
#include "certified_sets.hpp"
#include "loop/control/adaptive_damping.hpp"
#include "loop/control/axis_simulation.hpp"
#include "loop/control/bilateral_coupling.hpp"
#include "loop/safety/force_limiter.hpp"
#include "loop/safety/neutral_ramp.hpp"
#include "support/constants.hpp"
#include "support/figure.hpp"

#include <deque>

namespace wholehand::test {
namespace {

constexpr int kPatientTicks = 1500;

enum class Habit { kReflex, kFight };

/// An active arm. Its force never exceeds that of a strong person.
class ActiveArm {
 public:
  ActiveArm(Habit habit, Draw& draw)
      : habit_(habit),
        gain_(draw.between(300.0, 30000.0)),
        threshold_m_s_(0.05 + 0.1 * draw.unit()),
        from_m_(0.02 * (2.0 * draw.unit() - 1.0)),
        strength_n_(draw.between(10.0, 60.0)),
        frequency_hz_(draw.between(0.3, 6.0)),
        sway_n_(draw.between(1.0, 25.0)) {}

  double force(double x, double v, double felt, double time_s) {
    const double sway = sway_n_ * std::sin(2.0 * std::numbers::pi * frequency_hz_ * time_s);
    if (habit_ == Habit::kFight) {  // with the motion, or against the effort at rest
      return sway + strength_n_ * (v > 0.0 ? 0.5 : -0.5) -
             0.5 * std::clamp(felt, -strength_n_, strength_n_);
    }
    // Velocity-dependent stretch reflex: 40 ms of nerve, 30 ms of muscle (first order).
    seen_.push_back(v);
    if (seen_.size() <= 40) return sway;
    const double late = seen_.front();
    seen_.pop_front();
    const double wanted = gain_ * std::max(0.0, late - threshold_m_s_) * std::max(0.0, x - from_m_);
    muscle_n_ += kPeriod_s / 0.03 * (std::min(wanted, strength_n_) - muscle_n_);
    return sway - muscle_n_;
  }

 private:
  Habit habit_;
  double gain_, threshold_m_s_, from_m_, strength_n_, frequency_hz_, sway_n_;
  double muscle_n_ = 0.0;
  std::deque<double> seen_;
};

/// The tick of one axis, in the renderer's order.
class OneAxisTick {
 public:
  OneAxisTick(const CertifiedSet& set, double carried)
      : limit(1, set.gains.axis.effort_limit),
        most_change(1, kPeriod_s * std::max(1.02 * requiredSlew(set.gains),
                                            40.0 * set.gains.axis.effort_limit)),
        neutral(1, carried),
        loop_(set.gains.loop(1.0)),
        wall_(set.wall()),
        gains_(gainsOf(loop_)),
        tank_config_(tankOf(loop_)),
        tank_(fullTank(tank_config_)),
        ramp_(engageFrom(neutral)) {
    damping_config_ = {
        1,          AxisEffort(1, 0.5), AxisEffort(1, 5.0), AxisTime(1, 0.3), AxisFlag(1, true),
        AxisFlag(1)};
    damping_ = {AxisRatio(1), AxisRatio(1)};
  }

  double send(double x, double xs, double vs, bool stop) {
    const AxisPosition q_m(1, x), q_s(1, xs);
    const AxisVelocity qd_s(1, vs);
    velocity_ = estimateVelocity(velocity_, q_m, gains_, 1, kPeriod_s);
    const double vf = velocity_.filtered[0];
    const double depth = std::max(0.0, x - 0.005);
    const double push = wall_.stiffness * depth + wall_.damping * vf;
    const double felt =
        couplingEffort(q_m, velocity_.filtered, q_s, qd_s, dampingOf(loop_), gains_)[0] +
        (depth > 0.0 ? -std::clamp(push, 0.0, 0.7 * limit[0]) : 0.0);  // Eq. (15) at α = 1
    damping_ = adaptDamping(damping_, AxisEffort(1, felt), damping_config_, 1, kPeriod_s);
    const EnergyTankStep step =
        advanceTank(tank_, q_m, q_s, AxisEnergy(1, 0.5 * wall_.stiffness * depth * depth), {},
                    gains_, tank_config_, limit, 1, kPeriod_s);
    const double wanted = felt - damping_.phi[0] * gains_.k_dm[0] * vf + step.effort[0];
    const LimitedEffort limited = limitEffort(AxisEffort(1, wanted), limit);
    faults |= limited.faults;
    slew_.note(ramp_.sent);
    ramp_ = advanceRamp(ramp_, limited.effort, neutral, stop ? StopAsked::kPlain : StopAsked::kNone,
                        1, kPeriod_s, {});
    ramp_.sent = limitSlew(ramp_.sent, slew_, most_change).effort;
    tank_ = recordSent(step.state, AxisEffort(1, ramp_.sent[0] - neutral[0]),
                       avatarEffort(q_m, velocity_.filtered, q_s, qd_s, dampingOf(loop_), gains_),
                       limit);
    drive_per_s2 = loop_.k_ps_per_s2 * (x - xs) + loop_.k_ds_per_s * (vf - vs);
    return ramp_.sent[0];
  }

  AxisEffort limit, most_change, neutral;
  Fault faults = Fault::kNone;
  double drive_per_s2 = 0.0;

 private:
  AxisLoop loop_;
  WallCase wall_;
  CouplingGains gains_;
  EnergyTankConfig tank_config_;
  EnergyTankState tank_;
  NeutralRampState ramp_;
  SlewWindow slew_;
  AdaptiveDampingConfig damping_config_;
  AdaptiveDampingState damping_;
  VelocityState velocity_;
};

struct TrialOutcome {
  double over_limit = 0.0;  ///< largest excess of an effort over its limit [N]
  double over_slew = 0.0;   ///< largest excess of a change over its limit [N]
  int ticks_to_neutral = 0;
  bool stays_neutral = true, finite = true, stopped_by_itself = false;
  double fastest_m_s = 0.0;
};

TrialOutcome live(const CertifiedSet& set, Habit habit, Draw& draw) {
  OneAxisTick tick(set, 4.0 * draw.unit() - 2.0);
  ActiveArm arm(habit, draw);
  const AxisLoop l = set.gains.loop(0.0);
  const HeldMotion motion(l.mass + draw.between(0.1, 3.0), l.damping + draw.between(0.5, 20.0),
                          draw.between(10.0, 600.0), kPeriod_s);
  const double kind = draw.unit();
  const double held_mass = kind > 0.6 ? draw.between(0.1, 20.0) : 0.0;
  const int stop_at = 250 + draw.upTo(kPatientTicks - 250 - 2 * kNeutralWithin);
  std::deque<double> queue(static_cast<std::size_t>(l.delay_ticks), tick.neutral[0]);
  double x = 0.0, v = 0.0, xs = 0.0, vs = 0.0, last = tick.neutral[0];
  TrialOutcome seen;
  bool neutral = false;
  for (int k = 0; k < kPatientTicks; ++k) {
    const double sent = tick.send(x, xs, vs, k >= stop_at);
    seen.over_limit = std::max(seen.over_limit, std::abs(sent) - tick.limit[0]);
    seen.over_slew = std::max(seen.over_slew, std::abs(sent - last) - tick.most_change[0]);
    last = sent;
    if (k >= stop_at && !neutral) {
      ++seen.ticks_to_neutral;
      neutral = sent == tick.neutral[0];
    } else if (k >= stop_at) {
      seen.stays_neutral = seen.stays_neutral && sent == tick.neutral[0];
    }
    queue.push_back(sent);
    const double acting = queue.front() - tick.neutral[0];  // the neutral part carries the device
    queue.pop_front();
    if (kind > 0.3) {  // otherwise a stop holds the avatar
      vs += kPeriod_s * tick.drive_per_s2 / (1.0 + held_mass);
      xs += kPeriod_s * vs;
    }
    const double force = arm.force(x, v, acting, k * kPeriod_s);
    motion.advance(x, v, acting + force);
    seen.finite = seen.finite && std::isfinite(sent + x + v + xs + vs);
    seen.fastest_m_s = std::max(seen.fastest_m_s, std::abs(v));
  }
  seen.stopped_by_itself = any(tick.faults & Fault::kNonFiniteEffort);
  return seen;
}

void expectGentle(Habit habit, const char* name, unsigned stream) {
  Draw draw(stream);
  double over_limit = 0.0, over_slew = 0.0, fastest = 0.0;
  int number = 0, slowest = 0;
  for (const CertifiedSet& set : certifiedSets()) {
    const TrialOutcome seen = live(set, habit, draw);
    EXPECT_LE(seen.over_limit, 0.0) << name << " set " << number;
    EXPECT_LE(seen.over_slew, 1e-9) << name << " set " << number;
    EXPECT_LE(seen.ticks_to_neutral, kNeutralWithin) << name << " set " << number;
    EXPECT_TRUE(seen.stays_neutral) << name << " set " << number;
    EXPECT_TRUE(seen.finite && !seen.stopped_by_itself) << name << " set " << number;
    over_limit = std::max(over_limit, seen.over_limit);
    over_slew = std::max(over_slew, seen.over_slew);
    slowest = std::max(slowest, seen.ticks_to_neutral);
    fastest = std::max(fastest, seen.fastest_m_s);
    ++number;
  }
  figure(std::string("certified sets with a patient who ") + name, number, "sets");
  figure("  most over the effort limit", over_limit, "N");
  figure("  most over the slew limit, in a tick", over_slew, "N");
  figure("  slowest to neutral on a stop", slowest, "ms");
  figure("  fastest the device was moved", fastest, "m/s");
  EXPECT_GT(fastest, 0.5) << "the patient hardly moved";
}

TEST(CertifiedGains, PatientWithAStretchReflex_StaysWithinTheLimitsAndIsLetGo) {
  expectGentle(Habit::kReflex, "has a stretch reflex", 75);
}
TEST(CertifiedGains, PatientWhoFights_StaysWithinTheLimitsAndIsLetGo) {
  expectGentle(Habit::kFight, "fights", 76);
}

}  // namespace
}  // namespace wholehand::test
