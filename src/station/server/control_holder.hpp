#pragma once

#include <atomic>
#include <cstdint>

namespace wholehand {

/// Grants command to one client at a time, over WebSocket or UDP. Shared by all servers of the
/// program. Thread-safe; never waits.
class ControlHolder {
 public:
  /// Client number; 0: none.
  using Client = std::uint32_t;

  /// Returns an unused number.
  [[nodiscard]] Client newClient() noexcept { return ++clients_; }

  /// Result of taking the controls; false when another client holds them.
  struct TakeResult {
    std::uint32_t claim = 0;        ///< number of the holder's claim, from 1
    bool predecessor_lost = false;  ///< the previous holder was lost or overruled, so its commands
                                    ///< end here
    explicit operator bool() const noexcept { return claim != 0; }
  };
  [[nodiscard]] TakeResult take(Client client) noexcept;
  /// Takes the controls from any holder, as a therapist may. Fails only for client 0.
  [[nodiscard]] TakeResult takeOver(Client client) noexcept;
  /// Releases the controls. True when the client held them; nobody holds them afterwards.
  /// @param handed_back true: the client gave them back; false: the client was lost, and the next
  /// holder starts afresh
  bool release(Client client, bool handed_back = false) noexcept;
  /// Client that holds the controls; 0: none.
  [[nodiscard]] Client holder() const noexcept { return holder_.load(); }
  /// Claim of the newest holder, which may have released the controls since. When it is read before
  /// holder(), it is never newer than the holder.
  [[nodiscard]] std::uint32_t claim() const noexcept { return claims_.load(); }
  [[nodiscard]] bool heldBy(Client client) const noexcept {
    return client != 0 && holder() == client;
  }
  /// False from the loss of a holder until the next one takes the controls.
  [[nodiscard]] bool handedBack() const noexcept { return handed_back_.load(); }

 private:
  std::atomic<Client> clients_{0};
  std::atomic<Client> holder_{0};
  std::atomic<std::uint32_t> claims_{0};
  std::atomic<bool> handed_back_{true};
};

}  // namespace wholehand
