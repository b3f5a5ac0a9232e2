#include "server/udp_host.hpp"

#include <algorithm>
#include <string>
#include <string_view>

// From a Hello to a game.
namespace wholehand::udp {
namespace {

/// Nonces remembered; an old Hello that is played back later than that begins a conversation that
/// nobody continues.
constexpr std::size_t kOldNonces = 64;

/// Takes as long for a wrong token as for the right one.
bool sameToken(std::string_view wanted, std::span<const std::uint8_t> given) noexcept {
  std::size_t difference = wanted.size() ^ given.size();
  for (std::size_t i = 0; i < given.size() && !wanted.empty(); ++i) {
    difference |= static_cast<std::uint8_t>(wanted[i % wanted.size()]) ^ std::size_t{given[i]};
  }
  return difference == 0;
}

/// A number that is not 0 and hard to guess from the last one (SplitMix64).
std::uint32_t nextSession(std::uint64_t& state) noexcept {
  std::uint64_t z = 0;
  do {
    z = (state += 0x9E3779B97F4A7C15U);
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
    z ^= z >> 31U;
  } while (static_cast<std::uint32_t>(z) == 0);
  return static_cast<std::uint32_t>(z);
}

}  // namespace

bool Host::mayHello(const UdpEndpoint& from) const {
  return from.isLoopback() ||
         std::any_of(admission_.peers.begin(), admission_.peers.end(), [&](const UdpEndpoint& p) {
           return p.address == from.address && (p.port == 0 || p.port == from.port);
         });
}

void Host::receiveHello(const UdpEndpoint& from, std::span<const std::uint8_t> payload,
                        std::int64_t now_ns) {
  if (!mayHello(from)) return counters_.ignore(UdpIgnored::kUnknownPeer);
  Hello hello;
  if (!readHello(payload, hello)) return counters_.ignore(UdpIgnored::kHello);
  if (!admission_.token.empty() && !sameToken(admission_.token, hello.token)) {
    return refuseHello(from, UdpIgnored::kToken, "this is not the token of the program", now_ns);
  }
  if (hello.schema_version != wire::kSchemaVersion) {
    return refuseHello(from, UdpIgnored::kSchema,
                       "the program speaks version " + std::to_string(wire::kSchemaVersion) +
                           " of protocol/wholehand.fbs, the game version " +
                           std::to_string(hello.schema_version),
                       now_ns);
  }
  Peer* peer = find(from);
  if (peer != nullptr && peer->nonce == hello.nonce) return welcome(*peer, now_ns);
  if (std::find(old_nonces_.begin(), old_nonces_.end(), hello.nonce) != old_nonces_.end()) {
    return counters_.ignore(UdpIgnored::kReplayed);
  }
  makeRoomForHello(from, now_ns);
  if (games() >= admission_.most_peers) return refuseFull(from, now_ns);
  Peer& added = peers_.emplace_back();
  added.endpoint = from;
  added.nonce = hello.nonce;
  added.session = nextSession(random_);
  added.client = controls_.newClient();
  added.rate_hz = hello.rate_hz;
  added.decimator = Decimator(hello.rate_hz, tick_rate_hz_);
  added.heard_ns = added.alive_ns = now_ns;
  welcome(added, now_ns);
}

void Host::makeRoomForHello(const UdpEndpoint& from, std::int64_t now_ns) {
  remove([&](const Peer& p) { return p.endpoint == from; }, now_ns);
  if (peers_.size() - games() < kMostUnanswered) return;
  const auto oldest = std::find_if(peers_.begin(), peers_.end(),
                                   [](const Peer& p) { return !p.answered; });  // in their order
  peers_.erase(oldest);
}

std::size_t Host::games() const {
  return static_cast<std::size_t>(
      std::count_if(peers_.begin(), peers_.end(), [](const Peer& p) { return p.answered; }));
}

void Host::refuseFull(const UdpEndpoint& to, std::int64_t now_ns) {
  refuseHello(to, UdpIgnored::kHello, std::to_string(games()) + " games are connected already",
              now_ns);
}

/// The Welcome was answered: from now on it is a game. False, and it is gone, where there are
/// enough of them.
bool Host::begin(Peer& peer, std::int64_t now_ns) {
  if (games() >= admission_.most_peers) {
    const UdpEndpoint endpoint = peer.endpoint;
    remove([&](const Peer& p) { return p.endpoint == endpoint; }, now_ns);
    refuseFull(endpoint, now_ns);
    return false;
  }
  if (old_nonces_.size() == kOldNonces) old_nonces_.erase(old_nonces_.begin());
  old_nonces_.push_back(peer.nonce);
  peer.answered = true;
  counters_.peers = static_cast<std::uint32_t>(games());
  tellControls(peer, now_ns);
  if (scene_message_ != nullptr) sendReliable(peer, scene_message_, now_ns);
  return true;
}

}  // namespace wholehand::udp
