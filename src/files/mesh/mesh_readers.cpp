#include "files/mesh/mesh_readers.hpp"

#include "loop/core/printable.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>
#include <utility>

namespace wholehand {
namespace {

using Eigen::Vector3d;

constexpr std::string_view kWordEnds = " \t\r\n\v\f";
/// Largest number of corners of a polygon cut into ears; the search takes cubic time.
constexpr std::size_t kMostEars = 256;

/// Normal of a polygon by Newell's sum over its edges; also valid for a polygon that is not convex.
Vector3d polygonNormal(const MeshSurface& surface, const std::vector<int>& corners) {
  const Vector3d& origin = surface.points[corners.front()];
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector3d& next = surface.points[corners[(i + 1) % corners.size()]];
    sum += (surface.points[corners[i]] - origin).cross(next - origin);
  }
  return sum;
}

/// True when every corner of the polygon is convex. The fan from its first corner is then the
/// polygon itself; other programs divide four corners that are not in one plane in the same way.
bool isConvex(const MeshSurface& surface, const std::vector<int>& corners, const Vector3d& normal) {
  const std::size_t n = corners.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vector3d& here = surface.points[corners[i]];
    const Vector3d in = here - surface.points[corners[(i + n - 1) % n]];
    if (normal.dot(in.cross(surface.points[corners[(i + 1) % n]] - here)) < 0.0) return false;
  }
  return true;
}

/// True when corner `i` is convex and no other corner lies in its triangle.
bool isEar(const MeshSurface& surface, const std::vector<int>& corners, std::size_t i,
           const Vector3d& normal) {
  const std::size_t n = corners.size();
  const int before = corners[(i + n - 1) % n], here = corners[i], after = corners[(i + 1) % n];
  const Vector3d &a = surface.points[before], &b = surface.points[here], &c = surface.points[after];
  const auto side = [&](const Vector3d& from, const Vector3d& to, const Vector3d& p) {
    return normal.dot((to - from).cross(p - from));
  };
  if (!(side(a, b, c) > 0.0)) return false;
  return std::none_of(corners.begin(), corners.end(), [&](int other) {
    const Vector3d& p = surface.points[other];
    if (p == a || p == b || p == c) return false;
    return side(a, b, p) >= 0.0 && side(b, c, p) >= 0.0 && side(c, a, p) >= 0.0;
  });
}

}  // namespace

std::optional<double> meshNumber(std::string_view word) {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  double value = 0.0;
  const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (stop != word.data() + word.size()) return std::nullopt;
  if (error == std::errc{}) return value;
  const bool small = error == std::errc::result_out_of_range &&
                     (word.find("e-") != word.npos || word.find("E-") != word.npos);
  return small ? std::optional<double>(0.0) : std::nullopt;
}

bool isCorner(double value, std::size_t count) {
  return value >= 0.0 && value < static_cast<double>(count) && value == std::floor(value);
}

std::string_view MeshWords::next() {
  for (; at_ < text_.size() && kWordEnds.find(text_[at_]) != kWordEnds.npos; ++at_) {
    // A carriage return without a newline also ends a line.
    if (text_[at_] == '\n' || (text_[at_] == '\r' && !text_.substr(at_).starts_with("\r\n")))
      ++line_;
  }
  const std::size_t begin = at_;
  at_ = std::min(text_.find_first_of(kWordEnds, begin), text_.size());
  return text_.substr(begin, at_ - begin);
}

std::string_view MeshWords::restOfLine() {
  const std::size_t end = std::min(text_.find_first_of("\r\n", at_), text_.size());
  std::string_view rest = text_.substr(at_, end - at_);
  at_ = end;
  rest.remove_prefix(std::min(rest.find_first_not_of(kWordEnds), rest.size()));
  return rest.substr(0, rest.find_last_not_of(kWordEnds) + 1);
}

double MeshWords::number() {
  const std::string_view word = next();
  if (const auto value = meshNumber(word)) return *value;
  throw UnreadableMesh{
      fmt::format("has {} where a number belongs, in line {}",
                  word.empty() ? "its end" : fmt::format("\"{}\"", printable(word, 40)), line_),
      "correct this line, or export it again"};
}

std::int64_t MeshWords::whole(std::int64_t least, std::int64_t most) {
  const double value = number();
  if (value == std::floor(value) && value >= static_cast<double>(least) &&
      value <= static_cast<double>(most)) {
    return static_cast<std::int64_t>(value);
  }
  throw UnreadableMesh{fmt::format("has {:g} where a whole number in [{}, {}] belongs, in line {}",
                                   value, least, most, line_),
                       "correct this line, or export it again"};
}

std::string_view withoutByteOrderMark(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  return text;
}

void addPolygon(MeshSurface& surface, const std::vector<int>& corners) {
  std::vector<int> left = corners;
  const Vector3d normal = left.size() > 3 ? polygonNormal(surface, left) : Vector3d::Zero();
  if (isConvex(surface, left, normal)) return addFan(surface, left);
  while (left.size() > 3 && left.size() <= kMostEars) {
    std::size_t ear = 0;
    while (ear < left.size() && !isEar(surface, left, ear, normal)) ++ear;
    if (ear == left.size()) break;
    const std::size_t n = left.size();
    surface.triangles.emplace_back(left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]);
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  addFan(surface, left);
}

void addStrip(MeshSurface& surface, const std::vector<int>& corners) {
  for (std::size_t i = 2; i < corners.size(); ++i) {
    const bool turned = i % 2 == 1;
    surface.triangles.emplace_back(corners[i - (turned ? 1 : 2)], corners[i - (turned ? 2 : 1)],
                                   corners[i]);
  }
}

void addFan(MeshSurface& surface, const std::vector<int>& corners) {
  for (std::size_t i = 2; i < corners.size(); ++i) {
    surface.triangles.emplace_back(corners[0], corners[i - 1], corners[i]);
  }
}

void place(const MeshSurface& surface, const Eigen::Matrix4d& map, MeshFile& file) {
  if (surface.triangles.empty()) return;
  if (map.allFinite() && !map.row(3).isApprox(Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0), 1e-6)) {
    throw UnreadableMesh{"has a node whose matrix does not end in 0 0 0 1", "export it again"};
  }
  if (file.surface.triangles.size() + surface.triangles.size() > kMostPlacedTriangles ||
      file.surface.points.size() + surface.points.size() > 3 * kMostPlacedTriangles) {
    throw UnreadableMesh{
        fmt::format("places more than {} triangles by its nodes", kMostPlacedTriangles),
        "simplify the surface"};
  }
  const int first = static_cast<int>(file.surface.points.size());
  const Eigen::Matrix3d linear = map.topLeftCorner<3, 3>();
  const Vector3d shift = map.topRightCorner<3, 1>();
  const bool mirrored = linear.determinant() < 0.0;
  const int part = file.part.empty() ? 0 : file.part.back() + 1;
  for (const Vector3d& p : surface.points) file.surface.points.push_back(linear * p + shift);
  for (Eigen::Vector3i t : surface.triangles) {
    if (mirrored) std::swap(t[1], t[2]);
    file.surface.triangles.emplace_back(t + Eigen::Vector3i::Constant(first));
    file.part.push_back(part);
  }
}

}  // namespace wholehand
