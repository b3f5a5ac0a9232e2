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

  /// What came of taking the controls; false where another client holds them.
  struct Taken {
    std::uint32_t claim = 0;  ///< counts from 1 with every new holder
    bool orphaned = false;    ///< who held them before vanished or was overruled: nothing of it is
                              ///< to go on
    explicit operator bool() const noexcept { return claim != 0; }
  };
  [[nodiscard]] Taken take(Client client) noexcept;
  /// From whoever has them: the therapist's way. Always succeeds, but for nobody (0).
  [[nodiscard]] Taken takeOver(Client client) noexcept;
  /// True when the client held them; nobody does now.
  /// @param handed_back it gave them back; else it was lost, and the next one begins anew
  bool release(Client client, bool handed_back = false) noexcept;
  /// 0: nobody.
  [[nodiscard]] Client holder() const noexcept { return holder_.load(); }
  /// Of the newest holder, also when it holds them no more. Read before holder(), it is never of a
  /// later one.
  [[nodiscard]] std::uint32_t claim() const noexcept { return claims_.load(); }
  [[nodiscard]] bool heldBy(Client client) const noexcept {
    return client != 0 && holder() == client;
  }
  /// False from when a holder vanished until the next one takes them.
  [[nodiscard]] bool handedBack() const noexcept { return handed_back_.load(); }

 private:
  std::atomic<Client> clients_{0};
  std::atomic<Client> holder_{0};
  std::atomic<std::uint32_t> claims_{0};
  std::atomic<bool> handed_back_{true};
};

}  // namespace wholehand
