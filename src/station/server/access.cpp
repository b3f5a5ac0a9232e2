#include "station/server/access.hpp"

#include "station/server/http_line.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace wholehand {

namespace {

using orders::Permission;

OrderReply needsControls(const Standing& now) {
  if (now.holds) return {true, ""};
  return refused(Refusal::kNotHolder, "this client does not hold the controls");
}

OrderReply therapistOnly(const std::string& what) {
  return refused(Refusal::kTherapistOnly, what + " is for the therapist only");
}

// Decides about orders that begin something. A player who is alone with a simulated device may
// begin: for the demo, and for practice at home.
OrderReply playerMayBegin(const Order& order, const Standing& now) {
  const bool arms = order.is<orders::Arm>();
  if (arms && now.own_rest) return needsControls(now);
  if (now.led || now.moves_person) return therapistOnly(order.row().doing);
  if (arms && now.run_state != RunState::kDisarmed && !now.rest_before_start) {
    return therapistOnly("starting again after a stop");
  }
  return needsControls(now);
}

OrderReply playerMay(const Order& order, const Standing& now) {
  switch (order.row().permission) {
    case Permission::kHolder:
      return needsControls(now);
    case Permission::kBeginner:
      return playerMayBegin(order, now);
    case Permission::kHolderOrLeader: {
      const auto* action = order.as<orders::Action>();
      const bool pauses = action != nullptr && action->act == Act::kPause;
      if (!now.therapist_paused || !now.led || pauses) return needsControls(now);
      return refused(Refusal::kTherapistPaused, "the therapist has paused the exercise");
    }
    default:
      return therapistOnly(order.row().doing);
  }
}

}  // namespace

std::optional<Role> roleNamed(std::string_view name) {
  for (const Role role : {Role::kWatcher, Role::kPlayer, Role::kTherapist}) {
    if (name == nameOf(role)) return role;
  }
  return std::nullopt;
}

Role grantedRole(Role claimed, Role by_token) noexcept {
  if (claimed == Role::kUnspecified) return by_token;
  return claimed <= by_token ? claimed : Role::kWatcher;
}

OrderReply mayOrder(Role role, const Order& order, const Standing& now) {
  const orders::Row& row = order.row();
  const Permission permission = row.permission;
  if (permission == Permission::kProgram) {
    return refused(Refusal::kUnreadable, std::string(row.name) + " is not a client's order");
  }
  if (permission == Permission::kAnyone) return {true, ""};
  if (role == Role::kWatcher) return refused(Refusal::kOnlyWatches, "this client only watches");
  if (permission == Permission::kNotWatchers) return {true, ""};
  if (role == Role::kPlayer) return playerMay(order, now);
  const bool therapist = role == Role::kTherapist;
  if (permission == Permission::kHoldingTherapist && !therapist) return therapistOnly(row.doing);
  const bool holds =
      permission == Permission::kHolder || permission == Permission::kHoldingTherapist;
  return therapist && !holds ? OrderReply{true, ""} : needsControls(now);
}

namespace {

constexpr std::string_view kCookie = "wholehand_token";

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

/// Tokens in all cookies whose name begins with this server's prefix, of any port and age.
std::vector<std::string_view> cookieTokens(std::string_view cookies) {
  std::vector<std::string_view> tokens;
  for (std::string_view rest = cookies; !rest.empty();) {
    const std::size_t end = std::min(rest.find(';'), rest.size());
    std::string_view one = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    while (!one.empty() && one.front() == ' ') one.remove_prefix(1);
    const std::size_t equals = one.find('=');
    if (one.starts_with(kCookie) && equals != std::string_view::npos) {
      tokens.push_back(one.substr(equals + 1));
    }
  }
  return tokens;
}

Diagnostics faultsOfToken(const char* key, const std::string& token) {
  Diagnostics faults;
  if (!token.empty() && token.size() < kShortestToken) {
    faults.push_back({"", 0, key, "", "is too short",
                      "must have at least " + std::to_string(kShortestToken) + " characters"});
  }
  const bool plain = std::all_of(token.begin(), token.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '-' ||
           c == '_' || c == '.' || c == '~';
  });
  if (!plain) {
    faults.push_back(keyFault("", key, "", "cannot stand in an address",
                              "may have letters, digits and - _ . ~ only"));
  }
  return faults;
}

// Two roles must not share a token.
Diagnostics faultsOfTokens(const ServerOptions& o) {
  Diagnostics faults = faultsOfToken("token", o.token);
  const std::array<std::pair<const char*, const std::string*>, 2> more = {
      {{"player token", &o.player_token}, {"watcher token", &o.watcher_token}}};
  for (const auto& [key, token] : more) {
    for (Diagnostic& fault : faultsOfToken(key, *token)) faults.push_back(std::move(fault));
    if (token->empty()) continue;
    if (o.token.empty()) {
      faults.push_back(keyFault("", key, "", "leaves nobody who may lead",
                                "give the therapist a token, too: therapist=..."));
    }
    if (*token == o.token) {
      faults.push_back({"", 0, key, "", "is the therapist's, too", "give each role its own"});
    }
  }
  if (!o.player_token.empty() && o.player_token == o.watcher_token) {
    faults.push_back(
        {"", 0, "watcher token", "", "is the player's, too", "give each role its own"});
  }
  return faults;
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
  if (!isLoopback(o.address) && o.token.size() < kShortestToken) {
    faults.push_back(
        keyFault("", "address", o.address, "can be reached by other machines",
                 "needs a token of at least " + std::to_string(kShortestToken) + " characters"));
  }
  // Reports a token that is too short only once.
  const bool said = !faults.empty();
  for (Diagnostic& fault : faultsOfTokens(o)) {
    const bool again = said && fault.key == "token" && fault.problem == "is too short";
    if (!again) faults.push_back(std::move(fault));
  }
  if (o.max_clients < 1 || o.max_clients > 1000) {
    faults.push_back(keyFault("", "max_clients", std::to_string(o.max_clients), "is out of range",
                              "must be in [1, 1000]"));
  }
  return faults;
}

Access::Access(const ServerOptions& options, std::uint16_t port)
    : address_(bracketed(options.address)),
      allowed_origins_(options.allowed_origins),
      port_(port),
      this_machine_only_(isLoopback(options.address)) {
  const std::array<Key, 3> keys = {{{options.token, Role::kTherapist},
                                    {options.player_token, Role::kPlayer},
                                    {options.watcher_token, Role::kWatcher}}};
  for (const Key& key : keys) {
    if (!key.token.empty()) keys_.push_back(key);
  }
}

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

std::optional<Role> Access::roleOf(std::string_view token) const {
  std::optional<Role> role;
  for (const Key& key : keys_) {
    // Compares every character even after a difference, so that the time reveals nothing.
    unsigned differences = token.size() == key.token.size() ? 0U : 1U;
    for (std::size_t i = 0; i < key.token.size(); ++i) {
      const char theirs = token.empty() ? '\0' : token[i % token.size()];
      differences |= static_cast<unsigned char>(theirs) ^ static_cast<unsigned char>(key.token[i]);
    }
    if (differences == 0U) role = key.role;
  }
  return role;
}

std::string_view Access::shownToken(const Credentials& c) const {
  constexpr std::string_view kBearer = "Bearer ";
  const std::string_view bearer = c.authorization.starts_with(kBearer)
                                      ? c.authorization.substr(kBearer.size())
                                      : std::string_view();
  std::vector<std::string_view> shown = cookieTokens(c.cookie);
  shown.insert(shown.begin(), {queryValue(c.query, "token"), bearer});
  for (const std::string_view token : shown) {
    if (roleOf(token)) return token;
  }
  return {};
}

bool Access::authorized(const Credentials& c) const {
  return !guarded() || !shownToken(c).empty();
}

std::optional<Role> Access::roleOf(const Credentials& c) const {
  const std::string_view name = queryValue(c.query, "role");
  const std::optional<Role> claimed =
      name.empty() ? std::optional(Role::kUnspecified) : roleNamed(name);
  if (!claimed) return std::nullopt;
  if (!guarded()) return *claimed;
  const Role by_token = roleOf(shownToken(c)).value_or(Role::kWatcher);
  // Without roles, the single token grants everything, as before roles were introduced.
  if (*claimed == Role::kUnspecified && by_token == Role::kTherapist) return Role::kUnspecified;
  return grantedRole(*claimed, by_token);
}

std::string Access::cookieFor(const Credentials& c) const {
  const std::string_view token = queryValue(c.query, "token");
  if (!guarded() || !roleOf(token)) return {};
  return std::string(kCookie) + "_" + std::to_string(port_) + "=" + std::string(token) +
         "; HttpOnly; SameSite=Strict; Path=/";
}

}  // namespace wholehand
