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
  /// Tokens for clients on other machines: "..." for the therapist, or "player=..." and
  /// "watcher=...".
  std::vector<std::string> tokens;
};

/// Tokens by role.
struct RoleTokens {
  std::string therapist, player, watcher;
  Diagnostics faults;
};

/// Adds tokens that the list of processes does not show: those in a file, one per line, or, if
/// neither an option nor a file gives one, those in the environment variable WHOLEHAND_TOKEN,
/// separated by commas.
/// @param file file of --token-file; empty: none
[[nodiscard]] Expected<Done> readTokens(const std::string& file, std::vector<std::string>& tokens);

/// Overwrites the values of --token and --udp-key, which every user of the machine could read in
/// the list of processes.
void hideSecrets(int argc, char** argv);

/// Parses --token: "player=..." and "watcher=..." name the role; a value without a role is the
/// therapist's.
[[nodiscard]] RoleTokens roleTokens(const std::vector<std::string>& given);

/// Server options for the shipped pages; roleTokens() reports faults of the tokens.
[[nodiscard]] ServerOptions serverOptions(const PageOptions& options,
                                          std::function<void(const std::string&)> log);

}  // namespace wholehand
