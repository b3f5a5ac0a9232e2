// The rig alone: reads a hand and a device, certifies the gains, rehearses the worst contacts and
// ticks. Links wholehand::rig, which has no recorder, station or driver, and needs no HDF5, Boost
// or SQLite.
//
//   08_rig_alone [folder that holds config/]
#include "wholehand/wholehand.hpp"

#include <cstdio>
#include <string>

using namespace wholehand;

int refuse(const Diagnostics& why) {
  std::fprintf(stderr, "%s\n", format(why).c_str());
  return 2;
}

int main(int argc, char** argv) {
  const std::string config = std::string(argc > 1 ? argv[1] : WHOLEHAND_SOURCE_DIR) + "/config";
  ModelFiles files;
  files.scene = config + "/scenes/four-shapes.toml";
  files.hand = config + "/hands/adult-median-right.toml";
  files.device = config + "/devices/lambda-pride.toml";
  files.rendering = config + "/rendering/lambda-pride.toml";
  files.patient = config + "/patients/relaxed-adult.toml";
  auto models = loadModels(files);
  if (!models) return refuse(models.errors());

  const RigOptions options;  // 1 kHz
  auto gains = checkGains(*models, options.period_s);
  if (!gains || !gains->refused.empty()) return refuse(gains ? gains->refused : gains.errors());
  AxisPosition back = restPose(*models);  // the hand withdrawn from the four shapes
  back[models->device.axisIndex("x")] = models->device.axes[models->device.axisIndex("x")].lower;
  auto rehearsal = rehearse(*models, back, options);
  if (!rehearsal) return refuse(rehearsal.errors());
  std::printf("certified; rehearsed: %s\n", describe(*rehearsal).c_str());

  auto rig = buildRig(*models, Intention::throughWaypoints({{0.0, back}}), options);
  if (!rig) return refuse(rig.errors());
  HapticRenderer& renderer = *(*rig)->renderer;
  if (auto armed = renderer.arm(rehearsal->passed); !armed) return refuse(armed.errors());
  TickRecord record;
  for (int tick = 0; tick < 1000; ++tick) renderer.tick(1, record);
  std::printf("%d axes, state %d, faults %u after 1 s\n", record.q_m.size(),
              static_cast<int>(record.safety_state), static_cast<unsigned>(record.faults));
  renderer.requestStop();  // ramps to the neutral effort
  while (!renderer.atNeutral()) renderer.tick(1, record);
  (*rig)->device->close();
}
