#include "record/synthetic_recording.hpp"
#include "replay/recording_series.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace wholehand {
namespace {

TickRecord tick(SafetyState state, Fault faults, double authority) {
  TickRecord r;
  r.time_s = 2.5;
  r.safety_state = state;
  r.faults = faults;
  r.authority = authority;
  return r;
}

const TickRecord kRendering = tick(SafetyState::kRendering, Fault::kNone, 1.0);

std::vector<std::string> kindsOf(const TickRecord& record, const TickRecord* before) {
  std::vector<std::string> kinds;
  for (const RecordingMark& mark : marksOf(record, before, synthetic::meta())) {
    EXPECT_EQ(mark.time_s, 2.5);
    kinds.push_back(mark.kind);
  }
  return kinds;
}

using Kinds = std::vector<std::string>;

TEST(RecordingMarks, QuietTick_HasNone) {
  EXPECT_EQ(kindsOf(kRendering, &kRendering), Kinds{});
}

TEST(RecordingMarks, FirstArmedTick_IsMarkedAsArmed) {
  const TickRecord armed = tick(SafetyState::kArmed, Fault::kNone, 1.0);
  EXPECT_EQ(kindsOf(armed, nullptr), Kinds{"armed"});
  EXPECT_EQ(kindsOf(kRendering, &armed), Kinds{}) << "blended in: armed it was before";
}

TEST(RecordingMarks, OrdersOfPeople_AreMarkedWhereTheyBegin) {
  for (const auto& [bit, kind] : {std::pair{Fault::kStopRequested, "stop"},
                                  {Fault::kEmergencyStop, "emergency_stop"},
                                  {Fault::kHolderSilent, "controls_lost"}}) {
    const TickRecord asked = tick(SafetyState::kRendering, bit, 0.9);
    EXPECT_EQ(kindsOf(asked, &kRendering), Kinds{kind});
    EXPECT_EQ(kindsOf(asked, &asked), Kinds{}) << "it goes on";
  }
}

TEST(RecordingMarks, StoppingFault_IsMarkedWithItsNameAndAxis) {
  TickRecord faulted = tick(SafetyState::kFaulted, Fault::kSpeedLimit | Fault::kLateTick, 0.99);
  faulted.fault_axis = 3;
  const auto marks = marksOf(faulted, &kRendering, synthetic::meta());
  ASSERT_EQ(marks.size(), 1U);
  EXPECT_EQ(marks[0].kind, "fault");
  EXPECT_EQ(marks[0].text, "speed limit exceeded");  // late ticks are no stopping fault
  EXPECT_EQ(marks[0].axis, "finger_flexion");
  TickRecord more = faulted;
  more.faults |= Fault::kWorkspace;
  more.fault_axis = -1;
  const auto next = marksOf(more, &faulted, synthetic::meta());
  ASSERT_EQ(next.size(), 1U);
  EXPECT_EQ(next[0].text, "workspace left") << "the other one was reported";
  EXPECT_EQ(next[0].axis, "");
}

TEST(RecordingMarks, NeutralEffort_IsMarkedOnce) {
  const TickRecord ramping = tick(SafetyState::kRendering, Fault::kNone, 1e-3);
  const TickRecord neutral = tick(SafetyState::kDisarmed, Fault::kNone, 0.0);
  EXPECT_EQ(kindsOf(neutral, &ramping), Kinds{"neutral"});
  EXPECT_EQ(kindsOf(neutral, &neutral), Kinds{});
}

}  // namespace
}  // namespace wholehand
