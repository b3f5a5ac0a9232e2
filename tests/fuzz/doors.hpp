#pragma once

#include "telemetry/recording.hpp"

#include <functional>
#include <random>
#include <string>
#include <vector>

/// The doors at which bytes of strangers come in: what the test `fuzz` sends damaged inputs
/// through, and libFuzzer inputs of its own making (`./check --fuzz`).
namespace wholehand::test {

struct Door {
  std::string name;
  std::vector<std::string> good;  ///< inputs that are taken
  /// Gives it these bytes. Empty: they were taken, or refused in words; otherwise what was wrong.
  std::function<std::string(const std::string& bytes)> enter;
  int full = 10'000;  ///< inputs under WHOLEHAND_FULL=1
  int sampled = 60;   ///< inputs otherwise
};

[[nodiscard]] std::vector<Door> fileDoors();       ///< TOML of every kind, CSV, URDF
[[nodiscard]] std::vector<Door> messageDoors();    ///< WebSocket, UDP, HTTP, the reader of meshes
[[nodiscard]] std::vector<Door> recordingDoors();  ///< black box, recordings

/// What HDF5 has read of a recording; one of recordingDoors().
[[nodiscard]] Door recordedTablesDoor();
/// Reads every tick: empty when what can be read is within the shapes of a record.
[[nodiscard]] std::string readTicks(RecordingReader& recording);

/// So many inputs of random bytes.
[[nodiscard]] inline std::vector<std::string> randomTexts(std::size_t count, std::size_t bytes) {
  std::mt19937_64 random(3);
  std::vector<std::string> texts(count, std::string(bytes, '\0'));
  for (std::string& text : texts) {
    for (char& byte : text) byte = static_cast<char>(random());
  }
  return texts;
}

[[nodiscard]] inline std::vector<Door> allDoors() {
  std::vector<Door> all = fileDoors();
  for (const auto& more : {messageDoors(), recordingDoors()}) {
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

}  // namespace wholehand::test
