#pragma once

#include "core/axis_array.hpp"
#include "core/real_time.hpp"
#include "model/capsule_gap.hpp"
#include "model/hand_model.hpp"

#include <vector>

namespace wholehand {

/// Which pairs of a hand's capsules are about to meet.
///
/// A pair can only near by what the hand's axes do: no faster than the axis moves either capsule.
/// So a pair that was seen apart is looked at again only when the axes have gone so far; while the
/// hand is open and while the arm moves nothing is computed.
class SelfContactSearch {
 public:
  /// Pairs nearer than this are told [m]. Twice what the fastest shipped axes close within 1 ms
  /// (10 rad/s of finger and thumb, at most 0.1 m/rad each).
  static constexpr double kNear_m = 4e-3;

  struct Near {
    int pair = -1;  ///< index into HandModel::self_contacts
    CapsuleGap gap;
  };

  /// @pre hand outlives this
  explicit SelfContactSearch(const HandModel& hand);

  /// The hand was put elsewhere. A pair that overlaps there is let go until it has parted: a hand
  /// that is armed while closed is not pushed open. Real-time safe.
  WHOLEHAND_RT void reset(const Pose* links, const AxisPosition& q_s) noexcept;
  /// @param links poses of all links [world] at q_s. Real-time safe.
  WHOLEHAND_RT void update(const Pose* links, const AxisPosition& q_s) noexcept;

  /// In the order of HandModel::self_contacts.
  [[nodiscard]] const Near& near(int i) const noexcept { return near_[i]; }
  [[nodiscard]] int count() const noexcept { return count_; }

 private:
  struct Pair {
    const Capsule *a = nullptr, *b = nullptr;
    double due_m = 0.0;  ///< path at which it is to be looked at again
    bool let_go = false;
  };

  void look(const Pose* links) noexcept;

  std::vector<Pair> pairs_;
  std::vector<double> fastest_;  ///< of each axis: nearing of any pair [m per unit of the axis]
  std::vector<Near> near_;       ///< as many as pairs; the first count_ are in use
  int count_ = 0;
  AxisPosition q_s_;     ///< at the last update
  double path_m_ = 0.0;  ///< no pair has neared by more since the last reset
  double due_m_ = 0.0;   ///< of the pair that is due first
};

}  // namespace wholehand
