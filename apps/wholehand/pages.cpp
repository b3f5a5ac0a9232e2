#include "pages.hpp"

#include "server/roles.hpp"
#include "shipped_files.hpp"

#include <cstdint>
#include <utility>

namespace wholehand {

RoleTokens roleTokens(const std::vector<std::string>& given) {
  RoleTokens tokens;
  for (const std::string& one : given) {
    const std::size_t equals = one.find('=');
    const std::string name = equals == std::string::npos ? "therapist" : one.substr(0, equals);
    const std::string token = equals == std::string::npos ? one : one.substr(equals + 1);
    const auto role = roleNamed(name);
    std::string& of = role == Role::kPlayer    ? tokens.player
                      : role == Role::kWatcher ? tokens.watcher
                                               : tokens.therapist;
    if (!role) {
      tokens.faults.push_back({"", 0, "--token", name + "=...", "names no role",
                               "write therapist=..., player=... or watcher=..."});
    } else if (equals != std::string::npos && token.empty()) {
      tokens.faults.push_back(
          {"", 0, "--token", name + "=", "has no token", "write at least 16 characters after it"});
    } else if (!of.empty()) {
      tokens.faults.push_back(
          {"", 0, "--token", name + "=...", "is given twice", "give each role one token"});
    } else {
      of = token;
    }
  }
  return tokens;
}

ServerOptions serverOptions(const PageOptions& options,
                            std::function<void(const std::string&)> log) {
  ServerOptions server;
  server.address = options.address;
  server.port = static_cast<std::uint16_t>(options.port);
  server.web_folder = shippedFile("web/dist");
  const RoleTokens tokens = roleTokens(options.tokens);
  server.token = tokens.therapist;
  server.player_token = tokens.player;
  server.watcher_token = tokens.watcher;
  server.log = std::move(log);
  return server;
}

}  // namespace wholehand
