#include "loop/control/viscoelastic.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wholehand {
namespace {

/// A travel below this counts as zero: the shell has returned. Without it the travel would decay
/// forever, into denormal numbers.
constexpr double kWhole = 1e-12;

}  // namespace

CushionStep advanceCushion(const Cushion& cushion, double travel, double depth, bool open,
                           double elapsed_s) noexcept {
  const double k = cushion.stiffness, k_s = cushion.return_stiffness;
  if (!std::isfinite(travel) || !std::isfinite(depth) || !(k >= 0.0)) return {};
  const double before = std::max(0.0, travel), pressed = k * std::max(0.0, depth);
  const auto effort_at = [=](double y) { return std::max(0.0, pressed - k * y); };
  const auto after = [=](double resistance, double push, double spring) {
    return (resistance * before + elapsed_s * push) / (resistance + elapsed_s * spring);
  };
  const double q = effort_at(before) - k_s * before;  // q while no liquid flows
  double y = before;
  if (open && q > cushion.opening) {
    y = after(cushion.resistance, pressed - cushion.opening, k + k_s);
  } else if (q < 0.0) {
    y = after(cushion.air_resistance, pressed, k + k_s);
    if (k * y > pressed) y = after(cushion.air_resistance, 0.0, k_s);  // the digit left the shell
    if (pressed == 0.0 && y < kWhole) y = 0.0;
  }
  return std::isfinite(y) ? CushionStep{y, effort_at(y)} : CushionStep{};
}

double lateDamping(double stiffness, double least_resistance, int delay_ticks,
                   double period_s) noexcept {
  const double late = delay_ticks * stiffness * period_s;
  return late == 0.0 ? 0.0 : late * late / (4.0 * least_resistance);
}

double nozzleResistance(const Nozzle& nozzle, double area_m2) noexcept {
  const double square_m2 = nozzle.radius_m * nozzle.radius_m;
  return 8.0 * nozzle.viscosity_pa_s * nozzle.length_m * area_m2 * area_m2 /
         (std::numbers::pi * square_m2 * square_m2);
}

}  // namespace wholehand
