// Every shipped hand on every shipped device in every shipped scene.
#include "clinic/presets/presets.hpp"
#include "exercises/load_exercise.hpp"
#include "files/hand/hand_file.hpp"
#include "loop/renderer/live_settings.hpp"
#include "rig/models.hpp"
#include "support/rig_tools.hpp"
#include "support/seed.hpp"
#include "support/shipped.hpp"
#include "support/test_names.hpp"
#include "support/tolerance.hpp"

#include <Eigen/Core>
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

namespace wholehand::test {
namespace {

/// Moves from the back and the top into the middle while closing; `aside` is the share of the way
/// to the left.
Intention reachIn(const DeviceModel& device, double aside) {
  AxisPosition start(device.axisCount()), end(device.axisCount());
  for (int a = 0; a < start.size(); ++a) {
    const DeviceAxis& axis = device.axes[a];
    if (axis.name == "x") start[a] = 0.95 * axis.lower;
    if (axis.name == "y") start[a] = aside * axis.upper;
    if (axis.name == "z") start[a] = 0.95 * axis.upper;
    if (axis.group == AxisGroup::kHand) end[a] = 0.6 * axis.upper;
    if (axis.kind == AxisKind::kRotation && axis.group == AxisGroup::kBase) end[a] = 0.2;
  }
  return Intention::throughWaypoints({{0.0, start}, {0.8, end}});
}

/// Builds and arms a rig. @return null where the hand would start inside a body
std::shared_ptr<Rig> armed(const std::string& device, const std::string& scene,
                           const std::string& hand, double aside) {
  Models m = load(shippedFiles(device, scene, hand));
  Intention intention = reachIn(m.device, aside);
  // The gains must be certified: `uncertified` is not set.
  std::shared_ptr<Rig> rig = orThrow(buildRig(std::move(m), std::move(intention), {}));
  return rig->renderer->arm() ? rig : nullptr;
}

// A clinic plans without a station, so its file names the limits, too.
TEST(EveryDevice, ParametersThatBoundEfforts_AreThoseOfTheClinicsFile) {
  const auto presets = orThrow(
      clinic::loadPresets(std::string(WHOLEHAND_SOURCE_DIR) + "/config/clinic/presets.toml"));
  const std::set<std::string> expected(presets.limits.begin(), presets.limits.end());
  std::set<std::string> found;
  for (const std::string& name : shipped("devices")) {
    const Models m =
        load(shippedFiles(name, shipped("scenes").front(), shippedHands(0, true).front()));
    const LiveSettings live(m.device, makeAdaptiveDamping(m.device, m.rendering));
    for (const LiveParameter& parameter : live.parameters()) {
      if (parameter.bounds_effort) found.insert(parameter.name);
    }
  }
  EXPECT_EQ(found, expected);
}

class EveryFile : public testing::TestWithParam<std::string> {};

TEST_P(EveryFile, OnThisDevice_BuildsArmsAndRunsASecond) {
  const std::string& device = GetParam();
  const std::vector<std::string> hands = shippedHands(seed(), cases(1) > 1);
  const std::vector<std::string> scenes = shipped("scenes");
  ASSERT_GE(hands.size(), 7U);
  ASSERT_GE(scenes.size(), 3U);
  int touching = 0, tried = 0, begun = 0;
  std::size_t index = 0;
  for (const std::string& hand : hands) {
    for (const std::string& scene : scenes) {
      // Samples: every hand, and every scene with some hand; the seed decides the pairs.
      const std::size_t pair = index++;
      const std::size_t due = (pair / scenes.size() + seed()) % scenes.size();
      if (cases(1) == 1 && pair % scenes.size() != due) continue;
      if (leftOutUnderASanitizer(pair / scenes.size())) continue;
      SCOPED_TRACE(hand + " in " + scene);
      // Small devices must start beside the bodies in the middle; bodies that fill their whole
      // range leave no place for a large hand.
      std::shared_ptr<Rig> rig;
      for (const double aside : {0.0, 0.95, -0.95}) {
        if (!rig) rig = armed(device, scene, hand, aside);
      }
      ++tried;
      if (!rig) continue;
      ++begun;
      double coupling_error = 0.0;
      int touched = 0;
      runTicks(*rig->renderer, 1000, [&](const TickRecord& r) {
        ASSERT_EQ(r.faults & kStoppingFaults, Fault::kNone) << "tick " << r.tick;
        ASSERT_EQ(r.contacts_dropped, 0);
        for (int i = 0; i < r.body_count; ++i) {
          ASSERT_LT(r.bodies[i].velocity_m_s.eigen().norm(), 10.0) << "tick " << r.tick;
        }
        coupling_error = std::max(coupling_error, r.coupling_error_rad);
        touched += r.contact_count > 0 ? 1 : 0;
      });
      EXPECT_LE(coupling_error, tolerance(1e-5));
      touching += touched > 0 ? 1 : 0;
    }
  }
  EXPECT_GE(begun, device == "desktop-3axis" ? 0.9 * tried - 1.0 : tried);
  if (cases(1) > 1) {
    EXPECT_GT(touching, 0);
  }
}
INSTANTIATE_TEST_SUITE_P(Devices, EveryFile, testing::ValuesIn(shipped("devices")),
                         [](const auto& tested) { return withoutHyphens(tested.param); });

// Compares left hands of every size with right ones, in mirrored scenes, through the whole
// renderer.

/// Mirror image for lambda-pride in the plane y = 0: only y changes its sign.
template <class Axes>
Axes mirrored(Axes axes) {
  axes[1] = -axes[1];
  return axes;
}

/// A hand that reaches from the back for a fixed ball beside it, closes and is pushed back.
std::unique_ptr<Rig> reaching(const std::string& size, bool left) {
  Models m = load(shippedFiles("lambda-pride", "empty", size + (left ? "-left" : "-right")));
  // Frictionless, so that the solver's choice of tangents does not matter.
  SceneBody body = ball({0.09, left ? -0.07 : 0.07, 0.0}, 0.03, 0.0);
  body.friction = 0.0;
  m.scene.bodies = {body};
  AxisPosition from(6), to(6);
  from[0] = -0.07;
  to[0] = 0.03;
  to[1] = 0.02;
  to[3] = 2.2;
  to[5] = 0.8;
  return buildScripted(std::move(m), left ? moveAndHold(mirrored(from), mirrored(to), 800)
                                          : moveAndHold(from, to, 800));
}

TEST(LeftHandOfEverySize, MirroredScene_RendersTheMirroredEffort) {
  double apart_n = 0.0;
  for (const std::string& size :
       sampleTenth<std::string>({"adult-median", "woman-p05", "woman-p50", "woman-p95", "man-p05",
                                 "man-p50", "man-p95"})) {
    const std::unique_ptr<Rig> right = reaching(size, false), left = reaching(size, true);
    ASSERT_TRUE(right->renderer->arm()) << size;
    ASSERT_TRUE(left->renderer->arm()) << size;
    std::vector<AxisEffort> felt;
    double most = 0.0;
    runTicks(*right->renderer, 1200, [&](const TickRecord& r) {
      felt.push_back(r.sent);
      most = std::max(most, std::abs(r.sent[3]));
    });
    EXPECT_GT(most, 0.05) << size << ": the fingers met the ball";  // N m
    runTicks(*left->renderer, 1200, [&](const TickRecord& r) {
      const AxisEffort image = mirrored(r.sent);
      apart_n = std::max(apart_n, (image.vec() - felt[r.tick].vec()).cwiseAbs().maxCoeff());
    });
  }
  figure("left hands' effort against the mirror image of the right ones'", apart_n, "N or N m");
  EXPECT_LE(apart_n, tolerance(1e-6));
}

// A glove with an axis for every finger joint: twelve rotations, no base. 3^12 postures would take
// minutes; the check must stay fast and still include the corners.

const std::string kRoot = WHOLEHAND_SOURCE_DIR;

Models glove() {
  auto file = loadHandFile(kRoot + "/config/hands/adult-median-right.toml");
  EXPECT_TRUE(file.ok());
  file->synergy.clear();
  file->reference.clear();
  Models models;
  for (const JointRange& joint : file->joints) {
    if (joint.joint.find("thumb") != std::string::npos) continue;
    file->synergy.push_back({joint.joint, joint.joint, 1.0});
    file->reference.emplace_back(joint.joint, 0.5 * joint.upper_rad);
    DeviceAxis axis;
    axis.name = joint.joint;
    axis.kind = AxisKind::kRotation;
    axis.group = AxisGroup::kHand;
    axis.lower = joint.lower_rad;
    axis.upper = joint.upper_rad;
    axis.effort_limit = 1.0;
    axis.speed_limit = 10.0;
    axis.mass = 1e-4;
    models.device.axes.push_back(axis);
  }
  models.hand = orThrow(assembleHand(*file, models.device));
  return models;
}

TEST(SampledInertia, GloveOfTwelveRotations_IsSampled) {
  const Models models = glove();
  ASSERT_EQ(models.device.axisCount(), 12);
  const SampledInertia inertia = sampleInertia(models.hand, models.device);
  EXPECT_EQ(inertia.samples.size(), 729U);  // 3^6, as many as for six rotations
  const SampledInertia again = sampleInertia(models.hand, models.device);
  for (std::size_t i = 0; i < inertia.samples.size(); ++i) {
    ASSERT_EQ(inertia.samples[i], again.samples[i]);  // the same result every time
    EXPECT_GT(inertia.samples[i].diagonal().minCoeff(), 0.0);
  }
  // A straight finger has more inertia at its knuckle than a bent one: the samples contain both
  // ends.
  EXPECT_GT(inertia.samples[0](0, 0), inertia.samples[2](0, 0));
}

// Every shipped exercise starts: no hand starts inside an object to be grasped.

std::string config(const std::string& name) {
  return std::string(WHOLEHAND_SOURCE_DIR) + "/config/" + name;
}

/// Starts as `run` and the station do: with its virtual patient, or with a hand at rest where it
/// has none.
void expectBegins(Models models, std::uint64_t seed) {
  std::unique_ptr<Player> player = makeExercisePlayer(models, seed);
  if (!player) player = makeMotionPlayer(models);
  const auto rig = orThrow(buildRig(std::move(models), std::move(player), {}));
  const auto armed = rig->renderer->arm();
  ASSERT_TRUE(armed.ok()) << format(armed.errors());
  runTicks(*rig->renderer, 20, [](const TickRecord& r) {
    ASSERT_EQ(r.faults & kStoppingFaults, Fault::kNone) << "tick " << r.tick;
    ASSERT_EQ(r.contact_count, 0) << "touches at tick " << r.tick;
  });
}

TEST(ShippedExercises, EveryLevel_ArmsAtItsStartWithoutContact) {
  const std::vector<ExerciseFile> exercises = listExercises(config("exercises"));
  ASSERT_GE(exercises.size(), 3U);
  std::size_t index = 0;
  for (const ExerciseFile& file : exercises) {
    int levels = 1;
    for (int level = 1; level <= levels; ++level) {
      for (const std::uint64_t seed : {1U, 2U}) {  // the virtual patient's start depends on it
        if (level > 1 && leftOutUnderASanitizer(index++)) continue;
        SCOPED_TRACE(file.name + ", level " + std::to_string(level) + ", seed " +
                     std::to_string(seed));
        ModelFiles files = shippedFiles();
        files.exercise = file.path;
        files.level = level;
        Models models = load(files);
        levels = models.exercise->description().levels;
        expectBegins(std::move(models), seed);
      }
    }
  }
}

// The exercise names no device and no hand, so it starts with any of them.
TEST(ShippedExercises, FreeGrasping_ArmsWithEveryDeviceAndHand) {
  std::size_t index = 0;
  for (const std::string& device : shipped("devices")) {
    for (const std::string& hand : shippedHands(seed(), cases(1) > 1)) {
      if (leftOutUnderASanitizer(index++)) continue;
      SCOPED_TRACE(hand + " on " + device);
      expectBegins(load(exerciseFiles("free-grasping", 1, hand, device)), 1);
    }
  }
}

/// A body is within reach if the device can put the palm into the power grasp of a bottle: the
/// bottle's axis is (0.049, 0.041, 0.004) m from the palm's base (docs/exercises.md, dispensers).
TEST(ShippedExercises, FreeGrasping_EveryBodyIsWithinReachOfAGrasp) {
  const Models models = load(exerciseFiles("free-grasping"));
  ASSERT_FALSE(models.scene.bodies.empty());
  const Eigen::Vector3d held_m(0.049, 0.041, 0.004);
  for (const SceneBody& body : models.scene.bodies) {
    const Eigen::Vector3d base_m = body.pose.translation_m - held_m;
    for (int i = 0; i < 3; ++i) {
      const DeviceAxis& axis =
          models.device.axes[models.device.axisIndex(std::string(1, "xyz"[i]))];
      EXPECT_GE(base_m[i], axis.lower) << body.name << " along " << axis.name;
      EXPECT_LE(base_m[i], axis.upper) << body.name << " along " << axis.name;
    }
  }
}

}  // namespace
}  // namespace wholehand::test
