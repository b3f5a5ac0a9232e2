// Runs your own device (rails.hpp) as the program does: the loop on a real-time thread, a gentle
// stop by Ctrl-C, a recording, a black box file when a fault occurs, and an orderly end (neutral
// effort, device, black box file, recording).
//
//   05_run_and_record recording.h5 [seconds [folder that holds config/]]
#include "rails.hpp"
#include "wholehand/recording.hpp"

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

using namespace wholehand;

int fail(const Diagnostics& why) {
  return std::fprintf(stderr, "%s\n", format(why).c_str()), 2;
}

int main(int argc, char** argv) {
  if (argc < 2) return std::fprintf(stderr, "which file is to be recorded?\n"), 2;
  const std::string config = (argc > 3 ? argv[3] : std::string(WHOLEHAND_SOURCE_DIR)) + "/config/";
  auto models = loadModels({.scene = config + "scenes/four-shapes.toml",
                            .hand = config + "hands/adult-median-right.toml",
                            .device = config + "devices/desktop-3axis.toml",
                            .rendering = config + "rendering/desktop-3axis.toml",
                            .patient = config + "patients/no-arm.toml"});
  if (!models) return fail(models.errors());
  const InterruptScope signals;  // from here on Ctrl-C is remembered
  auto rig = buildRig(*models, std::make_unique<Rails>(1, 1.0), RigOptions{});
  if (!rig) return fail(rig.errors());
  auto rehearsal = rehearse(*models, AxisPosition(3), RigOptions{});
  if (!rehearsal) return fail(rehearsal.errors());

  RunPlan plan;
  plan.rehearsed = rehearsal->passed;
  plan.title = "Rails";
  plan.record = argv[1];
  plan.black_box = plan.record + ".black-box";
  plan.duration_ticks = 1000 * static_cast<std::uint64_t>(argc > 2 ? std::atoi(argv[2]) : 5);
  plan.interrupts = &InterruptScope::shared();
  auto outcome = runAndRecord(**rig, plan);
  if (!outcome) return fail(outcome.errors());
  std::printf("%llu ticks, %llu recorded%s\n",
              static_cast<unsigned long long>(outcome->counters.ticks_run),
              static_cast<unsigned long long>(outcome->written),
              outcome->faulted ? ", ended by a fault" : "");
  return outcome->faulted ? 1 : 0;
}
