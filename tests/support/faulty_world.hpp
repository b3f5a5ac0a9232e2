#pragma once

#include "loop/physics/physics_world.hpp"

#include <limits>

namespace wholehand::test {

/// A fault of a world in one tick (counted by observations since the hand was placed).
struct InjectedWorldFault {
  enum class Kind {
    kNonFiniteState,  ///< a joint is NaN, and the engine reports it
    kSilentNan,       ///< a coordinate of the hand is NaN, and the engine does not notice
    kSilentNanJoint,  ///< a joint is NaN, and the engine does not notice
    kStepFails,       ///< the engine cannot step and does not
    kBodyExplodes,    ///< the first body flies off; a world without bodies shows one
    kHandFliesOff     ///< one coordinate of the hand is a hundred times too fast
  };
  Kind kind = Kind::kStepFails;
  int tick = 0;
  int axis = 0;  ///< of the hand coordinate that flies off
};

/// Forwards everything to another world except the injected fault.
class FaultyWorld final : public PhysicsWorld {
 public:
  /// @pre world outlives this
  FaultyWorld(PhysicsWorld& world, InjectedWorldFault fault) : world_(world), fault_(fault) {}

  [[nodiscard]] Expected<Done> placeHand(const AxisPosition& q_s) override {
    tick_ = -1;
    steps_ = 0;
    return world_.placeHand(q_s);
  }

  [[nodiscard]] Fault observe(PhysicsState& state) noexcept override {
    ++tick_;
    const Fault fault = world_.observe(state);
    if (now(InjectedWorldFault::Kind::kNonFiniteState)) {
      state.q_s[0] = state.theta[0] = std::numeric_limits<double>::quiet_NaN();
      return fault | Fault::kNonFiniteState;
    }
    if (now(InjectedWorldFault::Kind::kSilentNan)) {
      state.q_s[0] = std::numeric_limits<double>::quiet_NaN();
    }
    if (now(InjectedWorldFault::Kind::kSilentNanJoint)) {
      state.theta[state.theta.size() - 1] = std::numeric_limits<double>::quiet_NaN();
    }
    if (now(InjectedWorldFault::Kind::kHandFliesOff)) state.qd_s[fault_.axis] = 1e3;
    if (fault_.kind == InjectedWorldFault::Kind::kBodyExplodes) {
      if (state.body_count == 0) {
        state.body_count = 1;
        state.bodies[0] = BodyState{};
      }
      if (tick_ >= fault_.tick) state.bodies[0].velocity_m_s.z += 50.0;
    }
    return fault;
  }

  void placeBodies(const BodyPlacements& placements) noexcept override {
    world_.placeBodies(placements);
  }

  [[nodiscard]] Fault step(const HandDrive& drive, double period_s) noexcept override {
    if (now(InjectedWorldFault::Kind::kStepFails)) return Fault::kPhysicsStep;
    ++steps_;
    return world_.step(drive, period_s);
  }

  void contacts(ContactList& contacts) const noexcept override { world_.contacts(contacts); }

  void selfForces(SelfForces& forces) const noexcept override { world_.selfForces(forces); }

  /// Removes the fault.
  void clear() noexcept { fault_.tick = std::numeric_limits<int>::max(); }
  /// Number of steps of the wrapped world since the hand was placed.
  [[nodiscard]] int steps() const noexcept { return steps_; }

 private:
  [[nodiscard]] bool now(InjectedWorldFault::Kind kind) const noexcept {
    return fault_.kind == kind && fault_.tick == tick_;
  }

  PhysicsWorld& world_;
  InjectedWorldFault fault_;
  int tick_ = -1;
  int steps_ = 0;
};

}  // namespace wholehand::test
