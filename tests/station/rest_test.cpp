// A rest is a gentle stop; its status says that nothing else has ended the session.
#include "station/station_bench.hpp"

#include <fstream>
#include <iterator>

namespace wholehand::test {
namespace {

class RestOfAPlayer : public Bar {
 protected:
  bool rested() { return station_->status().rested; }
};

TEST_F(RestOfAPlayer, RestWhileRendering_IsReportedUntilArmedAgain) {
  run(true);
  ASSERT_TRUE(rendersOn());
  EXPECT_FALSE(rested());
  ASSERT_TRUE(ask(orders::Rest{}).accepted);
  staysAt(RunState::kStopped);
  EXPECT_TRUE(rested()) << "the end of the session belongs to it";
  ASSERT_TRUE(ask(orders::Rest{}).accepted);
  EXPECT_TRUE(rested()) << "pressed twice";
  ASSERT_TRUE(ask(orders::Arm{}).accepted);
  ASSERT_TRUE(rendersOn());
  EXPECT_FALSE(rested());
}

TEST_F(RestOfAPlayer, RestFollowedByAStop_IsNotReportedAsARest) {
  for (const orders::Any& stop : kStops) {
    if (!thread_.joinable()) run(true);
    ASSERT_TRUE(rendersOn());
    ASSERT_TRUE(ask(orders::Rest{}).accepted);
    ASSERT_TRUE(ask(stop).accepted);
    EXPECT_FALSE(rested());
    staysAt(RunState::kStopped);
    EXPECT_FALSE(rested());
    ASSERT_TRUE(ask(orders::Rest{}).accepted);
    EXPECT_FALSE(rested()) << "a rest that comes after a stop does not undo it";
    ASSERT_TRUE(ask(orders::Arm{}).accepted);
  }
}

TEST_F(RestOfAPlayer, RestBeforeTheFirstArming_IsReportedAsBeforeTheStart) {
  run(false);
  ASSERT_TRUE(ask(orders::Rest{}).accepted);
  EXPECT_EQ(station_->status().run_state, RunState::kStopped);
  EXPECT_TRUE(rested());
  EXPECT_TRUE(station_->status().rest_before_start);
  ASSERT_TRUE(ask(orders::Rest{}).accepted);
  EXPECT_TRUE(station_->status().rest_before_start) << "pressed twice";
  ASSERT_TRUE(ask(orders::LoadExercise{.hand = "woman-p05-left"}).accepted);
  EXPECT_TRUE(rested()) << "nothing of the earlier person was begun";
  ASSERT_TRUE(ask(orders::Arm{}).accepted);
  ASSERT_TRUE(rendersOn());
  ASSERT_TRUE(ask(orders::Rest{}).accepted);
  EXPECT_TRUE(rested());
  EXPECT_FALSE(station_->status().rest_before_start);
}

// The loop stops for the load and would continue after it.
TEST_F(RestOfAPlayer, RestAtAnyMomentOfALoad_IsReportedAsARest) {
  run(true);
  ASSERT_TRUE(rendersOn());
  for (const auto after : {0ms, 30ms, 100ms, 200ms, 300ms, 400ms}) {
    auto loaded = askLater(Order{kLoadLevel2});
    std::this_thread::sleep_for(after);
    ASSERT_TRUE(ask(orders::Rest{}).accepted);
    (void)loaded.get();
    staysAt(RunState::kStopped);
    EXPECT_TRUE(rested()) << after.count() << " ms";
    ASSERT_TRUE(ask(orders::Arm{}).accepted);
    ASSERT_TRUE(rendersOn());
  }
}

// The console shows the limit of the next session, not that of the last one.
TEST_F(RestOfAPlayer, LimitSetDuringARest_IsShownAndAppliesToTheNextSession) {
  run(true);
  ASSERT_TRUE(rendersOn());
  ASSERT_TRUE(ask(orders::Rest{}).accepted);
  ASSERT_TRUE(becomes([&] { return station_->status().run_state == RunState::kStopped; }));
  const PublishedParameter first = station_->scene()->parameters.front();
  const orders::SetParameter limit{first.name, first.lower};
  ASSERT_TRUE(ask(limit).accepted);
  EXPECT_EQ(station_->status().parameters.front(), limit.value);
  ASSERT_TRUE(ask(orders::Arm{}).accepted);
  ASSERT_TRUE(rendersOn());
  EXPECT_EQ(station_->status().parameters.front(), limit.value);
}

class InALevel : public RestOfAPlayer {
 protected:
  double value(const std::string& name) {
    const auto scene = station_->scene();
    const auto& names = scene->value_names;
    const auto found = std::find(names.begin(), names.end(), name);
    TickRecord record;
    if (found == names.end() || !station_->latest(record)) return std::nan("");
    return record.exercise.values[found - names.begin()];
  }
};

/// An exercise whose only task is one squeeze.
class FinishedLevel : public InALevel {
 protected:
  void playToItsEnd() {
    std::ifstream in(kRoot + "/config/exercises/squeeze-to-level.toml");
    std::string text(std::istreambuf_iterator<char>(in), {});
    const auto bands = text.find("[[bands]]"), wall = text.find("[wall]");
    ASSERT_TRUE(bands != std::string::npos && wall != std::string::npos);
    text.replace(bands, wall - bands, "[[bands]]\nlow_n = 0.5\nhigh_n = 6.0\n\n");
    const auto replace = [&](const std::string& what, const std::string& by) {
      ASSERT_NE(text.find(what), std::string::npos) << what;
      text.replace(text.find(what), what.size(), by);
    };
    replace("hold_s = 2.0", "hold_s = 0.1");
    replace("../scenes/", kRoot + "/config/scenes/");
    replace("range = [0.0, 2.0]", "range = [0.0, 0.1]");
    replace("range = [0.0, 3.0]", "range = [0.0, 1.0]");
    const std::string file = folder_ + "/squeeze-once.toml";
    std::ofstream(file) << text;
    StationConfig config = barConfig();
    config.files.exercise = file;
    config.repeat_after = kRepeatAfter;
    load(config);
    const auto names = station_->scene()->event_names;
    const auto restarted = std::find(names.begin(), names.end(), "restarted") - names.begin();
    station_->addSink([this, restarted](const TickRecord& record) {
      for (int i = 0; i < record.exercise.event_count; ++i) {
        restarts_ += record.exercise.events[i].type == restarted ? 1 : 0;
      }
    });
    run(true);
    ASSERT_TRUE(becomes([&] { return value("done") == 1.0; }));
  }
  bool steer(Steering by) { return ask(orders::Steer{by}).accepted; }
  static constexpr auto kRepeatAfter = 1000ms;
  std::atomic<int> restarts_{0};
};

TEST_F(FinishedLevel, LevelThatNobodySteers_IsPlayedAgain) {
  playToItsEnd();
  EXPECT_TRUE(becomes([&] { return value("done") == 0.0; }));
}

// A person finishes a level, looks at the result and leaves.
TEST_F(FinishedLevel, LevelOfAPersonWhoLeaves_IsPlayedAgainByTheVirtualPatient) {
  playToItsEnd();
  ASSERT_TRUE(steer(Steering::kPerson));
  std::this_thread::sleep_for(2 * kRepeatAfter);
  EXPECT_EQ(value("done"), 1.0) << "a person's level was taken away";
  ASSERT_TRUE(steer(Steering::kVirtualPatient));
  EXPECT_TRUE(becomes([&] { return value("done") == 0.0; }));
}

// A level that a person restarted is not restarted again, neither under this person nor the next.
TEST_F(FinishedLevel, LevelRestartedByAPerson_IsNotRestartedAgain) {
  playToItsEnd();
  ASSERT_TRUE(steer(Steering::kPerson));
  ASSERT_TRUE(ask(orders::Action{Act::kRestart}).accepted);
  ASSERT_TRUE(becomes([&] { return value("done") == 0.0; }));
  ASSERT_TRUE(steer(Steering::kVirtualPatient));
  std::this_thread::sleep_for(2 * kRepeatAfter);
  EXPECT_EQ(restarts_, 1);
}

class RestInALevel : public InALevel {
 protected:
  /// Plays level 2, which has two drinks, until the virtual patient is at the second one.
  void playToTheSecondDrink() {
    StationConfig config = barConfig();
    config.files.level = 2;
    load(config);
    run(true);
    ASSERT_TRUE(becomes([&] { return value("drink") == 1.0; }));
  }
};

TEST_F(RestInALevel, ArmAfterARest_ContinuesTheDrinkAndAfterAStopRestartsTheLevel) {
  playToTheSecondDrink();
  ASSERT_TRUE(ask(orders::Rest{}).accepted);
  ASSERT_TRUE(becomes(RunState::kStopped));
  ASSERT_TRUE(ask(orders::Arm{}).accepted);
  ASSERT_TRUE(rendersOn());
  EXPECT_EQ(value("drink"), 1.0);
  EXPECT_EQ(value("step"), 0.0);
  ASSERT_TRUE(ask(orders::Stop{}).accepted);
  ASSERT_TRUE(becomes(RunState::kStopped));
  ASSERT_TRUE(ask(orders::Arm{}).accepted);
  ASSERT_TRUE(rendersOn());
  EXPECT_EQ(value("drink"), 0.0) << "after a stop a level begins at its start";
}

}  // namespace
}  // namespace wholehand::test
