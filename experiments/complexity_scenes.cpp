#include "experiments/complexity_scenes.hpp"

#include "files/mesh/convex_mesh.hpp"
#include "loop/dynamics/articulated_body.hpp"
#include "loop/dynamics/synergy.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

constexpr double kStart_z_m = 0.05;  // initial height of the hand's base
constexpr double kClear_m = 0.005;   // initial gap below the hand
constexpr double kPress_m = 0.02;    // depth of the press beyond the gap
constexpr double kSway_m = 0.01;
constexpr double kDown_s = 0.3;
constexpr double kSwayPeriod_s = 0.5;

constexpr double kBall_m = 0.015;  // radius
constexpr double kBox_m = 0.03;    // edge
// Gap between neighbours, smaller than the contact distance of the engines.
constexpr double kGap_m = 2e-4;
constexpr int kStackHeight = 4;
constexpr double kApart_m = 0.05;  // distance between the centres of bodies that rest apart
constexpr double kFar_m = 1.5;     // distance from the hand to the first body that is out of reach
constexpr double kMass_kg = 0.02;
constexpr double kMesh_m = 0.04;  // radius

/// The hand's capsules in the start pose: ends in the world and the lowest point.
struct StartingHand {
  struct Placed {
    Vector3d a_m, b_m;
    double radius_m;
  };
  std::vector<Placed> capsules;
  double lowest_m = std::numeric_limits<double>::infinity();
  Vector3d middle_m = Vector3d::Zero();
};

AxisPosition handAt(const DeviceModel& device, double y_m, double z_m) {
  AxisPosition q(device.axisCount());
  if (const int y = device.axisIndex("y"); y >= 0) q[y] = y_m;
  if (const int z = device.axisIndex("z"); z >= 0) q[z] = z_m;
  return q;
}

StartingHand startingHand(const Models& models) {
  ArticulatedBody body(models.hand);
  JointPosition theta;
  Synergy(models.hand).expand(handAt(models.device, 0.0, kStart_z_m), theta);
  body.updateKinematics(theta);
  StartingHand hand;
  for (const Capsule& c : models.hand.capsules) {
    const Pose& at = body.linkPose(c.link);
    hand.capsules.push_back({at * c.a_m, at * c.b_m, c.radius_m});
    const StartingHand::Placed& placed = hand.capsules.back();
    hand.lowest_m =
        std::min(hand.lowest_m, std::min(placed.a_m.z(), placed.b_m.z()) - placed.radius_m);
  }
  // Computes the point at which the hand comes down.
  double count = 0.0;
  for (const StartingHand::Placed& c : hand.capsules) {
    if (std::min(c.a_m.z(), c.b_m.z()) - c.radius_m > hand.lowest_m + 0.02) continue;
    hand.middle_m += 0.5 * (c.a_m + c.b_m);
    count += 1.0;
  }
  hand.middle_m /= std::max(count, 1.0);
  return hand;
}

/// Places of a square grid of `wide` by `wide` places, the middle ones first.
std::vector<std::pair<double, double>> fromTheMiddle(int wide) {
  std::vector<std::pair<double, double>> places;
  for (int i = 0; i < wide * wide; ++i) {
    const int row = i / wide, column = i % wide;
    places.emplace_back(column - 0.5 * (wide - 1), row - 0.5 * (wide - 1));
  }
  std::stable_sort(places.begin(), places.end(), [](const auto& a, const auto& b) {
    return std::hypot(a.first, a.second) < std::hypot(b.first, b.second);
  });
  return places;
}

Shape boxOf(const Vector3d& size_m, const Vector3d& at_m = Vector3d::Zero()) {
  Shape shape;
  shape.half_extents_m = 0.5 * size_m;
  shape.in_body.translation_m = at_m;
  return shape;
}

Shape ballOf(double radius_m) {
  Shape shape;
  shape.type = ShapeType::kSphere;
  shape.radius_m = radius_m;
  return shape;
}

class SceneOf {
 public:
  explicit SceneOf(const Models& models) : hand_(startingHand(models)) {}

  Expected<SceneModel> make(ComplexityKind kind, int count) {
    scene_.name = std::string(complexityName(kind)) + " " + std::to_string(count);
    switch (kind) {
      case ComplexityKind::kPile:
        pile(count);
        break;
      case ComplexityKind::kStacks:
        stacks(count);
        break;
      case ComplexityKind::kApart:
        apart(count, hand_.middle_m);
        break;
      case ComplexityKind::kFar:
        apart(count, hand_.middle_m + Vector3d(kFar_m, 0.0, 0.0));
        break;
      case ComplexityKind::kVertices:
        if (auto made = mesh(count); !made) return made.errors();
        break;
      case ComplexityKind::kContacts:
        bed(count);
        break;
      case ComplexityKind::kCount:
        break;
    }
    return std::move(scene_);
  }

 private:
  [[nodiscard]] double top() const { return hand_.lowest_m - kClear_m; }

  void add(Shape shape, const Vector3d& at_m, bool fixed) {
    SceneBody& body = scene_.bodies.emplace_back();
    body.name = "body-" + std::to_string(scene_.bodies.size());
    body.pose.translation_m = at_m;
    body.fixed = fixed;
    if (!fixed) {
      const ShapeMoments m = moments(shape);
      body.mass_kg = kMass_kg;
      body.com_m = m.center_m;
      body.inertia_kg_m2 = kMass_kg / m.volume_m3 * m.inertia_m5;
    }
    body.shapes.push_back(std::move(shape));
  }

  /// Adds a floor with its top at `floor_m` and walls around a square of width `width_m`.
  void tray(const Vector3d& middle_m, double floor_m, double width_m, double height_m) {
    constexpr double kWall_m = 0.02;
    const double out_m = width_m + 2.0 * kWall_m;
    add(boxOf({out_m, out_m, kWall_m}), {middle_m.x(), middle_m.y(), floor_m - 0.5 * kWall_m},
        true);
    SceneBody& body = scene_.bodies.back();
    for (const double side : {-1.0, 1.0}) {
      const double at_m = side * 0.5 * (width_m + kWall_m);
      const double up_m = 0.5 * (height_m + kWall_m);
      body.shapes.push_back(boxOf({kWall_m, out_m, height_m}, {at_m, 0.0, up_m}));
      body.shapes.push_back(boxOf({out_m, kWall_m, height_m}, {0.0, at_m, up_m}));
    }
  }

  /// Adds balls that lie in the hollows of the layer below, in layers of k², (k - 1)², k² ...
  /// balls.
  void pile(int count) {
    const double pitch_m = 2.0 * kBall_m + kGap_m;
    const double rise_m = std::sqrt(4.0 * kBall_m * kBall_m - 0.5 * pitch_m * pitch_m) + 1e-5;
    const int wide = std::max(2, static_cast<int>(std::ceil(std::sqrt(count / 2.2))));
    std::vector<Vector3d> at;  // positions, the bottom layer first
    for (int layer = 0; static_cast<int>(at.size()) < count; ++layer) {
      const int k = wide - layer % 2;
      for (const auto& [x, y] : fromTheMiddle(k)) {
        if (static_cast<int>(at.size()) == count) break;
        at.push_back({pitch_m * x, pitch_m * y, kBall_m + layer * rise_m});
      }
    }
    const double height_m = at.empty() ? 0.0 : at.back().z() + kBall_m;
    const double floor_m = top() - height_m;
    tray(hand_.middle_m, floor_m, wide * pitch_m + kGap_m, std::min(height_m, 2.0 * kBall_m));
    for (const Vector3d& p : at) {
      add(ballOf(kBall_m),
          {hand_.middle_m.x() + p.x(), hand_.middle_m.y() + p.y(), floor_m + p.z()}, false);
    }
  }

  void stacks(int count) {
    const int columns = (count + kStackHeight - 1) / kStackHeight;
    const int wide = std::max(1, static_cast<int>(std::ceil(std::sqrt(columns))));
    const double pitch_m = kBox_m + kGap_m;
    const double height_m = std::min(count, kStackHeight) * kBox_m;
    const double floor_m = top() - height_m;
    tray(hand_.middle_m, floor_m, wide * pitch_m + kGap_m, std::min(height_m, kBox_m));
    const auto columns_at = fromTheMiddle(wide);
    for (int i = 0; i < count; ++i) {
      const auto& [x, y] = columns_at[i / kStackHeight];
      add(boxOf(Vector3d::Constant(kBox_m)),
          {hand_.middle_m.x() + pitch_m * x, hand_.middle_m.y() + pitch_m * y,
           floor_m + kBox_m * (i % kStackHeight + 0.5)},
          false);
    }
  }

  /// Adds separate boxes on a table that is too low for the hand to reach.
  void apart(int count, const Vector3d& middle_m) {
    const int wide = std::max(1, static_cast<int>(std::ceil(std::sqrt(count))));
    const double floor_m = top() - kPress_m - 2.0 * kBox_m;
    const double width_m = wide * kApart_m + 0.2;
    const bool far = middle_m.x() > hand_.middle_m.x() + 0.5;
    const Vector3d place_m =
        far ? Vector3d(middle_m.x() + 0.5 * width_m, middle_m.y(), 0.0) : middle_m;
    add(boxOf({width_m, width_m, 0.02}), {place_m.x(), place_m.y(), floor_m - 0.01}, true);
    for (int i = 0; i < count; ++i) {
      const int row = i / wide, column = i % wide;
      add(boxOf(Vector3d::Constant(kBox_m)),
          {place_m.x() + kApart_m * (column - 0.5 * (wide - 1)),
           place_m.y() + kApart_m * (row - 0.5 * (wide - 1)), floor_m + 0.5 * kBox_m},
          false);
    }
  }

  /// Adds a ball of flat faces in a tray. `count` is rounded to a possible number of corners of
  /// such a ball.
  Expected<Done> mesh(int count) {
    const int around = std::max(4, static_cast<int>(std::lround(std::sqrt(2.0 * (count - 2)))));
    const int rings = std::max(1, (count - 2) / around);
    std::vector<Vector3d> points{{0.0, 0.0, kMesh_m}, {0.0, 0.0, -kMesh_m}};
    std::vector<Eigen::Vector3i> faces;
    const auto at = [&](int ring, int i) { return 2 + ring * around + i % around; };
    for (int ring = 0; ring < rings; ++ring) {
      const double down = pi * (ring + 1) / (rings + 1);
      for (int i = 0; i < around; ++i) {
        const double turn = 2.0 * pi * i / around;
        points.push_back(kMesh_m * Vector3d(std::sin(down) * std::cos(turn),
                                            std::sin(down) * std::sin(turn), std::cos(down)));
        if (ring == 0) faces.push_back({0, at(0, i), at(0, i + 1)});
        if (ring == rings - 1) faces.push_back({1, at(ring, i + 1), at(ring, i)});
        if (ring > 0) {
          faces.push_back({at(ring - 1, i), at(ring, i), at(ring, i + 1)});
          faces.push_back({at(ring - 1, i), at(ring, i + 1), at(ring - 1, i + 1)});
        }
      }
    }
    Expected<Shape> shape = convexMesh(points, faces);
    if (!shape) return shape.errors();
    const double floor_m = top() - 2.0 * kMesh_m;
    tray(hand_.middle_m, floor_m, 2.0 * kMesh_m + kGap_m, kMesh_m);
    add(std::move(*shape), {hand_.middle_m.x(), hand_.middle_m.y(), floor_m + kMesh_m}, false);
    return Done{};
  }

  /// Adds small fixed balls below the capsules at the depth to which the hand sinks.
  void bed(int count) {
    constexpr double kSmall_m = 0.003;
    constexpr double kSink_m = 0.002;
    const auto capsules = static_cast<int>(hand_.capsules.size());
    const int each = (count + capsules - 1) / std::max(capsules, 1);
    for (int i = 0; i < count; ++i) {
      const StartingHand::Placed& c = hand_.capsules[i % capsules];
      const int turn = i / capsules;
      const double along = (turn + 0.5) / each;
      const Vector3d on_axis = c.a_m + along * (c.b_m - c.a_m);
      const double down_m = c.radius_m + kSmall_m + kClear_m + kPress_m - kSink_m;
      add(ballOf(kSmall_m), on_axis - Vector3d(0.0, 0.0, down_m), true);
    }
  }

  StartingHand hand_;
  SceneModel scene_;
};

}  // namespace

const char* complexityName(ComplexityKind kind) {
  constexpr std::array<const char*, kComplexityKinds> kNames{"pile", "stacks",   "apart",
                                                             "far",  "vertices", "contacts"};
  return kNames.at(static_cast<std::size_t>(kind));
}

Intention swayingHand(const DeviceModel& device, double duration_s) {
  const double pressed_m = kStart_z_m - kClear_m - kPress_m;
  std::vector<Waypoint> way{{0.0, handAt(device, 0.0, kStart_z_m)},
                            {kDown_s, handAt(device, 0.0, pressed_m)}};
  double side_m = kSway_m;
  while (way.back().time_s < duration_s) {
    way.push_back({way.back().time_s + 0.5 * kSwayPeriod_s, handAt(device, side_m, pressed_m)});
    side_m = -side_m;
  }
  return Intention::throughWaypoints(std::move(way));
}

Expected<SceneModel> complexityScene(ComplexityKind kind, int count, const Models& models) {
  return SceneOf(models).make(kind, count);
}

}  // namespace wholehand
