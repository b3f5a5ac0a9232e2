// Bodies of a game in a recording, as the replay and the report show them.
#include "game_bodies/game_tools.hpp"
#include "replay/recording_report.hpp"
#include "replay/replayed_recording.hpp"
#include "rig/run/run.hpp"
#include "support/folder.hpp"
#include "unpacked.hpp"
#include "wholehand_generated.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <set>

namespace wholehand::test {
namespace {

namespace fb = wholehand::protocol;

constexpr std::uint64_t kGameTicks = 4000;
constexpr int kSlots = 20;  ///< filled one after another, each for 1.5 s

/// The bodies at one row as text, each with its slot, generation, state and shapes.
using Row = std::string;

/// Reads the changes by row. A shape is kept while a body has it, as clients do.
std::map<std::uint64_t, Row> rowsIn(const std::string& changes) {
  std::map<std::uint64_t, Row> rows;
  std::map<std::uint32_t, std::string> shapes;
  for (std::size_t at = 0; at < changes.size();) {
    std::uint32_t row = 0, size = 0;
    std::memcpy(&row, changes.data() + at, sizeof row);
    std::memcpy(&size, changes.data() + at + sizeof row, sizeof size);
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(changes.data() + at + 8);
    flatbuffers::Verifier verifier(bytes, size);
    EXPECT_TRUE(fb::VerifyMessageBuffer(verifier));
    const auto* reported = fb::GetMessage(bytes)->payload_as_GameBodies();
    for (const auto* set : *reported->new_shapes()) {
      shapes[set->id()] = std::to_string(set->pieces()->size()) + " of type " +
                          std::to_string(static_cast<int>(set->pieces()->Get(0)->type()));
    }
    std::map<std::uint32_t, std::string> kept;
    for (const fb::GameBody* body : *reported->bodies()) {
      const std::string& of = kept[body->shapes()] = shapes[body->shapes()];
      rows[row] += std::to_string(body->slot()) + "." + std::to_string(body->generation()) + " " +
                   std::to_string(static_cast<int>(body->state())) + " " + of + "; ";
    }
    if (reported->bodies()->size() == 0) rows[row] = "";
    shapes = std::move(kept);
    at += 8 + size;
  }
  return rows;
}

Row at(const std::map<std::uint64_t, Row>& rows, std::uint64_t row) {
  const auto after = rows.upper_bound(row);
  return after == rows.begin() ? "" : std::prev(after)->second;
}

/// Records fixed balls and meshes that appear and disappear beside the hand.
std::string recordGame(const Folder& folder) {
  Models models = gameModels();
  std::shared_ptr<Rig> rig = orThrow(buildRig(std::move(models), atRest(), {}));
  std::vector<std::vector<Command>> shapes;
  const auto prepare = [&](int set, const Shape& shape) {
    shapes.push_back(shapeCommands(set, orThrow(prepareShapes({shape}, rig->models.scene.game))));
  };
  prepare(0, ballShape(0.03));
  prepare(1, boxMesh({0.02, 0.03, 0.04}));
  std::unique_ptr<Run> run;
  RunPlan plan;
  plan.duration_ticks = kGameTicks;
  plan.record = folder.file("game.h5");
  plan.simulated_clock = true;
  plan.sinks.push_back([&](const TickRecord& record) {
    if (record.tick < shapes.size()) {
      for (const Command& command : shapes[record.tick]) EXPECT_TRUE(run->tryCommand(command));
    }
    const int slot = static_cast<int>(record.tick / 100) - 1;
    if (record.tick % 100 == 0 && slot >= 0 && slot < kSlots) {
      const SpawnOrder order =
          spawnOf(slot, slot % 2, BodyOwner::kFixed, poseAt({0.5, 0.1 * slot - 1.0, 0.5}));
      EXPECT_TRUE(run->tryCommand(spawnCommand(order)));
    }
    const int gone = slot - 15;
    if (record.tick % 100 == 0 && gone >= 0 && gone < kSlots) {
      EXPECT_TRUE(run->tryCommand(removeCommand(gone, 1)));
    }
  });
  run = orThrow(Run::prepare(rig, std::move(plan)));
  orThrow(run->simulate());
  run->finish();
  EXPECT_FALSE(run->outcome().faulted);
  return folder.file("game.h5");
}

/// The recording of recordGame(), made once.
std::string recordedGame() {
  static const Folder folder;
  static const std::string path = recordGame(folder);
  return path;
}

TEST(GameRecording, BodiesInAReport_EqualThoseOfTheReplayAtEveryState) {
  const std::string path = recordedGame();
  const auto reader = orThrow(RecordingReader::open(path));
  const auto replayed = rowsIn(gameBodiesOf(*reader));
  // The body of slot k is ordered in ticks 100 k to 100 k + 99 and removed 1500 ticks later.
  EXPECT_EQ(at(replayed, 99), "");
  EXPECT_EQ(at(replayed, 150), "0.1 2 1 of type 1; ") << "a ball, solid";
  EXPECT_EQ(at(replayed, 250), "0.1 2 1 of type 1; 1.1 2 1 of type 4; ") << "and a mesh";
  EXPECT_EQ(at(replayed, kGameTicks - 1), "");
  for (const std::uint64_t long_from : {kLongRecording_ticks, std::uint64_t{0}}) {
    const nlohmann::json data = orThrow(reportData(path, "", {}, long_from));
    const auto rows = data["states"]["rows"].get<std::vector<std::uint64_t>>();
    const auto reported = rowsIn(unpacked(data["bodies"]));
    EXPECT_GE(rows.size(), 200U);
    std::set<Row> different;
    for (const std::uint64_t row : rows) {
      ASSERT_EQ(at(reported, row), at(replayed, row)) << row;
      different.insert(at(reported, row));
    }
    EXPECT_GE(different.size(), 30U);
    EXPECT_LE(reported.size(), rows.size());
  }
}

TEST(GameRecording, BodiesAtFewerRows_TakeFewerBytesAndAreRight) {
  const auto reader = orThrow(RecordingReader::open(recordedGame()));
  SampledBodies bodies(reader->meta());
  std::vector<std::uint64_t> rows;
  TickRecord record;
  for (std::uint64_t row = 0; row < reader->size(); ++row) {
    ASSERT_TRUE(reader->read(row, record));
    bodies.onRecord(record);
    if (row % 10 != 0) continue;
    bodies.keep(row);
    rows.push_back(row);
  }
  const std::string all = bodies.at(rows, 1), few = bodies.at(rows, 64);
  EXPECT_LT(few.size(), all.size() / 2);
  const auto of_all = rowsIn(all), of_few = rowsIn(few);
  for (std::size_t i = 0; i < rows.size(); i += 64) {
    EXPECT_EQ(at(of_few, rows[i]), at(of_all, rows[i])) << rows[i];
  }
  EXPECT_EQ(at(of_few, rows.back()), at(of_all, rows.back()));
}

}  // namespace
}  // namespace wholehand::test
