// First touch: a virtual patient lowers the hand onto a box, and the device renders the contact.
//
// Shows the whole path in one page: files -> models -> rig -> arm -> tick -> record. Prints every
// tenth of a second the position of the device, the position of the simulated hand and the effort
// that the person feels. At rest this effort is K_pm times the distance between the two positions.
//
//   01_first_touch [folder that holds config/]
#include "wholehand/wholehand.hpp"

#include <cstdio>
#include <string>

using namespace wholehand;

// A box under the hand; its top is 60 mm below the middle of the workspace.
SceneBody makeBox() {
  Shape shape;  // a box by default
  shape.half_extents_m = {0.3, 0.3, 0.1};
  SceneBody body;
  body.name = "box";
  body.fixed = true;
  body.pose.translation_m = {0.1, 0.0, -0.16};
  body.shapes.push_back(shape);
  return body;
}

int refuse(const Diagnostics& why) {
  std::fprintf(stderr, "%s\n", format(why).c_str());
  return 2;
}

int main(int argc, char** argv) {
  const std::string folder = argc > 1 ? argv[1] : WHOLEHAND_SOURCE_DIR;
  ModelFiles files;
  for (std::string* file :
       {&files.scene, &files.hand, &files.device, &files.rendering, &files.patient}) {
    *file = folder + "/" + *file;  // files that come with the program
  }
  files.scene = folder + "/config/scenes/empty.toml";
  Expected<Models> models = loadModels(files);
  if (!models) return refuse(models.errors());
  models->scene.bodies.push_back(makeBox());

  // The person aims 60 mm down: with the hand on edge, 40 mm into the box.
  const int z = models->device.axisIndex("z");
  AxisPosition above(models->device.axisCount()), below = above;
  below[z] = -0.06;
  Intention intention = Intention::throughWaypoints({{0.5, above}, {1.5, below}});

  auto rig = buildRig(*models, std::move(intention), RigOptions{});
  if (!rig) return refuse(rig.errors());
  HapticRenderer& renderer = *(*rig)->renderer;
  if (auto armed = renderer.arm(); !armed) return refuse(armed.errors());

  std::printf("%8s %12s %12s %12s %10s\n", "time s", "device mm", "hand mm", "felt N", "contacts");
  TickRecord record;
  for (int tick = 0; tick <= 2000; ++tick) {
    renderer.tick(1, record);  // a real device needs one tick per millisecond: see Session
    if (any(record.faults & kStoppingFaults)) return 3;
    if (tick % 100 != 0) continue;
    std::printf("%8.1f %12.2f %12.2f %12.3f %10d\n", tick * 1e-3, record.q_m[z] * 1e3,
                record.q_s[z] * 1e3, record.sent[z], record.contact_count);
  }
  renderer.requestStop();  // first ramps to the device's neutral effort, which carries its weight
  while (!renderer.atNeutral()) renderer.tick(1, record);
  (*rig)->device->close();
}
