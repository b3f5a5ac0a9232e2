#include "server/udp_host_fixture.hpp"

// Who may command, silence, and what reaches games over a network that loses.
namespace wholehand::udp {
namespace {

TEST_F(UdpHost, Commands_NeedTheControlsExceptTheEmergencyStop) {
  connect(game);
  connect(other, 1000, 2);
  game.command(words::arm(1));
  settle();
  EXPECT_FALSE(game.replies().at(1).first);
  takeControls(other, 1);
  game.command(words::takeControls(2));
  game.command(words::arm(3));
  game.command(words::emergencyStop(4));
  settle();
  EXPECT_FALSE(game.replies().at(2).first);
  EXPECT_FALSE(game.replies().at(3).first);
  EXPECT_NE(game.replies().at(3).second.find("another client"), std::string::npos);
  EXPECT_TRUE(game.replies().at(4).first);
  EXPECT_EQ(backend.orders().back().type, OrderType::kEmergencyStop);
  other.command(words::releaseControls(2));
  settle();
  takeControls(game, 5);
}

TEST_F(UdpHost, BrowserThatHoldsTheControls_KeepsThem) {
  const auto browser = controls.newClient();
  ASSERT_TRUE(controls.take(browser));
  connect(game);
  ASSERT_GE(game.messages().size(), 1U);
  EXPECT_TRUE(game.messages()[0]->payload_as_Controls()->held());
  game.command(words::takeControls(1));
  settle();
  EXPECT_FALSE(game.replies().at(1).first);
  controls.release(browser);
  pass(1);
  const auto* told = game.messages().back()->payload_as_Controls();
  ASSERT_NE(told, nullptr) << "it is told that nobody holds them any more";
  EXPECT_FALSE(told->held());
  takeControls(game, 2);
}

TEST_F(UdpHost, BrowserVanishesJustBeforeATakeover_ItsAimDoesNotGoOn) {
  connect(game);
  const auto browser = controls.newClient();
  ASSERT_TRUE(controls.take(browser));
  Order steer;
  steer.type = OrderType::kSteer;
  steer.steering = Steering::kPerson;
  backend.order(steer, [](const OrderReply&) {});
  ASSERT_TRUE(controls.release(browser));
  takeControls(game, 1);
  EXPECT_EQ(backend.status().steering, Steering::kVirtualPatient);
  EXPECT_EQ(backend.ownerAlive(), 1.0);
}

TEST_F(UdpHost, CommandOutOfRange_IsRefusedWithTheReasonAndChangesNothing) {
  connect(game);
  takeControls(game, 1);
  game.command(words::setParameter(2, "lead_in_m", 5.0));
  game.command(words::setParameter(3, "no_such", 5.0));
  settle();
  EXPECT_EQ(game.replies().at(2),
            (std::pair{false, std::string("lead_in_m must be in [0, 0.02] m")}));
  EXPECT_FALSE(game.replies().at(3).first);
  EXPECT_EQ(backend.record(0).exercise.values[0], 0.005);
  game.command(words::setParameter(4, "lead_in_m", 0.015));
  settle();
  EXPECT_TRUE(game.replies().at(4).first);
  EXPECT_EQ(backend.record(0).exercise.values[0], 0.015);
}

TEST_F(UdpHost, Aims_ActEachAndAreAnsweredOnlyWhenRefusedFirst) {
  connect(game);
  for (std::uint32_t id = 1; id <= 100; ++id) game.command(words::aim(id, std::vector<float>(9)));
  settle();
  EXPECT_EQ(game.replies().size(), 1U);
  takeControls(game, 101);
  for (std::uint32_t id = 102; id <= 201; ++id) {
    game.command(words::aim(id, std::vector<float>(9, 0.01F)));
  }
  game.command(words::aim(150, std::vector<float>(9)));  // an old one must not pull back
  settle();
  EXPECT_EQ(backend.aims(), 100);
  EXPECT_NEAR(backend.record(0).exercise.values[3], 0.01, 1e-9);
  EXPECT_EQ(game.replies().size(), 2U);
}

TEST_F(UdpHost, SilentGame_LosesTheControlsAfter200msAndMustTakeThemAnew) {
  connect(game);
  takeControls(game, 1);
  pass(200);
  EXPECT_EQ(backend.ownerAlive(), 1.0);
  pass(1);
  EXPECT_EQ(backend.ownerAlive(), 0.0);
  EXPECT_EQ(counters.silences, 1U);
  EXPECT_EQ(controls.holder(), 0U);
  const auto* told = game.messages().back()->payload_as_Controls();
  ASSERT_NE(told, nullptr) << "it is told";
  EXPECT_FALSE(told->held_by_you());
  game.say(Kind::kHeartbeat);
  game.command(words::aim(2, std::vector<float>(9)));
  settle();
  EXPECT_EQ(backend.ownerAlive(), 0.0) << "to be heard again is not enough";
  EXPECT_FALSE(game.replies().at(2).first);
  takeControls(game, 3);
  EXPECT_EQ(backend.ownerAlive(), 1.0);
  for (int i = 0; i < 20; ++i) {
    pass(100);
    game.say(Kind::kHeartbeat);
    settle();
  }
  EXPECT_EQ(counters.silences, 1U) << "every 100 ms is often enough";
}

TEST_F(UdpHost, HeartbeatEverySecondFor24s_ChangesTheEffortOnce) {
  connect(game);
  takeControls(game, 1);
  const auto changesOf = [&] {
    const auto& orders = backend.orders();
    return std::count_if(orders.begin(), orders.end(),
                         [](const Order& o) { return o.type == OrderType::kOwnerAlive; });
  };
  const auto before = changesOf();
  for (int i = 0; i < 24; ++i) {
    game.say(Kind::kHeartbeat);
    pass(1000);
  }
  EXPECT_EQ(changesOf(), before + 1);
  EXPECT_EQ(backend.ownerAlive(), 0.0);
  EXPECT_EQ(counters.peers, 1U) << "it is connected all the same";
}

TEST_F(UdpHost, GameThatOnlyAcknowledges_CountsAsSilent) {
  connect(game);
  takeControls(game, 1);
  for (std::uint64_t i = 0; i < 30; ++i) {
    TickRecord record = backend.record(i);
    record.exercise.event_count = 1;
    host.publish(record, backend.status(), now_ns);
    pass(10);  // events come, and are acknowledged: its main thread may hang all the same
  }
  EXPECT_EQ(backend.ownerAlive(), 0.0);
}

TEST_F(UdpHost, GameWithoutControls_MayBeSilent) {
  connect(game);
  pass(1000);
  EXPECT_TRUE(backend.orders().empty());
  EXPECT_EQ(counters.silences, 0U);
}

TEST_F(UdpHost, GameGoneForFiveSeconds_LosesTheControlsToTheVirtualPatient) {
  connect(game);
  takeControls(game, 1);
  game.command(words::steer(2, test::fb::Steering::Person));
  settle();
  ASSERT_EQ(backend.status().steering, Steering::kPerson);
  pass(5200);  // its network acknowledged after 201 ms that the controls were lost
  EXPECT_EQ(counters.peers, 1U);
  EXPECT_EQ(backend.ownerAlive(), 0.0);
  pass(2);
  EXPECT_EQ(counters.peers, 0U);
  EXPECT_EQ(counters.peers_lost, 1U);
  EXPECT_EQ(controls.holder(), 0U);
  EXPECT_EQ(backend.ownerAlive(), 0.0);
  EXPECT_EQ(backend.status().steering, Steering::kVirtualPatient);
  EXPECT_EQ(backend.ownerAlive(), 0.0) << "nothing pushes until somebody takes the controls";
  const auto before = ignored(UdpIgnored::kUnknownPeer);
  game.say(Kind::kHeartbeat);
  settle();
  EXPECT_EQ(ignored(UdpIgnored::kUnknownPeer), before + 1);
}

TEST_F(UdpHost, GameThatHangsForFiveSeconds_LosesTheControlsAndIsTold) {
  connect(game);
  takeControls(game, 1);
  for (std::uint64_t i = 0; i < 53; ++i) {
    TickRecord record = backend.record(i);
    record.exercise.event_count = 1;
    host.publish(record, backend.status(), now_ns);  // it acknowledges, and no more
    pass(100);
  }
  EXPECT_EQ(counters.peers, 1U);
  EXPECT_EQ(controls.holder(), 0U);
  EXPECT_EQ(backend.status().steering, Steering::kVirtualPatient);
  bool told = false;
  for (const test::fb::Message* m : game.messages()) {
    if (const auto* c = m->payload_as_Controls()) told = !c->held_by_you();
  }
  EXPECT_TRUE(told);
}

TEST_F(UdpHost, Goodbye_ReleasesTheControlsAndFadesTheExerciseOut) {
  connect(game);
  takeControls(game, 1);
  game.say(Kind::kGoodbye);
  settle();
  EXPECT_EQ(counters.peers, 0U);
  EXPECT_EQ(controls.holder(), 0U);
  EXPECT_EQ(backend.ownerAlive(), 0.0);
  connect(other, 1000, 2);
  takeControls(other, 1);
  EXPECT_EQ(backend.ownerAlive(), 1.0);
}

TEST_F(UdpHost, GameThatVanished_IsFollowedByTheVirtualPatient) {
  connect(game);
  takeControls(game, 1);
  game.command(words::steer(2, test::fb::Steering::Person));
  game.say(Kind::kGoodbye);
  settle();
  pass(5000);
  EXPECT_EQ(backend.ownerAlive(), 0.0);
  EXPECT_EQ(backend.status().steering, Steering::kPerson);
  pass(2);
  EXPECT_EQ(backend.ownerAlive(), 0.0);
  EXPECT_EQ(backend.status().steering, Steering::kVirtualPatient);
  const auto orders = backend.orders().size();
  pass(6000);
  EXPECT_EQ(backend.orders().size(), orders) << "once";
}

TEST_F(UdpHost, ReleasedControls_LetTheVirtualPatientPlayAtOnce) {
  connect(game);
  takeControls(game, 1);
  game.command(words::steer(2, test::fb::Steering::Person));
  game.command(words::releaseControls(3));
  settle();
  EXPECT_EQ(backend.status().steering, Steering::kVirtualPatient);
  EXPECT_EQ(backend.ownerAlive(), 1.0);
  EXPECT_TRUE(controls.handedBack());
  pass(300);
  EXPECT_EQ(backend.ownerAlive(), 1.0) << "who does not hold them may be silent";
}

TEST_F(UdpHost, MoreCommandsThanTicks_AreIgnoredButStops) {
  connect(game);
  takeControls(game, 1);
  for (std::uint32_t id = 2; id <= 3000; ++id) {
    game.command(words::aim(id, std::vector<float>(9)));
    settle();
  }
  EXPECT_EQ(backend.aims(), 1199);  // 1200 a second, TakeControls among them
  EXPECT_EQ(ignored(UdpIgnored::kRate), 1800U);
  game.command(words::stop(3001));
  settle();
  EXPECT_EQ(backend.orders().back().type, OrderType::kStop);
  game.command(words::emergencyStop(3002));
  settle();
  EXPECT_EQ(backend.orders().back().type, OrderType::kEmergencyStop);
  game.command(words::arm(3003));  // whoever waits for an answer is told which
  settle();
  EXPECT_EQ(game.replies()[3003].second,
            "Arm: more than 1200 commands in a second, those beyond are dropped");
  pass(1000);
  takeControls(game, 3004);
  game.command(words::aim(3005, std::vector<float>(9)));
  settle();
  EXPECT_EQ(backend.aims(), 1200);
}

TEST_F(UdpHost, GameStartedAnew_BeginsAConversationAndLosesTheOldOne) {
  connect(game);
  takeControls(game, 1);
  game.reliable.clear();
  connect(game, 500, 2);
  EXPECT_EQ(counters.peers, 1U);
  EXPECT_EQ(controls.holder(), 0U);
  takeControls(game, 1);
}

TEST_F(UdpHost, States_ComeAtTheRateOfEachGame) {
  connect(game, 1000);
  connect(other, 60, 2);
  for (std::uint64_t tick = 1; tick <= 2000; ++tick) publish(tick);
  ASSERT_EQ(game.state_ticks.size(), 2000U);
  for (std::uint64_t i = 0; i < 2000; ++i) {
    EXPECT_EQ(game.state_ticks[i], i + 1);
    EXPECT_EQ(game.state_sequences[i], i + 1);
  }
  EXPECT_NEAR(static_cast<double>(other.state_ticks.size()), 120.0, 1.0);
  const auto* state = TestGame::verified(game.last_state).payload_as_WorldState();
  EXPECT_EQ(state->q_s()->size(), 9U);
  EXPECT_EQ(state->theta()->size(), 19U);
  EXPECT_EQ(state->values()->size(), 48U);
  EXPECT_LE(game.largest, kLargestDatagram);
}

TEST_F(UdpHost, LossBothWays_EventsAndRepliesComeCompleteAndCommandsActOnce) {
  connect(game, 10);
  takeControls(game, 1);
  const auto begun = backend.orders().size();
  loss = 0.3;
  std::uint32_t answered = 1;
  std::uint64_t tick = 0;
  for (int i = 0; i < 30'000 && (answered < 41 || tick < 60 || host.peers()[0].outbox.size() > 0);
       ++i) {
    if (i % 100 == 0 && tick < 60) {
      TickRecord record = backend.record(++tick);
      record.exercise.event_count = 1;
      record.exercise.events[0] = {0, 0, static_cast<double>(tick)};
      host.publish(record, backend.status(), now_ns);
    }
    if (i == 500) {
      backend.changeScene();
      host.setScene(backend.scene(), now_ns);
    }
    // One command after the other, each repeated until it is answered.
    if (game.replies().count(answered) != 0 && answered < 41) ++answered;
    if (i % 50 == 0 && answered < 41) {
      game.command(words::setParameter(answered, "lead_in_m", 0.0001 * answered));
    }
    if (i % 50 == 25) game.say(Kind::kHeartbeat);
    pass(1);
  }
  EXPECT_GT(counters.repeated, 20U) << "nothing was lost: this tests nothing";
  std::vector<double> parameters;
  for (const Order& order : backend.orders()) {
    if (order.type == OrderType::kSetParameter) parameters.push_back(order.value);
  }
  ASSERT_EQ(parameters.size(), 39U);  // ids 2 .. 40
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    EXPECT_NEAR(parameters[i], 0.0001 * static_cast<double>(i + 2), 1e-12);
  }
  EXPECT_GE(backend.orders().size(), begun + 39);
  std::vector<double> events;
  int scenes = 0;
  for (const test::fb::Message* m : game.messages()) {
    if (const auto* e = m->payload_as_Events()) {
      for (const auto* event : *e->events()) events.push_back(static_cast<double>(event->value()));
    }
    scenes += m->payload_as_Scene() != nullptr ? 1 : 0;
  }
  ASSERT_EQ(events.size(), 60U);
  for (std::size_t i = 0; i < 60; ++i) EXPECT_EQ(events[i], static_cast<double>(i + 1));
  EXPECT_EQ(scenes, 2);
}

TEST_F(UdpHost, GameThatNeverAcknowledges_IsRemovedAndTheOthersGoOn) {
  connect(game);
  connect(other, 1000, 2);
  game.acknowledges = false;
  for (std::uint64_t tick = 1; tick <= 600; ++tick) {
    TickRecord record = backend.record(tick);
    record.exercise.event_count = 1;
    host.publish(record, backend.status(), now_ns);
    if (tick % 50 == 0) {
      game.say(Kind::kHeartbeat);
      other.say(Kind::kHeartbeat);
    }
    pass(1);
  }
  EXPECT_EQ(counters.peers, 1U);
  EXPECT_EQ(counters.peers_lost, 1U);
  EXPECT_EQ(other.state_ticks.size(), 600U);
}

TEST_F(UdpHost, LargeCommandInPieces_IsRead) {
  connect(game);
  takeControls(game, 1);
  const std::string long_name(3000, 'x');
  game.command(words::load(2, long_name.c_str(), 1, ""));
  EXPECT_EQ(arriving.size(), 3U);
  std::swap(arriving[0], arriving[2]);
  settle();
  EXPECT_EQ(backend.orders().back().name, long_name);
  game.command(words::load(3, std::string(5000, 'x').c_str(), 1, ""));
  settle();
  EXPECT_GE(ignored(UdpIgnored::kFragment), 1U);
}

TEST_F(UdpHost, FullSocket_DropsAndCounts) {
  connect(game);
  full = true;
  for (std::uint64_t tick = 1; tick <= 100; ++tick) publish(tick);
  EXPECT_EQ(counters.dropped_full, 100U);
  full = false;
  publish(101);
  EXPECT_EQ(game.state_ticks, (std::vector<std::uint64_t>{101}));
}

TEST_F(UdpHost, WithoutRecords_TheProgramSaysThatItIsThere) {
  connect(game);
  for (int i = 0; i < 10; ++i) {
    pass(100);
    game.say(Kind::kHeartbeat);
  }
  EXPECT_GE(game.heard[Kind::kHeartbeat], 9);
  host.publishIdle(backend.record(7), backend.status(), now_ns);
  host.publishIdle(backend.record(7), backend.status(), now_ns);
  settle();
  EXPECT_EQ(game.state_ticks, (std::vector<std::uint64_t>{7, 7}));
}

TEST_F(UdpHost, EndOfTheProgram_IsSaid) {
  connect(game);
  host.sayGoodbye(now_ns);
  settle();
  EXPECT_EQ(game.heard[Kind::kGoodbye], 1);
  EXPECT_TRUE(host.peers().empty());
}

}  // namespace
}  // namespace wholehand::udp
