#pragma once

#include "station/server/control_holder.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace wholehand {

/// Decides who loses the controls when the browser that holds them goes silent, and who steers the
/// hand when nobody holds them. Time is an argument [ns, monotonic]; one thread.
///
///   nobody has held them     the virtual patient plays, the exercise pushes (the demo)
///   holder silent 200 ms     suspended: the exercise's effort fades out
///     heard within 2 s       it goes on as if it had not been silent
///     a second time          the effort stays out until 10 s after its last return, and until the
///     within 10 s            holder has not been silent for 2 s
///     silent for 2 s         it loses the controls, as if its connection were lost
///   holder says it is busy   as if it were silent, but it keeps the controls for 30 s after its
///                            last other message
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
/// The server of UDP games watches a game that holds the controls. This class learns only that the
/// game lost them; ControlHolder says whether it released them or its connection was lost.
class ControlTimeouts {
 public:
  static constexpr std::int64_t kSilent_ns = 200'000'000;
  static constexpr std::int64_t kGone_ns = 2'000'000'000;
  static constexpr std::int64_t kBusy_ns = 30'000'000'000;
  static constexpr std::int64_t kOnceIn_ns = 10'000'000'000;
  static constexpr std::int64_t kSteady_ns = 2'000'000'000;
  /// A longer time between two calls of advance() means that the program stood still [ns].
  static constexpr std::int64_t kLate_ns = 50'000'000;
  static constexpr std::int64_t kLost_ns = 5'000'000'000;
  static constexpr std::int64_t kUnattended_ns = 900'000'000'000;

  using Client = ControlHolder::Client;

  /// What advance() reports to the program.
  struct Advice {
    std::optional<bool> holder_alive;  ///< set when it changed
    bool give_back = false;            ///< the virtual patient steers again
    bool unattended = false;           ///< nobody held the controls or ordered anything for
                                       ///< kUnattended_ns
    bool holder_changed = false;       ///< to be reported to all clients
    Client silent_client = 0;          ///< client that lost the controls by silence; 0: none
    Client suspended_client = 0;       ///< client whose silence began; 0: none
    std::uint32_t claim = 0;           ///< claim on the controls that this advice concerns
  };

  /// @pre the holder object outlives this
  explicit ControlTimeouts(ControlHolder& controls) : controls_(controls) {}

  /// Takes the controls for a client. Empty when the client holds them now, else the reason.
  [[nodiscard]] std::string take(Client client, std::int64_t now_ns);
  /// Takes the controls from any holder. @pre client is not 0
  void takeOver(Client client, std::int64_t now_ns);
  /// Releases the controls. Empty when released, else the reason.
  [[nodiscard]] std::string release(Client client);
  /// Records that a message of the client arrived.
  void noteMessage(Client client, std::int64_t now_ns);
  /// Records that the client said it is busy: it keeps the controls, and is silent otherwise.
  void noteBusy(Client client, std::int64_t now_ns);
  /// Records an obeyed order of any client: somebody attends to the session.
  void attend(std::int64_t now_ns) { free_ns_ = now_ns; }
  /// Records that the client's connection ended.
  void left(Client client, std::int64_t now_ns);

  /// Returns what is new since the last call. Call after any of the above, and at least every 20
  /// ms.
  [[nodiscard]] Advice advance(std::int64_t now_ns);

  [[nodiscard]] bool holds(Client client) const { return client != 0 && own_holder_ == client; }
  /// Holder of the controls if it is a client of this server, else 0.
  [[nodiscard]] Client holder() const { return own_holder_; }
  [[nodiscard]] bool held() const { return controls_.holder() != 0; }
  /// Claim of the holder if it is a client of this server.
  [[nodiscard]] std::uint32_t claim() const { return claim_; }

 private:
  void followOthers(std::int64_t now_ns);
  void checkSilence(std::int64_t now_ns, Advice& advice);
  [[nodiscard]] bool steadyAgain(std::int64_t now_ns) const;
  void holdsNow(Client client, const ControlHolder::TakeResult& result, std::int64_t now_ns);

  ControlHolder& controls_;
  Client own_holder_ = 0;        ///< holder, if a client of this server
  std::uint32_t claim_ = 0;      ///< claim of the newest holder known to this server
  std::uint32_t own_claim_ = 0;  ///< claim of the newest holder among this server's clients
  Client reported_ = 0;          ///< holder in the last advice
  bool other_holds_ = false;     ///< another server's client held them at the last advice
  std::int64_t message_ns_ = 0;  ///< time of the last message of own_holder_ but that it is busy
  std::int64_t kept_ns_ = 0;     ///< time until which own_holder_ has been busy or heard
  std::int64_t looked_ns_ = 0;   ///< time of the last advice
  bool excused_ = false;         ///< the present silence was restarted after a late wake-up
  bool suspended_ = false;       ///< own_holder_ is silent, or was silent too often and is not
                                 ///< steady yet
  bool often_silent_ = false;    ///< own_holder_ fell silent within 10 s after the effort returned
  std::int64_t steady_ns_ = 0;   ///< time since which own_holder_ has not been silent
  std::optional<std::int64_t> resumed_ns_;  ///< time at which the effort last returned
  bool abandoned_ = false;                  ///< the last holder was lost and has no successor
  std::optional<std::int64_t> lost_ns_;     ///< time of that loss, until the virtual patient steers
  std::optional<std::int64_t> free_ns_;     ///< time since which nobody has held them or ordered
                                            ///< anything, until unattended is advised
  bool give_back_ = false;
  std::optional<bool> reported_alive_ = true;  ///< last reported value; empty: another server has
                                               ///< reported since
};

}  // namespace wholehand
