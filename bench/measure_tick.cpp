// One scene's ticks, for counting their instructions, timing them and telling whether their bits
// have changed.
//
//   measure_tick SCENE [TICKS]
//
// Prints the CPU time of a tick and a digest of all that the ticks computed. Two programs that
// print one digest computed the same to the last bit. scripts/tick_cost.py runs it under Callgrind.
#include "assembly/rig.hpp"
#include "bench/rig_files.hpp"
#include "experiments/complexity_scenes.hpp"
#include "experiments/exercise_script.hpp"
#include "experiments/grasp_script.hpp"
#include "experiments/grip_target.hpp"
#include "files/text_file.hpp"
#include "realtime/monotonic_clock.hpp"
#include "realtime/thread_setup.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <unistd.h>
#include <vector>

namespace wholehand {

/// What Callgrind counts: its name is passed to --toggle-collect.
[[gnu::noinline]] void measuredTick(HapticRenderer& renderer, TickRecord& record) {
  renderer.tick(1, record);
}

/// Where Callgrind writes the count of one tick: its name is passed to --dump-before.
[[gnu::noinline]] void countedTick(const TickRecord& record) {
  asm volatile("" : : "r"(&record) : "memory");
}

namespace {

/// A rig, and how many of its ticks pass before those that are measured.
struct Prepared {
  std::unique_ptr<Rig> rig;
  int ticks_before = 0;
};

ModelFiles barFiles() {
  ModelFiles files = filesOf("cocktail-bar.toml");
  files.exercise = WHOLEHAND_SOURCE_DIR "/config/exercises/cocktail-bar.toml";
  return files;
}

/// The bar with its walls: the first dispenser is squeezed again and again, as in
/// `wholehand experiment timing`.
Prepared squeezeInBar(int ticks_before, const RigOptions& options) {
  Models models = orThrow(loadModels(barFiles()));
  const GripTarget target = firstDispenser(models);
  Intention aim = squeezeAgainAndAgain(models.device, target.grip_m, 3600.0);
  return {orThrow(buildRig(std::move(models), std::move(aim), options)), ticks_before};
}

/// An exercise played by its virtual patient.
Prepared play(const std::string& exercise, std::uint64_t seed, int ticks_before,
              const RigOptions& options) {
  ModelFiles files = barFiles();
  files.exercise = WHOLEHAND_SOURCE_DIR "/config/exercises/" + exercise + ".toml";
  Models models = orThrow(loadModels(files));
  auto player = makeExercisePlayer(models, seed);
  return {orThrow(buildRig(std::move(models), std::move(player), options)), ticks_before};
}

/// The hand at rest among the paper's four objects, which it does not touch.
Prepared restAmongFour(const RigOptions& options) {
  Models models = orThrow(loadModels(filesOf("four-shapes.toml")));
  AxisPosition rest(static_cast<int>(models.device.axes.size()));
  Intention aim = Intention::throughWaypoints({{0.0, rest}});
  return {orThrow(buildRig(std::move(models), std::move(aim), options)), 100};
}

/// A tuned grasp of `experiment grasping`: lifted, then held.
Prepared holdObject(const std::string& shape, const RigOptions& options) {
  GraspTrial trial;
  for (const GraspTrial& tuned : tunedTrials()) {
    if (tuned.shape == shape && tuned.gravity) trial = tuned;
  }
  if (trial.shape != shape) throw std::runtime_error("no tuned grasp holds a \"" + shape + "\"");
  const std::string scene =
      std::filesystem::temp_directory_path() / ("measure-tick-" + std::to_string(getpid()));
  ModelFiles files = filesOf("empty.toml");
  const Models without = orThrow(loadModels(files));
  orThrow(writeText(scene, graspScene(trial, without)));
  files.scene = scene;
  auto models = loadModels(files);
  std::filesystem::remove(scene);
  Models loaded = orThrow(std::move(models));
  Intention aim = graspIntention(trial, loaded);
  return {orThrow(buildRig(std::move(loaded), std::move(aim), options)),
          static_cast<int>(std::lround(grasp_times::kHoldBegins / 1e-3))};
}

/// A pile of balls with the hand in it, as in `wholehand experiment complexity`.
Prepared pressOnPile(int balls, const RigOptions& options) {
  constexpr int kDown = 500;  // ticks until the hand presses
  Models models = orThrow(loadModels(filesOf("empty.toml")));
  models.scene = orThrow(complexityScene(ComplexityKind::kPile, balls, models));
  Intention aim = swayingHand(models.device, 3600.0);
  return {orThrow(buildRig(std::move(models), std::move(aim), options)), kDown};
}

Prepared prepare(const std::string& scene, const RigOptions& options) {
  constexpr int kSqueezed = 4000;  // of squeezeAgainAndAgain: the walls are felt, the grip is firm
  if (scene == "approach") return squeezeInBar(0, options);
  if (scene == "squeeze") return squeezeInBar(kSqueezed, options);
  if (scene == "near") return restAmongFour(options);
  if (scene.rfind("hold-", 0) == 0) return holdObject(scene.substr(5), options);
  if (scene.rfind("pile-", 0) == 0) return pressOnPile(std::stoi(scene.substr(5)), options);
  if (scene == "drawer") return play(scene, 1, 4000, options);  // its bar is grasped and pulled
  if (scene.rfind("play-", 0) == 0) {
    return play("cocktail-bar", std::stoull(scene.substr(5)), 0, options);
  }
  throw std::runtime_error(
      "scene \"" + scene +
      "\" is none of approach, squeeze, near, drawer, hold-cube, hold-cylinder, "
      "hold-sphere, hold-disk, pile-BALLS, play-SEED");
}

/// FNV-1a over all that a tick computes.
class Digest {
 public:
  void add(const TickRecord& r) {
    for (const auto* a : {&r.q_s, &r.q_m, &r.closure}) addAll(*a);
    for (const auto* a : {&r.f_s, &r.coupling, &r.sent, &r.rendered}) addAll(*a);
    addAll(r.qd_s);
    addAll(r.theta);
    add(r.palm_distance_m);
    add(r.palm_target_distance_m);
    add(static_cast<double>(r.faults));
    for (int i = 0; i < r.exercise.value_count; ++i) add(r.exercise.values[i]);
    for (int i = 0; i < r.body_count; ++i) {
      add(r.bodies[i].position_m);
      add(r.bodies[i].velocity_m_s);
      add(r.bodies[i].angular_velocity_rad_s);
    }
    add(r.contact_count);
    for (int i = 0; i < r.contact_count; ++i) {
      add(r.contacts[i].capsule);
      add(r.contacts[i].point_m);
      add(r.contacts[i].force_n);
    }
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  void add(double x) {
    std::uint64_t bits = std::bit_cast<std::uint64_t>(x);
    for (int i = 0; i < 8; ++i, bits >>= 8) value_ = (value_ ^ (bits & 0xff)) * 0x100000001b3ULL;
  }
  void add(const Vec3& v) { add(v.x), add(v.y), add(v.z); }
  template <class Array>
  void addAll(const Array& a) {
    for (const double x : a) add(x);
  }

  std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

double percentile_us(std::vector<std::int64_t>& ns, double share) {
  const auto at =
      ns.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(ns.size() - 1));
  std::nth_element(ns.begin(), at, ns.end());
  return static_cast<double>(*at) * 1e-3;
}

void measure(const std::string& scene, int ticks, const RigOptions& options) {
  flushDenormals();
  const Prepared prepared = prepare(scene, options);
  HapticRenderer& renderer = *prepared.rig->renderer;
  orThrow(renderer.arm());
  TickRecord record;
  Digest digest;
  const auto see = [&] {  // a virtual patient decides by what it sees
    if (prepared.rig->listener) prepared.rig->listener->afterTick(record);
  };
  for (int k = 0; k < prepared.ticks_before; ++k) {
    renderer.tick(1, record);
    see();
    digest.add(record);
  }
  std::vector<std::int64_t> cpu_ns;
  int touched = 0;
  for (int k = 0; k < ticks; ++k) {
    const std::int64_t began_ns = threadCpuNow_ns();
    measuredTick(renderer, record);
    cpu_ns.push_back(threadCpuNow_ns() - began_ns);
    countedTick(record);
    see();
    digest.add(record);
    touched += record.contact_count > 0 ? 1 : 0;
  }
  std::printf("%s: %d ticks, %d of them with contacts, faults %u\n", scene.c_str(), ticks, touched,
              static_cast<unsigned>(record.faults));
  std::printf("CPU time of a tick: p50 %.1f us, p99.9 %.1f us\n", percentile_us(cpu_ns, 0.5),
              percentile_us(cpu_ns, 0.999));
  std::printf("digest: %016llx\n", static_cast<unsigned long long>(digest.value()));
}

}  // namespace
}  // namespace wholehand

int main(int argc, char** argv) {
  try {
    if (argc < 2) throw std::runtime_error("usage: measure_tick SCENE [TICKS [ENGINE]]");
    const int ticks = argc > 2 ? std::atoi(argv[2]) : 1000;
    if (ticks < 1)
      throw std::runtime_error(std::string("TICKS is \"") + argv[2] + "\": give 1 or more");
    wholehand::RigOptions options;
    if (argc > 3) options.engine = argv[3];
    wholehand::measure(argv[1], ticks, options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "measure_tick: %s\n", error.what());
    return 1;
  }
  return 0;
}
