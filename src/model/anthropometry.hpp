#pragma once

#include "model/hand_model.hpp"

#include <Eigen/Core>

#include <array>
#include <string>
#include <vector>

namespace wholehand {

/// The size of a hand against the median one whose tables are in anthropometry.cpp.
struct Proportions {
  double length = 1.0;   ///< hand length / 188 mm: stretches along x (distal) and phalanx lengths
  double breadth = 1.0;  ///< hand breadth / 85 mm: stretches along y and z, and radii
};
/// @param length_m wrist crease to middle fingertip  @param breadth_m across the knuckles
[[nodiscard]] Proportions proportions(double length_m, double breadth_m) noexcept;

/// A digit of three segments, right hand. Palm frame: x distal, y radial, z dorsal.
struct Digit {
  std::string name;  ///< "index", ..., "thumb"
  HandPart part = HandPart::kIndex;
  std::array<std::string, 3> segments;       ///< names of the capsules without the digit
  std::array<std::string, 3> joints;         ///< the flexion that carries each segment
  std::array<double, 3> joint_to_joint_m{};  ///< the last one: to the fingertip
  std::array<double, 3> segment_m{};         ///< of the capsule's axis, from its joint
  std::array<double, 3> radius_m{};
  Eigen::Vector3d base_m = Eigen::Vector3d::Zero();  ///< first joint in the palm frame
  double abduction_rad = 0.0;  ///< fixed turn about dorsal, towards radial (fingers)
  double tilt_rad = 0.0;       ///< fixed turn of the flexion plane about the finger (fingers)
};

/// A collider that does not move against the palm, or not against the first part of a digit.
struct PlacedCapsule {
  std::string name;
  HandPart part = HandPart::kPalm;
  Eigen::Vector3d a_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d b_m = Eigen::Vector3d::Zero();
  double radius_m = 0.0;
  bool has_mass = true;  ///< false: skin over mass counted elsewhere, or the forearm's
};

/// Index, middle, ring, little.
[[nodiscard]] std::array<Digit, 4> fingers(const Proportions& size);
/// The thumb: metacarpal, proximal, distal; base_m is its carpometacarpal joint.
[[nodiscard]] Digit thumb(const Proportions& size);
/// Thumb at zero circumduction, turned about -x from the plane of the palm [rad].
[[nodiscard]] double thumbRestCircumduction() noexcept;
/// Direction of the straight thumb before circumduction, from distal towards radial [rad].
[[nodiscard]] double thumbPointing() noexcept;

/// Palm, knuckle webs, first web and wrist, in the palm frame of a right hand [m].
[[nodiscard]] std::vector<PlacedCapsule> palmCapsules(const Proportions& size);
/// The three webs between the fingers; web i rides on the first phalanx of finger i, in the frame
/// of that link.
[[nodiscard]] std::array<PlacedCapsule, 3> fingerWebs(const Proportions& size);
/// The thenar muscle, in the frame that circumduction turns: x distal, y along the radial plane.
[[nodiscard]] PlacedCapsule thenarCapsule(const Proportions& size);

/// The hinge joints a hand has, in the order of the links.
[[nodiscard]] const std::vector<std::string>& handJointNames();
/// The capsules a hand has.
[[nodiscard]] const std::vector<std::string>& handCapsuleNames();

}  // namespace wholehand
