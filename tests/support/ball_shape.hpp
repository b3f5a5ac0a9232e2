#pragma once

#include "loop/model/scene_model.hpp"

namespace wholehand::test {

inline Shape ballShape(double radius_m) {
  Shape shape;
  shape.type = ShapeType::kSphere;
  shape.radius_m = radius_m;
  return shape;
}

}  // namespace wholehand::test
