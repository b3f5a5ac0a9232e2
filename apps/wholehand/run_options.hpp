#pragma once

#include "assembly/models.hpp"
#include "assembly/rig.hpp"
#include "device/plugin/plugin_driver.hpp"

#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// What `wholehand run` was asked for.
struct RunOptions {
  ModelFiles files;
  std::string engine = defaultEngine();
  double rate_hz = 1000.0;
  double duration_s = 0.0;        ///< 0: until the motion has been played
  std::string record;             ///< HDF5 file; empty: none
  std::string report;             ///< folder; empty: none
  std::string json;               ///< file; empty: none
  DriverLocation driver;          ///< of a real device; no path: a simulated one, or a host's
  std::string host;               ///< name of the host that holds a real device; empty: none
  bool without_passport = false;  ///< of a real device: nobody may be attached
  bool simulated_clock = false;
  bool uncertified = false;
  bool no_rehearsal = false;
  std::string certificate;  ///< file that the run is to fit; empty: it certifies itself
  std::uint64_t seed = 1;   ///< of the virtual patient who plays an exercise

  bool no_web = false;                ///< open no port
  std::string address = "127.0.0.1";  ///< of the server
  int port = 8080;                    ///< 0: any that is free
  /// What clients on other machines must show: the therapist's, or "player=..." and the like.
  std::vector<std::string> tokens;
  std::vector<std::string> origins;  ///< allowed besides our own pages
  std::string udp;                   ///< "port" or "address:port" for game engines; empty: closed
  std::string udp_key;               ///< of a game without a WebSocket; empty: there is none
  bool wait = false;                 ///< arm only when a client asks for it
};

/// A person holds the device.
[[nodiscard]] inline bool isRealDevice(const RunOptions& options) {
  return !options.driver.path.empty() || !options.host.empty();
}

/// Every file that such a run reads; empty where it names none.
[[nodiscard]] std::vector<std::string> inputsOf(const RunOptions& options);

/// The certificate that the options name, read; none where they name none.
[[nodiscard]] Expected<std::optional<RigOptions::NamedCertificate>> certificateOf(
    const RunOptions& options);

/// Plays a motion or an exercise without pages. Returns the program's exit code.
int runCommand(RunOptions options);

}  // namespace wholehand
