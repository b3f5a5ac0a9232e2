#include "model/scene/scene_model.hpp"

#include <cstddef>

namespace wholehand {

int SceneModel::bodyIndex(const std::string& body_name) const {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].name == body_name) return static_cast<int>(i);
  }
  return -1;
}

Shape coreOf(const SceneBody& body, const Shape& shape) {
  Shape core = shape;
  if (shape.type == ShapeType::kCylinder) core.radius_m -= body.soft_m;
  return core;
}

}  // namespace wholehand
