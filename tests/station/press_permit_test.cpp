// A press of Start begins an effort only while its client is there, up to the first tick. The clock
// is the test's.
#include "station/press_permit.hpp"

#include "support/figure.hpp"
#include "support/seed.hpp"

#include <algorithm>

namespace wholehand::test {
namespace {

using Millis = std::chrono::milliseconds;

/// A client that presses Start at 0 ms, and the permit of its press.
struct Press {
  explicit Press(std::uint32_t claim) {
    requester->claim = claim;
    order.claim = claim;
    order.requester = requester;
    newest_claim = claim;
  }
  [[nodiscard]] std::unique_ptr<PressPermit> permit() {
    return std::make_unique<PressPermit>(
        order, at(0), [this] { return at(now_ms); }, newest_claim);
  }
  [[nodiscard]] OrderReply refusal() const {
    return PressPermit::refuse(order, at(0), at(now_ms), newest_claim);
  }
  [[nodiscard]] static PressPermit::Clock::time_point at(std::int64_t ms) {
    return PressPermit::Clock::time_point(std::chrono::hours(1) + Millis(ms));
  }
  void heard(std::int64_t ms) {
    requester->heard_ns = std::chrono::nanoseconds(at(ms).time_since_epoch()).count();
  }

  Order order{orders::Arm{}};
  std::shared_ptr<Requester> requester = std::make_shared<Requester>();
  std::atomic<std::uint32_t> newest_claim{0};
  std::int64_t now_ms = 0;
};

// The client sends a beat every 50 ms until it leaves, at any millisecond of an arming of up to
// 35 s. Expected: an effort begins if and only if the client has not left more than 200 ms after
// its last beat, and the arming took 30 s at most.
TEST(PressPermit, PressAtEveryMillisecondOfAnArming_BeginsOnlyWhileItsClientIsThere) {
  enum { kStays, kIsSilent, kCloses, kGivesBack, kIsOverruled, kWays };
  auto random = seededRandom(5804);
  constexpr int kDrawn = 200'000;
  int left = 0, began_after_leaving = 0, stayed = 0, stayed_and_began = 0;
  for (int i = 0; i < kDrawn; ++i) {
    const auto way = random() % 2 == 0 ? kStays : static_cast<int>(random() % kWays);
    Press press(1 + static_cast<std::uint32_t>(random() % 9));
    const auto permit = press.permit();
    press.now_ms = static_cast<std::int64_t>(random() % 35'001);
    const auto leaves_ms = static_cast<std::int64_t>(random() >> 1U) % (press.now_ms + 1);
    const std::int64_t last_ms = way == kIsSilent ? leaves_ms : press.now_ms;
    press.heard(last_ms - last_ms % 50);
    if (way == kCloses) press.requester->connected = false;
    if (way == kGivesBack) press.requester->claim = 0;
    if (way == kIsOverruled) press.newest_claim = press.order.claim + 1;
    const bool heard = press.now_ms - (last_ms - last_ms % 50) <= 200;
    const bool there = (way == kStays || way == kIsSilent) && heard;
    const bool expected = there && press.now_ms <= 30'000;
    const bool begins = permit->judge();
    ASSERT_EQ(begins, expected) << way << ", " << press.now_ms << " ms, heard " << last_ms;
    ASSERT_EQ(permit->verdict(),
              begins ? PressPermit::Verdict::kBegun : PressPermit::Verdict::kVoid);
    ASSERT_EQ(permit->refusal().accepted, begins);
    ASSERT_EQ(press.refusal().accepted, begins);
    if (!there) {
      ++left;
      began_after_leaving += begins ? 1 : 0;
    } else if (press.now_ms <= 30'000) {
      ++stayed;
      stayed_and_began += begins ? 1 : 0;
    }
  }
  EXPECT_EQ(began_after_leaving, 0);
  EXPECT_EQ(stayed_and_began, stayed);
  figure("armings whose presser left", left, "");
  figure("of them began", began_after_leaving, "");
  figure("armings whose presser stayed", stayed, "");
  figure("of them began an effort", stayed_and_began, "");
}

TEST(PressPermit, Refusals_NameWhatIsWrong) {
  Press press(3);
  press.heard(0);
  const auto permit = press.permit();
  EXPECT_EQ(permit->verdict(), PressPermit::Verdict::kOpen);
  press.now_ms = 200;
  EXPECT_TRUE(press.refusal().accepted);
  press.now_ms = 201;
  EXPECT_EQ(press.refusal().refusal, Refusal::kNotHeard);
  press.now_ms = 30'001;
  press.heard(30'000);
  EXPECT_EQ(press.refusal().refusal, Refusal::kWaitedTooLong);
  press.now_ms = 30'000;
  EXPECT_TRUE(press.refusal().accepted);
  press.newest_claim = 4;
  EXPECT_EQ(press.refusal().refusal, Refusal::kNotHolder);
}

TEST(PressPermit, ClientThatWasNeverHeard_BeginsNothing) {
  Press press(0);
  EXPECT_FALSE(press.permit()->judge());
}

// A therapist may start without the controls; who holds them meanwhile does not matter.
TEST(PressPermit, PressWithoutTheControls_IsNotVoidedByAClaim) {
  Press press(0);
  press.heard(0);
  press.newest_claim = 7;
  EXPECT_TRUE(press.permit()->judge());
}

}  // namespace
}  // namespace wholehand::test
