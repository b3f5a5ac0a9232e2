#pragma once

#include "loop/core/tick_record.hpp"

#include <cstdint>
#include <type_traits>

namespace wholehand {

/// Calls visit(name, numbers, count) for every value that a tick computes from its recorded inputs,
/// in order. Clock times and the virtual patient are left out, and arrays are visited up to their
/// size. The names are those of the recording's datasets; `numbers` points to doubles.
template <class Visit>
void visitComputed(const TickRecord& r, Visit&& visit) {
  const auto one = [&visit](const char* name, auto value) {
    const auto number = static_cast<double>(value);
    visit(name, &number, 1);
  };
  const auto array = [&visit](const char* name, const auto& a) {
    visit(name, a.data(), static_cast<int>(a.size()));
  };
  one("faults", static_cast<std::uint32_t>(r.faults));
  one("safety_state", static_cast<std::int32_t>(r.safety_state));
  one("fault_axis", r.fault_axis);
  visit("parameters", r.parameters.data(), r.parameter_count);
  array("effort_limit", r.effort_limit);
  array("q_m", r.q_m);
  array("qd_mf", r.qd_mf);
  array("q_s", r.q_s);
  array("qd_s", r.qd_s);
  array("theta", r.theta);
  one("coupling_error_rad", r.coupling_error_rad);
  one("palm_distance_m", r.palm_distance_m);
  one("palm_body", r.palm_body);
  one("palm_target_distance_m", r.palm_target_distance_m);
  array("closure", r.closure);
  static_assert(sizeof(BodyState) == 13 * sizeof(double));
  one("body_count", r.body_count);
  visit("bodies", reinterpret_cast<const double*>(r.bodies.data()), 13 * r.body_count);
  array("f_s", r.f_s);
  array("coupling", r.coupling);
  array("exercise_effort", r.exercise.effort);
  one("alpha", r.exercise.alpha);
  for (const auto active : r.exercise.wall_active) one("wall_active", active);
  array("wall", r.exercise.wall);
  visit("exercise_values", r.exercise.values.data(), r.exercise.value_count);
  one("event_count", r.exercise.event_count);
  const auto each_event = [&](const char* name, auto member) {
    for (int i = 0; i < r.exercise.event_count; ++i) one(name, r.exercise.events[i].*member);
  };
  each_event("events/type", &ExerciseEvent::type);
  each_event("events/index", &ExerciseEvent::index);
  each_event("events/value", &ExerciseEvent::value);
  array("phi", r.phi);
  array("damping", r.damping);
  array("tank", r.tank);
  array("tank_effort", r.tank_effort);
  array("rendered", r.rendered);
  one("authority", r.authority);
  array("sent", r.sent);
  one("contact_count", r.contact_count);
  one("contacts_dropped", r.contacts_dropped);
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  const auto each_contact = [&](const char* name, auto member) {
    for (int i = 0; i < r.contact_count; ++i) {
      const auto& value = r.contacts[i].*member;
      if constexpr (std::is_same_v<decltype(value), const Vec3&>) {
        visit(name, &value.x, 3);
      } else {
        one(name, value);
      }
    }
  };
  each_contact("contacts/capsule", &Contact::capsule);
  each_contact("contacts/link", &Contact::link);
  each_contact("contacts/body", &Contact::body);
  each_contact("contacts/point_m", &Contact::point_m);
  each_contact("contacts/normal", &Contact::normal);
  each_contact("contacts/force_n", &Contact::force_n);
  each_contact("contacts/torque_nm", &Contact::torque_nm);
  each_contact("contacts/distance_m", &Contact::distance_m);
}

/// Digest of all values of visitComputed() and their counts: two ticks have the same digest if
/// every bit is the same. 0 and −0 differ; all NaNs count as equal. Takes 1 µs: do not call it in
/// the tick.
[[nodiscard]] std::uint64_t digestOf(const TickRecord& record) noexcept;

}  // namespace wholehand
