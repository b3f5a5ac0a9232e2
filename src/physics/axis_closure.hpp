#pragma once

#include "core/axis_array.hpp"
#include "core/real_time.hpp"
#include "core/tick_record.hpp"
#include "model/scene_model.hpp"
#include "physics/closing_chain.hpp"
#include "physics/segment_distance.hpp"

#include <vector>

namespace wholehand {

/// First touch of each hand axis with a body: with the base and the other axes where the avatar has
/// them, the axis is moved alone from its lower end, where the hand is open, to its upper one;
/// first touch is the least position at which the surface of a capsule that the axis moves meets
/// the body's. Minus infinity where they overlap at the lower end already: a hand that is more
/// closed did not come there by closing on to the body. NaN where they never meet, on axes that
/// carry the palm, and until it is found.
///
/// A touch once found is followed with one Newton step a tick. Beside that the whole travel is
/// searched again and again, a few distances a tick, by conservative advancement: a convex body
/// lies behind the plane through its nearest point, and a capsule whose gap to that is d cannot
/// touch before it has gone d towards it. So an earlier touch is seen and a
/// lost one replaced within one search, and as long keeps its last value; capsules that pass by
/// are no touch however near. For a hand that stays, all axes are right to 0.1 mm of path within
/// 50 ms. What it gives is a function of the calls since reset() and what they were told, nothing
/// else.
class AxisClosure {
 public:
  AxisClosure(const HandModel& hand, const SceneModel& scene);

  /// Forgets what was found. Real-time safe.
  WHOLEHAND_RT void reset() noexcept;

  /// One tick. @param links poses of the hand's links at theta @param body index in the scene, -1:
  /// not asked
  /// @param closure first touch per axis. Real-time safe.
  WHOLEHAND_RT void update(const Pose* links, const JointPosition& theta, const AxisPosition& q_s,
                           int body, const BodyState* bodies, AxisPosition& closure) noexcept;

 private:
  /// A capsule that an axis moves and a shape of the body.
  struct Pair {
    int chain = -1, shape = -1;
  };
  struct Axis {
    int index = -1;  ///< of the device
    double lower = 0.0, upper = 0.0;
    std::vector<ClosingChain> chains;
    bool follows = false;  ///< touch is one, of `pair`; otherwise it is an old one or NaN
    double touch = 0.0;
    Pair pair;
  };
  /// What a tick looks at.
  struct Scene {
    const Pose* links;
    const JointPosition* theta;
    const AxisPosition* q_s;
    const SceneBody* body;
    Pose from_world;  ///< into the body's frame
  };
  /// Where a pair is, with the axis somewhere.
  struct Gap {
    ClosingChain::Placed at;
    SegmentDistance is;
    double slope;  ///< change of the distance per unit of the axis
  };

  [[nodiscard]] bool jumped(const Scene& scene) noexcept;
  void follow(const Scene& scene, Axis& axis) noexcept;
  void search(const Scene& scene) noexcept;
  void beginSearch() noexcept;
  [[nodiscard]] int look(const Scene& scene, Axis& axis, Pair pair, double& clear) noexcept;
  static void meet(Axis& axis, Pair pair, double touch) noexcept;
  [[nodiscard]] static int refine(const Scene& scene, const Axis& axis, Pair pair,
                                  double& q) noexcept;
  [[nodiscard]] static double clearFor(const ClosingChain& chain, const Gap& gap) noexcept;
  static void measure(const Scene& scene, const Axis& axis, Pair pair, double q, double share,
                      Gap& gap) noexcept;

  std::vector<SceneBody> bodies_;
  std::vector<Axis> axes_;  ///< of the hand, those that move capsules
  int axis_count_ = 0;
  int palm_link_ = 0;
  int body_ = -1;

  Pose palm_in_body_;  ///< one tick ago
  AxisPosition q_s_;

  int searched_ = 0;           ///< of axes_
  std::vector<double> clear_;  ///< per pair: no touch below this
};

}  // namespace wholehand
