// A session on both clocks, in an analytic world: a mass on a rail against a rigid stop.
#include "loop/runtime/session.hpp"

#include "devices/one_axis.hpp"
#include "loop/control/adaptive_damping.hpp"
#include "loop/control/bilateral_coupling.hpp"
#include "loop/physics/analytic/analytic_world.hpp"
#include "loop/realtime/monotonic_clock.hpp"
#include "support/fault_injector.hpp"
#include "support/figure.hpp"
#include "support/seed.hpp"
#include "support/watched_main.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <thread>
#include <vector>

namespace wholehand::test {
namespace {

constexpr double kSessionPeriod_s = 1e-3;
constexpr double kAvatar_kg = 0.25;
constexpr int kRampTicks = 80;  // NeutralRampConfig::ramp_s

HandModel slider() {
  HandModel hand;
  hand.joint_count = hand.axis_count = 1;
  hand.joint_names = hand.axis_names = {"x"};
  HandLink link;
  link.type = JointType::kPrismatic;
  link.joint = 0;
  link.mass_kg = kAvatar_kg;
  link.inertia_kg_m2 = 1e-6 * Eigen::Matrix3d::Identity();
  hand.links = {link};
  hand.synergy = JointAxisMatrix::Ones(1, 1);
  hand.theta0 = JointPosition(1);
  hand.reference = AxisPosition(1);
  return hand;
}

AnalyticScene stopAt(double x_m) {
  AnalyticScene scene;
  scene.axes.resize(1);
  scene.axes[0].upper_stop = x_m;
  return scene;
}

/// A person whose 200 N/m pull 4 cm beyond a stop at 1 cm.
struct Rail {
  explicit Rail(const SessionConfig& session_config, std::vector<InjectedFault> faults = {},
                double fade_out_s = 0.0, double ramp_s = 0.08) {
    device_model.axes[0].damping = 6.0;
    device_model.axes[0].neutral_effort = 1.5;
    person.axes[0] = {"x", 0.5, 15.0, 200.0};
    device = std::make_unique<SimulatedDevice>(
        device_model, person,
        Intention::throughWaypoints({{0.0, AxisPosition(1, 0.0)}, {0.1, AxisPosition(1, 0.05)}}),
        kSessionPeriod_s);
    faulty = std::make_unique<FaultInjector>(*device, std::move(faults));
    RenderingConfig rendering;
    rendering.axes.resize(1);
    rendering.axes[0].k_pm = 1000.0;
    rendering.axes[0].k_dm = 10.0;
    const auto gains =
        resolveGains(rendering, AxisMatrix::Constant(1, 1, kAvatar_kg), kSessionPeriod_s);
    EXPECT_TRUE(gains) << format(gains.errors());
    RendererConfig config;
    config.gains = *gains;
    config.damping = makeAdaptiveDamping(device_model, rendering);
    config.safety.effort_limit = AxisEffort(1, 20.0);
    config.safety.neutral = device_model.neutral();
    config.safety.ramp.fade_out_s = fade_out_s;
    config.safety.ramp.ramp_s = ramp_s;
    config.live = LiveSettings(device_model, config.damping);
    config.moves_nobody = true;  // although everything is monitored
    renderer = std::make_unique<HapticRenderer>(*faulty, world, hand, SceneModel{}, config);
    EXPECT_TRUE(renderer->arm());
    session = std::make_unique<Session>(*renderer, session_config);
  }

  HandModel hand = slider();
  DeviceModel device_model = test::oneAxisDevice(0.8);
  PatientConfig person = test::nobody();
  AnalyticWorld world{hand, stopAt(0.01)};
  std::unique_ptr<SimulatedDevice> device;
  std::unique_ptr<FaultInjector> faulty;  ///< wraps the device; keeps the last effort written
  std::unique_ptr<HapticRenderer> renderer;
  std::unique_ptr<Session> session;
};

void startThread(Session& session) {
  seesRealTime();
  PeriodicThreadConfig thread;
  thread.period_ns = 1'000'000;
  const Expected<SetupReport> started = session.start(thread);
  ASSERT_TRUE(started) << format(started.errors());
}

/// Returns every record of a simulated run; `each` is called with every record as it comes.
std::vector<TickRecord> runAll(
    Rail& rail, const std::function<void(const TickRecord&)>& each = [](const TickRecord&) {}) {
  std::vector<TickRecord> records;
  rail.session->runSimulated([&](const TickRecord& r) {
    records.push_back(r);
    each(r);
  });
  return records;
}

/// Pops records until the session has ended and its queue is empty.
std::vector<TickRecord> drain(Session& session) {
  std::vector<TickRecord> records;
  TickRecord record;
  for (bool more = true; more;) {
    more = session.running();
    while (session.tryPop(record)) records.push_back(record);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return records;
}

TEST(SimulatedSession, GivenDuration_TicksEveryPeriodAndEndsAtNeutral) {
  SessionConfig config;
  config.duration_ticks = 1500;
  Rail rail(config);
  const std::vector<TickRecord> records = runAll(rail);
  volatile double tiny = std::numeric_limits<double>::min();
  tiny = tiny / 4.0;
  EXPECT_NE(tiny, 0.0) << "the arithmetic of the thread that runs it is as before";
  ASSERT_EQ(records.size(), 1500U + kRampTicks);
  for (std::size_t k = 0; k < records.size(); ++k) {
    ASSERT_EQ(records[k].tick, k);
    ASSERT_DOUBLE_EQ(records[k].time_s, static_cast<double>(k) * kSessionPeriod_s);
    ASSERT_EQ(records[k].elapsed_periods, 1U);
  }
  // At rest against the stop at 1 cm: the person's 200 N/m pull to 5 cm, the coupling's 1000 N/m
  // back to 1 cm.
  // back to 1 cm.
  const double rest_m = (200.0 * 0.05 + 1000.0 * 0.01) / 1200.0;
  EXPECT_NEAR(records[1499].q_m[0], rest_m, 1e-6);
  EXPECT_NEAR(records[1499].sent[0], 1.5 - 1000.0 * (rest_m - 0.01), 1e-3);
  EXPECT_EQ(records.back().sent[0], 1.5);
  EXPECT_EQ(records.back().authority, 0.0);
  EXPECT_EQ(rail.session->counters().ticks_run, records.size());
}

/// Index of the first record with that bit; -1: none.
int firstWith(const std::vector<TickRecord>& records, Fault bit) {
  for (std::size_t k = 0; k < records.size(); ++k) {
    if (any(records[k].faults & bit)) return static_cast<int>(k);
  }
  return -1;
}

// The loop stops by itself, from the tick after the request: the sink stands for every other thread
// and does nothing any more. The effort only falls, for the fade-out and the ramp's 80 ms:
// docs/safety.md.
TEST(SimulatedSession, GentleStopRequest_LetsGoWithoutOtherThreads) {
  Rail rail({}, {}, 0.35);
  const std::vector<TickRecord> records = runAll(rail, [&](const TickRecord& r) {
    if (r.tick == 99) rail.session->requestGentleStop();
    // The control client comes back too late.
    Command sign;
    sign.type = CommandType::kHolderAlive;
    sign.value = 1.0;
    if (r.tick == 150) {
      EXPECT_TRUE(rail.session->tryCommand(sign));
    }
    if (r.tick == 160) rail.session->setHolderAlive(true);
  });
  EXPECT_EQ(firstWith(records, Fault::kStopRequested), 100);
  EXPECT_EQ(firstWith(records, Fault::kGentleStop), 100);
  ASSERT_EQ(records.size(), 100U + 350U + kRampTicks);
  const double neutral = 1.5;
  const double at_stop = std::abs(records[99].sent[0] - neutral);
  for (std::size_t k = 100; k < records.size(); ++k) {
    const double u = static_cast<double>(k - 99) * kSessionPeriod_s / 0.43;
    ASSERT_LE(std::abs(records[k].sent[0] - neutral),
              at_stop * (1.0 - u * u * (3.0 - 2.0 * u)) + 1e-9)
        << k;
  }
  EXPECT_EQ(records.back().sent[0], neutral);
}

TEST(SimulatedSession, SignalBeforeAndWhileItRuns_StopsItGently) {
  for (const std::uint64_t at : {0U, 40U}) {
    Interrupts interrupts;
    SessionConfig config;
    config.interrupts = &interrupts;
    Rail rail(config);
    if (at == 0) interrupts.asked = 1;
    const std::vector<TickRecord> records = runAll(rail, [&](const TickRecord& r) {
      if (r.tick + 1 == at) interrupts.asked = 1;
    });
    EXPECT_EQ(firstWith(records, Fault::kStopRequested), static_cast<int>(at));
    EXPECT_EQ(records.size(), at + kRampTicks);
  }
}

/// A permit with a fixed verdict; counts how often it is judged.
class FixedPermit final : public StartPermit {
 public:
  explicit FixedPermit(bool holds) : holds_(holds) {}
  [[nodiscard]] bool judge() noexcept override {
    ++judged;
    return holds_;
  }
  int judged = 0;

 private:
  bool holds_;
};

TEST(SimulatedSession, PermitThatDoesNotHold_SendsTheNeutralEffortOnlyAndEnds) {
  for (const bool holds : {false, true}) {
    FixedPermit permit(holds);
    SessionConfig config;
    config.duration_ticks = 300;
    config.permit = &permit;
    Rail rail(config);
    const std::vector<TickRecord> records = runAll(rail);
    EXPECT_EQ(permit.judged, 1);
    EXPECT_EQ(firstWith(records, Fault::kStopRequested), holds ? 300 : 0);
    EXPECT_EQ(records.size(), (holds ? 300U : 0U) + kRampTicks);
    for (const TickRecord& record : records) {
      if (holds) break;
      ASSERT_EQ(record.sent[0], 1.5) << record.tick;
      ASSERT_EQ(record.authority, 0.0) << record.tick;
    }
    EXPECT_TRUE(rail.renderer->atNeutral());
  }
}

TEST(RealTimeSession, WhileItTicks_IsCountedAsARunningLoop) {
  Interrupts interrupts;
  SessionConfig config;
  config.interrupts = &interrupts;
  Rail rail(config);
  EXPECT_EQ(interrupts.loops, 0);
  startThread(*rail.session);
  EXPECT_EQ(interrupts.loops, 1);
  interrupts.asked = 1;
  rail.session->join();
  EXPECT_EQ(interrupts.loops, 0) << "the loop says so itself: nobody else may be there";
}

/// Holds the tick with this number until it is let go.
class HeldTick final : public TickListener {
 public:
  explicit HeldTick(std::uint64_t tick) : tick_(tick) {}
  void beforeTick(const TickRecord& record) noexcept override {
    if (record.tick < tick_ || let_go) return;
    held = true;
    while (!let_go) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  void afterTick(const TickRecord&) noexcept override {}

  std::atomic<bool> held{false}, let_go{false};

 private:
  std::uint64_t tick_;
};

TEST(RealTimeSession, LoopThatHangs_KeepsTheTimeOfItsLastTickAndObeysNoStop) {
  for (const std::uint64_t tick : {0U, 50U}) {
    Interrupts interrupts;
    HeldTick hangs(tick);
    SessionConfig config;
    config.listener = &hangs;
    config.interrupts = &interrupts;
    Rail rail(config);
    EXPECT_EQ(rail.session->word().ticked_ns, 0);
    const std::int64_t began_ns = monotonicNow_ns();
    startThread(*rail.session);
    while (!hangs.held) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const std::int64_t held_ns = monotonicNow_ns();
    rail.session->requestStop();
    rail.session->requestEmergencyStop();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const LoopWord word = rail.session->word();
    EXPECT_GE(word.ticked_ns, began_ns) << "a first tick that hangs has a time, too";
    EXPECT_LE(word.ticked_ns, held_ns);
    EXPECT_EQ(interrupts.ticked_ns, word.ticked_ns);
    EXPECT_EQ(word.stops, Fault::kNone);
    EXPECT_FALSE(word.at_neutral);
    EXPECT_FALSE(word.over);
    hangs.let_go = true;
    rail.session->join();
    EXPECT_GT(rail.session->word().ticked_ns, held_ns);
    EXPECT_TRUE(rail.session->word().over);
  }
}

// A stop is obeyed by a tick whose effort the device has taken, and only of the kind that the tick
// has seen.
TEST(RealTimeSession, Stop_IsObeyedByTheFirstTickWhoseEffortTheDeviceTakes) {
  Rail rail({}, {}, 100.0);  // a gentle stop that lasts
  startThread(*rail.session);
  const auto obeys = [&](Fault stop) {
    while (!any(rail.session->word().stops & stop)) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  };
  EXPECT_EQ(rail.session->word().stops, Fault::kNone);
  rail.session->requestGentleStop();
  obeys(Fault::kStopRequested);
  EXPECT_EQ(rail.session->word().stops, Fault::kStopRequested);
  EXPECT_FALSE(rail.session->word().at_neutral);
  rail.session->requestEmergencyStop();
  obeys(Fault::kEmergencyStop);
  rail.session->join();
  EXPECT_TRUE(rail.session->word().at_neutral);
}

TEST(RealTimeSession, DeviceThatRefusesEveryEffort_ObeysNothingAndIsNotAtNeutral) {
  Rail rail({}, {{InjectedKind::kWriteFails, 500, 1 << 30, 0}});  // pressed against the stop
  startThread(*rail.session);
  TickRecord record;
  while (!any(record.faults & Fault::kDeviceWrite)) {
    if (!rail.session->tryPop(record)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  rail.session->requestEmergencyStop();
  rail.session->join();  // after a second of refusals
  EXPECT_EQ(rail.session->word().stops, Fault::kNone);
  EXPECT_FALSE(rail.session->word().at_neutral);
}

TEST(SimulatedSession, SimulatedClock_HasNoTimeOfItsLastTick) {
  SessionConfig config;
  config.duration_ticks = 20;
  Rail rail(config);
  (void)runAll(rail);
  EXPECT_EQ(rail.session->word().ticked_ns, 0);
}

TEST(SimulatedSession, LostHolder_IsReportedEvenIfTheCommandQueueIsFull) {
  SessionConfig config;
  config.duration_ticks = 60;
  Rail rail(config);
  const std::vector<TickRecord> records = runAll(rail, [&](const TickRecord& r) {
    Command aim;
    aim.type = CommandType::kAction;
    while (rail.session->tryCommand(aim)) {
    }
    if (r.tick == 19) rail.session->setHolderAlive(false);
    if (r.tick == 39) rail.session->setHolderAlive(true);
  });
  for (std::size_t k = 0; k < records.size(); ++k) {
    ASSERT_EQ(any(records[k].faults & Fault::kHolderSilent), k >= 20 && k < 40) << k;
  }
}

void fillTheQueue(Session& session) {
  Command action;
  action.type = CommandType::kAction;
  while (session.tryCommand(action)) {
  }
}

// A limit that was accepted while the device was being enabled holds from the first tick, however
// many orders came before it.
TEST(SimulatedSession, ParametersSetBeforeTheFirstTick_AreInForceInIt) {
  SessionConfig config;
  config.queue_bytes = 0;  // the shortest
  Rail rail(config, {}, 0.0, kSessionPeriod_s);
  const std::vector<LiveParameter> parameters = rail.renderer->liveParameters();
  ASSERT_EQ(parameters.front().name, "effort_limit_arm_n");
  const auto ends = [&](const TickRecord& r) {
    if (r.tick == 0) rail.session->requestStop();
  };
  rail.session->runSimulated(ends);
  auto random = seededRandom(5801);
  const int drawn = fullCounts() ? 100'000 : cases(2000);
  for (int i = 0; i < drawn && !testing::Test::HasFailure(); ++i) {
    std::vector<double> expected;
    for (const LiveParameter& p : parameters) {
      expected.push_back(uniform(random, p.lower, p.upper));
    }
    rail.renderer->startParametersAt(expected);
    ASSERT_TRUE(rail.renderer->arm());
    rail.session = std::make_unique<Session>(*rail.renderer, config);
    for (auto orders = random() % 20; orders > 0; --orders) {
      const std::size_t p = random() % parameters.size();
      expected[p] = uniform(random, parameters[p].lower, parameters[p].upper);
      rail.session->setParameter(static_cast<int>(p), expected[p]);
    }
    if (random() % 2 == 0) fillTheQueue(*rail.session);
    rail.session->setHolderAlive(random() % 2 == 0);
    rail.session->runSimulated([&](const TickRecord& r) {
      if (r.tick != 0) return;
      for (std::size_t p = 0; p < expected.size(); ++p) {
        EXPECT_EQ(r.parameters[p], expected[p]) << parameters[p].name;
      }
      EXPECT_EQ(r.effort_limit[0], std::min(expected[0], 20.0));
      ends(r);
    });
  }
  figure("first ticks with the limits accepted last", drawn, "");
}

TEST(SimulatedSession, ParameterSetWhileItRuns_RampsEvenIfTheCommandQueueIsFull) {
  SessionConfig config;
  config.duration_ticks = 40;
  Rail rail(config);
  const LiveParameter limit = rail.renderer->liveParameters().front();
  const std::vector<TickRecord> records = runAll(rail, [&](const TickRecord& r) {
    fillTheQueue(*rail.session);
    rail.session->setParameter(-1, limit.lower);
    rail.session->setParameter(kMaxLiveParameters, limit.lower);
    if (r.tick == 9) rail.session->setParameter(0, limit.lower);
  });
  for (int k = 0; k < 40; ++k) {
    const double ramped_s = std::max(k - 9, 0) * kSessionPeriod_s;
    ASSERT_NEAR(records[k].parameters[0], limit.value - limit.rate_per_s * ramped_s, 1e-9) << k;
  }
}

TEST(RealTimeSession, GivenDuration_YieldsEveryRecordInOrder) {
  SessionConfig config;
  config.duration_ticks = 300;
  Rail rail(config);
  startThread(*rail.session);
  const std::vector<TickRecord> records = drain(*rail.session);
  rail.session->join();
  EXPECT_EQ(rail.session->droppedRecords(), 0U);
  const SessionCounters counters = rail.session->counters();
  ASSERT_EQ(records.size(), counters.ticks_run);
  EXPECT_EQ(records.back().tick + 1, counters.ticks_run + counters.skipped_periods);
  std::uint64_t periods = 0;
  for (std::size_t k = 0; k < records.size(); ++k) {
    const TickRecord& r = records[k];
    periods += r.elapsed_periods;
    // Skipped periods count: tick is the number of the period, including all missed ones.
    ASSERT_EQ(r.tick + 1, periods);
    ASSERT_EQ(any(r.faults & Fault::kLateTick), r.elapsed_periods > 1);
    ASSERT_EQ(r.faults & kStoppingFaults, Fault::kNone);
    ASSERT_GE(r.lateness_ns, 0);
    ASSERT_GE(r.wall_ns, 0);
  }
  EXPECT_GE(records.back().tick + 1, 300U);
  EXPECT_EQ(records.back().sent[0], 1.5);
}

TEST(RealTimeSession, ShortQueueWithoutReader_DropsCountsAndRunsOn) {
  SessionConfig config;
  config.duration_ticks = 600;
  config.queue_bytes = 0;  // the shortest
  Rail rail(config);
  startThread(*rail.session);
  rail.session->join();
  const std::uint64_t run = rail.session->counters().ticks_run;
  TickRecord record;
  std::uint64_t left = 0, last = 0;
  for (; rail.session->tryPop(record); ++left) last = record.tick;
  EXPECT_GT(left, 0U);
  EXPECT_EQ(rail.session->droppedRecords(), run - left);
  EXPECT_LT(last, 500U) << "the oldest are kept: what came later was dropped";
}

TEST(RealTimeSession, StopFromAnotherThread_EndsAtNeutral) {
  Rail rail({});  // no time limit
  startThread(*rail.session);
  std::thread other([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
    rail.session->requestStop();
  });
  const std::vector<TickRecord> records = drain(*rail.session);
  other.join();
  rail.session->join();
  EXPECT_FALSE(rail.session->running());
  ASSERT_FALSE(records.empty());
  EXPECT_TRUE(any(records.back().faults & Fault::kStopRequested));
  EXPECT_EQ(records.back().sent[0], 1.5) << kAlways;
  // The effort falls monotonically and is neutral within 100 ms, however late the ticks were.
  std::size_t first = 0;
  while (!any(records[first].faults & Fault::kStopRequested)) ++first;
  std::uint64_t ramp_periods = 0;
  for (std::size_t k = first; k < records.size(); ++k) {
    if (k > first) {
      ramp_periods += records[k].elapsed_periods;
      ASSERT_LE(records[k].authority, records[k - 1].authority) << kAlways;
    }
  }
  EXPECT_LE(ramp_periods - records.back().elapsed_periods, 100U) << kAlways;
}

TEST(RealTimeSession, DestroyedWhileItRuns_LeavesTheDeviceAtNeutral) {
  Rail rail({});  // no time limit
  startThread(*rail.session);
  TickRecord last;
  // Pressed against the stop, the device holds an effort far from its neutral one.
  for (int i = 0; i < 15'000 && !(last.tick > 200 && std::abs(last.sent[0] - 1.5) > 1.0); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    while (rail.session->tryPop(last)) {
    }
  }
  ASSERT_GT(std::abs(last.sent[0] - 1.5), 1.0);
  ASSERT_TRUE(rail.session->running());
  rail.session.reset();
  EXPECT_EQ(rail.faulty->written()[0], 1.5) << kAlways;
  EXPECT_TRUE(rail.renderer->atNeutral()) << kAlways;
}

TEST(Session, DestroyedBeforeItRan_LeavesTheRendererToTheNextSession) {
  SessionConfig config;
  config.duration_ticks = 20;
  Rail rail(config);
  rail.session = std::make_unique<Session>(*rail.renderer, config);
  rail.session->runSimulated([](const TickRecord&) {});
  EXPECT_EQ(rail.session->counters().ticks_run, 20U + kRampTicks);
}

TEST(RealTimeSession, FaultWhoseRecordsWereDropped_IsCountedWithEveryPeriod) {
  SessionConfig config;
  config.queue_bytes = 0;  // the shortest
  // arm() is the first read; the fault is in tick 500.
  Rail rail(config, {{InjectedKind::kReadFails, 501, 501, 0}});
  startThread(*rail.session);
  rail.session->join();
  std::uint64_t reported = 0;
  TickRecord record;
  while (rail.session->tryPop(record)) reported += any(record.faults & kStoppingFaults) ? 1 : 0;
  ASSERT_EQ(reported, 0U);  // no record contains it
  const SessionCounters c = rail.session->counters();
  EXPECT_EQ(c.latched, Fault::kDeviceRead);
  EXPECT_EQ(c.stopping_faults, 1U);
  EXPECT_EQ(c.faults[0], 1U);  // the device's read
  // 500 ticks, then the ramp of 80 periods; a skipped period replaces a tick of the ramp.
  EXPECT_GE(c.ticks_run + c.skipped_periods, 500U + kRampTicks);
  EXPECT_LE(c.ticks_run, 500U + kRampTicks) << kAlways;
}

// The device accepts no effort any more: the loop retries for a second beyond the ramp, then ends
// and does not report the device as neutral.
TEST(SimulatedSession, WritesRefusedForever_EndWithin1200msAndNotAtNeutral) {
  constexpr std::size_t kRefused = 600;  // pressed against the stop; arm() is the first read
  Rail rail({}, {{InjectedKind::kWriteFails, kRefused + 1, 1'000'000, 0}});
  const std::vector<TickRecord> records = runAll(rail);
  EXPECT_GT(records.size(), kRefused + 1000U);
  EXPECT_LE(records.size(), kRefused + 1200U);
  EXPECT_FALSE(rail.renderer->atNeutral());
  EXPECT_EQ(rail.session->counters().latched, Fault::kDeviceWrite);
  // The records hold the effort that the device holds and that acts on it.
  const double held = records[kRefused - 1].sent[0];
  EXPECT_GT(std::abs(held - 1.5), 1.0);
  for (std::size_t k = kRefused; k < records.size(); ++k) {
    ASSERT_EQ(records[k].sent[0], held) << k;
    ASSERT_TRUE(any(records[k].faults & Fault::kDeviceWrite)) << k;
    ASSERT_EQ(records[k].safety_state, SafetyState::kFaulted) << k;
  }
  EXPECT_EQ(rail.device->acting()[0], held);
}

// Gains that were checked at 1 kHz must not be rendered at 2 kHz: the session is refused and
// disarmed.
TEST(RealTimeSession, PeriodOtherThanTheRenderers_IsRefusedAndDisarms) {
  Rail rail({});
  PeriodicThreadConfig thread;
  thread.period_ns = 500'000;
  const Expected<SetupReport> started = rail.session->start(thread);
  ASSERT_FALSE(started);
  EXPECT_EQ(started.errors().front().key, "period_ns");
  EXPECT_FALSE(started.errors().front().remedy.empty());
  EXPECT_FALSE(rail.session->running());
  EXPECT_EQ(rail.session->counters().ticks_run, 0U);
  EXPECT_EQ(rail.renderer->safetyState(), SafetyState::kDisarmed);
  EXPECT_TRUE(rail.renderer->atNeutral());
}

TEST(RealTimeSession, RunWithoutLateTicks_GivesTheBitsOfTheSimulatedClock) {
  SessionConfig config;
  config.duration_ticks = 120;
  Rail real(config), simulated(config);
  startThread(*real.session);
  const std::vector<TickRecord> records = drain(*real.session);
  real.session->join();
  const std::vector<TickRecord> expected = runAll(simulated);
  // Compares up to the first late tick; from there on the inputs differ.
  std::size_t compared = 0;
  for (; compared < records.size() && records[compared].elapsed_periods == 1; ++compared) {
    ASSERT_EQ(std::memcmp(records[compared].sent.data(), expected[compared].sent.data(), 8), 0);
    ASSERT_EQ(std::memcmp(records[compared].q_s.data(), expected[compared].q_s.data(), 8), 0);
  }
  EXPECT_GE(compared, 1U);
}

}  // namespace
}  // namespace wholehand::test
