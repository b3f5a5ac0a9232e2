#pragma once

#include "experiments/contact_balance.hpp"
#include "experiments/felt_noise.hpp"
#include "experiments/grasp_trial.hpp"
#include "rig/rig.hpp"

namespace wholehand {

/// Computes the result of a grasp from its records.
class GraspObserver {
 public:
  /// @pre rig outlives this, and its first body is the object
  GraspObserver(const GraspTrial& trial, const Rig& rig, double hold_s);

  void operator()(const TickRecord& r);
  [[nodiscard]] GraspResult finish(const TickRecord& last);

 private:
  void trackTipForce(const TickRecord& r);
  void trackHold(const TickRecord& r, const Pose& held);

  const Rig& rig_;
  ArticulatedBody body_;
  ContactBalance balance_;  ///< over the last 2 s
  FeltNoise noise_;         ///< over the last 2 s
  double end_s_;
  GraspResult result_;
  Pose at_lift_, at_hold_;
  Eigen::Vector3d world_at_lift_ = Eigen::Vector3d::Zero();
  bool lifting_ = false, holding_ = false;
};

}  // namespace wholehand
