#pragma once

#include "server/roles.hpp"
#include "server/server.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace wholehand {

/// What a request says of itself.
struct Credentials {
  std::string_view host;           ///< header Host
  std::string_view origin;         ///< header Origin; empty: no browser sent it
  std::string_view query;          ///< after the '?'
  std::string_view authorization;  ///< header Authorization
  std::string_view cookie;         ///< header Cookie
};

/// Who may have what. A page of another site that a person of this machine has open must reach
/// nothing: its Origin gives it away, and where it renames itself to our address, its Host does.
class Access {
 public:
  Access(const ServerOptions& options, std::uint16_t port);

  /// Whether a request with this Host may be answered. Listening on this machine alone: only its
  /// names; else any, since the token guards.
  [[nodiscard]] bool hostAllowed(std::string_view host) const;
  /// Ours (the same host and port as asked for, or any name of this machine with our port), one of
  /// the options', or none at all: then it is no browser.
  [[nodiscard]] bool originAllowed(std::string_view origin, std::string_view host) const;
  /// Whether the token was shown, in the query, as a bearer or in the cookie; true without a token.
  [[nodiscard]] bool authorized(const Credentials& c) const;
  /// Compared in a time that says nothing of it; true where none is asked for.
  [[nodiscard]] bool tokenMatches(std::string_view token) const {
    return !guarded() || roleOf(token).has_value();
  }
  /// Role that is granted for what is shown: the query's `role`, and what the token allows. Nothing
  /// where the query names none that there is.
  /// @pre authorized(c)
  [[nodiscard]] std::optional<Role> roleOf(const Credentials& c) const;
  /// Set-Cookie for a request that showed the token in its query; empty for others.
  [[nodiscard]] std::string cookieFor(const Credentials& c) const;

 private:
  struct Key {
    std::string token;
    Role role = Role::kTherapist;
  };
  [[nodiscard]] bool guarded() const { return !keys_.empty(); }
  /// Of a token; nothing where it is none. The same time for every token.
  [[nodiscard]] std::optional<Role> roleOf(std::string_view token) const;
  /// The first token of those shown that is one; empty: none.
  [[nodiscard]] std::string_view shownToken(const Credentials& c) const;

  std::string address_;
  std::vector<Key> keys_;  ///< empty: no token is asked for
  std::vector<std::string> allowed_origins_;
  std::uint16_t port_ = 0;
  bool this_machine_only_ = true;
};

/// Whether an address is of this machine only.
[[nodiscard]] bool isLoopback(std::string_view address);

/// "::1" → "[::1]", others as they are.
[[nodiscard]] std::string bracketed(const std::string& address);

}  // namespace wholehand
