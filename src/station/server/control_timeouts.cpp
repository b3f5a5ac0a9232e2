#include "station/server/control_timeouts.hpp"

#include <utility>

namespace wholehand {

std::string ControlTimeouts::take(Client client, std::int64_t now_ns) {
  const ControlHolder::TakeResult result = controls_.take(client);
  if (!result) return "another client holds the controls";
  holdsNow(client, result, now_ns);
  return {};
}

void ControlTimeouts::takeOver(Client client, std::int64_t now_ns) {
  holdsNow(client, controls_.takeOver(client), now_ns);
}

void ControlTimeouts::holdsNow(Client client, const ControlHolder::TakeResult& result,
                               std::int64_t now_ns) {
  // After the loss of a holder, the new one must choose the steering again; the lost holder's aim
  // must not continue.
  if (result.predecessor_lost) give_back_ = true;
  // If clients of another server held the controls in between, that server's reports may arrive
  // late, so the last reported value is unknown.
  if (result.claim > own_claim_ + 1) reported_alive_.reset();
  lost_ns_.reset();
  abandoned_ = false;
  own_holder_ = client;
  claim_ = own_claim_ = result.claim;
  message_ns_ = kept_ns_ = steady_ns_ = now_ns;
  excused_ = suspended_ = false;
  resumed_ns_.reset();
}

std::string ControlTimeouts::release(Client client) {
  if (!holds(client)) return "this client does not hold the controls";
  controls_.release(client, true);
  own_holder_ = 0;
  suspended_ = false;
  give_back_ = true;
  return {};
}

void ControlTimeouts::noteMessage(Client client, std::int64_t now_ns) {
  if (!holds(client)) return;
  if (now_ns - message_ns_ > kSilent_ns) steady_ns_ = now_ns;
  message_ns_ = kept_ns_ = now_ns;
  excused_ = false;
  if (!suspended_ || (often_silent_ && !steadyAgain(now_ns))) return;
  suspended_ = false;
  resumed_ns_ = now_ns;
}

void ControlTimeouts::noteBusy(Client client, std::int64_t now_ns) {
  if (holds(client) && now_ns - message_ns_ <= kBusy_ns) kept_ns_ = now_ns;
}

bool ControlTimeouts::steadyAgain(std::int64_t now_ns) const {
  return now_ns - resumed_ns_.value_or(now_ns) >= kOnceIn_ns && now_ns - steady_ns_ >= kSteady_ns;
}

void ControlTimeouts::left(Client client, std::int64_t now_ns) {
  if (!holds(client)) return;
  controls_.release(client);
  own_holder_ = 0;
  suspended_ = false;
  lost_ns_ = now_ns;
  abandoned_ = true;
}

void ControlTimeouts::followOthers(std::int64_t now_ns) {
  const std::uint32_t claim = controls_.claim();  // read before the holder
  const Client holder = controls_.holder();
  const bool other_holds = holder != 0 && holder != own_holder_;
  if (other_holds) {
    // The other server reports whether its client is alive, and that client chooses the steering.
    lost_ns_.reset();
    abandoned_ = false;
    reported_alive_ = true;
  } else if (other_holds_ && holder == 0) {
    claim_ = claim;
    if (controls_.handedBack()) {
      give_back_ = true;
    } else {
      lost_ns_ = now_ns;
      abandoned_ = true;
    }
  }
  other_holds_ = other_holds;
}

void ControlTimeouts::checkSilence(std::int64_t now_ns, Advice& advice) {
  const bool late = now_ns - std::exchange(looked_ns_, now_ns) > kLate_ns;
  if (own_holder_ == 0) return;
  if (late && !std::exchange(excused_, true)) message_ns_ = kept_ns_ = now_ns;
  if (now_ns - message_ns_ <= kSilent_ns) return;
  if (now_ns - kept_ns_ > kGone_ns) {
    advice.silent_client = own_holder_;
    left(own_holder_, now_ns);
  } else if (!std::exchange(suspended_, true)) {
    often_silent_ = resumed_ns_ && now_ns - *resumed_ns_ < kOnceIn_ns;
    advice.suspended_client = own_holder_;
  }
}

ControlTimeouts::Advice ControlTimeouts::advance(std::int64_t now_ns) {
  Advice advice;
  followOthers(now_ns);
  checkSilence(now_ns, advice);
  if (lost_ns_ && now_ns - *lost_ns_ > kLost_ns) {
    lost_ns_.reset();
    give_back_ = true;
  }
  const bool alive = !abandoned_ && !suspended_;
  if (alive != reported_alive_) advice.holder_alive = reported_alive_ = alive;
  advice.claim = claim_;
  advice.give_back = give_back_;
  give_back_ = false;
  const Client holder = controls_.holder();
  if (holder != 0 || !free_ns_) free_ns_ = now_ns;
  advice.unattended = now_ns - *free_ns_ > kUnattended_ns;
  if (advice.unattended) free_ns_ = now_ns;
  advice.holder_changed = holder != reported_;
  reported_ = holder;
  return advice;
}

}  // namespace wholehand
