#pragma once

#include "patient/player.hpp"

#include <complex>
#include <vector>

namespace wholehand {

/// Frequencies with whole periods in a window, which a Fourier transform separates exactly: line i
/// has lines[i] periods in `window` ticks.
struct LineGrid {
  int window = 0;
  double period_s = 1e-3;
  std::vector<int> lines;
  [[nodiscard]] double frequency_hz(std::size_t line) const {
    return lines[line] / (window * period_s);
  }
};

/// Logarithmically spaced lines from 0.1 Hz to just below half the rate.
[[nodiscard]] LineGrid lineGrid(double period_s);
/// A single line of four periods. @param frequency_hz approximate
[[nodiscard]] LineGrid oneLine(double frequency_hz, double period_s);

/// Phasors of the lines from successive samples, over the windows since the start.
class LineTransform {
 public:
  explicit LineTransform(const LineGrid& grid);
  void add(double sample);
  /// Amplitude (peak) and phase. @pre a whole number of windows was added
  [[nodiscard]] std::complex<double> phasor(std::size_t line) const;

 private:
  const LineGrid* grid_;
  std::vector<std::complex<double>> turn_, sum_;
  int added_ = 0;
};

/// A person who pushes one axis with a sum of sines and holds the others. The push acts through an
/// arm so soft that only its target matters.
class MultisinePlayer final : public Player {
 public:
  /// @param amplitude effort per line of the grid  @param stiffness of the arm on the axis
  MultisinePlayer(AxisPosition rest, int axis, const LineGrid& grid,
                  const std::vector<double>& amplitude, double stiffness);

  [[nodiscard]] AxisPosition start() const override { return rest_; }
  void reset() override { periods_ = 0; }
  WHOLEHAND_RT void advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept override;
  WHOLEHAND_RT void see(const TickRecord&) noexcept override {}

 private:
  AxisPosition rest_;
  int axis_;
  std::vector<double> aim_;  ///< target over one window, repeated
  std::size_t periods_ = 0;
};

}  // namespace wholehand
