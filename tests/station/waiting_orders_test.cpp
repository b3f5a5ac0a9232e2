// Orders that wait: to arm, to load, to save. What their client was allowed when it asked must hold
// in the moment of starting, and they wait for 3 s at most, on a clock that the test moves.
#include "station/profiles.hpp"
#include "station/server/client_words.hpp"
#include "station/server/fake_program.hpp"
#include "station/server/udp_bridge.hpp"
#include "station/server/udp_test_game.hpp"
#include "station/station_bench.hpp"
#include "support/figure.hpp"
#include "support/resting_device.hpp"
#include "support/seed.hpp"

#include <functional>

namespace wholehand::test {
namespace {

/// What became of the devices of a station.
struct Devices {
  std::atomic<int> opened{0}, open{0};
  std::atomic<bool> refuses{false};    ///< to be enabled
  std::function<void()> when_enabled;  ///< in the station's thread
};

/// Moves nobody, and says whether it is open.
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
  std::shared_ptr<Asker> asker = std::make_shared<Asker>();
  [[nodiscard]] Order asks(Order order) const {
    order.client = number;
    order.claim = claim;
    order.asker = asker;
    return order;
  }
  void takes(std::uint32_t with_claim) {
    claim = with_claim;
    asker->claim = with_claim;
  }
};

class WaitingOrders : public Bar {
 protected:
  void begin(bool arm_at_once = false) {
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
    run(arm_at_once);
  }
  Person person() { return {++persons_, 0, std::make_shared<Asker>()}; }

  /// The station's thread answers somebody who does not take the answer until release().
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
  OrderReply stopAndWait() {
    OrderReply reply = ask(orders::EmergencyStop{});
    EXPECT_TRUE(becomes([&] { return devices.open == 0; }));
    EXPECT_TRUE(becomes([&] { return station_->status().run_state != RunState::kStopping; }));
    return reply;
  }
  static Order parameter(const char* name, double value) {
    return {orders::SetParameter{name, value}};
  }
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
  std::string hand_;  ///< file of the first hand; empty: the bar's

 private:
  std::atomic<std::int64_t> now_ms_{1000};
  std::uint32_t persons_ = 0;
  std::promise<void> released_;
};

/// What happens to an order to arm, drawn; and whether it may start by the law below.
struct Fate {
  bool may = true;
  std::string what;
};

class ArmAmidOthers : public WaitingOrders {
 protected:
  /// While it waits, while it begins, or while the loop is built.
  void happens(unsigned percent) {
    const auto chance = [&](unsigned of_100) { return random() % 100 < of_100; };
    const auto ends = [&](bool it, const char* what) {
      if (it) fate.may = false;
      fate.what += what;
    };
    if (chance(percent)) {
      asks.asker->connected = false;
      ends(true, " gone");
    }
    if (chance(percent)) {
      asks.asker->claim = 0;
      ends(asks.claim != 0, " lost");
    }
    if (chance(percent)) {
      other.takes(++claims);
      asks.asker->claim = 0;
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
    if (chance(20)) (void)askLater(asks.asks(of(orders::LoadProfile{"nobody"})));
    waits_ms = static_cast<std::int64_t>(random() % (chance(70) ? 3001 : 60'001));
    passes(waits_ms);
    if (waits_ms > 3000) fate = {false, fate.what + " waited"};
    happens(6);
    when_it_begins = [this] { itsOwnWork(3); };
    while_it_is_built = [this] { itsOwnWork(8); };
  }
  void itsOwnWork(unsigned percent) {
    passes(static_cast<std::int64_t>(random() % 60'001));
    happens(percent);
  }
  void judge() {
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
  std::int64_t waits_ms = 0, longest_ms = 0;
  int started = 0;
};

// Law: an order to arm starts if and only if its client is there, has lost no controls that it
// asked with, nothing has ended since, nothing that it asked for before was refused while it
// waited, and it waited for 3 s at most behind others; its own work may take as long as it takes.
TEST_F(ArmAmidOthers, InRandomInterleavings_StartsForWhoMayAndNobodyElse) {
  begin();
  const int drawn = fullCounts() ? 30000 : cases(200);
  for (int i = 0; i < drawn && !HasFailure(); ++i) {
    SCOPED_TRACE("case " + std::to_string(i));
    drawCase();
    judge();
  }
  figure("orders to arm in random interleavings", drawn, "");
  figure("of them started", started, "");
  figure("longest wait of one that started", 1e-3 * static_cast<double>(longest_ms), "s");
  if (kCountsTell) {
    EXPECT_GT(started, drawn / 10);
    EXPECT_LT(started, drawn * 9 / 10);
  }
}

TEST_F(WaitingOrders, ArmRefused_SaysWhy) {
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
  EXPECT_EQ(armedAfter([&] { asks.asker->claim = 8; }).refusal, Refusal::kNotHolder);
  asks.takes(9);
  EXPECT_EQ(armedAfter([&] { (void)ask(orders::Stop{}); }).refusal, Refusal::kStopCame);
  hold();
  (void)askLater(asks.asks(of(orders::LoadProfile{"nobody"})));
  auto armed = askLater(asks.asks(of(orders::Arm{})));
  release();
  EXPECT_EQ(armed.get().refusal, Refusal::kRefusedBefore);
  EXPECT_EQ(devices.opened, 0);
}

// A load goes on with what rendered by the same law, and else leaves it stopped, or untouched.
TEST_F(WaitingOrders, LoadWhileRendering_GoesOnOnlyForWhoMay) {
  begin(true);
  ASSERT_TRUE(rendersOn());
  const Person stays = person(), leaves = person();
  ASSERT_TRUE(ask(stays.asks(level(1))).accepted);
  EXPECT_EQ(station_->status().session, 2U);
  ASSERT_TRUE(rendersOn());
  hold();
  auto loaded = askLater(leaves.asks(level(1)));
  leaves.asker->connected = false;
  release();
  EXPECT_FALSE(loaded.get().accepted);
  EXPECT_EQ(station_->status().session, 2U) << "what renders is not touched";
  ASSERT_TRUE(rendersOn());
  const std::uint32_t seen = station_->status().endings;
  Person loses = person();
  loses.takes(5);
  when_it_begins = [&] { loses.asker->claim = 0; };  // what rendered has stopped by then
  loaded = askLater(loses.asks(level(1)));
  EXPECT_EQ(loaded.get().refusal, Refusal::kNotHolder);
  when_it_begins = nullptr;
  staysAt(RunState::kStopped);
  EXPECT_GT(station_->status().endings, seen) << "it has ended, and that is said";
  EXPECT_EQ(devices.open, 0);
}

// Even for who may raise it: a person is strapped in, and nobody has pressed Start.
TEST_F(WaitingOrders, AnotherHandWhileItRenders_RaisesNoLimit) {
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

TEST_F(WaitingOrders, SameHandByAnotherPath_IsTheSamePersons) {
  hand_ = kRoot + "/tests/../config/hands/adult-median-right.toml";
  begin();
  ASSERT_TRUE(ask(parameter("effort_limit_arm_n", 4.0)).accepted);
  Order load = of(orders::LoadExercise{.hand = "adult-median-right", .level = 1});
  load.may_raise_limits = true;
  ASSERT_TRUE(ask(person().asks(load)).accepted);
  EXPECT_EQ(value("effort_limit_arm_n"), 4.0);
}

// The screen of who presses Start shows p-1; p-2's order to load waits before it.
TEST_F(WaitingOrders, ArmBehindAnotherPersons_StartsOnlyForWhoLoadedThem) {
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

TEST_F(WaitingOrders, SaveProfile_WritesTheValuesOfTheMomentWhenItWasAsked) {
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
  EXPECT_EQ(written->help, Help::kUnsaid);
}

// Saved as p-1 while p-2's order to load waits before it: what holds then is p-2's.
TEST_F(WaitingOrders, SaveProfileBehindAnotherPersons_KeepsTheHandAndClaimsNothing) {
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

TEST_F(WaitingOrders, LoadProfile_OverwritesNothingThatWasSetLater) {
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

// A console that still shows the patient before moves a slider while the next visit is being
// opened. Only what lowers the next one's limit stays.
TEST_F(WaitingOrders, OpenVisit_TakesOverNothingThatWasSetMeanwhileButALowerLimit) {
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
  EXPECT_EQ(station_->status().help, Help::kUnsaid);
}

// Nothing of the earlier patient outlives a change of hand, side or person; a limit rises only by
// the press of somebody who may set it.
TEST_F(WaitingOrders, ChangeOfThePerson_SetsEverythingToItsDefault) {
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
    EXPECT_EQ(station_->status().help, Help::kUnsaid);
    EXPECT_EQ(station_->scene()->profile, "");
    for (const PublishedParameter& p : after) {
      const bool limit = p.name.starts_with("effort_limit_");
      const bool stays = limit && !therapist && set.contains(p.name);
      EXPECT_EQ(value(p.name.c_str()), stays ? set[p.name] : p.initial) << p.name << therapist;
      if (limit && !therapist) set.erase(p.name);
    }
    if (!therapist) {  // for the next case
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

TEST_F(WaitingOrders, RestOfTheEarlierPerson_IsNoRestOfTheNext) {
  begin(true);
  ASSERT_TRUE(rendersOn());
  ASSERT_TRUE(ask(orders::Rest{}).accepted);
  ASSERT_TRUE(becomes(RunState::kStopped));
  ASSERT_TRUE(station_->status().rested);
  ASSERT_TRUE(ask(orders::LoadExercise{.hand = "woman-p05-left"}).accepted);
  EXPECT_FALSE(station_->status().rested);
}

// ---- presses around an arming

/// Pressed at random moments around an arming: while it waits, while it begins, while the loop is
/// built and while the device is enabled.
class PressesAroundAnArming : public WaitingOrders {
 protected:
  enum class Press { kRest, kStop, kEmergencyStop, kArm };

  /// The law, beside the press. A press of Arm starts the device unless any of the others follows.
  /// A rest is one that may be ended where it cancels an arming or follows a rest; after a stop
  /// nothing but an arming makes it one.
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
  /// From a station at rest, stopped or never armed.
  void drawCase() {
    pressed_.clear();
    hold();
    press(Press::kArm);
    pressSome(4);
    when_it_begins = while_it_is_built = [this] { pressSome(4); };
    devices.when_enabled = [this] { pressSome(3); };  // an arm is refused from here on
    release();
    EXPECT_TRUE(becomes([&] { return unanswered_ == 0; }));
    when_it_begins = while_it_is_built = devices.when_enabled = nullptr;
  }
  void judge() {
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
  /// For the next case: neutral, by a rest or by a stop.
  void end() {
    if (starts_) press(random_() % 2 == 0 ? Press::kStop : Press::kRest);
    EXPECT_TRUE(becomes([&] { return devices.open == 0; }));
    EXPECT_TRUE(becomes(RunState::kStopped));
    EXPECT_EQ(station_->status().rested, rests_) << pressed_;
    before_ = records_;
  }

  std::mt19937_64 random_ = seededRandom(3407);
  std::string pressed_;             ///< A arm, R rest, E stop, s emergency stop
  std::atomic<int> unanswered_{0};  ///< orders to arm
  bool starts_ = false, rests_ = false;
  std::uint64_t before_ = 0;
};

TEST_F(PressesAroundAnArming, InAnyOrder_StartItOrRestOrStopAsTheLastOnesSay) {
  begin();
  int rests = 0, starts = 0;
  for (int i = 0; i < cases(100) && !HasFailure(); ++i) {
    drawCase();
    judge();
    rests += rests_ ? 1 : 0;
    starts += starts_ ? 1 : 0;
    end();
  }
  figure("armings that presses of Rest, Stop and Arm surround", cases(100), "");
  figure("of them ended as a rest", rests, "");
  figure("of them started", starts, "");
}

// The device refuses: who pressed Go on may press it again.
TEST_F(PressesAroundAnArming, ArmThatFails_LeavesTheRest) {
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
  /// A therapist, who needs no controls, and who is shown how far it is.
  std::unique_ptr<WebSocket> armsAndSeesTheRehearsal() {
    auto client =
        std::make_unique<WebSocket>(server_->port(), "", std::string("/ws?role=therapist"));
    client->say(words::armHavingSeen(station_->status().endings, 1));
    std::uint32_t rehearsed = 0;
    for (const auto until = Clock::now() + kHang; rehearsed == 0 && Clock::now() < until;) {
      const auto frame = replies::next(*client, replies::fb::Payload::WorldState);
      if (!frame) break;
      rehearsed = replies::message(*frame).payload_as_WorldState()->rehearsed_ticks();
    }
    EXPECT_GT(rehearsed, 0U);
    return client;
  }

  /// Hears states until one is so, and shows that it is alive.
  template <class Condition>
  bool sees(WebSocket& client, Condition&& so) {
    for (const auto until = Clock::now() + 20s; Clock::now() < until && !client.closed();) {
      client.say(words::heartbeat(0));
      const auto frame = client.hear(50ms);
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
  /// A player rests while it is being armed, sees it, and goes on.
  void restsAndGoesOn(WebSocket& player, std::uint32_t id) {
    using State = replies::fb::WorldState;
    ASSERT_TRUE(sees(player, [](const State& s) { return s.arming(); }));
    player.say(words::takeControls(id));
    player.say(words::rest(id + 1));
    std::uint32_t shown = 0;
    ASSERT_TRUE(sees(player, [&](const State& s) {
      shown = s.endings();
      return s.rested() && !s.arming() && s.run_state() == replies::fb::RunState::Stopped;
    }));
    EXPECT_EQ(records_, 0U) << kAlways << "nothing was rendered";
    player.say(words::takeControls(id + 2));
    player.say(words::armHavingSeen(shown, id + 3));
    EXPECT_TRUE(sees(player, [](const State& s) {
      return s.run_state() == replies::fb::RunState::Rendering;
    })) << refusals_;
  }

  std::string refusals_;  ///< that were heard
};

TEST_F(ArmOverALine, OfAPlayerWhoRestsMeanwhile_GoesOnByTheNextPress) {
  open();
  WebSocket player(server_->port(), "", std::string("/ws?role=player"));
  player.say(words::takeControls(1));
  player.say(words::armHavingSeen(1, 2));
  restsAndGoesOn(player, 3);
}

// A player who is led may not begin, but may end its own rest.
TEST_F(ArmOverALine, OfATherapistWhosePlayerRestsMeanwhile_GoesOnByThePlayersPress) {
  open();
  WebSocket player(server_->port(), "", std::string("/ws?role=player"));
  const auto therapist = armsAndSeesTheRehearsal();
  restsAndGoesOn(player, 1);
}

TEST_F(ArmOverALine, ThatEndsDuringTheRehearsal_StartsNothing) {
  open();
  armsAndSeesTheRehearsal().reset();
  EXPECT_TRUE(becomes([&] { return station_->status().rehearsed_ticks == 0; }));
  staysAt(RunState::kDisarmed);
  EXPECT_EQ(records_, 0U);
  EXPECT_EQ(station_->status().session, 0U);
}

TEST_F(ArmOverALine, ThatStays_Starts) {
  open();
  const auto client = armsAndSeesTheRehearsal();
  EXPECT_TRUE(replies::answer(*client).accepted);
  EXPECT_TRUE(rendersOn());
}

// ---- stops in every state

// A game that repeats its stop every 10 ms must not keep everybody from naming the last ending.
TEST_F(WaitingOrders, StopsThatAreRepeated_CountOnceUntilSomebodyArms) {
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

// A stop that is pressed again is another one: what was asked before it is void, where it comes
// later.
TEST_F(WaitingOrders, StopThatIsPressedAgain_CountsAgain) {
  begin();
  const Person game = person();
  Order pressed = game.asks(of(orders::EmergencyStop{}));
  pressed.id = 7;
  ASSERT_TRUE(ask(pressed).accepted);
  const Order late = person().asks(of(orders::Arm{}));  // sent now, and long on its way
  const std::uint32_t shown = station_->status().endings;
  for (int i = 0; i < 300; ++i) ASSERT_TRUE(ask(pressed).accepted);
  EXPECT_EQ(station_->status().endings, shown);
  pressed.id = 8;
  for (int i = 0; i < 300; ++i) ASSERT_TRUE(ask(pressed).accepted);
  EXPECT_EQ(station_->status().endings, shown + 1);
  EXPECT_EQ(ask(late).refusal, Refusal::kStopNotSeen);
}

// As of a game that numbers nothing, a second after its last one, and of the program that the
// station is in, at any time.
TEST_F(WaitingOrders, StopWithoutANumber_IsAPressOfItsOwn) {
  begin();
  const Person game = person();
  for (const orders::Any& stop : kStops) {
    for (const bool inside : {false, true}) {
      const Order pressed = inside ? of(stop) : game.asks(of(stop));
      ASSERT_TRUE(ask(pressed).accepted);
      const Order late = person().asks(of(orders::Arm{}));  // sent now, and long on its way
      if (!inside) passes(1000);
      ASSERT_TRUE(ask(pressed).accepted);
      EXPECT_EQ(ask(late).refusal, Refusal::kStopNotSeen);
      EXPECT_NE(station_->status().run_state, RunState::kRendering);
    }
  }
}

TEST_F(WaitingOrders, StopThatIsRepeatedWhileAnArmWaits_UndoesItAndCounts) {
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

// A game that numbers nothing: every one of its stops is obeyed, and they count as one.
TEST_F(WaitingOrders, EmergencyStopsWithId0ByDatagram_AreObeyedAndCountOnce) {
  begin(true);
  ASSERT_TRUE(rendersOn());
  constexpr std::uint64_t kKey = 0x1234;
  constexpr UdpEndpoint kAnyPort{0x7F000001, 0};
  ControlsArbiter controls;
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
      game.say(words::emergencyStop(0));
      return bridge.counters().stops >= said;
    }));
  }
  EXPECT_TRUE(becomes(RunState::kStopped));
  expectNeutral();
  EXPECT_EQ(station_->status().endings, shown + 2) << "the stop, and the end of the session";
}

// Law: in every state, of whomever, a stop is accepted and leads to neutral; nothing renders after.
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
