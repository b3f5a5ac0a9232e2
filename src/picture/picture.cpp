#include "picture/picture.hpp"

#include "dynamics/articulated_body.hpp"
#include "picture/camera.hpp"
#include "picture/diorama.hpp"
#include "picture/glow.hpp"
#include "picture/parallel_rows.hpp"
#include "picture/png_file.hpp"
#include "picture/studio.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace wholehand {
namespace {

constexpr int kLargest_px = 8192;
constexpr int kMostSamples = 16;
constexpr float kContrast = 0.035F;  // neighbours that differ more deserve all samples

Diagnostic wrong(const std::string& path, std::string key, std::string value, std::string problem,
                 std::string remedy) {
  return {path, 0, std::move(key), std::move(value), std::move(problem), std::move(remedy)};
}

Diagnostics faults(const PictureRequest& r, const std::string& path) {
  Diagnostics all;
  const auto whole = [&](const char* key, int value, int low, int high) {
    if (value >= low && value <= high) return;
    all.push_back(wrong(path, key, std::to_string(value), "is out of range",
                        "must be in [" + std::to_string(low) + ", " + std::to_string(high) + "]"));
  };
  const auto real = [&](const char* key, double value, bool allowed, const char* range) {
    if (std::isfinite(value) && allowed) return;
    all.push_back(wrong(path, key, std::to_string(value), "is out of range or not finite", range));
  };
  whole("width_px", r.width_px, 1, kLargest_px);
  whole("height_px", r.height_px, 1, kLargest_px);
  whole("samples", r.samples, 1, kMostSamples);
  real("target_m", r.target_m.sum(), r.target_m.allFinite(), "must be finite");
  real("distance_m", r.distance_m, r.distance_m > 0.0, "must be > 0 m");
  real("azimuth_rad", r.azimuth_rad, true, "must be finite");
  real("elevation_rad", r.elevation_rad, true, "must be finite");
  real("field_of_view_rad", r.field_of_view_rad,
       r.field_of_view_rad > 0.0 && r.field_of_view_rad < 3.0, "must be in (0, 3) rad");
  return all;
}

/// What was handed over must fit together before anything is drawn.
Diagnostics misfits(const HandModel& hand, const SceneModel& scene, const JointPosition& theta,
                    const std::vector<BodyState>& bodies, const std::string& path) {
  Diagnostics all;
  if (theta.size() != hand.joint_count || !allFinite(theta)) {
    all.push_back(wrong(path, "theta", std::to_string(theta.size()) + " values",
                        "is not a posture of this hand",
                        "needs " + std::to_string(hand.joint_count) + " finite joint positions"));
  }
  if (hand.links.size() > static_cast<std::size_t>(kMaxLinks)) {
    all.push_back(wrong(path, "links", std::to_string(hand.links.size()), "is too many links",
                        "a hand has at most " + std::to_string(kMaxLinks)));
  }
  if (bodies.size() != scene.bodies.size()) {
    all.push_back(wrong(path, "bodies", std::to_string(bodies.size()), "is not the scene's count",
                        "needs one state for each of " + std::to_string(scene.bodies.size())));
  }
  for (std::size_t i = 0; i < std::min(bodies.size(), scene.bodies.size()); ++i) {
    if (bodies[i].position_m.eigen().allFinite() &&
        bodies[i].orientation_xyzw.eigen().norm() > 1e-6) {
      continue;
    }
    all.push_back(wrong(path, "bodies[" + std::to_string(i) + "]", scene.bodies[i].name,
                        "has no finite pose", "leave the tick that went wrong out"));
  }
  return all;
}

std::vector<Pose> linkPoses(const HandModel& hand, const JointPosition& theta) {
  std::vector<Pose> poses;
  if (hand.links.empty()) return poses;
  ArticulatedBody body(hand);
  body.updateKinematics(theta);
  for (int i = 0; i < static_cast<int>(hand.links.size()); ++i) poses.push_back(body.linkPose(i));
  return poses;
}

/// One sample a pixel first; then all the others where neighbours differ, so that edges are smooth
/// and calm areas cost little.
class Exposure {
 public:
  Exposure(const Studio& studio, const Camera& camera, const PictureRequest& request)
      : studio_(studio), camera_(camera), samples_(request.samples) {
    canvas_.width_px = request.width_px;
    canvas_.height_px = request.height_px;
    canvas_.pixel.resize(static_cast<std::size_t>(request.width_px) *
                         static_cast<std::size_t>(request.height_px));
  }

  Canvas take() {
    const int width = canvas_.width_px, height = canvas_.height_px;
    forEachRow(height, [&](int y) {
      for (int x = 0; x < width; ++x) canvas_.pixel[canvas_.index(x, y)] = sample(x + 0.5, y + 0.5);
    });
    if (samples_ == 1) return canvas_;
    const std::vector<Eigen::Array3f> first = canvas_.pixel;
    forEachRow(height, [&](int y) {
      for (int x = 0; x < width; ++x) {
        if (contrast(first, x, y)) canvas_.pixel[canvas_.index(x, y)] = refined(x, y);
      }
    });
    return canvas_;
  }

 private:
  [[nodiscard]] Eigen::Array3f sample(double x_px, double y_px) const {
    Hit hit;
    const double half = 0.5 * canvas_.height_px;
    const double u = (x_px - 0.5 * canvas_.width_px) / half, v = 1.0 - y_px / half;
    return toneMapped(studio_.trace(camera_.ray(x_px, y_px), u, v, hit)).cast<float>();
  }

  [[nodiscard]] bool contrast(const std::vector<Eigen::Array3f>& first, int x, int y) const {
    const Eigen::Array3f& here = first[canvas_.index(x, y)];
    for (int j = std::max(0, y - 1); j <= std::min(canvas_.height_px - 1, y + 1); ++j) {
      for (int i = std::max(0, x - 1); i <= std::min(canvas_.width_px - 1, x + 1); ++i) {
        if ((first[canvas_.index(i, j)] - here).abs().maxCoeff() > kContrast) return true;
      }
    }
    return false;
  }

  /// Samples spread evenly by the plastic number's sequence (R2), which suits any count.
  [[nodiscard]] Eigen::Array3f refined(int x, int y) const {
    Eigen::Array3f sum = Eigen::Array3f::Zero();
    for (int i = 0; i < samples_; ++i) {
      const double dx = std::fmod(0.5 + 0.7548776662466927 * (i + 1), 1.0);
      const double dy = std::fmod(0.5 + 0.5698402909980532 * (i + 1), 1.0);
      sum += sample(x + dx, y + dy);
    }
    return sum / static_cast<float>(samples_);
  }

  const Studio& studio_;
  const Camera& camera_;
  int samples_;
  Canvas canvas_;
};

/// Eight bits a colour; a fixed dither of one step keeps the backdrop free of bands.
std::vector<std::uint8_t> quantised(const Canvas& canvas) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(canvas.pixel.size() * 3);
  std::uint32_t noise = 0x9E3779B9U;
  for (const Eigen::Array3f& p : canvas.pixel) {
    noise = noise * 1664525U + 1013904223U;
    const float dither = static_cast<float>(noise >> 8) * 0x1p-24F;
    for (int c = 0; c < 3; ++c) {
      bytes.push_back(static_cast<std::uint8_t>(std::clamp(p[c] * 255.0F + dither, 0.0F, 255.0F)));
    }
  }
  return bytes;
}

}  // namespace

Expected<Done> drawPicture(const HandModel& hand, const SceneModel& scene,
                           const JointPosition& theta, const std::vector<BodyState>& bodies,
                           const std::vector<Contact>& contacts, const PictureRequest& request,
                           const std::string& png_path) {
  Diagnostics errors = faults(request, png_path);
  const Diagnostics unfit = misfits(hand, scene, theta, bodies, png_path);
  errors.insert(errors.end(), unfit.begin(), unfit.end());
  if (!errors.empty()) return errors;

  const std::vector<Pose> poses = linkPoses(hand, theta);
  const Pose palm = poses.empty() ? Pose{} : poses[static_cast<std::size_t>(hand.palm_link)];
  const Diorama diorama(SkinField(hand, poses), Sleeve(hand, palm), scene, bodies,
                        request.target_m);
  const Camera camera(request);
  const std::vector<Ember> embers =
      request.show_contacts ? embersOf(contacts) : std::vector<Ember>{};
  const Studio studio(diorama, camera.frame(), embers);
  Canvas canvas = Exposure(studio, camera, request).take();
  drawGlow(embers, diorama, camera, canvas);
  return writePng(png_path, request.width_px, request.height_px, quantised(canvas));
}

}  // namespace wholehand
