#pragma once

#include "core/expected.hpp"
#include "model/device_model.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// Shows by motion whether efforts reach the motors, whatever the drive's bits say. Every axis is
/// pushed against its weight, or towards the middle of its travel where it has none. What acts on
/// it follows from its motion and the device file: m q̈ + b q̇ + f_c sign q̇, of which a weight that
/// falls and a brake have the other sign or nothing.
class LetGoProof {
 public:
  /// @param lasts_s a push that never ends stays below half the speed limit for so long
  /// @param share largest share of an effort limit
  LetGoProof(const DeviceModel& model, double lasts_s, double share);

  /// Effort of each axis [N or N·m]; the first positions choose the direction.
  [[nodiscard]] const std::vector<double>& push(const std::vector<double>& position);
  /// One more place of the part that is judged; `at_s` by the sample's own time.
  void see(double at_s, const std::vector<double>& position);
  /// The next part begins.
  void forget() { seen_.clear(); }

  /// Whether every axis has moved by enough steps of its encoder to be judged.
  [[nodiscard]] bool moved() const;
  /// Axes that the push did not move: nothing would show whether it ends.
  [[nodiscard]] Diagnostics still() const;
  /// Axes on which more than half of the push acts.
  /// @param when "after its watchdog let go"
  [[nodiscard]] Diagnostics acting(const std::string& when) const;

 private:
  struct Seen {
    double at_s = 0.0;
    std::vector<double> position;
  };
  [[nodiscard]] double shareActing(std::size_t axis) const;

  const DeviceModel* model_;
  double lasts_s_, share_;
  std::vector<double> push_, effort_;
  std::vector<Seen> seen_;
};

}  // namespace wholehand
