// Complete commissioning with a scripted operator, a fake device and a simulated clock.
#include "devices/commissioning/commissioning.hpp"

#include "devices/plugin/plugin_device.hpp"
#include "fake_device.hpp"
#include "files/device/device_file.hpp"
#include "passport_file.hpp"
#include "support/contains.hpp"
#include "support/seed.hpp"

#include <memory>

namespace wholehand::test {
namespace {

using Step = CommissioningStep;

const Motion kAnyMotion{MotionKind::kPush, "test", "", 0.0};

/// A device, an operator and their bench, with a temporary folder for the files.
struct Session {
  explicit Session(const std::string& file, InjectedFaults injected = {})
      : path(folder.file("mine.toml")),
        model(load(file, path)),
        device(model, std::move(injected)) {}

  void begin() {
    bench.emplace(orThrow(Bench::make(device, model, person, device, 1e-3)));
    CommissioningPlan plan;
    plan.operator_name = "Test";
    plan.now = [] {
      return PlaceTime{std::chrono::sys_days(std::chrono::year(2026) / 11 / 21), {}};
    };
    plan.write = [](const std::string& to, const std::string& text) -> Expected<Done> {
      writeFile(to, text);
      return Done{};
    };
    plan.draw = [this](const ChartPage& page, const std::string& to) { return draw(page, to); };
    commissioning.emplace(*bench, plan);
  }
  Expected<Done> upTo(Step last) {
    if (!commissioning) begin();
    for (int i = 0; i <= static_cast<int>(last); ++i) {
      if (commissioning->done(static_cast<Step>(i))) continue;
      if (auto done = commissioning->carryOut(static_cast<Step>(i)); !done) return done;
    }
    return Done{};
  }
  static DeviceModel load(const std::string& file, const std::string& to) {
    std::filesystem::copy_file(WHOLEHAND_SOURCE_DIR "/config/devices/" + file + ".toml", to);
    return orThrow(loadDeviceFile(to));
  }

  Expected<Done> draw(const ChartPage& page, const std::string& to) {
    if (!can_draw) return fileFault(to, "the pages are not built", "build them");
    drawn = chartPageJson(page);
    drawn_to = to;
    return Done{};
  }

  Folder folder;
  std::string path;
  bool can_draw = true;
  nlohmann::json drawn;
  std::string drawn_to;
  DeviceModel model;
  FakeDevice device;
  ScriptedOperator person{device, model};
  std::optional<Bench> bench;
  std::optional<Commissioning> commissioning;
};

std::string said(const Expected<Done>& done) {
  return done.ok() ? "" : format(done.errors());
}

TEST(Commissioning, SixAxes_TakeSixMinutesAnd26ActionsAndClearTheDevice) {
  Session s("lambda-pride");
  const auto gentle = s.upTo(Step::kRangeStops);
  ASSERT_TRUE(gentle.ok()) << said(gentle) << s.person.said;
  EXPECT_LE(s.bench->largestShare(), 0.2 + 1e-12);
  const auto done = s.upTo(Step::kPassport);
  ASSERT_TRUE(done.ok()) << said(done) << s.person.said;
  const double time_s = static_cast<double>(s.device.now_ns()) * 1e-9;
  // Steps without a question start with the key: home, gravity and mass, watchdog, range stops,
  // effort limit.
  const int actions = s.person.actions + 5;
  figure("six axes commissioned in", time_s, "s");
  figure("six axes commissioned with", actions, "actions");
  figure("largest effort, of the limit", 100.0 * s.bench->largestShare(), "%");
  EXPECT_LE(time_s, 360.0);
  EXPECT_LE(actions, 26);
  EXPECT_NEAR(s.bench->largestShare(), 1.0, 0.02) << "the climb reaches the limit";
  const Passport passport = orThrow(readPassport(s.commissioning->path()));
  EXPECT_EQ(s.drawn_to, s.folder.file("mine.F-1.passport.html"));
  EXPECT_EQ(s.drawn["tables"].size(), s.model.axes.size());
  for (std::size_t i = 0; i < s.model.axes.size(); ++i) {
    const DeviceAxis& truth = s.model.axes[i];  // the fake device has the figures of its file
    EXPECT_TRUE(passport.axes[i].mass.contains(truth.mass)) << truth.name;
    EXPECT_TRUE(passport.axes[i].damping.contains(truth.damping)) << truth.name;
    EXPECT_TRUE(passport.axes[i].coulomb.contains(truth.coulomb)) << truth.name;
  }

  const PlaceTime day = passport.measured_at;
  EXPECT_FALSE(checkArmingPermit(s.device.identity(), s.model, passport.rate_hz, day).ok())
      << "not checked today";
  const auto checked = s.commissioning->checkToday();
  ASSERT_TRUE(checked.ok()) << said(checked);
  EXPECT_TRUE(checkArmingPermit(s.device.identity(), s.model, passport.rate_hz, day).ok());
}

TEST(Commissioning, WithoutBuiltPages_WritesThePassportAndReportsTheMissingChart) {
  Session s("desktop-3axis");
  s.can_draw = false;
  const auto done = s.upTo(Step::kPassport);
  ASSERT_TRUE(done.ok()) << said(done) << s.person.said;
  EXPECT_TRUE(readPassport(s.commissioning->path()).ok());
  EXPECT_TRUE(contains(s.person.said, "not drawn: "));
}

TEST(Commissioning, StepsOutOfOrder_AreRefusedByName) {
  Session s("desktop-3axis");
  s.begin();
  for (int i = 1; i < kCommissioningSteps; ++i) {
    const auto step = static_cast<Step>(i);
    const std::string why = said(s.commissioning->carryOut(step));
    EXPECT_TRUE(contains(why, "needs the step identify first"));
    EXPECT_TRUE(contains(why, stepName(step)));
  }
  EXPECT_EQ(s.bench->largestShare(), 0.0) << "nothing moved";
}

TEST(Commissioning, PersonAttached_MovesNothing) {
  Session s("desktop-3axis");
  s.person.nobody = false;
  EXPECT_TRUE(contains(said(s.upTo(Step::kSigns)), "somebody is attached"));
  EXPECT_EQ(s.bench->largestShare(), 0.0);
  EXPECT_TRUE(
      contains(said(s.bench->move(kAnyMotion, [](Bench::Now&) -> Expected<bool> { return true; })),
               "nobody is attached"));
}

TEST(Commissioning, ReleasedKey_EndsTheMoveAtNeutralAndTheStepCanBeRepeated) {
  Session s("desktop-3axis");
  ASSERT_TRUE(s.upTo(Step::kGravity).ok());
  s.person.lets_go_after = s.person.looks + 5000;
  const std::string why = said(s.commissioning->carryOut(Step::kMassFrictionDelay));
  EXPECT_TRUE(contains(why, "the key was let go; repeat the step"));
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(s.bench->sent(i), 0.0) << "neutral";
  EXPECT_FALSE(s.commissioning->done(Step::kMassFrictionDelay));
  EXPECT_TRUE(contains(said(s.commissioning->carryOut(Step::kKnownWeight)), "mass-friction-delay"));
  s.person.lets_go_after = 1L << 60;
  EXPECT_TRUE(s.commissioning->carryOut(Step::kMassFrictionDelay).ok());
}

TEST(Commissioning, LateMachineWhileMeasuring_IsReportedAndTheStepCanBeRepeated) {
  Session s("desktop-3axis");
  ASSERT_TRUE(s.upTo(Step::kGravity).ok());
  s.person.on_look = [&] {
    if (s.person.looks % 1000 == 0) s.device.late_ns = 8'000'000;
  };
  const std::string why = said(s.commissioning->carryOut(Step::kMassFrictionDelay));
  EXPECT_TRUE(contains(why, "by a machine that was late"));
  EXPECT_TRUE(contains(why, "axes = x"));
  s.person.on_look = nullptr;
  EXPECT_TRUE(s.commissioning->carryOut(Step::kMassFrictionDelay).ok());
}

// A stall of the machine must not be taken for a motion of the device: the move is the same, only a
// sample comes late.
TEST(Commissioning, StalledMachineDuringAMove_IsNotReportedAsARunaway) {
  std::mt19937_64 random = seededRandom(436);
  for (int run = 0; run < cases(20); ++run) {
    Session s("desktop-3axis");
    s.begin();
    s.bench->confirmNobodyAttached(true);
    const int stall_ticks = static_cast<int>(random() % 60);
    const auto at = static_cast<long>(100 + random() % 200);
    bool stalled = false;
    s.person.on_look =
        [&] {  // the device continues without the program; its watchdog reacts after 20 ms
          if (s.person.looks < at || std::exchange(stalled, true)) return;
          for (int i = 0; i < stall_ticks; ++i) s.device.waitForTick();
        };
    // Moves to and fro at a third of the speed limit or more.
    const double effort = 0.2 * s.model.axes[0].effort_limit;
    double fastest = 0.0;
    const auto moved = s.bench->move(kAnyMotion, [&](Bench::Now& now) -> Expected<bool> {
      now.effort[0] = now.position[0] < 0.0 ? effort : -effort;
      fastest = std::max(fastest, std::abs(s.device.mechanism.speed(0)));
      return now.time_s < 0.5;
    });
    ASSERT_LT(fastest, s.model.axes[0].speed_limit);
    const std::string why = said(moved);
    EXPECT_FALSE(contains(why, "runs away") || contains(why, "jumps"))
        << stall_ticks << " ms: " << why;
    if (stall_ticks < 18) EXPECT_EQ(why, "") << stall_ticks;
    if (stall_ticks > 21) EXPECT_NE(why, "") << stall_ticks;
    if (!why.empty()) EXPECT_TRUE(contains(why, "its watchdog let go; this program was silent"));
  }
}

TEST(Commissioning, SamplesWithWrongTimes_EndTheMoveWithTheRightReason) {
  struct Mistake {
    const char* what;
    std::int64_t (*shown)(std::int64_t taken_ns);
    const char* expected;
  };
  const Mistake all[] = {
      {"frozen", [](std::int64_t) -> std::int64_t { return 1'000'000; }, "ms old when they come"},
      {"an hour ahead", [](std::int64_t t) { return t + 3'600'000'000'000; }, "in the future"},
      {"old", [](std::int64_t t) { return t - 250'000'000; }, "ms old when they come"}};
  for (const Mistake& wrong : all) {
    Session s("desktop-3axis");
    s.begin();
    s.bench->confirmNobodyAttached(true);
    s.device.shown_ns = wrong.shown;
    long ticks = 0;
    const auto moved = s.bench->move(kAnyMotion, [&](Bench::Now& now) -> Expected<bool> {
      ++ticks;
      now.effort[0] = s.bench->limit(0);
      return true;
    });
    EXPECT_TRUE(contains(said(moved), wrong.expected)) << wrong.what << ": " << said(moved);
    EXPECT_LE(static_cast<double>(ticks) * 1e-3, longestStill_s(s.model) + 2e-3) << wrong.what;
    EXPECT_FALSE(s.device.enabled());
  }
}

TEST(Commissioning, DriverThatCannotDropItsWatchdog_IsTestedBySilence) {
  InjectedFaults injected;
  injected.cannot_drop = true;
  Session s("desktop-3axis", injected);
  EXPECT_EQ(said(s.upTo(Step::kWatchdog)), "");
}

TEST(Commissioning, RepeatedStep_InvalidatesThePassport) {
  Session s("desktop-3axis");
  ASSERT_TRUE(s.upTo(Step::kPassport).ok()) << s.person.said;
  ASSERT_TRUE(s.commissioning->carryOut(Step::kWatchdog).ok());
  EXPECT_FALSE(s.commissioning->done(Step::kPassport));
  EXPECT_EQ(s.commissioning->next(), Step::kPassport);
}

struct Fault {
  const char* what;
  InjectedFaults injected;
  const char* expected;
};

TEST(FaultyDevice, EveryKindOfFault_IsNamedWithAtMostAFifthOfTheLimit) {
  const auto on = [](const char* axis) {
    InjectedFaults s;
    s.axis = axis;
    return s;
  };
  std::vector<Fault> faults;
  for (const char* axis : {"x", "y", "z"}) {
    InjectedFaults s = on(axis);
    s.encoder_sign = true;
    faults.push_back({"encoder sign", s, "its encoder has the wrong sign"});
    s = on(axis);
    s.motor_sign = true;
    faults.push_back({"motor sign", s, "its motor has the wrong sign"});
    for (const double scale : {2.0, 0.5}) {
      s = on(axis);
      s.scale = scale;
      faults.push_back({"scale", s, scale > 1.0 ? "2 times" : "0.5 times"});
    }
    s = on(axis);
    s.wraps = true;
    faults.push_back({"wrapped encoder", s, "its encoder wraps round"});
    for (const double scale : {2.0, 0.5}) {
      s = on(axis);
      s.effort_scale = scale;
      faults.push_back({"torque constant", s, "times what they are called"});
    }
    s = on(axis);
    s.swapped_with = axis == std::string("x") ? "z" : "x";
    faults.push_back({"swapped", s, "their motors are swapped"});
    s = on(axis);
    s.encoder_of = axis == std::string("x") ? "z" : "x";
    faults.push_back({"swapped encoders", s, "their positions are swapped"});
    for (const double off : {0.1, -0.1}) {
      s = on(axis);
      s.homed_off = off;
      faults.push_back({"homed elsewhere", s, "homed elsewhere than where it stands"});
    }
  }
  // A hidden weight moves the axis as its motor should. Only x: the other axes would fall while x
  // is pushed.
  for (const double weight : {0.1, -0.1}) {
    InjectedFaults s = on("x");
    s.motor_sign = true;
    s.hidden_weight = weight;
    faults.push_back({"motor sign behind a weight", s, "its motor has the wrong sign"});
  }
  InjectedFaults s;
  s.no_watchdog = true;
  faults.push_back({"watchdog", s, "watchdog did not let go"});
  s.cannot_drop = true;  // the step then tests the watchdog by silence
  faults.push_back({"watchdog", s, "watchdog did not let go"});
  s = {};
  s.deaf_home = true;
  faults.push_back({"homing", s, "did not be homed"});
  s = {};
  s.no_stop_button = true;
  faults.push_back({"stop button", s, "the emergency stop does not cut it off"});
  std::size_t index = 0;
  for (const Fault& fault : faults) {
    if (leftOutUnderASanitizer(index++)) continue;
    Session session("desktop-3axis", fault.injected);
    session.begin();
    const std::string why = said(session.upTo(Step::kPassport));
    EXPECT_TRUE(contains(why, fault.expected))
        << fault.what << " of " << fault.injected.axis << ": " << why;
    EXPECT_LE(session.bench->largestShare(), 0.2 + 1e-12) << fault.what;
    EXPECT_FALSE(std::filesystem::exists(session.commissioning->path())) << fault.what;
  }
}

TEST(Commissioning, CoupledAxes_AreRefusedWithARemedy) {
  Session s("desktop-3axis");
  s.device.mechanism.cross_inertia = 0.3;
  const std::string why = said(s.upTo(Step::kMassFrictionDelay));
  EXPECT_TRUE(contains(why, "along"));
  EXPECT_TRUE(contains(why, "decouple the axes"));
}

TEST(Commissioning, DeviceWithoutSerialNumber_IsRefused) {
  InjectedFaults injected;
  injected.anonymous = true;
  Session s("desktop-3axis", injected);
  EXPECT_TRUE(contains(said(s.upTo(Step::kIdentify)), "no serial number"));
}

TEST(Commissioning, FrozenSamplesInMotion_EndTheMoveAtNeutral) {
  Session s("desktop-3axis");
  ASSERT_TRUE(s.upTo(Step::kGravity).ok());
  // The default is 20 ms (plugin_device.hpp); desktop-3axis states its own value.
  const auto most = static_cast<int>(longestStill_s(s.model) / 1e-3);
  int after = 0;
  const auto done = s.bench->move(kAnyMotion, [&](Bench::Now& now) -> Expected<bool> {
    s.device.frozen = now.time_s > 0.1;
    if (s.device.frozen) ++after;
    now.effort[0] = 1.0;
    return now.time_s < 2.0;
  });
  EXPECT_TRUE(contains(said(done), "samples stand still"));
  EXPECT_LE(after, most + 2);
  EXPECT_EQ(s.bench->sent(0), 0.0) << "neutral";
}

TEST(Commissioning, HomeRepeatedWithAPersonAttached_ForbidsEveryMove) {
  Session s("desktop-3axis");
  ASSERT_TRUE(s.upTo(Step::kSigns).ok());
  s.person.nobody = false;
  EXPECT_FALSE(s.commissioning->carryOut(Step::kHome).ok());
  const auto look = [](int, const wh_sample&) { return Bench::SampleUse::kOver; };
  for (const std::string& why :
       {said(s.bench->move(kAnyMotion, [](Bench::Now&) -> Expected<bool> { return false; })),
        said(s.bench->move(kAnyMotion, look, [](Bench::Now&) -> Expected<bool> { return true; })),
        format(s.bench->dropWatchdog(0.1).errors())}) {
    EXPECT_TRUE(contains(why, "nobody is attached"));
  }
}

TEST(Commissioning, OperatorWhoGaveUp_EndsTheWaitForTheKey) {
  Session s("desktop-3axis");
  ASSERT_TRUE(s.upTo(Step::kGravity).ok());
  s.person.gave_up = true;
  s.person.lets_go_after = 0;
  const std::int64_t began_ns = s.device.now_ns();
  EXPECT_TRUE(contains(said(s.commissioning->carryOut(Step::kGravity)), "gave up"));
  EXPECT_LE(s.device.now_ns() - began_ns, 2'000'000) << "two ticks";
}

TEST(EmergencyStop, ReleaseByTheWatchdog_IsNotTakenForAPressedStop) {
  InjectedFaults injected;
  injected.stop_says_silenced = true;
  Session s("desktop-3axis", injected);
  ASSERT_TRUE(s.upTo(Step::kWatchdog).ok());
  s.person.presses_stop = false;
  s.person.late_ticks = 50;  // the watchdog reacts after 20
  const std::string why = said(s.commissioning->carryOut(Step::kEmergencyStop));
  EXPECT_TRUE(contains(why, "its watchdog let go first"));
  s.person.late_ticks = 0;
  s.person.presses_stop = true;
  EXPECT_EQ(said(s.commissioning->carryOut(Step::kEmergencyStop)), "");
}

// The status bits are not trusted: each axis is pushed and must not move.
TEST(LastResorts, StatusBitsWithoutEffect_AreRefusedByTheMotionOfEachAxis) {
  std::vector<std::pair<Step, std::string>> cases;
  for (const Step step : {Step::kWatchdog, Step::kEmergencyStop}) {
    for (const char* axis : {"x", "y", "z"}) cases.emplace_back(step, axis);
  }
  for (const auto& [step, axis] : sampleTenth(cases)) {
    InjectedFaults injected;
    injected.axis = axis;
    injected.watchdog_bit = step == Step::kWatchdog;
    injected.stop_bit = step == Step::kEmergencyStop;
    Session s("desktop-3axis", injected);
    ASSERT_EQ(said(s.upTo(static_cast<Step>(static_cast<int>(step) - 1))), "");
    const std::string why = said(s.commissioning->carryOut(step));
    EXPECT_TRUE(contains(why, axis));
    EXPECT_TRUE(contains(why, "is still pushed")) << stepName(step) << " " << axis;
    EXPECT_FALSE(s.device.enabled());
    EXPECT_LE(s.bench->largestShare(), 0.2 + 1e-12);
  }
}

// The device's own speed limit applies at the neutral effort, too.
TEST(RunawayDevice, RunawayInAWatchdogOrStopTest_IsDisabledAtItsSpeedLimit) {
  constexpr double kRuns_m_s2 = 60.0;
  for (const Step step : {Step::kWatchdog, Step::kEmergencyStop}) {
    InjectedFaults injected;
    injected.no_watchdog = step == Step::kWatchdog;  // otherwise the watchdog would let go first
    Session s("desktop-3axis", injected);
    ASSERT_EQ(said(s.upTo(static_cast<Step>(static_cast<int>(step) - 1))), "");
    double fastest = 0.0;
    s.device.on_tick = [&] {
      s.device.mechanism.pushed[0] = s.device.enabled() ? kRuns_m_s2 * s.model.axes[0].mass : 0.0;
      if (s.device.enabled()) fastest = std::max(fastest, std::abs(s.device.mechanism.speed(0)));
    };
    EXPECT_TRUE(contains(said(s.commissioning->carryOut(step)), "runs away")) << stepName(step);
    EXPECT_FALSE(s.device.enabled());
    // The speed is judged by its mean over 10 ms, and the ramp takes 20 ms.
    EXPECT_LE(fastest, s.model.axes[0].speed_limit + kRuns_m_s2 * (0.005 + 0.025))
        << stepName(step);
  }
}

TEST(Watchdog, DeviceCutOffByItsStop_DoesNotPassTheWatchdogTest) {
  Session s("desktop-3axis");
  ASSERT_TRUE(s.upTo(Step::kKnownWeight).ok());
  s.person.on_look = [&s] {
    s.device.stop_pressed = true;
  };  // after the key is pressed and before the silence
  EXPECT_NE(said(s.commissioning->carryOut(Step::kWatchdog)), "");
  EXPECT_FALSE(s.commissioning->done(Step::kWatchdog));
}

TEST(DailyCheck, DeviceOffItsMark_IsRefused) {
  Session s("desktop-3axis");
  ASSERT_TRUE(s.upTo(Step::kPassport).ok());
  s.person.off_mark = 0.005;
  const std::string why = said(s.commissioning->checkToday());
  EXPECT_TRUE(contains(why, "off its mark"));
}

}  // namespace
}  // namespace wholehand::test
