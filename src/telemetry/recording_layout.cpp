#include "telemetry/recording_layout.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace wholehand::recording {
namespace {

using hdf5::NumberType;
using Texts = std::vector<std::string>;

/// Marks a missing value: an axis array shorter than the device (no virtual patient). A quiet NaN
/// with its own payload, so that a computed NaN stays distinguishable.
constexpr std::uint64_t kAbsent = 0x7FFC'5748'0000'0001ULL;

template <class T>
constexpr NumberType numberType() {
  if constexpr (std::is_same_v<T, double>) return NumberType::kFloat64;
  if constexpr (std::is_same_v<T, std::uint64_t>) return NumberType::kUint64;
  if constexpr (std::is_same_v<T, std::int64_t>) return NumberType::kInt64;
  if constexpr (std::is_same_v<T, std::uint32_t> || std::is_same_v<T, Fault>) {
    return NumberType::kUint32;
  }
  static_assert(sizeof(T) == 4 || sizeof(T) == 8);
  return NumberType::kInt32;
}

/// A plain number of a row, reached by `at`: Row& -> T&.
template <class Row, class At>
Column<Row> number(const char* name, const char* unit, At at) {
  using T = std::remove_reference_t<std::invoke_result_t<At, Row&>>;
  Column<Row> c;
  c.name = name;
  c.type = numberType<T>();
  c.units = {unit};
  c.store = [at](const Row& row, std::byte* out) {
    std::memcpy(out, &at(const_cast<Row&>(row)), sizeof(T));
  };
  c.load = [at](const std::byte* in, Row& row) { std::memcpy(&at(row), in, sizeof(T)); };
  return c;
}

/// A block of doubles or int32 that lies contiguous in the row.
template <class Row, class At>
Column<Row> block(const char* name, std::uint64_t width, const Texts& units, const Texts& labels,
                  At at) {
  using T = std::remove_pointer_t<std::invoke_result_t<At, Row&>>;
  Column<Row> c;
  c.name = name;
  c.type = numberType<T>();
  c.shape = {width};
  c.units = units;
  c.labels = labels;
  const std::size_t bytes = width * sizeof(T);
  c.store = [at, bytes](const Row& row, std::byte* out) {
    std::memcpy(out, at(const_cast<Row&>(row)), bytes);
  };
  c.load = [at, bytes](const std::byte* in, Row& row) { std::memcpy(at(row), in, bytes); };
  return c;
}

/// A value per axis or per joint, reached by `at`: Row& -> array&; the array may be shorter than
/// the recording's.
template <class Row, class At>
Column<Row> perAxis(const char* name, At at, const Texts& units, const Texts& labels) {
  using Array = std::remove_reference_t<std::invoke_result_t<At, Row&>>;
  Column<Row> c;
  c.name = name;
  c.shape = {labels.size()};
  c.units = units;
  c.labels = labels;
  const int width = static_cast<int>(c.labels.size());
  c.store = [at, width](const Row& row, std::byte* out) {
    const Array& values = at(const_cast<Row&>(row));
    for (int i = 0; i < width; ++i) {
      const double v =
          i < values.size() ? static_cast<double>(values[i]) : std::bit_cast<double>(kAbsent);
      std::memcpy(out + i * sizeof v, &v, sizeof v);
    }
  };
  c.load = [at, width](const std::byte* in, Row& row) {
    Array values(width);
    int size = 0;
    for (; size < width; ++size) {
      double v = 0.0;
      std::memcpy(&v, in + size * sizeof v, sizeof v);
      if (std::bit_cast<std::uint64_t>(v) == kAbsent) break;
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
  auto c = block<TickRecord>(
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

void addSessionColumns(std::vector<Column<TickRecord>>& out) {
  const auto add = [&out](auto column) { out.push_back(std::move(column)); };
  using R = TickRecord;
  add(number<R>(
      "tick", "1", [](R & r) -> auto& { return r.tick; }));
  add(number<R>(
      "time_s", "s", [](R & r) -> auto& { return r.time_s; }));
  add(number<R>(
      "elapsed_periods", "1", [](R & r) -> auto& { return r.elapsed_periods; }));
  add(number<R>(
      "faults", "bits", [](R & r) -> auto& { return r.faults; }));
  add(number<R>(
      "lateness_ns", "ns", [](R & r) -> auto& { return r.lateness_ns; }));
  add(number<R>(
      "wall_ns", "ns", [](R & r) -> auto& { return r.wall_ns; }));
  add(number<R>(
      "cpu_ns", "ns", [](R & r) -> auto& { return r.cpu_ns; }));
  Texts stages;
  for (int i = 0; i < kStages; ++i) stages.emplace_back(stageName(static_cast<Stage>(i)));
  add(block<R>("stage_cpu_ns", kStages, {"ns"}, stages,
               [](R& r) { return r.stage_cpu_ns.data(); }));
}

void addAxisColumns(std::vector<Column<TickRecord>>& out, const RecordingMeta& meta) {
  const Texts& names = meta.axis_names;
  const Texts position = perUnit(meta.axis_units, "m", "rad");
  const Texts velocity = perUnit(meta.axis_units, "m/s", "rad/s");
  const Texts effort = perUnit(meta.axis_units, "N", "N·m");
  const auto add = [&](const char* name, auto member, const Texts& units) {
    out.push_back(perAxis<TickRecord>(
        name, [member](TickRecord & r) -> auto& { return r.*member; }, units, names));
  };
  add("q_m", &TickRecord::q_m, position);
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
  add(perAxis<R>(
      "effort_limit", [](R & r) -> auto& { return r.effort_limit; }, effort, names));
  add(perAxis<R>(
      "tank", [](R & r) -> auto& { return r.tank; }, {"J"}, names));
  add(perAxis<R>(
      "tank_effort", [](R & r) -> auto& { return r.tank_effort; }, effort, names));
  add(perAxis<R>(
      "closure", [](R & r) -> auto& { return r.closure; }, position, names));
  add(perAxis<R>(
      "exercise_effort", [](R & r) -> auto& { return r.exercise.effort; }, effort, names));
  add(perAxis<R>(
      "wall", [](R & r) -> auto& { return r.exercise.wall; }, position, names));
  add(perAxis<R>(
      "wall_active", [](R & r) -> auto& { return r.exercise.wall_active; }, {"1"}, names));
  add(number<R>(
      "alpha", "1", [](R & r) -> auto& { return r.exercise.alpha; }));
  add(number<R>(
      "palm_body", "1", [](R & r) -> auto& { return r.palm_body; }));
  add(number<R>(
      "palm_target_distance_m", "m", [](R & r) -> auto& { return r.palm_target_distance_m; }));
  add(number<R>(
      "event_count", "1", [](R & r) -> auto& { return r.exercise.event_count; }));
  add(number<R>(
      "command_count", "1", [](R & r) -> auto& { return r.command_count; }));
  if (!meta.parameter_names.empty()) {
    add(block<R>("parameters", meta.parameter_names.size(), {"see name"}, meta.parameter_names,
                 [](R& r) { return r.parameters.data(); }));
  }
  if (!meta.value_names.empty()) {
    add(block<R>("exercise_values", meta.value_names.size(), {"see name"}, meta.value_names,
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
    add(perAxis<R>(
        "theta", [](R & r) -> auto& { return r.theta; }, {"m or rad"}, meta.joint_names));
  }
  add(number<R>(
      "coupling_error_rad", "rad", [](R & r) -> auto& { return r.coupling_error_rad; }));
  add(number<R>(
      "palm_distance_m", "m", [](R & r) -> auto& { return r.palm_distance_m; }));
  add(number<R>(
      "authority", "1", [](R & r) -> auto& { return r.authority; }));
  add(number<R>(
      "body_count", "1", [](R & r) -> auto& { return r.body_count; }));
  if (!meta.body_names.empty()) add(bodyColumn(meta.body_names));
  add(number<R>(
      "contact_count", "1", [](R & r) -> auto& { return r.contact_count; }));
  add(number<R>(
      "contacts_dropped", "1", [](R & r) -> auto& { return r.contacts_dropped; }));
  addExerciseColumns(out, meta);
  if (meta.schema >= 3) {
    add(number<R>(
        "safety_state", "1", [](R & r) -> auto& { return r.safety_state; }));
    add(number<R>(
        "fault_axis", "1", [](R & r) -> auto& { return r.fault_axis; }));
  }
  return out;
}

std::vector<Column<EventRow>> eventColumns() {
  using R = EventRow;
  std::vector<Column<R>> out;
  const auto add = [&out](auto column) { out.push_back(std::move(column)); };
  add(number<R>(
      "row", "1", [](R & r) -> auto& { return r.row; }));
  add(number<R>(
      "type", "1", [](R & r) -> auto& { return r.event.type; }));
  add(number<R>(
      "index", "1", [](R & r) -> auto& { return r.event.index; }));
  add(number<R>(
      "value", "see type", [](R & r) -> auto& { return r.event.value; }));
  return out;
}

std::vector<Column<CommandRow>> commandColumns(const RecordingMeta& meta) {
  using R = CommandRow;
  std::vector<Column<R>> out;
  const auto add = [&out](auto column) { out.push_back(std::move(column)); };
  add(number<R>(
      "row", "1", [](R & r) -> auto& { return r.row; }));
  add(number<R>(
      "type", "1", [](R & r) -> auto& { return r.command.type; }));
  add(number<R>(
      "index", "1", [](R & r) -> auto& { return r.command.index; }));
  add(number<R>(
      "value", "see type", [](R & r) -> auto& { return r.command.value; }));
  add(perAxis<R>(
      "aim", [](R & r) -> auto& { return r.command.aim; }, perUnit(meta.axis_units, "m", "rad"),
      meta.axis_names));
  if (meta.game_slots > 0) {
    add(block<R>("numbers", kOrderNumbers, {"see type"}, {},
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
  add(number<R>(
      "row", "1", [](R & r) -> auto& { return r.row; }));
  add(number<R>(
      "capsule", "1", [](R & r) -> auto& { return r.contact.capsule; }));
  add(number<R>(
      "link", "1", [](R & r) -> auto& { return r.contact.link; }));
  add(number<R>(
      "body", "1", [](R & r) -> auto& { return r.contact.body; }));
  add(block<R>("point_m", 3, {"m"}, xyz, [](R& r) { return &r.contact.point_m.x; }));
  add(block<R>("normal", 3, {"1"}, xyz, [](R& r) { return &r.contact.normal.x; }));
  add(block<R>("force_n", 3, {"N"}, xyz, [](R& r) { return &r.contact.force_n.x; }));
  add(block<R>("torque_nm", 3, {"N·m"}, xyz, [](R& r) { return &r.contact.torque_nm.x; }));
  add(number<R>(
      "distance_m", "m", [](R & r) -> auto& { return r.contact.distance_m; }));
  return out;
}

hdf5::Handle elementType(const ColumnShape& column, bool in_memory) {
  const NumberType type = column.fileType();
  const hid_t number = in_memory ? hdf5::memoryType(type) : hdf5::fileType(type);
  if (!column.row_elements) return {H5Tcopy(number), H5Tclose};
  const std::vector<hsize_t> dims(column.shape.begin(), column.shape.end());
  return {H5Tarray_create2(number, static_cast<unsigned>(dims.size()), dims.data()), H5Tclose};
}

std::uint64_t chunkRows(double period_s) noexcept {
  return static_cast<std::uint64_t>(std::clamp(std::round(0.25 / period_s), 25.0, 1000.0));
}

}  // namespace wholehand::recording
