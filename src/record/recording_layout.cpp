#include "record/recording_layout.hpp"

#include "loop/core/record_fields.hpp"
#include "loop/core/tick_digest.hpp"
#include "record/recording_meta.hpp"

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
    const S value = static_cast<S>(at(row));
    std::memcpy(out, &value, sizeof value);
  };
  c.load = [at](const std::byte* in, Row& row) {
    S value{};
    std::memcpy(&value, in, sizeof value);
    at(row) = static_cast<T>(value);
  };
  return c;
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
    const T* values = at(row);
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
    const auto& values = at(row);
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

/// One unit for all elements, or one per axis or joint.
template <class Path>
Texts unitsOf(const RecordingMeta& meta, const Field<Path>& field) {
  const FieldUnit& unit = field.unit;
  if (std::strcmp(unit.per_m, unit.per_rad) == 0) return {unit.per_m};
  Texts out;
  const bool of_bodies = field.labels == FieldLabels::kBodyJoints;
  for (const std::string& of : of_bodies ? meta.body_joint_units : meta.axis_units) {
    out.emplace_back(of == "rad" ? unit.per_rad : unit.per_m);
  }
  return out;
}

template <class Of>
Column<TickRecord> bodyColumn(const char* name, const Texts& names, Of bodies) {
  static_assert(sizeof(BodyState) == 13 * sizeof(double));
  auto c = block<TickRecord, float>(
      name, names.size() * 13,
      {"m", "m", "m", "1", "1", "1", "1", "m/s", "m/s", "m/s", "rad/s", "rad/s", "rad/s"}, names,
      [bodies](auto& row) { return &bodies(row).data->position_m.x; });
  c.shape = {names.size(), 13};
  c.columns = {"px", "py", "pz", "qx", "qy", "qz", "qw", "vx", "vy", "vz", "wx", "wy", "wz"};
  return c;
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
template <class At>
Column<TickRecord> named(const char* name, int count, At at) {
  Column<TickRecord> c = number<TickRecord, std::int32_t>(name, "1", at);
  c.load = [at, count](const std::byte* in, TickRecord& row) {
    std::int32_t number = 0;
    std::memcpy(&number, in, sizeof number);
    auto& value = at(row);
    value = static_cast<std::remove_reference_t<decltype(value)>>(
        number >= 0 && number < count ? number : 0);
  };
  return c;
}

/// Column of a number that names a row, or the tick of one; kNeverWritten where nothing was
/// written.
template <class Row, class At>
Column<Row> rowNumber(const RecordingMeta& meta, const char* name, At at) {
  Column<Row> c = number<Row>(name, "1", at);
  if (meta.schema >= 10) c.type = NumberType::kInt64;  // the same bits
  return c;
}

/// Adds the column of a field, if the recording has such elements.
template <class Row, class Path>
void addColumn(std::vector<Column<Row>>& out, const RecordingMeta& meta, const Field<Path>& field) {
  if (field.storage == FieldStorage::kNot) return;
  const Texts& labels = labelsOf(meta, field.labels);
  const Texts units = unitsOf(meta, field);
  if (field.labels != FieldLabels::kNone && labels.empty()) return;
  const bool exact = field.storage == FieldStorage::kExact;
  const char* const slash = std::strrchr(field.name, '/');
  const char* const name = slash == nullptr ? field.name : slash + 1;
  const Path of = field.of;
  const auto add = [&out](auto column) { out.push_back(std::move(column)); };
  using Value = std::remove_cvref_t<std::invoke_result_t<Path, Row&>>;
  if constexpr (kIsItems<Value>) {
    using Item = std::remove_cvref_t<decltype(*std::declval<Value>().data)>;
    const auto data = [of](auto& row) { return of(row).data; };
    if constexpr (std::is_same_v<Item, BodyState>) add(bodyColumn(name, labels, of));
    if constexpr (std::is_same_v<Item, double>) {
      add(exact ? block<Row, double>(name, labels.size(), units, labels, data)
                : block<Row, float>(name, labels.size(), units, labels, data));
    }
  } else if constexpr (kIsTaggedArray<Value>) {
    add(exact ? perAxis<Row, double>(name, of, units, labels)
              : perAxis<Row, float>(name, of, units, labels));
  } else if constexpr (std::is_same_v<Value, Vec3>) {
    static_assert(sizeof(Vec3) == 3 * sizeof(double));
    add(block<Row, float>(name, 3, units, {"x", "y", "z"}, [of](auto& row) { return &of(row).x; }));
  } else if constexpr (std::is_enum_v<Value> || std::is_arithmetic_v<Value>) {
    if constexpr (std::is_same_v<Value, std::uint64_t>) {
      if (exact) return add(rowNumber<Row>(meta, name, of));
    }
    if (field.below > 0) {
      if constexpr (std::is_same_v<Row, TickRecord>) add(named(name, field.below, of));
    } else if (exact) {
      add(number<Row>(name, field.unit.per_m, of));
    } else {
      add(number<Row, float>(name, field.unit.per_m, of));
    }
  } else {
    using Element = typename Value::value_type;
    add(block<Row, Element>(name, labels.size(), units, labels,
                            [of](auto& row) { return of(row).data(); }));
  }
}

constexpr int kNumbersOfSchema9 = 16;

/// Replaces the spin of a spawn order in a file of schema 9, where the last number holds the three
/// components: 17 bits each, the x component in the lowest, in steps of 1/256 rad/s.
void unpackSpin(Command& command) {
  constexpr std::int64_t kHalf = 1 << 16;
  double& packed = command.numbers[kNumbersOfSchema9 - 1];
  if (command.type != CommandType::kSpawn || !(packed >= 0.0 && packed < 0x1p51)) return;
  auto all = static_cast<std::int64_t>(packed);
  for (int i = 0; i < 3; ++i, all /= 2 * kHalf) {
    const std::int64_t steps = all % (2 * kHalf);
    command.numbers[kNumbersOfSchema9 - 1 + i] =
        static_cast<double>(steps < kHalf ? steps : steps - 2 * kHalf) / 256.0;
  }
}

/// Adds the columns of an item's fields, and before them its row of /ticks.
template <class Row, class Item, class... Fields>
std::vector<Column<Row>> itemColumns(const RecordingMeta& meta, Item Row::*item,
                                     const std::tuple<Fields...>& table) {
  std::vector<Column<Row>> out;
  out.push_back(rowNumber<Row>(meta, "row", fieldPath(&Row::row)));
  visitFields(table, [&](const auto& field) {
    const auto in_row = fieldPath(item, field.of.member);
    addColumn(out, meta,
              Field<std::remove_const_t<decltype(in_row)>>{field.name, field.unit, field.role,
                                                           field.storage, in_row});
  });
  return out;
}

}  // namespace

std::vector<Column<TickRecord>> tickColumns(const RecordingMeta& meta) {
  std::vector<Column<TickRecord>> out;
  visitFields(kRecordFields, [&](const auto& field) { addColumn(out, meta, field); });
  out.push_back(digestColumn());
  return out;
}

std::vector<Column<EventRow>> eventColumns(const RecordingMeta& meta) {
  return itemColumns(meta, &EventRow::event, kEventFields);
}

std::vector<Column<ContactRow>> contactColumns(const RecordingMeta& meta) {
  return itemColumns(meta, &ContactRow::contact, kContactFields);
}

std::vector<Column<CommandRow>> commandColumns(const RecordingMeta& meta) {
  using R = CommandRow;
  std::vector<Column<R>> out;
  const auto add = [&out](auto column) { out.push_back(std::move(column)); };
  add(rowNumber<R>(meta, "row", fieldPath(&R::row)));
  add(number<R>("type", "1", fieldPath(&R::command, &Command::type)));
  add(number<R>("index", "1", fieldPath(&R::command, &Command::index)));
  add(number<R>("value", "see type", fieldPath(&R::command, &Command::value)));
  Texts position;
  for (const std::string& unit : meta.axis_units)
    position.emplace_back(unit == "rad" ? "rad" : "m");
  add(perAxis<R, double>("aim", fieldPath(&R::command, &Command::aim), position, meta.axis_names));
  if (meta.game_slots > 0) {
    auto numbers =
        block<R, double>("numbers", meta.schema < 10 ? kNumbersOfSchema9 : kOrderNumbers,
                         {"see type"}, {}, [](auto& row) { return row.command.numbers.data(); });
    if (meta.schema < 10) {
      numbers.load = [load = numbers.load](const std::byte* in, R& row) {
        load(in, row);
        unpackSpin(row.command);
      };
    }
    add(std::move(numbers));
  }
  return out;
}

std::uint64_t chunkRows(double period_s) noexcept {
  return static_cast<std::uint64_t>(std::clamp(std::round(1.0 / period_s), 25.0, 4000.0));
}

}  // namespace wholehand::recording
