// The station's decisions, as a value: every order of events to a bounded depth, all states that
// one and two clients reach, and long drawn lists. No thread, clock, file or device takes part; the
// test is the world around decide().
#include "station/decide_search.hpp"
#include "support/figure.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

namespace wholehand::test::decisions {
namespace {

void print(const Search& search) {
  figure("states", static_cast<double>(search.states), "");
  figure("events tried in them", static_cast<double>(search.steps), "");
  figure("events to the last state", search.depth, "");
}

// Expected: the laws of docs/safety.md, which World states one by one.
TEST(Decide, EveryOrderOfFewEvents_KeepsTheLaws) {
  const Search search = explore(allEvents(kClients), {}, {.depth = kReducedCounts ? 3 : 5});
  EXPECT_TRUE(search.verdicts.empty()) << search.example;
  print(search);
}

/// Events of clients that are explored until no new state is found.
struct Alphabet {
  const char* name;
  int clients;
  std::vector<Step> steps;
};

const std::vector<Step> kStarts{Step::kLook,   Step::kArm,           Step::kStop,
                                Step::kLeaves, Step::kTakesControls, Step::kFallsSilent};
const std::vector<Step> kPersons{Step::kLook,     Step::kArm,       Step::kStop,
                                 Step::kLoadHand, Step::kOpenVisit, Step::kCloseVisit};

/// The clients may do the same; one order waits beside the one that is under way.
void expectTheLaws(const Alphabet& alphabet) {
  const bool repeats =
      std::count(alphabet.steps.begin(), alphabet.steps.end(), Step::kRepeatStop) > 0;
  const Search search =
      explore(eventsOf(alphabet.clients, alphabet.steps), {.alike = true, .repeats = repeats},
              {.depth = kSanitized ? 5 : Bounds{}.depth});
  EXPECT_TRUE(search.verdicts.empty()) << search.example;
  EXPECT_TRUE(search.complete || kSanitized);
  print(search);
}

class DecideTogether : public testing::TestWithParam<Alphabet> {};

TEST_P(DecideTogether, AllStates_KeepTheLaws) {
  expectTheLaws(GetParam());
}

const auto kNamed = [](const auto& info) { return std::string(info.param.name); };

INSTANTIATE_TEST_SUITE_P(
    Of, DecideTogether,
    testing::Values(Alphabet{"starts", 2, kStarts},
                    Alphabet{"stops",
                             1,
                             {Step::kLook, Step::kArm, Step::kStop, Step::kRest,
                              Step::kEmergencyStop, Step::kRepeatStop}},
                    Alphabet{"limits",
                             1,
                             {Step::kLook, Step::kArm, Step::kLowerLimit, Step::kRaiseLimit,
                              Step::kGoesOn}},
                    Alphabet{"loads", 1, {Step::kLook, Step::kArm, Step::kStop, Step::kLoadHand}}),
    kNamed);

class DecideAmongTwo : public testing::TestWithParam<Alphabet> {};

TEST_P(DecideAmongTwo, AllStates_KeepTheLaws_slow) {
  expectTheLaws(GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    Of, DecideAmongTwo,
    testing::Values(Alphabet{"starts",
                             2,
                             {Step::kLook, Step::kArm, Step::kStop, Step::kRest, Step::kGoesOn,
                              Step::kLowerLimit, Step::kRaiseLimit, Step::kLeaves,
                              Step::kTakesControls, Step::kFallsSilent}},
                    Alphabet{"stops",
                             2,
                             {Step::kLook, Step::kArm, Step::kStop, Step::kRest,
                              Step::kEmergencyStop, Step::kRepeatStop, Step::kTakesControls}},
                    Alphabet{"persons", 2, kPersons}),
    kNamed);

TEST(Decide, ThreeClients_KeepTheLawsAsDeepAsAMinuteAllows_slow) {
  const Search search = explore(allEvents(kClients), {}, {.states = 8'000'000, .cpu_s = 60.0});
  EXPECT_TRUE(search.verdicts.empty()) << search.example;
  print(search);
}

// Taking states as equal hides nothing: without it the verdicts are the same.
TEST(Decide, StatesTakenAsEqual_GiveTheVerdictsOfAllStates) {
  for (const bool alike : {false, true}) {
    const WorldRules rules{.alike = alike};
    const int depth = kReducedCounts ? 3 : 4;
    const Search all = explore(allEvents(2), rules, {.depth = depth, .hashed = false});
    const Search hashed = explore(allEvents(2), rules, {.depth = depth});
    EXPECT_EQ(all.verdicts, hashed.verdicts);
    figure("states, none taken as equal", static_cast<double>(all.states), "");
    figure("states", static_cast<double>(hashed.states), "");
  }
}

TEST(Decide, LongDrawnLists_KeepTheLaws) {
  auto random = seededRandom(5801);
  const int lists = kSanitized ? 300 : kReducedCounts ? 2'000 : 1'000'000;
  const std::vector<Event> events = allEvents(kClients);
  std::size_t adopted = 0, steps = 0;
  for (int list = 0; list < lists; ++list) {
    World world({.rehearse = random() % 2 == 0});
    std::string path;
    for (int i = 0; i < 60; ++i) {
      // Work goes on in every second event, or little would ever start.
      Event event = events[random() % events.size()];
      if (random() % 2 == 0) event = {world.state().under_way ? Step::kWorkDone : Step::kTurn, 0};
      if (event.step == Step::kLeaves && random() % 4 != 0) continue;
      if (event.step == Step::kArm && random() % 2 == 0) {
        (void)world.happens({Step::kLook, event.client});
      }
      if (!world.happens(event)) continue;
      ++steps;
      path += nameOf(event) + ", ";
      adopted += world.adopted() ? 1 : 0;
      ASSERT_EQ(world.broken(), "") << path;
    }
  }
  EXPECT_GT(adopted, static_cast<std::size_t>(lists) / 4);
  figure("events", static_cast<double>(steps), "");
  figure("sessions among them", static_cast<double>(adopted), "");
}

// Pressers who stay do start, whatever the others' orders to look, rest before, or load.
TEST(Decide, PresserWhoStays_Starts) {
  auto random = seededRandom(5802);
  const int draws = kReducedCounts ? 2'000 : 100'000;
  int started = 0;
  for (int draw = 0; draw < draws; ++draw) {
    World world({.rehearse = random() % 2 == 0});
    const int presser = static_cast<int>(random() % kClients);
    for (unsigned i = random() % 8; i > 0; --i) {  // whatever came before
      const std::vector<Event> events = allEvents(kClients);
      const Event event = events[random() % events.size()];
      if (event.step == Step::kLeaves) continue;
      (void)world.happens(event);
    }
    const auto settle = [&] {
      for (int i = 0; i < 60; ++i) {
        if (!world.happens({Step::kWorkDone, 0}) && !world.happens({Step::kTurn, 0}) &&
            (!world.state().live || !world.happens({Step::kPasses, 0}))) {
          break;
        }
      }
    };
    (void)world.happens({Step::kStop, 1});
    settle();
    ASSERT_FALSE(world.state().live);
    if (random() % 2 == 0) (void)world.happens({Step::kTakesControls, presser});
    if (world.lostControls(presser)) (void)world.happens({Step::kTakesControls, presser});
    (void)world.happens({Step::kLook, presser});
    (void)world.happens({Step::kArm, presser});
    const bool was_queued = world.unanswered() == 1;
    for (int i = 0; i < 30 && world.unanswered() > 0; ++i) {
      if (random() % 8 == 0) (void)world.happens({Step::kLook, static_cast<int>(random() % 3)});
      if (random() % 8 == 0) (void)world.happens({Step::kPasses, 0});
      if (!world.happens({Step::kTurn, 0})) (void)world.happens({Step::kWorkDone, 0});
      ASSERT_EQ(world.broken(), "");
    }
    const bool began =
        was_queued && world.lastReply().accepted && world.state().run_state == RunState::kRendering;
    started += began ? 1 : 0;
    ASSERT_TRUE(began) << world.lastReply().reason;
  }
  EXPECT_EQ(started, draws);
  figure("pressers who stayed", draws, "");
  figure("of them started", started, "");
}

}  // namespace
}  // namespace wholehand::test::decisions
