#pragma once

#include "loop/core/expected.hpp"
#include "station/server/server.hpp"

#include <functional>
#include <string>
#include <vector>

namespace wholehand {

/// Address, port and tokens of a command's pages.
struct PageOptions {
  std::string address = "127.0.0.1";
  int port = 8080;  ///< 0: any free port
  /// Tokens for clients on other machines: the therapist's, or "player=..." and the like.
  std::vector<std::string> tokens;
};

/// Tokens by role.
struct RoleTokens {
  std::string therapist, player, watcher;
  Diagnostics faults;
};

/// Adds the tokens that are in no process list: those of a file, one a line, or, if neither an
/// option nor a file gives one, of the environment variable WHOLEHAND_TOKEN, separated by commas.
/// @param file of --token-file; empty: none
[[nodiscard]] Expected<Done> readTokens(const std::string& file, std::vector<std::string>& tokens);

/// Overwrites the values of --token and --udp-key, which every user of the machine can read in the
/// list of processes.
void hideSecrets(int argc, char** argv);

/// Parses --token: "player=..." is the player's, one without a name is the therapist's.
[[nodiscard]] RoleTokens roleTokens(const std::vector<std::string>& given);

/// Server options for the shipped pages; roleTokens() reports faults of the tokens.
[[nodiscard]] ServerOptions serverOptions(const PageOptions& options,
                                          std::function<void(const std::string&)> log);

}  // namespace wholehand
