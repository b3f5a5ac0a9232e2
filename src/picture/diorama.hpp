#pragma once

#include "core/tick_record.hpp"
#include "model/scene_model.hpp"
#include "picture/skin_field.hpp"
#include "picture/sleeve.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <utility>
#include <vector>

namespace wholehand {

struct Ray {
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< unit

  [[nodiscard]] Eigen::Vector3d at(double t_m) const { return origin_m + t_m * direction; }
};

enum class Surface { kNothing, kFloor, kSkin, kCuff, kCloth, kBody };

struct Hit {
  Surface surface = Surface::kNothing;
  int body = -1;     ///< for kBody: index into the scene's bodies
  double t_m = 0.0;  ///< along the ray
};

/// All that stands before the camera, as signed distances in the world frame: the hand's skin, its
/// sleeve, the bodies, and a floor below them. Bounding spheres keep far things out of a ray.
class Diorama {
 public:
  /// Which things a ray can meet: one bit each.
  using Mask = std::uint64_t;

  /// @pre bodies.size() == scene.bodies.size(); both outlive this
  Diorama(SkinField skin, Sleeve sleeve, const SceneModel& scene,
          const std::vector<BodyState>& bodies, const Eigen::Vector3d& target_m);

  [[nodiscard]] Hit march(const Ray& ray) const noexcept;
  /// Share of a light that reaches a point: 0 in the core of a shadow, 1 outside its penumbra.
  /// @param softness tangent of the light's apparent radius
  [[nodiscard]] double shadow(const Eigen::Vector3d& p_m, const Eigen::Vector3d& to_light,
                              double softness) const noexcept;
  /// Share of the sky seen from a point, near things only.
  [[nodiscard]] double openness(const Eigen::Vector3d& p_m, const Eigen::Vector3d& normal,
                                double reach_m) const noexcept;
  [[nodiscard]] Eigen::Vector3d normal(const Hit& hit, const Eigen::Vector3d& p_m) const noexcept;

  [[nodiscard]] const SkinField& skin() const noexcept { return skin_; }
  [[nodiscard]] const Sleeve& sleeve() const noexcept { return sleeve_; }
  [[nodiscard]] const SceneModel& scene() const noexcept { return *scene_; }
  /// Centre and half width [m] of the square of floor that shadows of near things may reach.
  [[nodiscard]] std::pair<Eigen::Vector2d, double> shadowArea(const Eigen::Vector3d& to_lamp,
                                                              double softness) const;
  [[nodiscard]] double floorHeight() const noexcept { return floor_m_; }

 private:
  struct Thing {
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    double radius = 0.0;
    Surface surface = Surface::kNothing;
    int body = -1;
  };
  struct Span {
    Mask mask = 0;
    double near_m = 0.0, far_m = 0.0;
  };

  void addBody(const SceneBody& body, const BodyState& state, int index);
  void layFloor();
  [[nodiscard]] bool inPicture(const Thing& t) const;
  [[nodiscard]] Span span(const Ray& ray, double margin_m, double softness) const noexcept;
  /// A lower bound of the distance, and the distance itself.
  [[nodiscard]] double thing(const Thing& t, const Eigen::Vector3d& p_m) const noexcept;
  [[nodiscard]] double whole(const Thing& t, const Eigen::Vector3d& p_m) const noexcept;
  [[nodiscard]] double body(int index, const Eigen::Vector3d& p_m) const noexcept;
  [[nodiscard]] double nearest(Mask mask, const Eigen::Vector3d& p_m,
                               std::size_t& which) const noexcept;

  SkinField skin_;
  Sleeve sleeve_;
  const SceneModel* scene_;
  std::vector<Thing> things_;
  std::vector<Pose> to_body_;  // world to body frame, per body
  Eigen::Vector3d target_m_;
  double floor_m_ = 0.0;
};

}  // namespace wholehand
