// Measures the CPU time of the tick and of its parts, with one object in the hand.
//
//   bench_tick [--benchmark_filter=Tick] [--benchmark_repetitions=5]
//
// `wholehand experiment timing` gives the figures and percentiles of the whole system. This
// benchmark shows which part changed on the same machine.
#include "bench/rig_files.hpp"
#include "experiments/grasp_script.hpp"
#include "files/text/text_file.hpp"
#include "loop/dynamics/articulated_body.hpp"
#include "loop/realtime/spsc_queue.hpp"
#include "loop/realtime/stage_clock.hpp"
#include "loop/realtime/thread_setup.hpp"
#include "record/recording.hpp"

#include <benchmark/benchmark.h>

#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <unistd.h>

namespace wholehand {
namespace {

/// Temporary folder that is removed when the program ends.
class Folder {
 public:
  Folder()
      : path_(std::filesystem::temp_directory_path() /
              ("wholehand-bench-" + std::to_string(getpid()))) {
    std::filesystem::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::string file(const char* name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

const Folder& folder() {
  static const Folder folder;
  return folder;
}

/// A rig whose hand has grasped and lifted a cylinder; from then on the patient holds still.
struct Holding {
  std::unique_ptr<Rig> rig;
  TickRecord record;

  Holding() {
    flushDenormals();
    GraspTrial trial;
    for (const GraspTrial& tuned : tunedTrials()) {
      if (tuned.shape == "cylinder" && tuned.gravity) trial = tuned;
    }
    ModelFiles files = filesOf("empty.toml");
    const Models without = orThrow(loadModels(files));
    files.scene = folder().file("grasp.toml");
    orThrow(writeText(files.scene, graspScene(trial, without)));
    Models models = orThrow(loadModels(files));
    Intention intention = graspIntention(trial, models);
    rig = orThrow(buildRig(std::move(models), std::move(intention), {}));
    orThrow(rig->renderer->arm());
    const int ticks = static_cast<int>(std::lround(grasp_times::kHoldBegins / 1e-3));
    for (int k = 0; k < ticks; ++k) rig->renderer->tick(1, record);
    if (record.contact_count == 0) throw std::runtime_error("nothing is grasped");
  }
};

Holding& holding() {
  static Holding holding;
  return holding;
}

void tickHolding(benchmark::State& state) {
  Holding& h = holding();
  for (auto step : state) h.rig->renderer->tick(1, h.record);
  state.counters["contacts"] = h.record.contact_count;
}
BENCHMARK(tickHolding)->Name("Tick, a cylinder in the hand");

class Laps final : public StageListener {
 public:
  explicit Laps(StageClock& clock) : clock_(clock) {}
  void lap(Stage stage) noexcept override { clock_.lap(stage); }

 private:
  StageClock& clock_;
};

// Times collision detection and the contact solver inside their tick. The step alone would lose the
// grasp.
void physicsStep(benchmark::State& state) {
  Holding& h = holding();
  StageClock clock;
  Laps laps(clock);
  for (auto step : state) {
    clock.start();
    h.rig->renderer->tick(1, h.record, &laps);
    const StageTimes times = clock.finish();
    const auto stage = static_cast<std::size_t>(Stage::kPhysicsStep);
    state.SetIterationTime(times.stage_cpu_ns[stage] * 1e-9);
  }
  state.counters["contacts"] = h.record.contact_count;
}
BENCHMARK(physicsStep)->Name("Contact solver and step, of that tick")->UseManualTime();

void dynamics(benchmark::State& state) {
  const HandModel& hand = holding().rig->models.hand;
  ArticulatedBody body(hand);
  const JointVelocity theta_dot(hand.joint_count, 0.1);
  const Eigen::Vector3d gravity_m_s2(0.0, 0.0, -9.81);
  for (auto step : state) {
    benchmark::DoNotOptimize(body.update(holding().record.theta, theta_dot, gravity_m_s2));
  }
}
BENCHMARK(dynamics)->Name("h, M, their reduction and its inverse");

// Mean over many ticks. Most ticks only fill a buffer; some write a chunk of rows to the disk.
void recordingAppend(benchmark::State& state) {
  const Rig& rig = *holding().rig;
  RecordingMeta meta;
  meta.engine = "bullet";
  for (const DeviceAxis& axis : rig.models.device.axes) {
    meta.axis_names.push_back(axis.name);
    meta.axis_units.push_back(axis.positionUnit());
    meta.effort_limits.push_back(axis.effort_limit);
    meta.lever_arms_m.push_back(axis.lever_arm_m);
  }
  meta.armed_position.assign(rig.renderer->armedPosition().begin(),
                             rig.renderer->armedPosition().end());
  meta.joint_names = rig.models.hand.joint_names;
  for (const SceneBody& body : rig.models.scene.bodies) meta.body_names.push_back(body.name);
  for (const Capsule& capsule : rig.models.hand.capsules)
    meta.capsule_names.push_back(capsule.name);
  const auto writer = orThrow(RecordingWriter::create(folder().file("bench.h5"), meta));
  TickRecord record = holding().record;
  for (auto step : state) {
    ++record.tick;
    if (!writer->append(record)) state.SkipWithError("the disk is full");
  }
  writer->close();
}
BENCHMARK(recordingAppend)->Name("Recording, one tick appended");

void queuePush(benchmark::State& state) {
  RecordQueue queue(SessionConfig{}.queue_bytes);
  TickRecord record = holding().record;
  for (auto step : state) {
    benchmark::DoNotOptimize(queue.try_push(record));
    benchmark::DoNotOptimize(queue.try_pop(record));
  }
}
BENCHMARK(queuePush)->Name("Queue, one record in and out");

}  // namespace
}  // namespace wholehand

BENCHMARK_MAIN();
