#include "model/urdf/urdf_collision.hpp"

#include "model/mesh/convex_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <string_view>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

using tinyxml2::XMLElement;
namespace fs = std::filesystem;

/// Resolves a URDF's mesh name; the unresolved path if nothing is found, so that the mesh reader's
/// message names it.
fs::path meshPath(std::string_view name, const fs::path& urdf) {
  constexpr std::string_view kFile = "file://", kPackage = "package://";
  const fs::path folder = fs::absolute(urdf).parent_path();
  if (name.starts_with(kFile)) return fs::path(name.substr(kFile.size()));
  if (!name.starts_with(kPackage)) return folder / fs::path(name);
  name.remove_prefix(kPackage.size());
  const std::size_t slash = std::min(name.find('/'), name.size());
  const fs::path package(name.substr(0, slash));
  const fs::path rest(name.substr(std::min(slash + 1, name.size())));
  std::error_code error;
  for (fs::path up = folder; up.has_relative_path(); up = up.parent_path()) {
    fs::path inside = up / rest, below = up / package / rest;
    if (up.filename() == package && fs::exists(inside, error)) return inside;
    if (fs::exists(below, error)) return below;
  }
  return folder / package / rest;
}

std::optional<Shape> readBox(const XMLElement& e, const std::string& key, UrdfFaults& faults) {
  const std::size_t before = faults.all().size();
  const std::vector<double> size = faults.numbers(e, "size", key, 3);
  if (faults.all().size() > before) return std::nullopt;
  const auto [least, most] = std::minmax_element(size.begin(), size.end());
  if (*least < 1e-3 || *most > 10.0) {
    faults.add(&e, key + ".size", e.Attribute("size"), "is out of range",
               "must be three lengths in [0.001, 10] m");
    return std::nullopt;
  }
  Shape shape;
  shape.half_extents_m = Eigen::Vector3d(size[0], size[1], size[2]) / 2.0;
  return shape;
}

std::optional<Shape> readMesh(const XMLElement& e, const std::string& key, UrdfFaults& faults,
                              UrdfMeshes& meshes) {
  const std::string name = faults.text(e, "filename", key);
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
  if (e.Attribute("scale") != nullptr) {
    const std::vector<double> s = faults.numbers(e, "scale", key, 3);
    scale = {s[0], s[1], s[2]};
  }
  if (name.empty()) return std::nullopt;
  meshes.files.push_back(meshPath(name, faults.file()).string());
  if (meshes.time->isOver()) return std::nullopt;  // with a fault at the mesh before
  Expected<MeshCollider> mesh = loadMeshCollider(meshes.files.back(), scale, *meshes.time);
  if (mesh) {
    if (mesh->notice) faults.note(&e, key + ".filename", name, std::move(*mesh->notice));
    return std::move(mesh->shape);
  }
  const Diagnostic& d = mesh.errors().front();
  faults.add(&e, key + ".filename", name, d.problem, d.remedy);
  return std::nullopt;
}

std::optional<Shape> readRound(const XMLElement& e, ShapeType type, const std::string& key,
                               UrdfFaults& faults) {
  const std::size_t before = faults.all().size();
  Shape shape;
  shape.type = type;
  shape.radius_m = faults.length_m(e, "radius", key);
  if (type != ShapeType::kSphere) shape.length_m = faults.length_m(e, "length", key);
  if (faults.all().size() > before) return std::nullopt;
  return shape;
}

std::optional<Shape> readGeometry(const XMLElement& e, const std::string& key, UrdfFaults& faults,
                                  UrdfMeshes& meshes) {
  const std::string_view kind = e.Name();
  if (kind == "box") return readBox(e, key, faults);
  if (kind == "sphere") return readRound(e, ShapeType::kSphere, key, faults);
  if (kind == "cylinder") return readRound(e, ShapeType::kCylinder, key, faults);
  if (kind == "capsule") return readRound(e, ShapeType::kCapsule, key, faults);
  if (kind == "mesh") return readMesh(e, key, faults, meshes);
  faults.add(&e, key, "", fmt::format("is an unknown shape <{}>", kind),
             "must be one of box, sphere, cylinder, capsule, mesh");
  return std::nullopt;
}

}  // namespace

std::optional<Shape> readUrdfCollision(const XMLElement& collision, const std::string& key,
                                       UrdfFaults& faults, UrdfMeshes& meshes) {
  const XMLElement* geometry = collision.FirstChildElement("geometry");
  const XMLElement* kind = geometry != nullptr ? geometry->FirstChildElement() : nullptr;
  if (kind == nullptr || kind->NextSiblingElement() != nullptr) {
    faults.add(&collision, key + ".geometry", "", "does not hold exactly one shape",
               "give one of box, sphere, cylinder, capsule, mesh");
    return std::nullopt;
  }
  std::optional<Shape> shape = readGeometry(*kind, key + "." + kind->Name(), faults, meshes);
  const Pose in_link = faults.origin(collision, key);
  if (shape) shape->in_body = in_link;
  return shape;
}

}  // namespace wholehand
