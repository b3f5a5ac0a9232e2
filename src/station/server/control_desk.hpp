#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>

namespace wholehand {

/// Grants command to one client at a time, over WebSocket or UDP. Shared by all servers of the
/// program. Thread-safe; never waits.
class ControlsArbiter {
 public:
  /// Client number; 0: none.
  using Client = std::uint32_t;

  /// Returns an unused number.
  [[nodiscard]] Client newClient() noexcept { return ++clients_; }

  /// Result of taking the controls; false when another client holds them.
  struct Taken {
    std::uint32_t claim = 0;        ///< number of the holder's claim, from 1
    bool predecessor_lost = false;  ///< the holder before vanished or was overruled: its commands
                                    ///< end here
    explicit operator bool() const noexcept { return claim != 0; }
  };
  [[nodiscard]] Taken take(Client client) noexcept;
  /// Takes the controls from any holder, as a therapist may. Fails only for client 0.
  [[nodiscard]] Taken takeOver(Client client) noexcept;
  /// Releases the controls. True when the client held them; nobody does afterwards.
  /// @param handed_back the client gave them back; else it was lost, and its successor starts
  /// afresh
  bool release(Client client, bool handed_back = false) noexcept;
  /// Current holder; 0: none.
  [[nodiscard]] Client holder() const noexcept { return holder_.load(); }
  /// Claim of the newest holder, which may have released it. When read before holder(), it is never
  /// newer than the holder.
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

/// Decides who loses the controls when the browser that holds them goes silent, and who steers the
/// hand when nobody holds them. Time is an argument [ns, monotonic]; one thread.
///
///   nobody has held them     the virtual patient plays, the exercise pushes (the demo)
///   holder silent 200 ms     suspended: the exercise's effort fades out
///     heard within 1 s       it goes on as if it had not been silent
///     a second time          the effort stays out until 10 s after its last return, and until the
///     within 10 s            holder has not been silent for 2 s
///     silent for 1 s         it loses the controls, as if its connection were lost
///   connection lost          the exercise's effort fades out and stays out until somebody takes
///                            the controls; after 5 s without a new holder the virtual patient
///                            steers
///   holder gives them back   the virtual patient plays again at once
///   nobody for 15 min, and   a loop that a client armed is stopped: it would be recorded for ever
///   no order of anybody
///
/// The effort therefore returns at most once in 10 s, whatever the timing of the holder's messages.
/// Silence begins anew when the program wakes up late: what the holder said meanwhile waits in a
/// socket.
///
/// The server of UDP games watches a game that holds the controls. This desk learns only that the
/// game lost them; the arbiter says whether it released them or its connection was lost.
class ControlDesk {
 public:
  static constexpr std::int64_t kSilent_ns = 200'000'000;
  static constexpr std::int64_t kGone_ns = 1'000'000'000;
  static constexpr std::int64_t kOnceIn_ns = 10'000'000'000;
  static constexpr std::int64_t kSteady_ns = 2'000'000'000;
  /// Longer between two looks, the program stood still.
  static constexpr std::int64_t kLate_ns = 50'000'000;
  static constexpr std::int64_t kLost_ns = 5'000'000'000;
  static constexpr std::int64_t kUnattended_ns = 900'000'000'000;

  using Client = ControlsArbiter::Client;

  /// What the desk reports to the program.
  struct Advice {
    std::optional<bool> holder_alive;  ///< set when it changed
    bool give_back = false;            ///< steering returns to the virtual patient
    bool unattended = false;           ///< for kUnattended_ns nobody held the controls or ordered
    bool holder_changed = false;       ///< to be reported to all clients
    Client silent_client = 0;          ///< client that lost the controls by silence; 0: none
    Client suspended_client = 0;       ///< client whose silence began; 0: none
    std::uint32_t claim = 0;           ///< claim on the controls that this advice concerns
  };

  /// @pre the arbiter outlives the desk
  explicit ControlDesk(ControlsArbiter& arbiter) : arbiter_(arbiter) {}

  /// Takes the controls for a client. Empty when the client holds them now, else the reason.
  [[nodiscard]] std::string take(Client client, std::int64_t now_ns);
  /// Takes the controls from any holder. @pre client is not 0
  void takeOver(Client client, std::int64_t now_ns);
  /// Releases the controls. Empty when released, else the reason.
  [[nodiscard]] std::string release(Client client);
  /// Notes a message of the client.
  void heard(Client client, std::int64_t now_ns);
  /// Notes an order that was obeyed, of whomever: somebody attends to the session.
  void attend(std::int64_t now_ns) { free_ns_ = now_ns; }
  /// Notes that the client's connection ended.
  void left(Client client, std::int64_t now_ns);

  /// Returns what is new since the last call. Call after any of the above, and at least every 20
  /// ms.
  [[nodiscard]] Advice advance(std::int64_t now_ns);

  [[nodiscard]] bool holds(Client client) const { return client != 0 && own_holder_ == client; }
  /// Holder of the controls if it is a client of this server, else 0.
  [[nodiscard]] Client holder() const { return own_holder_; }
  [[nodiscard]] bool held() const { return arbiter_.holder() != 0; }
  /// Claim of the holder if it is a client of this server.
  [[nodiscard]] std::uint32_t claim() const { return claim_; }

 private:
  void followOthers(std::int64_t now_ns);
  void judgeSilence(std::int64_t now_ns, Advice& advice);
  [[nodiscard]] bool steadyAgain(std::int64_t now_ns) const;
  void holdsNow(Client client, const ControlsArbiter::Taken& taken, std::int64_t now_ns);

  ControlsArbiter& arbiter_;
  Client own_holder_ = 0;        ///< holder, if a client of this server
  std::uint32_t claim_ = 0;      ///< claim of the newest holder known to this desk
  std::uint32_t own_claim_ = 0;  ///< claim of the newest holder among this server's clients
  Client reported_ = 0;          ///< holder in the last advice
  bool other_holds_ = false;     ///< another server's client held them at the last advice
  std::int64_t heard_ns_ = 0;    ///< time of the last message of own_holder_
  std::int64_t looked_ns_ = 0;   ///< time of the last advice
  bool excused_ = false;         ///< the present silence began anew by a late wake-up
  bool suspended_ = false;       ///< own_holder_ is silent, or was too often and is not steady yet
  bool often_silent_ = false;    ///< own_holder_ fell silent within 10 s after the effort returned
  std::int64_t steady_ns_ = 0;   ///< since when own_holder_ has not been silent
  std::optional<std::int64_t> resumed_ns_;  ///< when the effort returned last
  bool abandoned_ = false;                  ///< the last holder was lost and has no successor
  std::optional<std::int64_t> lost_ns_;     ///< time of that loss, until the virtual patient steers
  std::optional<std::int64_t> free_ns_;  ///< since when nobody has held them or ordered anything,
                                         ///< until unattended is advised
  bool give_back_ = false;
  std::optional<bool> reported_alive_ = true;  ///< empty: another server has reported since
};

}  // namespace wholehand
