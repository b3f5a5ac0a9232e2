#include "loop/model/device_model.hpp"

namespace wholehand {

int DeviceModel::axisIndex(const std::string& axis_name) const {
  for (int i = 0; i < axisCount(); ++i) {
    if (axes[i].name == axis_name) return i;
  }
  return -1;
}

AxisEffort DeviceModel::neutral() const {
  AxisEffort effort(axisCount());
  for (int i = 0; i < axisCount(); ++i) {
    effort[i] = axes[i].neutral_effort;
  }
  return effort;
}

}  // namespace wholehand
