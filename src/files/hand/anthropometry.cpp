#include "files/hand/anthropometry.hpp"

#include "loop/core/geometry.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wholehand {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kMm = 1e-3;

/// Size of the hand in the tables.
constexpr double kTableLength_m = 0.188;
constexpr double kTableBreadth_m = 0.085;
/// Factor on the distance between knuckles. The knuckles of the tables are too close together for
/// the finger radii of the tables; the measured hand breadth requires 1.22 times their distance.
constexpr double kKnuckleSpread = 1.22;
/// The tables end at the tip site; the pulp extends further.
constexpr double kPulp_mm = 5.0;

/// Joint-to-joint lengths, capsule radii and first joints [mm]: MyoHub's hand (myo_sim, Apache-2.0;
/// the numbers only). Abduction and tilt are our own: the smallest that keep the fingers side by
/// side, open and closed.
struct DigitRow {
  const char* name;
  HandPart part;
  std::array<double, 3> lengths_mm;
  std::array<double, 3> radii_mm;
  std::array<double, 3> base_mm;  ///< distal, radial, dorsal from the capitate
  double abduction_deg;
  double tilt_deg;
};
constexpr std::array<DigitRow, 4> kFingers = {{
    {"index", HandPart::kIndex, {42.6, 25.1, 18.1}, {9, 8, 7}, {65.9, 18.2, 8.7}, 1.0, 0.0},
    {"middle", HandPart::kMiddle, {44.7, 29.1, 19.1}, {9, 8, 7}, {65.5, 0.7, 9.2}, 0.0, 0.0},
    {"ring", HandPart::kRing, {40.4, 24.9, 18.1}, {8.5, 7.5, 6.8}, {64.2, -13.9, 3.3}, -1.0, -1.0},
    {"little", HandPart::kLittle, {36.1, 21.0, 17.3}, {8, 7, 6}, {56.1, -23.5, -5.7}, -6.0, -4.0},
}};
constexpr DigitRow kThumb = {
    "thumb", HandPart::kThumb, {35.9, 31.1, 23.7}, {9.5, 8.5, 6.5}, {10.0, 22.5, -12.8}, 0.0, 0.0};
// From the grasping study: a thumb that points 85 degrees from distal and starts 20 degrees palmar
// opposes the fingers within 90 degrees of circumduction.
constexpr double kThumbPointing_deg = 85.0;
constexpr double kThumbRest_deg = 20.0;

/// Scales a point of the tables (distal, radial, dorsal) [mm].
Vector3d place(const Proportions& size, double distal, double radial, double dorsal) {
  return {distal * size.length * kMm, radial * size.breadth * kMm, dorsal * size.breadth * kMm};
}

Digit makeDigit(const DigitRow& row, const Proportions& size, double spread) {
  Digit digit;
  digit.name = row.name;
  digit.part = row.part;
  for (std::size_t k = 0; k < 3; ++k) {
    const double pulp_mm = k == 2 ? kPulp_mm : 0.0;
    digit.joint_to_joint_m[k] = (row.lengths_mm[k] + pulp_mm) * size.length * kMm;
    digit.radius_m[k] = row.radii_mm[k] * size.breadth * kMm;
    digit.segment_m[k] = digit.joint_to_joint_m[k] - (k == 2 ? digit.radius_m[k] : 0.0);
  }
  digit.base_m = place(size, row.base_mm[0], row.base_mm[1] * spread, row.base_mm[2]);
  digit.abduction_rad = row.abduction_deg * kDeg;
  digit.tilt_rad = row.tilt_deg * kDeg;
  return digit;
}

/// A capsule in the palm's table [mm]. Marked ends have y multiplied by kKnuckleSpread.
struct PalmRow {
  const char* name;
  std::array<double, 3> a_mm, b_mm;
  double radius_mm;
  bool spread_a, spread_b;
  bool has_mass;
};
// Placed by eye against the skin of the design study.
constexpr std::array<PalmRow, 22> kPalm = {{
    {"metacarpal_2", {4, 12, 1}, {65.9, 18.2, 8.7}, 9.6, false, true, true},
    {"metacarpal_3", {3, 4, 3}, {65.5, 0.7, 9.2}, 9.8, false, true, true},
    {"metacarpal_4", {3, -6, 2}, {64.2, -13.9, 3.3}, 9.4, false, true, true},
    {"metacarpal_5", {4, -13, -2}, {56.1, -23.5, -5.7}, 9.0, false, true, true},
    {"between_23", {8, 8, 1}, {63, 9.8, 7.6}, 9.4, false, true, true},
    {"between_34", {8, -1, 1}, {62.5, -6.6, 5}, 9.4, false, true, true},
    {"between_45", {8, -10, -2}, {58.5, -18.7, -2.2}, 9.0, false, true, true},
    {"pad_radial", {56, 16.5, 1.5}, {56, -3, 0}, 8.6, true, true, true},
    {"pad_ulnar", {56, -3, 0}, {50, -20, -8.5}, 8.4, true, true, true},
    {"thenar", {20, 15, -4}, {44, 17, 0}, 9.5, false, false, true},
    {"hollow", {14, 0, -5}, {44, 2, -1}, 9.5, false, false, true},
    {"hypothenar_edge", {2, -16, -6}, {42, -23, -8.5}, 10.0, false, false, true},
    {"hypothenar", {12, -14, -7}, {42, -15, -7}, 9.5, false, false, true},
    {"carpus", {2, 12, -4}, {2, -13, -5}, 11.5, false, false, true},
    // The knuckle webs lie between first joints, which do not move against the palm.
    {"knuckle_web_23", {65.9, 18.2, 8.7}, {65.5, 0.7, 9.2}, 8.4, true, true, true},
    {"knuckle_web_34", {65.5, 0.7, 9.2}, {64.2, -13.9, 3.3}, 8.4, true, true, true},
    {"knuckle_web_45", {64.2, -13.9, 3.3}, {56.1, -23.5, -5.7}, 8.4, true, true, true},
    // The first web is fixed to the palm: fixed to the thumb, it would swing into the grasp.
    {"thumb_web", {22, 24, -6}, {48, 21, 3}, 7.5, false, false, true},
    {"thumb_web_deep", {14, 25, -11}, {40, 19, 2}, 8.0, false, false, true},
    // A stub of the forearm: it collides, but its mass does not count for the hand.
    {"wrist_radial", {-52, 12, -3}, {0, 13, -3.5}, 13.0, false, false, false},
    {"wrist_ulnar", {-52, -12, -3}, {4, -14, -5}, 12.5, false, false, false},
    {"wrist_middle", {-52, 0, -3}, {0, 0, -2.5}, 14.0, false, false, false},
}};

constexpr double kWebRadius_mm = 7.0;
constexpr double kWebAlong = 0.24;  ///< share of the first phalanx at which the web ends
constexpr double kWebReach = 0.5;   ///< share of the gap; the neighbour's capsule fills the rest
constexpr double kWebFlexion_rad = 0.6;  ///< half of the flexion of a knuckle
constexpr double kThenarRadius_mm = 10.6;
constexpr double kThenarAlong = 0.46;  ///< share of the thumb's metacarpal

double squaredDistance(const Vector3d& point, const PlacedCapsule& capsule) {
  const Vector3d axis = capsule.b_m - capsule.a_m;
  const double length2 = axis.squaredNorm();
  const double along =
      length2 > 0.0 ? std::clamp((point - capsule.a_m).dot(axis) / length2, 0.0, 1.0) : 0.0;
  return (point - capsule.a_m - along * axis).squaredNorm();
}

bool inside(const Vector3d& point, const std::vector<PlacedCapsule>& capsules) {
  return std::any_of(capsules.begin(), capsules.end(), [&](const PlacedCapsule& c) {
    return squaredDistance(point, c) <= c.radius_m * c.radius_m;
  });
}

}  // namespace

Proportions proportions(double length_m, double breadth_m) noexcept {
  return {length_m / kTableLength_m, breadth_m / kTableBreadth_m};
}

std::array<Digit, 4> fingers(const Proportions& size) {
  std::array<Digit, 4> out;
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = makeDigit(kFingers[i], size, kKnuckleSpread);
    out[i].segments = {"proximal", "middle", "distal"};
    out[i].joints = {out[i].name + "_mcp_flexion", out[i].name + "_pip_flexion",
                     out[i].name + "_dip_flexion"};
  }
  return out;
}

Digit thumb(const Proportions& size) {
  Digit out = makeDigit(kThumb, size, 1.0);
  out.segments = {"metacarpal", "proximal", "distal"};
  out.joints = {"thumb_cmc_flexion", "thumb_mcp_flexion", "thumb_ip_flexion"};
  return out;
}

double thumbRestCircumduction() noexcept {
  return kThumbRest_deg * kDeg;
}
double thumbPointing() noexcept {
  return kThumbPointing_deg * kDeg;
}

std::vector<PlacedCapsule> palmCapsules(const Proportions& size) {
  std::vector<PlacedCapsule> out;
  for (const PalmRow& row : kPalm) {
    const double spread_a = row.spread_a ? kKnuckleSpread : 1.0;
    const double spread_b = row.spread_b ? kKnuckleSpread : 1.0;
    out.push_back({row.name, HandPart::kPalm,
                   place(size, row.a_mm[0], row.a_mm[1] * spread_a, row.a_mm[2]),
                   place(size, row.b_mm[0], row.b_mm[1] * spread_b, row.b_mm[2]),
                   row.radius_mm * size.breadth * kMm, row.has_mass});
  }
  return out;
}

std::array<PlacedCapsule, 3> fingerWebs(const Proportions& size) {
  static constexpr std::array<const char*, 3> kNames = {"web_23", "web_34", "web_45"};
  const std::array<Digit, 4> digits = fingers(size);
  std::array<PlacedCapsule, 3> out;
  for (std::size_t i = 0; i < out.size(); ++i) {
    // Seen from this phalanx, the neighbour's knuckle turns back as the fingers flex; the web is
    // placed for half that angle.
    const Vector3d gap_m = Eigen::AngleAxisd(-kWebFlexion_rad, Vector3d::UnitY()) *
                           (digits[i + 1].base_m - digits[i].base_m);
    const Vector3d a_m(kWebAlong * digits[i].joint_to_joint_m[0], 0.0, 0.0);
    out[i] = {kNames[i],
              HandPart::kPalm,
              a_m,
              a_m + kWebReach * gap_m,
              kWebRadius_mm * size.breadth * kMm,
              false};
  }
  return out;
}

PlacedCapsule thenarCapsule(const Proportions& size) {
  const double reach_m = kThenarAlong * thumb(size).joint_to_joint_m[0];
  const Vector3d along(std::cos(thumbPointing()), std::sin(thumbPointing()), 0.0);
  return {"thumb_thenar",
          HandPart::kThumb,
          Vector3d::Zero(),
          reach_m * along,
          kThenarRadius_mm * size.breadth * kMm,
          true};
}

const std::vector<std::string>& handJointNames() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> out;
    for (const Digit& finger : fingers({})) {
      out.insert(out.end(), finger.joints.begin(), finger.joints.end());
    }
    out.emplace_back("thumb_circumduction");
    const Digit digit = thumb({});
    out.insert(out.end(), digit.joints.begin(), digit.joints.end());
    return out;
  }();
  return kNames;
}

const std::vector<std::string>& handCapsuleNames() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> out;
    const auto add_digit = [&](const Digit& digit) {
      for (const std::string& segment : digit.segments) out.push_back(digit.name + "_" + segment);
    };
    for (const PlacedCapsule& placed : palmCapsules({})) out.push_back(placed.name);
    for (const Digit& finger : fingers({})) add_digit(finger);
    for (const PlacedCapsule& web : fingerWebs({})) out.push_back(web.name);
    out.push_back(thenarCapsule({}).name);
    add_digit(thumb({}));
    return out;
  }();
  return kNames;
}

MassProperties capsuleMass(const Vector3d& a_m, const Vector3d& b_m, double radius_m,
                           double density_kg_m3) {
  const double length = (b_m - a_m).norm();
  const double r2 = radius_m * radius_m;
  const double cylinder = density_kg_m3 * std::numbers::pi * r2 * length;
  const double ball = density_kg_m3 * 4.0 / 3.0 * std::numbers::pi * r2 * radius_m;
  const double lengthwise = cylinder * r2 / 2.0 + ball * 0.4 * r2;
  const double crosswise =
      cylinder * (length * length / 12.0 + r2 / 4.0) +
      ball * (0.4 * r2 + length * length / 4.0 + 3.0 / 8.0 * length * radius_m);
  MassProperties out;
  out.mass_kg = cylinder + ball;
  out.com_m = (a_m + b_m) / 2.0;
  out.inertia_kg_m2 = crosswise * Matrix3d::Identity();
  if (length > 0.0) {
    const Vector3d axis = (b_m - a_m) / length;
    out.inertia_kg_m2 += (lengthwise - crosswise) * axis * axis.transpose();
  }
  return out;
}

MassProperties unionMass(const std::vector<PlacedCapsule>& capsules, double density_kg_m3,
                         double step_m) {
  std::vector<PlacedCapsule> solid;
  std::copy_if(capsules.begin(), capsules.end(), std::back_inserter(solid),
               [](const PlacedCapsule& c) { return c.has_mass; });
  MassProperties out;
  if (solid.empty()) return out;
  Vector3d low = solid.front().a_m;
  Vector3d high = low;
  for (const PlacedCapsule& c : solid) {
    const Vector3d swell = Vector3d::Constant(c.radius_m);
    low = low.cwiseMin(c.a_m.cwiseMin(c.b_m) - swell);
    high = high.cwiseMax(c.a_m.cwiseMax(c.b_m) + swell);
  }
  // Sums are relative to the centre of the bounding box, which keeps the parallel-axis step
  // precise.
  const Vector3d center = (low + high) / 2.0;
  const Eigen::Vector3i cells = ((high - low) / step_m).array().ceil().cast<int>();
  const double cell_kg = density_kg_m3 * step_m * step_m * step_m;
  Vector3d first = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero();
  for (int i = 0; i < cells.x(); ++i) {
    for (int j = 0; j < cells.y(); ++j) {
      for (int k = 0; k < cells.z(); ++k) {
        const Vector3d at = low + step_m * Vector3d(i + 0.5, j + 0.5, k + 0.5);
        if (!inside(at, solid)) continue;
        const Vector3d arm = at - center;
        out.mass_kg += cell_kg;
        first += cell_kg * arm;
        second += cell_kg * arm * arm.transpose();
      }
    }
  }
  if (out.mass_kg == 0.0) return out;
  const Vector3d shift = first / out.mass_kg;
  second -= out.mass_kg * shift * shift.transpose();
  // Own inertia of a cubic cell.
  second += out.mass_kg * step_m * step_m / 12.0 * Matrix3d::Identity();
  out.com_m = center + shift;
  out.inertia_kg_m2 = second.trace() * Matrix3d::Identity() - second;
  return out;
}

}  // namespace wholehand
