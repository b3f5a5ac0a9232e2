#include "loop/core/body_order.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

// Indices into Command::numbers.
constexpr int kPose = 0;  // 7 numbers: position, quaternion xyzw
constexpr int kVelocity = 7, kShapes = 10, kOwnerAt = 11, kMass = 12, kFriction = 13, kRefuse = 14;
constexpr int kSpin = 15;  // three integers packed in one number, each with kSpinWrap values
constexpr std::int64_t kSpinHalf = 1 << 16, kSpinWrap = 2 * kSpinHalf;
constexpr double kSpinSteps_s_rad = 256.0;  // resolution: steps per rad/s

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

/// Packs an angular velocity into one number: below 2^51, so that a double holds it exactly; 0 for
/// no spin.
double packed(const Vec3& spin_rad_s) noexcept {
  constexpr double kMost = static_cast<double>(kSpinHalf - 1);
  std::int64_t all = 0;
  for (const double speed : {spin_rad_s.z, spin_rad_s.y, spin_rad_s.x}) {
    const double steps = std::isfinite(speed) ? std::round(speed * kSpinSteps_s_rad) : 0.0;
    const auto whole_steps = static_cast<std::int64_t>(std::clamp(steps, -kMost, kMost));
    all = all * kSpinWrap + (whole_steps + kSpinWrap) % kSpinWrap;
  }
  return static_cast<double>(all);
}

Vec3 unpacked(double number) noexcept {
  if (!(number >= 0.0 && number < 0x1p51)) return {};
  auto all = static_cast<std::int64_t>(number);
  std::array<double, 3> speed{};
  for (double& s : speed) {
    const std::int64_t steps = all % kSpinWrap;
    s = static_cast<double>(steps < kSpinHalf ? steps : steps - kSpinWrap) / kSpinSteps_s_rad;
    all /= kSpinWrap;
  }
  return {speed[0], speed[1], speed[2]};
}

}  // namespace

Command spawnCommand(const SpawnOrder& spawn) noexcept {
  Command command = order(CommandType::kSpawn, spawn.slot, spawn.generation);
  put(spawn.pose, command);
  command.numbers[kVelocity] = spawn.velocity_m_s.x;
  command.numbers[kVelocity + 1] = spawn.velocity_m_s.y;
  command.numbers[kVelocity + 2] = spawn.velocity_m_s.z;
  command.numbers[kShapes] = spawn.shape_set;
  command.numbers[kOwnerAt] = static_cast<double>(spawn.owner);
  command.numbers[kMass] = spawn.mass_kg;
  command.numbers[kFriction] = spawn.friction;
  command.numbers[kRefuse] = spawn.refuse_overlap ? 1.0 : 0.0;
  command.numbers[kSpin] = packed(spawn.spin_rad_s);
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
  out.velocity_m_s = {command.numbers[kVelocity], command.numbers[kVelocity + 1],
                      command.numbers[kVelocity + 2]};
  out.shape_set = whole(command.numbers[kShapes]);
  out.owner = static_cast<BodyOwner>(whole(command.numbers[kOwnerAt]));
  out.mass_kg = command.numbers[kMass];
  out.friction = command.numbers[kFriction];
  out.refuse_overlap = command.numbers[kRefuse] != 0.0;
  out.spin_rad_s = unpacked(command.numbers[kSpin]);
  return out;
}

BodyPose poseOf(const Command& command) noexcept {
  const auto& n = command.numbers;
  return {{n[kPose], n[kPose + 1], n[kPose + 2]},
          {n[kPose + 3], n[kPose + 4], n[kPose + 5], n[kPose + 6]}};
}

}  // namespace wholehand
