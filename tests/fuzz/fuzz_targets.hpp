#pragma once

#include "record/recording.hpp"

#include <functional>
#include <random>
#include <string>
#include <vector>

/// Readers of untrusted bytes. The test `fuzz` gives them damaged inputs; libFuzzer gives them
/// generated ones (`./check --fuzz`).
namespace wholehand::test {

struct FuzzTarget {
  std::string name;
  std::vector<std::string> good;  ///< inputs that must be accepted
  /// Passes these bytes to the reader. @return empty if they were accepted or properly refused;
  /// otherwise the failure
  std::function<std::string(const std::string& bytes)> enter;
  int full = 10'000;  ///< inputs under WHOLEHAND_FULL=1
  int sampled = 60;   ///< inputs otherwise
};

[[nodiscard]] std::vector<FuzzTarget> fileTargets();     ///< TOML of every kind, CSV, URDF, meshes
[[nodiscard]] std::vector<FuzzTarget> messageTargets();  ///< WebSocket, UDP, HTTP, meshes
[[nodiscard]] std::vector<FuzzTarget> recordingTargets();  ///< black box, recordings

/// The data that HDF5 has read of a recording; one of recordingTargets().
[[nodiscard]] FuzzTarget recordedTablesTarget();
/// Reads every tick. @return empty if everything readable is within the shapes of a record
[[nodiscard]] std::string readTicks(RecordingReader& recording);

/// `count` inputs of random bytes.
[[nodiscard]] inline std::vector<std::string> randomTexts(std::size_t count, std::size_t bytes) {
  std::mt19937_64 random(3);
  std::vector<std::string> texts(count, std::string(bytes, '\0'));
  for (std::string& text : texts) {
    for (char& byte : text) byte = static_cast<char>(random());
  }
  return texts;
}

[[nodiscard]] inline std::vector<FuzzTarget> allTargets() {
  std::vector<FuzzTarget> all = fileTargets();
  for (const auto& more : {messageTargets(), recordingTargets()}) {
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

}  // namespace wholehand::test
