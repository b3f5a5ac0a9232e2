#include "station/server/udp_host_fixture.hpp"

// Tests which datagrams are obeyed, answered or ignored.
namespace wholehand::udp {
namespace {

TEST_F(UdpHost, DatagramWithoutAKey_IsCountedAndNotAnswered) {
  TestGame untrusted = makeGame(kElsewhere);
  untrusted.key = kGameKey + 1;
  for (int i = 0; i < 100; ++i) {
    untrusted.send();
    untrusted.send(words::emergencyStop(1));
  }
  settle();
  EXPECT_EQ(sent_bytes, 0U);
  EXPECT_TRUE(said.empty()) << "not even a stop";
  EXPECT_EQ(ignored(UdpIgnored::kKey), 200U);
}

TEST_F(UdpHost, BadDatagrams_AreCountedByReasonAndNeverAnswered) {
  const auto bad = [&](UdpIgnored reason, TestGame::Bytes d) {
    const auto before = ignored(reason);
    arrive(kGame, d);
    EXPECT_EQ(ignored(reason), before + 1) << udpIgnoredName(reason);
  };
  const TestGame::Bytes good = game.datagram(words::aim(1, {0.1F}));
  bad(UdpIgnored::kTooShort, {});
  bad(UdpIgnored::kTooShort, TestGame::Bytes(good.begin(), good.begin() + 47));
  bad(UdpIgnored::kTooLong, TestGame::Bytes(1201, 1));
  bad(UdpIgnored::kChecksum, TestGame::Bytes(good.begin(), good.end() - 1));
  bad(UdpIgnored::kMagic, TestGame::Bytes(100, 1));
  TestGame::Bytes changed = good;
  changed[4] = 1;
  bad(UdpIgnored::kVersion, changed);
  for (std::size_t at = 6; at < good.size(); ++at) {
    changed = good;
    changed[at] ^= 0x10;
    bad(UdpIgnored::kChecksum, changed);
  }
  Header header;
  header.key = kGameKey;
  header.kind = Kind::kPresent;  // a kind that only the program sends
  Datagram d;
  bad(UdpIgnored::kHeader, {d.begin(), d.begin() + write(d, header, {})});
  bad(UdpIgnored::kMessage, game.datagram({1, 2, 3}));
  EXPECT_EQ(sent_bytes, 0U);
}

TEST_F(UdpHost, OrdersThatNeedDelivery_AreRefusedByDatagram) {
  connect(game);
  said.clear();
  const auto all = words::oneOfEach();
  for (const auto& message : all) game.send(message);
  settle();
  ASSERT_EQ(said.size(), 5U) << "every stop, an aim and a heartbeat";
  EXPECT_EQ(sentOf<orders::EmergencyStop>(), 1);
  EXPECT_EQ(gentleStops(), 2) << "a rest is one";
  EXPECT_EQ(sentOf<orders::Aim>(), 1);
  EXPECT_EQ(ignored(UdpIgnored::kMessage), all.size() - 5);
}

TEST_F(UdpHost, GameWithoutWebSocket_MayAlsoTakeTheControlsAndSteer) {
  TestGame board = makeGame(kGame);
  board.key = 0xABCDEF;
  host.admit(board.key, controls.newClient(), true);
  for (int i = 0; i < 2; ++i) {
    board.send();
    for (const auto& [from, d] : std::exchange(arriving, {})) arrive(from, d);
    for (const auto& [to, d] : std::exchange(leaving, {})) board.receive(d);
  }
  (void)host.takeCommands();
  for (const auto& message : words::oneOfEach()) arrive(kGame, board.datagram(message));
  std::vector<std::string> names;
  for (const ReceivedCommand& s : host.takeCommands()) names.emplace_back(s.order.row().name);
  EXPECT_EQ(names,
            (std::vector<std::string>{"Stop", "EmergencyStop", "Aim", "Steer", "TakeControls",
                                      "ReleaseControls", "Heartbeat", "Rest"}));
}

TEST_F(UdpHost, UnprovenAddress_GetsNoMoreBytesThanItSent) {
  game.echoes = false;  // a client with the key and a forged address
  std::size_t got = 0;
  for (std::uint64_t tick = 1; tick <= 3000; ++tick) {
    if (tick % 20 == 0) {
      game.send(tick % 40 == 0 ? words::aim(static_cast<std::uint32_t>(tick), {0.1F})
                               : TestGame::Bytes{});
      got += game.last_sent.size();
    }
    publish(tick);
    pass(1);
    ASSERT_LE(sent_bytes, got) << "tick " << tick;
  }
  EXPECT_EQ(counters.states_sent, 0U);
  EXPECT_EQ(sentOf<orders::Aim>(), 0) << "it may only stop";
  game.send(words::emergencyStop(9999));
  game.send(words::stop(10'000));
  game.send(words::rest(10'001));
  settle();
  EXPECT_EQ(sentOf<orders::EmergencyStop>(), 1);
  EXPECT_EQ(gentleStops(), 2);
}

TEST_F(UdpHost, LateStop_IsPassedOnOnce) {
  connect(game);
  const TestGame::Bytes late = game.datagram(words::stop(5));
  game.send(words::aim(6, {0.1F}));
  settle();
  arrive(kGame, late);
  arrive(kGame, late);
  arrive(kElsewhere, late);
  settle();
  EXPECT_EQ(gentleStops(), 1);
  game.send(words::stop(5));  // repeated until a state shows the stop
  settle();
  EXPECT_EQ(gentleStops(), 2);
}

TEST_F(UdpHost, DatagramWithoutCommand_IsAnsweredWithOneHeader) {
  game.send();
  settle();
  for (std::uint64_t tick = 1; tick <= 3000; ++tick) {
    publish(tick);
    pass(1);
  }
  EXPECT_EQ(sent_bytes, kHeaderSize);
}

TEST_F(UdpHost, GameThatChangesItsAddress_MustProveTheNewOne) {
  connect(game);
  const std::size_t before = sent_bytes;
  arrive(kElsewhere, game.datagram());
  EXPECT_EQ(leaving.size(), 1U);
  EXPECT_EQ(leaving.at(0).where, kElsewhere);
  publish(1);
  EXPECT_EQ(sent_bytes, before + kHeaderSize) << "no state for an address that may be anybody's";
}

TEST_F(UdpHost, States_EndASecondAfterTheLastSignOfLife) {
  connect(game);
  const std::int64_t last_ns = now_ns;
  std::int64_t last_sent_ns = 0;
  for (std::uint64_t tick = 1; tick <= 3000; ++tick) {
    now_ns += kMillisecond_ns;
    const std::size_t before = sent_bytes;
    publish(tick);
    host.advance(now_ns);
    if (sent_bytes != before) last_sent_ns = now_ns;
  }
  EXPECT_EQ(last_sent_ns - last_ns, 1'000'000'000);
  EXPECT_EQ(counters.peers, 0U);
  EXPECT_EQ(counters.peers_lost, 1U);
}

TEST_F(UdpHost, EndOfTheWebSocket_EndsTheDatagrams) {
  connect(game);
  host.dismiss(client);
  const std::size_t before = sent_bytes;
  game.send(words::aim(1, {0.1F}));
  settle();
  publish(1);
  pass(200);
  EXPECT_EQ(sent_bytes, before);
  EXPECT_EQ(ignored(UdpIgnored::kKey), 1U);
  EXPECT_EQ(counters.peers, 0U);
}

TEST_F(UdpHost, ReplayedDatagram_ActsOnce) {
  connect(game);
  game.send(words::aim(1, {0.1F}));
  const TestGame::Bytes first = game.last_sent;
  settle();
  game.send(words::aim(2, {0.2F}));
  settle();
  for (int i = 0; i < 10; ++i) arrive(kGame, first);
  arrive(kElsewhere, first);
  settle();
  EXPECT_EQ(sentOf<orders::Aim>(), 2);
  EXPECT_EQ(ignored(UdpIgnored::kStale), 11U);
  EXPECT_TRUE(host.peers().front().endpoint == kGame) << "nobody moves a game by an old datagram";
  pass(1100);  // nor after the game is gone
  arrive(kElsewhere, first);
  settle();
  EXPECT_EQ(sentOf<orders::Aim>(), 2);
}

TEST_F(UdpHost, ReplayedConversationWithAFixedKey_MovesNothing) {
  TestGame board = makeGame(kGame);
  board.key = 0xABCDEF;
  host.admit(board.key, controls.newClient(), true);
  std::vector<TestGame::Bytes> overheard;
  for (int i = 0; i < 20; ++i) {
    now_ns += kMillisecond_ns;
    overheard.push_back(board.datagram(words::aim(static_cast<std::uint32_t>(i) + 1, {0.1F})));
    arrive(kGame, overheard.back());
    for (const auto& [to, d] : std::exchange(leaving, {})) board.receive(d);
  }
  EXPECT_EQ(host.takeCommands().size(), 19U) << "all but the one before it was known to listen";
  now_ns += Host::kGone_ns + kMillisecond_ns;
  host.advance(now_ns);
  for (const auto& d : overheard) arrive(kElsewhere, d);
  EXPECT_TRUE(host.takeCommands().empty());
}

TEST_F(UdpHost, LateEmergencyStop_IsObeyedOnce) {
  connect(game);
  const TestGame::Bytes late = game.datagram(words::emergencyStop(5));
  game.send(words::aim(6, {0.1F}));
  settle();
  arrive(kGame, late);
  arrive(kGame, late);
  game.send(words::emergencyStop(5));  // repeated until the game sees the stop
  settle();
  EXPECT_EQ(sentOf<orders::EmergencyStop>(), 1);
  pass(200);
  EXPECT_EQ(game.last.rate_or_stop, 5U) << "the game is shown that it was obeyed";
}

TEST_F(UdpHost, EmergencyStop_IsAcknowledgedWhenObeyedAndRetriedIfThatFailed) {
  connect(game);
  const auto repeat = [&] {
    game.send(words::emergencyStop(5));
    for (const auto& [from, d] : std::exchange(arriving, {})) arrive(from, d);
    auto stops = host.takeCommands();
    now_ns += Host::kPresent_ns;
    host.advance(now_ns);
    for (const auto& [to, d] : std::exchange(leaving, {})) game.receive(d);
    return stops;
  };
  const auto first = repeat();
  ASSERT_EQ(first.size(), 1U);
  EXPECT_EQ(game.last.rate_or_stop, 0U) << "taken, not yet obeyed";
  EXPECT_TRUE(repeat().empty()) << "it is being obeyed";
  host.finishStop(first.front(), false);
  const auto again = repeat();
  ASSERT_EQ(again.size(), 1U);
  EXPECT_EQ(game.last.rate_or_stop, 0U);
  host.finishStop(again.front(), true);
  EXPECT_TRUE(repeat().empty());
  EXPECT_EQ(game.last.rate_or_stop, 5U);
}

TEST_F(UdpHost, EmergencyStopWithAnyId_IsObeyed) {
  connect(game);
  for (const std::uint32_t id : {7U, 3U, 0U, 4'000'000'000U, 7U}) {
    game.send(words::emergencyStop(id));
  }
  settle();
  EXPECT_EQ(sentOf<orders::EmergencyStop>(), 5);
}

TEST_F(UdpHost, CommandsBeyondTheRate_AreIgnoredExceptStops) {
  connect(game);
  for (std::uint32_t id = 1; id <= 2000; ++id) game.send(words::aim(id, {0.1F}));
  game.send(words::emergencyStop(3000));
  settle();
  EXPECT_EQ(sentOf<orders::EmergencyStop>(), 1);
  // The two signs of life of the connection count, too.
  EXPECT_GE(sentOf<orders::Aim>(), Host::kMostCommands - 2);
  EXPECT_LE(sentOf<orders::Aim>(), Host::kMostCommands);
  EXPECT_EQ(ignored(UdpIgnored::kRate), 2000U - sentOf<orders::Aim>());
}

TEST_F(UdpHost, RandomBytesFromAGame_ChangeNothing) {
  connect(game);
  said.clear();
  for (int i = 0; i < 5000; ++i) {
    TestGame::Bytes message(1 + random() % 300);
    for (auto& b : message) b = static_cast<std::uint8_t>(random());
    if (message.size() > 8) std::copy_n("WHND", 4, message.begin() + 4);
    game.send(message);
    settle();
  }
  EXPECT_TRUE(said.empty());
}

TEST_F(UdpHost, States_AreSentAtTheRateOfEachGame) {
  connect(game, 1000);
  connect(other, 60);
  for (std::uint64_t tick = 1; tick <= 2000; ++tick) {
    publish(tick);
    pass(1);
    if (tick % 50 != 0) continue;
    game.send();
    other.send();
  }
  EXPECT_EQ(game.state_ticks.size(), 2000U);
  EXPECT_NEAR(static_cast<double>(other.state_ticks.size()), 120.0, 1.0);
  EXPECT_LE(game.largest, kLargestDatagram);
}

TEST_F(UdpHost, States_SayWhoHoldsTheControls) {
  connect(game);
  publish(1);
  EXPECT_FALSE(game.last.holds_controls);
  ASSERT_TRUE(controls.take(client));
  publish(2);
  EXPECT_TRUE(game.last.holds_controls);
}

TEST_F(UdpHost, Echo_ReportsTheLastDatagramAndItsAge) {
  connect(game);
  now_ns += 7'654'000;
  publish(1);
  EXPECT_EQ(game.last.echo_ns, game.sent_ns);
  EXPECT_EQ(game.last.echo_age_us, 7654U);
}

TEST_F(UdpHost, ProgramWithoutRecords_SendsSignsOfLife) {
  connect(game, 0);
  const int before = game.heard;
  for (int i = 0; i < 10; ++i) {
    game.send();
    pass(100);
  }
  EXPECT_EQ(game.heard - before, 10);
}

}  // namespace
}  // namespace wholehand::udp
