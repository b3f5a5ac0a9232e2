#pragma once

#include "rig/models.hpp"

#include <stdexcept>
#include <string>
#include <utility>

namespace wholehand {

template <class T>
T orThrow(Expected<T> expected) {
  if (!expected) throw std::runtime_error(format(expected.errors()));
  return std::move(expected).value();
}

/// Model files with the paper's device and an adult's hand in a shipped scene.
inline ModelFiles filesOf(const std::string& scene) {
  const std::string config = WHOLEHAND_SOURCE_DIR "/config/";
  return {config + "scenes/" + scene,
          config + "hands/adult-median-right.toml",
          config + "devices/lambda-pride.toml",
          config + "rendering/lambda-pride.toml",
          config + "patients/relaxed-adult.toml",
          "",
          ""};
}

}  // namespace wholehand
