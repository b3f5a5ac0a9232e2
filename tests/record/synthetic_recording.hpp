#pragma once

#include "loop/core/tick_digest.hpp"
#include "loop/core/tick_record.hpp"
#include "record/recording.hpp"
#include "support/folder.hpp"

#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

namespace wholehand::synthetic {

using test::Folder;

inline RecordingMeta meta() {
  RecordingMeta m;
  m.created_utc = "2026-11-20T09:38:00Z";
  m.git_version = "7c1e90a";
  m.seed = 0xFEDC'BA98'7654'3210ULL;
  m.engine = "bullet";
  m.models_changed = true;
  m.passport = "0123";
  m.title = "Reach and grasp";
  m.axis_names = {"x", "y", "z", "finger_flexion", "thumb_circumduction", "thumb_flexion"};
  m.axis_units = {"m", "m", "m", "rad", "rad", "rad"};
  m.effort_limits = {20, 20, 20, 0.8, 0.6, 0.8};
  m.lever_arms_m = {0, 0, 0, 0.08, 0, 0.08};
  m.encoder_step = {1e-5, 1e-5, 2e-5, 0.0, 1e-4, 3e-4};
  m.armed_position = {0.01, -0.02, 0.03, 0.4, 0.5, 0.6};
  for (int i = 0; i < 18; ++i) m.joint_names.push_back("joint_" + std::to_string(i));
  m.body_names = {"cube", "sphere", "cylinder", "disk"};
  m.capsule_names = {"palm", "index_proximal"};
  m.body_joint_names = {"cube", "disk"};
  m.body_joint_units = {"rad", "m"};
  m.exercise = "cocktail-bar";
  m.level = 3;
  m.parameter_names = {"effort_limit_arm_n", "wall_stiffness_ratio"};
  m.parameter_values = {20.0, 1.0};
  m.value_names = {"stage", "flow_l_s", "spilt_l"};
  m.event_names = {"touched", "spilt"};
  m.clinic_visit = 1'234'567'890'123;
  m.clinic_item = 4;
  m.files = {{"config/devices/lambda-pride.toml", "kind = \"device\"\nname = \"lambda-pride\"\n"},
             {"mesh.stl", std::string("bin\0ary\xff\0", 9)},
             {"empty.txt", ""}};
  return m;
}

template <class Array>
Array randomArray(int size, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Array a(size);
  for (int i = 0; i < size; ++i) a[i] = normal(random);
  return a;
}

/// A record with every field set to a distinct value.
inline TickRecord noisy(std::uint64_t tick, std::mt19937_64& random) {
  std::normal_distribution<double> n;
  const auto whole = [&random](int most) {
    return static_cast<std::int32_t>(random() % static_cast<std::uint64_t>(most));
  };
  TickRecord r;
  r.tick = tick;
  r.time_s = static_cast<double>(tick) * 1e-3;
  r.elapsed_periods = 1 + static_cast<std::uint32_t>(tick % 50 == 49);
  r.faults = static_cast<Fault>(random() % (1ULL << kFaultBits));
  r.lateness_ns = whole(100000);
  r.wall_ns = whole(200000);
  r.cpu_ns = whole(150000);
  for (auto& s : r.stage_cpu_ns) s = whole(20000);
  r.moved_by = static_cast<Mover>(whole(kMovers));
  r.help = static_cast<Help>(whole(kHelps));
  r.q_m = randomArray<AxisPosition>(6, random);
  r.intention = randomArray<AxisPosition>(tick % 3 == 0 ? 0 : 6, random);
  r.patient_effort = randomArray<AxisEffort>(tick % 3 == 0 ? 0 : 6, random);
  r.qd_mf = randomArray<AxisVelocity>(6, random);
  r.q_s = randomArray<AxisPosition>(6, random);
  r.qd_s = randomArray<AxisVelocity>(6, random);
  r.theta = randomArray<JointPosition>(18, random);
  r.coupling_error_rad = n(random) * 1e-6;
  r.palm_distance_m = tick % 7 == 0 ? std::numeric_limits<double>::infinity() : n(random);
  r.body_count = 4;
  for (std::size_t b = 0; b < 4; ++b) {
    r.bodies[b].position_m = {n(random), n(random), n(random)};
    r.bodies[b].orientation_xyzw = {n(random), n(random), n(random), n(random)};
    r.bodies[b].velocity_m_s = {n(random), n(random), n(random)};
    r.bodies[b].angular_velocity_rad_s = {n(random), n(random), n(random)};
  }
  r.body_joint_count = 2;
  for (std::size_t j = 0; j < 2; ++j) {
    r.body_q[j] = n(random);
    r.body_qd[j] = n(random);
  }
  r.f_s = randomArray<AxisEffort>(6, random);
  r.coupling = randomArray<AxisEffort>(6, random);
  r.phi = randomArray<AxisRatio>(6, random);
  r.damping = randomArray<AxisEffort>(6, random);
  r.rendered = randomArray<AxisEffort>(6, random);
  if (tick % 11 == 0) r.rendered[2] = std::numeric_limits<double>::quiet_NaN();
  r.authority = std::abs(n(random));
  r.sent = randomArray<AxisEffort>(6, random);
  r.contact_count = tick % 5 == 0 ? 0 : whole(9);
  r.contacts_dropped = whole(2);
  for (std::int32_t c = 0; c < r.contact_count; ++c) {
    Contact& k = r.contacts[c];
    k.capsule = whole(40);
    k.link = whole(20);
    k.body = whole(4);
    k.point_m = {n(random), n(random), n(random)};
    k.normal = {n(random), n(random), n(random)};
    k.force_n = {n(random), n(random), n(random)};
    k.torque_nm = {n(random), n(random), n(random)};
    k.distance_m = n(random);
  }
  r.effort_limit = randomArray<AxisEffort>(6, random);
  r.tank = randomArray<AxisEnergy>(6, random);
  r.tank_effort = randomArray<AxisEffort>(6, random);
  r.closure = randomArray<AxisPosition>(tick % 4 == 0 ? 0 : 6, random);
  if (tick % 4 != 0) r.closure[0] = std::numeric_limits<double>::quiet_NaN();
  r.palm_body = whole(5) - 1;
  r.palm_target_distance_m = n(random);
  r.safety_state = static_cast<SafetyState>(whole(4));
  r.fault_axis = whole(7) - 1;
  r.parameter_count = 2;
  for (std::size_t i = 0; i < 2; ++i) r.parameters[i] = n(random);
  r.command_count = tick % 20 == 0 ? whole(kMaxCommands + 1) : 0;
  for (std::int32_t c = 0; c < r.command_count; ++c) {
    r.commands[c] = {static_cast<CommandType>(whole(6)), whole(9), n(random),
                     randomArray<AxisPosition>(6, random)};
  }
  r.exercise.effort = randomArray<AxisEffort>(6, random);
  r.exercise.alpha = n(random);
  r.exercise.wall_active = AxisFlag(6);
  for (int a = 0; a < 6; ++a) r.exercise.wall_active[a] = whole(2) == 1;
  r.exercise.wall = randomArray<AxisPosition>(6, random);
  r.exercise.value_count = 3;
  for (std::size_t i = 0; i < 3; ++i) r.exercise.values[i] = n(random);
  r.exercise.event_count = tick % 9 == 0 ? whole(kMaxExerciseEvents + 1) : 0;
  for (std::int32_t c = 0; c < r.exercise.event_count; ++c) {
    r.exercise.events[c] = {whole(2), whole(4) - 1, n(random)};
  }
  return r;
}

/// `count` of them, one after another.
inline std::vector<TickRecord> noisyTicks(std::uint64_t count, std::uint64_t seed = 1) {
  std::mt19937_64 random(seed);
  std::vector<TickRecord> ticks;
  for (std::uint64_t i = 0; i < count; ++i) ticks.push_back(noisy(i, random));
  return ticks;
}

/// Writes a complete, closed recording of these ticks.
inline void writeRecording(const std::string& path, const std::vector<TickRecord>& ticks,
                           const RecordingMeta& description = meta()) {
  const auto writer = RecordingWriter::create(path, description).value();
  for (const TickRecord& tick : ticks) {
    if (!writer->append(tick)) throw std::runtime_error("no room on the disk");
  }
  writer->close();
}

/// True if `read` is what a recording keeps of `wrote`: its number, its inputs and, by the digest,
/// all the rest.
inline bool identical(const TickRecord& read, std::uint64_t digest, const TickRecord& wrote) {
  return read.tick == wrote.tick && digest == digestOf(wrote);
}

}  // namespace wholehand::synthetic
