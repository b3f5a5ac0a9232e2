#pragma once

#include "server/controls_arbiter.hpp"
#include "server/udp_datagram.hpp"
#include "server/udp_socket.hpp"
#include "server/wire.hpp"

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>

// What the program remembers of one game. Pure: no socket, no clock.
namespace wholehand::udp {

/// Which ticks are sent at a rate: evenly spread, exact over any whole second.
class Decimator {
 public:
  Decimator() = default;
  /// 0 Hz: none.
  Decimator(std::uint32_t rate_hz, std::uint32_t tick_rate_hz) noexcept
      : rate_hz_(rate_hz), tick_rate_hz_(tick_rate_hz) {}

  /// True when a state is due at this tick. Skipped ticks are not made up for; a tick that is not
  /// after the last one begins anew (a new session).
  [[nodiscard]] bool due(std::uint64_t tick) noexcept;

 private:
  std::uint32_t rate_hz_ = 0, tick_rate_hz_ = 1000;
  bool any_ = false;
  std::uint64_t last_ = 0;
};

/// Messages that are sent again until they are acknowledged: at once, then after 50 ms, twice as
/// long after each further time, at most every 500 ms. At most kMostUnderway are on the way.
class ReliableOutbox {
 public:
  using Message = std::shared_ptr<const wire::Bytes>;
  using Send = std::function<void(std::uint32_t sequence, const wire::Bytes& message, bool again)>;

  static constexpr std::size_t kMostUnderway = 32;
  static constexpr std::size_t kMostWaiting = 512;
  static constexpr std::int64_t kFirstPause_ns = 50'000'000;
  static constexpr std::int64_t kLongestPause_ns = 500'000'000;

  /// False where too many wait: the game acknowledges nothing.
  [[nodiscard]] bool add(Message message);
  void acknowledge(std::uint32_t sequence);
  void sendDue(std::int64_t now_ns, const Send& send);
  [[nodiscard]] std::size_t size() const noexcept { return waiting_.size(); }

 private:
  struct Waiting {
    std::uint32_t sequence = 0;
    Message message;
    std::int64_t due_ns = 0;
    std::int64_t pause_ns = kFirstPause_ns;
    bool sent = false;
  };

  std::uint32_t last_sequence_ = 0;
  std::deque<Waiting> waiting_;
};

struct Peer {
  UdpEndpoint endpoint;
  std::uint32_t session = 0;
  std::uint64_t nonce = 0;  ///< of its Hello
  /// Its address has sent something that names the session, hence got the Welcome. Until then it
  /// gets nothing else: a Hello may carry anybody's address.
  bool answered = false;
  ControlsArbiter::Client client = 0;
  std::uint32_t claim = 0;  ///< of its last holding of the controls
  std::uint16_t rate_hz = 0;
  Decimator decimator;

  ReplayWindow window;
  Reassembler reassembler{wire::kLargestClientMessage};
  std::int64_t heard_ns = 0;  ///< anything
  std::int64_t alive_ns = 0;  ///< a heartbeat or a command: the game itself, not its network code

  std::uint32_t last_order = 0;      ///< ids below are carried out or overtaken
  std::uint32_t last_aim = 0;        ///< aims are not repeated, hence counted by themselves
  std::uint32_t last_emergency = 0;  ///< a late emergency stop is obeyed all the same
  std::int64_t second_ns = 0;        ///< when commands were last counted from 0
  int commands = 0;                  ///< since then
  bool aim_refused = false;          ///< told once, until one is accepted or the controls change

  std::uint32_t state_sequence = 0;
  std::uint32_t other_sequence = 0;
  std::int64_t sent_ns = 0;
  ReliableOutbox outbox;
  bool told_mine = false, told_held = false;  ///< what it knows of the controls
};

}  // namespace wholehand::udp
