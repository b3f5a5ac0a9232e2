#pragma once

#include "loop/control/energy_tank.hpp"
#include "loop/core/geometry.hpp"
#include "loop/core/real_time.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/model/scene_model.hpp"

#include <Eigen/Core>

#include <vector>

namespace wholehand {

/// Energy of a game's bodies, as the pool that moves them reports it.
struct PoolEnergy {
  double held_j = 0.0;  ///< their kinetic energy
  /// Energy put in since the last report by gravity, the game and its orders.
  double received_j = 0.0;
};

/// Energy of the bodies of a world, computed from their states, whatever the engine:
///   held      K = Σ ½ m v² + ½ ω·I ω of the moving bodies, plus the energy that springs and
///             latches of their joints store: a person who stretched a spring may get it back
///   received  W = Σ m g·½(v⁻ + v) T, plus the energy that placements add to K, plus f·v T of
///             fixed bodies that an exercise moves against the hand
///   gained    ΔK − W − work of the hand, −Σ f·½(u⁻ + u) T at its contacts. Contacts and friction
///             make it at most 0. While a fixed body moves, its push on other bodies is not known;
///             a gain then counts as received.
class BodyEnergy {
 public:
  BodyEnergy(const SceneModel& scene, double period_s);

  /// Forgets the last states. Real-time safe.
  void clear() noexcept { known_ = false; }
  /// Updates the energies from the states after a step. Call once a tick.
  /// @param contacts contacts of that step
  WHOLEHAND_RT void advance(const TickRecord& observed, const Contact* contacts, int contact_count,
                            const PoolEnergy& pool) noexcept;
  /// Notes the bodies that are placed before the next step. @param observed the record that
  /// advance() got
  WHOLEHAND_RT void notePlaced(const BodyPlacements& placements,
                               const TickRecord& observed) noexcept;

  [[nodiscard]] const WorldEnergy& energy() const noexcept { return energy_; }
  /// Energy that the bodies gained in the last step without a source [J]; at most 0 in a passive
  /// world.
  [[nodiscard]] double gained_j() const noexcept { return gained_j_; }

 private:
  struct Body {
    double mass_kg = 0.0;  ///< 0: fixed
    Eigen::Matrix3d inertia_kg_m2 = Eigen::Matrix3d::Zero();
    Vec3 velocity_m_s, spin_rad_s;  ///< after the last step, or as placed since
    double kinetic_j = 0.0;
    int store = -1;  ///< index into stores_; -1: none
  };
  /// Spring and latch of a body's joint.
  struct Store {
    SceneJoint joint;
    Pose start;             ///< pose of the body frame at q = 0
    Eigen::Vector3d com_m;  ///< centre of mass, body frame
    double q = 0.0;
    double stored_j = 0.0;  ///< after the last step, or as placed since

    void put(const Pose& pose) noexcept;
    /// Like put(), for a body that moved there: whole turns of a hinge count.
    void follow(const Pose& pose) noexcept;
    /// Pose of the body frame of a body whose centre of mass is there.
    [[nodiscard]] Pose poseAt(const Vec3& position_m, const QuatXyzw& turned) const noexcept;
  };
  [[nodiscard]] static double kinetic(const Body& body, const BodyState& state) noexcept;
  [[nodiscard]] double workOfHand(const TickRecord& observed, const Contact* contacts,
                                  int contact_count) noexcept;

  std::vector<Body> bodies_;  ///< the scene's bodies, as many as a record holds
  std::vector<int> free_;     ///< indices of the bodies that move
  std::vector<Store> stores_;
  Eigen::Vector3d gravity_m_s2_;
  double period_s_;
  double placed_j_ = 0.0;     ///< energy received by placements since the last step
  double pool_held_j_ = 0.0;  ///< energy of the pool after the last step
  bool pushes_ = false;       ///< a fixed body moves in this step
  bool known_ = false;        ///< the values of the last step are valid
  WorldEnergy energy_;
  double gained_j_ = 0.0;
};

}  // namespace wholehand
