#pragma once

#include <atomic>
#include <cstdint>

namespace wholehand {

/// Who may command: one client at a time, whether it speaks WebSocket or UDP. Shared by all
/// servers of the program. Thread-safe, never waits.
class ControlsArbiter {
 public:
  /// Number of a client; 0 is nobody.
  using Client = std::uint32_t;

  /// A number that no client had before.
  [[nodiscard]] Client newClient() noexcept { return ++clients_; }

  /// True when the client holds the controls now; refused while another one does.
  [[nodiscard]] bool take(Client client) noexcept;
  /// True when the client held them; nobody does now.
  /// @param handed_back it gave them back, or lost them long ago: nothing of it is to go on
  bool release(Client client, bool handed_back = false) noexcept;
  /// 0: nobody.
  [[nodiscard]] Client holder() const noexcept { return holder_.load(); }
  [[nodiscard]] bool heldBy(Client client) const noexcept {
    return client != 0 && holder() == client;
  }
  /// Whether the last release was a handing back; false after a holder that vanished.
  [[nodiscard]] bool handedBack() const noexcept { return handed_back_.load(); }

 private:
  std::atomic<Client> clients_{0};
  std::atomic<Client> holder_{0};
  std::atomic<bool> handed_back_{false};
};

}  // namespace wholehand
