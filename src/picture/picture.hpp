#pragma once

#include "core/axis_array.hpp"
#include "core/expected.hpp"
#include "core/tick_record.hpp"
#include "model/hand_model.hpp"
#include "model/scene_model.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// What a picture shows and from where.
struct PictureRequest {
  int width_px = 960, height_px = 640;
  /// Camera: looks at `target_m` from `distance_m` away; azimuth about z from -x (the person's
  /// side, 0 looks along +x), elevation above the horizon; vertical field of view.
  Eigen::Vector3d target_m = Eigen::Vector3d::Zero();
  double distance_m = 0.5, azimuth_rad = 0.0, elevation_rad = 0.35, field_of_view_rad = 0.5;
  bool show_contacts = true;  ///< amber glow whose size follows the force
  int samples = 4;            ///< anti-aliasing, per pixel
};

/// Draws the hand (smooth skin over the very capsules that collide), the bodies and the contacts of
/// one tick, and writes a PNG. No graphics card: signed distances are ray-marched on the CPU.
[[nodiscard]] Expected<Done> drawPicture(const HandModel& hand, const SceneModel& scene,
                                         const JointPosition& theta,
                                         const std::vector<BodyState>& bodies,
                                         const std::vector<Contact>& contacts,
                                         const PictureRequest& request,
                                         const std::string& png_path);

}  // namespace wholehand
