// Your own device (rails.hpp): thirty lines read positions and write efforts, and the renderer
// drives it like any other device.
//
// Here the "hardware" is a handle on three rails that a person pulls forward with a steady 3 N. A
// wall stands 17 mm ahead of the fingertips. At rest the wall must give back exactly these 3 N.
//
//   02_own_device [folder that holds config/]
#include "rails.hpp"

#include <cstdio>
#include <memory>
#include <string>

using namespace wholehand;

int main(int argc, char** argv) {
  const std::string config = (argc > 1 ? argv[1] : std::string(WHOLEHAND_SOURCE_DIR)) + "/config/";
  auto models =
      loadModels({.scene = config + "scenes/empty.toml",
                  .hand = config + "hands/adult-median-right.toml",
                  .device = config + "devices/desktop-3axis.toml",  // describes the three axes
                  .rendering = config + "rendering/desktop-3axis.toml",
                  .patient = config + "patients/no-arm.toml"});
  if (!models) return std::fprintf(stderr, "%s\n", format(models.errors()).c_str()), 2;
  SceneBody wall;
  wall.name = "wall";
  wall.fixed = true;
  wall.pose.translation_m = {0.205, 0.0, 0.0};
  wall.shapes.emplace_back().half_extents_m = {0.05, 0.5, 0.5};
  models->scene.bodies.push_back(wall);

  constexpr double kPull_n = 3.0;
  auto rig = buildRig(*models, std::make_unique<Rails>(0, kPull_n), RigOptions{});
  if (!rig) return std::fprintf(stderr, "%s\n", format(rig.errors()).c_str()), 2;
  // A device that may move a person is armed only after a rehearsal, which simulates the worst
  // contacts on this machine.
  auto rehearsal = rehearse(*models, AxisPosition(3), RigOptions{});
  if (!rehearsal) return std::fprintf(stderr, "%s\n", format(rehearsal.errors()).c_str()), 2;
  HapticRenderer& renderer = *(*rig)->renderer;
  auto armed = renderer.arm(rehearsal->passed);
  if (!armed) return std::fprintf(stderr, "%s\n", format(armed.errors()).c_str()), 2;
  TickRecord record;
  for (int tick = 0; tick < 2000; ++tick) {
    renderer.tick(1, record);
    if (tick % 100 == 0) std::printf("x %6.2f mm  %6.3f N\n", record.q_m[0] * 1e3, record.sent[0]);
  }
  std::printf("pulled with %.3f N, the wall gives back %.3f N\n", kPull_n, -record.sent[0]);
  renderer.requestStop();  // ramps to the neutral effort, within 100 ms
  while (!renderer.atNeutral()) renderer.tick(1, record);
  (*rig)->device->close();
}
