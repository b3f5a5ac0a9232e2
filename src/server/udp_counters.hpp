#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>

namespace wholehand {

/// Why a datagram was ignored.
enum class UdpIgnored {
  kTooShort,
  kTooLong,
  kMagic,
  kVersion,
  kLength,
  kChecksum,
  kHeader,       ///< unknown kind, impossible fragment, bits that must be 0
  kUnknownPeer,  ///< who never said hello, or may not
  kToken,
  kSchema,    ///< a Hello of another version of protocol/wholehand.fbs
  kHello,     ///< a Hello that is malformed, or one game too many
  kSession,   ///< of another conversation
  kReplayed,  ///< a sequence number that came already, or an old one
  kFragment,  ///< contradicts its message, or the message is too large
  kMessage,   ///< no Message that a client may say
  kCommand,   ///< a command that came already, or that a later one has overtaken
  kRate,      ///< more commands than any game needs
  kCount
};

/// What the UDP side did since it began, for /metrics. Written by its threads, read by anybody.
struct UdpCounters {
  using Counter = std::atomic<std::uint64_t>;

  Counter received{0};       ///< datagrams
  Counter states_sent{0};    ///< WorldState messages
  Counter reliable_sent{0};  ///< scenes, events, replies: each once
  Counter repeated{0};       ///< of these, sent again for want of an acknowledgement
  Counter dropped_full{0};   ///< datagrams not sent: the socket's buffer was full
  Counter send_errors{0};    ///< datagrams not sent: anything else
  Counter commands_accepted{0};
  Counter commands_refused{0};
  Counter silences{0};    ///< games that lost the controls: not heard for 200 ms
  Counter exceptions{0};  ///< orders and rounds that the program gave up; the bridge went on
  Counter peers_lost{0};  ///< games removed for silence, or since they acknowledged nothing
  std::atomic<std::uint32_t> peers{0};  ///< now
  std::array<Counter, static_cast<std::size_t>(UdpIgnored::kCount)> ignored{};

  void ignore(UdpIgnored reason) noexcept { ++ignored[static_cast<std::size_t>(reason)]; }
  [[nodiscard]] std::uint64_t ignoredFor(UdpIgnored reason) const noexcept {
    return ignored[static_cast<std::size_t>(reason)];
  }
};

/// snake_case name of a reason, the label of its metric.
[[nodiscard]] const char* udpIgnoredName(UdpIgnored reason) noexcept;

/// All of them as Prometheus text, to follow the server's own.
[[nodiscard]] std::string udpMetricsText(const UdpCounters& counters);

}  // namespace wholehand
