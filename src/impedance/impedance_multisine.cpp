#include "impedance/impedance_multisine.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wholehand {
namespace {

constexpr double kWindow_s = 10.0;  // one period of the lowest line
constexpr double kLinesPerDecade = 14.0;
constexpr double kFade_s = 0.5;  // a gradual onset leaves a smaller transient

}  // namespace

LineGrid lineGrid(double period_s) {
  LineGrid grid;
  grid.period_s = period_s;
  grid.window = static_cast<int>(std::lround(kWindow_s / period_s));
  const int last = grid.window / 2 - 1;
  const double decades = std::log10(static_cast<double>(last));
  const int steps = static_cast<int>(std::ceil(decades * kLinesPerDecade));
  for (int i = 0; i <= steps; ++i) {
    const int line = static_cast<int>(std::lround(std::pow(10.0, decades * i / steps)));
    if (grid.lines.empty() || line > grid.lines.back()) grid.lines.push_back(line);
  }
  return grid;
}

LineGrid oneLine(double frequency_hz, double period_s) {
  constexpr int kTurns = 4;
  return {static_cast<int>(std::lround(kTurns / (frequency_hz * period_s))), period_s, {kTurns}};
}

LineTransform::LineTransform(const LineGrid& grid) : grid_(&grid), sum_(grid.lines.size()) {
  for (int k = 0; k < grid.window; ++k) {
    turn_.push_back(std::polar(1.0, -2.0 * std::numbers::pi * k / grid.window));
  }
}

void LineTransform::add(double sample) {
  const std::int64_t at = added_++ % grid_->window;
  for (std::size_t i = 0; i < sum_.size(); ++i) {
    const std::int64_t angle = at * grid_->lines[i] % grid_->window;
    sum_[i] += sample * turn_[angle];
  }
}

std::complex<double> LineTransform::phasor(std::size_t line) const {
  return sum_[line] * (2.0 / added_);
}

MultisinePlayer::MultisinePlayer(AxisPosition rest, int axis, const LineGrid& grid,
                                 const std::vector<double>& amplitude, double stiffness)
    : rest_(rest), axis_(axis), aim_(grid.window) {
  const auto count = static_cast<double>(grid.lines.size());
  for (std::size_t i = 0; i < grid.lines.size(); ++i) {
    // Schroeder phases keep the peaks of the sum low.
    const auto n = static_cast<double>(i);
    const double phase = -std::numbers::pi * n * (n + 1.0) / count;
    for (std::size_t k = 0; k < aim_.size(); ++k) {
      const auto turned = static_cast<std::int64_t>(k) * grid.lines[i] % grid.window;
      aim_[k] +=
          amplitude[i] / stiffness *
          std::sin(2.0 * std::numbers::pi * static_cast<double>(turned) / grid.window + phase);
    }
  }
}

void MultisinePlayer::advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept {
  ++periods_;
  const double u = std::min(static_cast<double>(periods_) * period_s / kFade_s, 1.0);
  q = rest_;
  q[axis_] += u * u * (3.0 - 2.0 * u) * aim_[periods_ % aim_.size()];
  qd = AxisVelocity(rest_.size());
}

}  // namespace wholehand
