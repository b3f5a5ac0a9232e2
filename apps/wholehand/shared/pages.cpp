#include "apps/wholehand/shared/pages.hpp"

#include "apps/wholehand/shared/shipped_files.hpp"
#include "station/server/access.hpp"

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>

namespace wholehand {
namespace fs = std::filesystem;

Expected<Done> readTokens(const std::string& file, std::vector<std::string>& tokens) {
  if (!file.empty()) {
    std::error_code error;
    constexpr std::uintmax_t kMost_bytes = 4096;
    const auto refusal = [&file](std::string problem) {
      return keyFault(file, "--token-file", "", std::move(problem),
                      "name a file with a token on each line: therapist=..., player=..., "
                      "watcher=...");
    };
    if (!fs::is_regular_file(file, error)) return refusal("is no regular file");
    if (fs::file_size(file, error) > kMost_bytes || error) return refusal("is no list of tokens");
    std::ifstream in(file);
    if (!in.is_open()) return refusal("cannot be read");
    const std::size_t before = tokens.size();
    for (std::string line; std::getline(in, line);) {
      if (!line.empty() && line.back() == '\r') line.pop_back();
      if (!line.empty()) tokens.push_back(line);
    }
    if (tokens.size() == before) return refusal("holds no token");
    return Done{};
  }
  const char* const given = tokens.empty() ? std::getenv("WHOLEHAND_TOKEN") : nullptr;
  std::istringstream all(given == nullptr ? "" : given);
  for (std::string one; std::getline(all, one, ',');) {
    if (!one.empty()) tokens.push_back(one);
  }
  return Done{};
}

void hideSecrets(int argc, char** argv) {
  bool value = false;
  for (int i = 0; i < argc; ++i) {
    const std::string_view word = argv[i];
    std::size_t keep = value ? 0 : word.size();
    for (const std::string_view option : {"--token=", "--udp-key="}) {
      if (!value && word.starts_with(option)) keep = option.size();
    }
    value = word == "--token" || word == "--udp-key";
    std::memset(argv[i] + keep, '.', word.size() - keep);
  }
}

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
      tokens.faults.push_back(keyFault("", "--token", name + "=...", "names no role",
                                       "write therapist=..., player=... or watcher=..."));
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
