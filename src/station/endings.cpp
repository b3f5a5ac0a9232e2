#include "station/endings.hpp"

#include <fmt/format.h>

namespace wholehand {

OrderReply Endings::refuseUnseen(std::uint32_t seen) const {
  if (seen == count_) return {true, ""};
  if (seen == 0) {
    return refused(Refusal::kOtherVersion,
                   "the order does not say which stop it has seen (Arm.endings_seen, "
                   "docs/protocol.md): bring client and program to the same version");
  }
  return refused(Refusal::kStopNotSeen,
                 fmt::format("it was stopped after this was asked (ending {}, the order has seen "
                             "{}): look why, then arm again",
                             count_, seen));
}

bool Endings::rested(RunState now) const {
  return count_ == rest_ && (now == RunState::kStopping || now == RunState::kStopped);
}

// A rest ends what renders or is about to, continues a rest, or comes before the first start; it
// does not replace another stop.
void Endings::stop(const Order& order, std::uint64_t asked, Clock::time_point at, RunState now,
                   bool arming) {
  stop_asked_ = asked;
  const bool rests =
      order.is<orders::Rest>() &&
      (rested(now) || arming || now == RunState::kRendering || now == RunState::kDisarmed);
  rest_before_start_ = !arming && (rested(now) ? rest_before_start_ : now == RunState::kDisarmed);
  if (!repeats(order, at)) ++count_;
  rest_ = rests ? count_ : 0;
}

// Repetitions count once: else nobody could name the last ending while a client repeats its stop. A
// client that numbers nothing repeats within a second; the program that the station is in never
// does. What is taken for a repetition lets an order to arm pass that was on its way.
bool Endings::repeats(const Order& order, Clock::time_point at) {
  const auto [last, first] =
      presses_.try_emplace({order.client, order.what.index()}, Press{order.id, at});
  const bool same = !first && last->second.id == order.id;
  const bool numbered = order.id != 0;
  const bool soon = order.client != 0 && at - last->second.at < kRepeats;
  last->second = {order.id, at};
  return same && (numbered || soon);
}

void Endings::countOn() {
  const bool rest = count_ == rest_;
  ++count_;
  if (rest) rest_ = count_;
}

void Endings::endSession(bool faulted, bool goes_on) {
  const bool rest = count_ == rest_ && !faulted;
  if (!goes_on) ++count_;
  rest_ = rest ? count_ : 0;
}

void Endings::beginSession() {
  presses_.clear();
  rest_ = 0;
}

void Endings::restoreRest(bool before, std::uint32_t count) {
  if (before && count == count_) rest_ = count_;
}

void Endings::changePerson() {
  if (!rest_before_start_) rest_ = 0;
}

}  // namespace wholehand
