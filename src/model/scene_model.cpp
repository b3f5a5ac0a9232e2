#include "model/scene_model.hpp"

#include <cstddef>

namespace wholehand {

int SceneModel::bodyIndex(const std::string& body_name) const {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].name == body_name) return static_cast<int>(i);
  }
  return -1;
}

}  // namespace wholehand
