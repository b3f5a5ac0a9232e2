#pragma once

#include "loop/core/record_fields.hpp"

#include <cstdint>
#include <type_traits>

namespace wholehand {

/// Calls visit(name, numbers, count) for every value that a tick computes from its recorded inputs,
/// in the order of kRecordFields, arrays up to their size. `numbers` points to doubles. Items of
/// events and contacts are visited by member: "contacts/point_m" of the first, of the second ...
template <class Visit>
void visitComputed(const TickRecord& r, Visit&& visit) {
  const auto one = [&visit](const char* name, auto value) {
    const auto number = static_cast<double>(value);
    visit(name, &number, 1);
  };
  const auto each_member = [&](const auto& table, const auto& items) {
    visitFields(table, [&](const auto& field) {
      for (int i = 0; i < items.count; ++i) {
        const auto& value = field.of(items.data[i]);
        if constexpr (std::is_same_v<decltype(value), const Vec3&>) {
          static_assert(sizeof(Vec3) == 3 * sizeof(double));
          visit(field.name, &value.x, 3);
        } else {
          one(field.name, value);
        }
      }
    });
  };
  visitFields(kRecordFields, [&](const auto& field) {
    if (field.role != FieldRole::kComputed) return;
    const char* const name = field.name;
    const auto& value = field.of(r);
    using Value = std::remove_cvref_t<decltype(value)>;
    if constexpr (kIsItems<Value>) {
      using Item = std::remove_cvref_t<decltype(*value.data)>;
      if constexpr (std::is_same_v<Item, double>) visit(name, value.data, value.count);
      if constexpr (std::is_same_v<Item, BodyState>) {
        static_assert(sizeof(BodyState) == 13 * sizeof(double));
        visit(name, reinterpret_cast<const double*>(value.data), 13 * value.count);
      }
      if constexpr (std::is_same_v<Item, ExerciseEvent>) each_member(kEventFields, value);
      if constexpr (std::is_same_v<Item, Contact>) each_member(kContactFields, value);
    } else if constexpr (std::is_same_v<Value, AxisFlag>) {
      for (const bool flag : value) one(name, flag);
    } else if constexpr (kIsTaggedArray<Value>) {
      visit(name, value.data(), value.size());
    } else if constexpr (std::is_enum_v<Value>) {
      one(name, static_cast<std::underlying_type_t<Value>>(value));
    } else if constexpr (std::is_arithmetic_v<Value>) {
      one(name, value);
    }
  });
}

/// Digest of all values of visitComputed() and their counts: two ticks have the same digest if
/// every bit is the same. 0 and −0 differ; all NaNs count as equal. Takes 1 µs: do not call it in
/// the tick.
[[nodiscard]] std::uint64_t digestOf(const TickRecord& record) noexcept;

}  // namespace wholehand
