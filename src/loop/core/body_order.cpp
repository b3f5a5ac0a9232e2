#include "loop/core/body_order.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

// Indices into Command::numbers.
constexpr int kPose = 0;  // 7 numbers: position, quaternion xyzw
constexpr int kVelocity = 7, kShapes = 10, kOwnerAt = 11, kMass = 12, kFriction = 13, kRefuse = 14,
              kSpin = 15;

Command order(CommandType type, int slot, int generation) noexcept {
  Command command;
  command.type = type;
  command.index = slot;
  command.value = generation;
  return command;
}

void put(const BodyPose& pose, Command& command) noexcept {
  const Vec3& p = pose.position_m;
  const QuatXyzw& q = pose.orientation_xyzw;
  command.numbers = {p.x, p.y, p.z, q.x, q.y, q.z, q.w};
}

/// Converts a command's number to an integer; −1 when it is not a whole number in 0 .. 1e9.
int whole(double value) noexcept {
  return value >= 0.0 && value < 1e9 && value == std::floor(value) ? static_cast<int>(value) : -1;
}

void put(const Vec3& v, int at, Command& command) noexcept {
  command.numbers[at] = v.x;
  command.numbers[at + 1] = v.y;
  command.numbers[at + 2] = v.z;
}

Vec3 vectorAt(int at, const Command& command) noexcept {
  return {command.numbers[at], command.numbers[at + 1], command.numbers[at + 2]};
}

}  // namespace

Command spawnCommand(const SpawnOrder& spawn) noexcept {
  Command command = order(CommandType::kSpawn, spawn.slot, spawn.generation);
  put(spawn.pose, command);
  put(spawn.velocity_m_s, kVelocity, command);
  put(spawn.spin_rad_s, kSpin, command);
  command.numbers[kShapes] = spawn.shape_set;
  command.numbers[kOwnerAt] = static_cast<double>(spawn.owner);
  command.numbers[kMass] = spawn.mass_kg;
  command.numbers[kFriction] = spawn.friction;
  command.numbers[kRefuse] = spawn.refuse_overlap ? 1.0 : 0.0;
  return command;
}

Command removeCommand(int slot, int generation) noexcept {
  return order(CommandType::kRemove, slot, generation);
}

Command teleportCommand(int slot, int generation, const BodyPose& pose) noexcept {
  Command command = order(CommandType::kTeleport, slot, generation);
  put(pose, command);
  return command;
}

Command setOwnerCommand(int slot, int generation, BodyOwner owner) noexcept {
  Command command = order(CommandType::kSetOwner, slot, generation);
  command.numbers[kOwnerAt] = static_cast<double>(owner);
  return command;
}

Command bodyTargetCommand(int slot, int generation, const BodyPose& pose) noexcept {
  Command command = order(CommandType::kBodyTarget, slot, generation);
  put(pose, command);
  return command;
}

SpawnOrder spawnOrderOf(const Command& command) noexcept {
  SpawnOrder out;
  out.slot = command.index;
  out.generation = whole(command.value);
  out.pose = poseOf(command);
  out.velocity_m_s = vectorAt(kVelocity, command);
  out.shape_set = whole(command.numbers[kShapes]);
  out.owner = static_cast<BodyOwner>(whole(command.numbers[kOwnerAt]));
  out.mass_kg = command.numbers[kMass];
  out.friction = command.numbers[kFriction];
  out.refuse_overlap = command.numbers[kRefuse] != 0.0;
  out.spin_rad_s = vectorAt(kSpin, command);
  return out;
}

BodyPose poseOf(const Command& command) noexcept {
  const auto& n = command.numbers;
  return {{n[kPose], n[kPose + 1], n[kPose + 2]},
          {n[kPose + 3], n[kPose + 4], n[kPose + 5], n[kPose + 6]}};
}

}  // namespace wholehand
