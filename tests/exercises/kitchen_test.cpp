// Tasks of daily life: their rules, the shipped tasks played by virtual patients, and faulty files.
#include "exercises/bar_table.hpp"
#include "exercises/kitchen/kitchen_player.hpp"
#include "exercises/kitchen/kitchen_task.hpp"
#include "rig/run/run.hpp"
#include "support/contains.hpp"
#include "support/figure.hpp"
#include "support/folder.hpp"
#include "support/rig_tools.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"

namespace wholehand::test {
namespace {

using kitchen::KitchenTask;
using kitchen::Means;
using kitchen::Step;
using kitchen::TaskSteps;
using kitchen::ThingObservation;
using kitchen::Verb;

Step stepOf(Verb verb) {
  Step step;
  step.verb = verb;
  step.within_m = 0.03;
  step.force_n = 1.0;
  step.to = 0.1, step.tolerance = 0.01;
  step.for_s = 0.5;
  step.center_m = step.half_size_m = Eigen::Vector3d::Constant(0.1);
  return step;
}

/// Ticks until the only step ends; 0: it does not end within 2 s.
int ticksUntilDone(Verb verb, const ThingObservation& seen) {
  KitchenTask task;
  task.things.emplace_back();
  task.steps = {stepOf(verb)};
  TaskSteps steps(task);
  for (int k = 1; k <= 2000; ++k) {
    if (steps.tick(seen, kTick_s)) return k;
  }
  return 0;
}

TEST(TaskSteps, EachVerb_EndsOnlyByItsOwnCondition) {
  ThingObservation away;
  away.palm_m = 1.0, away.handle_n = 0.5;
  for (const Verb verb : {Verb::kReach, Verb::kTake, Verb::kMove, Verb::kHold, Verb::kPress,
                          Verb::kPut, Verb::kLetGo}) {
    ThingObservation seen = away;
    seen.center_m.setConstant(1.0);
    EXPECT_EQ(ticksUntilDone(verb, seen), 0) << kitchen::kVerbs[static_cast<int>(verb)];
  }
  ThingObservation near = away;
  near.palm_m = 0.03;
  EXPECT_EQ(ticksUntilDone(Verb::kReach, near), 1);
  ThingObservation taken = away;
  taken.squeeze_n = 1.0;
  EXPECT_NEAR(ticksUntilDone(Verb::kTake, taken), 200, 1);
  ThingObservation moved = away;
  moved.q = 0.109;
  EXPECT_EQ(ticksUntilDone(Verb::kMove, moved), 1);
  EXPECT_NEAR(ticksUntilDone(Verb::kHold, moved), 500, 1);
  ThingObservation pressed = away;
  pressed.handle_n = 1.0;
  EXPECT_NEAR(ticksUntilDone(Verb::kPress, pressed), 500, 1);
  ThingObservation there = away;
  there.center_m.setConstant(0.19);
  EXPECT_NEAR(ticksUntilDone(Verb::kPut, there), 200, 1);
  ThingObservation free = away;
  free.handle_n = 0.0;
  EXPECT_NEAR(ticksUntilDone(Verb::kLetGo, free), 200, 1);
}

TEST(TaskSteps, TremblingGrip_CountsAndAnOpenedGripStartsAgain) {
  KitchenTask task;
  task.things.emplace_back();
  task.steps = {stepOf(Verb::kTake)};
  for (const double low_n : {0.5, 0.1}) {
    TaskSteps steps(task);
    bool done = false;
    for (int k = 0; k < 1000 && !done; ++k) {
      ThingObservation seen;
      seen.squeeze_n = k / 100 % 2 == 0 ? 1.5 : low_n;
      done = steps.tick(seen, kTick_s);
    }
    EXPECT_EQ(done, low_n > 0.25) << low_n;
  }
}

TEST(TaskSteps, Score_IsFullWithinParAndFallsToZeroAtThreeTimesPar) {
  KitchenTask task;
  task.things.emplace_back();
  task.steps = {stepOf(Verb::kReach), stepOf(Verb::kReach)};
  task.par_s = 1.0;
  ThingObservation far, near;
  far.palm_m = 1.0;
  TaskSteps steps(task);
  (void)steps.tick(near, kTick_s);
  EXPECT_DOUBLE_EQ(steps.score(), 50.0);
  for (int k = 0; k < 1999; ++k) (void)steps.tick(far, kTick_s);
  (void)steps.tick(near, kTick_s);
  EXPECT_TRUE(steps.done());
  EXPECT_NEAR(steps.score(), 75.0, 1e-6);  // twice par: half the score of one of the two steps
}

/// A task with an object on a joint whose grip is at the origin.
KitchenTask taskOf(SceneJoint::Type type, const Eigen::Vector3d& axis,
                   const Eigen::Vector3d& point_m, const std::vector<Verb>& verbs) {
  KitchenTask task;
  kitchen::Thing& thing = task.things.emplace_back();
  thing.grip_m = thing.com_m = Eigen::Vector3d::Zero();
  thing.radius_m = 0.02;
  thing.joint.type = type, thing.joint.axis = axis, thing.joint.point_m = point_m;
  thing.jointed = true;
  for (const Verb verb : verbs) task.steps.push_back(stepOf(verb));
  return task;
}

TEST(Meeting, VerbsAndJoint_DetermineTheMeans) {
  using Eigen::Vector3d;
  constexpr auto kHinge = SceneJoint::Type::kHinge, kSlide = SceneJoint::Type::kSlide;
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  struct Case {
    const char* what;
    KitchenTask task;
    Means means;
    Vector3d toward;
  };
  const Case cases[] = {
      {"a drawer that is taken",
       taskOf(kSlide, -x, z, {Verb::kReach, Verb::kTake, Verb::kMove}),
       Means::kGrasp,
       {}},
      {"a drawer that is pulled", taskOf(kSlide, -x, z, {Verb::kMove}), Means::kGrasp, {}},
      {"a button", taskOf(kSlide, x, z, {Verb::kReach, Verb::kPress}), Means::kPush, x},
      {"a lid, its hinge behind", taskOf(kHinge, y, 0.1 * x, {Verb::kMove}), Means::kPush, z},
      {"a shutter to the left", taskOf(kSlide, y, z, {Verb::kMove}), Means::kPush, y},
      {"a lever towards a right palm", taskOf(kSlide, -y, z, {Verb::kPress}), Means::kSqueeze, -y},
      {"a rocker", taskOf(kHinge, -z, 0.006 * x, {Verb::kMove}), Means::kPush, x},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.what);
    const kitchen::Meeting meeting = meetingOf(c.task, 0, 0.0, Vector3d::Zero(), 1.0);
    EXPECT_EQ(static_cast<int>(meeting.means), static_cast<int>(c.means));
    if (c.means != Means::kGrasp) EXPECT_EQ(meeting.toward, c.toward);
  }
  // A rocker is pushed on the half that turns it: by x at p about axis -z, -(p x e_x)·z = p_y.
  const KitchenTask rocker = taskOf(kHinge, -z, 0.006 * x, {Verb::kMove});
  const Vector3d on_m = meetingOf(rocker, 0, 0.0, Vector3d::Zero(), 1.0).side_m,
                 off_m = meetingOf(rocker, 0, 0.2, Vector3d::Zero(), 1.0).side_m;
  EXPECT_NEAR(on_m.y(), 0.02, 1e-15);
  EXPECT_LT(off_m.y(), -0.019);
  // The palm of a left hand faces the other way.
  const KitchenTask lever = taskOf(kSlide, -y, z, {Verb::kPress});
  EXPECT_EQ(meetingOf(lever, 0, 0.0, Vector3d::Zero(), -1.0).means, Means::kPush);
}

// A hand must never be trapped: an open object returns only when the palm is 6 cm away and no part
// of the hand touches it.
TEST(Kitchen, OpenObject_ReturnsOnlyWhenTheHandIsClear) {
  const auto loaded =
      orThrow(loadExercise(config("exercises/drawer.toml"), 1, shippedDevice(), shippedHand()));
  const ExerciseDescription& about = loaded.exercise->description();
  std::array<double, kMaxLiveParameters> parameters{};
  for (std::size_t i = 0; i < about.parameters.size(); ++i) {
    parameters[i] = about.parameters[i].value;
  }
  TickRecord seen;
  ExerciseRecord out;
  BodyPlacements placements;
  const auto placed = [&](double palm_m, int contacts) {
    seen.palm_target_distance_m = palm_m;
    seen.contact_count = contacts;
    seen.contacts[0].body = 0;
    ExerciseInput input;
    input.observed = &seen;
    input.parameters = parameters.data();
    input.period_s = kTick_s;
    loaded.exercise->tick(input, out, placements);
    return placements.count;
  };
  EXPECT_EQ(placed(0.03, 0), 0);
  EXPECT_EQ(placed(-0.03, 0), 0) << "the back of the hand is as near";
  EXPECT_EQ(placed(0.10, 1), 0) << "a fingertip is inside";
  EXPECT_EQ(placed(0.10, 0), 1);
  EXPECT_EQ(placed(0.10, 0), 0) << "once";
}

TEST(Kitchen, HandThatStartsInsideAnObject_IsRefusedWithItsName) {
  Models models = load(exerciseFiles("drawer"));
  models.scene.bodies[0].pose.translation_m.setZero();
  std::unique_ptr<Player> player = makeExercisePlayer(models, 1);
  const auto rig = buildRig(std::move(models), std::move(player), RigOptions{});
  const auto armed = rig.ok() ? (*rig)->renderer->arm() : Expected<Done>(rig.errors());
  ASSERT_FALSE(armed.ok());
  EXPECT_TRUE(contains(format(armed.errors()), "drawer")) << format(armed.errors());
}

// This includes a device that hardly draws back, with the largest hand.
TEST(Kitchen, HandOnAnyDevice_StartsClearOfEveryTask) {
  const std::string hand = seed() % 2 == 0 ? "man-p95-right" : "man-p95-left";
  for (const std::string device : {"lambda-pride", "desktop-3axis", "wrist-9axis"}) {
    for (const std::string task : {"drawer", "cupboard-door", "light-switch", "coffee-mill",
                                   "flip-top-lid", "press-lever"}) {
      SCOPED_TRACE(task + " on " + device);
      Models models = load(exerciseFiles(task, 1, hand, device));
      std::unique_ptr<Player> player = makeExercisePlayer(models, 1);
      const auto rig = orThrow(buildRig(std::move(models), std::move(player), RigOptions{}));
      const auto armed = rig->renderer->arm();
      EXPECT_TRUE(armed.ok()) << format(armed.errors());
    }
  }
}

struct Played {
  double score = 0.0, done = 0.0, time_s = 0.0, deepest_m = 0.0, error_m = 0.0;
  int faults = 0;
};

Played play(const ModelFiles& files, std::uint64_t seed_of_player, int ticks = 25'000) {
  Models models = load(files);
  std::unique_ptr<Player> player = makeExercisePlayer(models, seed_of_player);
  const auto rig = orThrow(buildRig(std::move(models), std::move(player), RigOptions{}));
  const SceneBody& body = rig->models.scene.bodies[0];
  EXPECT_TRUE(rig->renderer->arm());
  Played out;
  runTicks(*rig->renderer, ticks, [&](const TickRecord& r) {
    rig->listener->afterTick(r);
    if (any(r.faults & kStoppingFaults)) ++out.faults;
    for (int i = 0; i < r.contact_count; ++i) {
      out.deepest_m = std::max(out.deepest_m, -r.contacts[i].distance_m);
    }
    const ExerciseRecord& e = r.exercise;
    if (e.value_count != kitchen::kValues) return;
    out.score = e.values[kitchen::kScore], out.done = e.values[kitchen::kDone];
    out.time_s = e.values[kitchen::kTime];
    if (!body.joint) return;
    const Pose on_path = poseOn(*body.joint, body.pose, e.values[kitchen::kJoint]);
    const Eigen::Vector3d center_m = on_path * body.com_m;
    out.error_m = std::max(out.error_m, (center_m - r.bodies[0].position_m.eigen()).norm());
  });
  return out;
}

/// A shipped task. Patients with weak fingers play only tasks that need no grip.
struct ShippedTask {
  std::string name;
  bool grips = true;
  int plays = 0, done = 0;
};

TEST(Kitchen, ShippedTasks_AreCompletedByEveryKindOfPatientAndHand) {
  std::mt19937_64 random(seed());
  ShippedTask tasks[] = {{"drawer"},      {"cupboard-door"},       {"light-switch", false},
                         {"coffee-mill"}, {"flip-top-lid", false}, {"press-lever"}};
  const std::vector<std::string> hands{"adult-median-right", "adult-median-left", "woman-p05-right",
                                       "man-p95-left"},
      patients{"relaxed-adult", "spastic", "tremor", "spastic-fist", "weak"};
  double deepest_m = 0.0, longest_s = 0.0, error_m = 0.0;
  const int plays = fullCounts() ? 600 : cases(40) / 4 + 1;
  for (int k = 0; k < plays; ++k) {
    ShippedTask& task = tasks[(seed() + k) % std::size(tasks)];
    const std::string hand = hands[random() % hands.size()],
                      patient = patients[random() % (patients.size() - (task.grips ? 1 : 0))];
    const int level = 1 + static_cast<int>(random() % 3);
    const std::uint64_t of_player = random() % 100;
    const std::string who = task.name + ", level " + std::to_string(level) + ", " + hand + ", " +
                            patient + ", player " + std::to_string(of_player);
    SCOPED_TRACE(who);
    ModelFiles files = exerciseFiles(task.name, level, hand);
    files.patient = config("patients/") + patient + ".toml";
    const Played played = play(files, of_player);
    EXPECT_EQ(played.faults, 0);
    const bool done = played.done > 0.5;
    if (!done) std::printf("not done: %s\n", who.c_str());
    if (done) EXPECT_GT(played.score, 90.0);
    ++task.plays;
    task.done += done ? 1 : 0;
    deepest_m = std::max(deepest_m, played.deepest_m);
    if (done) longest_s = std::max(longest_s, played.time_s);
    error_m = std::max(error_m, played.error_m);
  }
  for (const ShippedTask& task : tasks) {
    SCOPED_TRACE(task.name);
    figure("kitchen, plays of " + task.name + " done of " + std::to_string(task.plays), task.done,
           "");
    EXPECT_GE(task.done, task.plays - task.plays / 20);  // 95 of 100
  }
  figure("kitchen, longest play", longest_s, "s");
  figure("kitchen, deepest overlap of hand and thing", 1e3 * deepest_m, "mm");
  figure("kitchen, error of a joint", error_m, "m");
  EXPECT_LE(deepest_m, 0.5e-3);
  EXPECT_LE(error_m, 1e-12);  // rounding of quaternions; the pose is computed from q
}

// A body without joint is taken and put aside, or pushed away by the fingertips, to the place in
// the file. No code is written for this task.
TEST(Kitchen, ObjectWithoutJoint_IsPutWhereTheFileSays) {
  const std::string scene = R"(
kind = "scene"
version = 1
name = "Beaker"
gravity_m_s2 = [0.0, 0.0, -9.81]
[[bodies]]
name = "beaker"
shape = "cylinder"
radius_m = 0.0275
height_m = 0.12
mass_kg = 0.15
position_m = [0.12, 0.03, 0.0]
[[bodies]]
name = "table"
shape = "box"
size_m = [0.4, 0.6, 0.04]
fixed = true
position_m = [0.2, 0.0, -0.08]
)",
                    head = R"(
kind = "exercise"
version = 1
exercise = "kitchen"
name = "beaker"
scene = "../scenes/beaker.toml"
[[things]]
body = "beaker"
grip_m = [0.0, 0.0, 0.0]
radius_m = 0.0275
)",
                    take = R"(
[[steps]]
verb = "take"
thing = "beaker"
force_n = 1.0
)",
                    tail = R"(
size_m = [0.02, 0.02, 0.02]
[[steps]]
verb = "let_go"
thing = "beaker"
[panel]
title = { en = "a", fr = "a", de = "a" }
lead = { en = "a", fr = "a", de = "a" }
)";
  const std::string put = "[[steps]]\nverb = \"put\"\nthing = \"beaker\"\ncenter_m = ";
  const Folder folder;
  folder.write("scenes/beaker.toml", scene);
  for (const std::string& steps : {take + put + "[0.05, 0.06, 0.0]", put + "[0.17, 0.03, 0.0]"}) {
    SCOPED_TRACE(steps);
    ModelFiles files = exerciseFiles("drawer");
    files.exercise = folder.write("exercises/beaker.toml", head + steps + tail);
    const Played played = play(files, 2, 12'000);
    EXPECT_EQ(played.faults, 0);
    EXPECT_EQ(played.done, 1.0);
    EXPECT_LE(played.deepest_m, 0.5e-3);
  }
}

TEST(Kitchen, UnknownLevel_IsRefusedWithThoseThatAre) {
  const std::string drawer = config("exercises/drawer.toml");
  EXPECT_TRUE(loadExercise(drawer, 3, shippedDevice(), shippedHand()).ok());
  EXPECT_TRUE(
      test::refusedWith(loadExercise(drawer, 4, shippedDevice(), shippedHand()), "ask for 1 .. 3"));
}

TEST(Mirror, MirroringASceneTwice_RestoresTheScene) {
  const auto loaded = orThrow(
      loadExercise(config("exercises/cupboard-door.toml"), 1, shippedDevice(), shippedHand()));
  SceneModel twice = loaded.scene;
  mirror(twice);
  const SceneBody &once = twice.bodies[0], &before = loaded.scene.bodies[0];
  // Opened by the same q, the handle is at the mirrored place.
  const Eigen::Vector3d right = poseOn(*before.joint, before.pose, 0.8) * Eigen::Vector3d::Zero(),
                        left = poseOn(*once.joint, once.pose, 0.8) * Eigen::Vector3d::Zero();
  EXPECT_LE((left - Eigen::Vector3d(right.x(), -right.y(), right.z())).norm(), 1e-15);
  mirror(twice);
  EXPECT_EQ(twice.bodies[0].joint->axis, before.joint->axis);
  EXPECT_EQ(twice.bodies[0].pose.rotation, before.pose.rotation);
}

}  // namespace
}  // namespace wholehand::test
