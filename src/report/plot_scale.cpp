#include "report/plot_scale.hpp"

#include "report/html_text.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace wholehand {
namespace {
constexpr double kSmallestLog = 1e-300;
}

std::vector<double> niceTicks(double low, double high, int most) {
  std::vector<double> ticks;
  if (!(low < high) || !std::isfinite(high - low) || most < 1) return ticks;
  double decade = std::pow(10.0, std::floor(std::log10((high - low) / most)));
  for (const double factor : {1.0, 2.0, 5.0, 10.0, 20.0, 50.0}) {
    const double step = factor * decade;
    // A hair of tolerance, so that 0.3 counts as within [0, 0.3].
    const double first = std::ceil(low / step - 1e-9), last = std::floor(high / step + 1e-9);
    if (last - first + 1.0 > most) continue;
    for (double i = first; i <= last; i += 1.0) ticks.push_back(i == 0.0 ? 0.0 : i * step);
    break;
  }
  return ticks;
}

std::vector<double> decadeTicks(double low, double high, int most) {
  std::vector<double> ticks;
  if (!(low > 0.0) || !(low < high) || !std::isfinite(high) || most < 1) return ticks;
  const double first = std::ceil(std::log10(low) - 1e-9),
               last = std::floor(std::log10(high) + 1e-9);
  const double step = std::max(1.0, std::ceil((last - first + 1.0) / most));
  for (double i = first; i <= last; i += step) ticks.push_back(std::pow(10.0, i));
  return ticks;
}

std::vector<double> logTicks(double low, double high, int most) {
  std::vector<double> decades = decadeTicks(low, high, most);
  if (decades.size() > 1 || !(low > 0.0) || !(low < high) || !std::isfinite(high)) return decades;
  std::vector<double> ticks;
  for (double exponent = std::floor(std::log10(low)); std::pow(10.0, exponent) < high; ++exponent) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      const double tick = factor * std::pow(10.0, exponent);
      if (tick >= low && tick <= high) ticks.push_back(tick);
    }
  }
  return ticks.size() > static_cast<std::size_t>(std::max(most, 0)) ? decades : ticks;
}

std::string logTickText(double value, const std::vector<double>& ticks) {
  const bool decades = std::all_of(ticks.begin(), ticks.end(), [](double tick) {
    return std::abs(tick / std::pow(10.0, std::round(std::log10(tick))) - 1.0) < 1e-9;
  });
  if (decades) return decadeText(value);
  return formatNumber(value, std::max(0, -static_cast<int>(std::floor(std::log10(value) + 1e-9))));
}

std::string tickText(double value, const std::vector<double>& ticks) {
  double spacing = ticks.size() > 1 ? ticks[1] - ticks[0] : std::abs(value);
  int decimals = 0;
  while (decimals < 9 && spacing > 0.0 &&
         std::abs(spacing - std::round(spacing)) > 1e-6 * spacing) {
    spacing *= 10.0;
    ++decimals;
  }
  return formatNumber(value, decimals);
}

std::string decadeText(double value) {
  static const std::vector<std::string> kSuperscripts = {"⁰", "¹", "²", "³", "⁴",
                                                         "⁵", "⁶", "⁷", "⁸", "⁹"};
  const int exponent = static_cast<int>(std::lround(std::log10(value)));
  if (exponent == 0) return "1";
  if (exponent == 1) return "10";
  std::string out = exponent < 0 ? "10⁻" : "10";
  for (const char digit : std::to_string(std::abs(exponent))) {
    out += kSuperscripts[static_cast<std::size_t>(digit - '0')];
  }
  return out;
}

PlotScale::PlotScale(double from, double to, double from_px, double to_px, bool logarithmic)
    : logarithmic_(logarithmic),
      from_(position(from)),
      to_(position(to)),
      from_px_(from_px),
      to_px_(to_px) {}

double PlotScale::position(double value) const {
  return logarithmic_ ? std::log10(std::max(value, kSmallestLog)) : value;
}

double PlotScale::px(double value) const {
  if (from_ == to_) return 0.5 * (from_px_ + to_px_);
  return from_px_ + (position(value) - from_) / (to_ - from_) * (to_px_ - from_px_);
}

std::vector<double> declutter(const std::vector<double>& wanted, double gap, double low,
                              double high) {
  const std::size_t n = wanted.size();
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return wanted[a] < wanted[b]; });
  // Labels that touch form a cluster; a cluster sits where its members on average want to be.
  struct Cluster {
    double sum;  // of the first label's place as each member wants it
    std::size_t size;
    [[nodiscard]] double first() const { return sum / static_cast<double>(size); }
  };
  std::vector<Cluster> clusters;
  const auto placed = [&](const Cluster& c) {
    const double length = static_cast<double>(c.size - 1) * gap;
    return std::max(low, std::min(c.first(), high - length));
  };
  for (const std::size_t i : order) {
    clusters.push_back({wanted[i], 1});
    while (clusters.size() > 1) {
      const Cluster last = clusters.back();
      Cluster& before = clusters[clusters.size() - 2];
      const double length = static_cast<double>(before.size) * gap;
      if (placed(before) + length <= placed(last)) break;
      before.sum += last.sum - length * static_cast<double>(last.size);
      before.size += last.size;
      clusters.pop_back();
    }
  }
  std::vector<double> out(n);
  std::size_t next = 0;
  for (const Cluster& c : clusters) {
    for (std::size_t k = 0; k < c.size; ++k) {
      out[order[next++]] = placed(c) + static_cast<double>(k) * gap;
    }
  }
  return out;
}

}  // namespace wholehand
