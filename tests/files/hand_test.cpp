#include "files/hand/anthropometry.hpp"
#include "files/hand/hand_file.hpp"
#include "files/shipped_models.hpp"
#include "support/contains.hpp"
#include "support/folder.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace wholehand::test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kMm = 1e-3;

HandModel hand(const std::string& name, const DeviceModel& on) {
  return orThrow(assembleHand(handFile(name), on));
}

/// Forward kinematics by the definition of HandLink.
std::vector<Pose> linkPoses(const HandModel& model, const AxisPosition& q) {
  std::vector<Pose> poses;
  for (const HandLink& link : model.links) {
    double theta = 0.0;
    if (link.joint >= 0) {
      theta = model.theta0[link.joint] + model.synergy.row(link.joint).dot(q.vec());
    }
    Pose moved;
    if (link.type == JointType::kRevolute) {
      moved.rotation = Eigen::AngleAxisd(theta, link.axis).toRotationMatrix();
    } else if (link.type == JointType::kPrismatic) {
      moved.translation_m = theta * link.axis;
    }
    const Pose parent = link.parent < 0 ? Pose{} : poses[link.parent];
    poses.push_back(parent * link.parent_to_link * moved);
  }
  return poses;
}

int linkIndex(const HandModel& model, const std::string& name) {
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    if (model.links[i].name == name) return static_cast<int>(i);
  }
  ADD_FAILURE() << "no link " << name;
  return 0;
}

const Capsule& capsule(const HandModel& model, const std::string& name) {
  const auto found = std::find_if(model.capsules.begin(), model.capsules.end(),
                                  [&](const Capsule& c) { return c.name == name; });
  EXPECT_NE(found, model.capsules.end()) << name;
  return *found;
}

/// Pose of a link in the palm frame.
Pose inPalm(const HandModel& model, const std::vector<Pose>& poses, int link) {
  return poses[model.palm_link].inverse() * poses[link];
}

/// Device position with the hand's coordinates set, base axes at zero.
AxisPosition posture(const HandModel& model, double fingers, double circumduction, double thumb) {
  AxisPosition q(model.axis_count);
  for (int i = 0; i < model.axis_count; ++i) {
    const std::string& name = model.axis_names[i];
    if (name == "finger_flexion") q[i] = fingers;
    if (name == "thumb_circumduction") q[i] = circumduction;
    if (name == "thumb_flexion") q[i] = thumb;
  }
  return q;
}

// ---------------------------------------------------------------- mass from geometry

TEST(CapsuleMass, Ball_IsTwoFifthsOfMassTimesRadiusSquared) {
  const MassProperties ball = capsuleMass(Vector3d::Zero(), Vector3d::Zero(), 0.01, 1000.0);
  const double mass = 1000.0 * 4.0 / 3.0 * kPi * 1e-6;
  EXPECT_NEAR(ball.mass_kg, mass, 1e-12 * mass);
  EXPECT_TRUE(ball.inertia_kg_m2.isApprox(0.4 * mass * 1e-4 * Matrix3d::Identity(), 1e-12));
}

TEST(CapsuleMass, IndexProximalPhalanx_IsCylinderPlusTwoHalfBalls) {
  // Computed by hand, r 9 mm, length 42.6 mm, 1100 kg/m³: cylinder 11.9245 g, balls 3.3590 g. A
  // half ball has its centre 3r/8 from its face and 83/320 m r² about it.
  const double r = 9e-3;
  const double l = 42.6e-3;
  const double cylinder = 1100.0 * kPi * r * r * l;
  const double half_ball = 1100.0 * 2.0 / 3.0 * kPi * r * r * r;
  const double arm = l / 2.0 + 3.0 * r / 8.0;
  const double across = cylinder * (3.0 * r * r + l * l) / 12.0 +
                        2.0 * half_ball * (83.0 / 320.0 * r * r + arm * arm);
  const double along = cylinder * r * r / 2.0 + 2.0 * half_ball * 0.4 * r * r;
  const MassProperties m = capsuleMass({0, 0, 0}, {l, 0, 0}, r, 1100.0);
  EXPECT_NEAR(m.mass_kg, 15.2835e-3, 1e-6);
  EXPECT_TRUE(m.com_m.isApprox(Vector3d(l / 2.0, 0, 0)));
  EXPECT_NEAR(m.inertia_kg_m2(0, 0), along, 1e-12 * along);
  EXPECT_NEAR(m.inertia_kg_m2(1, 1), across, 1e-12 * across);
  EXPECT_NEAR(m.inertia_kg_m2(2, 2), across, 1e-12 * across);
}

TEST(UnionMass, OneObliqueCapsule_MatchesTheClosedForm) {
  const Vector3d a(3 * kMm, -4 * kMm, 1 * kMm);
  const Vector3d b(41 * kMm, 12 * kMm, 7 * kMm);
  const MassProperties exact = capsuleMass(a, b, 9.5 * kMm, 1100.0);
  const MassProperties grid = unionMass({{"c", HandPart::kPalm, a, b, 9.5 * kMm}}, 1100.0, 5e-4);
  EXPECT_NEAR(grid.mass_kg, exact.mass_kg, 0.002 * exact.mass_kg);
  EXPECT_LT((grid.com_m - exact.com_m).norm(), 0.05 * kMm);
  EXPECT_LT((grid.inertia_kg_m2 - exact.inertia_kg_m2).norm(), 0.005 * exact.inertia_kg_m2.norm());
}

TEST(UnionMass, PalmOnTheUsedGrid_IsWithinOnePercentOfAFinerOne) {
  const auto palm = palmCapsules(proportions(0.188, 0.085));
  const MassProperties coarse = unionMass(palm, kHandDensity_kg_m3, 2 * kMm);
  const MassProperties fine = unionMass(palm, kHandDensity_kg_m3, 0.7 * kMm);
  EXPECT_NEAR(coarse.mass_kg, fine.mass_kg, 0.01 * fine.mass_kg);
  EXPECT_LT((coarse.inertia_kg_m2 - fine.inertia_kg_m2).norm(), 0.01 * fine.inertia_kg_m2.norm());
}

TEST(UnionMass, OverlapAndSkin_OverlapCountsOnceAndSkinNotAtAll) {
  const PlacedCapsule one{"a", HandPart::kPalm, {0, 0, 0}, {0.04, 0, 0}, 0.01};
  PlacedCapsule inner{"b", HandPart::kPalm, {0.01, 0, 0}, {0.03, 0, 0}, 0.008};
  PlacedCapsule skin{"c", HandPart::kPalm, {0, 0.05, 0}, {0.04, 0.05, 0}, 0.01, false};
  const MassProperties alone = unionMass({one}, 1100.0, 1e-3);
  const MassProperties all = unionMass({one, inner, skin}, 1100.0, 1e-3);
  EXPECT_EQ(all.mass_kg, alone.mass_kg);
  EXPECT_EQ(all.inertia_kg_m2, alone.inertia_kg_m2);
}

// ---------------------------------------------------------------- kinematics

TEST(Hand, LambdaPride_Has19JointsAnd41Capsules) {
  const HandModel model = handNamed();
  EXPECT_EQ(model.joint_count, 19);  // 3 translations, 4 x 3 fingers, 1 + 3 thumb
  EXPECT_EQ(model.capsules.size(), 41U);
  EXPECT_EQ(model.links[model.palm_link].name, "z");
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    EXPECT_LT(model.links[i].parent, static_cast<int>(i));
    EXPECT_NEAR(model.links[i].axis.norm(), 1.0, 1e-12);
    EXPECT_GT(model.links[i].mass_kg, 0.0);
  }
}

TEST(Hand, StraightMiddleFinger_ReachesTheSumOfItsBones) {
  const HandModel model = handNamed();
  const auto poses = linkPoses(model, posture(model, 0, 0, 0));
  const Capsule& tip = capsule(model, "middle_distal");
  const Vector3d end = inPalm(model, poses, tip.link) * tip.b_m;
  // MCP 65.5 mm distal, bones 44.7, 29.1, 19.1, pulp 5: this is the end of the skin.
  EXPECT_NEAR(end.x() + tip.radius_m, (65.5 + 44.7 + 29.1 + 19.1 + 5.0) * kMm, 1e-12);
  EXPECT_NEAR(end.y(), 0.7 * 1.22 * kMm, 1e-12);
  EXPECT_NEAR(end.z(), 9.2 * kMm, 1e-12);
}

TEST(Hand, FingerFlexion_IsTheAngleBetweenFingertipAndMetacarpal) {
  const HandModel model = handNamed();
  const auto open = linkPoses(model, posture(model, 0, 0, 0));
  for (const double theta : {0.3, 1.0, 2.0, kPi}) {
    const auto bent = linkPoses(model, posture(model, theta, 0, 0));
    for (const char* name : {"index", "middle", "ring", "little"}) {
      const int link = linkIndex(model, std::string(name) + "_dip_flexion");
      const Matrix3d turn = open[link].rotation.transpose() * bent[link].rotation;
      // The three joints of a finger turn about parallel axes, so their angles add up.
      EXPECT_NEAR(Eigen::AngleAxisd(turn).angle(), theta, 1e-9) << name;
    }
  }
}

TEST(Hand, PositiveCoordinates_CloseTheHand) {
  const HandModel model = handNamed();
  const auto tipAt = [&](const std::string& name, const AxisPosition& q) -> Vector3d {
    const Capsule& tip = capsule(model, name);
    return inPalm(model, linkPoses(model, q), tip.link) * tip.b_m;
  };
  const Vector3d open = tipAt("index_distal", posture(model, 0, 0, 0));
  const Vector3d bent = tipAt("index_distal", posture(model, 1.0, 0, 0));
  EXPECT_LT(bent.z(), open.z() - 20 * kMm);  // towards the palm
  EXPECT_LT(bent.x(), open.x());
  const Vector3d thumb_flat = tipAt("thumb_distal", posture(model, 0, 0, 0));
  const Vector3d thumb_opposed = tipAt("thumb_distal", posture(model, 0, 1.2, 0));
  EXPECT_GT(thumb_flat.y(), 80 * kMm);                      // points radially
  EXPECT_LT(thumb_opposed.z(), thumb_flat.z() - 30 * kMm);  // swings in front of the palm
  const Vector3d thumb_bent = tipAt("thumb_distal", posture(model, 0, 1.2, 1.0));
  EXPECT_GT(thumb_bent.x(), thumb_opposed.x() + 20 * kMm);  // bends towards the fingers
}

TEST(Hand, NeutralPosture_HasTheThumbUpAndTheBackToTheRight) {
  const HandModel model = handNamed();
  const auto poses = linkPoses(model, posture(model, 0, 0, 0));
  const Matrix3d palm = poses[model.palm_link].rotation;
  EXPECT_TRUE((palm * Vector3d::UnitX()).isApprox(Vector3d::UnitX(), 1e-12));  // away from the body
  EXPECT_TRUE((palm * Vector3d::UnitY()).isApprox(Vector3d::UnitZ(), 1e-12));  // radial is up
  EXPECT_TRUE((palm * Vector3d::UnitZ()).isApprox(-Vector3d::UnitY(), 1e-12));  // dorsal is right
  // A translation moves the palm along the world's axis in any mounting.
  AxisPosition q = posture(model, 0, 0, 0);
  q[0] = 0.01, q[1] = 0.02, q[2] = 0.03;
  EXPECT_TRUE(linkPoses(model, q)[model.palm_link].translation_m.isApprox(
      Vector3d(0.01, 0.02, 0.03), 1e-12));
}

TEST(Hand, WristAxes_TurnInSeriesAboutTheHandsOwnAxes) {
  const HandModel model = hand("adult-median-right", deviceNamed("wrist-9axis"));
  AxisPosition q(9);
  const double roll = 0.3, pitch = -0.2, yaw = 0.25;
  q[3] = roll, q[4] = pitch, q[5] = yaw;
  const Matrix3d expected =
      (Eigen::AngleAxisd(kPi / 2, Vector3d::UnitX()) * Eigen::AngleAxisd(roll, Vector3d::UnitX()) *
       Eigen::AngleAxisd(pitch, Vector3d::UnitY()) * Eigen::AngleAxisd(yaw, Vector3d::UnitZ()))
          .toRotationMatrix();
  const Pose palm = linkPoses(model, q)[model.palm_link];
  EXPECT_TRUE(palm.rotation.isApprox(expected, 1e-12));
  EXPECT_LT(palm.translation_m.norm(), 1e-15);  // through the palm frame's origin
}

TEST(Hand, LeftHandOfEverySize_IsTheMirrorImageInEveryPosture) {
  const std::array<const char*, 3> devices = {"lambda-pride", "wrist-9axis", "desktop-3axis"};
  for (std::size_t k = 0; k < 3 * kHandSizes.size(); ++k) {
    const std::string size = kHandSizes[k / 3], name = devices[k % 3];
    SCOPED_TRACE(size + " on " + name);
    const DeviceModel on = deviceNamed(name);
    const HandModel right = hand(size + "-right", on);
    const HandModel left = hand(size + "-left", on);
    EXPECT_EQ(left.side, Side::kLeft);
    EXPECT_EQ(left.name, size + "-left");
    EXPECT_EQ(left.reference.vec(), right.reference.vec());
    AxisPosition q(on.axisCount());
    AxisPosition mirrored(on.axisCount());
    for (int i = 0; i < on.axisCount(); ++i) {
      const DeviceAxis& axis = on.axes[i];
      q[i] = axis.lower + (0.23 + 0.07 * i) * (axis.upper - axis.lower);
      // In the mirror image in the plane y = 0, y and the rotations about x and z change sign.
      const bool turns_round = axis.name == "y" || axis.name == "roll" || axis.name == "yaw";
      mirrored[i] = turns_round ? -q[i] : q[i];
    }
    const auto right_poses = linkPoses(right, q);
    const auto left_poses = linkPoses(left, mirrored);
    const Vector3d flip(1.0, -1.0, 1.0);
    ASSERT_EQ(right.capsules.size(), left.capsules.size());
    for (std::size_t i = 0; i < right.capsules.size(); ++i) {
      const Capsule& r = right.capsules[i];
      const Capsule& l = left.capsules[i];
      const Vector3d at = right_poses[r.link] * r.b_m;
      const Vector3d image = left_poses[l.link] * l.b_m;
      EXPECT_LT((image - flip.cwiseProduct(at)).norm(), 1e-12) << r.name;
    }
    for (std::size_t i = 0; i < right.links.size(); ++i) {
      EXPECT_EQ(right.links[i].mass_kg, left.links[i].mass_kg);
      const Vector3d com = right_poses[i] * right.links[i].com_m;
      EXPECT_LT((left_poses[i] * left.links[i].com_m - flip.cwiseProduct(com)).norm(), 1e-12);
      const Matrix3d inertia = right_poses[i].rotation * right.links[i].inertia_kg_m2 *
                               right_poses[i].rotation.transpose();
      const Matrix3d image =
          left_poses[i].rotation * left.links[i].inertia_kg_m2 * left_poses[i].rotation.transpose();
      EXPECT_LT((image - Matrix3d(flip.asDiagonal() * inertia * flip.asDiagonal())).norm(), 1e-15);
    }
  }
}

/// The messages for a hand file that begins like this and continues with `rest`.
std::string reported(const Folder& folder, const std::string& rest) {
  const std::string text = "kind = \"hand\"\nversion = 1\nname = \"hand\"\n" + rest;
  const auto loaded = loadHandFile(folder.write("hand.toml", text));
  return loaded ? "loaded" : format(loaded.errors());
}

TEST(MirroredHand, FaultyMirrorFile_IsRefusedWithKeyAndValue) {
  const Folder folder;
  folder.write("mirror.toml", "kind = \"hand\"\nversion = 1\nmirror_of = \"somebody\"\n");
  const std::vector<std::array<std::string, 3>> cases = {
      {"nobody", "", "cannot be read"},
      {"../hand", "", "names no file of this folder"},
      {"mirror", "", "is itself a mirror image of another hand"},
      {"hand", "", "is itself a mirror image of another hand"},  // itself
      {"mirror", "length_m = 0.1\n", "length_m"},  // the two values would contradict each other
  };
  for (const auto& [name, more, why] : cases) {
    const std::string said = reported(folder, "mirror_of = \"" + name + "\"\n" + more);
    for (const std::string& word : {std::string("hand.toml"), why}) {
      EXPECT_TRUE(contains(said, word)) << name << ": " << said;
    }
    if (more.empty()) {
      EXPECT_TRUE(contains(said, "mirror_of"));
    }
  }
}

TEST(Hand, JointsWithoutAnAxis_AreLockedAtRest) {
  const HandModel model = hand("adult-median-right", deviceNamed("desktop-3axis"));
  EXPECT_EQ(model.joint_count, 3);
  const auto poses = linkPoses(model, AxisPosition(3));
  const HandFile file = handFile("adult-median-right");
  double rest = 0.0;
  for (const JointRange& joint : file.joints) {
    if (joint.joint.starts_with("middle_")) rest += joint.rest_rad;
  }
  const int tip = linkIndex(model, "middle_dip_flexion");
  EXPECT_EQ(model.links[tip].type, JointType::kFixed);
  const Vector3d direction = inPalm(model, poses, tip).rotation * Vector3d::UnitX();
  EXPECT_NEAR(std::atan2(-direction.z(), direction.x()), rest,
              1e-12);  // middle finger: no abduction
}

TEST(Hand, Glove_NeedsNoBaseAxes) {
  DeviceModel glove = deviceNamed("lambda-pride");
  glove.axes.erase(glove.axes.begin(), glove.axes.begin() + 3);
  const HandModel model = hand("adult-median-right", glove);
  EXPECT_EQ(model.joint_count, 16);
  EXPECT_EQ(model.links[model.palm_link].type, JointType::kFixed);
  EXPECT_NEAR(model.reference[0], kPi / 2, 1e-12);  // mid-grasp, from the hand file
}

// ---------------------------------------------------------------- size and mass

TEST(Hand, EveryHandOnEveryDevice_HasTheMassOfItsFile) {
  for (const char* on : {"lambda-pride", "desktop-3axis", "wrist-9axis"}) {
    for (const char* name : {"adult-median-right", "adult-median-left", "woman-p05-right"}) {
      const HandModel model = hand(name, deviceNamed(on));
      double total = 0.0;
      for (const HandLink& link : model.links) total += link.mass_kg;
      EXPECT_NEAR(total, 0.25, 1e-15);
      EXPECT_EQ(model.total_mass_kg, 0.25);
    }
  }
}

TEST(Hand, Phalanges_ShareTheMassByVolume) {
  const HandModel model = handNamed();
  const auto mass = [&](const char* link) { return model.links[linkIndex(model, link)].mass_kg; };
  // Volumes of the capsules: r² (l + 4r/3).
  const double proximal = 81.0 * (42.6 + 12.0);
  const double middle = 64.0 * (25.1 + 32.0 / 3.0);
  EXPECT_NEAR(mass("index_mcp_flexion") / mass("index_pip_flexion"), proximal / middle, 1e-9);
}

TEST(Hand, LargerPercentiles_GrowInReachAndBreadth) {
  for (const std::string sex : {"woman", "man"}) {
    double reach = 0.0;
    double breadth = 0.0;
    for (const std::string percentile : {"p05", "p50", "p95"}) {
      const std::string name = sex + "-" + percentile + "-right";
      const HandFile file = handFile(name);
      const HandModel model = hand(name, deviceNamed("lambda-pride"));
      const auto poses = linkPoses(model, posture(model, 0, 0, 0));
      const Capsule& tip = capsule(model, "middle_distal");
      const double tip_reach = (inPalm(model, poses, tip.link) * tip.b_m).x() + tip.radius_m;
      // Lengths depend only on the hand's length: 163.4 mm of the median hand's 188 mm.
      EXPECT_NEAR(tip_reach, 0.1634 / 0.188 * file.length_m, 1e-12);
      const double knuckles = fingers(proportions(file.length_m, file.breadth_m))[0].base_m.y() -
                              fingers(proportions(file.length_m, file.breadth_m))[3].base_m.y();
      EXPECT_NEAR(knuckles, (18.2 + 23.5) * 1.22 / 85.0 * file.breadth_m, 1e-12);
      EXPECT_GT(tip_reach, reach);
      EXPECT_GT(knuckles, breadth);
      reach = tip_reach;
      breadth = knuckles;
    }
  }
}

double segmentDistance(const Vector3d& a0, const Vector3d& a1, const Vector3d& b0,
                       const Vector3d& b1) {
  double best = 1.0;
  for (int i = 0; i <= 100; ++i) {
    const Vector3d p = a0 + i / 100.0 * (a1 - a0);
    const Vector3d d = b1 - b0;
    const double t = std::clamp((p - b0).dot(d) / d.squaredNorm(), 0.0, 1.0);
    best = std::min(best, (p - b0 - t * d).norm());
  }
  return best;
}

TEST(Hand, NeighbouringFingers_StaySideBySideFromOpenToFist) {
  const std::vector<std::string> names = {"index", "middle", "ring", "little"};
  for (const char* file : {"adult-median-right", "woman-p05-right", "woman-p50-right",
                           "woman-p95-right", "man-p05-right", "man-p50-right", "man-p95-right"}) {
    SCOPED_TRACE(file);
    const HandModel model = hand(file, deviceNamed("lambda-pride"));
    const auto digits = fingers(proportions(handFile(file).length_m, handFile(file).breadth_m));
    for (std::size_t f = 0; f + 1 < names.size(); ++f) {
      // Knuckles are balls with the radii of the first phalanges and must not overlap.
      EXPECT_GT((digits[f].base_m - digits[f + 1].base_m).norm(),
                digits[f].radius_m[0] + digits[f + 1].radius_m[0]);
      for (double theta = 0.0; theta <= kPi; theta += kPi / 12.0) {
        const auto poses = linkPoses(model, posture(model, theta, 0, 0));
        for (const Capsule& a : model.capsules) {
          for (const Capsule& b : model.capsules) {
            if (!a.name.starts_with(names[f] + "_")) continue;
            if (!b.name.starts_with(names[f + 1] + "_")) continue;
            const Pose& pa = poses[a.link];
            const Pose& pb = poses[b.link];
            const double gap = segmentDistance(pa * a.a_m, pa * a.b_m, pb * b.a_m, pb * b.b_m) -
                               a.radius_m - b.radius_m;
            // Ring and little finger touch at their web; flesh yields by a millimetre.
            EXPECT_GT(gap, -1.5 * kMm) << a.name << " " << b.name << " at " << theta;
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace wholehand::test
