#include "station/server/wire.hpp"

#include "loop/realtime/allocation_counter.hpp"
#include "station/server/client_words.hpp"
#include "station/server/sample_facts.hpp"
#include "support/rig_tools.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

// Messages are read back by flatc's own accessors after its verifier has passed them, as a client
// in another language does.
namespace wholehand {
namespace {

using namespace test::words;
using flatbuffers::FlatBufferBuilder;

const fb::Message& verified(std::span<const std::uint8_t> bytes) {
  flatbuffers::Verifier verifier(bytes.data(), bytes.size());
  if (!fb::VerifyMessageBuffer(verifier)) throw std::runtime_error("not a message");
  return *fb::GetMessage(bytes.data());
}

/// A record with every array at its largest length for so many axes and joints, and no field at its
/// default.
TickRecord fullRecord(int axes, int joints, int values) {
  TickRecord r = test::sampleRecord(axes, joints, kMaxContacts, 1);
  r.theta = JointPosition(joints, 0.5);
  r.palm_target_distance_m = 0.125;
  r.exercise.value_count = values;
  for (int i = 0; i < values; ++i) r.exercise.values[i] = i + 0.1;
  r.body_count = kMaxBodies;
  return r;
}

LoopStatus fullStatus() {
  return test::sampleStatus(std::vector<double>(8, 0.5));
}

TEST(WireState, AnswersOfTheLoop_AreReadBackUnchanged) {
  wire::StateEncoder encoder(std::make_shared<SceneFacts>(test::sampleScene()));
  const auto read = [&](const LoopStatus& status, wire::Detail detail) {
    return verified(encoder.encode(fullRecord(2, 2, 1), status, detail, 555))
        .payload_as_WorldState();
  };
  for (const wire::Detail detail : {wire::Detail::kFull, wire::Detail::kCompact}) {
    LoopStatus status = fullStatus();
    EXPECT_FALSE(read(status, detail)->silent());
    EXPECT_FALSE(read(status, detail)->stop_pending());
    EXPECT_FALSE(read(status, detail)->stop_unconfirmed());
    EXPECT_EQ(read(status, detail)->loop_age_s(), -1.0F) << "no loop ticks";
    status.silent = true;
    EXPECT_TRUE(read(status, detail)->silent());
    status.stop_pending = true;
    EXPECT_TRUE(read(status, detail)->stop_pending());
    status.stop_unconfirmed = true;
    EXPECT_TRUE(read(status, detail)->stop_unconfirmed());
    status.loop_age_s = 0.0;
    EXPECT_EQ(read(status, detail)->loop_age_s(), 0.0F);
  }
}

TEST(WireState, FullRecord_IsReadBackUnchanged) {
  auto facts = std::make_shared<SceneFacts>(test::sampleScene());
  wire::StateEncoder encoder(facts);
  TickRecord r = fullRecord(2, 2, 48);
  r.safety_state = SafetyState::kFaulted;
  r.theta[0] = 0.3;
  r.theta[1] = std::acos(0.0);
  const auto* s =
      verified(encoder.encode(r, fullStatus(), wire::Detail::kFull, 555)).payload_as_WorldState();
  ASSERT_NE(s, nullptr);
  EXPECT_EQ(s->session(), 3U);
  EXPECT_EQ(s->endings(), 5U);
  EXPECT_EQ(s->basis(), 8U);
  EXPECT_EQ(s->tick(), 123456789012U);
  EXPECT_EQ(s->time_s(), 123456.789);
  EXPECT_EQ(s->sent_monotonic_ns(), 555);
  EXPECT_EQ(s->run_state(), fb::RunState::Faulted);
  EXPECT_EQ(s->help(), fb::Help::None);
  EXPECT_EQ(s->steering(), fb::Steering::Person);
  EXPECT_EQ(s->faults(), 128U);        // bit 7
  EXPECT_EQ(s->latched_faults(), 1U);  // bit 0
  EXPECT_EQ(s->safety_state(), fb::SafetyState::Faulted);
  EXPECT_EQ(s->fault_axis(), 1);
  EXPECT_EQ(s->fault_value(), 1.625F);
  EXPECT_EQ(s->fault_limit(), 1.5F);
  EXPECT_EQ(s->q_m()->Get(1), 0.25F);
  EXPECT_EQ(s->qd_s()->Get(1), -0.75F);
  EXPECT_EQ(s->sent()->Get(0), -1.5F);
  EXPECT_EQ(s->phi()->Get(0), 0.75F);
  EXPECT_EQ(s->palm_body(), 1);
  EXPECT_EQ(s->palm_target_distance_m(), 0.125F);
  EXPECT_EQ(s->values()->size(), 48U);
  EXPECT_EQ(s->values()->Get(47), 47.1);  // a double, so exact
  EXPECT_EQ(s->contacts()->size(), std::size_t{kMaxContacts});
  EXPECT_EQ(s->contacts()->Get(63)->capsule(), 63);
  EXPECT_EQ(s->contacts()->Get(0)->force_n().z(), 2.0F);
  EXPECT_EQ(s->bodies()->size(), std::size_t{kMaxBodies});
  EXPECT_EQ(s->parameters()->size(), 8U);
  EXPECT_EQ(s->statistics()->dropped_records(), 9U);
  EXPECT_EQ(s->statistics()->cpu_p999_us(), 42.5F);
  EXPECT_EQ(s->recording_bytes(), 1ULL << 40U);
  // Computed by hand: the arm's frame is at (0.3, 0.1, 0), turned by 90° about z.
  ASSERT_EQ(s->links()->size(), 2U);
  const fb::Pose& arm = *s->links()->Get(1);
  EXPECT_NEAR(arm.position_m().x(), 0.3F, 1e-7F);
  EXPECT_NEAR(arm.position_m().y(), 0.1F, 1e-7F);
  EXPECT_NEAR(arm.orientation_xyzw().z(), std::sqrt(0.5F), 1e-7F);
  EXPECT_NEAR(arm.orientation_xyzw().w(), std::sqrt(0.5F), 1e-7F);
}

TEST(WireState, SlotsOfAGame_AreSentUpToTheLastOneInUse) {
  SceneFacts facts = test::sampleScene();  // one body
  facts.scene.game.slots = 8;
  TickRecord record;
  record.body_count = 9;
  record.bodies[4].position_m.x = 0.5;  // slot 3
  const auto count = [&](const LoopStatus& status, wire::Detail detail) {
    wire::StateEncoder encoder(std::make_shared<const SceneFacts>(facts));
    const auto* state = verified(encoder.encode(record, status, detail, 0)).payload_as_WorldState();
    if (state->bodies()->size() == 5) {
      EXPECT_EQ(state->bodies()->Get(4)->position_m().x(), 0.5F);
    }
    return state->bodies()->size();
  };
  LoopStatus status;
  EXPECT_EQ(count(status, wire::Detail::kFull), 1U);
  EXPECT_EQ(count(status, wire::Detail::kRecorded), 9U) << "nobody followed the game";
  GameBody body;
  body.slot = 3;
  status.bodies = std::make_shared<const GameBodies>(GameBodies{body});
  EXPECT_EQ(count(status, wire::Detail::kFull), 5U);
}

TEST(WireState, RealDevice_ReportsItsProperties) {
  wire::StateEncoder encoder(std::make_shared<SceneFacts>(test::sampleScene()));
  LoopStatus status = fullStatus();
  const auto encoded = [&](wire::Detail detail) {
    return verified(encoder.encode(fullRecord(2, 2, 4), status, detail, 0))
        .payload_as_WorldState()
        ->device();
  };
  EXPECT_EQ(encoded(wire::Detail::kFull), nullptr) << "a simulated one";
  status.device = DeviceStatus{};
  status.device->enabled = status.device->hosted = true;
  status.device->sample_age_s = 0.5;
  status.device->host_age_s = 0.25;
  status.device->let_go = ReleaseReason::kNeverCommanded;
  const auto* device = encoded(wire::Detail::kFull);
  ASSERT_NE(device, nullptr);
  EXPECT_TRUE(device->enabled());
  EXPECT_FALSE(device->homed());
  EXPECT_FALSE(device->temperature_known()) << "NaN";
  EXPECT_EQ(device->sample_age_s(), 0.5F);
  EXPECT_TRUE(device->hosted());
  EXPECT_EQ(device->host_age_s(), 0.25F);
  EXPECT_EQ(device->let_go(), fb::ReleaseReason::NeverCommanded);
  status.device->temperature_c = 41.5;
  EXPECT_TRUE(encoded(wire::Detail::kFull)->temperature_known());
  EXPECT_EQ(encoded(wire::Detail::kFull)->temperature_c(), 41.5F);
  EXPECT_EQ(encoded(wire::Detail::kCompact), nullptr) << "datagrams are small";
}

TEST(WireState, StateBeforeTheFirstRecord_HasTheRunState) {
  wire::StateEncoder encoder(std::make_shared<SceneFacts>(test::sampleScene()));
  LoopStatus idle;
  const auto* s =
      verified(encoder.encode(TickRecord{}, idle, wire::Detail::kFull, 0)).payload_as_WorldState();
  EXPECT_EQ(s->run_state(), fb::RunState::Disarmed);
  EXPECT_EQ(s->links(), nullptr);  // no joints in the record, so no link poses
}

// The limit is 1,150 bytes: with its header a datagram of 1,200.
TEST(WireState, CompactStateOfAnyDevice_FitsADatagram) {
  auto facts = std::make_shared<SceneFacts>(test::sampleScene());
  wire::StateEncoder encoder(facts);
  for (int axes = 1; axes <= kMaxAxes; ++axes) {
    const auto bytes = encoder.encode(fullRecord(axes, kMaxJoints, kMaxExerciseValues),
                                      fullStatus(), wire::Detail::kCompact, 555);
    EXPECT_LE(bytes.size(), 1150U) << axes << " axes";
    const auto* s = verified(bytes).payload_as_WorldState();
    EXPECT_EQ(s->values()->size(), 48U);
    EXPECT_EQ(s->basis(), 0U) << "a datagram may overtake the scene";
    EXPECT_EQ(s->links(), nullptr);
    EXPECT_EQ(s->contacts(), nullptr);
    EXPECT_EQ(s->coupling() != nullptr, axes <= 9);
    if (axes == 9) test::figure("compact state, 9 axes", static_cast<double>(bytes.size()), "B");
  }
}

TEST(WireState, EncodingAfterTheFirst_AllocatesNothing) {
  if (!allocationCountingAvailable()) GTEST_SKIP() << "a sanitizer owns malloc";
  auto facts = std::make_shared<SceneFacts>(test::sampleScene());
  wire::StateEncoder encoder(facts);
  const TickRecord r = fullRecord(2, 2, 48);
  const LoopStatus status = fullStatus();
  (void)encoder.encode(r, status, wire::Detail::kFull, 0);
  const AllocationScope scope;
  for (int i = 0; i < 1000; ++i) (void)encoder.encode(r, status, wire::Detail::kFull, i);
  EXPECT_EQ(scope.allocations(), 0U);
}

TEST(WireScene, ShippedHand_IsSentWithEveryNameAndCapsule) {
  const Models models = test::load(test::shippedFiles("lambda-pride", "four-shapes"));
  SceneFacts facts;
  facts.hand = models.hand;
  facts.device = models.device;
  facts.scene = models.scene;
  facts.levels = 4;
  const wire::Bytes bytes = wire::sceneMessage(facts);
  test::figure("scene message", static_cast<double>(bytes.size()), "B");
  const auto* s = verified(bytes).payload_as_Scene();
  ASSERT_NE(s, nullptr);
  EXPECT_TRUE(s->right_hand());
  EXPECT_EQ(s->axes()->size(), models.device.axes.size());
  EXPECT_EQ(s->axes()->Get(0)->name()->str(), "x");
  EXPECT_EQ(s->axes()->Get(0)->unit()->str(), "m");
  EXPECT_EQ(s->capsules()->size(), models.hand.capsules.size());
  EXPECT_EQ(s->link_names()->size(), models.hand.links.size());
  EXPECT_EQ(s->bodies()->size(), models.scene.bodies.size());
  EXPECT_EQ(s->fault_names()->size(), static_cast<unsigned>(kFaultBits));
  EXPECT_EQ(s->fault_names()->Get(7)->str(), "late tick");
  EXPECT_EQ(s->levels(), 4);
}

Eigen::Isometry3d placedAt(const fb::Pose& pose) {
  const auto& p = pose.position_m();
  const auto& q = pose.orientation_xyzw();
  const Eigen::Quaternionf turned(q.w(), q.x(), q.y(), q.z());
  return Eigen::Translation3d(Eigen::Vector3f(p.x(), p.y(), p.z()).cast<double>()) *
         turned.cast<double>();
}

/// Link poses as a client computes them from Scene.links and WorldState.theta, by the rule in the
/// schema.
std::vector<Eigen::Isometry3d> drawn(const fb::Scene& scene, const fb::WorldState& state) {
  std::vector<Eigen::Isometry3d> poses;
  for (const fb::Link* link : *scene.links()) {
    double theta = 0.0;
    if (link->joint() >= 0)
      theta = static_cast<double>(state.theta()->Get(static_cast<unsigned>(link->joint())));
    const auto& along = *link->axis();
    const Eigen::Vector3d axis = Eigen::Vector3f(along.x(), along.y(), along.z()).cast<double>();
    Eigen::Isometry3d pose =
        link->parent() < 0 ? Eigen::Isometry3d::Identity() : poses[link->parent()];
    pose = pose * placedAt(*link->at_zero());
    if (link->type() == fb::JointType::Prismatic) pose.translate(theta * axis);
    if (link->type() == fb::JointType::Revolute) pose.rotate(Eigen::AngleAxisd(theta, axis));
    poses.push_back(pose);
  }
  return poses;
}

// WorldState.links comes from the loop's own kinematics; the link tree that a client gets must lead
// to the same poses. Tolerance: single precision over 20 links, some 1e-6.
TEST(WireScene, LinksOfTheScene_LeadToTheLinkPosesOfTheState) {
  for (const char* device : {"lambda-pride", "wrist-9axis"}) {
    const Models models = test::load(test::shippedFiles(device, "four-shapes"));
    auto facts = std::make_shared<SceneFacts>();
    facts->hand = models.hand;
    facts->device = models.device;
    facts->scene = models.scene;
    const wire::Bytes message = wire::sceneMessage(*facts);
    const fb::Scene& scene = *verified(message).payload_as_Scene();
    ASSERT_EQ(scene.links()->size(), models.hand.links.size());
    wire::StateEncoder encoder(facts);
    TickRecord r = fullRecord(models.hand.axis_count, models.hand.joint_count, 0);
    for (int j = 0; j < models.hand.joint_count; ++j) r.theta[j] = std::sin(3.0 * j + 1.0);
    const fb::WorldState& state =
        *verified(encoder.encode(r, LoopStatus{}, wire::Detail::kFull, 0)).payload_as_WorldState();
    const auto poses = drawn(scene, state);
    for (unsigned i = 0; i < poses.size(); ++i) {
      EXPECT_EQ(scene.links()->Get(i)->name()->str(), scene.link_names()->Get(i)->str());
      const Eigen::Isometry3d said = placedAt(*state.links()->Get(i));
      EXPECT_LE((poses[i].translation() - said.translation()).norm(), 2e-6)
          << device << ", link " << i;
      EXPECT_LE((poses[i].rotation() - said.rotation()).norm(), 4e-6) << device << ", link " << i;
    }
  }
}

// WorldState.bodies gives the centre of mass: a shape 0.058 above the body's frame, with the centre
// of mass at 0.05, is drawn 0.008 above it.
TEST(WireScene, Shapes_ArePlacedRelativeToTheCentreOfMass) {
  const wire::Bytes bytes = wire::sceneMessage(test::sampleScene());
  const auto* s = verified(bytes).payload_as_Scene();
  EXPECT_NEAR(s->bodies()->Get(0)->shapes()->Get(0)->in_body()->position_m().z(), 0.008F, 1e-7F);
}

// ---- messages of clients ---------------------------------------------------------------------

std::string wireRefusalOf(const wire::Bytes& bytes) {
  const auto m = wire::decode(bytes);
  return m ? "" : format(m.errors());
}

TEST(WireDecode, EveryOrder_IsDecoded) {
  std::vector<Order> m;
  for (const wire::Bytes& bytes : oneOfEach()) m.push_back(test::orThrow(wire::decode(bytes)));
  for (std::size_t i = 0; i < m.size(); ++i) EXPECT_EQ(m[i].id, i + 1);
  EXPECT_EQ(std::get<orders::Arm>(m[0].what).acknowledged_stop, 1U);
  EXPECT_EQ(std::get<orders::Arm>(m[0].what).basis_seen, 6U);
  EXPECT_TRUE(m[1].is<orders::Stop>());
  EXPECT_TRUE(m[2].is<orders::EmergencyStop>());
  const auto load = std::get<orders::LoadExercise>(m[3].what);
  EXPECT_EQ(load.exercise, "cocktail-bar");
  EXPECT_EQ(load.level, 2);
  EXPECT_EQ(load.hand, "adult");
  const auto aim = std::get<orders::Aim>(m[4].what);
  EXPECT_EQ(aim.q.size(), 2);
  EXPECT_EQ(aim.q[1], static_cast<double>(-0.2F));
  EXPECT_EQ(aim.by, Help::kNone);
  EXPECT_EQ(std::get<orders::SetParameter>(m[5].what).name, "lead_in_m");
  EXPECT_EQ(std::get<orders::SetParameter>(m[5].what).value, 0.01);
  EXPECT_EQ(std::get<orders::SetParameter>(m[5].what).basis_seen, 7U);
  EXPECT_EQ(std::get<orders::Steer>(m[6].what).by, Steering::kPerson);
  EXPECT_EQ(std::get<orders::Action>(m[7].what).act, Act::kPause);
  EXPECT_EQ(std::get<orders::TakeControls>(m[8].what).token, "a token of 18 char");
  EXPECT_TRUE(m[9].is<orders::ReleaseControls>());
  EXPECT_TRUE(m[10].is<orders::Heartbeat>());
  EXPECT_EQ(std::get<orders::SetHelp>(m[12].what).help, Help::kSome);
  EXPECT_STREQ(m[12].row().name, "SetHelp");
  EXPECT_EQ(bodiesOf(m[13])->shape_set, 0);
  EXPECT_EQ(bodiesOf(m[13])->pieces.at(0).radius_m, static_cast<double>(0.03F));
  const char* const names[] = {"PrepareShapes", "Spawn",    "Remove",
                               "Teleport",      "SetOwner", "BodyTargets"};
  for (std::size_t i = 0; i < std::size(names); ++i) {
    EXPECT_STREQ(m[13 + i].row().name, names[i]);
    EXPECT_EQ(m[13 + i].streams(), i == 5) << names[i];
  }
  const SpawnOrder spawned = spawnOrderOf(bodiesOf(m[14])->commands.at(0));
  EXPECT_EQ(spawned.generation, 1);
  EXPECT_EQ(spawned.mass_kg, static_cast<double>(0.1F));
  EXPECT_EQ(spawned.pose.position_m.y, static_cast<double>(0.3F));
  EXPECT_EQ(poseOf(bodiesOf(m[16])->commands.at(0)).position_m.z, static_cast<double>(0.1F));
  EXPECT_EQ(spawnOrderOf(bodiesOf(m[17])->commands.at(0)).owner, BodyOwner::kFixed);
}

TEST(WireDecode, EveryCommandOfTheSchema_HasExactlyOneTableRow) {
  std::size_t programs_own = 0;
  for (const orders::Row& row : orders::kTable) programs_own += row.wire == 0 ? 1 : 0;
  EXPECT_EQ(programs_own, 3U);
  EXPECT_EQ(orders::kTable.size() - programs_own, static_cast<std::size_t>(fb::Order::MAX));
  for (const fb::Order type : fb::EnumValuesOrder()) {
    if (type == fb::Order::NONE) continue;
    std::vector<std::string> names;
    for (const orders::Row& row : orders::kTable) {
      if (row.wire == static_cast<std::uint8_t>(type)) names.emplace_back(row.name);
    }
    EXPECT_EQ(names, std::vector<std::string>{fb::EnumNameOrder(type)});
  }
}

TEST(WireDecode, BadMessages_AreRefusedWithTheReason) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  EXPECT_NE(wireRefusalOf({}), "");
  EXPECT_NE(wireRefusalOf({1, 2, 3}), "");
  EXPECT_NE(wireRefusalOf(wire::Bytes(100, 0xFF)).find("not one of Wholehand's"),
            std::string::npos);
  EXPECT_NE(wireRefusalOf(wire::Bytes(wire::kLargestClientMessage + 1, 0)).find("too large"),
            std::string::npos);
  EXPECT_NE(wireRefusalOf(arm(1, 2)).find("schema_version = 2"), std::string::npos);
  EXPECT_NE(wireRefusalOf(aim(1, {0.0F, nan})).find("finite"), std::string::npos);
  EXPECT_NE(wireRefusalOf(aim(1, {inf})).find("finite"), std::string::npos);
  EXPECT_NE(wireRefusalOf(aim(1, {})).find("1 to 16 axes"), std::string::npos);
  EXPECT_EQ(wireRefusalOf(aim(1, {0.0F}, fb::Help::MAX)), "");
  const wire::Bytes beyond = aim(1, {0.0F}, static_cast<fb::Help>(4));
  EXPECT_NE(wireRefusalOf(beyond).find("help = 4"), std::string::npos) << wireRefusalOf(beyond);
  EXPECT_NE(wireRefusalOf(aim(1, std::vector<float>(17))).find("1 to 16 axes"), std::string::npos);
  EXPECT_NE(wireRefusalOf(setParameter(1, "lead_in_m", -std::numeric_limits<double>::infinity()))
                .find("finite"),
            std::string::npos);
  EXPECT_NE(wireRefusalOf(steer(1, static_cast<fb::Steering>(2))).find("steer = 2"),
            std::string::npos);
  EXPECT_NE(wireRefusalOf(setHelp(1, static_cast<fb::Help>(4))).find("help = 4"),
            std::string::npos);
  EXPECT_NE(wireRefusalOf(action(1, static_cast<fb::Act>(-1), 0)).find("action = -1"),
            std::string::npos);
  // Messages of the program are not accepted from a client.
  EXPECT_NE(wireRefusalOf(wire::controlsMessage({true, true})).find("client may send"),
            std::string::npos);
}

TEST(WireDecode, MissingOrder_IsRefused) {
  FlatBufferBuilder b;
  fb::FinishMessageBuffer(b, fb::CreateMessage(b, wire::kSchemaVersion, fb::Payload::Command,
                                               fb::CreateCommand(b, 1, fb::Order::Aim, 0).Union()));
  EXPECT_NE(wireRefusalOf({b.GetBufferPointer(), b.GetBufferPointer() + b.GetSize()}), "");
}

// The decoder must never read beyond the bytes (asan-ubsan runs this) and never return an order
// with a number that is not finite.
void survives(std::span<const std::uint8_t> bytes) {
  // A copy of exactly this size, so that reading one more byte is detected.
  const wire::Bytes exact(bytes.begin(), bytes.end());
  const auto m = wire::decode(exact);
  if (!m) return;
  if (const auto* set = m->as<orders::SetParameter>()) EXPECT_TRUE(std::isfinite(set->value));
  if (const auto* aim = m->as<orders::Aim>()) {
    EXPECT_TRUE(allFinite(aim->q));
    EXPECT_LE(aim->q.size(), kMaxAxes);
  }
}

TEST(WireDecode, MessageCutAnywhere_IsNeverReadBeyondItsEnd) {
  for (const wire::Bytes& whole : oneOfEach()) {
    for (std::size_t n = 0; n < whole.size(); ++n) survives(std::span(whole).first(n));
  }
}

}  // namespace
}  // namespace wholehand
