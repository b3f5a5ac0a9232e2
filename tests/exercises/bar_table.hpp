#pragma once

#include "exercises/load_exercise.hpp"
#include "files/shipped_models.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/dynamics/articulated_body.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace wholehand::test {

inline std::string config(const std::string& name) {
  return std::string(WHOLEHAND_SOURCE_DIR) + "/config/" + name;
}

inline constexpr double kTick_s = 1e-3;

/// Values of "stage".
inline constexpr double kReach = 0, kSqueeze = 1, kPouring = 2, kLetGo = 3, kDrinkDone = 4,
                        kLevelDone = 5, kDrawBack = 6, kBreathe = 7;

inline const std::string kFree = config("exercises/cocktail-bar-free.toml");

inline const DeviceModel& shippedDevice() {
  static const DeviceModel device = deviceNamed();
  return device;
}

inline const HandModel& shippedHand() {
  static const HandModel hand = handNamed();
  return hand;
}

/// θ = θ₀ + G q_s.
inline JointPosition postureOf(const HandModel& hand, const AxisPosition& q_s) {
  JointPosition theta = hand.theta0;
  for (int j = 0; j < hand.joint_count; ++j) {
    for (int a = 0; a < hand.axis_count; ++a) theta[j] += hand.synergy(j, a) * q_s[a];
  }
  return theta;
}

/// A bar without physics: the exercise places the bodies, the test sets the hand.
class BarTable {
 public:
  struct Reported {
    std::uint64_t tick;
    std::string event;
    int index;
    double value;
  };

  explicit BarTable(int level, const std::string& file = config("exercises/cocktail-bar.toml")) {
    Expected<LoadedExercise> loaded = loadExercise(file, level, shippedDevice(), shippedHand());
    if (!loaded) {
      ADD_FAILURE() << format(loaded.errors());
      std::abort();
    }
    exercise = std::move(loaded->exercise);
    scene = std::move(loaded->scene);
    for (const LiveParameter& p : exercise->description().parameters) {
      parameters.push_back(p.value);
    }
    const int n = shippedDevice().axisCount();
    record.q_m = record.q_s = record.closure = AxisPosition(n);
    record.qd_mf = AxisVelocity(n);
    for (int i = 0; i < n; ++i) record.closure[i] = std::numeric_limits<double>::quiet_NaN();
    record.body_count = static_cast<int>(scene.bodies.size());
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
      record.bodies[i].position_m = Vec3::from(scene.bodies[i].pose.translation_m);
    }
    if (file == kFree) stiffness_n_m = 100.0;
    exercise->reset();
    drawBack();
  }

  [[nodiscard]] BodyState& glass() { return record.bodies[scene.bodyIndex("glass")]; }

  /// Moves the hand back in front of everything, with half bent fingers that touch nothing.
  void drawBack() {
    record.q_s[0] = record.q_m[0] = -0.08;
    record.q_s[3] = 1.1;
    fingers_face_palm = presses = false;
    record.closure[3] = std::numeric_limits<double>::quiet_NaN();
    palm(0, 0.15);
    squeeze(-1, 0.0);
  }
  /// Moves the palm to a dispenser, given by its index in the level.
  void palm(int dispenser, double distance_m) {
    record.palm_body = bodyOf(dispenser);
    record.palm_target_distance_m = distance_m;
  }
  /// The palm holds a dispenser and squeezes it with four contacts that give `felt_n` at the
  /// fingertips. The digits press its cushion with the same force as far as it yields.
  void hold(int dispenser, double felt_n) {
    record.q_s[0] = record.q_m[0] = 0.07;
    record.q_s[3] = 0.0;
    fingers_face_palm = true;
    presses = true;
    palm(dispenser, 0.002);
    squeeze(dispenser, felt_n);
  }
  /// Presses a dispenser between the middle finger's end and the palm, which faces +y. Two contacts
  /// on the finger hold its axis back by felt_n at the tip, -jᵀf, including friction.
  void squeeze(int dispenser, double felt_n) {
    pressed_n = felt_n;
    record.contact_count = felt_n > 0.0 ? 4 : 0;
    const Vec3 friction{0.3, 0.0, 0.1};
    AxisPosition closed = record.q_s;
    closed[3] = 3.14;
    ArticulatedBody body(shippedHand());
    body.updateKinematics(postureOf(shippedHand(), closed));
    const Capsule& end = shippedHand().capsules[capsuleOf("middle_distal")];
    const Eigen::Vector3d at = body.linkPose(end.link) * Eigen::Vector3d(0.5 * (end.a_m + end.b_m));
    const auto moves = [&](const Eigen::Vector3d& along) {
      std::array<double, kMaxAxes> row{};
      body.reducedPointRow(end.link, at, along, row.data());
      return row[3];
    };
    const double normal_n =
        (0.5 * felt_n * kLever_m + moves(friction.eigen())) / -moves(Eigen::Vector3d::UnitY());
    for (std::size_t i = 0; i < 4; ++i) {
      Contact& c = record.contacts[i];
      const double side = i < 2 ? 1.0 : -1.0;
      c.body = dispenser >= 0 ? bodyOf(dispenser) : -1;
      c.capsule = capsuleOf(i < 2 ? "middle_distal" : "hollow");
      c.point_m = Vec3::from(at);
      c.normal = {0.0, side, 0.0};
      c.force_n = {friction.x, side * normal_n, friction.z};
    }
  }
  [[nodiscard]] static int capsuleOf(const std::string& name) {
    const std::vector<Capsule>& capsules = shippedHand().capsules;
    const auto found = std::find_if(capsules.begin(), capsules.end(),
                                    [&](const Capsule& c) { return c.name == name; });
    return static_cast<int>(found - capsules.begin());
  }
  [[nodiscard]] int bodyOf(int dispenser) const {
    static const char* const kBodies[] = {"dispenser_lemon", "dispenser_cherry",
                                          "dispenser_blueberry", "dispenser_coconut"};
    return scene.bodyIndex(kBodies[dispenser]);
  }

  /// Position of a finger that presses the shell with pressed_n: the shell's compression beyond the
  /// wall, which stands where the liquid has flowed out.
  void press() {
    record.closure[3] = kTouch_rad;
    const bool felt = out.wall_active.size() > 3 && out.wall_active[3];
    const double wall = felt ? out.wall[3] : kTouch_rad;
    record.q_m[3] = pressed_n > 0.0 ? wall + pressed_n / (stiffness_n_m * kLever_m) : kTouch_rad;
  }
  static constexpr double kTouch_rad = 1.1, kLever_m = 0.08;

  void tick() {
    if (presses) press();
    AxisPosition posture = record.q_s;
    if (fingers_face_palm) posture[3] = 3.14;
    record.theta = postureOf(shippedHand(), posture);
    hand.updateKinematics(record.theta);
    const WorldQuery query = exercise->query();
    asked_closure = query.closure_body;
    ExerciseInput input;
    input.observed = &record;
    input.hand = &hand;
    input.parameters = parameters.data();
    input.may_push = may_push;
    exercise->tick(input, out, placements);
    record.command_count = 0;
    for (int i = 0; i < placements.count; ++i) {
      const BodyPlacement& p = placements.items[i];
      BodyState& body = record.bodies[p.body];
      body.position_m = p.position_m;
      body.orientation_xyzw = p.orientation_xyzw;
      body.velocity_m_s = p.velocity_m_s;
    }
    for (int i = 0; i < out.event_count; ++i) {
      const ExerciseEvent& e = out.events[i];
      reported.push_back(
          {record.tick, exercise->description().event_names[e.type], e.index, e.value});
    }
    ++record.tick;
  }
  void run(double time_s) {
    for (int i = 0; i < static_cast<int>(std::lround(time_s * 1e3)); ++i) tick();
  }
  /// Ticks until a value equals `wanted`; fails after a minute of play.
  void runUntil(const std::string& name, double wanted) {
    for (int i = 0; i < 60'000; ++i) {
      tick();
      if (value(name) == wanted) return;
    }
    ADD_FAILURE() << name << " never became " << wanted << ", it is " << value(name);
  }
  void act(Act action, double value = 0.0) {
    Command& c = record.commands[record.command_count++];
    c = Command{};
    c.type = CommandType::kAction;
    c.index = static_cast<std::int32_t>(action);
    c.value = value;
  }

  [[nodiscard]] double value(const std::string& name) const {
    const auto& names = exercise->description().value_names;
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) ADD_FAILURE() << "no value " << name;
    return out.values[found - names.begin()];
  }
  [[nodiscard]] int count(const std::string& event) const {
    return static_cast<int>(std::count_if(reported.begin(), reported.end(),
                                          [&](const Reported& t) { return t.event == event; }));
  }
  [[nodiscard]] Reported last(const std::string& event) const {
    const auto found = std::find_if(reported.rbegin(), reported.rend(),
                                    [&](const Reported& t) { return t.event == event; });
    if (found == reported.rend()) {
      ADD_FAILURE() << "no event " << event;
      return {};
    }
    return *found;
  }
  /// Liquid left in all dispensers [l].
  [[nodiscard]] double left_l() const {
    double sum_l = 0.0;
    const auto& names = exercise->description().value_names;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i].starts_with("left_l/")) sum_l += out.values[i];
    }
    return sum_l;
  }

  std::unique_ptr<Exercise> exercise;
  SceneModel scene;
  TickRecord record;
  ArticulatedBody hand{shippedHand()};
  ExerciseRecord out;
  BodyPlacements placements;
  std::vector<double> parameters;
  std::vector<Reported> reported;
  bool presses = false;            ///< the fingers press the cushion of the held dispenser ...
  double pressed_n = 0.0;          ///< ... with this force at their tips
  double stiffness_n_m = 280.0;    ///< of the dispenser's shell
  bool fingers_face_palm = false;  ///< posture in which the fingertips press the object in the palm
  int asked_closure = -1;
  bool may_push = true;
};

}  // namespace wholehand::test
