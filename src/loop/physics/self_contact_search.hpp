#pragma once

#include "loop/core/axis_array.hpp"
#include "loop/core/real_time.hpp"
#include "loop/model/capsule_gap.hpp"
#include "loop/model/hand_model.hpp"

#include <vector>

namespace wholehand {

/// Finds the pairs of the hand's capsules that are about to touch.
///
/// Two capsules approach each other only by motion of the hand's axes, and no faster than the axes
/// move them. A separated pair is therefore checked again only after the axes have moved far
/// enough. While the hand is open or only the arm moves, nothing is computed.
class SelfContactSearch {
 public:
  /// Pairs nearer than this are reported [m]. Twice the distance that the fastest shipped axes
  /// close within 1 ms (10 rad/s of finger and thumb, at most 0.1 m/rad each).
  static constexpr double kNear_m = 4e-3;

  struct Near {
    int pair = -1;  ///< index into HandModel::self_contacts
    CapsuleGap gap;
  };

  /// @pre hand outlives this
  explicit SelfContactSearch(const HandModel& hand);

  /// Resets after the hand was placed elsewhere. A pair that overlaps there is ignored until it has
  /// separated, so that a hand armed while closed is not pushed open. Real-time safe.
  WHOLEHAND_RT void reset(const Pose* links, const AxisPosition& q_s) noexcept;
  /// @param links poses of all links [world] at q_s. Real-time safe.
  WHOLEHAND_RT void update(const Pose* links, const AxisPosition& q_s) noexcept;

  /// The i-th near pair, in the order of HandModel::self_contacts.
  [[nodiscard]] const Near& near(int i) const noexcept { return near_[i]; }
  [[nodiscard]] int count() const noexcept { return count_; }

 private:
  struct Pair {
    const Capsule *a = nullptr, *b = nullptr;
    double due_m = 0.0;  ///< path at which the pair is due for a check
    bool let_go = false;
  };

  void look(const Pose* links) noexcept;

  std::vector<Pair> pairs_;
  std::vector<double> fastest_;  ///< per axis: fastest approach of any pair [m per unit of the
                                 ///< axis]
  std::vector<Near> near_;       ///< one per pair; the first count_ are in use
  int count_ = 0;
  AxisPosition q_s_;     ///< at the last update
  double path_m_ = 0.0;  ///< upper bound of any pair's approach since the last reset
  double due_m_ = 0.0;   ///< due_m of the pair that is due first
};

}  // namespace wholehand
