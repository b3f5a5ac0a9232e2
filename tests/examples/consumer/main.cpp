// A program outside the source tree: builds a rig from the installed files, runs a session in its
// own thread and reads the records.
#include <cmath>
#include <cstdio>
#include <string>
#include <wholehand/wholehand.hpp>

using namespace wholehand;

int fail(const std::string& why) {
  std::fprintf(stderr, "%s\n", why.c_str());
  return 1;
}

int main() {
  const std::string config = SHARE "/config/";
  ModelFiles files;
  files.scene = config + "scenes/four-shapes.toml";
  files.hand = config + "hands/adult-median-right.toml";
  files.device = config + "devices/lambda-pride.toml";
  files.rendering = config + "rendering/lambda-pride.toml";
  files.patient = config + "patients/relaxed-adult.toml";
  files.motion = SHARE "/data/human-motion/reach-grasp-00.csv";
  auto models = loadModels(files);
  if (!models) return fail(format(models.errors()));
  AxisPosition rest(models->device.axisCount());
  Intention intention =
      Intention::fromMotion(*models->motion, models->patient.motion, models->device, rest, nullptr);
  auto rig = buildRig(*models, std::move(intention), RigOptions{});
  if (!rig) return fail(format(rig.errors()));
  if (auto armed = (*rig)->renderer->arm(); !armed) return fail(format(armed.errors()));

  SessionConfig config_of_session;
  config_of_session.duration_ticks = 300;
  Session session(*(*rig)->renderer, config_of_session);
  auto started = session.start(PeriodicThreadConfig{});
  if (!started) return fail(format(started.errors()));
  session.join();

  TickRecord record;
  std::uint64_t records = 0, last = 0;
  while (session.tryPop(record)) {
    if (any(record.faults & kStoppingFaults))
      return fail("a fault in tick " + std::to_string(record.tick));
    if (record.q_m.size() != 6 || !allFinite(record.sent)) return fail("a record is not sound");
    last = record.tick;
    ++records;
  }
  if (records == 0 || records != session.counters().ticks_run) return fail("records are missing");
  if (last < 299) return fail("ended early");
  for (double effort : record.sent) {
    if (effort != 0.0) return fail("does not end at neutral");
  }
  std::printf("%llu records, the last of tick %llu\n", static_cast<unsigned long long>(records),
              static_cast<unsigned long long>(last));
}
