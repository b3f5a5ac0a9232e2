#include "server/controls_arbiter.hpp"

namespace wholehand {

bool ControlsArbiter::take(Client client) noexcept {
  if (client == 0) return false;
  Client before = 0;
  return holder_.compare_exchange_strong(before, client) || before == client;
}

bool ControlsArbiter::release(Client client, bool handed_back) noexcept {
  if (client == 0 || holder() != client) return false;
  handed_back_ = handed_back;  // before the holder: whoever sees nobody sees why
  Client before = client;
  return holder_.compare_exchange_strong(before, 0);
}

}  // namespace wholehand
