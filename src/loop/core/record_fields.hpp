#pragma once

#include "loop/core/tick_record.hpp"

#include <cstddef>
#include <cstdint>
#include <tuple>
#include <type_traits>

/// The fields of a tick's record and of its items, each once. Packing, digest, recordings, replay
/// and the Python module visit these tables.
namespace wholehand {

/// What a field is to a tick that is computed again from its recorded inputs.
enum class FieldRole : std::uint8_t {
  kClock,     ///< time of the machine; another one in every run
  kInput,     ///< given to the tick
  kComputed,  ///< follows from the inputs; the digest covers it
  kLength     ///< number of items of another field; not in a recording, where the items tell it
};

/// How a recording stores a field.
enum class FieldStorage : std::uint8_t {
  kNot,
  kSingle,  ///< doubles in single precision
  kExact    ///< as it is; what a tick needs to be computed again
};

/// Names of a recording that label the elements of a field. A field without them has no dataset.
enum class FieldLabels : std::uint8_t {
  kNone,
  kStages,
  kAxes,
  kJoints,
  kBodies,
  kBodyJoints,
  kParameters,
  kValues
};

/// Unit of an element: of a translation, and of a rotation.
struct FieldUnit {
  constexpr FieldUnit(const char* both) : per_m(both), per_rad(both) {}
  constexpr FieldUnit(const char* of_m, const char* of_rad) : per_m(of_m), per_rad(of_rad) {}
  const char* per_m;
  const char* per_rad;
};

/// Items of an array of the record, of which the first `count` are used.
template <class Item, class Count>
struct FieldItems {
  Item* data;
  Count& count;
  int capacity;
};

/// A member, or a member's member.
template <class Row, class T, class... More>
struct FieldPath {
  T Row::*member;
  std::tuple<More...> more;

  constexpr auto& operator()(auto& row) const {
    if constexpr (sizeof...(More) == 0) {
      return row.*member;
    } else {
      return row.*member.*std::get<0>(more);
    }
  }
};
template <class Row, class T>
constexpr FieldPath<Row, T> fieldPath(T Row::*member) {
  return {member, {}};
}
template <class Row, class Part, class T>
constexpr FieldPath<Row, Part, T Part::*> fieldPath(Part Row::*part, T Part::*member) {
  return {part, {member}};
}

/// An array's path and that of its number of used items.
template <class Array, class Count>
struct ItemsPath {
  Array array;
  Count count;

  constexpr auto operator()(auto& row) const {
    auto& items = array(row);
    return FieldItems<std::remove_reference_t<decltype(items[0])>,
                      std::remove_reference_t<decltype(count(row))>>{
        items.data(), count(row), static_cast<int>(items.size())};
  }
};

template <class Path>
struct Field {
  const char* name;  ///< of difference and Python attribute; of the dataset, behind the last /
  FieldUnit unit;
  FieldRole role;
  FieldStorage storage;
  Path of;  ///< row -> number&, array&, or FieldItems
  FieldLabels labels = FieldLabels::kNone;
  int below =
      0;  ///< a stored number from here on, or below 0, is read as 0, unknown; 0: any number
};

namespace record_fields {

using enum FieldRole;
using enum FieldStorage;
using R = TickRecord;
using X = ExerciseRecord;

inline constexpr FieldUnit kOne{"1"}, kMetres{"m"}, kRadians{"rad"}, kSeconds{"s"},
    kNanoseconds{"ns"}, kJoules{"J"}, kPosition{"m", "rad"}, kVelocity{"m/s", "rad/s"},
    kEffort{"N", "N·m"}, kSeeName{"see name"}, kSeeType{"see type"};

template <class Path>
constexpr Field<Path> field(const char* name, FieldUnit unit, FieldRole role, FieldStorage storage,
                            Path path, FieldLabels labels = FieldLabels::kNone, int below = 0) {
  return {name, unit, role, storage, path, labels, below};
}
/// A value per axis.
template <class Array>
constexpr auto axes(const char* name, FieldUnit unit, FieldRole role, Array R::*member,
                    FieldStorage storage = kSingle) {
  return field(name, unit, role, storage, fieldPath(member), FieldLabels::kAxes);
}
template <class Array>
constexpr auto axes(const char* name, FieldUnit unit, FieldRole role, X R::*part,
                    Array X::*member) {
  return field(name, unit, role, kSingle, fieldPath(part, member), FieldLabels::kAxes);
}
template <class Array, class Count>
constexpr auto items(const char* name, FieldUnit unit, FieldRole role, FieldStorage storage,
                     Array array, Count count, FieldLabels labels = FieldLabels::kNone) {
  return field(name, unit, role, storage, ItemsPath<Array, Count>{array, count}, labels);
}

}  // namespace record_fields

/// The record's fields, in the order of a packed record and of the digest. A length comes before
/// its items.
inline constexpr auto kRecordFields = [] {
  using namespace record_fields;
  const auto path = [](auto... members) { return fieldPath(members...); };
  return std::tuple{
      field("tick", kOne, kInput, kExact, path(&R::tick)),
      field("time_s", kSeconds, kInput, kExact, path(&R::time_s)),
      field("elapsed_periods", kOne, kInput, kExact, path(&R::elapsed_periods)),
      field("faults", "bits", kComputed, kExact, path(&R::faults)),
      field("lateness_ns", kNanoseconds, kClock, kExact, path(&R::lateness_ns)),
      field("wall_ns", kNanoseconds, kClock, kExact, path(&R::wall_ns)),
      field("cpu_ns", kNanoseconds, kClock, kExact, path(&R::cpu_ns)),
      field("stage_cpu_ns", kNanoseconds, kClock, kExact, path(&R::stage_cpu_ns),
            FieldLabels::kStages),
      field("moved_by", kOne, kInput, kExact, path(&R::moved_by), FieldLabels::kNone, kMovers),
      field("help", kOne, kInput, kExact, path(&R::help), FieldLabels::kNone, kHelps),
      field("command_count", kOne, kInput, kExact, path(&R::command_count)),
      items("commands", kOne, kInput, kNot, path(&R::commands), path(&R::command_count)),
      field("safety_state", kOne, kComputed, kExact, path(&R::safety_state)),
      field("fault_axis", kOne, kComputed, kExact, path(&R::fault_axis)),
      field("parameter_count", kOne, kLength, kNot, path(&R::parameter_count)),
      items("parameters", kSeeName, kComputed, kExact, path(&R::parameters),
            path(&R::parameter_count), FieldLabels::kParameters),
      axes("effort_limit", kEffort, kComputed, &R::effort_limit),
      axes("q_m", kPosition, kComputed, &R::q_m, kExact),
      axes("intention", kPosition, kInput, &R::intention),
      axes("patient_effort", kEffort, kInput, &R::patient_effort),
      axes("qd_mf", kVelocity, kComputed, &R::qd_mf),
      axes("q_s", kPosition, kComputed, &R::q_s),
      axes("qd_s", kVelocity, kComputed, &R::qd_s),
      field("theta", "m or rad", kComputed, kSingle, path(&R::theta), FieldLabels::kJoints),
      field("coupling_error_rad", kRadians, kComputed, kSingle, path(&R::coupling_error_rad)),
      field("palm_distance_m", kMetres, kComputed, kSingle, path(&R::palm_distance_m)),
      field("palm_body", kOne, kComputed, kExact, path(&R::palm_body)),
      field("palm_target_distance_m", kMetres, kComputed, kSingle,
            path(&R::palm_target_distance_m)),
      axes("closure", kPosition, kComputed, &R::closure),
      field("body_count", kOne, kComputed, kExact, path(&R::body_count)),
      items("bodies", kSeeName, kComputed, kSingle, path(&R::bodies), path(&R::body_count),
            FieldLabels::kBodies),
      field("body_joint_count", kOne, kLength, kNot, path(&R::body_joint_count)),
      items("body_q", kPosition, kComputed, kSingle, path(&R::body_q), path(&R::body_joint_count),
            FieldLabels::kBodyJoints),
      items("body_qd", kVelocity, kComputed, kSingle, path(&R::body_qd), path(&R::body_joint_count),
            FieldLabels::kBodyJoints),
      axes("f_s", kEffort, kComputed, &R::f_s),
      axes("coupling", kEffort, kComputed, &R::coupling),
      axes("exercise_effort", kEffort, kComputed, &R::exercise, &X::effort),
      field("alpha", kOne, kComputed, kSingle, path(&R::exercise, &X::alpha)),
      axes("wall_active", kOne, kComputed, &R::exercise, &X::wall_active),
      axes("wall", kPosition, kComputed, &R::exercise, &X::wall),
      field("value_count", kOne, kLength, kNot, path(&R::exercise, &X::value_count)),
      items("exercise_values", kSeeName, kComputed, kSingle, path(&R::exercise, &X::values),
            path(&R::exercise, &X::value_count), FieldLabels::kValues),
      field("event_count", kOne, kComputed, kExact, path(&R::exercise, &X::event_count)),
      items("events", kOne, kComputed, kNot, path(&R::exercise, &X::events),
            path(&R::exercise, &X::event_count)),
      field("placement_count", kOne, kLength, kNot, path(&R::placements, &BodyPlacements::count)),
      items("placements", kOne, kInput, kNot, path(&R::placements, &BodyPlacements::items),
            path(&R::placements, &BodyPlacements::count)),
      axes("phi", kOne, kComputed, &R::phi),
      axes("damping", kEffort, kComputed, &R::damping),
      axes("tank", kJoules, kComputed, &R::tank),
      axes("tank_effort", kEffort, kComputed, &R::tank_effort),
      axes("rendered", kEffort, kComputed, &R::rendered),
      field("authority", kOne, kComputed, kSingle, path(&R::authority)),
      axes("sent", kEffort, kComputed, &R::sent),
      field("contact_count", kOne, kComputed, kExact, path(&R::contact_count)),
      field("contacts_dropped", kOne, kComputed, kExact, path(&R::contacts_dropped)),
      items("contacts", kOne, kComputed, kNot, path(&R::contacts), path(&R::contact_count))};
}();

/// The fields of an event, as in /events of a recording.
inline constexpr auto kEventFields = [] {
  using namespace record_fields;
  return std::tuple{
      field("events/type", kOne, kComputed, kExact, fieldPath(&ExerciseEvent::type)),
      field("events/index", kOne, kComputed, kExact, fieldPath(&ExerciseEvent::index)),
      field("events/value", kSeeType, kComputed, kExact, fieldPath(&ExerciseEvent::value))};
}();

/// The fields of a contact, as in /contacts of a recording.
inline constexpr auto kContactFields = [] {
  using namespace record_fields;
  return std::tuple{
      field("contacts/capsule", kOne, kComputed, kExact, fieldPath(&Contact::capsule)),
      field("contacts/link", kOne, kComputed, kExact, fieldPath(&Contact::link)),
      field("contacts/body", kOne, kComputed, kExact, fieldPath(&Contact::body)),
      field("contacts/point_m", kMetres, kComputed, kSingle, fieldPath(&Contact::point_m)),
      field("contacts/normal", kOne, kComputed, kSingle, fieldPath(&Contact::normal)),
      field("contacts/force_n", "N", kComputed, kSingle, fieldPath(&Contact::force_n)),
      field("contacts/torque_nm", "N·m", kComputed, kSingle, fieldPath(&Contact::torque_nm)),
      field("contacts/distance_m", kMetres, kComputed, kSingle, fieldPath(&Contact::distance_m))};
}();

/// Calls visit(field) for each field of a table, in order. Real-time safe if `visit` is.
template <class... Fields, class Visit>
constexpr void visitFields(const std::tuple<Fields...>& table, Visit&& visit) {
  std::apply([&visit](const auto&... fields) { (visit(fields), ...); }, table);
}

/// What a field refers to, by its type.
template <class Value>
inline constexpr bool kIsItems = false;
template <class Item, class Count>
inline constexpr bool kIsItems<FieldItems<Item, Count>> = true;
template <class Value>
inline constexpr bool kIsTaggedArray = false;
template <class Tag, int Capacity, class Number>
inline constexpr bool kIsTaggedArray<TaggedArray<Tag, Capacity, Number>> = true;

}  // namespace wholehand
