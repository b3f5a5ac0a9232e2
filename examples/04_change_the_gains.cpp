// Finds how stiff the coupling may be: tries stiffnesses on the axis x and asks checkGains() which
// of them are certified, that is, stable with any passive person and object, at every adaptive
// damping (docs/certificate.md).
//
// A shorter period allows more stiffness: the same device can be stiffer at 2 kHz than at 1 kHz.
//
//   04_change_the_gains [folder that holds config/]
#include "wholehand/wholehand.hpp"

#include <cstdio>
#include <string>

using namespace wholehand;

int main(int argc, char** argv) {
  const std::string config = (argc > 1 ? argv[1] : std::string(WHOLEHAND_SOURCE_DIR)) + "/config/";
  auto models = loadModels({.scene = config + "scenes/empty.toml",
                            .hand = config + "hands/adult-median-right.toml",
                            .device = config + "devices/lambda-pride.toml",
                            .rendering = config + "rendering/lambda-pride.toml",
                            .patient = config + "patients/relaxed-adult.toml"});
  if (!models) return std::fprintf(stderr, "%s\n", format(models.errors()).c_str()), 2;
  const int x = models->device.axisIndex("x");
  // Simulates a device that may change its effort faster, because the slew limit also bounds the
  // stiffness.
  models->device.axes[x].effort_slew_limit = 20000.0;

  for (const double rate_hz : {1000.0, 2000.0}) {
    std::printf("\n%.0f Hz\n%12s %8s %8s   %s\n", rate_hz, "K_pm N/m", "felt kg", "armature",
                "verdict");
    for (const double k_pm : {1000.0, 1500.0, 2000.0, 4000.0, 16000.0}) {
      models->rendering.axes[x].k_pm = k_pm;
      const Expected<CheckedGains> checked = checkGains(*models, 1.0 / rate_hz);
      if (!checked) {
        std::printf("%12.0f %8s %8s   %s\n", k_pm, "-", "-", format(checked.errors()).c_str());
        continue;
      }
      const CouplingGains& gains = checked->gains;
      std::printf("%12.0f %8.3f %8.3f   ", k_pm, feltInertia(gains, x, 1.0 / rate_hz),
                  gains.armature[x]);
      if (checked->refused.empty()) {
        std::printf("certified\n");
      } else {
        const Diagnostic& why = checked->refused.front();
        std::printf("refused: %s; %s\n", why.problem.c_str(), why.remedy.c_str());
      }
    }
  }
}
