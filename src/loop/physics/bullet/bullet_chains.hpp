#pragma once

#include "loop/model/scene_model.hpp"
#include "loop/physics/bullet/bullet_bodies.hpp"
#include "loop/physics/bullet/reduced_contact_solver.hpp"
#include "loop/physics/bullet/resting_bodies.hpp"
#include "loop/physics/joint_chain.hpp"

#include <memory>
#include <vector>

namespace wholehand::bullet {

/// The trees of joints of a scene, and the bodies that they move. Real-time safe except for
/// construction and addTo().
class BulletChains {
 public:
  /// @pre bodies outlive this
  BulletChains(const SceneModel& scene, std::vector<BulletBody>& bodies);

  [[nodiscard]] bool any() const noexcept { return !trees_.empty(); }
  void addTo(ReducedContactSolver& solver);
  /// Begins a step of the trees that are awake. @param touched per body: a contact may act on it
  void predict(const RestingBodies& resting, const std::vector<char>& touched,
               double step_s) noexcept;
  /// Ends the step.
  void finish(const RestingBodies& resting, double step_s) noexcept;

 private:
  struct Tree {
    std::unique_ptr<JointChain> chain;
    std::vector<int> members;         ///< bodies of the scene; the first one is the lead
    std::vector<BulletBody*> bodies;  ///< the same
  };
  std::vector<Tree> trees_;
};

}  // namespace wholehand::bullet
