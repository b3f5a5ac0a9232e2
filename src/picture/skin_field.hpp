#pragma once

#include "core/geometry.hpp"
#include "model/hand_model.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

namespace wholehand {

/// How the skin is drawn over the colliders. Lengths in metres.
struct SkinRecipe {
  double blend_m = 0.005;        ///< smooth union of what is drawn
  double digit_light_m = 0.007;  ///< softer union of what is lit: within a digit
  double palm_light_m = 0.019;   ///< and within the palm, and of a digit with the palm
  double thumb_share = 0.9;      ///< the thumb blends a little less than the palm does
  double leave_m = 0.00045;      ///< how far the skin may leave the colliders, out or in
  double clamp_m = 0.0005;       ///< rounding of that limit
  double nail_m = 0.0003;        ///< thickness of a nail
};

/// What the skin is like at a point of its surface; every share in 0 .. 1.
struct SkinLook {
  double palmar = 0.0;   ///< along the normal: 1 on the palm side, 0 at the back
  double fold = 0.0;     ///< depth inside a crease
  double redness = 0.0;  ///< fingertips and knuckles
  double crease = 0.0;   ///< flexion lines across the palm side of a joint
  double nail = 0.0;     ///< share of nail
};

/// The skin of a posed hand as a signed distance field over the very capsules that collide:
/// negative inside, metres, world frame. Digits taper from joint to joint and blend with the palm,
/// never with each other; the surface is never more than SkinRecipe::leave_m away from the
/// colliders.
///
/// A grid of sampled distances lets rays cross empty space in large steps, and each of its blocks
/// lists the few capsules that shape the skin there.
class SkinField {
 public:
  /// @param link_poses world pose of every link of the hand
  SkinField(const HandModel& hand, const std::vector<Pose>& link_poses, SkinRecipe recipe = {});

  [[nodiscard]] bool empty() const noexcept { return capsules_.empty(); }
  /// Distance to the union of the colliders.
  [[nodiscard]] double colliders(const Eigen::Vector3d& p_m) const noexcept;
  /// Distance to the drawn skin, exact within 3 mm of it; elsewhere that to the colliders, short by
  /// at most 2 mm.
  [[nodiscard]] double skin(const Eigen::Vector3d& p_m) const noexcept;
  /// The same without leaving room for error: hardly jumps from place to place, for shadows.
  [[nodiscard]] double estimate(const Eigen::Vector3d& p_m) const noexcept;
  /// A smooth estimate of the distance, right to about half a millimetre: for occlusion.
  [[nodiscard]] double roughly(const Eigen::Vector3d& p_m) const noexcept;
  /// Unit normal that light sees: of the softer union, so that light looks like skin while the
  /// geometry stays honest; of the drawn surface on nails.
  [[nodiscard]] Eigen::Vector3d lightNormal(const Eigen::Vector3d& p_m) const noexcept;
  [[nodiscard]] SkinLook look(const Eigen::Vector3d& p_m,
                              const Eigen::Vector3d& normal) const noexcept;

  [[nodiscard]] const Eigen::Vector3d& center() const noexcept { return center_m_; }
  [[nodiscard]] double radius() const noexcept { return radius_m_; }

 private:
  static constexpr double kNode_m = 0.004;               // spacing of the sampled distances
  static constexpr int kBlockNodes = 2;                  // a block of candidates is 8 mm wide
  static constexpr double kBlockHalfDiagonal_m = 0.007;  // of 8 mm
  static constexpr double kNear_m = 0.003;               // the skin is exact up to here

  struct Placed {
    Eigen::Vector3d a, ab, palmar;
    double inverse_length2, length, radius;
    double skin_radius_a = 0.0,
           skin_radius_b = 0.0;  // tapered towards the neighbours of the same digit
    Eigen::Vector3d bend = Eigen::Vector3d::Zero();  // own direction less that of the one before
    HandPart part;
    bool tip, joined = false;  // joined: begins where an earlier capsule of the digit ends
  };
  struct Nail {
    Eigen::Vector3d root, along, dorsal, side, center;
    double radius, segment;
  };
  struct List {
    std::uint32_t first = 0, count = 0;  // in candidates_
  };
  struct Block {
    List drawn, lit;  // both empty where no skin is near
  };

  void place(const HandModel& hand, const std::vector<Pose>& link_poses);
  void addNail(const Placed& distal);
  void taper();
  void bound();
  void sampleGrid();
  void listCandidates();
  List candidates(const Eigen::Vector3d& middle, double blend_m);
  [[nodiscard]] double capsule(const Placed& c, const Eigen::Vector3d& p) const noexcept;
  /// Width of the blend of a capsule with those of its part before it.
  [[nodiscard]] double blend(const Placed& c, const Eigen::Vector3d& p, double within_digit,
                             double with_palm) const noexcept;
  [[nodiscard]] const Block* block(const Eigen::Vector3d& p) const noexcept;
  [[nodiscard]] double blended(const List& list, const Eigen::Vector3d& p, double within_digit,
                               double with_palm, double& hard) const noexcept;
  [[nodiscard]] double soft(const Eigen::Vector3d& p) const noexcept;
  [[nodiscard]] double nailShare(const Eigen::Vector3d& p) const noexcept;

  SkinRecipe recipe_;
  std::vector<Placed> capsules_;
  std::vector<Nail> nails_;
  Eigen::Vector3d low_m_, high_m_;  ///< tight box of the colliders
  Eigen::Vector3d center_m_ = Eigen::Vector3d::Zero();
  double radius_m_ = 0.0;
  Eigen::Vector3d origin_m_;
  Eigen::Array3i nodes_{0, 0, 0}, blocks_{0, 0, 0};
  std::vector<float> sampled_m_;
  std::vector<Block> block_;
  std::vector<std::uint16_t> candidates_;
};

}  // namespace wholehand
