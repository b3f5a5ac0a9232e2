#pragma once

#include "loop/patient/motion.hpp"
#include "station/station.hpp"

#include <memory>
#include <string>

namespace wholehand::test {

/// The shipped bar with the hand at rest.
inline StationConfig barStation() {
  const std::string config = std::string(WHOLEHAND_SOURCE_DIR) + "/config";
  StationConfig c;
  c.files = {"",
             config + "/hands/adult-median-right.toml",
             config + "/devices/lambda-pride.toml",
             config + "/rendering/lambda-pride.toml",
             config + "/patients/relaxed-adult.toml",
             "",
             config + "/exercises/cocktail-bar.toml",
             1};
  c.config_folder = config;
  c.make_player = [](const Models& models) {
    return std::make_unique<ScriptedPlayer>(
        Intention::throughWaypoints({{0.0, AxisPosition(models.device.axisCount())}}));
  };
  return c;
}

}  // namespace wholehand::test
