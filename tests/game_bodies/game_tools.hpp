#pragma once

#include "files/mesh/convex_mesh.hpp"
#include "loop/core/body_order.hpp"
#include "loop/model/game_shapes.hpp"
#include "support/rig_tools.hpp"
#include "support/tolerance.hpp"

#include <cstring>
#include <deque>
#include <map>
#include <random>

/// A rig with the shipped game scene, and orders to the game's bodies.
namespace wholehand::test {

inline Models gameModels(const std::string& device = "lambda-pride",
                         const std::string& hand = "adult-median-right") {
  return load(exerciseFiles("game-scene", 1, hand, device));
}

inline const Eigen::Vector3d kAside_m(0.5, 0.3, 0.2);  ///< a place beside the hand

inline Shape boxShape(const Eigen::Vector3d& size_m) {
  Shape shape;
  shape.half_extents_m = 0.5 * size_m;
  return shape;
}

/// Moves to a random position every 0.6 s, within this share of each axis's range about its middle.
inline Intention wander(std::mt19937_64& random, const DeviceModel& device, double duration_s,
                        double share) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::vector<Waypoint> way{{0.0, AxisPosition(device.axisCount())}};
  for (double t = 0.6; t < duration_s; t += 0.6) {
    AxisPosition q(device.axisCount());
    for (int a = 0; a < q.size(); ++a) {
      const DeviceAxis& axis = device.axes[a];
      q[a] = 0.5 * (axis.lower + axis.upper) + share * unit(random) * (axis.upper - axis.lower);
    }
    way.push_back({t, q});
  }
  return Intention::throughWaypoints(way);
}

/// A box as a convex mesh, to test the mesh code of the engine's narrow phase.
inline Shape boxMesh(const Eigen::Vector3d& size_m) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 8; ++i) {
    points.emplace_back(0.5 * size_m.x() * ((i & 1) != 0 ? 1 : -1),
                        0.5 * size_m.y() * ((i & 2) != 0 ? 1 : -1),
                        0.5 * size_m.z() * ((i & 4) != 0 ? 1 : -1));
  }
  const std::vector<Eigen::Vector3i> faces = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6},
                                              {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3},
                                              {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return orThrow(convexMesh(points, faces));
}

inline BodyPose poseAt(const Eigen::Vector3d& at_m,
                       const Eigen::Quaterniond& turn = Eigen::Quaterniond::Identity()) {
  return {Vec3::from(at_m), QuatXyzw::from(turn)};
}

/// A rig that the test ticks; orders wait until a tick takes them, at most eight per tick.
struct Game {
  Game(Models models, Intention intention, const RigOptions& options = {})
      : rig(orThrow(buildRig(std::move(models), std::move(intention), options))) {
    if (!rig->renderer->arm()) throw std::runtime_error("not armed");
  }

  /// The shipped scene at rest, with these shapes as set 0, after `after_ticks` ticks.
  explicit Game(const std::vector<Shape>& pieces, int after_ticks = 0)
      : Game(gameModels(), Intention::throughWaypoints({{0.0, AxisPosition(6)}})) {
    prepare(0, pieces);
    run(after_ticks);
  }

  void order(const Command& command) { waiting.push_back(command); }
  void prepare(int set, const std::vector<Shape>& pieces) {
    const auto shapes = orThrow(prepareShapes(pieces, rig->models.scene.game));
    for (const Command& command : shapeCommands(set, shapes)) order(command);
  }
  const TickRecord& tick() {
    record.tick = ticks++;
    record.time_s = static_cast<double>(record.tick) * 1e-3;
    record.command_count = 0;
    while (record.command_count < kMaxCommands && !waiting.empty()) {
      record.commands[record.command_count++] = waiting.front();
      waiting.pop_front();
    }
    rig->renderer->tick(1, record);
    return record;
  }
  void run(int count) {
    for (int k = 0; k < count; ++k) tick();
  }
  [[nodiscard]] const BodyState& body(int slot) const {
    return record.bodies[rig->models.scene.bodies.size() + static_cast<std::size_t>(slot)];
  }
  /// Name of this slot's last event in the last tick; empty if none.
  [[nodiscard]] std::string event(int slot) const {
    const auto& names = rig->models.exercise->description().event_names;
    std::string last;
    for (int i = 0; i < record.exercise.event_count; ++i) {
      const ExerciseEvent& e = record.exercise.events[i];
      if (e.index == slot) last = names[e.type];
    }
    return last;
  }
  /// Ticks until the slot has this event; false if it has not within `most` ticks.
  bool until(int slot, const std::string& name, int most) {
    for (int k = 0; k < most; ++k) {
      tick();
      if (event(slot) == name) return true;
    }
    return false;
  }
  /// Force of a slot's body on the hand in the last tick [N].
  [[nodiscard]] Eigen::Vector3d forceOf(int slot) const {
    const int index = static_cast<int>(rig->models.scene.bodies.size()) + slot;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int i = 0; i < record.contact_count; ++i) {
      if (record.contacts[i].body == index) sum += record.contacts[i].force_n.eigen();
    }
    return sum;
  }
  /// Centre of the palm [m].
  [[nodiscard]] Eigen::Vector3d palm() const {
    const HandModel& hand = rig->models.hand;
    const ArticulatedBody at = handAt(hand, record.q_s);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int count = 0;
    for (const Capsule& c : hand.capsules) {
      if (c.link != hand.palm_link) continue;
      sum += at.linkPose(c.link) * Eigen::Vector3d(0.5 * (c.a_m + c.b_m));
      ++count;
    }
    return sum / count;
  }

  std::unique_ptr<Rig> rig;
  std::deque<Command> waiting;
  TickRecord record;
  std::uint64_t ticks = 0;
};

inline Intention atRest(int axes = 6) {
  return Intention::throughWaypoints({{0.0, AxisPosition(axes)}});
}

inline SpawnOrder spawnOf(int slot, int set, BodyOwner owner, const BodyPose& pose) {
  SpawnOrder order;
  order.slot = slot;
  order.shape_set = set;
  order.owner = owner;
  order.pose = pose;
  return order;
}

/// A game whose person has pressed a plate from above for a second; the plate is at `at_m`.
inline Game pressedFromAbove(BodyOwner owner, Eigen::Vector3d& at_m) {
  AxisPosition pressing(6);
  pressing[2] = -0.06;
  Game game(gameModels(), Intention::throughWaypoints({{0.0, AxisPosition(6)}, {0.5, pressing}}));
  game.prepare(0, {boxShape({0.25, 0.25, 0.04})});
  game.run(100);
  at_m = game.palm();
  at_m.z() = -reach(game.rig->models.hand, game.record.q_s, -Eigen::Vector3d::UnitZ()) - 0.025;
  game.order(spawnCommand(spawnOf(0, 0, owner, poseAt(at_m))));
  for (int k = 0; k < 1500; ++k) {
    if (owner == BodyOwner::kGame && k % 16 == 0) game.order(bodyTargetCommand(0, 1, poseAt(at_m)));
    game.tick();
  }
  return game;
}

}  // namespace wholehand::test
