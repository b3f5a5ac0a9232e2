#pragma once

#include "experiments/complexity_scenes.hpp"
#include "loop/core/expected.hpp"
#include "rig/engines.hpp"
#include "rig/models.hpp"

#include <array>
#include <functional>
#include <string>
#include <vector>

namespace wholehand {

/// Tick time in one scene. Times are CPU times of whole ticks.
struct ComplexityPoint {
  int count = 0;     ///< size of the scene in its kind's unit (bodies, corners, contacts)
  int bodies = 0;    ///< number of bodies including fixed ones
  int contacts = 0;  ///< largest number of contacts of the hand in a tick
  int dropped = 0;   ///< largest number of contact points beyond the record's capacity in a tick
  bool faulted = false;
  double p10_us = 0.0, p50_us = 0.0, p99_us = 0.0, p999_us = 0.0;
  double p999_once_us = 0.0;  ///< 99.9th percentile of single runs, with the noise of the machine
};

struct ComplexityCurve {
  ComplexityKind kind = ComplexityKind::kPile;
  std::vector<ComplexityPoint>
      points;  ///< points in order of count, which rises from 0 or from the smallest mesh

  /// Least-squares slope of log(median minus median without bodies) over log(count) for counts of
  /// at least `from`. NaN with fewer than two points.
  [[nodiscard]] double exponent(int from = 16) const;
  /// Largest count with p99.9 below the limit, interpolated between measured points. −1: the first
  /// point exceeds it. @param all set to true if every measured point is below the limit
  [[nodiscard]] double admitted(double limit_us, bool& all) const;
};

struct ComplexityResult {
  std::vector<ComplexityCurve> curves;
  bool interrupted = false;
};

struct ComplexityPlan {
  ModelFiles files;  ///< hand, device, rendering, patient
  std::string engine = defaultEngine();
  double period_s = 1e-3;
  int ticks = 3000;  ///< ticks per scene after the hand has come down
  int passes = 3;    ///< number of bit-identical runs; each tick counts with its shortest time
  std::string only;  ///< runs only kinds whose name contains this
  std::function<void(int pass, int passes)> status;
};

/// Rates of the admission table [Hz].
inline constexpr std::array<double, 4> kComplexityRatesHz{1e3, 2e3, 4e3, 8e3};

/// Runs every scene on the simulated clock, a few ticks of each in turn, so that other load on the
/// machine affects all scenes equally.
[[nodiscard]] Expected<ComplexityResult> measureComplexity(const ComplexityPlan& plan);

}  // namespace wholehand
