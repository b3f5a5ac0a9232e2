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

/// A minimal game: sends what the test says, keeps what it receives. Datagrams leave through a
/// function and come by hear(): a socket, or a network made up.
class TestGame {
 public:
  using Bytes = wire::Bytes;
  using Send = std::function<void(const Bytes& datagram)>;

  explicit TestGame(Send send) : send_(std::move(send)) {}

  /// A datagram as it would be said now.
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
  void say(const Bytes& message = {}) {
    last_said = datagram(message);
    send_(last_said);
  }

  void hear(std::span<const std::uint8_t> bytes) {
    const udp::Received r = udp::read(bytes);
    if (r.flaw != udp::Flaw::kNone) throw std::runtime_error("the program sent rubbish");
    ++heard;
    heard_bytes += bytes.size();
    largest = std::max(largest, bytes.size());
    if (r.header.key != key) throw std::runtime_error("the key of another conversation");
    if (r.header.sequence <= newest) return;  // an old one, or one that came twice
    newest = r.header.sequence;
    program_ns = r.header.sent_ns;
    last = r.header;
    if (r.header.kind != udp::Kind::kState) return;
    last_state.assign(r.payload.begin(), r.payload.end());
    state_ticks.push_back(state().tick());
  }
  /// The newest. @pre there is one
  [[nodiscard]] const fb::WorldState& state() const {
    flatbuffers::Verifier verifier(last_state.data(), last_state.size());
    if (!fb::VerifyMessageBuffer(verifier)) throw std::runtime_error("not a message");
    return *fb::GetMessage(last_state.data())->payload_as_WorldState();
  }

  std::uint64_t key = 0;
  std::uint32_t rate_hz = 1000, sequence = 0;
  std::int64_t sent_ns = 0;
  bool echoes = true;  ///< what the program sent: it gets what is sent to its address
  Bytes last_said, last_state;
  udp::Header last;  ///< of the newest that came
  std::uint32_t newest = 0;
  std::int64_t program_ns = 0;
  int heard = 0;
  std::size_t heard_bytes = 0, largest = 0;
  std::vector<std::uint64_t> state_ticks;

 private:
  Send send_;
};

}  // namespace wholehand::test
