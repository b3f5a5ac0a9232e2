#pragma once

#include "exercise/cocktail_bar/bar_view.hpp"
#include "patient/player.hpp"
#include "patient/reach.hpp"

#include <array>
#include <cstdint>
#include <memory>

namespace wholehand {

/// A virtual patient who plays the cocktail bar by what is seen in the records, a reaction time
/// late: draws back while row or glass slide, comes to the dispenser from behind and beside it,
/// closes the hand, squeezes as the meter asks, anticipates the line and lets go, draws back. A
/// free dispenser is lifted until its nozzle is over the glass and put back. A squeeze that
/// brings nothing into the glass is given up; a grasp that fails is tried again with another aim,
/// which may be farther off every time. The seed says where the hand starts, how well it aims, how
/// strongly and how fast this person acts, and how the hand trembles. Deterministic.
class BarPlayer final : public Player {
 public:
  BarPlayer(const BarView& view, std::uint64_t seed);

  [[nodiscard]] AxisPosition start() const override { return start_; }
  void reset() override;
  WHOLEHAND_RT void advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept override;
  WHOLEHAND_RT void see(const TickRecord& record) noexcept override;

 private:
  /// What the person is doing. Of each one knows what comes next.
  enum class Doing {
    kDrawBack,  ///< straight back, away from the row
    kWait,      ///< drawn back, until there is something to reach for
    kAlign,     ///< sideways, drawn back, to where the way in is free
    kEnter,     ///< beside the dispenser, fingers stretched
    kTouch,     ///< the palm against it
    kSqueeze,   ///< closes, and presses by what is felt
    kEase,      ///< a free one: presses less, and holds
    kOpen,
    kLeave,   ///< sideways off the dispenser
    kLift,    ///< a free one: up ...
    kCarry,   ///< ... over the glass ...
    kReturn,  ///< ... back ...
    kLower    ///< ... and down
  };

  /// How this person is; drawn from the seed.
  struct Character {
    double reaction_s = 0.2;
    double pace = 1.0;       ///< of every movement
    double share = 0.5;      ///< of the zone "just right" that is aimed for
    double aim_m = 0.002;    ///< how far an aim may be off
    double judgement = 1.0;  ///< of what will still flow when the hand lets go: 1 is right
    double tremor_m = 0.0;   ///< amplitude of the arm; the fingers' is its tenfold in rad
    double tremor_rad_s = 50.0;
    double tremor_phase = 0.0;
  };

  /// Glances of the last kMemory milliseconds.
  static constexpr int kMemory = 512;
  static constexpr double kGlance_s = 1e-3;

  double draw() noexcept;  // 0 .. 1
  double draw(double low, double high) noexcept;
  [[nodiscard]] const BarGlance& remember() const noexcept;
  void decide(const BarGlance& seen, const TickRecord& record) noexcept;
  void next(const BarGlance& seen, const TickRecord& record) noexcept;
  void pressBy(const BarGlance& seen) noexcept;
  void press(double period_s) noexcept;
  void go(Doing doing) noexcept;
  [[nodiscard]] double back_m() const noexcept;
  [[nodiscard]] bool drawnBack() const noexcept;
  [[nodiscard]] AxisPosition goalOf(Doing doing) const noexcept;
  void shape(Doing doing) noexcept;
  [[nodiscard]] double durationTo(const AxisPosition& goal) const noexcept;
  void aimAt(const TickRecord& record, int dispenser) noexcept;
  void noteGrasp(const BarGlance& seen) noexcept;
  void aimOverGlass(const TickRecord& record) noexcept;
  [[nodiscard]] bool comeNear(const TickRecord& record) noexcept;
  void tremble(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept;
  [[nodiscard]] bool wantsToGrasp(const BarGlance& seen) const noexcept;

  BarView view_;
  std::uint64_t seed_;
  std::uint64_t random_ = 0;
  Character character_;
  AxisPosition start_;

  Doing doing_ = Doing::kWait;
  double since_s_ = 0.0;  // that it is done
  double period_s_ = 1e-3;
  bool advanced_ = false;  // since the last record
  bool lost_ = false;      // somebody else moved the hand ...
  bool near_ = false;      // ... to a dispenser
  Reach reach_;
  AxisPosition q_;
  AxisVelocity qd_;

  int dispenser_ = -1;  // the one that is grasped for, -1: none yet
  int drink_ = -1, step_ = -1;
  int tries_ = 0;                                   // squeezes of this grasp
  int failures_ = 0;                                // grasps in a row that brought nothing
  double poured_before_l_ = 0.0;                    // this grasp
  double poured_l_ = 0.0;                           // when it last was worth the while ...
  double vain_s_ = 0.0;                             // ... so long ago
  bool lifted_ = false;                             // a free dispenser is over the glass
  Eigen::Vector3d grip_ = Eigen::Vector3d::Zero();  // where the base is to be
  Eigen::Vector3d over_ = Eigen::Vector3d::Zero();  // a free one: where it pours
  double share_ = 0.5;                              // of the zone, of this squeeze
  double settled_s_ = 0.0;                          // how long a hold was as it should be
  double fingers_ = 0.0, thumb_ = 0.0;     // their aim while they press; thumb at half bent
  double rate_ = 0.0, wanted_rate_ = 0.0;  // of the fingers' aim [rad/s]
  bool grips_ = false;                     // as seen last: something is felt between the fingers

  std::array<BarGlance, kMemory> memory_{};
  int remembered_ = 0;  // glances so far, at most kMemory
  int newest_ = 0;
  double glance_due_s_ = 0.0;
  double trembling_s_ = 0.0;
};

/// A virtual patient for a bar. @param hand null: the adult median right one
[[nodiscard]] std::unique_ptr<Player> makeBarPlayer(const Bar& bar, const DeviceModel& device,
                                                    const HandModel* hand, std::uint64_t seed);

}  // namespace wholehand
