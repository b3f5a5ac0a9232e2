// data/schema_9.h5 was written by version 9893d4ac, the last one with schema 9, by the loop whose
// numbers stand here: 12 ticks of a game with a spawned body.
#include "loop/core/body_order.hpp"
#include "record/recording.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>

namespace wholehand {
namespace {

struct Schema9 : testing::Test {
  std::unique_ptr<RecordingReader> reader =
      RecordingReader::open(std::string(WHOLEHAND_SOURCE_DIR) + "/tests/record/data/schema_9.h5")
          .value();
};

TEST_F(Schema9, Ticks_AreRead) {
  EXPECT_EQ(reader->meta().schema, 9U);
  EXPECT_TRUE(reader->meta().body_joint_names.empty());
  ASSERT_EQ(reader->size(), 12U);
  TickRecord tick;
  for (std::uint64_t i = 0; i < 12; ++i) {
    ASSERT_TRUE(reader->read(i, tick));
    const auto n = static_cast<double>(i);
    EXPECT_EQ(tick.tick, i);
    EXPECT_EQ(tick.q_m[0], 0.25 * n);
    EXPECT_EQ(tick.sent[0], 1.0 + n);
    EXPECT_EQ(tick.bodies[2].position_m.x, 1.0);
    EXPECT_EQ(tick.bodies[2].position_m.y, 0.25 * n);
    EXPECT_EQ(tick.body_joint_count, 0);
    ASSERT_EQ(tick.contact_count, i % 2 == 1 ? 1 : 0) << "unsigned rows of /contacts";
    if (i % 2 == 1) EXPECT_EQ(tick.contacts[0].force_n.z, 2.0 * n);
    EXPECT_EQ(tick.exercise.event_count, i == 5 ? 1 : 0);
  }
}

TEST_F(Schema9, SpinPackedIntoOneNumber_IsRead) {
  TickRecord tick;
  ASSERT_TRUE(reader->read(3, tick));
  ASSERT_EQ(tick.command_count, 1);
  const SpawnOrder order = spawnOrderOf(tick.commands[0]);
  EXPECT_EQ(order.slot, 1);
  EXPECT_EQ(order.generation, 7);
  EXPECT_EQ(order.shape_set, 4);
  EXPECT_EQ(order.owner, BodyOwner::kGame);
  EXPECT_EQ(order.mass_kg, 0.25);
  EXPECT_TRUE(order.refuse_overlap);
  EXPECT_EQ(order.velocity_m_s.z, -0.25);
  EXPECT_EQ(order.spin_rad_s.x, 1.5);
  EXPECT_EQ(order.spin_rad_s.y, -2.25);
  EXPECT_EQ(order.spin_rad_s.z, 0.125);
}

}  // namespace
}  // namespace wholehand
