#pragma once

#include "exercises/approach.hpp"
#include "exercises/tell_apart/tell_apart_task.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>

namespace wholehand::tell_apart {

/// A virtual patient who compares: it squeezes the bottle that the exercise asks for up to the
/// mark, lets go, moves to the other, and squeezes the one again that it takes for more. It feels
/// ln(second / first) with the noise of Jones's observers (σ 0.222). The seed sets its pace and its
/// noise. Deterministic.
class TellApartPlayer final : public approach::ClosingPlayer {
 public:
  /// @param center_m centre of the first bottle at the start
  TellApartPlayer(const PlayerReach& hand, std::array<int, kBottles> bodies,
                  const Eigen::Vector3d& center_m, const PlayerTraits& traits);

  void reset() override;
  WHOLEHAND_RT void advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept override;
  WHOLEHAND_RT void onRecord(const TickRecord& record) noexcept override;

 private:
  /// kPass moves the open hand to another bottle.
  enum class Phase { kDrawBack, kAlign, kEnter, kTouch, kSqueeze, kOpen, kAside, kPass, kRest };

  WHOLEHAND_RT void go(Phase phase) noexcept;
  WHOLEHAND_RT void next() noexcept;
  [[nodiscard]] WHOLEHAND_RT double pressingRate() const noexcept;
  [[nodiscard]] WHOLEHAND_RT AxisPosition goalOf(Phase phase) const noexcept;
  /// The bottle that it takes for more.
  [[nodiscard]] WHOLEHAND_RT int chosen(double x) noexcept;
  [[nodiscard]] WHOLEHAND_RT double uniform() noexcept;

  std::array<int, kBottles> bodies_;
  std::uint64_t seed_, random_ = 0;
  Phase phase_ = Phase::kDrawBack;
  std::array<Eigen::Vector3d, kBottles> grips_m_{};  ///< targets of the hand's base
  int at_ = 0;                                       ///< bottle where the hand is
  int to_ = -1;                                      ///< bottle to be squeezed; -1: none
  int choice_ = -1;                                  ///< its answer; -1: none yet
  bool near_ = false, done_ = false, felt_ = false;
  double pressed_ = 0.0, squeeze_n_ = 0.0;
};

}  // namespace wholehand::tell_apart
