// What the avatar and the bodies do without contact follows from the rows before: it takes little
// room since schema 8, to the same bits.
#include "telemetry/round_trip.hpp"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace wholehand {
namespace {

using synthetic::Folder;
using synthetic::kManyTicks;
using synthetic::ofSchema;
using synthetic::roundTrip;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr double kInertiaPeriod_s = 1e-3;

/// M_r of synthetic::inertia(), by its formula.
Matrix6 inertiaAt(const Vector6& q) {
  const double x3 = q[3] / 2, x4 = q[4] / 2, x5 = q[5] / 2;
  Matrix6 m = Matrix6::Constant(0.125 * x5);
  m.diagonal().setConstant(2.0 + 0.25 * x3 * (2 * x4 * x4 - 1));
  return m;
}

/// An avatar that follows a device which moves by encoder steps. From tick `touch` on a force acts
/// on the first axes, as on a palm, and the ticks have a contact.
std::vector<TickRecord> avatarTicks(std::uint64_t count, std::uint64_t touch) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise;
  std::vector<TickRecord> ticks;
  Vector6 q = Vector6::Zero(), v = Vector6::Zero();
  for (std::uint64_t t = 0; t < count; ++t) {
    TickRecord r = synthetic::noisy(t, random);
    r.elapsed_periods = 1;
    const bool touches = t >= touch;
    r.contact_count = touches ? 1 : 0;
    r.contacts = {};
    r.exercise = {};
    r.exercise.value_count = 3;
    r.closure = r.exercise.wall = AxisPosition(6);
    r.exercise.wall_active = AxisFlag(6);
    r.exercise.effort = r.tank_effort = AxisEffort(6);
    const Matrix6 m = inertiaAt(q);
    Vector6 force;
    for (int i = 0; i < 6; ++i) {
      r.q_m[i] = 1e-5 * std::round(5e4 * std::sin(3e-3 * static_cast<double>(t) + i));
      r.qd_mf[i] = 1.5e-3 * std::round(1e3 * std::cos(3e-3 * static_cast<double>(t) + i));
      r.q_s[i] = q[i];
      r.qd_s[i] = v[i];
      const double k = 900.0 / m(i, i);
      const double damping = m(i, i) * (2.0 * std::sqrt(k) - k * kInertiaPeriod_s);
      r.f_s[i] = 900.0 * (r.q_m[i] - q[i]) + damping * (r.qd_mf[i] - v[i]);
      force[i] = r.f_s[i];
      if (touches && i < 3) force[i] += 0.1 * noise(random);
    }
    v += kInertiaPeriod_s * m.llt().solve(force);
    q += kInertiaPeriod_s * v;
    ticks.push_back(r);
  }
  return ticks;
}

/// Bodies that tumble beside it.
void addTumblingBodies(std::vector<TickRecord>& ticks) {
  std::array<Eigen::Quaterniond, 4> turn;
  turn.fill(Eigen::Quaterniond::Identity());
  std::array<Eigen::Vector3d, 4> place{};
  for (std::size_t t = 0; t < ticks.size(); ++t) {
    for (std::size_t b = 0; b < 4; ++b) {
      const double phase = 1e-2 * static_cast<double>(t) + static_cast<double>(b);
      const Eigen::Vector3d v(std::sin(phase), 0.5 * std::cos(phase), 0.1);
      const Eigen::Vector3d spin(3.0 * std::cos(phase), 5.0, std::sin(2 * phase));
      place[b] += kInertiaPeriod_s * v;
      const double angle = spin.norm() * kInertiaPeriod_s;
      turn[b] = Eigen::Quaterniond(Eigen::AngleAxisd(angle, spin.normalized())) * turn[b];
      turn[b].normalize();
      BodyState& body = ticks[t].bodies[b];
      body.position_m = Vec3::from(place[b]);
      body.velocity_m_s = Vec3::from(v);
      body.angular_velocity_rad_s = Vec3::from(spin);
      body.orientation_xyzw = {turn[b].x(), turn[b].y(), turn[b].z(), turn[b].w()};
    }
  }
}

// Free, then touched. Of a body's 7 numbers of position and orientation schema 8 packs each in 6
// bytes less; of the avatar's 18 numbers q̇_s, f_s and q_m each in 3.5 less while it is free.
TEST(InertiaPacking, AvatarThatIsTouchedAndTumblingBodies_ComeBackAndTakeLittleRoom) {
  std::vector<TickRecord> ticks = avatarTicks(kManyTicks, kManyTicks / 2);
  addTumblingBodies(ticks);
  RecordingMeta no_fingers = synthetic::meta();  // none that a touched palm leaves alone
  no_fingers.law.hand_axis.assign(6, 0.0);
  const double bytes = roundTrip(ticks), before = roundTrip(ticks, ofSchema(kStepSchema - 1));
  std::printf("figure: %.0f bytes a tick, %.0f in schema 7\n", bytes, before);
  EXPECT_LT(bytes, before - (4 * 7 * 6.0 + 18 * 3.5 / 2));
  EXPECT_LT(bytes, roundTrip(ticks, no_fingers));
}

TEST(InertiaPacking, InertiaOfAnotherDevice_IsRefused) {
  const Folder folder;
  for (const int what : {0, 1, 2}) {
    RecordingMeta meta = synthetic::meta();
    if (what == 0) meta.law.inertia.coefficients.pop_back();
    if (what == 1) meta.law.inertia.degrees[3] = 0.5;
    if (what == 2) meta.law.inertia.lower.pop_back();
    EXPECT_FALSE(RecordingWriter::create(folder.file("a.h5"), meta).ok()) << what;
  }
}

}  // namespace
}  // namespace wholehand
