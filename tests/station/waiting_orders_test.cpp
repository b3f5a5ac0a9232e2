// Orders to arm, load and save wait in a queue. The rights of the client must still hold when the
// order is carried out, and an order waits 3 s at most. The test sets the clock.
#include "station/profiles.hpp"
#include "station/server/client_words.hpp"
#include "station/server/fake_program.hpp"
#include "station/server/udp_bridge.hpp"
#include "station/server/udp_test_game.hpp"
#include "station/station_bench.hpp"
#include "support/figure.hpp"
#include "support/resting_device.hpp"
#include "support/seed.hpp"

#include <algorithm>
#include <functional>
#include <limits>

namespace wholehand::test {
namespace {

/// Counts the devices that a station opened and holds open.
struct Devices {
  std::atomic<int> opened{0}, open{0};
  std::atomic<bool> refuses{false};    ///< if true, enable() fails
  std::function<void()> when_enabled;  ///< in the station's thread
};

/// A device that moves no person and counts whether it is open.
class CountedDevice final : public RestingDevice {
 public:
  CountedDevice(Devices& devices, const AxisPosition& at) : RestingDevice(at), devices_(devices) {}
  [[nodiscard]] Expected<Done> open() override {
    ++devices_.opened;
    ++devices_.open;
    open_ = true;
    return Done{};
  }
  [[nodiscard]] bool simulated() const noexcept override { return true; }
  [[nodiscard]] Expected<Done> enable() override {
    if (devices_.when_enabled) devices_.when_enabled();
    if (devices_.refuses) return fileFault("", "the drive does not answer", "");
    return Done{};
  }
  void close() noexcept override {
    if (std::exchange(open_, false)) --devices_.open;
  }

 private:
  Devices& devices_;
  bool open_ = false;
};

/// A client as the server knows it.
struct Person {
  std::uint32_t number = 0, claim = 0;
  std::shared_ptr<Requester> requester = alwaysHeard();
  [[nodiscard]] static std::shared_ptr<Requester> alwaysHeard() {
    auto requester = std::make_shared<Requester>();
    requester->heard_ns = std::numeric_limits<std::int64_t>::max();
    return requester;
  }
  [[nodiscard]] Order asks(Order order) const {
    order.client = number;
    order.claim = claim;
    order.requester = requester;
    return order;
  }
  void takes(std::uint32_t with_claim) {
    claim = with_claim;
    requester->claim = with_claim;
  }
};

class WaitingOrders : public Bar {
 protected:
  void begin(bool arm_at_once = false, const std::function<void(const TickRecord&)>& sink = {}) {
    StationConfig config = barConfig();
    config.files.exercise = kRoot + "/config/exercises/free-grasping.toml";
    if (!hand_.empty()) config.files.hand = hand_;
    config.recordings_folder.clear();
    config.profiles_folder = folder_ + "/profiles";
    config.visit_hands_folder = folder_ + "/hands";
    config.rehearse = false;
    config.now = [this] { return Clock::time_point(std::chrono::milliseconds(now_ms_)); };
    config.make_device = [this](const DeviceModel& device) {
      if (while_it_is_built) while_it_is_built();
      return Expected<std::unique_ptr<HapticDevice>>(
          std::make_unique<CountedDevice>(devices, AxisPosition(device.axisCount())));
    };
    config.make_player = [this](const Models& models) {
      if (when_it_begins) when_it_begins();
      return std::make_unique<ScriptedPlayer>(
          Intention::throughWaypoints({{0.0, AxisPosition(models.device.axisCount())}}));
    };
    load(config);
    if (sink) station_->addSink(sink);
    run(arm_at_once);
  }
  Person person() { return {.number = ++persons_}; }

  /// Blocks the station's thread in an answer until release().
  void hold() {
    released_ = std::promise<void>();
    auto reached = std::make_shared<std::promise<void>>();
    const orders::LoadExercise unknown{.exercise = "none-of-that-name"};
    station_->order(person().asks(of(unknown)),
                    [reached, may = released_.get_future().share()](const OrderReply&) {
                      reached->set_value();
                      may.wait();
                    });
    reached->get_future().wait();
  }
  void release() { released_.set_value(); }
  void passes(std::int64_t ms) { now_ms_ += ms; }
  [[nodiscard]] std::int64_t nowMs() const { return now_ms_; }
  OrderReply stopAndWait() {
    OrderReply reply = ask(orders::EmergencyStop{});
    EXPECT_TRUE(becomes([&] { return devices.open == 0; }));
    EXPECT_TRUE(becomes([&] { return station_->status().run_state != RunState::kStopping; }));
    return reply;
  }
  Order parameter(const char* name, double value) { return of(orders::SetParameter{name, value}); }
  static Order level(int number) { return {orders::LoadExercise{.level = number}}; }
  double value(const char* name) {
    const auto scene = station_->scene();
    for (std::size_t i = 0; i < scene->parameters.size(); ++i) {
      if (scene->parameters[i].name == std::string(name)) return station_->status().parameters[i];
    }
    return std::nan("");
  }

  Devices devices;
  std::function<void()> when_it_begins, while_it_is_built;  ///< in the station's thread
  std::string hand_;  ///< file of the first hand; empty: that of the bar

 private:
  std::atomic<std::int64_t> now_ms_{1000};
  std::uint32_t persons_ = 0;
  std::promise<void> released_;
};

/// Random events around an order to arm, and whether it may start by the rule below.
struct Fate {
  bool may = true;
  std::string what;
};

class ArmAmidOthers : public WaitingOrders {
 protected:
  /// Draws events while the order waits, while it begins, or while the loop is built.
  void happens(unsigned percent) {
    const auto chance = [&](unsigned of_100) { return random() % 100 < of_100; };
    const auto ends = [&](bool it, const char* what) {
      if (it) fate.may = false;
      fate.what += what;
    };
    if (chance(percent)) {
      asks.requester->connected = false;
      ends(true, " gone");
    }
    if (chance(percent)) {
      asks.requester->claim = 0;
      ends(asks.claim != 0, " lost");
    }
    if (chance(percent)) {
      other.takes(++claims);
      asks.requester->claim = 0;
      EXPECT_TRUE(ask(other.asks(parameter("effort_limit_arm_n", 3.0))).accepted);
      ends(asks.claim != 0, " later holder");
    }
    if (chance(percent)) {
      EXPECT_TRUE(ask(other.asks(of(orders::Stop{}))).accepted);
      ends(true, " stop");
    }
    if (chance(percent)) {
      EXPECT_TRUE(ask(other.asks(of(orders::EmergencyStop{}))).accepted);
      ends(true, " emergency stop");
    }
  }
  void drawCase() {
    const auto chance = [&](unsigned of_100) { return random() % 100 < of_100; };
    asks = person();
    other = person();
    fate = {};
    if (chance(60)) asks.takes(++claims);
    hold();
    if (chance(20)) (void)askLater(other.asks(of(orders::LoadProfile{"nobody"})));
    if (chance(15)) {
      (void)askLater(asks.asks(of(orders::LoadProfile{"nobody"})));
      fate = {false, " refused before"};
    }
    armed = askLater(asks.asks(of(orders::Arm{})));
    asked_ms = nowMs();
    if (chance(20)) (void)askLater(asks.asks(of(orders::LoadProfile{"nobody"})));
    waits_ms = static_cast<std::int64_t>(random() % (chance(70) ? 3001 : 60'001));
    passes(waits_ms);
    if (waits_ms > 3000) fate = {false, fate.what + " waited"};
    happens(6);
    when_it_begins = [this] { itsOwnWork(3); };
    while_it_is_built = [this] { itsOwnWork(8); };
  }
  void itsOwnWork(unsigned percent) {
    passes(static_cast<std::int64_t>(random() % 20'001));
    if (nowMs() - asked_ms > 30'000) fate = {false, fate.what + " took too long"};
    happens(percent);
  }
  void check() {
    const std::uint64_t before = records_;
    const std::uint32_t session = station_->status().session;
    const int opened = devices.opened;
    const bool may_begin = fate.may;
    release();
    const OrderReply reply = armed.get();
    when_it_begins = while_it_is_built = nullptr;
    ASSERT_EQ(reply.accepted, fate.may) << fate.what << ", " << waits_ms << " ms: " << reply.reason;
    if (!may_begin) {
      EXPECT_EQ(devices.opened, opened) << "not even the device is opened";
    }
    if (fate.may) {
      ++started;
      longest_ms = std::max(longest_ms, waits_ms);
      EXPECT_TRUE(becomes([&] { return records_ > before; }));
      EXPECT_TRUE(stopAndWait().accepted);
    } else {
      EXPECT_EQ(devices.open, 0);
      EXPECT_EQ(records_, before);
      EXPECT_EQ(station_->status().session, session);
      EXPECT_NE(station_->status().run_state, RunState::kRendering);
    }
  }

  std::mt19937_64 random = seededRandom(3401);
  std::uint32_t claims = 1;
  Person asks, other;
  Fate fate;
  std::future<OrderReply> armed;
  std::int64_t waits_ms = 0, longest_ms = 0, asked_ms = 0;
  int started = 0;
};

// Rule: an order to arm starts if and only if its client is connected, has not lost the controls
// with which it asked, no ending came after the order, no earlier order of the client was refused
// while it waited, it waited behind others for 3 s at most, and the device is enabled within 30 s.
TEST_F(ArmAmidOthers, ArmInRandomInterleavings_StartsOnlyIfAllowed) {
  begin();
  const int drawn = fullCounts() ? 30000 : cases(200);
  for (int i = 0; i < drawn && !HasFailure(); ++i) {
    SCOPED_TRACE("case " + std::to_string(i));
    drawCase();
    check();
  }
  figure("orders to arm in random interleavings", drawn, "");
  figure("of them started", started, "");
  figure("longest wait of one that started", 1e-3 * static_cast<double>(longest_ms), "s");
  if (kStatisticsMeaningful) {
    EXPECT_GT(started, drawn / 10);
    EXPECT_LT(started, drawn * 9 / 10);
  }
}

// ---- the press and the instant that effort may begin

/// A person presses Start and sends beats until it leaves. The device takes long to be enabled.
class PressAndEffort : public WaitingOrders {
 protected:
  static constexpr std::int64_t kStays = std::numeric_limits<std::int64_t>::max();

  void begin() {
    WaitingOrders::begin(false, [this](const TickRecord& record) {
      pushed_ = pushed_ || record.authority > 0.0 || largest(record.sent) > 0.0;
    });
  }
  /// Time passes, with a beat every 50 ms until `leaves_ms`.
  void beats(std::int64_t ms) {
    passes(ms);
    const std::int64_t last_ms = std::min(nowMs(), leaves_ms_);
    asks_.requester->heard_ns = (last_ms - last_ms % 50) * 1'000'000;
  }
  /// Presses Start, leaves after a time, and returns the reply.
  OrderReply press(std::int64_t builds_ms, std::int64_t enables_ms, std::int64_t leaves_ms) {
    asks_ = person();
    const std::int64_t pressed_ms = nowMs();
    leaves_ms_ = leaves_ms == kStays ? kStays : pressed_ms + leaves_ms;
    beats(0);
    while_it_is_built = [this, builds_ms] { beats(builds_ms); };
    devices.when_enabled = [this, enables_ms] { beats(enables_ms); };
    pushed_ = false;
    const OrderReply reply = ask(asks_.asks(of(orders::Arm{})));
    while_it_is_built = devices.when_enabled = nullptr;
    return reply;
  }
  /// Checks that the device is at neutral as after a stop, and that somebody must see it.
  void expectNothingBegan(std::uint32_t endings) {
    EXPECT_TRUE(becomes([&] { return devices.open == 0; }));
    EXPECT_TRUE(becomes([&] {
      const RunState now = station_->status().run_state;
      return now == RunState::kStopped || now == RunState::kDisarmed;
    }));
    EXPECT_FALSE(pushed_) << kAlways << "an effort began with nobody there";
    EXPECT_GE(station_->status().endings, endings);
  }

  Person asks_;
  std::int64_t leaves_ms_ = kStays;
  std::atomic<bool> pushed_{false};
};

TEST_F(PressAndEffort, PressOfSomebodyWhoLeft_NeverBeginsAndOfSomebodyWhoStaysAlwaysBegins) {
  begin();
  auto random = seededRandom(5803);
  int left = 0, stayed = 0;
  for (int i = 0; i < cases(30) && !HasFailure(); ++i) {
    const auto builds_ms = static_cast<std::int64_t>(random() % 5000);
    const auto enables_ms = static_cast<std::int64_t>(random() % 24'900);
    // A beat is at most 50 ms older than the moment of leaving.
    const std::int64_t all_ms = builds_ms + enables_ms;
    const bool stays = all_ms <= 250 || random() % 2 == 0;
    const auto leaves_ms = static_cast<std::int64_t>(random() % std::max<std::int64_t>(all_ms, 1));
    const std::uint32_t endings = station_->status().endings;
    const OrderReply reply =
        press(builds_ms, enables_ms, stays ? kStays : std::min(leaves_ms, all_ms - 250));
    SCOPED_TRACE(std::to_string(builds_ms) + " ms + " + std::to_string(enables_ms) + " ms, left " +
                 std::to_string(leaves_ms));
    ASSERT_EQ(reply.accepted, stays) << reply.reason;
    if (stays) {
      ++stayed;
      EXPECT_TRUE(becomes([&] { return pushed_.load(); }));
      EXPECT_TRUE(stopAndWait().accepted);
    } else {
      ++left;
      EXPECT_EQ(reply.refusal, Refusal::kNotHeard);
      expectNothingBegan(endings);
    }
  }
  figure("presses of somebody who left", left, "");
  figure("presses of somebody who stayed, all started", stayed, "");
}

TEST_F(PressAndEffort, BeatOf200ms_StillCountsAndOneMillisecondMoreDoesNot) {
  begin();
  for (const std::int64_t silent_ms : {200, 201}) {
    asks_ = person();
    pushed_ = false;
    devices.when_enabled = [&] {
      asks_.requester->heard_ns = nowMs() * 1'000'000;
      passes(silent_ms);
    };
    const OrderReply reply = ask(asks_.asks(of(orders::Arm{})));
    EXPECT_EQ(reply.accepted, silent_ms == 200) << reply.reason;
    devices.when_enabled = nullptr;
    if (silent_ms == 200) {
      EXPECT_TRUE(stopAndWait().accepted);
    }
  }
  expectNothingBegan(0);
}

TEST_F(PressAndEffort, StartThatTakesMoreThan30s_IsVoid) {
  begin();
  EXPECT_TRUE(press(1000, 29'000, kStays).accepted);
  EXPECT_TRUE(stopAndWait().accepted);
  const std::uint32_t endings = station_->status().endings;
  EXPECT_EQ(press(1000, 29'001, kStays).refusal, Refusal::kWaitedTooLong);
  expectNothingBegan(endings + 1);
  EXPECT_EQ(press(30'001, 0, kStays).refusal, Refusal::kWaitedTooLong);
}

// The line closes, or a later holder takes the controls, while the device is being enabled.
TEST_F(PressAndEffort, PresserGoneOrOverruledWhileTheDeviceIsEnabled_BeginsNothing) {
  begin();
  using Happens = std::function<void()>;
  const std::vector<Happens> cases = {
      [&] { asks_.requester->connected = false; }, [&] { asks_.requester->claim = 0; },
      [&] {
        Person other = person();
        other.takes(asks_.claim + 1);
        EXPECT_TRUE(ask(other.asks(parameter("effort_limit_arm_n", 3.0))).accepted);
      }};
  std::uint32_t claim = 10;
  for (const Happens& happens : cases) {
    asks_ = person();
    asks_.takes(claim += 10);
    pushed_ = false;
    const std::uint32_t endings = station_->status().endings;
    devices.when_enabled = happens;
    EXPECT_EQ(ask(asks_.asks(of(orders::Arm{}))).refusal, Refusal::kNotHolder);
    devices.when_enabled = nullptr;
    expectNothingBegan(endings + 1);
    EXPECT_EQ(station_->status().run_state, RunState::kStopped);
    EXPECT_FALSE(station_->status().rested);
  }
}

TEST_F(WaitingOrders, RefusedArm_SaysWhy) {
  begin();
  Person asks = person();
  asks.takes(7);
  const auto armedAfter = [&](const std::function<void()>& happens) {
    hold();
    auto armed = askLater(asks.asks(of(orders::Arm{})));
    happens();
    release();
    return armed.get();
  };
  const OrderReply late = armedAfter([&] { passes(12'000); });
  EXPECT_EQ(late.refusal, Refusal::kWaitedTooLong);
  EXPECT_NE(late.reason.find("12.0 s"), std::string::npos) << late.reason;
  EXPECT_EQ(armedAfter([&] { asks.requester->claim = 8; }).refusal, Refusal::kNotHolder);
  asks.takes(9);
  EXPECT_EQ(armedAfter([&] { (void)ask(orders::Stop{}); }).refusal, Refusal::kStopCame);
  hold();
  (void)askLater(asks.asks(of(orders::LoadProfile{"nobody"})));
  auto armed = askLater(asks.asks(of(orders::Arm{})));
  release();
  EXPECT_EQ(armed.get().refusal, Refusal::kRefusedBefore);
  EXPECT_EQ(devices.opened, 0);
}

// A limit that the station accepts at any moment of an arming is in force in the first tick.
// Before, 2 N accepted while the device was being enabled was reached after 0.84 s.
TEST_F(WaitingOrders, LimitAcceptedDuringAnArming_IsInForceInTheFirstTick) {
  TickRecord first;
  std::atomic<bool> has_first{false};
  begin(false, [&](const TickRecord& record) {
    if (record.tick != 0) return;
    first = record;
    has_first = true;
  });
  auto random = seededRandom(5802);
  const std::vector<const char*> limits = {"effort_limit_hand_tip_n", "effort_limit_arm_n"};
  for (int i = 0; i < cases(30) && !HasFailure(); ++i) {
    const auto accepts = [&] {
      for (auto orders = random() % 12; orders > 0; --orders) {
        const char* name = limits[random() % 2];
        EXPECT_TRUE(ask(parameter(name, uniform(random, 2.0, 10.0))).accepted);
      }
    };
    std::vector<double> accepted;
    when_it_begins = while_it_is_built = accepts;
    devices.when_enabled = [&] {
      accepts();
      for (const char* name : limits) accepted.push_back(value(name));
    };
    has_first = false;
    ASSERT_TRUE(ask(orders::Arm{}).accepted);
    ASSERT_TRUE(becomes([&] { return has_first.load(); }));
    ASSERT_EQ(accepted.size(), 2U);
    EXPECT_EQ(first.parameters[0], accepted[0]);
    EXPECT_EQ(first.parameters[1], accepted[1]);
    EXPECT_EQ(first.effort_limit[0], accepted[1]) << "x is an axis of the arm";
    when_it_begins = while_it_is_built = devices.when_enabled = nullptr;
    EXPECT_TRUE(stopAndWait().accepted);
  }
}

// Less is obeyed whoever asks, also an order that the next holder has overtaken; more is not.
TEST_F(WaitingOrders, LimitOfAnEarlierHolder_IsObeyedIfItIsLower) {
  begin(true);
  ASSERT_TRUE(rendersOn());
  for (const char* name : {"effort_limit_hand_tip_n", "effort_limit_arm_n"}) {
    const auto limit = [&](double value_n, std::uint32_t claim) {
      Order order = parameter(name, value_n);
      order.claim = claim;
      return ask(order);
    };
    const double now_n = value(name);
    ASSERT_TRUE(limit(0.8 * now_n, 2).accepted);
    EXPECT_EQ(limit(0.9 * now_n, 1).refusal, Refusal::kNotHolder);
    EXPECT_TRUE(limit(0.5 * now_n, 1).accepted);
    EXPECT_TRUE(becomes([&] { return value(name) == 0.5 * now_n; })) << value(name);
  }
}

// A load while rendering continues by the same rule; otherwise it leaves the session stopped or
// untouched.
TEST_F(WaitingOrders, LoadWhileRendering_ContinuesOnlyForAnAllowedClient) {
  begin(true);
  ASSERT_TRUE(rendersOn());
  const Person stays = person(), leaves = person();
  ASSERT_TRUE(ask(stays.asks(level(1))).accepted);
  EXPECT_EQ(station_->status().session, 2U);
  ASSERT_TRUE(rendersOn());
  hold();
  auto loaded = askLater(leaves.asks(level(1)));
  leaves.requester->connected = false;
  release();
  EXPECT_FALSE(loaded.get().accepted);
  EXPECT_EQ(station_->status().session, 2U) << "what renders is not touched";
  ASSERT_TRUE(rendersOn());
  const std::uint32_t seen = station_->status().endings;
  Person loses = person();
  loses.takes(5);
  when_it_begins = [&] { loses.requester->claim = 0; };  // the old session has stopped by then
  loaded = askLater(loses.asks(level(1)));
  EXPECT_EQ(loaded.get().refusal, Refusal::kNotHolder);
  when_it_begins = nullptr;
  staysAt(RunState::kStopped);
  EXPECT_GT(station_->status().endings, seen) << "it has ended, and that is said";
  EXPECT_EQ(devices.open, 0);
}

// This also holds for a client that may raise limits: a person is strapped in, and nobody has
// pressed Start.
TEST_F(WaitingOrders, LoadOfAnotherHandWhileRendering_RaisesNoLimit) {
  begin(true);
  ASSERT_TRUE(rendersOn());
  const std::vector<const char*> limits = {"effort_limit_arm_n", "effort_limit_hand_tip_n"};
  for (const char* name : limits) ASSERT_TRUE(ask(parameter(name, 2.5)).accepted);
  Order load = of(orders::LoadExercise{.hand = "man-p95-right"});
  load.may_raise_limits = true;
  ASSERT_TRUE(ask(person().asks(load)).accepted);
  ASSERT_TRUE(rendersOn());
  EXPECT_EQ(station_->scene()->hand.name, "man-p95-right");
  for (const char* name : limits) EXPECT_EQ(value(name), 2.5) << name;
}

TEST_F(WaitingOrders, SameHandByAnotherPath_KeepsThePersonsSettings) {
  hand_ = kRoot + "/tests/../config/hands/adult-median-right.toml";
  begin();
  ASSERT_TRUE(ask(parameter("effort_limit_arm_n", 4.0)).accepted);
  Order load = of(orders::LoadExercise{.hand = "adult-median-right", .level = 1});
  load.may_raise_limits = true;
  ASSERT_TRUE(ask(person().asks(load)).accepted);
  EXPECT_EQ(value("effort_limit_arm_n"), 4.0);
}

// The client that presses Start sees p-1; another client's order to load p-2 waits before it.
TEST_F(WaitingOrders, ArmBehindALoadOfAnotherPerson_StartsOnlyForTheLoadingClient) {
  begin();
  ASSERT_TRUE(ask(of(orders::SaveProfile{"p-2"})).accepted);
  for (const bool same : {false, true}) {
    hold();
    const Person loads = person(), other = person();
    auto loaded = askLater(loads.asks(of(orders::LoadProfile{"p-2"})));
    auto armed = askLater((same ? loads : other).asks(of(orders::Arm{})));
    release();
    ASSERT_TRUE(loaded.get().accepted);
    const OrderReply reply = armed.get();
    EXPECT_EQ(reply.accepted, same) << reply.reason;
    EXPECT_EQ(station_->status().run_state == RunState::kRendering, same) << kAlways;
    EXPECT_EQ(devices.opened, same ? 1 : 0) << kAlways;
  }
}

TEST_F(WaitingOrders, SaveProfile_WritesTheValuesAtTheTimeOfTheOrder) {
  begin();
  ASSERT_TRUE(ask(parameter("effort_limit_arm_n", 8.0)).accepted);
  hold();
  auto saved = askLater(person().asks(of(orders::SaveProfile{"p-1"})));
  ASSERT_TRUE(ask(orders::SetHelp{Help::kNone}).accepted);
  ASSERT_TRUE(ask(parameter("effort_limit_arm_n", 12.0)).accepted);
  release();
  ASSERT_TRUE(saved.get().accepted);
  const auto written = Profiles(folder_ + "/profiles").load("p-1");
  ASSERT_TRUE(written) << format(written.errors());
  EXPECT_EQ(written->parameters.at("effort_limit_arm_n"), 8.0);
  EXPECT_EQ(written->help, Help::kUnspecified);
}

// The profile is saved as p-1 while an order to load p-2 waits before it; the values of p-2 hold
// afterwards.
TEST_F(WaitingOrders, SaveProfileBehindALoadOfAnotherPerson_SavesTheHandAndKeepsTheLoadedProfile) {
  begin();
  ASSERT_TRUE(ask(of(orders::SaveProfile{"p-2"})).accepted);
  ASSERT_TRUE(ask(orders::LoadExercise{.hand = "woman-p05-left"}).accepted);
  hold();
  auto loaded = askLater(person().asks(of(orders::LoadProfile{"p-2"})));
  auto saved = askLater(person().asks(of(orders::SaveProfile{"p-1"})));
  release();
  ASSERT_TRUE(loaded.get().accepted);
  ASSERT_TRUE(saved.get().accepted);
  EXPECT_EQ(Profiles(folder_ + "/profiles").load("p-1")->hand, "woman-p05-left");
  EXPECT_EQ(station_->scene()->profile, "p-2");
}

// Until the first tick nothing is rendered, and the status says only that it starts.
TEST_F(WaitingOrders, DeviceThatIsBeingEnabled_IsNotCalledRendering) {
  begin();
  RunState shown = RunState::kRendering;
  bool arming = false;
  devices.when_enabled = [&] {
    const LoopStatus status = station_->status();
    shown = status.run_state;
    arming = status.arming;
  };
  ASSERT_TRUE(ask(of(orders::Arm{})).accepted);
  devices.when_enabled = nullptr;
  EXPECT_EQ(shown, RunState::kDisarmed);
  EXPECT_TRUE(arming);
  EXPECT_EQ(station_->status().run_state, RunState::kRendering);
  stopAndWait();
}

TEST_F(WaitingOrders, LoadProfile_KeepsValuesThatWereSetAfterTheOrder) {
  begin();
  ASSERT_TRUE(ask(parameter("effort_limit_arm_n", 15.0)).accepted);
  ASSERT_TRUE(ask(parameter("effort_limit_hand_tip_n", 5.0)).accepted);
  ASSERT_TRUE(ask(of(orders::SaveProfile{"p-1"})).accepted);
  ASSERT_TRUE(ask(parameter("effort_limit_hand_tip_n", 2.0)).accepted);
  hold();
  Order load = person().asks(of(orders::LoadProfile{"p-1"}));
  load.may_raise_limits = true;
  auto loaded = askLater(load);
  ASSERT_TRUE(ask(parameter("effort_limit_arm_n", 3.0)).accepted);
  release();
  ASSERT_TRUE(loaded.get().accepted);
  EXPECT_EQ(value("effort_limit_arm_n"), 3.0) << "the answer to the therapist was \"accepted\"";
  EXPECT_EQ(value("effort_limit_hand_tip_n"), 5.0);
}

// A console still shows the earlier patient and moves a slider while the next visit is being
// opened. Only a change that lowers the next visit's limit is kept.
TEST_F(WaitingOrders, OpenVisit_KeepsOfMeanwhileChangesOnlyALowerLimit) {
  begin();
  hold();
  Order open = person().asks(of(orders::OpenVisit{
      .visit = 12,
      .exercise = "free-grasping",
      .hand = "man-p95-right",
      .parameters = {{"effort_limit_arm_n", 6.0}, {"effort_limit_hand_tip_n", 3.0}}}));
  open.may_raise_limits = true;
  auto opened = askLater(open);
  ASSERT_TRUE(ask(parameter("effort_limit_arm_n", 15.0)).accepted);
  ASSERT_TRUE(ask(parameter("effort_limit_hand_tip_n", 2.0)).accepted);
  ASSERT_TRUE(ask(orders::SetHelp{Help::kFull}).accepted);
  release();
  ASSERT_TRUE(opened.get().accepted);
  EXPECT_EQ(value("effort_limit_arm_n"), 6.0);
  EXPECT_EQ(value("effort_limit_hand_tip_n"), 2.0);
  EXPECT_EQ(station_->status().help, Help::kUnspecified);
}

// No setting of the earlier patient outlives a change of hand, side or person. A limit rises only
// by an order of a client that may set it.
TEST_F(WaitingOrders, ChangeOfThePerson_ResetsAllSettings) {
  begin();
  const auto scene = station_->scene();
  auto random = seededRandom(3402);
  const std::vector<std::string> hands = {"man-p95-right", "woman-p05-left", "woman-p05-right",
                                          "man-p95-left"};
  for (int i = 0; i < cases(40); ++i) {
    const auto before = station_->scene()->parameters;
    std::map<std::string, double> set;
    for (const PublishedParameter& p : before) {
      if (random() % 3 == 0) continue;
      set[p.name] = uniform(random, p.lower, p.upper);
      ASSERT_TRUE(ask(parameter(p.name.c_str(), set[p.name])).accepted);
    }
    ASSERT_TRUE(ask(orders::SetHelp{Help::kFull}).accepted);
    const bool therapist = random() % 2 == 0;
    Order change =
        of(orders::LoadExercise{.hand = hands[static_cast<std::size_t>(i) % hands.size()]});
    change.may_raise_limits = therapist;
    ASSERT_TRUE(ask(person().asks(change)).accepted);
    const auto after = station_->scene()->parameters;
    EXPECT_EQ(station_->status().help, Help::kUnspecified);
    EXPECT_EQ(station_->scene()->profile, "");
    for (const PublishedParameter& p : after) {
      const bool limit = p.name.starts_with("effort_limit_");
      const bool stays = limit && !therapist && set.contains(p.name);
      EXPECT_EQ(value(p.name.c_str()), stays ? set[p.name] : p.initial) << p.name << therapist;
      if (limit && !therapist) set.erase(p.name);
    }
    if (!therapist) {  // restores the hand for the next case
      Order back = of(orders::LoadExercise{.hand = "adult-median-right"});
      back.may_raise_limits = true;
      ASSERT_TRUE(ask(person().asks(back)).accepted);
    }
  }
}

TEST_F(WaitingOrders, AnotherExerciseOfTheSamePerson_KeepsTheSettings) {
  begin();
  ASSERT_TRUE(ask(parameter("effort_limit_arm_n", 4.0)).accepted);
  ASSERT_TRUE(ask(person().asks(level(1))).accepted);
  EXPECT_EQ(value("effort_limit_arm_n"), 4.0);
}

TEST_F(WaitingOrders, RestOfTheEarlierPerson_DoesNotPassToTheNext) {
  begin(true);
  ASSERT_TRUE(rendersOn());
  ASSERT_TRUE(ask(orders::Rest{}).accepted);
  ASSERT_TRUE(becomes(RunState::kStopped));
  ASSERT_TRUE(station_->status().rested);
  ASSERT_TRUE(ask(orders::LoadExercise{.hand = "woman-p05-left"}).accepted);
  EXPECT_FALSE(station_->status().rested);
}

// ---- presses around an arming

/// Presses at random moments around an arming: while it waits, while it begins, while the loop is
/// built and while the device is enabled.
class PressesAroundAnArming : public WaitingOrders {
 protected:
  enum class Press { kRest, kStop, kEmergencyStop, kArm };

  /// Presses and tracks the expected state. A press of Arm starts the device unless another press
  /// follows. A rest counts as a rest if it cancels an arming or follows a rest; after a stop only
  /// an arming makes this possible again.
  void press(Press what) {
    pressed_ += "REsA"[static_cast<int>(what)];
    switch (what) {
      case Press::kRest:
        rests_ = rests_ || starts_;
        starts_ = false;
        return expectStopped(orders::Rest{});
      case Press::kStop:
        rests_ = starts_ = false;
        return expectStopped(orders::Stop{});
      case Press::kEmergencyStop:
        rests_ = starts_ = false;
        return expectStopped(orders::EmergencyStop{});
      case Press::kArm:
        starts_ = true;
        ++unanswered_;
        station_->order(person().asks(of(orders::Arm{})),
                        [this](const OrderReply&) { --unanswered_; });
        EXPECT_TRUE(station_->status().arming) << pressed_;
    }
  }
  void expectStopped(orders::Any stop) {
    EXPECT_TRUE(ask(person().asks(of(std::move(stop)))).accepted) << pressed_;
    const LoopStatus now = station_->status();
    EXPECT_FALSE(now.arming) << kAlways << pressed_;
    EXPECT_EQ(now.rested, rests_) << pressed_;
    EXPECT_NE(now.run_state, RunState::kRendering) << kAlways << pressed_;
  }
  void pressSome(unsigned kinds) {
    pressed_ += ' ';
    while (random_() % 3 == 0) press(static_cast<Press>(random_() % kinds));
  }
  /// Draws one case, from a station that rests, is stopped or was never armed.
  void drawCase() {
    pressed_.clear();
    hold();
    press(Press::kArm);
    pressSome(4);
    when_it_begins = while_it_is_built = [this] { pressSome(4); };
    devices.when_enabled = [this] { pressSome(3); };  // an order to arm is refused from here on
    release();
    EXPECT_TRUE(becomes([&] { return unanswered_ == 0; }));
    when_it_begins = while_it_is_built = devices.when_enabled = nullptr;
  }
  void check() {
    if (starts_) {
      EXPECT_TRUE(rendersOn()) << pressed_;
    } else {
      EXPECT_EQ(records_, before_) << kAlways << "no tick, no force: " << pressed_;
      EXPECT_EQ(devices.open, 0) << kAlways << pressed_;
      EXPECT_EQ(station_->status().run_state, RunState::kStopped) << pressed_;
      EXPECT_EQ(station_->status().rested, rests_) << pressed_;
    }
    EXPECT_FALSE(station_->status().arming) << pressed_;
  }
  /// Ends the case at neutral, by a rest or a stop.
  void end() {
    if (starts_) press(random_() % 2 == 0 ? Press::kStop : Press::kRest);
    EXPECT_TRUE(becomes([&] { return devices.open == 0; }));
    EXPECT_TRUE(becomes(RunState::kStopped));
    EXPECT_EQ(station_->status().rested, rests_) << pressed_;
    before_ = records_;
  }

  std::mt19937_64 random_ = seededRandom(3407);
  std::string pressed_;             ///< A: arm, R: rest, E: stop, s: emergency stop
  std::atomic<int> unanswered_{0};  ///< orders to arm without an answer
  bool starts_ = false, rests_ = false;
  std::uint64_t before_ = 0;
};

TEST_F(PressesAroundAnArming, PressesInAnyOrder_HaveTheEffectOfTheLastOnes) {
  begin();
  int rests = 0, starts = 0;
  for (int i = 0; i < cases(100) && !HasFailure(); ++i) {
    drawCase();
    check();
    rests += rests_ ? 1 : 0;
    starts += starts_ ? 1 : 0;
    end();
  }
  figure("armings that presses of Rest, Stop and Arm surround", cases(100), "");
  figure("of them ended as a rest", rests, "");
  figure("of them started", starts, "");
}

// The device refuses; the client that pressed Go on may press it again.
TEST_F(PressesAroundAnArming, FailedArm_KeepsTheRest) {
  begin(true);
  ASSERT_TRUE(rendersOn());
  ASSERT_TRUE(ask(orders::Rest{}).accepted);
  ASSERT_TRUE(becomes(RunState::kStopped));
  devices.refuses = true;
  EXPECT_EQ(ask(orders::Arm{}).refusal, Refusal::kCannotStart);
  EXPECT_TRUE(station_->status().rested);
  devices.refuses = false;
  EXPECT_TRUE(ask(orders::Arm{}).accepted);
}

// ---- over a line, with a rehearsal

class ArmOverALine : public ServedBar {
 protected:
  void open() {
    load(barConfig());
    serve();
  }
  /// A therapist arms, which needs no controls, and waits until the progress of the rehearsal is
  /// shown.
  std::unique_ptr<WebSocket> armsAndShowsTheRehearsal() {
    auto client =
        std::make_unique<WebSocket>(server_->port(), "", std::string("/ws?role=therapist"));
    client->send(words::armAcknowledging(station_->status().endings, 1));
    std::uint32_t rehearsed = 0;
    for (const auto until = Clock::now() + kHang; rehearsed == 0 && Clock::now() < until;) {
      const auto frame = replies::next(*client, replies::fb::Payload::WorldState);
      if (!frame) break;
      rehearsed = replies::message(*frame).payload_as_WorldState()->rehearsed_ticks();
    }
    EXPECT_GT(rehearsed, 0U);
    return client;
  }

  /// Reads messages until a state meets the condition; sends heartbeats meanwhile.
  template <class Condition>
  bool sees(WebSocket& client, Condition&& so) {
    for (const auto until = Clock::now() + 20s; Clock::now() < until && !client.closed();) {
      client.send(words::heartbeat(0));
      const auto frame = client.receive(50ms);
      if (!frame || frame->opcode != 2) continue;
      const auto& message = replies::message(*frame);
      const auto* state = message.payload_as_WorldState();
      if (state != nullptr && so(*state)) return true;
      if (const auto* reply = message.payload_as_Reply(); reply != nullptr && !reply->accepted()) {
        refusals_ += reply->reason()->str() + "; ";
      }
    }
    return false;
  }
  /// A player rests during the arming, sees the rest and arms again.
  void restsAndGoesOn(WebSocket& player, std::uint32_t id) {
    using State = replies::fb::WorldState;
    ASSERT_TRUE(sees(player, [](const State& s) { return s.arming(); }));
    player.send(words::takeControls(id));
    player.send(words::rest(id + 1));
    std::uint32_t shown = 0;
    ASSERT_TRUE(sees(player, [&](const State& s) {
      shown = s.endings();
      return s.rested() && !s.arming() && s.run_state() == replies::fb::RunState::Stopped;
    }));
    EXPECT_EQ(records_, 0U) << kAlways << "nothing was rendered";
    player.send(words::takeControls(id + 2));
    player.send(words::armAcknowledging(shown, id + 3));
    EXPECT_TRUE(sees(player, [](const State& s) {
      return s.run_state() == replies::fb::RunState::Rendering;
    })) << refusals_;
  }

  std::string refusals_;  ///< reasons of the refusals received
};

TEST_F(ArmOverALine, ArmOfAPlayerWhoRestsMeanwhile_ContinuesByTheNextPress) {
  open();
  WebSocket player(server_->port(), "", std::string("/ws?role=player"));
  player.send(words::takeControls(1));
  player.send(words::armAcknowledging(1, 2));
  restsAndGoesOn(player, 3);
}

// A player in the presence of a therapist may not start a session, but may end its own rest.
TEST_F(ArmOverALine, ArmOfATherapistWhosePlayerRestsMeanwhile_ContinuesByThePlayersPress) {
  open();
  WebSocket player(server_->port(), "", std::string("/ws?role=player"));
  const auto therapist = armsAndShowsTheRehearsal();
  restsAndGoesOn(player, 1);
}

TEST_F(ArmOverALine, LineClosedDuringTheRehearsal_StartsNothing) {
  open();
  armsAndShowsTheRehearsal().reset();
  EXPECT_TRUE(becomes([&] { return station_->status().rehearsed_ticks == 0; }));
  staysAt(RunState::kDisarmed);
  EXPECT_EQ(records_, 0U);
  EXPECT_EQ(station_->status().session, 0U);
}

TEST_F(ArmOverALine, LineThatStaysOpen_Starts) {
  open();
  const auto client = armsAndShowsTheRehearsal();
  // It is heard until the first ticks; the state says Rendering before them.
  EXPECT_TRUE(sees(*client, [&](const replies::fb::WorldState&) { return records_ > 100; }))
      << refusals_;
}

// ---- stops in every state

// A game that repeats its stop every 10 ms must not make the number of endings rise, or nobody
// could name the newest one.
TEST_F(WaitingOrders, RepeatedStops_CountOnceUntilSomebodyArms) {
  begin();
  const Person game = person(), other = person();
  for (const orders::Any& stop : kStops) {
    const std::uint32_t shown = station_->status().endings;
    for (int i = 0; i < 300; ++i) ASSERT_TRUE(ask(game.asks(of(stop))).accepted);
    EXPECT_EQ(station_->status().endings, shown + 1);
    ASSERT_TRUE(ask(other.asks(of(stop))).accepted);
    EXPECT_EQ(station_->status().endings, shown + 2) << "somebody else's is none";
    ASSERT_TRUE(ask(orders::Arm{}).accepted);
    EXPECT_TRUE(rendersOn());
    const std::uint32_t armed = station_->status().endings;
    for (int i = 0; i < 300; ++i) ASSERT_TRUE(ask(game.asks(of(stop))).accepted);
    ASSERT_TRUE(becomes(RunState::kStopped));
    EXPECT_EQ(station_->status().endings, armed + 2) << "the stop, and the end of the session";
  }
}

// A stop that is pressed again is a new ending: an order sent before it and received after it is
// refused.
TEST_F(WaitingOrders, StopWithANewNumber_CountsAgain) {
  begin();
  const Person game = person();
  Order pressed = game.asks(of(orders::EmergencyStop{}));
  pressed.id = 7;
  ASSERT_TRUE(ask(pressed).accepted);
  const Order late = person().asks(of(orders::Arm{}));  // sent now, received later
  const std::uint32_t shown = station_->status().endings;
  for (int i = 0; i < 300; ++i) ASSERT_TRUE(ask(pressed).accepted);
  EXPECT_EQ(station_->status().endings, shown);
  pressed.id = 8;
  for (int i = 0; i < 300; ++i) ASSERT_TRUE(ask(pressed).accepted);
  EXPECT_EQ(station_->status().endings, shown + 1);
  EXPECT_EQ(ask(late).refusal, Refusal::kStopNotSeen);
}

// A repeated stop without a number is a new press in two cases: from a game one second after its
// last one, and from the program itself at any time.
TEST_F(WaitingOrders, StopWithoutANumber_CountsAsANewPress) {
  begin();
  const Person game = person();
  for (const orders::Any& stop : kStops) {
    for (const bool inside : {false, true}) {
      const Order pressed = inside ? of(stop) : game.asks(of(stop));
      ASSERT_TRUE(ask(pressed).accepted);
      const Order late = person().asks(of(orders::Arm{}));  // sent now, received later
      if (!inside) passes(1000);
      ASSERT_TRUE(ask(pressed).accepted);
      EXPECT_EQ(ask(late).refusal, Refusal::kStopNotSeen);
      EXPECT_NE(station_->status().run_state, RunState::kRendering);
    }
  }
}

TEST_F(WaitingOrders, StopRepeatedWhileAnArmWaits_RefusesTheArmAndCounts) {
  begin();
  const Person game = person();
  ASSERT_TRUE(ask(game.asks(of(orders::Stop{}))).accepted);
  hold();
  auto armed = askLater(person().asks(of(orders::Arm{})));
  const std::uint32_t shown = station_->status().endings;
  ASSERT_TRUE(ask(game.asks(of(orders::Stop{}))).accepted);
  EXPECT_EQ(station_->status().endings, shown + 1);
  release();
  EXPECT_EQ(armed.get().refusal, Refusal::kStopCame);
}

// A game that sends no command numbers: every stop is obeyed, and all count as one ending.
TEST_F(WaitingOrders, EmergencyStopsWithId0ByDatagram_AreObeyedAndCountOnce) {
  begin(true);
  ASSERT_TRUE(rendersOn());
  constexpr std::uint64_t kKey = 0x1234;
  constexpr UdpEndpoint kAnyPort{0x7F000001, 0};
  ControlHolder controls;
  UdpBridge bridge(*station_, controls);
  (void)orThrow(bridge.start({kAnyPort, kKey}));
  bridge.admitStandalone(controls.newClient());
  UdpSocket socket;
  (void)orThrow(socket.open(kAnyPort));
  TestGame game([&](const TestGame::Bytes& d) { (void)socket.send(bridge.local(), d); });
  game.key = kKey;
  const std::uint32_t shown = station_->status().endings;
  for (std::uint64_t said = 1; said <= 20; ++said) {
    EXPECT_TRUE(becomes([&] {
      game.send(words::emergencyStop(0));
      return bridge.counters().stops >= said;
    }));
  }
  EXPECT_TRUE(becomes(RunState::kStopped));
  expectNeutral();
  EXPECT_EQ(station_->status().endings, shown + 2) << "the stop, and the end of the session";
}

// Rule: in every state a stop from any client is accepted and leads to neutral; nothing renders
// after it.
TEST_F(WaitingOrders, StopInEveryState_LeadsToNeutral) {
  begin();
  auto random = seededRandom(3403);
  enum { kDisarmed, kArming, kRendering, kStopping, kStopped, kStates };
  for (int i = 0; i < (fullCounts() ? 6000 : cases(60)) && !HasFailure(); ++i) {
    const int state = static_cast<int>(random() % kStates);
    SCOPED_TRACE("state " + std::to_string(state));
    const Person stops = person();
    Order stop = of(kStops[random() % 2]);
    if (stop.is<orders::Stop>() && random() % 2 == 0) stop.what = orders::Rest{};
    OrderReply reply;
    const auto press = [&] { reply = ask(stops.asks(stop)); };
    if (state == kArming) while_it_is_built = press;
    if (state != kDisarmed && state != kStopped) {
      EXPECT_EQ(ask(person().asks(of(orders::Arm{}))).accepted, state != kArming);
    }
    while_it_is_built = nullptr;
    if (state == kStopping) (void)ask(orders::Stop{});
    if (state != kArming) press();
    EXPECT_TRUE(reply.accepted);
    EXPECT_TRUE(becomes([&] { return devices.open == 0; }));
    EXPECT_TRUE(becomes(RunState::kStopped));
    expectNeutral();
  }
}

}  // namespace
}  // namespace wholehand::test
