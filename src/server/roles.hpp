#pragma once

#include "server/backend.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace wholehand {

/// What a client is there for (protocol Role, in its order; docs/adr/0028-roles.md).
enum class Role : std::uint8_t {
  kUnsaid,    ///< says none, as clients from before roles: all of it, with the controls only
  kWatcher,   ///< sees everything, may stop
  kPlayer,    ///< the patient's: steers, rests and stops
  kTherapist  ///< leads: orders whoever has the controls, and takes them from everybody
};

/// "therapist", "player", "watcher".
[[nodiscard]] std::optional<Role> roleNamed(std::string_view name);
[[nodiscard]] const char* nameOf(Role role) noexcept;

/// What a client gets that claims a role and shows a token of another: a smaller one is granted,
/// whoever claims more than the token gives watches. `claimed` kUnsaid: that of the token.
[[nodiscard]] Role grantedRole(Role claimed, Role by_token) noexcept;

/// What an order is judged by, beside the role of who gives it.
struct Standing {
  bool holds = false;             ///< the client has the controls
  bool led = false;               ///< a therapist is connected
  bool moves_person = false;      ///< the device is a real one
  bool own_rest = false;          ///< what ended last is a rest that this client asked for
  bool therapist_paused = false;  ///< the exercise, and has not let it go on
  RunState run_state = RunState::kDisarmed;
};

/// Accepted, or why a client of that role may not order it now. An emergency stop is everybody's.
[[nodiscard]] OrderReply mayOrder(Role role, const Order& order, const Standing& now);

}  // namespace wholehand
