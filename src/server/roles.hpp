#pragma once

#include "server/backend.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace wholehand {

/// Role of a client (protocol Role, in its order; docs/adr/0028-roles.md).
enum class Role : std::uint8_t {
  kUnsaid,    ///< none stated (clients older than roles): all rights, while it holds the controls;
              ///< may stop
  kWatcher,   ///< sees everything; may stop
  kPlayer,    ///< the patient: steers, rests and stops
  kTherapist  ///< leads: may command whichever client holds the controls, and may take them
};

/// Reads "therapist", "player" or "watcher".
[[nodiscard]] std::optional<Role> roleNamed(std::string_view name);
[[nodiscard]] const char* nameOf(Role role) noexcept;

/// Role granted to a client that claims one role and shows a token of another. A smaller role is
/// granted; a claim beyond the token's role makes a watcher. `claimed` kUnsaid: the token's role.
[[nodiscard]] Role grantedRole(Role claimed, Role by_token) noexcept;

/// What an order is judged by, beside the role of its sender.
struct Standing {
  bool holds = false;              ///< the client has the controls
  bool led = false;                ///< a therapist is connected
  bool moves_person = false;       ///< the device is a real one
  bool own_rest = false;           ///< what ended last, or began last, this client ended by a rest
  bool therapist_paused = false;   ///< a therapist paused the exercise and has not resumed it
  bool rest_before_start = false;  ///< what ended last is a rest before the first start
  RunState run_state = RunState::kDisarmed;
};

/// Accepts an order, or returns why a client of that role may not give it now. Everyone may order
/// an emergency stop, everyone but a watcher a stop.
[[nodiscard]] OrderReply mayOrder(Role role, const Order& order, const Standing& now);

}  // namespace wholehand
