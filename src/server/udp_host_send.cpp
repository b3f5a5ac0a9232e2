#include "server/udp_host.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace wholehand::udp {

void Host::setScene(std::shared_ptr<const SceneFacts> scene, std::int64_t now_ns) {
  if (scene == scene_ || scene == nullptr) return;
  scene_ = std::move(scene);
  encoder_ = std::make_unique<wire::StateEncoder>(scene_);
  scene_message_ = std::make_shared<const wire::Bytes>(wire::sceneMessage(*scene_));
  tick_rate_hz_ = scene_->period_s > 0.0
                      ? static_cast<std::uint32_t>(std::lround(1.0 / scene_->period_s))
                      : 1000U;
  for (Peer& peer : peers_) {
    peer.decimator = Decimator(peer.rate_hz, tick_rate_hz_);
    if (peer.answered) sendReliable(peer, scene_message_, now_ns);
  }
}

void Host::publish(const TickRecord& record, const LoopStatus& status, std::int64_t now_ns) {
  if (encoder_ == nullptr) return;
  std::span<const std::uint8_t> state;
  for (Peer& peer : peers_) {
    if (!peer.answered || !peer.decimator.due(record.tick)) continue;
    if (state.empty()) {
      state = encoder_->encode(record, status, wire::Detail::kCompact, now_ns);
    }
    sendState(peer, state, now_ns);
  }
  const int count = std::clamp(record.exercise.event_count, 0, kMaxExerciseEvents);
  if (count == 0 || games() == 0) return;
  std::array<wire::NumberedEvent, kMaxExerciseEvents> events;
  for (int i = 0; i < count; ++i) events[i] = {record.tick, record.exercise.events[i]};
  const auto message = std::make_shared<const wire::Bytes>(
      wire::eventsMessage({events.data(), static_cast<std::size_t>(count)}));
  for (Peer& peer : peers_) {
    if (peer.answered) sendReliable(peer, message, now_ns);
  }
}

void Host::publishIdle(const TickRecord& record, const LoopStatus& status, std::int64_t now_ns) {
  if (encoder_ == nullptr || games() == 0) return;
  const auto state = encoder_->encode(record, status, wire::Detail::kCompact, now_ns);
  for (Peer& peer : peers_) {
    if (peer.answered && peer.rate_hz > 0) sendState(peer, state, now_ns);
  }
}

void Host::advance(std::int64_t now_ns) {
  std::erase_if(peers_, [now_ns](const Peer& peer) {
    return !peer.answered && now_ns - peer.heard_ns > kUnanswered_ns;
  });
  for (Peer& peer : peers_) {
    if (!peer.answered) continue;
    if (controls_.heldBy(peer.client)) watchHolder(peer, now_ns);
    tellControls(peer, now_ns);
    sendDue(peer, now_ns);
    if (now_ns - peer.sent_ns >= kHeartbeat_ns) sendOnce(peer, Kind::kHeartbeat, {}, now_ns);
  }
  counters_.peers_lost += remove(
      [&](const Peer& peer) {
        return now_ns - peer.heard_ns > kGone_ns ||
               peer.outbox.size() >= ReliableOutbox::kMostWaiting;
      },
      now_ns);
  if (lost_ns_ && controls_.holder() != 0) lost_ns_.reset();
  if (lost_ns_ && now_ns - *lost_ns_ > kGone_ns) {
    lost_ns_.reset();
    giveBack(lost_claim_);
  }
}

// A game that was silent and is heard again must take the controls anew: an effort that came back
// by itself would pulse with a game whose messages come too seldom.
void Host::watchHolder(Peer& peer, std::int64_t now_ns) {
  if (now_ns - peer.alive_ns <= kSilence_ns) return;
  ++counters_.silences;
  leave(peer, now_ns);
}

void Host::sayGoodbye(std::int64_t now_ns) {
  for (Peer& peer : peers_) {
    if (peer.answered) sendOnce(peer, Kind::kGoodbye, {}, now_ns);
  }
  remove([](const Peer&) { return true; }, now_ns);
}

void Host::refuseHello(const UdpEndpoint& to, UdpIgnored reason, const std::string& why,
                       std::int64_t now_ns) {
  counters_.ignore(reason);
  Header header;
  header.kind = Kind::kRefused;
  header.monotonic_ns = now_ns;
  sendTo(to, header, {reinterpret_cast<const std::uint8_t*>(why.data()), why.size()});
}

void Host::welcome(Peer& peer, std::int64_t now_ns) {
  sendOnce(peer, Kind::kWelcome,
           wire::welcomeMessage(peer.client, controls_.heldBy(peer.client),
                                scene_ == nullptr ? "" : scene_->program_version),
           now_ns);
}

void Host::reply(Peer& peer, std::uint32_t command, const OrderReply& given, std::int64_t now_ns) {
  ++(given.accepted ? counters_.commands_accepted : counters_.commands_refused);
  sendReliable(peer, std::make_shared<const wire::Bytes>(wire::replyMessage(command, given)),
               now_ns);
}

// Whoever waits for an answer gets one, as long as the last ones are acknowledged.
void Host::refuseForRate(Peer& peer, const wire::ClientMessage& message, std::int64_t now_ns) {
  counters_.ignore(UdpIgnored::kRate);
  if (message.streams() || peer.outbox.size() >= ReliableOutbox::kMostUnderway) return;
  reply(peer, message.id,
        refused(Refusal::kTooMany, std::string(wire::nameOf(message)) +
                                       ": more than 1200 commands in a second, those beyond are "
                                       "dropped"),
        now_ns);
}

void Host::tellControls(Peer& peer, std::int64_t now_ns) {
  const bool mine = controls_.heldBy(peer.client);
  const bool held = controls_.holder() != 0;
  if (mine == peer.told_mine && held == peer.told_held) return;
  peer.told_mine = mine;
  peer.told_held = held;
  peer.aim_refused = false;
  sendReliable(peer, std::make_shared<const wire::Bytes>(wire::controlsMessage({mine, held})),
               now_ns);
}

void Host::sendReliable(Peer& peer, ReliableOutbox::Message message, std::int64_t now_ns) {
  // Where it does not fit any more, advance() removes the game.
  if (!peer.outbox.add(std::move(message))) return;
  ++counters_.reliable_sent;
  sendDue(peer, now_ns);
}

void Host::sendDue(Peer& peer, std::int64_t now_ns) {
  peer.outbox.sendDue(now_ns, [&](std::uint32_t sequence, const wire::Bytes& message, bool again) {
    if (again) ++counters_.repeated;
    Header header;
    header.kind = Kind::kReliable;
    header.session = peer.session;
    header.sequence = sequence;
    header.monotonic_ns = now_ns;
    peer.sent_ns = now_ns;
    sendTo(peer.endpoint, header, message);
  });
}

void Host::sendState(Peer& peer, std::span<const std::uint8_t> message, std::int64_t now_ns) {
  Header header;
  header.kind = Kind::kState;
  header.session = peer.session;
  header.sequence = ++peer.state_sequence;
  header.monotonic_ns = now_ns;
  peer.sent_ns = now_ns;
  ++counters_.states_sent;
  sendTo(peer.endpoint, header, message);
}

void Host::sendOnce(Peer& peer, Kind kind, std::span<const std::uint8_t> message,
                    std::int64_t now_ns) {
  Header header;
  header.kind = kind;
  header.session = peer.session;
  header.sequence = ++peer.other_sequence;
  header.monotonic_ns = now_ns;
  peer.sent_ns = now_ns;
  sendTo(peer.endpoint, header, message);
}

void Host::sendTo(const UdpEndpoint& to, const Header& header,
                  std::span<const std::uint8_t> message) {
  forEachFragment(header, message, [&](std::span<const std::uint8_t> datagram) {
    const UdpSent sent = send_(to, datagram);
    if (sent == UdpSent::kFull) ++counters_.dropped_full;
    if (sent == UdpSent::kFailed) ++counters_.send_errors;
  });
}

}  // namespace wholehand::udp
