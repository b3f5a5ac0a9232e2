// Messages about a commissioning, read back by flatc's own accessors, and a page's messages to it.
#include "station/server/client_words.hpp"
#include "station/server/sample_facts.hpp"
#include "station/server/wire.hpp"
#include "support/figure.hpp"

#include <gtest/gtest.h>

#include <string>

namespace wholehand {
namespace {

using namespace test::words;

TEST(WireCommissioning, FactsOfAFailedStep_AreReadBackUnchanged) {
  const wire::Bytes bytes = wire::commissioningMessage(test::sampleFailedStep());
  flatbuffers::Verifier verifier(bytes.data(), bytes.size());
  ASSERT_TRUE(fb::VerifyMessageBuffer(verifier));
  const fb::Commissioning* said = fb::GetMessage(bytes.data())->payload_as_Commissioning();
  ASSERT_NE(said, nullptr);
  EXPECT_EQ(said->device()->str(), "rail");
  EXPECT_EQ(said->question(), 7U);
  EXPECT_EQ(said->asked(), fb::QuestionKind::KnownForce);
  EXPECT_EQ(said->motion_state(), fb::MotionState::AwaitsKey);
  const fb::CommissioningStep* step = said->steps()->Get(0);
  EXPECT_EQ(step->state(), fb::StepState::Failed);
  EXPECT_EQ(step->problem()->str(), "x is too heavy");
  EXPECT_EQ(step->findings()->Get(0)->unit()->str(), "kg");
  EXPECT_EQ(step->findings()->Get(0)->upper(), 1.02);
}

TEST(WireCommissioning, AnswerAndHeldButton_AreDecodedAsOrdersWithTheirNumbers) {
  const auto answer = test::orThrow(
      wire::decode(command(3, [](Builder& b) { return fb::CreateAnswerDirect(b, 7, "0.122"); })));
  ASSERT_TRUE(answer.is<orders::Answer>());
  EXPECT_EQ(answer.as<orders::Answer>()->question, 7U);
  EXPECT_EQ(answer.as<orders::Answer>()->text, "0.122");
  EXPECT_FALSE(answer.stops());
  const auto hold = test::orThrow(
      wire::decode(command(4, [](Builder& b) { return fb::CreateHoldToMove(b, 9, true); })));
  ASSERT_TRUE(hold.is<orders::HoldToMove>());
  EXPECT_EQ(hold.as<orders::HoldToMove>()->press, 9U);
  EXPECT_TRUE(hold.as<orders::HoldToMove>()->held);
  EXPECT_TRUE(hold.streams()) << "comes by the hundred";
}

}  // namespace
}  // namespace wholehand
