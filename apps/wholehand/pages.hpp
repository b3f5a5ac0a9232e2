#pragma once

#include "core/expected.hpp"
#include "server/server.hpp"

#include <functional>
#include <string>
#include <vector>

namespace wholehand {

/// Where a command shows its pages, and to whom.
struct PageOptions {
  std::string address = "127.0.0.1";
  int port = 8080;  ///< 0: any that is free
  /// What clients on other machines must show: the therapist's, or "player=..." and the like.
  std::vector<std::string> tokens;
};

/// The tokens of --token by role.
struct RoleTokens {
  std::string therapist, player, watcher;
  Diagnostics faults;
};

/// "player=..." is the player's, one without a name the therapist's.
[[nodiscard]] RoleTokens roleTokens(const std::vector<std::string>& given);

/// What the server needs for the shipped pages; faults of the tokens are roleTokens()' to tell.
[[nodiscard]] ServerOptions serverOptions(const PageOptions& options,
                                          std::function<void(const std::string&)> log);

}  // namespace wholehand
