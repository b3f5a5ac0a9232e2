#include "files/scene/object_scene.hpp"

#include "files/foreign/foreign_file.hpp"
#include "files/toml/toml_file.hpp"
#include "loop/core/printable.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string_view>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using std::numbers::pi;

constexpr double kNearest_m = 0.16;    // x of the object's nearest face
constexpr double kTable_m = -0.1;      // height of the table's top, as in the shipped scenes
constexpr double kAround_m = 0.2;      // of the table beyond the object
constexpr double kThick_m = 0.04;      // of the table
constexpr double kWritten_m = 1e-5;    // places are written to this
constexpr double kSidesDiffer = 0.05;  // a turn must be better by this share

AlignedBox3d boxIn(const Pose& pose, const std::vector<Shape>& shapes) {
  AlignedBox3d box;
  for (const Shape& shape : shapes) {
    for (const Vector3d& p : boundingPoints(shape)) box.extend(pose * p);
  }
  return box;
}

/// The object in the frame of its root link.
struct Extent {
  AlignedBox3d whole, moving;
  Vector3d opens = Vector3d::Zero();  ///< sum of where its joints open to; 0: nowhere
};

Extent extentOf(const UrdfBody& urdf) {
  Extent extent;
  extent.whole = boxIn({}, urdf.shapes);
  std::vector<Pose> at(urdf.movers.size());
  for (std::size_t i = 0; i < urdf.movers.size(); ++i) {
    const UrdfMover& mover = urdf.movers[i];
    at[i] = mover.carrier >= 0 ? at[mover.carrier] * mover.in_carrier : mover.in_carrier;
    extent.moving.extend(boxIn(at[i], mover.shapes));
  }
  extent.whole.extend(extent.moving);
  for (std::size_t i = 0; i < urdf.movers.size(); ++i) {
    const SceneJoint& joint = urdf.movers[i].joint;
    const AlignedBox3d box = boxIn(at[i], urdf.movers[i].shapes);
    if (box.isEmpty()) continue;
    if (joint.isHinge()) {
      extent.opens += 2.0 * (box.center() - extent.whole.center());
    } else {
      const double way = joint.most > -joint.least ? 1.0 : -1.0;
      extent.opens += way * box.sizes().maxCoeff() * (at[i].rotation * joint.axis);
    }
  }
  return extent;
}

/// Number of quarters of a turn about z that bring the opening side to -x, where the hand is.
int quartersTowardsHand(const Vector3d& opens) {
  const std::array<double, 4> along = {-opens.x(), opens.y(), opens.x(), -opens.y()};
  const double least = kSidesDiffer * opens.head<2>().norm();
  int best = 0;
  for (int k = 1; k < 4; ++k) {
    if (along[k] > along[best] + least) best = k;
  }
  return best;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

std::string numbers(const Vector3d& v, double step) {
  std::string out = "[";
  for (int i = 0; i < 3; ++i) {
    out += (i > 0 ? ", " : "") + formatNumber(step * std::round(v[i] / step) + 0.0);
  }
  return out + "]";
}

}  // namespace

bool isUrdf(const std::string& path) {
  if (const auto foreign = foreignFileAt(path)) {
    // An expanded xacro keeps its namespace; loadUrdf() knows whether macros are left.
    return foreign->problem == "is a URDF" || foreign->problem.starts_with("is xacro");
  }
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending == ".urdf";
}

ObjectScene makeObjectScene(const std::string& path, const UrdfBody& urdf) {
  const std::filesystem::path file = path;
  const Extent extent = extentOf(urdf);
  const bool stands = !urdf.movers.empty() || (urdf.massless && !urdf.inertial);
  const int quarters = quartersTowardsHand(extent.opens);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.5 * pi * quarters, Vector3d::UnitZ()).toRotationMatrix();
  const auto turned = [&](const AlignedBox3d& box) {
    AlignedBox3d out;
    for (int i = 0; i < 8; ++i) {
      out.extend(turn * box.corner(static_cast<AlignedBox3d::CornerType>(i)));
    }
    return out;
  };
  const AlignedBox3d whole = turned(extent.whole);
  const AlignedBox3d face = extent.moving.isEmpty() ? whole : turned(extent.moving);
  Vector3d at(kNearest_m - whole.min().x(), -face.center().y(), -face.center().z());
  if (!stands) at.z() = kTable_m - whole.min().z();

  ObjectScene made;
  made.text = fmt::format(
      "# Made of {}: the object before the hand.\nkind = \"scene\"\nversion = 1\nname = {}\n"
      "gravity_m_s2 = [0.0, 0.0, -9.81]\n\n[[bodies]]\nname = {}\nshape = \"urdf\"\nfile = {}\n"
      "position_m = {}\n",
      printable(file.filename().string()), quoted(file.stem().string()),
      quoted(file.stem().string()), quoted(file.filename().string()), numbers(at, kWritten_m));
  if (quarters > 0) {
    made.text +=
        fmt::format("orientation_rpy_rad = [0.0, 0.0, {}]\n", formatNumber(0.5 * pi * quarters));
  }
  std::string where = fmt::format("{:.0f} cm before the hand", 100.0 * kNearest_m);
  if (quarters > 0) where += fmt::format(", turned by {}° about z", 90 * quarters);
  if (!stands) {
    where += ", on a table";
    const Vector3d size = whole.sizes() + Vector3d(2.0 * kAround_m, 2.0 * kAround_m, 0.0);
    const Vector3d middle(kNearest_m + 0.5 * whole.sizes().x(), at.y() + whole.center().y(),
                          kTable_m - 0.5 * kThick_m);
    made.text += fmt::format(
        "\n[[bodies]]\nname = {}\nshape = \"box\"\nsize_m = {}\nfixed = true\nposition_m = {}\n"
        "color = \"#D9B98C\"\n",
        file.stem() == "table" ? "\"top\"" : "\"table\"",
        numbers({std::min(size.x(), 10.0), std::min(size.y(), 10.0), kThick_m}, kWritten_m),
        numbers(middle, kWritten_m));
  }
  made.notice = fileFault(path, "is a URDF: the scene was made of it, the object " + where,
                          "name it in a scene of its own (config/scenes/table.toml) to place it");
  return made;
}

}  // namespace wholehand
