#pragma once

#include <string>
#include <vector>

namespace wholehand {

/// Round numbers (1, 2 or 5 times a power of ten apart) within [low, high], at most `most` of them.
/// Empty unless low < high, both finite.
[[nodiscard]] std::vector<double> niceTicks(double low, double high, int most);
/// The powers of ten within [low, high], thinned to at most `most`.
[[nodiscard]] std::vector<double> decadeTicks(double low, double high, int most);
/// The same; where only one of them would be seen, 1, 2 and 5 times powers of ten, if they fit.
[[nodiscard]] std::vector<double> logTicks(double low, double high, int most);
/// The text of a tick among its fellows: as many decimals as their spacing needs.
[[nodiscard]] std::string tickText(double value, const std::vector<double>& ticks);
/// "1", "10", "10²", "10⁻³" for powers of ten.
[[nodiscard]] std::string decadeText(double value);

/// The text of one of logTicks() among its fellows: "10²", or "200" between others than powers of
/// ten.
[[nodiscard]] std::string logTickText(double value, const std::vector<double>& ticks);

/// Maps values to pixels, evenly or by their logarithm (values are then clamped to > 0).
class PlotScale {
 public:
  /// `from` .. `to` [value] map to from_px .. to_px.
  PlotScale(double from, double to, double from_px, double to_px, bool logarithmic = false);
  [[nodiscard]] double px(double value) const;

 private:
  [[nodiscard]] double position(double value) const;

  bool logarithmic_;
  double from_, to_, from_px_, to_px_;
};

/// Moves labels apart: each as near to its wanted place as the others allow, at least `gap` between
/// two, all within [low, high] where there is room; keeps their order. Returns one place per label.
[[nodiscard]] std::vector<double> declutter(const std::vector<double>& wanted, double gap,
                                            double low, double high);

}  // namespace wholehand
