#pragma once

#include "station/server/client_words.hpp"
#include "station/server/udp_host.hpp"
#include "station/server/udp_socket.hpp"
#include "wholehand_generated.h"

#include <algorithm>
#include <functional>
#include <stdexcept>
#include <vector>

namespace wholehand::test {

namespace fb = wholehand::protocol;

/// A minimal game: sends the test's messages and stores what it receives. Datagrams leave through a
/// function and arrive by receive(), over a socket or a simulated network.
class TestGame {
 public:
  using Bytes = wire::Bytes;
  using Send = std::function<void(const Bytes& datagram)>;

  explicit TestGame(Send send) : send_(std::move(send)) {}

  /// The next datagram with this message.
  [[nodiscard]] Bytes datagram(const Bytes& message = {}) {
    udp::Header header;
    header.kind = message.empty() ? udp::Kind::kAlive : udp::Kind::kCommand;
    header.key = key;
    header.sequence = ++sequence;
    header.rate_or_stop = rate_hz;
    header.sent_ns = ++sent_ns;
    header.echo_ns = echoes ? program_ns : 0;
    udp::Datagram d;
    const std::size_t size = udp::write(d, header, message);
    return {d.begin(), d.begin() + size};
  }
  void send(const Bytes& message = {}) {
    last_sent = datagram(message);
    send_(last_sent);
  }

  void receive(std::span<const std::uint8_t> bytes) {
    const udp::Received r = udp::read(bytes);
    if (r.flaw != udp::Flaw::kNone) throw std::runtime_error("the program sent rubbish");
    ++heard;
    received_bytes += bytes.size();
    largest = std::max(largest, bytes.size());
    if (r.header.key != key) throw std::runtime_error("the key of another conversation");
    if (r.header.sequence <= newest) return;  // old or duplicate
    newest = r.header.sequence;
    program_ns = r.header.sent_ns;
    last = r.header;
    if (r.header.kind != udp::Kind::kState) return;
    last_state.assign(r.payload.begin(), r.payload.end());
    state_ticks.push_back(state().tick());
  }
  /// The newest state. @pre there is one
  [[nodiscard]] const fb::WorldState& state() const {
    flatbuffers::Verifier verifier(last_state.data(), last_state.size());
    if (!fb::VerifyMessageBuffer(verifier)) throw std::runtime_error("not a message");
    return *fb::GetMessage(last_state.data())->payload_as_WorldState();
  }

  std::uint64_t key = 0;
  std::uint32_t rate_hz = 1000, sequence = 0;
  std::int64_t sent_ns = 0;
  bool echoes = true;  ///< whether it echoes, as a game that receives at its address does
  Bytes last_sent, last_state;
  udp::Header last;  ///< header of the newest datagram received
  std::uint32_t newest = 0;
  std::int64_t program_ns = 0;
  int heard = 0;
  std::size_t received_bytes = 0, largest = 0;
  std::vector<std::uint64_t> state_ticks;

 private:
  Send send_;
};

}  // namespace wholehand::test
