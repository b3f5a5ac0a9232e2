#include "picture/camera.hpp"

#include <Eigen/Geometry>

#include <cmath>

namespace wholehand {

using Eigen::Vector3d;

Camera::Camera(const PictureRequest& request)
    : focal_px_(0.5 * request.height_px / std::tan(0.5 * request.field_of_view_rad)),
      center_x_px_(0.5 * request.width_px),
      center_y_px_(0.5 * request.height_px) {
  const double az = request.azimuth_rad, el = request.elevation_rad;
  const Vector3d to_eye(-std::cos(el) * std::cos(az), -std::cos(el) * std::sin(az), std::sin(el));
  frame_.eye_m = request.target_m + request.distance_m * to_eye;
  frame_.forward = -to_eye;
  // From azimuth alone, so that looking straight down is no special case.
  frame_.right = Vector3d(std::sin(az), -std::cos(az), 0.0);
  frame_.up = frame_.right.cross(frame_.forward);
}

Ray Camera::ray(double x_px, double y_px) const {
  const Vector3d d = focal_px_ * frame_.forward + (x_px - center_x_px_) * frame_.right -
                     (y_px - center_y_px_) * frame_.up;
  return {frame_.eye_m, d.normalized()};
}

Vector3d Camera::project(const Vector3d& p_m) const {
  const Vector3d q = p_m - frame_.eye_m;
  const double depth = q.dot(frame_.forward);
  if (depth <= 0.0) return {0.0, 0.0, depth};
  return {center_x_px_ + focal_px_ * q.dot(frame_.right) / depth,
          center_y_px_ - focal_px_ * q.dot(frame_.up) / depth, depth};
}

}  // namespace wholehand
