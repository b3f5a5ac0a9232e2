#pragma once

#include "loop/physics/engine_bench.hpp"
#include "loop/physics/still_hand.hpp"

#include <algorithm>
#include <functional>
#include <memory>
#include <vector>

namespace wholehand::test {

inline constexpr double kLever_m = 0.08;  ///< lever arm of a fingertip

/// A person who moves the hand to an object, opposes the thumb and then holds fingers and thumb at
/// a given effort at the tips.
struct PowerGrasp {
  double tip_n;
  AxisPosition q_m{6};
  AxisEffort coupling{6};  ///< effort of the last tick
  std::unique_ptr<Rig> rig;

  PowerGrasp(double effort_tip_n, const SceneBody& thing,
             const std::function<AxisPosition(int)>& script)
      : PowerGrasp(effort_tip_n, std::vector<SceneBody>{thing}, script) {}
  PowerGrasp(double effort_tip_n, const std::vector<SceneBody>& things,
             const std::function<AxisPosition(int)>& script, double gravity_m_s2 = 0.0)
      : tip_n(effort_tip_n) {
    Models m = load(shippedFiles());
    m.scene.bodies = things;
    m.scene.gravity_m_s2 = {0.0, 0.0, -gravity_m_s2};
    q_m[1] = -0.1;
    q_m[kFingers] = 65.0 * kDeg, q_m[kCircumduction] = 5.0 * kDeg;
    rig = buildScripted(std::move(m), script);
  }
  /// Updates the hand's target for a reading.
  void grasp(int read) {
    if (read < 1000) {
      q_m[1] = -0.1 * (1.0 - 1e-3 * read);
    } else if (read < 1500) {
      q_m[kCircumduction] += 0.03 * kDeg;
    } else {
      for (const int axis : {kFingers, kThumb}) {
        const double missing_n = tip_n + coupling[axis] / kLever_m;
        q_m[axis] += std::clamp(1e-3 * missing_n, -2e-3, 2e-3);
        const DeviceAxis& range = rig->models.device.axes[axis];
        q_m[axis] = std::clamp(q_m[axis], range.lower, range.upper);
      }
    }
  }
};

}  // namespace wholehand::test
