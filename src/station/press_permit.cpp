#include "station/press_permit.hpp"

namespace wholehand {

PressPermit::Flaw PressPermit::absence(const Order& order, std::uint32_t newest_claim) noexcept {
  if (order.requester && !order.requester->connected) return Flaw::kGone;
  const bool lost = order.requester && order.requester->claim != order.claim;
  if (order.claim != 0 && (lost || order.claim < newest_claim)) return Flaw::kLostControls;
  return Flaw::kNone;
}

PressPermit::Flaw PressPermit::flaw(const Order& order, Clock::time_point asked_at,
                                    Clock::time_point now, std::uint32_t newest_claim) noexcept {
  const Flaw absent = absence(order, newest_claim);
  if (absent != Flaw::kNone || !order.requester) return absent;
  if (now - asked_at > kLongest) return Flaw::kLate;
  const Clock::time_point heard{std::chrono::nanoseconds(order.requester->heard_ns.load())};
  return now > heard && now - heard > kHeardWithin ? Flaw::kUnheard : Flaw::kNone;
}

OrderReply PressPermit::replyFor(Flaw flaw) {
  switch (flaw) {
    case Flaw::kNone:
      break;
    case Flaw::kGone:
      return refused(Refusal::kNotHolder, "the client that asked is gone");
    case Flaw::kLostControls:
      return refused(Refusal::kNotHolder, "this client has lost the controls since it asked");
    case Flaw::kUnheard:
      return refused(Refusal::kNotHeard,
                     "the client that asked was not heard for 0.2 s when the effort was to begin: "
                     "it must send heartbeats until it is answered; look, then ask again");
    case Flaw::kLate:
      return refused(Refusal::kWaitedTooLong,
                     "the start took more than 30 s: look, then ask again");
    case Flaw::kLimitRaised:
      return refused(Refusal::kBasisChanged,
                     "another client raised a limit since this was shown: look, then ask again");
  }
  return {true, ""};
}

bool PressPermit::judge() noexcept {
  Flaw now = flaw(order_, asked_at_, now_(), newest_claim_.load());
  if (now == Flaw::kNone && limit_raised_) now = Flaw::kLimitRaised;
  void_ = now;
  verdict_ = now == Flaw::kNone ? Verdict::kBegun : Verdict::kVoid;
  return now == Flaw::kNone;
}

OrderReply PressPermit::refuse(const Order& order, Clock::time_point asked_at,
                               Clock::time_point now, std::uint32_t newest_claim) {
  return replyFor(flaw(order, asked_at, now, newest_claim));
}

OrderReply PressPermit::refuseAbsent(const Order& order, std::uint32_t newest_claim) {
  return replyFor(absence(order, newest_claim));
}

OrderReply PressPermit::refuseLate(Clock::duration since) {
  return replyFor(since > kLongest ? Flaw::kLate : Flaw::kNone);
}

}  // namespace wholehand
