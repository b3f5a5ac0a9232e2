#include "loop/control/energy_tank.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

// Length d in Ê = f̂ d/2.
constexpr double kPush_m = 5e-3, kPush_rad = 0.05;
constexpr int kRing = kMostDelayTicks + 2;
constexpr double kFilter_s = 2e-3;  // time constant of the low-pass for v
// Largest damping, as a fraction of m / ((1 + n) T + kFilter_s).
constexpr double kMostDamping = 0.4;
constexpr double kCountShare = 0.02;  // largest effort of one encoder count, as a fraction of f̂

// Energy stored in the coupling's spring when its effort is clamped to the limit.
double storedIn(double stiffness, double stretch, double limit) noexcept {
  const double e = std::abs(stretch);
  if (stiffness * e < limit) return 0.5 * stiffness * e * e;
  return limit * e - 0.5 * limit * limit / stiffness;
}

double pushOf(const DeviceAxis& axis) noexcept {
  if (axis.kind == AxisKind::kTranslation) return kPush_m;
  return axis.lever_arm_m > 0.0 ? kPush_m / axis.lever_arm_m : kPush_rad;
}

double mostDamping(const DeviceAxis& axis, int delay_ticks, double period_s) noexcept {
  const double rings = kMostDamping * axis.mass / ((1.0 + delay_ticks) * period_s + kFilter_s);
  if (!(axis.encoder_step > 0.0)) return rings;
  return std::min(rings,
                  kCountShare * axis.effort_limit * (kFilter_s + period_s) / axis.encoder_step);
}

// Damping that dissipates a tank's debt within this tick, at most `most`.
double dampingFor(double debt_j, double speed_sq, double elapsed_s, double most) noexcept {
  return std::min(debt_j / (speed_sq * elapsed_s), most);
}

// Dissipates the debt of the hand's tank by all axes, each with the same share of its largest
// damping.
void dampHand(const EnergyTankState& state, const EnergyTankConfig& config, double elapsed_s,
              AxisEffort& effort) noexcept {
  double power_w = 0.0;
  for (int i = 0; i < config.axes; ++i) {
    power_w += config.most_damping[i] * state.velocity[i] * state.velocity[i];
  }
  if (!(state.hand < 0.0) || power_w == 0.0) return;
  const double share = std::min(-state.hand / (power_w * elapsed_s), 1.0);
  for (int i = 0; i < config.axes; ++i) {
    const double damping = -share * config.most_damping[i] * state.velocity[i];
    if (std::abs(damping) > std::abs(effort[i])) effort[i] = damping;
  }
}

}  // namespace

EnergyTankConfig makeEnergyTank(const DeviceModel& device, double period_s) {
  EnergyTankConfig config;
  config.axes = device.axisCount();
  config.delay_ticks = std::clamp(device.output_delay_ticks, 0, kMostDelayTicks);
  config.capacity = AxisEnergy(config.axes);
  config.device_damping = config.most_damping = AxisDamping(config.axes);
  config.encoder_step = AxisPosition(config.axes);
  for (int i = 0; i < config.axes; ++i) {
    const DeviceAxis& axis = device.axes[i];
    config.capacity[i] = 0.5 * axis.effort_limit * pushOf(axis);
    config.device_damping[i] = axis.damping;
    config.most_damping[i] = mostDamping(axis, device.output_delay_ticks, period_s);
    config.encoder_step[i] = axis.encoder_step;
    config.hand_capacity += config.capacity[i];
  }
  return config;
}

EnergyTankState fullTank(const EnergyTankConfig& config) noexcept {
  EnergyTankState state;
  state.energy = config.capacity;
  state.hand = config.hand_capacity;
  state.stored = AxisEnergy(config.axes);
  state.q_m = state.q_s = AxisPosition(config.axes);
  state.velocity = AxisVelocity(config.axes);
  state.avatar = AxisEffort(config.axes);
  state.sent.fill(AxisEffort(config.axes));
  state.pushed.fill(AxisEffort(config.axes));
  return state;
}

EnergyTankStep advanceTank(const EnergyTankState& state, const AxisPosition& q_m,
                           const AxisPosition& q_s, const AxisEnergy& wall_stored,
                           const WorldEnergy& world, const CouplingGains& gains,
                           const EnergyTankConfig& config, const AxisEffort& effort_limit,
                           int elapsed_periods, double period_s) noexcept {
  EnergyTankStep out{state, AxisEffort(config.axes)};
  const double elapsed_s = elapsed_periods * period_s;
  const auto at = [&state](int ticks_ago) { return (state.newest + kRing - ticks_ago) % kRing; };
  const AxisEffort& acted = state.sent[at(config.delay_ticks)];
  const AxisEffort& before = state.sent[at(config.delay_ticks + 1)];
  const AxisEffort& pushed = state.pushed[at(config.delay_ticks)];
  double given_by_hand = 0.0;
  for (int i = 0; i < config.axes; ++i) {
    const double wall = i < wall_stored.size() ? wall_stored[i] : 0.0;
    const double stored = storedIn(gains.k_pm[i], q_m[i] - q_s[i], effort_limit[i]) + wall;
    if (!state.fresh) {
      // Energy that the loop gave on this axis since the last tick.
      const double dx = q_m[i] - state.q_m[i];
      const double v = (kFilter_s * state.velocity[i] + dx) / (kFilter_s + elapsed_s);
      const double hidden = 0.5 * config.encoder_step[i] * std::abs(acted[i] - before[i]);
      const double taken = config.device_damping[i] * v * v * elapsed_s;
      const double to_person = acted[i] * dx + (stored - state.stored[i]) + hidden - taken;
      const double given = to_person + state.avatar[i] * (q_s[i] - state.q_s[i]);
      const double energy =
          std::clamp(state.energy[i] - given, -config.capacity[i], config.capacity[i]);
      given_by_hand += to_person - pushed[i] * dx;
      out.state.velocity[i] = v;
      out.state.energy[i] = energy;
      if (energy < 0.0 && v != 0.0) {
        out.effort[i] = -dampingFor(-energy, v * v, elapsed_s, config.most_damping[i]) * v;
      }
    }
    out.state.stored[i] = stored;
  }
  // The tank of the hand.
  const double most_j = config.hand_capacity + world.held_j;
  const double hand_j =
      state.fresh ? state.hand + world.held_j : state.hand - given_by_hand + world.received_j;
  out.state.hand = std::clamp(hand_j, -config.hand_capacity, most_j);
  dampHand(out.state, config, elapsed_s, out.effort);
  out.state.q_m = q_m;
  out.state.q_s = q_s;
  out.state.fresh = false;
  return out;
}

EnergyTankState recordSent(const EnergyTankState& state, const AxisEffort& sent,
                           const AxisEffort& avatar_effort, const AxisEffort& effort_limit,
                           const AxisEffort& pushed) noexcept {
  EnergyTankState out = state;
  out.newest = (state.newest + 1) % kRing;
  out.sent[out.newest] = sent;
  out.pushed[out.newest] = pushed.size() > 0 ? pushed : AxisEffort(sent.size());
  for (int i = 0; i < sent.size(); ++i) {
    out.avatar[i] = std::clamp(avatar_effort[i], -effort_limit[i], effort_limit[i]);
  }
  return out;
}

}  // namespace wholehand
