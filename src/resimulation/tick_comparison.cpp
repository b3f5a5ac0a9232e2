#include "resimulation/tick_comparison.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstdint>

namespace wholehand {
namespace {

// Not ==: NaN must equal itself, and 0 must differ from -0.
bool sameBits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

// Collects the first difference between two ticks.
class Comparison {
 public:
  void check(const char* name, double a, double b) {
    if (!found.field.empty() || sameBits(a, b)) return;
    found = {name, fmt::format("{:.17g}", a), fmt::format("{:.17g}", b)};
  }
  template <class Array>
  void checkArray(const char* name, const Array& a, const Array& b) {
    if (a.size() != b.size()) {
      check((std::string(name) + ".size").c_str(), a.size(), b.size());
      return;
    }
    for (int i = 0; i < a.size(); ++i) check(fmt::format("{}[{}]", name, i).c_str(), a[i], b[i]);
  }
  void check(const std::string& name, const Vec3& a, const Vec3& b) {
    check((name + ".x").c_str(), a.x, b.x);
    check((name + ".y").c_str(), a.y, b.y);
    check((name + ".z").c_str(), a.z, b.z);
  }
  void check(const std::string& name, const BodyState& a, const BodyState& b) {
    check(name + ".position_m", a.position_m, b.position_m);
    check((name + ".orientation_xyzw.x").c_str(), a.orientation_xyzw.x, b.orientation_xyzw.x);
    check((name + ".orientation_xyzw.y").c_str(), a.orientation_xyzw.y, b.orientation_xyzw.y);
    check((name + ".orientation_xyzw.z").c_str(), a.orientation_xyzw.z, b.orientation_xyzw.z);
    check((name + ".orientation_xyzw.w").c_str(), a.orientation_xyzw.w, b.orientation_xyzw.w);
    check(name + ".velocity_m_s", a.velocity_m_s, b.velocity_m_s);
    check(name + ".angular_velocity_rad_s", a.angular_velocity_rad_s, b.angular_velocity_rad_s);
  }
  void check(const std::string& name, const Contact& a, const Contact& b) {
    check((name + ".capsule").c_str(), a.capsule, b.capsule);
    check((name + ".link").c_str(), a.link, b.link);
    check((name + ".body").c_str(), a.body, b.body);
    check(name + ".point_m", a.point_m, b.point_m);
    check(name + ".normal", a.normal, b.normal);
    check(name + ".force_n", a.force_n, b.force_n);
    check(name + ".torque_nm", a.torque_nm, b.torque_nm);
    check((name + ".distance_m").c_str(), a.distance_m, b.distance_m);
  }

  TickDifference found;
};

}  // namespace

TickDifference firstDifference(const TickRecord& first, const TickRecord& again) {
  Comparison c;
  c.check("faults", static_cast<double>(first.faults), static_cast<double>(again.faults));
  c.check("safety_state", static_cast<double>(first.safety_state),
          static_cast<double>(again.safety_state));
  c.check("fault_axis", first.fault_axis, again.fault_axis);
  c.checkArray("q_m", first.q_m, again.q_m);
  c.checkArray("qd_mf", first.qd_mf, again.qd_mf);
  c.checkArray("q_s", first.q_s, again.q_s);
  c.checkArray("qd_s", first.qd_s, again.qd_s);
  c.checkArray("theta", first.theta, again.theta);
  c.check("coupling_error_rad", first.coupling_error_rad, again.coupling_error_rad);
  c.check("palm_distance_m", first.palm_distance_m, again.palm_distance_m);
  c.checkArray("f_s", first.f_s, again.f_s);
  c.checkArray("coupling", first.coupling, again.coupling);
  c.checkArray("exercise_effort", first.exercise.effort, again.exercise.effort);
  c.check("alpha", first.exercise.alpha, again.exercise.alpha);
  c.checkArray("wall", first.exercise.wall, again.exercise.wall);
  c.check("palm_body", first.palm_body, again.palm_body);
  c.check("palm_target_distance_m", first.palm_target_distance_m, again.palm_target_distance_m);
  c.checkArray("tank", first.tank, again.tank);
  c.checkArray("tank_effort", first.tank_effort, again.tank_effort);
  c.checkArray("closure", first.closure, again.closure);
  c.checkArray("effort_limit", first.effort_limit, again.effort_limit);
  c.check("parameter_count", first.parameter_count, again.parameter_count);
  c.check("value_count", first.exercise.value_count, again.exercise.value_count);
  c.check("event_count", first.exercise.event_count, again.exercise.event_count);
  c.checkArray("phi", first.phi, again.phi);
  c.checkArray("damping", first.damping, again.damping);
  c.checkArray("rendered", first.rendered, again.rendered);
  c.check("authority", first.authority, again.authority);
  c.checkArray("sent", first.sent, again.sent);
  c.check("body_count", first.body_count, again.body_count);
  c.check("contact_count", first.contact_count, again.contact_count);
  c.check("contacts_dropped", first.contacts_dropped, again.contacts_dropped);
  if (!c.found.field.empty()) return c.found;
  for (int i = 0; i < first.parameter_count; ++i) {
    c.check(fmt::format("parameters[{}]", i).c_str(), first.parameters[i], again.parameters[i]);
  }
  for (int i = 0; i < first.exercise.value_count; ++i) {
    c.check(fmt::format("exercise_values[{}]", i).c_str(), first.exercise.values[i],
            again.exercise.values[i]);
  }
  for (int i = 0; i < first.exercise.event_count; ++i) {
    const ExerciseEvent &a = first.exercise.events[i], &b = again.exercise.events[i];
    c.check(fmt::format("events[{}].type", i).c_str(), a.type, b.type);
    c.check(fmt::format("events[{}].index", i).c_str(), a.index, b.index);
    c.check(fmt::format("events[{}].value", i).c_str(), a.value, b.value);
  }
  for (int i = 0; i < first.body_count; ++i)
    c.check(fmt::format("bodies[{}]", i), first.bodies[i], again.bodies[i]);
  for (int i = 0; i < first.contact_count; ++i) {
    c.check(fmt::format("contacts[{}]", i), first.contacts[i], again.contacts[i]);
  }
  return c.found;
}

}  // namespace wholehand
