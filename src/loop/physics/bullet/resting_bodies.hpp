#pragma once

#include "loop/core/real_time.hpp"
#include "loop/physics/bullet/bullet_bodies.hpp"

#include <utility>
#include <vector>

namespace wholehand::bullet {

/// Puts bodies to rest and wakes them. Bodies near one another form a group. A group rests once all
/// its bodies have been still for a time without the hand near them. It wakes when something comes
/// near one of them. A resting body costs no computing time. Real-time safe except for
/// construction.
class RestingBodies {
 public:
  /// Two bodies whose colliders are near.
  using Near = std::pair<int, int>;

  /// All bodies are awake at first. @pre bodies outlive this @param gravity_m_s2 if 0, only bodies
  /// at exactly zero velocity count as still @param lets_rest false: watch() lays nothing down
  RestingBodies(std::vector<BulletBody>& bodies, double gravity_m_s2, bool lets_rest = true);

  /// True for a moving body that does not rest; false for fixed bodies.
  [[nodiscard]] bool awake(int body) const noexcept { return awake_[body]; }
  [[nodiscard]] bool rests(int body) const noexcept { return group_[body] >= 0; }
  /// Awake bodies, in the scene's order.
  [[nodiscard]] const std::vector<int>& awakeBodies() const noexcept { return awake_bodies_; }

  /// Changes whenever awakeBodies() does.
  [[nodiscard]] unsigned version() const noexcept { return version_; }

  /// Wakes a body and its group, and restarts their time of stillness.
  WHOLEHAND_RT void disturb(int body) noexcept;
  /// Marks a body as movable (and awake) or fixed; wakes the group in which it rested.
  WHOLEHAND_RT void setMoves(int body, bool moves) noexcept;
  /// Call after each step. True when layDown() is due.
  [[nodiscard]] WHOLEHAND_RT bool watch(double step_s) noexcept;
  /// Puts groups to rest that have been still long enough. @param near all pairs
  WHOLEHAND_RT void layDown(const std::vector<Near>& near) noexcept;
  /// Puts groups to rest that are still now. @param fell per body: has moved since the start
  void restAtOnce(const std::vector<Near>& near, const std::vector<bool>& fell) noexcept;

 private:
  [[nodiscard]] bool isStill(int body) const noexcept;
  [[nodiscard]] bool isHeld(int body) const noexcept;
  [[nodiscard]] int rootOf(int body) noexcept;
  void group(const std::vector<Near>& near) noexcept;
  void listAwake() noexcept;

  std::vector<BulletBody>& bodies_;
  const double still_m_s_, still_rad_s_;
  const bool lets_rest_;
  std::vector<bool> awake_;
  std::vector<int> awake_bodies_;
  std::vector<int> group_;  ///< per body: first body of its resting group; −1: awake or fixed
  std::vector<double> still_s_;  ///< time of stillness [s]
  std::vector<int> parent_;      ///< disjoint sets by which groups are found
  std::vector<double> least_s_;  ///< per first body: shortest time of stillness in its group [s]
  double unwatched_s_ = 0.0;
  unsigned version_ = 0;
};

}  // namespace wholehand::bullet
