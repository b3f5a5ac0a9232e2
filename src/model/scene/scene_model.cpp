#include "model/scene/scene_model.hpp"

#include "core/world_query.hpp"

#include <algorithm>
#include <cstddef>

namespace wholehand {

int SceneModel::bodyIndex(const std::string& body_name) const {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].name == body_name) return static_cast<int>(i);
  }
  return -1;
}

std::vector<std::string> SceneModel::recordedBodies() const {
  std::vector<std::string> names;
  for (const SceneBody& body : bodies) names.push_back(body.name);
  for (int slot = 0; slot < game.slots; ++slot) names.push_back("slot " + std::to_string(slot));
  names.resize(std::min<std::size_t>(names.size(), kMaxBodies));
  return names;
}

Shape coreOf(const SceneBody& body, const Shape& shape) {
  Shape core = shape;
  if (shape.type == ShapeType::kCylinder) core.radius_m -= body.soft_m;
  return core;
}

}  // namespace wholehand
