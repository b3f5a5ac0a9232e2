#include "core/crc32.hpp"
#include "server/udp_host_fixture.hpp"

// Who may speak, and what is ignored.
namespace wholehand::udp {
namespace {

TEST_F(UdpHost, Hello_IsWelcomedAndGetsTheSceneOnce) {
  connect(game);
  EXPECT_EQ(game.heard[Kind::kWelcome], 1);
  ASSERT_EQ(game.messages().size(), 1U);
  const auto* scene = game.messages()[0]->payload_as_Scene();
  ASSERT_NE(scene, nullptr);
  EXPECT_EQ(scene->capsules()->size(), 40U);
  EXPECT_GT(game.heard[Kind::kReliable], 1) << "this scene is meant to need several datagrams";
  EXPECT_LE(game.largest, kLargestDatagram);
  pass(1000);
  EXPECT_EQ(counters.repeated, 0U);
  backend.changeScene();
  host.setScene(backend.scene(), now_ns);
  settle();
  ASSERT_EQ(game.messages().size(), 2U);
  EXPECT_EQ(game.messages()[1]->payload_as_Scene()->session(), 2U);
}

TEST_F(UdpHost, BadDatagrams_AreCountedByReasonAndNeverAnswered) {
  connect(game);
  takeControls(game, 1);
  const std::uint64_t before = counters.received;
  leaving.clear();
  game.say(Kind::kHeartbeat);
  const TestGame::Bytes good = std::exchange(arriving, {})[0].bytes;
  struct Bad {
    UdpIgnored reason;
    TestGame::Bytes bytes;
  };
  const auto changed = [&](std::size_t at, std::uint8_t value) {
    TestGame::Bytes bytes = good;
    bytes[at] = value;
    const auto all = std::as_bytes(std::span(bytes)), payload = all.subspan(kHeaderSize);
    const std::uint32_t crc = crc32(crc32(0, all.data(), 32), payload.data(), payload.size());
    for (int i = 0; i < 4; ++i) bytes[32 + i] = static_cast<std::uint8_t>(crc >> (8 * i));
    return bytes;
  };
  TestGame::Bytes damaged = good;
  damaged[16] ^= 1U;
  TestGame::Bytes longer = good;
  longer.push_back(0);
  const std::vector<Bad> all = {
      {UdpIgnored::kTooShort, {}},
      {UdpIgnored::kTooShort, {good.begin(), good.end() - 1}},
      {UdpIgnored::kTooLong, TestGame::Bytes(kLargestDatagram + 1)},
      {UdpIgnored::kMagic, changed(0, 'w')},
      {UdpIgnored::kVersion, changed(4, 9)},
      {UdpIgnored::kLength, longer},
      {UdpIgnored::kChecksum, damaged},
      {UdpIgnored::kHeader, changed(6, 99)},
      {UdpIgnored::kHeader, changed(6, static_cast<std::uint8_t>(Kind::kState))},
      {UdpIgnored::kSession, changed(8, static_cast<std::uint8_t>(good[8] ^ 1U))},
      {UdpIgnored::kFragment, changed(26, 2)},  // the first of two, but not full
  };
  std::map<UdpIgnored, std::uint64_t> expected;
  for (const Bad& bad : all) {
    host.receive(kGame, bad.bytes, now_ns);
    EXPECT_EQ(ignored(bad.reason), ++expected[bad.reason]) << udpIgnoredName(bad.reason);
  }
  EXPECT_EQ(counters.received, before + all.size());
  EXPECT_TRUE(leaving.empty());
  EXPECT_TRUE(host.takeOrders().empty());
  host.receive(kGame, good, now_ns);  // the window is as it was
  host.receive(kGame, good, now_ns);
  EXPECT_EQ(ignored(UdpIgnored::kReplayed), 1U);
}

TEST_F(UdpHost, RandomBytesFromAGame_ChangeNothing) {
  connect(game);
  takeControls(game, 1);
  const auto orders = backend.orders().size();
  for (int i = 0; i < 20'000; ++i) {
    TestGame::Bytes bytes(random() % 300);
    for (auto& b : bytes) b = static_cast<std::uint8_t>(random());
    if (i % 2 == 0)
      game.command(bytes);  // in a sound datagram
    else
      host.receive(kGame, bytes, now_ns);
    if (i % 100 == 0) settle();
  }
  settle();
  EXPECT_EQ(backend.orders().size(), orders);
  EXPECT_GE(ignored(UdpIgnored::kMessage), 9'900U);
}

TEST_F(UdpHost, UnreadableMessage_IsAnsweredWithTheReason) {
  connect(game);
  game.command({1, 2, 3});
  settle();
  EXPECT_FALSE(game.replies().at(0).first);
  EXPECT_NE(game.replies().at(0).second, "");
}

TEST_F(UdpHost, UnknownPeers_AreIgnoredAndCounted) {
  other.say(Kind::kHeartbeat);
  other.command(words::emergencyStop(1));
  elsewhere.hello(1000);
  settle();
  EXPECT_EQ(ignored(UdpIgnored::kUnknownPeer), 3U);
  EXPECT_TRUE(backend.orders().empty());
  EXPECT_TRUE(elsewhere.heard.empty());
  EXPECT_EQ(counters.peers, 0U);
}

TEST_F(UdpHost, HelloWithAnotherSchema_IsRefusedInWords) {
  game.hello(1000, "", 1, wire::kSchemaVersion + 1);
  settle();
  EXPECT_EQ(game.session, 0U);
  EXPECT_NE(game.refusal.find("wholehand.fbs"), std::string::npos) << game.refusal;
  EXPECT_EQ(ignored(UdpIgnored::kSchema), 1U);
}

TEST_F(UdpHost, OneGameTooMany_IsRefusedInWords) {
  for (std::uint16_t i = 0; i < 4; ++i) {
    TestGame more = makeGame({0x7F000001, static_cast<std::uint16_t>(6000 + i)});
    more.hello(10, "", 100U + i);
    for (const auto& [from, d] : std::exchange(arriving, {})) host.receive(from, d, now_ns);
    for (const auto& [to, d] : std::exchange(leaving, {})) more.hear(d);
    settle();  // it answers
  }
  EXPECT_EQ(counters.peers, 4U);
  game.hello(1000);
  settle();
  EXPECT_EQ(game.session, 0U);
  EXPECT_NE(game.refusal, "");
}

class UdpHostWithToken : public UdpHost {
 protected:
  UdpHostWithToken() : UdpHost({{{kElsewhere.address, 0}}, "a long secret", 4}) {}
};

TEST_F(UdpHostWithToken, Hello_NeedsIt) {
  for (const char* wrong :
       {"", "a long secre", "a long secret.", "A long secret", "a long secreta long secret"}) {
    game.hello(1000, wrong);
    settle();
    EXPECT_EQ(game.session, 0U) << wrong;
    EXPECT_NE(game.refusal, "");
  }
  EXPECT_EQ(ignored(UdpIgnored::kToken), 5U);
  game.hello(1000, "a long secret");
  settle();
  EXPECT_NE(game.session, 0U);
}

TEST_F(UdpHostWithToken, ListedHost_MaySayHelloFromAnyPort) {
  elsewhere.hello(1000, "a long secret");
  settle();
  EXPECT_NE(elsewhere.session, 0U);
}

TEST_F(UdpHost, HelloRepeated_IsWelcomedAgainAndBeginsNothing) {
  connect(game);
  const std::uint32_t session = game.session;
  takeControls(game, 1);
  game.hello(1000);  // its Welcome may have been lost
  settle();
  EXPECT_EQ(game.heard[Kind::kWelcome], 2);
  EXPECT_EQ(game.session, session);
  EXPECT_NE(controls.holder(), 0U);
}

TEST_F(UdpHost, HelloPlayedBack_DoesNotEndTheConversation) {
  game.hello(1000, "", 11);
  settle();
  const TestGame::Bytes old_hello = game.last_said;
  // last_said is the last acknowledgement by now: the Hello itself was the first to be said.
  TestGame again = makeGame(kGame);
  again.hello(1000, "", 11);
  const TestGame::Bytes recorded = std::exchange(arriving, {})[0].bytes;
  connect(game, 1000, 12);
  const std::uint32_t session = host.peers()[0].session;
  host.receive(kGame, recorded, now_ns);
  EXPECT_EQ(host.peers()[0].session, session);
  EXPECT_EQ(ignored(UdpIgnored::kReplayed), 1U);
}

TEST_F(UdpHost, CommandPlayedBack_IsCarriedOutOnce) {
  connect(game);
  takeControls(game, 1);
  game.command(words::setParameter(2, "lead_in_m", 0.01));
  const TestGame::Bytes recorded = arriving.back().bytes;
  settle();
  const auto carried_out = backend.orders().size();
  for (int i = 0; i < 100; ++i) {
    host.receive(kGame, recorded, now_ns);
    game.say(Kind::kHeartbeat);  // also when it has left the window
    settle();
  }
  EXPECT_EQ(backend.orders().size(), carried_out);
  EXPECT_EQ(ignored(UdpIgnored::kReplayed), 100U);
  // In a new datagram, as a game repeats it whose answer was lost.
  game.command(words::setParameter(2, "lead_in_m", 0.01));
  settle();
  EXPECT_EQ(backend.orders().size(), carried_out);
  EXPECT_EQ(ignored(UdpIgnored::kCommand), 1U);
}

TEST_F(UdpHost, LateArm_DoesNotUndoTheStopThatOvertookIt) {
  connect(game);
  takeControls(game, 1);
  game.command(words::arm(2));
  auto late = std::exchange(arriving, {});
  game.command(words::emergencyStop(3));
  settle();
  arriving = late;
  settle();
  EXPECT_EQ(backend.orders().back().type, OrderType::kEmergencyStop);
  EXPECT_EQ(backend.status().run_state, RunState::kStopped);
}

TEST_F(UdpHost, LateEmergencyStop_IsObeyedAllTheSameAndOnce) {
  connect(game);
  takeControls(game, 1);
  game.command(words::emergencyStop(2));
  const auto late = std::exchange(arriving, {});
  game.command(words::arm(3));
  settle();
  ASSERT_EQ(backend.status().run_state, RunState::kRendering);
  arriving = late;
  settle();
  EXPECT_EQ(backend.status().run_state, RunState::kStopped);
  const auto orders = backend.orders().size();
  game.command(words::emergencyStop(2));  // repeated: its answer may have been lost
  settle();
  EXPECT_EQ(backend.orders().size(), orders);
}

// A game that began to count anew, or never counted: better twice than not at all.
TEST_F(UdpHost, EmergencyStopUnderAnyNumber_IsObeyed) {
  connect(game);
  takeControls(game, 1);
  std::uint32_t armed = 100;
  for (const std::uint32_t id : {0U, 90U, 50U, 0U}) {
    game.command(words::armHavingSeen(backend.status().endings, ++armed));
    settle();
    ASSERT_EQ(backend.status().run_state, RunState::kRendering);
    game.command(words::emergencyStop(id));
    settle();
    EXPECT_EQ(backend.status().run_state, RunState::kStopped) << id;
  }
}

// A Hello may carry anybody's address: whoever gets the answers must not be flooded by it.
TEST_F(UdpHost, HelloThatNobodyAnswers_BringsItsAddressLessThanThreeTimesItsBytes) {
  game.answers = false;
  game.hello(1000);
  const std::size_t said = arriving.at(0).bytes.size();
  std::size_t got = 0;
  const auto send = [&] {
    for (const auto& [from, d] : std::exchange(arriving, {})) host.receive(from, d, now_ns);
    for (const auto& [to, d] : std::exchange(leaving, {})) got += d.size();
  };
  send();
  EXPECT_GT(got, 0U);
  for (std::uint64_t tick = 1; tick <= 1500; ++tick) {
    now_ns += kMillisecond_ns;
    host.publish(backend.record(tick), backend.status(), now_ns);
    if (tick % 100 == 0) host.publishIdle(backend.record(tick), backend.status(), now_ns);
    if (tick == 500) backend.changeScene();
    host.setScene(backend.scene(), now_ns);
    host.advance(now_ns);
    send();
  }
  host.sayGoodbye(now_ns);
  send();
  std::printf("figure: a Hello of %zu bytes that nobody answers brings %zu\n", said, got);
  EXPECT_LE(got, 3 * said);
}

TEST_F(UdpHost, SilentHellosFromAnyNumberOfAddresses_KeepNoGameOut) {
  for (std::uint16_t i = 0; i < 200; ++i) {
    TestGame silent = makeGame({0x7F000001, static_cast<std::uint16_t>(6000 + i)});
    silent.hello(1000, "", 100U + i);
    settle();
  }
  EXPECT_EQ(host.peers().size(), Host::kMostUnanswered);
  EXPECT_EQ(counters.peers, 0U);
  connect(game);
  EXPECT_EQ(counters.peers, 1U);
  EXPECT_EQ(game.messages().size(), 1U);
}

TEST_F(UdpHost, SilentHello_IsForgottenAfterASecondAndMayComeAgain) {
  game.answers = false;
  game.hello(1000);
  settle();
  game.hello(1000);  // repeated: it keeps its place no longer
  settle();
  EXPECT_EQ(game.heard[Kind::kWelcome], 2);
  pass(999);
  EXPECT_EQ(host.peers().size(), 1U);
  pass(2);
  EXPECT_TRUE(host.peers().empty());
  game.answers = true;
  connect(game);
}

TEST_F(UdpHost, MoreGamesThanPlacesThatAnswerAtOnce_TheLastIsRefused) {
  std::vector<TestGame> games;
  for (std::uint16_t i = 0; i < 5; ++i) {
    games.push_back(makeGame({0x7F000001, static_cast<std::uint16_t>(6000 + i)}));
    games.back().answers = false;
    games.back().hello(0, "", 100U + i);
  }
  for (const auto& [from, d] : std::exchange(arriving, {})) host.receive(from, d, now_ns);
  for (const auto& [to, d] : std::exchange(leaving, {})) games.at(to.port - 6000U).hear(d);
  for (TestGame& g : games) g.say(Kind::kHeartbeat);
  for (const auto& [from, d] : std::exchange(arriving, {})) host.receive(from, d, now_ns);
  for (const auto& [to, d] : std::exchange(leaving, {})) games.at(to.port - 6000U).hear(d);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(games[static_cast<std::size_t>(i)].refusal, "");
  EXPECT_EQ(games[4].refusal, "4 games are connected already");
  EXPECT_EQ(host.peers().size(), 4U);
}

}  // namespace
}  // namespace wholehand::udp
