#include "record/recording_layout.hpp"

#include "loop/core/tick_digest.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace wholehand::recording {
namespace {

using hdf5::NumberType;
using Texts = std::vector<std::string>;

/// File type for a number of the loop: double if a re-run needs it exactly, else float.
template <class T>
constexpr NumberType numberType() {
  if constexpr (std::is_same_v<T, float>) return NumberType::kFloat32;
  if constexpr (std::is_same_v<T, double>) return NumberType::kFloat64;
  if constexpr (std::is_same_v<T, std::uint64_t>) return NumberType::kUint64;
  if constexpr (std::is_same_v<T, std::int64_t>) return NumberType::kInt64;
  if constexpr (std::is_same_v<T, std::uint32_t> || std::is_same_v<T, Fault>) {
    return NumberType::kUint32;
  }
  static_assert(sizeof(T) == 4 || sizeof(T) == 8);
  return NumberType::kInt32;
}

/// Marks a missing value of an axis array that is shorter than the device (no virtual patient). It
/// is a quiet NaN with its own payload, so that a computed NaN stays distinguishable.
template <class Stored>
constexpr auto absent() {
  if constexpr (sizeof(Stored) == sizeof(std::uint32_t)) {
    return std::uint32_t{0x7FC5'7481U};
  } else {
    return std::uint64_t{0x7FFC'5748'0000'0001ULL};
  }
}

/// Accessors Row& -> T& for a member and for a member's member.
template <class Row, class T>
auto path(T Row::*member) {
  return [member](Row& row) -> T& { return row.*member; };
}
template <class Row, class Part, class T>
auto path(Part Row::*part, T Part::*member) {
  return [part, member](Row& row) -> T& { return row.*part.*member; };
}

/// Column of a plain number that `at` accesses (Row& -> T&), stored in its own type or as Stored.
template <class Row, class Stored = void, class At>
Column<Row> number(const char* name, const char* unit, At at) {
  using T = std::remove_reference_t<std::invoke_result_t<At, Row&>>;
  using S = std::conditional_t<std::is_void_v<Stored>, T, Stored>;
  Column<Row> c;
  c.name = name;
  c.type = numberType<S>();
  c.units = {unit};
  c.store = [at](const Row& row, std::byte* out) {
    const S value = static_cast<S>(at(const_cast<Row&>(row)));
    std::memcpy(out, &value, sizeof value);
  };
  c.load = [at](const std::byte* in, Row& row) {
    S value{};
    std::memcpy(&value, in, sizeof value);
    at(row) = static_cast<T>(value);
  };
  return c;
}

/// Column of a double that no re-run needs, stored in single precision.
template <class Row, class At>
Column<Row> single(const char* name, const char* unit, At at) {
  return number<Row, float>(name, unit, at);
}

/// Column of `width` contiguous numbers of the row, each stored as Stored.
template <class Row, class Stored, class At>
Column<Row> block(const char* name, std::uint64_t width, const Texts& units, const Texts& labels,
                  At at) {
  using T = std::remove_pointer_t<std::invoke_result_t<At, Row&>>;
  Column<Row> c;
  c.name = name;
  c.type = numberType<Stored>();
  c.shape = {width};
  c.units = units;
  c.labels = labels;
  c.store = [at, width](const Row& row, std::byte* out) {
    const T* values = at(const_cast<Row&>(row));
    for (std::uint64_t i = 0; i < width; ++i) {
      const auto value = static_cast<Stored>(values[i]);
      std::memcpy(out + i * sizeof value, &value, sizeof value);
    }
  };
  c.load = [at, width](const std::byte* in, Row& row) {
    T* values = at(row);
    for (std::uint64_t i = 0; i < width; ++i) {
      Stored value{};
      std::memcpy(&value, in + i * sizeof value, sizeof value);
      values[i] = static_cast<T>(value);
    }
  };
  return c;
}

/// Column with a value per axis or per joint that `at` accesses (Row& -> array&). The array may be
/// shorter than the recording's.
template <class Row, class Stored = float, class At>
Column<Row> perAxis(const char* name, At at, const Texts& units, const Texts& labels) {
  using Array = std::remove_reference_t<std::invoke_result_t<At, Row&>>;
  using Bits = decltype(absent<Stored>());
  Column<Row> c;
  c.name = name;
  c.type = numberType<Stored>();
  c.shape = {labels.size()};
  c.units = units;
  c.labels = labels;
  const int width = static_cast<int>(c.labels.size());
  c.store = [at, width](const Row& row, std::byte* out) {
    const Array& values = at(const_cast<Row&>(row));
    for (int i = 0; i < width; ++i) {
      const Stored v = i < values.size() ? static_cast<Stored>(values[i])
                                         : std::bit_cast<Stored>(absent<Stored>());
      std::memcpy(out + i * sizeof v, &v, sizeof v);
    }
  };
  c.load = [at, width](const std::byte* in, Row& row) {
    Array values(width);
    int size = 0;
    for (; size < width; ++size) {
      Stored v{};
      std::memcpy(&v, in + size * sizeof v, sizeof v);
      if (std::bit_cast<Bits>(v) == absent<Stored>()) break;
      values[size] = static_cast<typename Array::Value>(v);
    }
    Array& array = at(row);
    array = Array(size);
    std::copy_n(values.data(), size, array.data());
  };
  return c;
}

Column<TickRecord> bodyColumn(const Texts& names) {
  static_assert(sizeof(BodyState) == 13 * sizeof(double));
  auto c = block<TickRecord, float>(
      "bodies", names.size() * 13,
      {"m", "m", "m", "1", "1", "1", "1", "m/s", "m/s", "m/s", "rad/s", "rad/s", "rad/s"}, names,
      [](TickRecord& r) { return reinterpret_cast<double*>(r.bodies.data()); });
  c.shape = {names.size(), 13};
  c.columns = {"px", "py", "pz", "qx", "qy", "qz", "qw", "vx", "vy", "vz", "wx", "wy", "wz"};
  return c;
}

Texts perUnit(const Texts& units, const char* per_m, const char* per_rad) {
  Texts out;
  for (const std::string& unit : units) out.emplace_back(unit == "rad" ? per_rad : per_m);
  return out;
}

/// Column of the digest, which is computed when a row is stored. A reader gets it with
/// TableReader::loaded().
Column<TickRecord> digestColumn() {
  Column<TickRecord> c;
  c.name = kDigest;
  c.type = NumberType::kUint64;
  c.units = {"1"};
  c.store = [](const TickRecord& row, std::byte* out) {
    const std::uint64_t digest = digestOf(row);
    std::memcpy(out, &digest, sizeof digest);
  };
  c.load = [](const std::byte*, TickRecord&) {};
  return c;
}

/// Column of a number below `count`, stored as int32. Any other number in a file is read as 0,
/// which means unknown.
template <class T>
Column<TickRecord> named(const char* name, T TickRecord::*member, int count) {
  Column<TickRecord> c;
  c.name = name;
  c.type = NumberType::kInt32;
  c.units = {"1"};
  c.store = [member](const TickRecord& row, std::byte* out) {
    const auto number = static_cast<std::int32_t>(row.*member);
    std::memcpy(out, &number, sizeof number);
  };
  c.load = [member, count](const std::byte* in, TickRecord& row) {
    std::int32_t number = 0;
    std::memcpy(&number, in, sizeof number);
    row.*member = static_cast<T>(number >= 0 && number < count ? number : 0);
  };
  return c;
}

void addSessionColumns(std::vector<Column<TickRecord>>& out) {
  const auto add = [&out](auto column) { out.push_back(std::move(column)); };
  using R = TickRecord;
  add(number<R>("tick", "1", path(&R::tick)));
  add(number<R>("time_s", "s", path(&R::time_s)));
  add(number<R>("elapsed_periods", "1", path(&R::elapsed_periods)));
  add(number<R>("faults", "bits", path(&R::faults)));
  add(named("moved_by", &R::moved_by, kMovers));
  add(named("help", &R::help, kHelps));
  add(digestColumn());
  add(number<R>("lateness_ns", "ns", path(&R::lateness_ns)));
  add(number<R>("wall_ns", "ns", path(&R::wall_ns)));
  add(number<R>("cpu_ns", "ns", path(&R::cpu_ns)));
  Texts stages;
  for (int i = 0; i < kStages; ++i) stages.emplace_back(stageName(static_cast<Stage>(i)));
  add(block<R, std::int32_t>("stage_cpu_ns", kStages, {"ns"}, stages,
                             [](R& r) { return r.stage_cpu_ns.data(); }));
}

void addAxisColumns(std::vector<Column<TickRecord>>& out, const RecordingMeta& meta) {
  const Texts& names = meta.axis_names;
  const Texts position = perUnit(meta.axis_units, "m", "rad");
  const Texts velocity = perUnit(meta.axis_units, "m/s", "rad/s");
  const Texts effort = perUnit(meta.axis_units, "N", "N·m");
  const auto add = [&](const char* name, auto member, const Texts& units) {
    out.push_back(perAxis<TickRecord>(name, path(member), units, names));
  };
  out.push_back(perAxis<TickRecord, double>("q_m", path(&TickRecord::q_m), position, names));
  add("intention", &TickRecord::intention, position);
  add("patient_effort", &TickRecord::patient_effort, effort);
  add("qd_mf", &TickRecord::qd_mf, velocity);
  add("q_s", &TickRecord::q_s, position);
  add("qd_s", &TickRecord::qd_s, velocity);
  add("f_s", &TickRecord::f_s, effort);
  add("coupling", &TickRecord::coupling, effort);
  add("phi", &TickRecord::phi, {"1"});
  add("damping", &TickRecord::damping, effort);
  add("rendered", &TickRecord::rendered, effort);
  add("sent", &TickRecord::sent, effort);
}

void addExerciseColumns(std::vector<Column<TickRecord>>& out, const RecordingMeta& meta) {
  using R = TickRecord;
  const Texts& names = meta.axis_names;
  const Texts position = perUnit(meta.axis_units, "m", "rad");
  const Texts effort = perUnit(meta.axis_units, "N", "N·m");
  const auto add = [&out](auto column) { out.push_back(std::move(column)); };
  add(perAxis<R>("effort_limit", path(&R::effort_limit), effort, names));
  add(perAxis<R>("tank", path(&R::tank), {"J"}, names));
  add(perAxis<R>("tank_effort", path(&R::tank_effort), effort, names));
  add(perAxis<R>("closure", path(&R::closure), position, names));
  add(perAxis<R>("exercise_effort", path(&R::exercise, &ExerciseRecord::effort), effort, names));
  add(perAxis<R>("wall", path(&R::exercise, &ExerciseRecord::wall), position, names));
  add(perAxis<R>("wall_active", path(&R::exercise, &ExerciseRecord::wall_active), {"1"}, names));
  add(single<R>("alpha", "1", path(&R::exercise, &ExerciseRecord::alpha)));
  add(number<R>("palm_body", "1", path(&R::palm_body)));
  add(single<R>("palm_target_distance_m", "m", path(&R::palm_target_distance_m)));
  add(number<R>("event_count", "1", path(&R::exercise, &ExerciseRecord::event_count)));
  add(number<R>("command_count", "1", path(&R::command_count)));
  if (!meta.parameter_names.empty()) {
    add(block<R, double>("parameters", meta.parameter_names.size(), {"see name"},
                         meta.parameter_names, [](R& r) { return r.parameters.data(); }));
  }
  if (!meta.value_names.empty()) {
    add(block<R, float>("exercise_values", meta.value_names.size(), {"see name"}, meta.value_names,
                        [](R& r) { return r.exercise.values.data(); }));
  }
}

}  // namespace

std::vector<Column<TickRecord>> tickColumns(const RecordingMeta& meta) {
  using R = TickRecord;
  std::vector<Column<R>> out;
  addSessionColumns(out);
  addAxisColumns(out, meta);
  const auto add = [&out](auto column) { out.push_back(std::move(column)); };
  if (!meta.joint_names.empty()) {
    add(perAxis<R>("theta", path(&R::theta), {"m or rad"}, meta.joint_names));
  }
  add(single<R>("coupling_error_rad", "rad", path(&R::coupling_error_rad)));
  add(single<R>("palm_distance_m", "m", path(&R::palm_distance_m)));
  add(single<R>("authority", "1", path(&R::authority)));
  add(number<R>("body_count", "1", path(&R::body_count)));
  if (!meta.body_names.empty()) add(bodyColumn(meta.body_names));
  add(number<R>("contact_count", "1", path(&R::contact_count)));
  add(number<R>("contacts_dropped", "1", path(&R::contacts_dropped)));
  addExerciseColumns(out, meta);
  add(number<R>("safety_state", "1", path(&R::safety_state)));
  add(number<R>("fault_axis", "1", path(&R::fault_axis)));
  return out;
}

std::vector<Column<EventRow>> eventColumns() {
  using R = EventRow;
  std::vector<Column<R>> out;
  const auto add = [&out](auto column) { out.push_back(std::move(column)); };
  add(number<R>("row", "1", path(&R::row)));
  add(number<R>("type", "1", path(&R::event, &ExerciseEvent::type)));
  add(number<R>("index", "1", path(&R::event, &ExerciseEvent::index)));
  add(number<R>("value", "see type", path(&R::event, &ExerciseEvent::value)));
  return out;
}

std::vector<Column<CommandRow>> commandColumns(const RecordingMeta& meta) {
  using R = CommandRow;
  std::vector<Column<R>> out;
  const auto add = [&out](auto column) { out.push_back(std::move(column)); };
  add(number<R>("row", "1", path(&R::row)));
  add(number<R>("type", "1", path(&R::command, &Command::type)));
  add(number<R>("index", "1", path(&R::command, &Command::index)));
  add(number<R>("value", "see type", path(&R::command, &Command::value)));
  add(perAxis<R, double>("aim", path(&R::command, &Command::aim),
                         perUnit(meta.axis_units, "m", "rad"), meta.axis_names));
  if (meta.game_slots > 0) {
    add(block<R, double>("numbers", kOrderNumbers, {"see type"}, {},
                         [](R& r) { return r.command.numbers.data(); }));
  }
  return out;
}

std::vector<Column<ContactRow>> contactColumns() {
  using R = ContactRow;
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  const Texts xyz = {"x", "y", "z"};
  std::vector<Column<R>> out;
  const auto add = [&out](auto column) { out.push_back(std::move(column)); };
  add(number<R>("row", "1", path(&R::row)));
  add(number<R>("capsule", "1", path(&R::contact, &Contact::capsule)));
  add(number<R>("link", "1", path(&R::contact, &Contact::link)));
  add(number<R>("body", "1", path(&R::contact, &Contact::body)));
  add(block<R, float>("point_m", 3, {"m"}, xyz, [](R& r) { return &r.contact.point_m.x; }));
  add(block<R, float>("normal", 3, {"1"}, xyz, [](R& r) { return &r.contact.normal.x; }));
  add(block<R, float>("force_n", 3, {"N"}, xyz, [](R& r) { return &r.contact.force_n.x; }));
  add(block<R, float>("torque_nm", 3, {"N·m"}, xyz, [](R& r) { return &r.contact.torque_nm.x; }));
  add(single<R>("distance_m", "m", path(&R::contact, &Contact::distance_m)));
  return out;
}

std::uint64_t chunkRows(double period_s) noexcept {
  return static_cast<std::uint64_t>(std::clamp(std::round(1.0 / period_s), 25.0, 4000.0));
}

}  // namespace wholehand::recording
