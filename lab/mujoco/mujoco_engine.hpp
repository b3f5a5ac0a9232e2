#pragma once

#include "lab/mujoco/hand_map.hpp"
#include "lab/mujoco/reduced_constraints.hpp"
#include "loop/model/scene_model.hpp"
#include "loop/physics/physics_world.hpp"

#include <memory>
#include <mujoco/mujoco.h>
#include <string>
#include <vector>

namespace wholehand::mujoco {

struct Deleter {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
  void operator()(mjData* data) const { mj_deleteData(data); }
};

/// MuJoCo's model and data with the hand and the scene's bodies; MujocoWorld steps it.
class MujocoEngine {
 public:
  /// Compiles the model and allocates all memory. An error names the part that MuJoCo does not
  /// accept.
  /// @pre hand outlives the engine
  [[nodiscard]] static Expected<std::unique_ptr<MujocoEngine>> build(
      const HandModel& hand, const SceneModel& scene, const SolverSettings& settings);

  MujocoEngine(const MujocoEngine&) = delete;
  MujocoEngine& operator=(const MujocoEngine&) = delete;

  /// Places the hand at rest. @return its overlaps with bodies
  [[nodiscard]] Diagnostics placeHand(const AxisPosition& position);
  WHOLEHAND_RT void place(const BodyPlacement& placement) noexcept;
  [[nodiscard]] WHOLEHAND_RT BodyState body(int index) const noexcept;
  /// Advances by one step. False when MuJoCo reports an error.
  [[nodiscard]] WHOLEHAND_RT bool step(const HandDrive& drive, double period_s) noexcept;
  WHOLEHAND_RT void contacts(ContactList& contacts) const noexcept;
  WHOLEHAND_RT void selfForces(SelfForces& forces) const noexcept;

  [[nodiscard]] int bodyCount() const noexcept { return static_cast<int>(bodies_.size()); }
  [[nodiscard]] const std::vector<std::string>& bodyNames() const noexcept { return body_names_; }
  [[nodiscard]] const std::string& scenePath() const noexcept { return scene_path_; }
  /// For measurements of the cost of a setting.
  [[nodiscard]] mjModel& model() noexcept { return *model_; }
  [[nodiscard]] const mjData& data() const noexcept { return *data_; }
  /// Coordinates of the hand before the next step.
  AxisPosition q_s;
  AxisVelocity qd_s;
  double coupling_error_rad = 0.0;

 private:
  MujocoEngine(const HandModel& hand, const SceneModel& scene, const SolverSettings& settings,
               mjModel* model);

  /// Owner of a geom: a capsule of the hand or a body of the scene.
  struct Owner {
    int capsule = -1, body = -1;
    double friction = 0.0;
  };
  struct Body {
    int position = -1, dof = -1;  ///< in qpos and qvel; -1: fixed
    int mocap = -1;               ///< -1: a free body
    int id = -1;
    double mass_kg = 0.0;
    double damping_per_s = 0.0;
    Eigen::Vector3d before_m = Eigen::Vector3d::Zero();  ///< position of its frame before the step
    /// Orientation of its frame before the step.
    Eigen::Quaterniond turned = Eigen::Quaterniond::Identity();
    /// Velocity of a fixed body in one step.
    Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();
  };

  void listGeoms(const SceneModel& scene);
  void listBodies(const SceneModel& scene);
  void pairSelf();
  WHOLEHAND_RT void findContacts() noexcept;
  WHOLEHAND_RT void checkContact(int index) noexcept;
  WHOLEHAND_RT void dampBodies(double period_s) noexcept;
  [[nodiscard]] WHOLEHAND_RT bool advance(double period_s) noexcept;
  [[nodiscard]] WHOLEHAND_RT bool integrate(double period_s) noexcept;
  WHOLEHAND_RT void kickByGravityOnly() noexcept;
  WHOLEHAND_RT void moveFreely(const Body& body, double period_s) noexcept;
  [[nodiscard]] const Owner& owner(int geom) const noexcept { return owners_[geom]; }

  std::unique_ptr<mjModel, Deleter> model_;
  std::unique_ptr<mjData, Deleter> data_;
  HandMap map_;
  ReducedConstraints constraints_;
  SolverSettings settings_;
  std::string scene_path_;
  std::vector<std::string> body_names_;
  std::vector<Owner> owners_;
  std::vector<Body> bodies_;
  std::vector<int> self_pair_;    ///< per pair of capsules, index into self_contacts; -1: none
  std::vector<char> let_go_;      ///< pairs that overlapped when the hand was placed
  std::vector<char> still_deep_;  ///< those of let_go_ that still overlap in this step
  std::vector<double> surface_velocity_;  ///< 3 numbers per contact
  int overflows_ = 0;                     ///< least number of contacts dropped in the last step
};

}  // namespace wholehand::mujoco
