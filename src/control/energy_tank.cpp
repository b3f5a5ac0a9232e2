#include "control/energy_tank.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

constexpr double kTranslation_j = 0.05;
constexpr double kRotation_j = 0.005;
constexpr int kRing = kMostDelayTicks + 2;
constexpr double kMostDamping = 0.4;  // of m / ((1 + n) T)

// What the coupling's spring holds when its effort is held to the limit.
double storedIn(double stiffness, double stretch, double limit) noexcept {
  const double e = std::abs(stretch);
  if (stiffness * e < limit) return 0.5 * stiffness * e * e;
  return limit * e - 0.5 * limit * limit / stiffness;
}

}  // namespace

EnergyTankConfig makeEnergyTank(const DeviceModel& device, double period_s) {
  EnergyTankConfig config;
  config.axes = device.axisCount();
  config.delay_ticks = std::clamp(device.output_delay_ticks, 0, kMostDelayTicks);
  config.capacity = AxisEnergy(config.axes);
  config.device_damping = config.most_damping = AxisRatio(config.axes);
  config.encoder_step = AxisPosition(config.axes);
  for (int i = 0; i < config.axes; ++i) {
    const DeviceAxis& axis = device.axes[static_cast<std::size_t>(i)];
    config.capacity[i] = axis.kind == AxisKind::kTranslation ? kTranslation_j : kRotation_j;
    config.device_damping[i] = axis.damping;
    config.most_damping[i] =
        kMostDamping * axis.mass / ((1.0 + device.output_delay_ticks) * period_s);
    config.encoder_step[i] = axis.encoder_step;
  }
  return config;
}

EnergyTankState fullTank(const EnergyTankConfig& config) noexcept {
  EnergyTankState state;
  state.energy = config.capacity;
  state.stored = AxisEnergy(config.axes);
  state.q_m = state.q_s = AxisPosition(config.axes);
  state.avatar = AxisEffort(config.axes);
  state.sent.fill(AxisEffort(config.axes));
  return state;
}

EnergyTankStep advanceTank(const EnergyTankState& state, const AxisPosition& q_m,
                           const AxisPosition& q_s, const AxisEnergy& wall_stored,
                           const CouplingGains& gains, const EnergyTankConfig& config,
                           const AxisEffort& effort_limit, int elapsed_periods,
                           double period_s) noexcept {
  EnergyTankStep out{state, AxisEffort(config.axes)};
  const double elapsed_s = elapsed_periods * period_s;
  const auto sent = [&state](int ticks_ago) -> const AxisEffort& {
    return state.sent[static_cast<std::size_t>((state.newest + kRing - ticks_ago) % kRing)];
  };
  const AxisEffort& acted = sent(config.delay_ticks);
  const AxisEffort& before = sent(config.delay_ticks + 1);
  for (int i = 0; i < config.axes; ++i) {
    const double wall = i < wall_stored.size() ? wall_stored[i] : 0.0;
    const double stored = storedIn(gains.k_pm[i], q_m[i] - q_s[i], effort_limit[i]) + wall;
    if (!state.fresh) {
      const double dx = q_m[i] - state.q_m[i];
      const double ds = q_s[i] - state.q_s[i];
      const double hidden = 0.5 * config.encoder_step[i] * std::abs(acted[i] - before[i]);
      const double given =
          acted[i] * dx + state.avatar[i] * ds + (stored - state.stored[i]) + hidden;
      const double taken = 0.5 * config.device_damping[i] * dx * dx / elapsed_s;
      const double energy =
          std::clamp(state.energy[i] - given + taken, -config.capacity[i], config.capacity[i]);
      out.state.energy[i] = energy;
      if (energy < 0.0 && dx != 0.0) {
        const double damping = std::min(-energy * elapsed_s / (dx * dx), config.most_damping[i]);
        out.effort[i] = -damping * dx / elapsed_s;
      }
    }
    out.state.stored[i] = stored;
  }
  out.state.q_m = q_m;
  out.state.q_s = q_s;
  out.state.fresh = false;
  return out;
}

EnergyTankState noteSent(const EnergyTankState& state, const AxisEffort& sent,
                         const AxisVelocity& qd_mf, const AxisVelocity& qd_s,
                         const AxisRatio& avatar_damping, const CouplingGains& gains) noexcept {
  EnergyTankState out = state;
  out.newest = (state.newest + 1) % kRing;
  out.sent[static_cast<std::size_t>(out.newest)] = sent;
  for (int i = 0; i < sent.size(); ++i) {
    out.avatar[i] =
        gains.k_pm[i] * (state.q_m[i] - state.q_s[i]) + avatar_damping[i] * (qd_mf[i] - qd_s[i]);
  }
  return out;
}

}  // namespace wholehand
