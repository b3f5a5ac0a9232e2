#include "experiments/grip_target.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <string>
#include <vector>

namespace wholehand {

GripTarget firstDispenser(const Models& models) {
  if (!models.exercise) return {};
  const auto json = nlohmann::json::parse(models.exercise->description().json, nullptr, false);
  if (json.is_discarded() || !json.contains("dispensers") || json["dispensers"].empty()) return {};
  const auto& item = json["dispensers"][0];
  GripTarget out;
  out.body = models.scene.bodyIndex(item.value("body", ""));
  if (out.body < 0) return {};
  const SceneBody& body = models.scene.bodies[out.body];
  const auto grip = item.value("grip_m", std::vector<double>{0.0, 0.0, 0.0});
  out.grip_m = body.pose * (body.com_m + Eigen::Vector3d(grip.at(0), grip.at(1), grip.at(2)));
  return out;
}

GripTarget firstBody(const Models& models) {
  const auto& bodies = models.scene.bodies;
  if (bodies.empty()) return {};
  const auto moves = [](const SceneBody& body) { return !body.fixed; };
  auto found = std::find_if(bodies.begin(), bodies.end(), moves);
  if (found == bodies.end()) found = bodies.begin();
  return {static_cast<int>(found - bodies.begin()), found->pose * found->com_m};
}

}  // namespace wholehand
