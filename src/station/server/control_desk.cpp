#include "station/server/control_desk.hpp"

#include <utility>

namespace wholehand {

ControlsArbiter::Taken ControlsArbiter::take(Client client) noexcept {
  if (client == 0) return {};
  Client before = 0;
  if (!holder_.compare_exchange_strong(before, client)) {
    return before == client ? Taken{claims_.load(), false} : Taken{};
  }
  const bool predecessor_lost = !handed_back_.exchange(true);
  return {claims_.fetch_add(1) + 1, predecessor_lost};
}

ControlsArbiter::Taken ControlsArbiter::takeOver(Client client) noexcept {
  if (client == 0) return {};
  const Client before = holder_.exchange(client);
  if (before == client) return {claims_.load(), false};
  const bool vanished = !handed_back_.exchange(true);
  return {claims_.fetch_add(1) + 1, before != 0 || vanished};
}

bool ControlsArbiter::release(Client client, bool handed_back) noexcept {
  if (client == 0 || holder() != client) return false;
  handed_back_ = handed_back;  // before the holder: a reader that sees no holder then sees the
                               // reason
  Client before = client;
  return holder_.compare_exchange_strong(before, 0);
}

std::string ControlDesk::take(Client client, std::int64_t now_ns) {
  const ControlsArbiter::Taken taken = arbiter_.take(client);
  if (!taken) return "another client holds the controls";
  holdsNow(client, taken, now_ns);
  return {};
}

void ControlDesk::takeOver(Client client, std::int64_t now_ns) {
  holdsNow(client, arbiter_.takeOver(client), now_ns);
}

void ControlDesk::holdsNow(Client client, const ControlsArbiter::Taken& taken,
                           std::int64_t now_ns) {
  // A new holder must choose the steering again: the lost holder's aim must not continue.
  if (taken.predecessor_lost) give_back_ = true;
  // Another server's clients held the controls in between; its reports since then may arrive too
  // late to count.
  if (taken.claim > own_claim_ + 1) reported_alive_.reset();
  lost_ns_.reset();
  abandoned_ = false;
  own_holder_ = client;
  claim_ = own_claim_ = taken.claim;
  heard_ns_ = steady_ns_ = now_ns;
  excused_ = suspended_ = false;
  resumed_ns_.reset();
}

std::string ControlDesk::release(Client client) {
  if (!holds(client)) return "this client does not hold the controls";
  arbiter_.release(client, true);
  own_holder_ = 0;
  suspended_ = false;
  give_back_ = true;
  return {};
}

void ControlDesk::heard(Client client, std::int64_t now_ns) {
  if (!holds(client)) return;
  if (now_ns - heard_ns_ > kSilent_ns) steady_ns_ = now_ns;
  heard_ns_ = now_ns;
  excused_ = false;
  if (!suspended_ || (often_silent_ && !steadyAgain(now_ns))) return;
  suspended_ = false;
  resumed_ns_ = now_ns;
}

bool ControlDesk::steadyAgain(std::int64_t now_ns) const {
  return now_ns - resumed_ns_.value_or(now_ns) >= kOnceIn_ns && now_ns - steady_ns_ >= kSteady_ns;
}

void ControlDesk::left(Client client, std::int64_t now_ns) {
  if (!holds(client)) return;
  arbiter_.release(client);
  own_holder_ = 0;
  suspended_ = false;
  lost_ns_ = now_ns;
  abandoned_ = true;
}

void ControlDesk::followOthers(std::int64_t now_ns) {
  const std::uint32_t claim = arbiter_.claim();  // read before the holder
  const Client holder = arbiter_.holder();
  const bool other_holds = holder != 0 && holder != own_holder_;
  if (other_holds) {
    // The other server reports whether its client is alive, and that client chooses the steering.
    lost_ns_.reset();
    abandoned_ = false;
    reported_alive_ = true;
  } else if (other_holds_ && holder == 0) {
    claim_ = claim;
    if (arbiter_.handedBack()) {
      give_back_ = true;
    } else {
      lost_ns_ = now_ns;
      abandoned_ = true;
    }
  }
  other_holds_ = other_holds;
}

void ControlDesk::judgeSilence(std::int64_t now_ns, Advice& advice) {
  const bool late = now_ns - std::exchange(looked_ns_, now_ns) > kLate_ns;
  if (own_holder_ == 0) return;
  if (late && !std::exchange(excused_, true)) heard_ns_ = now_ns;
  const std::int64_t silent_ns = now_ns - heard_ns_;
  if (silent_ns <= kSilent_ns) return;
  if (silent_ns > kGone_ns) {
    advice.silent_client = own_holder_;
    left(own_holder_, now_ns);
  } else if (!std::exchange(suspended_, true)) {
    often_silent_ = resumed_ns_ && now_ns - *resumed_ns_ < kOnceIn_ns;
    advice.suspended_client = own_holder_;
  }
}

ControlDesk::Advice ControlDesk::advance(std::int64_t now_ns) {
  Advice advice;
  followOthers(now_ns);
  judgeSilence(now_ns, advice);
  if (lost_ns_ && now_ns - *lost_ns_ > kLost_ns) {
    lost_ns_.reset();
    give_back_ = true;
  }
  const bool alive = !abandoned_ && !suspended_;
  if (alive != reported_alive_) advice.holder_alive = reported_alive_ = alive;
  advice.claim = claim_;
  advice.give_back = give_back_;
  give_back_ = false;
  const Client holder = arbiter_.holder();
  if (holder != 0 || !free_ns_) free_ns_ = now_ns;
  advice.unattended = now_ns - *free_ns_ > kUnattended_ns;
  if (advice.unattended) free_ns_ = now_ns;
  advice.holder_changed = holder != reported_;
  reported_ = holder;
  return advice;
}

}  // namespace wholehand
