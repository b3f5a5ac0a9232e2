// Runs the ticks of one scene, to count their instructions, to time them and to detect changes of
// their results.
//
//   measure_tick SCENE [TICKS]
//
// Prints the CPU time of a tick and a digest of all results of the ticks. Two programs that print
// the same digest computed bit-identical results. scripts/tick_cost.py runs this program under
// Callgrind. SCENE-bare is the scene without self contacts of the hand, armature and energy tank.
// If SCENE is "orders", the program executes TICKS commands to the bodies of a game instead of
// ticks.
#include "bench/rig_files.hpp"
#include "experiments/complexity_scenes.hpp"
#include "experiments/exercise_script.hpp"
#include "experiments/grasp_script.hpp"
#include "experiments/grip_target.hpp"
#include "files/mesh/convex_hull.hpp"
#include "files/mesh/convex_mesh.hpp"
#include "files/text/text_file.hpp"
#include "loop/model/game_shapes.hpp"
#include "loop/physics/physics_world.hpp"
#include "loop/realtime/monotonic_clock.hpp"
#include "loop/realtime/thread_setup.hpp"
#include "rig/rig.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <unistd.h>
#include <vector>

namespace wholehand {

/// The function whose instructions Callgrind counts; its name is passed to --toggle-collect.
[[gnu::noinline]] void measuredTick(HapticRenderer& renderer, TickRecord& record) {
  renderer.tick(1, record);
}

/// The same for one command.
[[gnu::noinline]] void measuredOrder(BodyPool& pool, const Command& order) {
  pool.apply(order);
}

/// Marks the point at which Callgrind writes the count of one tick or command; its name is passed
/// to --dump-before.
[[gnu::noinline]] void countedOne(const void* of) {
  asm volatile("" : : "r"(of) : "memory");
}

namespace {

/// A rig, and the number of its ticks before the measured ones.
struct Prepared {
  std::unique_ptr<Rig> rig;
  int ticks_before = 0;
};

constexpr double kEndless_s = 3600.0;

/// Changes the models for SCENE-bare.
void strip(Models& models, RigOptions& options) {
  models.hand.self_contacts.clear();
  for (AxisRendering& axis : models.rendering.axes) axis.armature = 0.0;
  options.uncertified = true;
}

/// Completes SCENE-bare: replaces the renderer of the rig by one without an energy tank.
void leaveOutTank(Rig& rig) {
  RendererConfig config = rig.renderer->config();
  config.safety.tank = {};
  rig.renderer =
      std::make_unique<HapticRenderer>(*rig.device, *rig.world, rig.models.hand, rig.models.scene,
                                       config, rig.models.exercise.get());
}

ModelFiles barFiles() {
  ModelFiles files = filesOf("cocktail-bar.toml");
  files.exercise = WHOLEHAND_SOURCE_DIR "/config/exercises/cocktail-bar.toml";
  return files;
}

/// The bar with its walls. The first dispenser is squeezed repeatedly, as in `wholehand experiment
/// timing`.
Prepared squeezeInBar(int ticks_before, RigOptions options, bool bare = false) {
  Models models = orThrow(loadModels(barFiles()));
  const GripTarget target = firstDispenser(models);
  if (bare) strip(models, options);
  Intention aim = squeezeAgainAndAgain(models.device, target.grip_m, kEndless_s);
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

/// *Squeeze to a level*, from its start; perhaps with a prescription of limits on every axis and a
/// corridor.
Prepared playGuided(bool guided, const RigOptions& options) {
  ModelFiles files = barFiles();
  files.exercise = WHOLEHAND_SOURCE_DIR "/config/exercises/squeeze-to-level.toml";
  Models models = orThrow(loadModels(files));
  if (guided) {
    Prescription all;
    for (int a = 0; a < models.device.axisCount(); ++a) {
      all.limits.push_back({a, models.device.axes[a].lower, models.device.axes[a].upper});
    }
    all.corridor = {0.02, 100.0};
    models.prescription = all;
  }
  auto player = makeExercisePlayer(models, 3);
  return {orThrow(buildRig(std::move(models), std::move(player), options)), 0};
}

/// The drawer of `drawer` with two flaps on hinges at its front: a tree of three coordinates under
/// the hand.
Prepared pullTree(int ticks_before, const RigOptions& options) {
  ModelFiles files = barFiles();
  files.exercise = WHOLEHAND_SOURCE_DIR "/config/exercises/drawer.toml";
  Models models = orThrow(loadModels(files));
  auto player = makeExercisePlayer(models, 1);
  std::vector<SceneBody>& bodies = models.scene.bodies;
  const auto drawer = std::find_if(bodies.begin(), bodies.end(),
                                   [](const SceneBody& body) { return body.joint.has_value(); });
  const int index = static_cast<int>(drawer - bodies.begin());
  for (const double side : {-1.0, 1.0}) {
    SceneBody flap;
    flap.name = side < 0.0 ? "right flap" : "left flap";
    flap.mass_kg = 0.1;
    flap.pose = bodies[index].pose;
    flap.pose.translation_m += Eigen::Vector3d(0.2, 0.1 * side, -0.1);
    flap.shapes.emplace_back().half_extents_m = {0.05, 0.005, 0.05};
    const ShapeMoments about = moments(flap.shapes[0]);
    flap.inertia_kg_m2 = flap.mass_kg / about.volume_m3 * about.inertia_m5;
    flap.joint.emplace();
    flap.joint->point_m = {-0.05, 0.0, 0.0};
    flap.joint->dry_friction = 0.01;
    flap.joint->parent = index;
    bodies.push_back(flap);
  }
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

/// A scene of `wholehand experiment complexity`: a pile of balls with the hand in it, or bodies
/// that the hand cannot reach.
Prepared swayAmong(ComplexityKind kind, int bodies, const RigOptions& options) {
  constexpr int kDown = 500;  // ticks until the hand presses
  Models models = orThrow(loadModels(filesOf("empty.toml")));
  models.scene = orThrow(complexityScene(kind, bodies, models));
  Intention aim = swayingHand(models.device, kEndless_s);
  return {orThrow(buildRig(std::move(models), std::move(aim), options)), kDown};
}

Models gameModels() {
  ModelFiles files = barFiles();
  files.scene.clear();
  files.exercise = WHOLEHAND_SOURCE_DIR "/config/exercises/game-scene.toml";
  return orThrow(loadModels(files));
}

/// The hand at rest, with the parked slots of a game or without slots.
Prepared restBesideSlots(bool slots, const RigOptions& options) {
  Models models = gameModels();
  if (!slots) models.scene.game = {};
  const AxisPosition rest(models.device.axisCount());
  Intention aim = Intention::throughWaypoints({{0.0, rest}});
  return {orThrow(buildRig(std::move(models), std::move(aim), options)), 100};
}

/// A hand that repeatedly closes by `share` of its range and opens, without touching a body.
Prepared closeInTheAir(double share, RigOptions options, bool bare) {
  constexpr double kHalf_s = 0.6, kSway_m = 0.05;
  constexpr int kTurns = 100;
  Models models = orThrow(loadModels(filesOf("empty.toml")));
  if (bare) strip(models, options);
  std::vector<Waypoint> way;
  for (int k = 0; k < kTurns; ++k) {
    AxisPosition at(models.device.axisCount());
    for (int a = 0; a < at.size(); ++a) {
      const DeviceAxis& axis = models.device.axes[a];
      if (axis.group == AxisGroup::kHand && k % 2 == 1) at[a] = share * axis.upper;
    }
    at[0] = k % 4 < 2 ? kSway_m : -kSway_m;
    way.push_back({k * kHalf_s, at});
  }
  Intention aim = Intention::throughWaypoints(way);
  return {orThrow(buildRig(std::move(models), std::move(aim), options)), 0};
}

/// Removes the suffix -bare from `scene`; returns true when it had the suffix.
bool takeBare(std::string& scene) {
  constexpr std::string_view kBare = "-bare";
  if (!scene.ends_with(kBare)) return false;
  scene.resize(scene.size() - kBare.size());
  return true;
}

Prepared prepareScene(const std::string& scene, bool bare, const RigOptions& options) {
  // Tick of squeezeAgainAndAgain with rendered walls and a firm grip.
  constexpr int kSqueezed = 4000;
  const auto counted = [&scene](const std::string& kind) {
    return scene.starts_with(kind) ? std::stoi(scene.substr(kind.size())) : -1;
  };
  if (scene == "squeeze") return squeezeInBar(kSqueezed, options, bare);
  if (const int percent = counted("close-"); percent >= 0) {
    return closeInTheAir(0.01 * percent, options, bare);
  }
  if (bare) throw std::runtime_error("only squeeze and close-PERCENT have a -bare");
  if (scene == "approach") return squeezeInBar(0, options);
  if (scene == "near") return restAmongFour(options);
  if (scene == "slots" || scene == "no-slots") return restBesideSlots(scene == "slots", options);
  if (scene.starts_with("hold-")) return holdObject(scene.substr(5), options);
  if (const int n = counted("pile-"); n >= 0) return swayAmong(ComplexityKind::kPile, n, options);
  if (const int n = counted("far-"); n >= 0) return swayAmong(ComplexityKind::kFar, n, options);
  if (scene == "drawer") return play(scene, 1, 4000, options);  // the handle is grasped and pulled
  if (scene == "guided" || scene == "unguided") return playGuided(scene == "guided", options);
  if (scene == "drawer-tree") return pullTree(4000, options);
  if (scene.starts_with("play-")) {
    return play("cocktail-bar", std::stoull(scene.substr(5)), 0, options);
  }
  throw std::runtime_error(
      "scene \"" + scene +
      "\" is none of approach, squeeze, near, drawer, drawer-tree, guided, unguided, slots, "
      "no-slots, orders, "
      "hold-cube, "
      "hold-cylinder, hold-sphere, hold-disk, close-PERCENT, pile-BALLS, far-BODIES, play-SEED; "
      "squeeze and close-PERCENT also with -bare");
}

Prepared prepare(std::string scene, const RigOptions& options) {
  const bool bare = takeBare(scene);
  Prepared prepared = prepareScene(scene, bare, options);
  if (bare) leaveOutTank(*prepared.rig);
  return prepared;
}

/// FNV-1a hash of everything that a tick computes.
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
  // Passes the record to a virtual patient, which bases its decisions on it.
  const auto onRecord = [&] {
    if (prepared.rig->listener) prepared.rig->listener->afterTick(record);
  };
  for (int k = 0; k < prepared.ticks_before; ++k) {
    renderer.tick(1, record);
    onRecord();
    digest.add(record);
  }
  std::vector<std::int64_t> cpu_ns;
  int touched = 0;
  for (int k = 0; k < ticks; ++k) {
    const std::int64_t began_ns = threadCpuNow_ns();
    measuredTick(renderer, record);
    cpu_ns.push_back(threadCpuNow_ns() - began_ns);
    countedOne(&record);
    onRecord();
    digest.add(record);
    touched += record.contact_count > 0 ? 1 : 0;
  }
  std::printf("%s: %d ticks, %d of them with contacts, faults %u\n", scene.c_str(), ticks, touched,
              static_cast<unsigned>(record.faults));
  std::printf("CPU time of a tick: p50 %.1f us, p99.9 %.1f us\n", percentile_us(cpu_ns, 0.5),
              percentile_us(cpu_ns, 0.999));
  std::printf("digest: %016llx\n", static_cast<unsigned long long>(digest.value()));
}

/// A prism with the largest number of vertices that the shipped game's budget allows.
Shape prism() {
  constexpr int kPoints = 32;
  constexpr double kRadius_m = 0.025, kHalf_m = 0.02;
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < kPoints; ++i) {
    const double angle = 2.0 * M_PI * (i / 2) / (kPoints / 2.0);
    points.emplace_back(kRadius_m * std::cos(angle), kRadius_m * std::sin(angle),
                        i % 2 == 0 ? kHalf_m : -kHalf_m);
  }
  const MeshSurface hull = orThrow(convexHull(points));
  return orThrow(convexMesh(hull.points, hull.triangles));
}

/// Removes, spawns and teleports twenty bodies above the hand in turn, three commands per step.
void measureOrders(int orders, const RigOptions& options) {
  constexpr int kSlots = 20;
  const Models models = gameModels();
  const auto world = orThrow(buildWorld(options.engine, models.hand, models.scene));
  BodyPool* const pool = world->bodyPool();
  const int axes = models.device.axisCount();
  if (pool == nullptr || !world->placeHand(AxisPosition(axes))) {
    throw std::runtime_error("engine \"" + options.engine + "\" has no bodies for a game");
  }
  Shape cube;
  cube.half_extents_m.setConstant(0.02);
  int set = 0;
  // Prepares two sets of shapes: a cube and a prism.
  for (const Shape& shape : {cube, prism()}) {
    const PreparedShapes shapes = orThrow(prepareShapes({shape}, models.scene.game));
    for (const Command& c : shapeCommands(set, shapes)) pool->apply(c);
    ++set;
  }
  const AxisMatrix inverse = AxisMatrix::Identity(axes, axes);
  HandDrive drive;
  drive.effort = AxisEffort(axes);
  drive.reduced_inertia_inverse = &inverse;
  const auto apply = [pool](const Command& order) {
    measuredOrder(*pool, order);
    countedOne(&order);
  };
  // Each step replaces and teleports the body of one slot.
  for (int k = 0; 3 * k < orders; ++k) {
    const int slot = k % kSlots, generation = 1 + k / kSlots;
    SpawnOrder spawn;
    spawn.slot = slot;
    spawn.generation = generation;
    spawn.shape_set = k % 2;
    spawn.owner = BodyOwner::kFixed;
    spawn.pose = {Vec3::from({0.02 * (slot % 5), 0.03 * (slot / 5) - 0.05, 0.0}),
                  QuatXyzw::from(Eigen::Quaterniond::Identity())};
    apply(removeCommand(slot, generation - 1));
    apply(spawnCommand(spawn));
    apply(teleportCommand(slot, generation, spawn.pose));
    if (any(world->step(drive, 1e-3) & kStoppingFaults)) throw std::runtime_error("a step failed");
  }
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
    if (std::string_view(argv[1]) == "orders") {
      wholehand::measureOrders(ticks, options);
    } else {
      wholehand::measure(argv[1], ticks, options);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "measure_tick: %s\n", error.what());
    return 1;
  }
  return 0;
}
