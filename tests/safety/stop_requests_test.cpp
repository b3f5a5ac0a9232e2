// Every order in which a stop, an arming and a tick may come.
#include "safety/stop_requests.hpp"

#include <gtest/gtest.h>

namespace wholehand::test {
namespace {

TEST(StopRequests, NobodyAsked_NothingIsSaid) {
  StopRequests stops;
  EXPECT_FALSE(stops.consumeUnseen());
  EXPECT_TRUE(stops.arm());
  EXPECT_EQ(stops.pending(), Fault::kNone);
}

TEST(StopRequests, AskedBeforeArming_IsSeenOnce) {
  StopRequests stops;
  stops.request();
  EXPECT_TRUE(stops.consumeUnseen());
  EXPECT_FALSE(stops.consumeUnseen());
  ASSERT_TRUE(stops.arm());
  EXPECT_EQ(stops.pending(), Fault::kNone) << "an old stop ended a new session";
}

TEST(StopRequests, AskedWhileArming_RefusesThatArmingOnly) {
  StopRequests stops;
  EXPECT_FALSE(stops.consumeUnseen());
  stops.requestEmergency();
  EXPECT_FALSE(stops.arm());
  EXPECT_FALSE(stops.consumeUnseen()) << "it was told already";
  EXPECT_TRUE(stops.arm());
  EXPECT_EQ(stops.pending(), Fault::kNone);
}

TEST(StopRequests, AskedOnceArmed_IsSaidInEveryTickFromThenOn) {
  StopRequests stops;
  ASSERT_TRUE(stops.arm());
  stops.request();
  EXPECT_EQ(stops.pending(), Fault::kStopRequested);
  EXPECT_EQ(stops.pending(), Fault::kStopRequested);
  stops.requestEmergency();
  EXPECT_EQ(stops.pending(), Fault::kStopRequested | Fault::kEmergencyStop);
}

TEST(StopRequests, SeenByATick_DoesNotRefuseTheNextArming) {
  StopRequests stops;
  ASSERT_TRUE(stops.arm());
  stops.requestEmergency();
  EXPECT_TRUE(any(stops.pending()));
  EXPECT_FALSE(stops.consumeUnseen());
  ASSERT_TRUE(stops.arm());
  EXPECT_EQ(stops.pending(), Fault::kNone);
}

TEST(StopRequests, AskedAfterTheLastTick_RefusesTheNextArming) {
  StopRequests stops;
  ASSERT_TRUE(stops.arm());
  EXPECT_EQ(stops.pending(), Fault::kNone);
  stops.request();
  EXPECT_TRUE(stops.consumeUnseen());
}

}  // namespace
}  // namespace wholehand::test
