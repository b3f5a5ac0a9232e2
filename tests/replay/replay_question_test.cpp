#include "replay/replay_question.hpp"

#include <gtest/gtest.h>

#include <string>

namespace wholehand {
namespace {

using Kind = ReplayQuestion::Kind;

ReplayQuestion parsed(const std::string& text) {
  const auto question = parseReplayQuestion(text);
  EXPECT_TRUE(question) << text << ": " << format(question.errors());
  return question ? *question : ReplayQuestion{};
}

TEST(ReplayQuestion, EachKind_IsParsedAndWrittenBack) {
  EXPECT_EQ(parsed("about").what, Kind::kAbout);
  EXPECT_EQ(parsed("about?token=abc").what, Kind::kAbout);
  EXPECT_EQ(parsed("scene?").what, Kind::kScene);
  EXPECT_EQ(parsed("bodies?token=abc").what, Kind::kBodies);
  EXPECT_EQ(textOf(parsed("bodies?token=abc")), "bodies");
  const ReplayQuestion states = parsed("states?step=25&tick=7&token=abc&count=256");
  EXPECT_EQ(states.what, Kind::kStates);
  EXPECT_EQ(states.states.first, 7U);
  EXPECT_EQ(states.states.count, 256U);
  EXPECT_EQ(states.states.step, 25U);
  EXPECT_EQ(textOf(states), "states?tick=7&count=256&step=25");  // unknown parameters are dropped
  const ReplayQuestion series = parsed("series?from_s=0.1&to_s=60.1&columns=2000");
  EXPECT_EQ(series.what, Kind::kSeries);
  EXPECT_EQ(series.series.from_s, 0.1);
  EXPECT_EQ(series.series.columns, 2000);
  const ReplayQuestion again = parsed(textOf(series));
  EXPECT_EQ(again.series.from_s, series.series.from_s);  // bit-identical
  EXPECT_EQ(again.series.to_s, series.series.to_s);
}

TEST(ReplayQuestion, NumbersOutOfRange_AreRefusedWithTheirKey) {
  const std::pair<const char*, const char*> bad[] = {
      {"states?count=1&step=1", "tick"},
      {"states?tick=0&count=0&step=1", "count"},
      {"states?tick=0&count=257&step=1", "count"},
      {"states?tick=0&count=1&step=0", "step"},
      {"states?tick=-1&count=1&step=1", "tick"},
      {"states?tick=1.5&count=1&step=1", "tick"},
      {"states?tick=0x1&count=1&step=1", "tick"},
      {"states?tick=99999999999999999999&count=1&step=1", "tick"},
      {"series?from_s=0&to_s=1&columns=0", "columns"},
      {"series?from_s=0&to_s=1&columns=2001", "columns"},
      {"series?from_s=0&to_s=1", "columns"},
      {"series?from_s=2&to_s=1&columns=10", "to_s"},
      {"series?from_s=1&to_s=1&columns=10", "to_s"},
      {"series?from_s=0&to_s=3600&columns=10", "to_s"},  // a section of an hour is too long
      {"series?from_s=nan&to_s=1&columns=10", "from_s"},
      {"series?from_s=0&to_s=inf&columns=10", "to_s"},
      {"series?from_s=0&to_s=1e400&columns=10", "to_s"},
      {"series?from_s=0&to_s=1%20&columns=10", "to_s"},
  };
  for (const auto& [text, key] : bad) {
    const auto question = parseReplayQuestion(text);
    ASSERT_FALSE(question) << text;
    ASSERT_EQ(question.errors().size(), 1U) << text;
    EXPECT_EQ(question.errors().front().key, key) << text;
    EXPECT_NE(question.errors().front().remedy, "") << text;
  }
}

TEST(ReplayQuestion, EveryFault_IsReportedAtOnce) {
  const auto question = parseReplayQuestion("series?from_s=x");
  ASSERT_FALSE(question);
  EXPECT_EQ(question.errors().size(), 3U);
}

TEST(ReplayQuestion, UnknownQuestion_IsRefusedWithoutAKey) {
  for (const char* text : {"", "?", "abou", "about/", "states/0", "SCENE", "../about"}) {
    const auto question = parseReplayQuestion(text);
    ASSERT_FALSE(question) << text;
    EXPECT_EQ(question.errors().front().key, "") << text;
  }
}

}  // namespace
}  // namespace wholehand
