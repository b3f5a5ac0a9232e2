#pragma once

#include "picture/diorama.hpp"
#include "picture/picture.hpp"
#include "picture/studio.hpp"

#include <Eigen/Core>

namespace wholehand {

/// A pinhole camera that a PictureRequest describes. Pixel (0, 0) is the top left corner of the top
/// left pixel; pixel centres lie at + 0.5.
class Camera {
 public:
  explicit Camera(const PictureRequest& request);

  [[nodiscard]] Ray ray(double x_px, double y_px) const;
  /// Place of a point in the picture; z is its distance along the line of sight [m], <= 0 behind.
  [[nodiscard]] Eigen::Vector3d project(const Eigen::Vector3d& p_m) const;
  /// Size in the picture of a length that faces the camera [px/m].
  [[nodiscard]] double scale(double depth_m) const noexcept { return focal_px_ / depth_m; }
  [[nodiscard]] const CameraFrame& frame() const noexcept { return frame_; }

 private:
  CameraFrame frame_;
  double focal_px_, center_x_px_, center_y_px_;
};

}  // namespace wholehand
