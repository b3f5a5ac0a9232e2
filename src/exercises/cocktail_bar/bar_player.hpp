#pragma once

#include "exercises/approach.hpp"
#include "exercises/cocktail_bar/bar_record.hpp"

#include <array>
#include <cstdint>
#include <memory>

namespace wholehand {

/// A virtual patient who plays the cocktail bar. It sees the records after a reaction time. It
/// withdraws while row or glass slide, approaches the dispenser from behind and from the side,
/// closes the hand, squeezes according to the meter, releases shortly before the line, and
/// withdraws. A free dispenser is lifted until its nozzle is over the glass, then put back. It
/// gives up a squeeze that pours nothing into the glass. It repeats a failed grasp with another
/// aim, whose error may grow every time. The seed sets the start pose, the accuracy, strength and
/// pace of this person, and the tremor. The hand opens only as fast as no reflex is triggered.
/// Deterministic.
class BarPlayer final : public approach::ReachingPlayer {
 public:
  BarPlayer(const BarLayout& layout, const PlayerTraits& traits);

  void reset() override;
  WHOLEHAND_RT void advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept override;
  WHOLEHAND_RT void onRecord(const TickRecord& record) noexcept override;

 private:
  /// Phases of the person's behaviour.
  enum class Phase {
    kDrawBack,  ///< straight back, away from the row
    kFree,      ///< backwards with stretched fingers when something blocks the hand
    kWait,      ///< stays withdrawn until there is a dispenser to reach for
    kAlign,     ///< sideways while withdrawn, to a free path
    kEnter,     ///< forward beside the dispenser with stretched fingers
    kTouch,     ///< presses the palm against the dispenser
    kSqueeze,   ///< closes the hand and controls the squeeze force
    kEase,      ///< free dispenser: presses less and holds
    kOpen,
    kLeave,   ///< sideways away from the dispenser
    kLift,    ///< free dispenser: up ...
    kCarry,   ///< ... over the glass ...
    kReturn,  ///< ... back ...
    kLower    ///< ... and down
  };

  /// Traits of this person, drawn from the seed.
  struct Character {
    double reaction_s = 0.2;
    double pace = 1.0;       ///< factor on the speed of movements
    double share = 0.5;      ///< target position within the force zone, 0 .. 1
    double aim_m = 0.002;    ///< largest aiming error
    double judgement = 1.0;  ///< estimate of the flow after the release; 1 is exact
    /// Amplitude of the arm; the fingers' amplitude is ten times this number [rad].
    double tremor_m = 0.0;
    double tremor_rad_s = 50.0;
    double tremor_phase = 0.0;
  };

  /// Length of the memory of statuses [ms], and the interval between two of them.
  static constexpr int kMemory = 512;
  static constexpr double kLook_s = 1e-3;

  double draw() noexcept;  // 0 .. 1
  double draw(double low, double high) noexcept;
  [[nodiscard]] const BarStatus& remember() const noexcept;
  void decide(const BarStatus& seen, const TickRecord& record) noexcept;
  void next(const BarStatus& seen, const TickRecord& record) noexcept;
  void pressBy(const BarStatus& seen) noexcept;
  void press(double period_s) noexcept;
  void go(Phase phase, double slower = 1.0) noexcept;
  [[nodiscard]] bool drawnBack() const noexcept;
  [[nodiscard]] bool isHeldBack() const noexcept;
  [[nodiscard]] AxisPosition goalOf(Phase phase) const noexcept;
  void shape(Phase phase) noexcept;
  void aimAt(const TickRecord& record, int dispenser) noexcept;
  void countFailedGrasp(const BarStatus& seen) noexcept;
  void aimOverGlass(const TickRecord& record) noexcept;
  [[nodiscard]] bool comeNear(const TickRecord& record) noexcept;
  void tremble(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept;
  [[nodiscard]] bool wantsToGrasp(const BarStatus& seen) const noexcept;

  BarLayout bar_;
  PlayerTraits traits_;
  std::uint64_t random_ = 0;
  Character character_;

  Phase phase_ = Phase::kWait;
  double since_s_ = 0.0;  // time in the present phase
  double period_s_ = 1e-3;
  bool near_ = false;      // someone else steered the hand to a dispenser
  bool touches_ = false;   // ... or against an object
  AxisPosition measured_;  // device position of the newest record

  int dispenser_ = -1;  // dispenser to grasp; -1: none yet
  int drink_ = -1, step_ = -1;
  int tries_ = 0;                                   // squeezes of this grasp
  int failures_ = 0;                                // consecutive grasps without success
  double poured_before_l_ = 0.0;                    // volume of the step at the start of this grasp
  double poured_l_ = 0.0;                           // volume at the last worthwhile progress ...
  double stalled_s_ = 0.0;                          // ... and time since then
  bool lifted_ = false;                             // a free dispenser is over the glass
  Eigen::Vector3d grip_ = Eigen::Vector3d::Zero();  // target of the hand's base
  Eigen::Vector3d over_ = Eigen::Vector3d::Zero();  // target over the glass, free dispenser
  double share_ = 0.5;                     // target position within the zone in this squeeze
  double settled_s_ = 0.0;                 // time within the wanted hold
  double fingers_ = 0.0, thumb_ = 0.0;     // targets while pressing; thumb at half bent
  double rate_ = 0.0, wanted_rate_ = 0.0;  // speed of the fingers' target [rad/s]
  bool grips_ = false;                     // the last status had an object between the fingers

  std::array<BarStatus, kMemory> memory_{};
  int remembered_ = 0;  // stored statuses, at most kMemory
  int newest_ = 0;
  double look_due_s_ = 0.0;
  double trembling_s_ = 0.0;
};

/// Makes a virtual patient for a bar. @param hand null: the adult median right hand
[[nodiscard]] std::unique_ptr<Player> makeBarPlayer(const Bar& bar, const DeviceModel& device,
                                                    const HandModel* hand,
                                                    const PlayerTraits& traits);

}  // namespace wholehand
