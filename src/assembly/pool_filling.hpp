#pragma once

#include "assembly/models.hpp"
#include "core/body_order.hpp"
#include "core/tick_record.hpp"

#include <Eigen/Core>

#include <deque>
#include <vector>

namespace wholehand {

class ArticulatedBody;

/// Orders that fill the slots of a game's scene with the costliest bodies that its budget admits,
/// and keep them at the hand: as many awake bodies as the budget says, half of them free under
/// gravity and half pulled into the hand, and fixed bodies in all other slots. Each has the most
/// pieces, rods of the most vertices, which overlap as far as prepareShapes() admits
/// (docs/adr/0043-bodies-of-a-game.md). Not real-time safe.
class PoolFilling {
 public:
  /// @param at pose of the hand when the bodies appear; they appear clear of it
  /// @param pieces of every body, in place of the costliest
  /// @pre budget.slots > 0 @pre models outlive this
  PoolFilling(const Models& models, const GameBudget& budget, const AxisPosition& at,
              std::vector<Shape> pieces = {});

  /// Writes the next orders into the record, before its tick. A body that fell out of reach, or
  /// left the world, comes back.
  void order(TickRecord& record);
  /// True once every body was ordered to appear.
  [[nodiscard]] bool spawned() const noexcept { return spawned_; }
  /// Who moves the body of a slot. Slots without a free place near the hand stay empty.
  [[nodiscard]] const std::vector<BodyOwner>& owners() const noexcept { return owners_; }
  /// True where a slot's state in the record is that of an empty one.
  [[nodiscard]] static bool isEmpty(const BodyState& slot) noexcept;
  /// Pieces of each body, as ordered.
  [[nodiscard]] const std::vector<Shape>& pieces() const noexcept { return pieces_; }

 private:
  void makePieces(const GameBudget& budget);
  void centerPieces();
  void findPlaces(const GameBudget& budget, const AxisPosition& at);
  [[nodiscard]] bool isClear(const Eigen::Vector3d& place_m, const ArticulatedBody& hand) const;
  [[nodiscard]] SpawnOrder spawnOf(int slot) const;
  void tend(int slot, const TickRecord& seen, const Eigen::Vector3d& pocket_m);
  /// Middle of the space that the half-closed hand encloses.
  [[nodiscard]] Eigen::Vector3d pocketAt(const AxisPosition& q_s) const;

  const Models& models_;
  double mass_kg_ = 0.0, radius_m_ = 0.0;
  std::vector<Shape> pieces_;
  std::vector<Eigen::Vector3d> places_m_, targets_m_;  ///< per slot
  std::vector<BodyOwner> owners_;                      ///< per slot
  std::vector<int> generations_;                       ///< per slot
  std::vector<int> pause_;  ///< per slot: times to leave it alone, until the record shows its spawn
  std::deque<Command> waiting_;
  std::size_t next_ = 0;  ///< slot that is tended next
  bool spawned_ = false;
};

}  // namespace wholehand
