#pragma once

#include "server/client_words.hpp"
#include "server/udp_datagram.hpp"
#include "server/udp_socket.hpp"
#include "wholehand_generated.h"

#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace wholehand::test {

namespace fb = wholehand::protocol;

/// A game of few words: says what it is told to, keeps what it hears, acknowledges where asked.
/// Datagrams leave through a function and come by hear(): a socket, or a network made up.
class TestGame {
 public:
  using Bytes = wire::Bytes;
  using Send = std::function<void(const Bytes& datagram)>;

  explicit TestGame(Send send) : send_(std::move(send)) {}

  void hello(std::uint16_t rate_hz, const std::string& token = "", std::uint64_t nonce = 1,
             std::uint16_t schema = wire::kSchemaVersion) {
    udp::Hello hello;
    hello.rate_hz = rate_hz;
    hello.schema_version = schema;
    hello.nonce = nonce;
    hello.token = {reinterpret_cast<const std::uint8_t*>(token.data()), token.size()};
    session = 0;
    say(udp::Kind::kHello, udp::writeHello(hello));
  }
  void say(udp::Kind kind, const Bytes& message = {}) {
    udp::Header header;
    header.kind = kind;
    header.session = session;
    header.sequence = ++sequence;
    udp::forEachFragment(header, message, [&](std::span<const std::uint8_t> d) {
      last_said.assign(d.begin(), d.end());
      send_(last_said);
    });
  }
  void command(const Bytes& message) { say(udp::Kind::kMessage, message); }

  void hear(std::span<const std::uint8_t> bytes) {
    const udp::Received r = udp::read(bytes);
    if (r.flaw != udp::Flaw::kNone) throw std::runtime_error("the program sent rubbish");
    largest = std::max(largest, bytes.size());
    ++heard[r.header.kind];
    if (r.header.kind == udp::Kind::kWelcome && session == 0) {
      session = r.header.session;
      if (answers) say(udp::Kind::kHeartbeat);
    }
    if (r.header.kind == udp::Kind::kRefused) {
      refusal.assign(r.payload.begin(), r.payload.end());
    }
    if (r.header.session != session) return;
    if (r.header.kind == udp::Kind::kState) {
      state_sequences.push_back(r.header.sequence);
      if (r.header.fragment_count != 1) throw std::runtime_error("a state was cut in pieces");
      last_state.assign(r.payload.begin(), r.payload.end());
      state_ticks.push_back(verified(last_state).payload_as_WorldState()->tick());
    }
    if (r.header.kind == udp::Kind::kReliable) hearReliable(r);
  }

  /// Messages in order and once each, as a client has to make them out of what comes.
  [[nodiscard]] std::vector<const fb::Message*> messages() const {
    std::vector<const fb::Message*> out;
    for (const auto& [number, bytes] : reliable) {
      if (number != out.size() + 1) break;
      out.push_back(&verified(bytes));
    }
    return out;
  }
  /// Answers by the number of their command.
  [[nodiscard]] std::map<std::uint32_t, std::pair<bool, std::string>> replies() const {
    std::map<std::uint32_t, std::pair<bool, std::string>> out;
    for (const fb::Message* m : messages()) {
      if (const auto* r = m->payload_as_Reply()) {
        out[r->command()] = {r->accepted(), r->reason()->str()};
      }
    }
    return out;
  }

  static const fb::Message& verified(const Bytes& bytes) {
    flatbuffers::Verifier verifier(bytes.data(), bytes.size());
    if (!fb::VerifyMessageBuffer(verifier)) throw std::runtime_error("not a message");
    return *fb::GetMessage(bytes.data());
  }

  bool acknowledges = true;
  bool answers = true;  ///< the Welcome, at once
  std::uint32_t session = 0, sequence = 0;
  Bytes last_said, last_state;
  std::map<udp::Kind, int> heard;
  std::string refusal;
  std::size_t largest = 0;  ///< datagram
  std::vector<std::uint32_t> state_sequences;
  std::vector<std::uint64_t> state_ticks;
  std::map<std::uint32_t, Bytes> reliable;  ///< complete ones, by their number

 private:
  void hearReliable(const udp::Received& r) {
    auto [it, added] = open_.try_emplace(r.header.sequence, 2'000'000);
    const bool known = reliable.count(r.header.sequence) != 0;
    if (!known) {
      if (it->second.add(r.header, r.payload) != udp::Reassembler::Result::kComplete) return;
      const auto m = it->second.message();
      reliable[r.header.sequence].assign(m.begin(), m.end());
    }
    if (!acknowledges) return;
    flatbuffers::FlatBufferBuilder b;
    const auto a = fb::CreateAcknowledge(b, r.header.sequence);
    fb::FinishMessageBuffer(
        b, fb::CreateMessage(b, wire::kSchemaVersion, fb::Payload::Acknowledge, a.Union()));
    command({b.GetBufferPointer(), b.GetBufferPointer() + b.GetSize()});
  }

  Send send_;
  std::map<std::uint32_t, udp::Reassembler> open_;
};

}  // namespace wholehand::test
