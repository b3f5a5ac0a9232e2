#include "server/controls_arbiter.hpp"

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

}  // namespace wholehand
