#include "station/stop_history.hpp"

#include <fmt/format.h>

namespace wholehand {

OrderReply StopHistory::refuseUnacknowledged(std::uint32_t seen) const {
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

bool StopHistory::rested(RunState now) const {
  return count_ == rest_ && (now == RunState::kStopping || now == RunState::kStopped);
}

// A rest counts as a rest only if something rendered or was being armed, if it continues a rest, or
// before the first start. It does not turn an earlier stop into a rest.
void StopHistory::stop(const Order& order, std::uint64_t asked, Clock::time_point at, RunState now,
                       bool arming) {
  stop_asked_ = asked;
  const bool rests =
      order.is<orders::Rest>() &&
      (rested(now) || arming || now == RunState::kRendering || now == RunState::kDisarmed);
  rest_before_start_ = !arming && (rested(now) ? rest_before_start_ : now == RunState::kDisarmed);
  if (!repeats(order, at)) ++count_;
  rest_ = rests ? count_ : 0;
}

// Repeated presses of the same stop count as one ending. Otherwise the count would rise while a
// client repeats its stop, and nobody could name the last ending. Presses with the same order
// number are repetitions. Presses without a number are repetitions within kRepeats; client 0, the
// program itself, never repeats. An order to arm that was sent before a repetition stays valid.
bool StopHistory::repeats(const Order& order, Clock::time_point at) {
  const auto [last, first] =
      presses_.try_emplace({order.client, order.what.index()}, Press{order.id, at});
  const bool same = !first && last->second.id == order.id;
  const bool numbered = order.id != 0;
  const bool soon = order.client != 0 && at - last->second.at < kRepeats;
  last->second = {order.id, at};
  return same && (numbered || soon);
}

void StopHistory::keepRestPending() {
  const bool rest = count_ == rest_;
  ++count_;
  if (rest) rest_ = count_;
}

void StopHistory::endSession(bool faulted, bool goes_on) {
  const bool rest = count_ == rest_ && !faulted;
  if (!goes_on) ++count_;
  rest_ = rest ? count_ : 0;
}

void StopHistory::beginSession() {
  presses_.clear();
  rest_ = 0;
}

void StopHistory::restoreRest(bool before, std::uint32_t count) {
  if (before && count == count_) rest_ = count_;
}

void StopHistory::changePerson() {
  if (!rest_before_start_) rest_ = 0;
}

}  // namespace wholehand
