#include "station/server/control_holder.hpp"

namespace wholehand {

ControlHolder::TakeResult ControlHolder::take(Client client) noexcept {
  if (client == 0) return {};
  Client before = 0;
  if (!holder_.compare_exchange_strong(before, client)) {
    return before == client ? TakeResult{claims_.load(), false} : TakeResult{};
  }
  const bool predecessor_lost = !handed_back_.exchange(true);
  return {claims_.fetch_add(1) + 1, predecessor_lost};
}

ControlHolder::TakeResult ControlHolder::takeOver(Client client) noexcept {
  if (client == 0) return {};
  const Client before = holder_.exchange(client);
  if (before == client) return {claims_.load(), false};
  const bool vanished = !handed_back_.exchange(true);
  return {claims_.fetch_add(1) + 1, before != 0 || vanished};
}

bool ControlHolder::release(Client client, bool handed_back) noexcept {
  if (client == 0 || holder() != client) return false;
  handed_back_ = handed_back;  // set before the holder changes, so that a reader that sees no
                               // holder also sees the reason
  Client before = client;
  return holder_.compare_exchange_strong(before, 0);
}

}  // namespace wholehand
