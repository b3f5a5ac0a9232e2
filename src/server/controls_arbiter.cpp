#include "server/controls_arbiter.hpp"

namespace wholehand {

bool ControlsArbiter::take(Client client) noexcept {
  if (client == 0) return false;
  Client before = 0;
  return holder_.compare_exchange_strong(before, client) || before == client;
}

bool ControlsArbiter::release(Client client) noexcept {
  Client before = client;
  return client != 0 && holder_.compare_exchange_strong(before, 0);
}

}  // namespace wholehand
