#pragma once

#include "devices/plugin/plugin_driver.hpp"
#include "rig/models.hpp"
#include "rig/rig.hpp"

#include <optional>
#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): of CLI11
class App;
}

namespace wholehand {

/// Options of `wholehand run`.
struct RunOptions {
  ModelFiles files;
  std::string engine = defaultEngine();
  double rate_hz = 1000.0;
  double duration_s = 0.0;        ///< 0: until the end of the motion
  std::string record;             ///< HDF5 file; empty: none
  std::string report;             ///< folder; empty: none
  std::string json;               ///< file; empty: none
  DriverLocation driver;          ///< driver of a real device; empty path: a simulated device, or a
                                  ///< host's
  std::string host;               ///< name of the host of a real device; empty: none
  bool without_passport = false;  ///< use a real device without a passport: nobody may be attached
  bool simulated_clock = false;
  bool uncertified = false;
  bool no_rehearsal = false;
  std::string certificate;  ///< certificate file to use; empty: the program certifies the rig
                            ///< itself
  std::uint64_t seed = 1;   ///< seed of the virtual patient who plays an exercise

  bool no_web = false;                ///< open no port
  std::string address = "127.0.0.1";  ///< address of the server
  int port = 8080;                    ///< 0: any free port
  /// Tokens for clients on other machines: "..." for the therapist, or "player=..." and
  /// "watcher=...".
  std::vector<std::string> tokens;
  std::string token_file;            ///< file of further tokens; empty: none
  std::vector<std::string> origins;  ///< allowed in addition to this program's pages
  std::string udp;                   ///< "port" or "address:port" for game engines; empty: closed
  std::string udp_key;               ///< key of a game without a WebSocket; empty: none
  bool wait = false;                 ///< arm only on a client's order
  std::string clinic;                ///< folder of the clinic's records; empty: none
};

/// True when a person holds the device.
[[nodiscard]] inline bool isRealDevice(const RunOptions& options) {
  return !options.driver.path.empty() || !options.host.empty();
}

/// Paths of every file that the run reads, without empty ones.
[[nodiscard]] std::vector<std::string> inputsOf(const RunOptions& options);

/// Reads the certificate that the options name, if any.
[[nodiscard]] Expected<std::optional<RigOptions::NamedCertificate>> certificateOf(
    const RunOptions& options);

/// Plays a motion or an exercise without pages. Returns the exit code.
int runCommand(RunOptions options);

/// Default options of `wholehand run`: the shipped files.
[[nodiscard]] RunOptions shippedRun();

/// Adds `wholehand run` with all its options.
/// @param options initialised by shippedRun(); outlives the parsing, as does `code`
/// @param code exit code of the run
void addRun(CLI::App& app, RunOptions& options, int& code);

/// `wholehand run` with pages: serves the game and the console, and lets a virtual patient play
/// until somebody takes over. Returns the exit code.
int playCommand(RunOptions options);

}  // namespace wholehand
