#include "server/access.hpp"

#include "server/http_text.hpp"

#include <algorithm>
#include <array>

namespace wholehand {

namespace {

constexpr std::string_view kCookie = "wholehand_token=";

/// "localhost:8080" → "localhost", "[::1]:8080" → "[::1]".
std::string_view withoutPort(std::string_view authority) {
  const std::size_t colon = authority.rfind(':');
  const std::size_t bracket = authority.rfind(']');
  const bool has_port =
      colon != std::string_view::npos && (bracket == std::string_view::npos || colon > bracket);
  return has_port ? authority.substr(0, colon) : authority;
}

bool namesThisMachine(std::string_view name) {
  constexpr std::array<std::string_view, 3> kNames = {"localhost", "127.0.0.1", "[::1]"};
  return std::find(kNames.begin(), kNames.end(), name) != kNames.end();
}

std::string_view cookieToken(std::string_view cookies) {
  for (std::string_view rest = cookies; !rest.empty();) {
    const std::size_t end = std::min(rest.find(';'), rest.size());
    std::string_view one = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    while (!one.empty() && one.front() == ' ') one.remove_prefix(1);
    if (one.starts_with(kCookie)) return one.substr(kCookie.size());
  }
  return {};
}

}  // namespace

bool isLoopback(std::string_view address) {
  return address.starts_with("127.") || address == "::1";
}

std::string bracketed(const std::string& address) {
  return address.find(':') == std::string::npos ? address : "[" + address + "]";
}

Diagnostics validate(const ServerOptions& o) {
  Diagnostics faults;
  const bool short_token = o.token.size() < kShortestToken;
  if (!isLoopback(o.address) && short_token) {
    faults.push_back(
        {"", 0, "address", o.address, "can be reached by other machines",
         "needs a token of at least " + std::to_string(kShortestToken) + " characters"});
  } else if (!o.token.empty() && short_token) {
    faults.push_back({"", 0, "token", "", "is too short",
                      "must have at least " + std::to_string(kShortestToken) + " characters"});
  }
  const bool plain = std::all_of(o.token.begin(), o.token.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '-' ||
           c == '_' || c == '.' || c == '~';
  });
  if (!plain) {
    faults.push_back({"", 0, "token", "", "cannot stand in an address",
                      "may have letters, digits and - _ . ~ only"});
  }
  if (o.max_clients < 1 || o.max_clients > 1000) {
    faults.push_back({"", 0, "max_clients", std::to_string(o.max_clients), "is out of range",
                      "must be in [1, 1000]"});
  }
  return faults;
}

Access::Access(const ServerOptions& options, std::uint16_t port)
    : address_(bracketed(options.address)),
      token_(options.token),
      allowed_origins_(options.allowed_origins),
      port_(port),
      this_machine_only_(isLoopback(options.address)) {}

bool Access::hostAllowed(std::string_view host) const {
  if (!this_machine_only_) return true;
  const std::string_view name = withoutPort(host);
  return namesThisMachine(name) || name == address_;
}

bool Access::originAllowed(std::string_view origin, std::string_view host) const {
  if (origin.empty()) return true;
  const auto listed = std::find(allowed_origins_.begin(), allowed_origins_.end(), origin);
  if (listed != allowed_origins_.end()) return true;
  const std::size_t scheme_end = origin.find("://");
  if (scheme_end == std::string_view::npos) return false;
  const std::string_view scheme = origin.substr(0, scheme_end);
  if (scheme != "http" && scheme != "https") return false;
  const std::string_view authority = origin.substr(scheme_end + 3);
  if (authority == host && hostAllowed(host)) return true;
  const std::string_view name = withoutPort(authority);
  return (namesThisMachine(name) || name == address_) &&
         authority == std::string(name) + ":" + std::to_string(port_);
}

bool Access::tokenMatches(std::string_view token) const {
  if (token_.empty()) return true;
  // Every character is looked at, whether an earlier one differs or not.
  unsigned differences = token.size() == token_.size() ? 0U : 1U;
  for (std::size_t i = 0; i < token_.size(); ++i) {
    const char theirs = token.empty() ? '\0' : token[i % token.size()];
    differences |= static_cast<unsigned char>(theirs) ^ static_cast<unsigned char>(token_[i]);
  }
  return differences == 0U;
}

bool Access::authorized(const Credentials& c) const {
  if (token_.empty()) return true;
  constexpr std::string_view kBearer = "Bearer ";
  if (tokenMatches(queryValue(c.query, "token"))) return true;
  if (c.authorization.starts_with(kBearer) && tokenMatches(c.authorization.substr(kBearer.size())))
    return true;
  return tokenMatches(cookieToken(c.cookie));
}

std::string Access::cookieFor(const Credentials& c) const {
  if (token_.empty() || !tokenMatches(queryValue(c.query, "token"))) return {};
  return std::string(kCookie) + token_ + "; HttpOnly; SameSite=Strict; Path=/";
}

}  // namespace wholehand
