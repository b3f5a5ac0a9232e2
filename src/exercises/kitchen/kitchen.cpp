#include "exercises/kitchen/kitchen_player.hpp"
#include "exercises/kitchen/kitchen_task.hpp"
#include "exercises/load_exercise.hpp"
#include "exercises/player_reach.hpp"
#include "loop/core/printable.hpp"
#include "loop/exercise/grip.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

/// Tasks of daily life. A file lists steps at objects of a scene; the objects may move on joints.
namespace wholehand::kitchen {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

enum Event : std::int32_t { kStepDone, kLevelDone, kRestarted };
enum Parameter : std::int32_t { kForceRatio };

/// Things return to their places when the palm is farther than this from all of them and the hand
/// touches none.
constexpr double kClear_m = 0.06;
constexpr double kTouches_n = 0.1;  // a larger force of the hand is a touch
/// Places of the hand along a way: a crank's radius of 40 mm changes by 0.1 mm between two.
constexpr double kSamplesARad = 20.0;
/// A hand that squeezes a thing comes from behind it and beside it.
constexpr double kBehind_m = 0.065, kLane_m = 0.05;
static_assert(kMaxPlacements >= kMostThings);

Json numbers(const Vector3d& v) {
  return Json::array({v.x(), v.y(), v.z()});
}

/// Describes how the hand meets the thing of a step, with the thing's joint where the previous
/// steps left it.
Json metJson(const KitchenTask& task, const KitchenPlayer& player, int now) {
  const Step& step = task.steps[now];
  const Thing& thing = task.things[step.thing];
  double q = 0.0;
  for (int i = 0; i < now; ++i) {
    const Step& before = task.steps[i];
    const bool moves = before.verb == Verb::kMove || before.verb == Verb::kHold;
    if (moves && before.thing == step.thing) q = before.to;
  }
  const auto met = player.metAt(now, q, thing.start * thing.com_m);
  return {{"means", kMeans[static_cast<int>(met.meeting.means)]},
          {"toward", numbers(met.meeting.toward)},
          {"side_m", numbers(met.meeting.side_m)},
          {"base_m", numbers(met.base_m)}};
}

Json taskJson(const KitchenTask& task, const KitchenPlayer& player) {
  Json steps = Json::array(), things = Json::array();
  for (int i = 0; i < static_cast<int>(task.steps.size()); ++i) {
    const Step& step = task.steps[i];
    const Thing& thing = task.things[step.thing];
    Json out{{"verb", kVerbs[static_cast<int>(step.verb)]}, {"body", thing.body}};
    if (step.verb == Verb::kMove || step.verb == Verb::kHold) {
      out["to"] = step.to;
      out["tolerance"] = step.tolerance;
    }
    if (step.for_s > 0.0) out["for_s"] = step.for_s;
    if (step.force_n > 0.0) out["force_n"] = step.force_n;
    out["met"] = metJson(task, player, i);
    if (step.verb == Verb::kPut) {
      out["center_m"] = numbers(step.center_m);
      out["half_size_m"] = numbers(step.half_size_m);
    }
    steps.push_back(std::move(out));
  }
  for (const Thing& thing : task.things) {
    Json out{{"body", thing.body}, {"grip_m", numbers(thing.grip_m)}, {"radius_m", thing.radius_m}};
    if (thing.jointed) {
      const SceneJoint& joint = thing.joint;
      const auto end = [](double q) { return std::isfinite(q) ? Json(q) : Json(); };
      out["joint"] = {{"type", joint.isHinge() ? "hinge" : "slide"},
                      {"axis", numbers(thing.start.rotation * joint.axis)},
                      {"point_m", numbers(thing.start * joint.point_m)},
                      {"least", end(joint.least)},
                      {"most", end(joint.most)}};
    }
    things.push_back(std::move(out));
  }
  return {{"kind", "kitchen"}, {"task", task.name}, {"things", things}, {"steps", steps}};
}

class Kitchen final : public Exercise {
 public:
  Kitchen(KitchenTask task, int level, int levels, const DeviceModel& device, const HandModel& hand)
      : task_(std::move(task)),
        device_(device),
        hand_(hand),
        meets_(task_, device_, hand_, {}),
        posture_(hand_),
        steps_(task_) {
    description_.name = task_.name;
    description_.level = level;
    description_.levels = levels;
    description_.parameters = {{"force_ratio", "1", 0.25, 2.0, 1.0, 0.5}};
    description_.value_names.assign(std::begin(kValueNames), std::end(kValueNames));
    description_.event_names = {"step_done", "level_done", "restarted"};
    description_.json = taskJson(task_, meets_).dump();
    Kitchen::reset();
  }

  void reset() override {
    steps_.reset();
    squeeze_n_ = 0.0;
    handle_n_.setZero();
    paused_ = false;
    returns_ = true;
    last_ = ThingObservation{};
    forgetGoal();
  }

  [[nodiscard]] WorldQuery query() const noexcept override {
    WorldQuery query;
    for (const Thing& thing : task_.things) {
      if (returns_ || thing.body == nowThing().body) query.targets.set(thing.body);
    }
    return query;
  }

  void tick(const ExerciseInput& input, ExerciseRecord& out,
            BodyPlacements& placements) noexcept override {
    const TickRecord& seen = *input.observed;
    const double elapsed_s = std::max(seen.elapsed_periods, 1U) * input.period_s;
    clear(out, placements, device_.axisCount());
    posture_.update(input.hand);
    if (takeActions(seen, steps_, paused_, kRestarted, out)) returns_ = true;
    const double ratio = input.parameters[kForceRatio];
    look(seen, ratio, elapsed_s);
    if (returns_) giveBack(seen, placements);
    if (!paused_ && !returns_ && steps_.tick(last_, elapsed_s)) {
      addEvent(out, kStepDone, steps_.step() - 1, steps_.score());
      if (steps_.done()) addEvent(out, kLevelDone, -1, steps_.score());
    }
    sayGoal(seen);
    show(out, ratio);
  }

  [[nodiscard]] std::unique_ptr<Player> makePlayer(const PlayerTraits& traits) const override {
    return std::make_unique<KitchenPlayer>(task_, device_, hand_, traits);
  }

 private:
  [[nodiscard]] const Thing& nowThing() const noexcept { return task_.things[steps_.now().thing]; }

  /// The place where the hand meets the thing is the goal, until it is near it or touches it.
  void sayGoal(const TickRecord& seen) noexcept {
    const bool goes = !steps_.done() && !paused_ && !returns_ &&
                      steps_.now().verb != Verb::kLetGo && last_.palm_m > kClear_m &&
                      handle_n_.norm() < kTouches_n;
    if (!goes) return goFor(-1, {});
    const Thing& thing = nowThing();
    const auto met = meets_.metAt(steps_.step(), last_.q, last_.center_m);
    const Vector3d met_m = worldPoint(seen.bodies[thing.body], thing.grip_m + met.meeting.side_m);
    goFor(steps_.step(), met_m + met.base_m);
  }

  /// Updates what the tick shows of the current step's thing. Forces are low-passed. They are
  /// divided by `ratio`, the therapist's factor on the required force.
  void look(const TickRecord& seen, double ratio, double elapsed_s) noexcept {
    const Thing& thing = nowThing();
    const double share = 1.0 - std::exp(-2.0 * std::numbers::pi * task_.filter_hz * elapsed_s);
    Vector3d force_n = Vector3d::Zero();
    for (int i = 0; i < seen.contact_count; ++i) {
      if (seen.contacts[i].body == thing.body) force_n += seen.contacts[i].force_n.eigen();
    }
    handle_n_ += share * (force_n - handle_n_);
    squeeze_n_ += share * (gripForce_n(seen, thing.body, posture_) - squeeze_n_);
    // The palm does not face a thing that it pushes, so the distance counts on either side of the
    // palm.
    last_.palm_m = seen.palm_body == thing.body ? std::abs(seen.palm_target_distance_m)
                                                : std::numeric_limits<double>::infinity();
    last_.squeeze_n = squeeze_n_ / ratio;
    last_.handle_n = handle_n_.norm() / ratio;
    last_.center_m = seen.bodies[thing.body].position_m.eigen();
    countTurns(seen);
    last_.q = q_[steps_.now().thing];
  }

  /// Updates q of every thing and counts whole turns of hinges. While things return, q is the value
  /// nearest to 0.
  void countTurns(const TickRecord& seen) noexcept {
    for (std::size_t i = 0; i < task_.things.size(); ++i) {
      const Thing& thing = task_.things[i];
      if (!thing.jointed) continue;
      q_[i] = returns_ ? positionOn(thing.joint, thing.start, poseOf(thing, seen))
                       : positionOn(thing.joint, thing.start, poseOf(thing, seen), q_[i]);
    }
  }

  /// Pose of a thing's body frame.
  [[nodiscard]] static Pose poseOf(const Thing& thing, const TickRecord& seen) noexcept {
    const BodyState& body = seen.bodies[thing.body];
    const Eigen::Matrix3d turned = body.orientation_xyzw.eigen().toRotationMatrix();
    return {turned, body.position_m.eigen() - turned * thing.com_m};
  }

  /// Puts all things back to their start poses when the hand is clear of them.
  void giveBack(const TickRecord& seen, BodyPlacements& placements) noexcept {
    const auto of_a_thing = [this](const Contact& c) {
      return std::any_of(task_.things.begin(), task_.things.end(),
                         [&c](const Thing& thing) { return thing.body == c.body; });
    };
    const auto* contacts = std::begin(seen.contacts);
    if (std::abs(seen.palm_target_distance_m) <= kClear_m ||
        std::any_of(contacts, contacts + seen.contact_count, of_a_thing)) {
      return;
    }
    returns_ = false;
    for (const Thing& thing : task_.things) {
      const Eigen::Quaterniond turned(thing.start.rotation);
      placements.items[placements.count++] = {thing.body,
                                              0,
                                              Vec3::from(Vector3d(thing.start * thing.com_m)),
                                              QuatXyzw::from(turned),
                                              {}};
    }
  }

  void show(ExerciseRecord& out, double ratio) const noexcept {
    const Step& step = steps_.now();
    const bool moves = !steps_.done() && (step.verb == Verb::kMove || step.verb == Verb::kHold);
    out.values[kInstruction] = steps_.step();
    out.values[kScore] = steps_.score();
    out.values[kDone] = steps_.done() ? 1.0 : 0.0;
    out.values[kStep] = steps_.step();
    out.values[kSteps] = static_cast<double>(task_.steps.size());
    out.values[kJoint] = last_.q;
    out.values[kGoalLow] = moves ? step.to - step.tolerance : 0.0;
    out.values[kGoalHigh] = moves ? step.to + step.tolerance : 0.0;
    out.values[kHandle] = last_.handle_n * ratio;
    out.values[kSqueeze] = last_.squeeze_n * ratio;
    out.values[kHeld] = step.for_s > 0.0 ? std::min(steps_.held_s(), step.for_s) : 0.0;
    out.values[kTime] = steps_.time_s();
    out.values[kPaused] = paused_ ? 1.0 : 0.0;
    out.value_count = kValues;
  }

  const KitchenTask task_;
  const DeviceModel device_;  ///< device and hand are inputs of makePlayer()
  const HandModel hand_;
  const KitchenPlayer meets_;  ///< knows how the hand meets the things
  HandPosture posture_;
  TaskSteps steps_;
  ThingObservation last_;
  std::array<double, kMostThings> q_{};  ///< joint position of every thing
  Vector3d handle_n_ = Vector3d::Zero();
  double squeeze_n_ = 0.0;
  bool paused_ = false;
  bool returns_ = true;  ///< things must return to their start poses
};

/// Adds all positions at which the hand meets the things, along the way of each step.
void addNeeds(const KitchenTask& task, const PlayerReach& reach, const HandModel& hand,
              const KitchenPlayer& player, TaskNeeds& needs) {
  std::vector<double> q(task.things.size(), 0.0);
  for (int i = 0; i < static_cast<int>(task.steps.size()); ++i) {
    const Step& step = task.steps[i];
    if (step.verb == Verb::kLetGo) continue;
    const Thing& thing = task.things[step.thing];
    if (step.verb == Verb::kTake) needs.addGrasp(reach, hand, thing.radius_m);
    const double from = q[step.thing];
    const bool moves = step.verb == Verb::kMove || step.verb == Verb::kHold;
    if (moves) q[step.thing] = step.to;
    const int samples = 1 + static_cast<int>(kSamplesARad * std::abs(q[step.thing] - from));
    for (int k = 0; k <= samples; ++k) {
      const double at = from + (q[step.thing] - from) * k / samples;
      const Pose pose = thing.jointed ? poseOn(thing.joint, thing.start, at) : thing.start;
      const auto met = player.metAt(i, at, pose * thing.com_m);
      const Vector3d base_m = pose * (thing.grip_m + thing.com_m + met.meeting.side_m) + met.base_m;
      needs.addBase(reach, base_m);
      if (met.meeting.means != Means::kSqueeze || k > 0) continue;
      needs.add(reach.x, base_m.x() - kBehind_m);
      needs.add(reach.y, base_m.y() - reach.beside * kLane_m);
    }
    if (step.verb == Verb::kPut) {
      const auto met = player.metAt(i, 0.0, step.center_m);
      needs.addBase(reach, step.center_m + thing.grip_m + met.base_m);
    }
  }
}

constexpr const char* kBaseAxes[] = {"x", "y", "z"};
/// Half of the space that a finger needs behind a bar.
constexpr double kFinger_m = 0.009;

Vector3d vectorFrom(const std::vector<double>& v) {
  return {v[0], v[1], v[2]};
}

/// Reads the file and checks it against the scene. Positions are for a right hand and are mirrored
/// for a left one.
class TaskReader {
 public:
  TaskReader(TomlTable& root, SceneModel& scene, const ExerciseSource& source)
      : root_(root), scene_(scene), source_(source), mirrored_(source.hand->side == Side::kLeft) {}

  void read(KitchenTask& task, int level, int& levels) {
    task.par_s = root_.number("par_s", between(1.0, 600.0, "s"), task.par_s);
    task.filter_hz = root_.number("filter_hz", above(0.0, 100.0, "Hz"), task.filter_hz);
    std::vector<TomlTable> things = root_.tables("things", 1);
    if (things.size() > kMostThings) {
      root_.fail("things", fmt::format("there are {}", things.size()),
                 fmt::format("a task has {} at most", kMostThings));
    }
    if (mirrored_) mirror(scene_);
    for (TomlTable& table : things) readThing(table, task);
    for (TomlTable& table : root_.tables("steps", 1)) readStep(table, task);
    readLevels(task, level, levels);
    for (std::size_t i = 0; i < things.size(); ++i) {
      const Thing& thing = task.things[i];
      if (thing.body < 0 || thing.body >= static_cast<int>(scene_.bodies.size())) continue;
      const auto is_taken = [i](const Step& step) {
        return step.verb == Verb::kTake && step.thing == static_cast<int>(i);
      };
      if (std::any_of(task.steps.begin(), task.steps.end(), is_taken)) checkRoom(things[i], thing);
      if (thing.jointed) checkResistance(things[i], thing);
    }
  }

 private:
  /// Reports a grip without enough room for the fingers behind it.
  void checkRoom(TomlTable& t, const Thing& thing) {
    const Vector3d grip_m = thing.start * (thing.grip_m + thing.com_m);
    const Vector3d behind_m = grip_m + (thing.radius_m + kFinger_m) * Vector3d::UnitX();
    for (const SceneBody& body : scene_.bodies) {
      const Pose to_body = body.pose.inverse();
      for (const Shape& shape : body.shapes) {
        if (signedDistance(shape, to_body * grip_m) < 0.0 &&
            signedDistance(shape, to_body * behind_m) > 0.0) {
          continue;  // the shape that the hand closes around
        }
        if (signedDistance(shape, to_body * behind_m) >= kFinger_m) continue;
        t.fail("grip_m", "is buried: fingers meet \"" + printable(body.name) + "\" behind it",
               fmt::format(
                   "leave {:.0f} mm free behind its radius of {:.0f} mm; 50 mm are comfortable",
                   2e3 * kFinger_m, 1e3 * thing.radius_m));
        return;
      }
    }
  }

  /// Warns of a joint that resists more at the grip than the device can push.
  void checkResistance(TomlTable& t, const Thing& thing) {
    const SceneJoint& joint = thing.joint;
    const Vector3d axis = thing.start.rotation * joint.axis;
    Vector3d way = axis;
    if (joint.isHinge()) {
      way = axis.cross(thing.start.rotation * (thing.grip_m + thing.com_m - joint.point_m));
      if (way.norm() < thing.radius_m) way = thing.radius_m * Vector3d::UnitX();  // a rocker
    }
    const double latch = 0.5 * joint.latch_energy_j * joint.latch_wave;
    const double resists_n = (joint.dry_friction + latch) / way.norm();
    double pushes_n = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
      const int device_axis = source_.device->axisIndex(kBaseAxes[k]);
      const double share = std::abs(way.normalized()[k]);
      if (device_axis < 0 || share < 1e-3) continue;
      pushes_n = std::min(pushes_n, source_.device->axes[device_axis].effort_limit / share);
    }
    if (resists_n <= pushes_n) return;
    scene_.notices.push_back(
        {source_.path, t.lineOf("body"), "things.body", printable(scene_.bodies[thing.body].name),
         fmt::format(
             "its {} resists with {:.3g} N where the hand takes it; this device pushes with "
             "{:.3g} N there at most: nobody can move it",
             joint.isHinge() ? "hinge" : "slide", resists_n, pushes_n),
         fmt::format("lower {} of its joint in the scene, or friction_ratio of the level",
                     joint.isHinge() ? "friction_nm" : "friction_n")});
  }

  Vector3d place(TomlTable& t, const char* key) {
    Vector3d v = vectorFrom(t.numbers(key, 3, between(-10.0, 10.0, "m")));
    if (mirrored_) v.y() *= -1.0;
    return v;
  }

  /// A place in the world.
  Vector3d placeInScene(TomlTable& t, const char* key) { return place(t, key) + source_.moved_m; }

  /// True for a body whose joint is moved by, or moves, that of another one.
  [[nodiscard]] bool movesOthers(int body) const {
    for (const std::vector<int>& chain : jointChains(scene_.bodies)) {
      if (std::find(chain.begin(), chain.end(), body) != chain.end()) return true;
    }
    return false;
  }

  void readThing(TomlTable& t, KitchenTask& task) {
    Thing thing;
    names_.push_back(t.text("body"));
    thing.body = scene_.bodyIndex(names_.back());
    thing.radius_m = t.number("radius_m", between(0.002, 0.06, "m"));
    const Vector3d grip_m = place(t, "grip_m");
    if (thing.body < 0 || thing.body >= kMaxBodies) {
      t.fail("body", "the scene " + printable(scene_.path) + " has no such body",
             "write the name of one of its first 128");
    } else if (scene_.bodies[thing.body].fixed) {
      t.fail("body", "is fixed in the scene " + printable(scene_.path),
             "give it a joint or a mass there");
    } else if (movesOthers(thing.body)) {
      t.fail("body", "moves together with other bodies of its object",
             "name a body whose joint stands alone");
    } else {
      const SceneBody& body = scene_.bodies[thing.body];
      thing.com_m = body.com_m;
      thing.grip_m = grip_m - body.com_m;
      thing.start = body.pose;
      thing.jointed = body.joint.has_value();
      if (body.joint) thing.joint = *body.joint;
    }
    task.things.push_back(thing);
  }

  void readStep(TomlTable& t, KitchenTask& task) {
    Step step;
    const std::vector<std::string> verbs(std::begin(kVerbs), std::end(kVerbs));
    const std::string verb = t.choice("verb", verbs);
    step.verb = static_cast<Verb>(std::find(verbs.begin(), verbs.end(), verb) - verbs.begin());
    const std::string named = t.text("thing");
    const auto at = std::find(names_.begin(), names_.end(), named);
    const bool known = at != names_.end();
    step.thing = known ? static_cast<int>(at - names_.begin()) : 0;
    if (!known && t.isGood("thing")) {
      t.fail("thing", "is not among [[things]]", "write one of them, or add it there");
    }
    if (t.isGood("verb")) readAims(t, step, known ? &task.things[step.thing] : nullptr);
    task.steps.push_back(step);
  }

  void readAims(TomlTable& t, Step& step, const Thing* thing) {
    switch (step.verb) {
      case Verb::kReach:
        step.within_m = t.number("within_m", between(0.005, 0.5, "m"));
        break;
      case Verb::kTake:
        step.force_n = t.number("force_n", above(0.0, 40.0, "N"));
        break;
      case Verb::kPress:
        step.force_n = t.number("force_n", above(0.0, 40.0, "N"));
        step.for_s = t.number("for_s", between(0.05, 60.0, "s"));
        break;
      case Verb::kMove:
      case Verb::kHold:
        readGoal(t, step, thing);
        break;
      case Verb::kPut:
        step.center_m = placeInScene(t, "center_m");
        step.half_size_m = 0.5 * vectorFrom(t.numbers("size_m", 3, between(0.005, 2.0, "m")));
        break;
      case Verb::kLetGo:
        break;
    }
  }

  static void readGoal(TomlTable& t, Step& step, const Thing* thing) {
    const bool hinge = thing != nullptr && thing->jointed && thing->joint.isHinge();
    if (thing != nullptr && !thing->jointed) {
      t.fail("thing", "has no joint in the scene", "give its body a joint there, or use put");
      t.ignoreUnknownKeys();
      return;
    }
    const char* to = hinge ? "to_rad" : "to_m";
    const char* tolerance = hinge ? "tolerance_rad" : "tolerance_m";
    step.to = t.number(to, hinge ? between(-70.0, 70.0, "rad") : between(-2.0, 2.0, "m"));
    step.tolerance = t.number(tolerance, above(0.0, 1.0, hinge ? "rad" : "m"));
    if (step.verb == Verb::kHold) step.for_s = t.number("for_s", between(0.05, 60.0, "s"));
    if (thing == nullptr || !t.isGood(to) || !t.isGood(tolerance)) return;
    if (step.to + step.tolerance < thing->joint.least ||
        step.to - step.tolerance > thing->joint.most) {
      t.fail(to, "is beyond the joint's range",
             fmt::format("must be within {:.3g} of {:.3g} .. {:.3g}", step.tolerance,
                         thing->joint.least, thing->joint.most));
    }
  }

  /// Reads the levels. A level scales the joints' friction and the required forces.
  void readLevels(KitchenTask& task, int level, int& levels) {
    std::vector<TomlTable> tables = root_.tables("levels", 0);
    levels = std::max<int>(1, static_cast<int>(tables.size()));
    if (level < 1 || level > levels) {
      root_.fail(tables.empty() ? "exercise" : "levels", fmt::format("has no level {}", level),
                 fmt::format("ask for 1 .. {}", levels));
    }
    for (int i = 0; i < static_cast<int>(tables.size()); ++i) {
      const double friction = tables[i].number("friction_ratio", between(0.0, 20.0), 1.0);
      const double force = tables[i].number("force_ratio", between(0.1, 10.0), 1.0);
      if (i + 1 != level) continue;
      for (Step& step : task.steps) step.force_n *= force;
      for (Thing& thing : task.things) {
        if (!thing.jointed) continue;
        thing.joint.dry_friction *= friction;
        scene_.bodies[thing.body].joint->dry_friction = thing.joint.dry_friction;
      }
    }
  }

  TomlTable& root_;
  SceneModel& scene_;
  const ExerciseSource& source_;
  bool mirrored_;
  std::vector<std::string> names_;
};

}  // namespace

Expected<LoadedExercise> load(TomlFile& file, const ExerciseSource& source) {
  KitchenTask task;
  task.name = source.name;
  int levels = 1;
  if (source.scene != nullptr) {
    TaskReader(file.root(), *source.scene, source).read(task, source.level, levels);
  } else {
    file.root().ignoreUnknownKeys();
  }
  const Diagnostics faults = file.finish();
  if (!faults.empty() || source.scene == nullptr) return faults;
  LoadedExercise out;
  addNeeds(task, playerReach(*source.device, source.hand, 0.0), *source.hand,
           KitchenPlayer(task, *source.device, *source.hand, {}), out.needs);
  out.exercise = std::make_unique<Kitchen>(std::move(task), source.level, levels, *source.device,
                                           *source.hand);
  return out;
}

}  // namespace wholehand::kitchen
