#include "arguments.hpp"

#include "loop/patient/steered_player.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace py = pybind11;

namespace wholehand::python {
namespace {

std::string textOf(py::handle value) {
  return py::cast<std::string>(py::str(value));
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

[[noreturn]] void refuseShape(const Numbers& aim, const Models& models, py::ssize_t rigs) {
  const std::string axes = std::to_string(models.device.axisCount());
  const std::string wanted =
      rigs == 0 ? "(" + axes + ",)" : "(" + std::to_string(rigs) + ", " + axes + ")";
  throw py::value_error("aim has the shape " + textOf(aim.attr("shape")) + "; must be " + wanted +
                        ", an axis each: " + joined(axisNames(models)));
}

}  // namespace

RigFiles filesOf(RigArguments arguments) {
  const double rate_hz = arguments.rate_hz;
  if (!(rate_hz >= 100.0 && rate_hz <= 16000.0)) {
    throw py::value_error("rate_hz = " + std::to_string(rate_hz) + ": must be in [100, 16000] Hz");
  }
  checkAtLeast("level", arguments.level, 1);
  RigFiles from;
  from.files = {std::move(arguments.scene),    std::move(arguments.hand),
                std::move(arguments.device),   std::move(arguments.rendering),
                std::move(arguments.patient),  std::move(arguments.motion),
                std::move(arguments.exercise), arguments.level};
  from.options.period_s = 1.0 / rate_hz;
  if (!arguments.engine.empty()) from.options.engine = std::move(arguments.engine);
  from.options.uncertified = arguments.uncertified;
  return from;
}

std::uint64_t wholeOf(const char* name, const py::object& value, std::uint64_t least,
                      std::uint64_t most) {
  const auto whole = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
  const std::uint64_t number = whole ? PyLong_AsUnsignedLongLong(whole.ptr()) : 0;
  if (PyErr_Occurred() == nullptr && number >= least && number <= most) return number;
  PyErr_Clear();
  throw py::value_error(std::string(name) + " = " + textOf(py::repr(value)) +
                        ": must be a whole number in [" + std::to_string(least) + ", " +
                        std::to_string(most) + "]");
}

void checkAtLeast(const char* name, int value, int least, const char* unit) {
  if (value >= least) return;
  throw py::value_error(std::string(name) + " = " + std::to_string(value) + ": must be at least " +
                        std::to_string(least) + unit);
}

void checkRig(int rig, int rigs) {
  if (rig >= 0 && rig < rigs) return;
  throw py::index_error("rig = " + std::to_string(rig) + ": must be in 0 .. " +
                        std::to_string(rigs - 1));
}

Numbers aimsOf(py::handle aim, const Models& models, py::ssize_t rigs) {
  const py::ssize_t axes = models.device.axisCount();
  Numbers numbers = Numbers::ensure(aim);
  if (!numbers) {
    PyErr_Clear();
    throw py::type_error("aim = " + textOf(py::repr(aim)) + ": is not an array of numbers");
  }
  const bool fits =
      rigs == 0 ? numbers.ndim() == 1 && numbers.shape(0) == axes
                : numbers.ndim() == 2 && numbers.shape(0) == rigs && numbers.shape(1) == axes;
  if (!fits) refuseShape(numbers, models, rigs);
  for (py::ssize_t i = 0; i < numbers.size(); ++i) {
    const double value = numbers.data()[i];
    if (std::isfinite(value)) continue;
    const int axis = static_cast<int>(i % axes);
    throw py::value_error("aim[" + (rigs == 0 ? "" : std::to_string(i / axes) + ", ") +
                          std::to_string(axis) + "] (" + models.device.axes[axis].name +
                          ") = " + std::to_string(value) + ": is not finite");
  }
  for (int rig = 0; rig < numbers.size() / axes; ++rig) {
    const AxisPosition one = aimOf(numbers, rig, static_cast<int>(axes));
    const int far = firstFarAim(models.device, one);
    if (far < 0) continue;
    throw py::value_error("aim: " + farAimText(models.device.axes[far], one[far]));
  }
  return numbers;
}

AxisPosition aimOf(const Numbers& aims, int rig, int axes) {
  AxisPosition aim(axes);
  std::copy_n(aims.data() + rig * axes, axes, aim.data());
  return aim;
}

std::vector<std::string> axisNames(const Models& models) {
  std::vector<std::string> names;
  for (const DeviceAxis& axis : models.device.axes) names.push_back(axis.name);
  return names;
}

}  // namespace wholehand::python
