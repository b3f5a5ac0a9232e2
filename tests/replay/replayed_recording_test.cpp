// A replayed recording of the bar, compared with its file and with the messages of the live program
// for the same ticks.
#include "replay/replayed_recording.hpp"

#include "record/synthetic_recording.hpp"
#include "replay/recording_report.hpp"
#include "replay/series_reader.hpp"
#include "rig/run/run.hpp"
#include "station/scene_facts.hpp"
#include "support/contains.hpp"
#include "support/folder.hpp"
#include "support/python.hpp"
#include "support/recorded_run.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"
#include "unpacked.hpp"
#include "wholehand_generated.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>

namespace wholehand::test {
namespace {

namespace fb = wholehand::protocol;
using Json = nlohmann::json;

const fb::Message& verified(const std::uint8_t* data, std::size_t size) {
  flatbuffers::Verifier verifier(data, size);
  if (!fb::VerifyMessageBuffer(verifier)) throw std::runtime_error("not a message");
  return *fb::GetMessage(data);
}

const fb::WorldState& stateIn(const std::string& bytes) {
  const auto* data = reinterpret_cast<const std::uint8_t*>(bytes.data());
  const fb::WorldState* state = verified(data, bytes.size()).payload_as_WorldState();
  if (state == nullptr) throw std::runtime_error("not a state");
  return *state;
}

/// Splits messages that are each preceded by their length in four bytes.
std::vector<std::string> splitMessages(const std::string& body) {
  std::vector<std::string> messages;
  for (std::size_t at = 0; at < body.size();) {
    std::uint32_t bytes = 0;
    std::memcpy(&bytes, body.data() + at, sizeof bytes);
    messages.push_back(body.substr(at + sizeof bytes, bytes));
    EXPECT_EQ(messages.back().size(), bytes);
    at += sizeof bytes + bytes;
  }
  return messages;
}

/// The messages of an answer with states.
std::vector<std::string> messagesIn(const ReplayAnswer& answer) {
  EXPECT_EQ(answer.status, 200) << answer.body;
  EXPECT_EQ(answer.content_type, "application/octet-stream");
  return splitMessages(answer.body);
}

ReplayAnswer ask(ReplayedRecording& recording, const std::string& question) {
  return recording.answer(orThrow(parseReplayQuestion(question)));
}

std::unique_ptr<ReplayedRecording> openedAgain(const std::string& path) {
  return std::make_unique<ReplayedRecording>(path);
}

Json aboutOf(ReplayedRecording& recording) {
  const ReplayAnswer answer = ask(recording, "about");
  EXPECT_EQ(answer.status, 200) << answer.body;
  EXPECT_EQ(answer.content_type, "application/json");
  return Json::parse(answer.body);
}

Models barModels() {
  ModelFiles files = shippedFiles();
  files.exercise = std::string(WHOLEHAND_SOURCE_DIR) + "/config/exercises/cocktail-bar.toml";
  return load(files);
}

/// Records nine seconds of the bar (four under a sanitizer) and the messages to clients for each
/// tick.
class RecordedBar {
 public:
  RecordedBar() {
    const Models models = barModels();
    facts = std::make_shared<const SceneFacts>(sceneFacts(models, 1e-3));
    wire::StateEncoder live(facts);
    const auto rig = orThrow(buildRig(models, models.exercise->makePlayer({1}), RigOptions{}));
    RunPlan plan;
    plan.title = "bar";
    plan.simulated_clock = true;
    plan.duration_ticks = kReducedCounts ? 4000 : 9000;
    plan.record = path();
    plan.sinks.push_back([&](const TickRecord& record) {
      const auto message = live.encode(record, LoopStatus{}, wire::Detail::kFull, 0);
      states.emplace_back(message.begin(), message.end());
    });
    orThrow(runAndRecord(*rig, plan));
  }
  [[nodiscard]] std::string path() const { return folder.file("bar.h5"); }

  const Folder folder;
  std::shared_ptr<const SceneFacts> facts;
  std::vector<std::string> states;  ///< state message of each tick, as live clients get it
};

const RecordedBar& recordedBar() {
  static const RecordedBar recorded;
  return recorded;
}

template <class Vector, class Array>
void expectFloats(const Vector* sent, const Array& recorded, const char* name) {
  ASSERT_NE(sent, nullptr) << name;
  ASSERT_EQ(sent->size(), static_cast<std::size_t>(recorded.size())) << name;
  for (unsigned i = 0; i < sent->size(); ++i) {
    EXPECT_EQ(sent->Get(i), static_cast<float>(recorded.data()[i])) << name << " " << i;
  }
}

/// The bytes of a vector of structs.
template <class Vector>
std::string bytesOfStructs(const Vector* v) {
  return v == nullptr ? std::string("none")
                      : std::string(reinterpret_cast<const char*>(v->Data()),
                                    v->size() * sizeof(*v->Get(0)));
}

/// Compares numbers computed from joints in single precision: within 3 units in the last place of
/// 1.
template <class Vector>
void expectNear(const Vector& a, const Vector& b) {
  ASSERT_EQ(a.size(), b.size());
  const std::size_t count = a.size() * sizeof(*a.Get(0)) / sizeof(float);
  const auto *x = reinterpret_cast<const float*>(a.Data()),
             *y = reinterpret_cast<const float*>(b.Data());
  for (std::size_t i = 0; i < count; ++i) EXPECT_NEAR(x[i], y[i], 4e-7) << i;
}

void expectAsInFile(const fb::WorldState& state, const TickRecord& row) {
  EXPECT_EQ(state.tick(), row.tick);
  EXPECT_EQ(state.time_s(), row.time_s);
  EXPECT_EQ(state.faults(), static_cast<std::uint32_t>(row.faults));
  EXPECT_EQ(state.authority(), static_cast<float>(row.authority));
  EXPECT_EQ(state.alpha(), static_cast<float>(row.exercise.alpha));
  EXPECT_EQ(state.palm_body(), row.palm_body);
  EXPECT_EQ(static_cast<int>(state.safety_state()), static_cast<int>(row.safety_state));
  expectFloats(state.q_m(), row.q_m, "q_m");
  expectFloats(state.q_s(), row.q_s, "q_s");
  expectFloats(state.theta(), row.theta, "theta");
  expectFloats(state.intention(), row.intention, "intention");
  expectFloats(state.coupling(), row.coupling, "coupling");
  expectFloats(state.exercise_effort(), row.exercise.effort, "exercise_effort");
  expectFloats(state.damping(), row.damping, "damping");
  expectFloats(state.sent(), row.sent, "sent");
  expectFloats(state.phi(), row.phi, "phi");
  ASSERT_EQ(state.values()->size(), static_cast<std::size_t>(row.exercise.value_count));
  for (unsigned v = 0; v < state.values()->size(); ++v) {
    EXPECT_EQ(state.values()->Get(v), row.exercise.values[v]);
  }
  ASSERT_EQ(state.contacts()->size(), static_cast<std::size_t>(row.contact_count));
  for (unsigned c = 0; c < state.contacts()->size(); ++c) {
    EXPECT_EQ(state.contacts()->Get(c)->force_n().x(),
              static_cast<float>(row.contacts[c].force_n.x));
  }
}

TEST(ReplayedRecording, ThousandRandomTicks_EqualTheFileAndTheLiveMessages) {
  auto random = seededRandom(92);
  const auto recording = openedAgain(recordedBar().path());
  const auto file = orThrow(RecordingReader::open(recordedBar().path()));
  ASSERT_EQ(file->size(), recordedBar().states.size());
  int with_contacts = 0;
  TickRecord row;
  for (int i = 0; i < cases(1000); ++i) {
    const std::uint64_t n = random() % file->size();
    SCOPED_TRACE(testing::Message() << "row " << n);
    const auto messages =
        messagesIn(ask(*recording, "states?tick=" + std::to_string(n) + "&count=1&step=1"));
    ASSERT_EQ(messages.size(), 1U);
    const fb::WorldState& state = stateIn(messages[0]);
    ASSERT_TRUE(file->read(n, row));
    expectAsInFile(state, row);
    const fb::WorldState& live = stateIn(recordedBar().states[n]);
    expectNear(*state.links(), *live.links());
    EXPECT_EQ(bytesOfStructs(state.bodies()), bytesOfStructs(live.bodies()));
    EXPECT_EQ(bytesOfStructs(state.contacts()), bytesOfStructs(live.contacts()));
    EXPECT_GT(state.links()->size(), 10U);
    EXPECT_EQ(state.palm_target_distance_m(), live.palm_target_distance_m());
    EXPECT_EQ(state.run_state(), fb::RunState::Rendering);
    EXPECT_EQ(state.statistics(), nullptr);
    EXPECT_EQ(state.fault_ticks(), nullptr);
    with_contacts += row.contact_count > 0 ? 1 : 0;
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_GT(with_contacts, 0) << "the bar was never touched: nothing of contacts was compared";
}

/// Ticks between two states of a report: 18 for a recording of four seconds; 40 for nine, where the
/// size limit halves their number. Both give 25 pictures a second.
const std::size_t kTicksAPicture = kReducedCounts ? 18 : 40;

TEST(RecordingReport, EveryState_EqualsThatOfTheFile) {
  const Json data = orThrow(reportData(recordedBar().path(), ""));
  const auto rows = data["states"]["rows"].get<std::vector<std::uint64_t>>();
  const auto messages = splitMessages(unpacked(data["states"]["messages"]));
  ASSERT_EQ(messages.size(), rows.size());
  EXPECT_GE(rows.size(), recordedBar().states.size() / kTicksAPicture);
  EXPECT_TRUE(std::is_sorted(rows.begin(), rows.end()));
  const auto file = orThrow(RecordingReader::open(recordedBar().path()));
  EXPECT_EQ(rows.front(), 0U);
  EXPECT_EQ(rows.back(), file->size() - 1);
  TickRecord row;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    SCOPED_TRACE(testing::Message() << "row " << rows[i]);
    ASSERT_TRUE(file->read(rows[i], row));
    expectAsInFile(stateIn(messages[i]), row);
    if (testing::Test::HasFailure()) return;
  }
}

TEST(RecordingReport, RecordingReadAsALongOne_GivesTheSamePage) {
  const Json read_once = orThrow(reportData(recordedBar().path(), ""));
  const Json read_as_long = orThrow(reportData(recordedBar().path(), "", {}, 0));
  EXPECT_GE(read_once["states"]["rows"].size(), recordedBar().states.size() / kTicksAPicture);
  for (const auto& [key, value] : read_once.items()) {
    EXPECT_EQ(read_as_long[key].dump(), value.dump()) << key;
  }
}

TEST(ReplayedRecording, Scene_EqualsTheLiveOneExceptForProgramFields) {
  const auto recording = openedAgain(recordedBar().path());
  const ReplayAnswer answer = ask(*recording, "scene");
  ASSERT_EQ(answer.status, 200) << answer.body;
  SceneFacts live = *recordedBar().facts;
  live.session = 1;
  live.program_version = orThrow(RecordingReader::open(recordedBar().path()))->meta().git_version;
  const wire::Bytes expected = wire::sceneMessage(live);
  EXPECT_TRUE(answer.body == std::string(expected.begin(), expected.end()));
  const auto* data = reinterpret_cast<const std::uint8_t*>(answer.body.data());
  const fb::Scene* scene = verified(data, answer.body.size()).payload_as_Scene();
  ASSERT_NE(scene, nullptr);
  EXPECT_EQ(scene->exercise_name()->str(), "cocktail-bar");
  EXPECT_GT(scene->bodies()->size(), 3U);
  EXPECT_FALSE(scene->exercise_json()->str().empty());
}

TEST(ReplayedRecording, About_DescribesTheContentsOfTheFile) {
  const auto recording = openedAgain(recordedBar().path());
  const Json about = aboutOf(*recording);
  const Json expected = {{"name", "bar.h5"},
                         {"title", "bar"},
                         {"ticks", recordedBar().states.size()},
                         {"from_s", 0.0},
                         {"device", "lambda-pride"},
                         {"hand", "adult-median-right"},
                         {"patient", "relaxed-adult"},
                         {"exercise", "cocktail-bar"},
                         {"level", 1},
                         {"picture", true},
                         {"whole", true},
                         {"run_again", true},
                         {"still_written", false},
                         {"simulated_device", true}};
  for (const auto& [key, value] : expected.items()) EXPECT_EQ(about[key], value) << key;
  EXPECT_NEAR(about["to_s"].get<double>(), 1e-3 * static_cast<double>(recordedBar().states.size()),
              1e-9);
  EXPECT_FALSE(about.contains("no_picture_because"));
  ASSERT_FALSE(about["result"].empty());
  EXPECT_TRUE(about["result"][0]["value"].is_number());
  EXPECT_TRUE(about["result"][0]["decimals"].is_number());
}

TEST(ReplayedRecording, StatesInSteps_AreTheRequestedRowsAndFewerAtTheEnd) {
  const auto recording = openedAgain(recordedBar().path());
  const auto ticksOf = [&](const std::string& question) {
    std::vector<std::uint64_t> ticks;
    for (const std::string& message : messagesIn(ask(*recording, question))) {
      ticks.push_back(stateIn(message).tick());
    }
    return ticks;
  };
  const std::uint64_t size = recordedBar().states.size();
  EXPECT_EQ(ticksOf("states?tick=10&count=3&step=400"), (std::vector<std::uint64_t>{10, 410, 810}));
  EXPECT_EQ(ticksOf("states?tick=" + std::to_string(size - 2) + "&count=256&step=1"),
            (std::vector<std::uint64_t>{size - 2, size - 1}));
  EXPECT_TRUE(ticksOf("states?tick=" + std::to_string(size) + "&count=1&step=1").empty());
}

TEST(ReplayedRecording, RecordingWithoutExerciseOrBodies_ShowsTheHandAlone) {
  const Folder folder;
  const auto recording =
      openedAgain(recordRest(load(shippedFiles("lambda-pride", "empty")), folder.file("rest.h5")));
  const Json about = aboutOf(*recording);
  EXPECT_EQ(about["exercise"], "");
  EXPECT_EQ(about["result"], Json::array());
  EXPECT_EQ(about["value_names"], Json::array());
  const auto messages = messagesIn(ask(*recording, "states?tick=0&count=5&step=20"));
  ASSERT_EQ(messages.size(), 5U);
  EXPECT_EQ(stateIn(messages[4]).bodies()->size(), 0U);
  EXPECT_GT(stateIn(messages[4]).links()->size(), 10U);
  const Series series(ask(*recording, "series?from_s=0&to_s=1&columns=4").body);
  EXPECT_TRUE(std::isnan(series.low(series.channel("palm_target_distance_m"), 0)))
      << "there is no body";
  EXPECT_EQ(series.high(series.channel("contact_count"), 0), 0.0F);
  EXPECT_EQ(ask(*recording, "scene").status, 200);
}

/// Writes a recording of plain ticks whose file contains no scene, hand ...
std::string synthetic(const Folder& folder, std::uint64_t ticks) {
  const std::string path = folder.file("synthetic.h5");
  synthetic::writeRecording(path, synthetic::noisyTicks(ticks, 5));
  return path;
}

TEST(ReplayedRecording, RecordingWithoutItsSceneFiles_HasAllButThePicture) {
  const Folder folder;
  const auto recording = openedAgain(synthetic(folder, 300));
  const Json about = aboutOf(*recording);
  EXPECT_EQ(about["picture"], false);
  const std::string why = about["no_picture_because"];
  EXPECT_TRUE(contains(why, "carries no scene file"));
  EXPECT_EQ(about["run_again"], false) << "its models were changed in memory";
  EXPECT_EQ(about["device"], "lambda-pride");
  EXPECT_EQ(about["axes"].size(), 6U);
  const ReplayAnswer scene = ask(*recording, "scene");
  EXPECT_EQ(scene.status, 422);
  EXPECT_EQ(Json::parse(scene.body)["error"], why);
  const auto messages = messagesIn(ask(*recording, "states?tick=299&count=1&step=1"));
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(stateIn(messages[0]).links(), nullptr);
  EXPECT_EQ(stateIn(messages[0]).q_m()->size(), 6U);
}

TEST(ReplayedRecording, RecordingWithoutTicks_IsRefused) {
  const Folder folder;
  const ReplayAnswer refused = ask(*openedAgain(synthetic(folder, 0)), "about");
  EXPECT_EQ(refused.status, 422);
  EXPECT_TRUE(contains(Json::parse(refused.body)["error"].get<std::string>(), "holds no ticks"));
}

/// A recording of 2000 ticks in eight chunks of 250; one chunk of `dataset` is overwritten with
/// zeros.
std::string damaged(const Folder& folder, const std::string& dataset, int chunk) {
  const std::string path = synthetic(folder, 2000);
  EXPECT_EQ(python("path, name, number = '" + path + "', '" + dataset + "', " +
                   std::to_string(chunk) + R"(
import h5py
with h5py.File(path, 'r') as f:
  chunk = f[name].id.get_chunk_info(number)
with open(path, 'r+b') as raw:
  raw.seek(chunk.byte_offset + 4)
  raw.write(bytes(chunk.size - 4)))"),
            "");
  return path;
}

TEST(ReplayedRecording, DamagedEnd_IsReportedWithItsTimeAndShownUpToThere) {
  const Folder folder;
  const auto recording = openedAgain(damaged(folder, "ticks/elapsed_periods", 1));
  const Json about = aboutOf(*recording);
  EXPECT_EQ(about["whole"], false);
  EXPECT_EQ(about["unreadable_from_s"], 1.0);
  EXPECT_EQ(about["ticks"], 1000);
  EXPECT_EQ(about["to_s"], 2.0) << "the time line goes on to where the ticks were";
  EXPECT_EQ(about["run_again"], false);
  EXPECT_EQ(messagesIn(ask(*recording, "states?tick=999&count=2&step=1")).size(), 1U);
}

TEST(ReplayedRecording, DamagedChunk_IsReportedAndTheRestIsShown) {
  const Folder folder;
  constexpr std::uint64_t kBad = 250;
  const auto recording = openedAgain(damaged(folder, "ticks/q_m", 0));
  EXPECT_EQ(aboutOf(*recording)["ticks"], 2000);
  const ReplayAnswer state =
      ask(*recording, "states?tick=" + std::to_string(kBad) + "&count=1&step=1");
  EXPECT_EQ(state.status, 422);
  EXPECT_TRUE(contains(state.body, "cannot be read"));
  const Series series(ask(*recording, "series?from_s=-0.0005&to_s=1.9995&columns=2000").body);
  EXPECT_TRUE(series.header["truncated"]);
  const std::size_t channel = series.channel("q_m", 0);
  EXPECT_TRUE(std::isnan(series.low(channel, kBad)));
  std::size_t shown = 0;
  for (std::size_t c = 0; c < 2000; ++c) shown += std::isnan(series.low(channel, c)) ? 0 : 1;
  EXPECT_EQ(shown, 1000U) << "a chunk of a second is lost, no more";
  ASSERT_FALSE(series.header["unreadable"].empty());
  EXPECT_NEAR(series.header["unreadable"][0]["from_s"].get<double>(), 0.0, 1e-9);
}

}  // namespace
}  // namespace wholehand::test
