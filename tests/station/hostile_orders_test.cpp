// Orders in unexpected states, with impossible numbers, and from clients that left. The station
// must stay safe and serve the next client. These tests run in real time.
#include "station/server/client_words.hpp"
#include "station/station_bench.hpp"
#include "support/seed.hpp"

#include <condition_variable>
#include <functional>

namespace wholehand::test {
namespace {

class HostileOrders : public Bar {
 protected:
  std::atomic<int> refused_count_{0}, answered_{0};
  double alpha() {
    TickRecord record;
    return station_->latest(record) ? record.exercise.alpha : 0.0;
  }
};

// The log can block: a terminal is stopped (Ctrl-S), or nobody reads the pipe.
TEST_F(HostileOrders, BlockedLog_DelaysNoStop) {
  std::mutex mutex;
  std::condition_variable released;
  bool stands_still = true;
  StationConfig config = barConfig();
  config.log = [&](const std::string&) {
    std::unique_lock lock(mutex);
    released.wait(lock, [&] { return !stands_still; });
  };
  // However the test ends, the log no longer waits and no longer refers to local variables.
  const std::function<void()> end = [&] {
    {
      const std::lock_guard lock(mutex);
      stands_still = false;
    }
    released.notify_all();
    (void)quit();
    station_.reset();
  };
  struct AtEnd {
    const std::function<void()>& run;
    ~AtEnd() { run(); }
  } at_end{end};
  load(config);
  run(false);
  for (const orders::Any& stop : kStops) {
    later(orders::Arm{});
    ASSERT_TRUE(squeezes());
    ASSERT_TRUE(ask(stop).accepted);
    ASSERT_TRUE(becomes(RunState::kStopped));
    TickRecord record;
    ASSERT_TRUE(station_->latest(record));
    EXPECT_LT(largest(record.sent), 1e-3)
        << kAlways;  // if the last record was dropped, this is the one before
  }
}

TEST_F(HostileOrders, FloodOfLoads_IsRefusedAndTheNextPersonArms) {
  run(false);
  const Order load = of(kLoadLevel2);
  for (int i = 0; i < 1000; ++i) {
    station_->order(load, [this](const OrderReply& reply) {
      ++answered_;
      if (reply.refusal == Refusal::kTooMany) ++refused_count_;
    });
  }
  EXPECT_GE(refused_count_, 980) << "each takes a second: a thousand would keep everybody waiting";
  ASSERT_TRUE(ask(orders::EmergencyStop{}).accepted);
  ASSERT_TRUE(becomes([&] { return answered_ == 1000; }));
  EXPECT_TRUE(ask(orders::Arm{}).accepted);
  EXPECT_TRUE(rendersOn());
}

// Two servers act for two holders. The order that the first holder vanished arrives after the
// second holder took the controls.
TEST_F(HostileOrders, OrderOfAFormerHolder_ChangesNothingExceptAStop) {
  run(true);
  ASSERT_TRUE(squeezes());
  ASSERT_TRUE(ask(of(orders::HolderAlive{true}, 2)).accepted);
  EXPECT_EQ(ask(of(orders::HolderAlive{false}, 1)).refusal, Refusal::kNotHolder);
  EXPECT_EQ(ask(of(orders::Steer{Steering::kPerson}, 1)).refusal, Refusal::kNotHolder);
  EXPECT_EQ(ask(of(orders::LoadExercise{}, 1)).refusal, Refusal::kNotHolder);
  const std::uint64_t before = records_;
  ASSERT_TRUE(becomes([&] { return records_ > before + 400; }));  // longer than the fade of 300 ms
  EXPECT_EQ(alpha(), 1.0) << "the exercise of the present holder still pushes";
  EXPECT_EQ(station_->status().steering, Steering::kVirtualPatient);
  EXPECT_TRUE(ask(of(orders::Stop{}, 1)).accepted) << "a stop never comes too late";
  EXPECT_TRUE(becomes(RunState::kStopped));
}

TEST_F(HostileOrders, HolderSilentWithAFullQueue_StillFadesTheExercise) {
  run(true);
  ASSERT_TRUE(squeezes());
  TickRecord record;
  ASSERT_TRUE(station_->latest(record));
  const Order aim = of(orders::Aim{record.q_m});
  const Order silent = of(orders::HolderAlive{false});
  int dropped = 0;
  for (int i = 0; i < 20'000 || dropped == 0; ++i) {
    station_->order(aim, [&](const OrderReply& reply) { dropped += reply.accepted ? 0 : 1; });
  }
  OrderReply reply;
  station_->order(silent, [&](const OrderReply& r) { reply = r; });
  EXPECT_TRUE(reply.accepted) << reply.reason;
  EXPECT_TRUE(becomes([&] { return alpha() == 0.0; }));
}

TEST_F(HostileOrders, EmergencyStopBeforeTheRun_PreventsArmingAtStart) {
  load(barConfig());
  ASSERT_TRUE(ask(orders::EmergencyStop{}).accepted);
  run(true);
  staysAt(RunState::kStopped);  // the state is shown as stopped
  EXPECT_EQ(records_, 0U) << kAlways;
  EXPECT_TRUE(ask(orders::Arm{}).accepted) << "somebody wants it now";
  EXPECT_TRUE(rendersOn());
}

TEST_F(HostileOrders, LimitLoweredWhileArming_AppliesToThatSession) {
  run(false);
  auto answer = askLater(of(orders::Arm{}));
  // The parameters of the session are fixed; the world is being built.
  ASSERT_TRUE(becomes([&] { return station_->status().session == 1U; }));
  const orders::SetParameter limit{"effort_limit_arm_n", 8.0};
  ASSERT_TRUE(ask(limit).accepted);
  ASSERT_TRUE(answer.get().accepted);
  TickRecord record;
  EXPECT_TRUE(becomes([&] {
    return station_->latest(record) && record.effort_limit[0] == limit.value;
  })) << record.effort_limit[0]
      << " N";
}

TEST_F(HostileOrders, UnattendedSession_EndsIfAClientArmedIt) {
  run(true);
  ASSERT_TRUE(rendersOn());
  ASSERT_TRUE(ask(orders::Unattended{}).accepted);
  EXPECT_TRUE(rendersOn()) << "the demo goes on";
  EXPECT_EQ(station_->status().run_state, RunState::kRendering);
  ASSERT_TRUE(ask(orders::Stop{}).accepted);
  ASSERT_TRUE(becomes(RunState::kStopped));
  ASSERT_TRUE(ask(orders::Arm{}).accepted);
  ASSERT_TRUE(rendersOn());
  ASSERT_TRUE(ask(orders::Unattended{}).accepted);
  EXPECT_TRUE(becomes(RunState::kStopped)) << "it would be recorded for ever";
}

TEST_F(HostileOrders, LoadDuringARunOfLimitedLength_DoesNotExtendTheRun) {
  load(barConfig());
  std::atomic<bool> ended{false};
  thread_ = std::thread([&] {
    (void)station_->run(true, 4.0);
    ended = true;
  });
  ASSERT_TRUE(rendersOn());
  ASSERT_TRUE(ask(kLoadLevel2).accepted);
  EXPECT_TRUE(becomes([&] { return ended.load(); }));
}

// Sends two seconds of mutated messages as the servers would pass them on, and checks every record.
TEST_F(HostileOrders, MutatedMessages_NeverPushBeyondTheLimitsNorPastAnEmergencyStop) {
  load(barConfig());
  std::atomic<int> beyond{0};
  const DeviceModel device = station_->models().device;
  station_->addSink([&beyond, device](const TickRecord& record) {
    bool sound = allFinite(record.sent) && allFinite(record.q_m) && record.authority <= 1.0;
    for (int i = 0; sound && i < record.sent.size(); ++i) {
      const double limit = device.axes[i].effort_limit;
      sound = std::abs(record.sent[i]) <= limit + 1e-9;
    }
    if (!sound) ++beyond;
  });
  run(true);
  ASSERT_TRUE(rendersOn());
  auto random = seededRandom(4170);
  const std::vector<wire::Bytes> valid = words::oneOfEach();
  int understood = 0;
  for (const auto until = Clock::now() + 2s; Clock::now() < until;) {
    wire::Bytes bytes = valid[random() % valid.size()];
    for (auto changes = random() % 4; changes > 0; --changes) {
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    }
    const auto message = wire::decode(bytes);
    if (!message) continue;
    Order order = *message;
    if (auto* aim = std::get_if<orders::Aim>(&order.what)) aim->q = AxisPosition(6, aim->q[0]);
    if (auto* set = std::get_if<orders::SetParameter>(&order.what))
      set->name = "effort_limit_arm_n";
    order.claim = static_cast<std::uint32_t>(random() % 4);
    station_->order(order, [](const OrderReply&) {});
    ++understood;
    if (understood % 16 == 0) std::this_thread::sleep_for(1ms);
  }
  EXPECT_GT(understood, 100);
  ASSERT_TRUE(ask(orders::EmergencyStop{}).accepted);
  ASSERT_TRUE(becomes([&] {
    const RunState state = station_->status().run_state;
    return state != RunState::kRendering && state != RunState::kStopping;
  })) << "whatever waits to be loaded or armed was asked for before the stop";
  staysAt(station_->status().run_state);
  EXPECT_EQ(beyond, 0) << kAlways;
  EXPECT_TRUE(becomes([&] { return ask(orders::Arm{}).accepted; }));
  EXPECT_TRUE(becomes(RunState::kRendering)) << "the next person is served";
}

TEST_F(HostileOrders, OrdersThatTheServerCarriesOut_AreRefusedByName) {
  load(barConfig());
  for (const orders::Any& what :
       {orders::Any(orders::TakeControls{}), orders::Any(orders::ReleaseControls{}),
        orders::Any(orders::Heartbeat{})}) {
    const Order order = of(what);
    const OrderReply reply = ask(order);
    EXPECT_EQ(reply.refusal, Refusal::kNotHere);
    EXPECT_NE(reply.reason.find(order.row().name), std::string::npos) << reply.reason;
  }
}

TEST_F(HostileOrders, OrderAfterTheEnd_IsAnsweredWithARefusal) {
  run(false);
  (void)quit();
  EXPECT_EQ(ask(orders::Arm{}).refusal, Refusal::kEnding);
  EXPECT_FALSE(ask(orders::Action{}).accepted);
}

}  // namespace
}  // namespace wholehand::test
