#include "renderer/parameter_ramps.hpp"

#include <algorithm>

namespace wholehand {

ParameterRamps::ParameterRamps(const std::vector<LiveParameter>& parameters)
    : count_(std::min(static_cast<int>(parameters.size()), kMaxLiveParameters)) {
  for (int i = 0; i < count_; ++i) {
    lower_[i] = parameters[i].lower;
    upper_[i] = parameters[i].upper;
    rate_per_s_[i] = parameters[i].rate_per_s;
    initial_[i] = parameters[i].value;
  }
  reset();
}

void ParameterRamps::startAt(int index, double value) noexcept {
  if (index < 0 || index >= count_) return;
  if (value >= lower_[index] && value <= upper_[index]) initial_[index] = value;  // false for NaN
}

void ParameterRamps::reset() noexcept {
  value_ = wanted_ = initial_;
}

void ParameterRamps::ask(int index, double value) noexcept {
  if (index < 0 || index >= count_) return;
  if (value >= lower_[index] && value <= upper_[index]) wanted_[index] = value;  // false for NaN
}

void ParameterRamps::advance(int elapsed_periods, double period_s) noexcept {
  for (int i = 0; i < count_; ++i) {
    const double most = rate_per_s_[i] * elapsed_periods * period_s;
    value_[i] += std::clamp(wanted_[i] - value_[i], -most, most);
  }
}

}  // namespace wholehand
