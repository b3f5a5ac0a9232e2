// Bodies of a game: a program puts a ball into the running world and moves it against the hand.
//
// The ball appears over the palm as a ghost (without contacts), becomes solid beside it, and is
// pulled to the program's targets by 5 N at most. Prints the state of the orders and how hard the
// ball presses.
//
//   07_bodies_of_a_game [folder that holds config/]
#include "wholehand/wholehand.hpp"

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

using namespace wholehand;

int refuse(const Diagnostics& why) {
  std::fprintf(stderr, "%s\n", format(why).c_str());
  return 2;
}

int main(int argc, char** argv) {
  const std::string config = (argc > 1 ? argv[1] : std::string(WHOLEHAND_SOURCE_DIR)) + "/config/";
  auto models = loadModels(
      {"", config + "hands/adult-median-right.toml", config + "devices/lambda-pride.toml",
       config + "rendering/lambda-pride.toml", config + "patients/relaxed-adult.toml", "",
       config + "exercises/game-scene.toml", 1});
  if (!models) return refuse(models.errors());
  Intention rest = Intention::throughWaypoints({{0.0, AxisPosition(models->device.axisCount())}});
  auto rig = buildRig(*models, std::move(rest), RigOptions{});
  if (!rig) return refuse(rig.errors());
  HapticRenderer& renderer = *(*rig)->renderer;
  if (auto armed = renderer.arm(); !armed) return refuse(armed.errors());

  Shape ball;
  ball.type = ShapeType::kSphere;
  ball.radius_m = 0.03;
  auto shapes = prepareShapes({ball}, models->scene.game);
  if (!shapes) return refuse(shapes.errors());
  std::vector<Command> orders = shapeCommands(0, *shapes);
  SpawnOrder spawn;
  spawn.owner = BodyOwner::kGame;
  spawn.pose.position_m = {0.05, 0.0, 0.0};  // in the palm
  orders.push_back(spawnCommand(spawn));

  const std::vector<std::string>& events = (*rig)->models.exercise->description().event_names;
  TickRecord record;
  for (int tick = 0; tick < 3000; ++tick) {
    // Away from the hand first, then back to where it was, 60 times a second.
    BodyPose target = spawn.pose;
    if (tick < 1500) target.position_m.y = 0.25;
    if (tick > 5 && tick % 16 == 0) orders.push_back(bodyTargetCommand(0, 1, target));
    record.command_count = std::min<int>(static_cast<int>(orders.size()), kMaxCommands);
    std::copy_n(orders.begin(), record.command_count, record.commands.begin());
    orders.erase(orders.begin(), orders.begin() + record.command_count);
    renderer.tick(1, record);  // a Session takes commands from its queue: tryCommand()
    if (any(record.faults & kStoppingFaults)) return 3;
    for (int i = 0; i < record.exercise.event_count; ++i) {
      const ExerciseEvent& event = record.exercise.events[i];
      std::printf("%5.3f s  slot %d %s\n", tick * 1e-3, event.index, events[event.type].c_str());
    }
    double force_n = 0.0;
    for (int i = 0; i < record.contact_count; ++i) {
      force_n += record.contacts[i].force_n.eigen().norm();
    }
    if (tick % 250 == 0) std::printf("%5.3f s  presses with %.2f N\n", tick * 1e-3, force_n);
  }
  renderer.requestStop();
  while (!renderer.atNeutral()) renderer.tick(1, record);
  (*rig)->device->close();
}
