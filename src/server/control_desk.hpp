#pragma once

#include "server/controls_arbiter.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace wholehand {

/// What becomes of the controls when the browser that holds them goes silent, and to whom the hand
/// falls when nobody holds them. Time is an argument [ns, monotonic]; one thread.
///
///   nobody has held them     the virtual patient plays, the exercise pushes (the demo)
///   holder silent 200 ms     it loses the controls, as one whose line is lost
///   holder's line is lost    the exercise's effort fades out and stays out until somebody takes
///                            the controls; after 5 s without a new holder the virtual patient
///                            steers
///   holder gives them back   the virtual patient plays again at once
///   nobody for 15 min        what a client armed is to be let down: it would be recorded for ever
///
/// A holder that was silent and is heard again must take the controls anew. Its effort therefore
/// changes once, however its messages come.
///
/// A game over UDP that holds the controls is heard by its own server; here it counts when it loses
/// them: as one that gave them back, or whose line was lost, as the arbiter says.
class ControlDesk {
 public:
  static constexpr std::int64_t kSilent_ns = 200'000'000;
  static constexpr std::int64_t kLost_ns = 5'000'000'000;
  static constexpr std::int64_t kLeftAlone_ns = 900'000'000'000;

  using Client = ControlsArbiter::Client;

  /// What the program has to be told.
  struct Advice {
    std::optional<bool> owner_alive;  ///< when it changed
    bool give_back = false;           ///< steering returns to the virtual patient
    bool left_alone = false;          ///< nobody has held the controls for so long
    bool holder_changed = false;      ///< all clients are told
    Client silent_client = 0;         ///< who lost the controls by silence; 0: nobody
    std::uint32_t claim = 0;          ///< whose holding of the controls all this is about
  };

  /// @pre the arbiter outlives the desk
  explicit ControlDesk(ControlsArbiter& arbiter) : arbiter_(arbiter) {}

  /// Empty when the client holds the controls now, else why not.
  [[nodiscard]] std::string take(Client client, std::int64_t now_ns);
  /// Takes them from whoever has them. @pre client is not 0
  void takeOver(Client client, std::int64_t now_ns);
  /// Empty when given back, else why not.
  [[nodiscard]] std::string release(Client client);
  /// A message of that client came.
  void heard(Client client, std::int64_t now_ns);
  /// Its connection ended.
  void left(Client client, std::int64_t now_ns);

  /// After any of the above, and at least every 20 ms: what is new since the last call.
  [[nodiscard]] Advice advance(std::int64_t now_ns);

  [[nodiscard]] bool holds(Client client) const { return client != 0 && mine_ == client; }
  /// Where it is a client of ours, else 0.
  [[nodiscard]] Client holder() const { return mine_; }
  [[nodiscard]] bool held() const { return arbiter_.holder() != 0; }
  /// Of the holder, where it is a client of ours.
  [[nodiscard]] std::uint32_t claim() const { return claim_; }

 private:
  void followOthers(std::int64_t now_ns);
  void holdsNow(Client client, const ControlsArbiter::Taken& taken, std::int64_t now_ns);

  ControlsArbiter& arbiter_;
  Client mine_ = 0;              ///< the holder, where it is a client of ours
  std::uint32_t claim_ = 0;      ///< of the newest holder that this desk knows
  std::uint32_t own_claim_ = 0;  ///< of the newest holder that was a client of ours
  Client told_ = 0;              ///< the holder of the last advice
  bool other_holds_ = false;     ///< a client of another server held them at the last advice
  std::int64_t heard_ns_ = 0;    ///< the last message of mine_
  bool abandoned_ = false;       ///< the last holder was lost, and nobody has taken over
  std::optional<std::int64_t> lost_ns_;  ///< when that was, until the virtual patient steers
  std::optional<std::int64_t> free_ns_;  ///< since when nobody has held them, or it was said
  bool give_back_ = false;
  std::optional<bool> told_alive_ = true;  ///< nothing: another server has told it since
};

}  // namespace wholehand
