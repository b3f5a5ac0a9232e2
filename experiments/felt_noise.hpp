#pragma once

#include "loop/core/tick_record.hpp"
#include "loop/model/device_model.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace wholehand {

/// Computes the rms about the mean of the rendered coupling effort per axis; rotations in newtons
/// at the tip.
class FeltNoise {
 public:
  /// @pre device outlives this
  explicit FeltNoise(const DeviceModel& device) : device_(device), axes_(device.axes.size()) {}

  void add(const TickRecord& r) {
    for (std::size_t a = 0; a < axes_.size(); ++a) {
      const DeviceAxis& axis = device_.axes[a];
      double newton = r.coupling[static_cast<int>(a)];
      if (axis.kind == AxisKind::kRotation)
        newton /= axis.lever_arm_m > 0.0 ? axis.lever_arm_m : kTipArm_m;
      axes_[a].add(newton);
    }
  }
  /// Value of the worst axis [N].
  [[nodiscard]] double worst() const {
    double worst_n = 0.0;
    for (const Spread& axis : axes_) worst_n = std::max(worst_n, axis.rms());
    return worst_n;
  }

 private:
  static constexpr double kTipArm_m = 0.08;  // lever arm for axes without a tip, that of a finger

  // Mean and variance without storing the samples (Welford).
  class Spread {
   public:
    void add(double x) {
      ++count_;
      const double d = x - mean_;
      mean_ += d / count_;
      squares_ += d * (x - mean_);
    }
    [[nodiscard]] double rms() const { return count_ > 0 ? std::sqrt(squares_ / count_) : 0.0; }

   private:
    double count_ = 0.0, mean_ = 0.0, squares_ = 0.0;
  };

  const DeviceModel& device_;
  std::vector<Spread> axes_;
};

}  // namespace wholehand
