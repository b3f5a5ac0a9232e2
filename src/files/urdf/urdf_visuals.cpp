#include "files/urdf/urdf_visuals.hpp"

#include "files/mesh/mesh_file.hpp"
#include "files/urdf/urdf_text.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string_view>

namespace wholehand {
namespace {

using Eigen::Vector3d;
using tinyxml2::XMLElement;

/// So many numbers of an attribute; empty: other ones, or none.
std::optional<std::vector<double>> numbersOf(const XMLElement& e, const char* attribute,
                                             std::size_t count) {
  const char* const text = e.Attribute(attribute);
  auto numbers = parseNumbers(text != nullptr ? text : "");
  if (!numbers || numbers->size() != count) return std::nullopt;
  return numbers;
}

Pose originOf(const XMLElement& visual) {
  Pose pose;
  const XMLElement* const origin = visual.FirstChildElement("origin");
  if (origin == nullptr) return pose;
  if (const auto xyz = numbersOf(*origin, "xyz", 3)) pose.translation_m = Vector3d(xyz->data());
  if (const auto rpy = numbersOf(*origin, "rpy", 3)) {
    pose.rotation = rotationFromRpy((*rpy)[0], (*rpy)[1], (*rpy)[2]);
  }
  return pose;
}

/// The visual without its place; empty: it cannot be read.
std::optional<UrdfVisual> shapeOf(const XMLElement& e, const std::string& urdf) {
  const std::string_view kind = e.Name();
  UrdfVisual visual;
  if (kind == "mesh") {
    const char* const name = e.Attribute("filename");
    if (name == nullptr) return std::nullopt;
    visual.mesh = meshPath(name, urdf).string();
    const auto scale = numbersOf(e, "scale", 3);
    visual.size = scale ? Vector3d(scale->data()) : Vector3d::Ones();
    return visual;
  }
  if (kind == "box") {
    const auto size = numbersOf(e, "size", 3);
    if (!size) return std::nullopt;
    visual.size = Vector3d(size->data()) / 2.0;
    return visual;
  }
  const auto radius = numbersOf(e, "radius", 1);
  if (!radius) return std::nullopt;
  visual.size.setConstant(radius->front());
  const auto length = numbersOf(e, "length", 1);
  if (kind == "cylinder" && length) visual.size.z() = length->front() / 2.0;
  if (kind == "capsule" && length) visual.size.z() += length->front() / 2.0;
  return visual;
}

}  // namespace

std::vector<UrdfVisual> readVisuals(const XMLElement& link, const std::string& urdf) {
  std::vector<UrdfVisual> visuals;
  for (const XMLElement* e = link.FirstChildElement("visual"); e != nullptr;
       e = e->NextSiblingElement("visual")) {
    const XMLElement* const geometry = e->FirstChildElement("geometry");
    const XMLElement* const kind = geometry != nullptr ? geometry->FirstChildElement() : nullptr;
    if (kind == nullptr) continue;
    if (std::optional<UrdfVisual> visual = shapeOf(*kind, urdf)) {
      visual->in_body = originOf(*e);
      visuals.push_back(std::move(*visual));
    }
  }
  return visuals;
}

std::vector<Vector3d> pointsOf(const std::vector<UrdfVisual>& visuals, MeshLoadTime& time,
                               std::vector<std::string>& files) {
  std::vector<Vector3d> points;
  for (const UrdfVisual& visual : visuals) {
    if (visual.mesh.empty()) {
      for (int i = 0; i < 8; ++i) {
        const Vector3d side((i & 1) != 0 ? 1.0 : -1.0, (i & 2) != 0 ? 1.0 : -1.0,
                            (i & 4) != 0 ? 1.0 : -1.0);
        points.push_back(visual.in_body * visual.size.cwiseProduct(side));
      }
      continue;
    }
    if (time.isOver()) continue;
    const Expected<MeshFile> mesh = time.measure(visual.mesh, [&](auto* spent) {
      return readMesh(visual.mesh, std::min(time.left(), kLongestMeshRead), spent);
    });
    if (!mesh) continue;
    files.push_back(visual.mesh);
    for (const Vector3d& p : mesh->surface.points) {
      points.push_back(visual.in_body * visual.size.cwiseProduct(p));
    }
  }
  return points;
}

}  // namespace wholehand
