#pragma once

#include "loop/model/hand_model.hpp"
#include "loop/model/scene_model.hpp"

#include <Eigen/Core>

#include <array>
#include <string>
#include <vector>

namespace wholehand {

/// Size of a hand relative to the median hand of the tables in anthropometry.cpp.
struct Proportions {
  double length = 1.0;   ///< hand length / 188 mm; scales along x (distal), and phalanx lengths
  double breadth = 1.0;  ///< hand breadth / 85 mm; scales along y and z, and radii
};
/// @param length_m wrist crease to middle fingertip  @param breadth_m across the knuckles
[[nodiscard]] Proportions proportions(double length_m, double breadth_m) noexcept;

/// A digit of three segments, right hand. Palm frame: x distal, y radial, z dorsal.
struct Digit {
  std::string name;  ///< "index", ..., "thumb"
  HandPart part = HandPart::kIndex;
  std::array<std::string, 3> segments;       ///< names of the capsules, without the digit's name
  std::array<std::string, 3> joints;         ///< flexion joint of each segment
  std::array<double, 3> joint_to_joint_m{};  ///< the last one: to the fingertip
  std::array<double, 3> segment_m{};         ///< length of the capsule's axis, from its joint
  std::array<double, 3> radius_m{};
  Eigen::Vector3d base_m = Eigen::Vector3d::Zero();  ///< first joint in the palm frame
  double abduction_rad = 0.0;  ///< fixed turn about dorsal, towards radial (fingers)
  double tilt_rad = 0.0;       ///< fixed turn of the flexion plane about the finger (fingers)
};

/// A capsule fixed to the palm or to the first link of a digit.
struct PlacedCapsule {
  std::string name;
  HandPart part = HandPart::kPalm;
  Eigen::Vector3d a_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d b_m = Eigen::Vector3d::Zero();
  double radius_m = 0.0;
  bool has_mass = true;  ///< false: skin over mass counted elsewhere, or forearm
};

/// Index, middle, ring, little.
[[nodiscard]] std::array<Digit, 4> fingers(const Proportions& size);
/// The thumb: metacarpal, proximal, distal; base_m is its carpometacarpal joint.
[[nodiscard]] Digit thumb(const Proportions& size);
/// Thumb's circumduction at coordinate zero, about -x from the plane of the palm [rad].
[[nodiscard]] double thumbRestCircumduction() noexcept;
/// Direction of the straight thumb before circumduction, from distal towards radial [rad].
[[nodiscard]] double thumbPointing() noexcept;

/// Palm, knuckle webs, first web and wrist, in the palm frame of a right hand [m].
[[nodiscard]] std::vector<PlacedCapsule> palmCapsules(const Proportions& size);
/// The three webs between the fingers. Web i is fixed to the first phalanx of finger i, in that
/// link's frame.
[[nodiscard]] std::array<PlacedCapsule, 3> fingerWebs(const Proportions& size);
/// The thenar muscle, in the frame that circumduction rotates: x distal, y along the radial plane.
[[nodiscard]] PlacedCapsule thenarCapsule(const Proportions& size);

/// The hinge joints a hand has, in the order of the links.
[[nodiscard]] const std::vector<std::string>& handJointNames();
/// The capsules a hand has.
[[nodiscard]] const std::vector<std::string>& handCapsuleNames();

/// Mean density of flesh and bone [kg/m³].
inline constexpr double kHandDensity_kg_m3 = 1100.0;

/// Mass properties of a capsule of uniform density, in closed form: a cylinder and two hemispheres.
[[nodiscard]] MassProperties capsuleMass(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m,
                                         double radius_m, double density_kg_m3);

/// Mass properties of the union of overlapping capsules, on a grid of the given step. Capsules
/// without mass are skipped.
[[nodiscard]] MassProperties unionMass(const std::vector<PlacedCapsule>& capsules,
                                       double density_kg_m3, double step_m);

}  // namespace wholehand
