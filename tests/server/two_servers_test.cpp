#include "server/control_desk.hpp"
#include "server/udp_host_fixture.hpp"

// Browsers and games share one set of controls, through two servers with a thread each: whatever
// they do, and in whatever order their servers' words reach the program.
namespace wholehand::udp {
namespace {

class TwoServers : public UdpHost {
 protected:
  TwoServers() {
    for (auto& number : browsers) number = controls.newClient();
  }

  void followDesk() {
    const ControlDesk::Advice advice = desk.advance(now_ns);
    if (advice.give_back) tell(OrderType::kSteer, 0.0, advice.claim);
    if (advice.owner_alive)
      tell(OrderType::kOwnerAlive, *advice.owner_alive ? 1.0 : 0.0, advice.claim);
  }
  void tell(OrderType type, double value, std::uint32_t claim) {
    Order order;
    order.type = type;
    order.value = value;
    order.claim = claim;
    backend.order(order, [](const OrderReply&) {});
  }
  /// What games said arrives; the host's words wait.
  void arrive() {
    for (const auto& [from, d] : std::exchange(arriving, {})) host.receive(from, d, now_ns);
  }
  void someBrowserActs() {
    auto& number = browsers[random() % browsers.size()];
    switch (random() % 4) {
      case 0:
        (void)desk.take(number, now_ns);
        break;
      case 1:
        (void)desk.release(number);
        break;
      case 2:
        desk.left(number, now_ns);
        number = controls.newClient();
        break;
      default:
        desk.heard(number, now_ns);
    }
    if (random() % 2 == 0) followDesk();  // as after every message; else with the next frame
  }
  void someGameActs() {
    TestGame& who = random() % 2 == 0 ? game : other;
    switch (random() % 4) {
      case 0:
        who.command(words::takeControls(++id));
        break;
      case 1:
        who.command(words::releaseControls(++id));
        break;
      case 2:
        who.say(Kind::kGoodbye);
        arrive();
        who.reliable.clear();
        who.hello(0, "", ++nonce);
        break;
      default:
        who.say(Kind::kHeartbeat);
    }
    arrive();
  }
  /// Time goes by; all that the two servers have to say is heard.
  void quiet(int ms, bool alive) {
    for (int i = 0; i < ms; i += 10) {
      now_ns += 10 * kMillisecond_ns;
      if (alive) {
        for (const auto number : browsers) desk.heard(number, now_ns);
        game.say(Kind::kHeartbeat);
        other.say(Kind::kHeartbeat);
      }
      host.advance(now_ns);
      settle();
      followDesk();
    }
  }

  ControlDesk desk{controls};
  std::array<ControlsArbiter::Client, 2> browsers{};
  std::uint32_t id = 0;
  std::uint64_t nonce = 10;
};

TEST_F(TwoServers, WhateverClientsDo_TheHolderIsAliveWhileItIsHeard) {
  connect(game, 0);
  connect(other, 0, 2);
  int held = 0;
  for (int round = 0; round < 1500; ++round) {
    for (int i = 0; i < 12; ++i) {
      now_ns += static_cast<std::int64_t>(random() % 20) * kMillisecond_ns;
      if (random() % 2 == 0) {
        someBrowserActs();
      } else {
        someGameActs();
      }
      if (random() % 3 == 0) host.advance(now_ns);
      if (random() % 3 == 0) settle();
      if (random() % 3 == 0) followDesk();
    }
    quiet(50, true);
    if (controls.holder() == 0) continue;
    ++held;
    ASSERT_EQ(backend.ownerAlive(), 1.0) << "round " << round << ": its exercise would stay faded";
    if (round % 10 != 0) continue;
    quiet(250, false);
    ASSERT_EQ(backend.ownerAlive(), 0.0) << "round " << round << ": nobody was heard for 250 ms";
  }
  EXPECT_GT(held, 500);
}

}  // namespace
}  // namespace wholehand::udp
