#pragma once

#include "station/server/server.hpp"
#include "vocabulary/backend.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace wholehand {

/// Reads "therapist", "player" or "watcher".
[[nodiscard]] std::optional<Role> roleNamed(std::string_view name);

/// Role granted to a client that claims one role and shows the token of another. A claim of a
/// smaller role is granted; a claim beyond the token's role makes the client a watcher. `claimed`
/// kUnspecified: the token's role.
[[nodiscard]] Role grantedRole(Role claimed, Role by_token) noexcept;

/// Facts that decide about an order, in addition to the role of its sender.
struct Standing {
  bool holds = false;              ///< the client has the controls
  bool led = false;                ///< a therapist is connected
  bool moves_person = false;       ///< the device is a real one
  bool own_rest = false;           ///< this client's rest is the last ending, and the client knows
                                   ///< it
  bool therapist_paused = false;   ///< a therapist paused the exercise and has not resumed it
  bool rest_before_start = false;  ///< the last ending is a rest before the first start
  RunState run_state = RunState::kDisarmed;
};

/// Accepts an order, or returns why a client of that role may not give it now. Everyone may order
/// an emergency stop; everyone but a watcher may order a stop.
[[nodiscard]] OrderReply mayOrder(Role role, const Order& order, const Standing& now);

/// The parts of a request that decide on access.
struct Credentials {
  std::string_view host;           ///< header Host
  std::string_view origin;         ///< header Origin; empty: not sent by a browser
  std::string_view query;          ///< URL part after '?'
  std::string_view authorization;  ///< header Authorization
  std::string_view cookie;         ///< header Cookie
};

/// Decides which requests are answered. A page of another site that is open in a browser on this
/// machine must reach nothing: its Origin differs, and under DNS rebinding its Host differs.
class Access {
 public:
  Access(const ServerOptions& options, std::uint16_t port);

  /// True when a request with this Host may be answered. A server that listens on this machine
  /// alone accepts only the machine's own names. Any other server accepts every Host, since the
  /// token guards it.
  [[nodiscard]] bool hostAllowed(std::string_view host) const;
  /// True when Origin is the requested host and port, a name of this machine with this server's
  /// port, or one of the options' allowed origins; or when it is absent, so that no browser sent
  /// the request.
  [[nodiscard]] bool originAllowed(std::string_view origin, std::string_view host) const;
  /// True when the query, the bearer header or the cookie carries a token, or when no token is
  /// required.
  [[nodiscard]] bool authorized(const Credentials& c) const;
  /// Compares in constant time. True when no token is required.
  [[nodiscard]] bool tokenMatches(std::string_view token) const {
    return !guarded() || roleOf(token).has_value();
  }
  /// Role granted to a request, from the query's `role` and from the token. Empty when the query
  /// names an unknown role.
  /// @pre authorized(c)
  [[nodiscard]] std::optional<Role> roleOf(const Credentials& c) const;
  /// Set-Cookie header for a request that carries the token in its query; empty for others.
  /// Browsers send a cookie to every port of a machine, so its name contains this server's port.
  [[nodiscard]] std::string cookieFor(const Credentials& c) const;

 private:
  struct Key {
    std::string token;
    Role role = Role::kTherapist;
  };
  [[nodiscard]] bool guarded() const { return !keys_.empty(); }
  /// Role that a token opens; empty for an unknown token. Takes the same time for every token.
  [[nodiscard]] std::optional<Role> roleOf(std::string_view token) const;
  /// First valid token of the request; empty: none. An additional wrong token, for example in
  /// another program's cookie, changes nothing.
  [[nodiscard]] std::string_view shownToken(const Credentials& c) const;

  std::string address_;
  std::vector<Key> keys_;  ///< empty: no token is required
  std::vector<std::string> allowed_origins_;
  std::uint16_t port_ = 0;
  bool this_machine_only_ = true;
};

/// True for an address that only this machine can reach.
[[nodiscard]] bool isLoopback(std::string_view address);

/// Puts an IPv6 address in brackets ("::1" → "[::1]"); other addresses stay as they are.
[[nodiscard]] std::string bracketed(const std::string& address);

}  // namespace wholehand
