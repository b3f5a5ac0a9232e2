#include "loop/core/active_time.hpp"

#include "loop/core/geometry.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace wholehand {
namespace {

constexpr double kWithin_s = 2.0;
constexpr double kRounding_s = 1e-6;  // of times
constexpr double kMove_m = 1e-3, kMove_rad = kDeg;

int indexOf(const std::vector<std::string>& names, std::string_view name) {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

double valueAt(const TickRecord& record, int index) noexcept {
  return index >= 0 && index < record.exercise.value_count ? record.exercise.values[index] : 0.0;
}

}  // namespace

ActiveTime::ActiveTime(const std::vector<std::string>& axis_units,
                       const std::vector<std::string>& value_names)
    : least_move_(static_cast<int>(std::min<std::size_t>(axis_units.size(), kMaxAxes))),
      paused_value_(indexOf(value_names, kPausedValue)),
      grip_value_(indexOf(value_names, kGripForceValue)) {
  for (int i = 0; i < least_move_.size(); ++i) {
    least_move_[i] = axis_units[static_cast<std::size_t>(i)] == "m" ? kMove_m : kMove_rad;
  }
}

bool ActiveTime::interrupted(const TickRecord& record) const noexcept {
  return any(record.faults & Fault::kHolderSilent) || valueAt(record, paused_value_) > 0.5;
}

ActiveTime::Kind ActiveTime::kindOf(const TickRecord& record) const noexcept {
  if (record.moved_by != Mover::kPerson || interrupted(record)) return Kind::kNone;
  return record.help == Help::kFull ? Kind::kLed : Kind::kOwn;
}

// True when the hand is away from where it last moved; keeps the new position.
bool ActiveTime::leaves(const AxisPosition& at) noexcept {
  const bool first = last_.size() != at.size();
  bool away = false;
  for (int i = 0; i < at.size() && !first; ++i) {
    if (!std::isfinite(last_[i])) last_[i] = at[i];
    const double least = i < least_move_.size() ? least_move_[i] : kMove_m;
    away = away || std::abs(at[i] - last_[i]) >= least;
  }
  if (first || away) last_ = at;
  return away;
}

bool ActiveTime::moves(const TickRecord& record) noexcept {
  const bool simulated = record.intention.size() > 0 && std::isfinite(record.intention[0]);
  if (!simulated) return leaves(record.q_m) || valueAt(record, grip_value_) >= kLeastGrip_n;
  for (int i = 0; i < record.command_count; ++i) {
    aimed_ = aimed_ || record.commands[i].type == CommandType::kAim;
  }
  return leaves(record.intention) && aimed_;
}

void ActiveTime::add(const TickRecord& record) noexcept {
  const Kind kind = kindOf(record);
  if (kind != kind_) {
    kind_ = kind;
    aimed_ = false;
    last_ = {};
    moved_s_ = -std::numeric_limits<double>::infinity();
  }
  if (kind == Kind::kNone) return;
  if (moves(record)) moved_s_ = record.time_s;
  if (record.time_s - moved_s_ > kWithin_s + kRounding_s) return;
  const std::uint64_t periods = std::max<std::uint32_t>(record.elapsed_periods, 1);
  (kind == Kind::kLed ? periods_.led : periods_.active) += periods;
  if (record.help == Help::kSome && kind == Kind::kOwn) periods_.helped += periods;
}

}  // namespace wholehand
