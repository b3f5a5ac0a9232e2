#include "arguments.hpp"

#include "loop/patient/steered_player.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>

namespace py = pybind11;

namespace wholehand::python {
namespace {

std::string shown(py::handle value) {
  return py::cast<std::string>(py::str(value));
}

/// "name = value: ", a long value cut.
std::string named(const char* name, py::handle value) {
  constexpr Py_ssize_t kLongest = 100;
  const py::str whole = py::repr(value);
  const auto begin = py::reinterpret_steal<py::str>(PyUnicode_Substring(whole.ptr(), 0, kLongest));
  const bool cut = PyUnicode_GetLength(whole.ptr()) > kLongest;
  return std::string(name) + " = " + py::cast<std::string>(begin) + (cut ? "...: " : ": ");
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
  throw py::value_error("aim has the shape " + shown(aim.attr("shape")) + "; must be " + wanted +
                        ", an axis each: " + joined(axisNames(models)));
}

}  // namespace

RigFiles filesOf(RigArguments arguments) {
  const double rate_hz = arguments.rate_hz;
  if (!(rate_hz >= 100.0 && rate_hz <= 16000.0)) {
    throw py::value_error("rate_hz = " + std::to_string(rate_hz) + ": must be in [100, 16000] Hz");
  }
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
  PyErr_Clear();
  int beyond = 0;
  const long long as_signed = whole ? PyLong_AsLongLongAndOverflow(whole.ptr(), &beyond) : -1;
  const bool negative = beyond < 0 || (beyond == 0 && as_signed < 0);
  const std::uint64_t number =
      whole && !negative ? PyLong_AsUnsignedLongLong(whole.ptr()) : std::uint64_t{0};
  const bool fits = PyErr_Occurred() == nullptr;
  PyErr_Clear();
  if (whole && !negative && fits && number >= least && number <= most) return number;
  const bool too_large = whole && !negative && (!fits || number > most);
  throw py::value_error(named(name, value) + "must be a whole number " +
                        (too_large
                             ? "in [" + std::to_string(least) + ", " + std::to_string(most) + "]"
                             : ">= " + std::to_string(least)));
}

double numberOf(const char* name, const py::object& value) {
  const double number = PyFloat_AsDouble(value.ptr());
  if (PyErr_Occurred() == nullptr) return number;
  PyErr_Clear();
  throw py::type_error(named(name, value) + "must be a number");
}

bool flagOf(const char* name, const py::object& value) {
  const bool of_numpy =
      py::cast<std::string>(py::type::of(value).attr("__module__")) == "numpy" &&
      py::cast<std::string>(py::type::of(value).attr("__name__")).starts_with("bool");
  if (PyBool_Check(value.ptr()) || of_numpy) return PyObject_IsTrue(value.ptr()) == 1;
  throw py::type_error(named(name, value) + "must be True or False");
}

std::string textOf(const char* name, const py::object& value) {
  if (PyUnicode_Check(value.ptr()) == 0)
    throw py::type_error(named(name, value) + "must be a text");
  Py_ssize_t size = 0;
  const char* const text = PyUnicode_AsUTF8AndSize(value.ptr(), &size);
  if (text != nullptr && std::string_view(text, size).find('\0') == std::string_view::npos) {
    return {text, static_cast<std::size_t>(size)};
  }
  PyErr_Clear();
  throw py::value_error(named(name, value) + "must be a text in UTF-8 without zeros");
}

int rigOf(const py::object& value, int rigs) {
  const auto whole = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
  PyErr_Clear();
  if (!whole) throw py::value_error(named("rig", value) + "must be a whole number");
  const long long rig = PyLong_AsLongLong(whole.ptr());  // -1 beyond its range
  PyErr_Clear();
  if (rig >= 0 && rig < rigs) return static_cast<int>(rig);
  throw py::index_error(named("rig", whole) + "must be in 0 .. " + std::to_string(rigs - 1));
}

std::vector<std::uint64_t> seedsOf(const py::object& seeds, int rigs) {
  const std::string wanted = "must have one for each of " + std::to_string(rigs) + " rigs";
  if (PySequence_Check(seeds.ptr()) == 0 || PyUnicode_Check(seeds.ptr()) != 0) {
    throw py::type_error(named("seeds", seeds) + "is not a list of whole numbers; " + wanted);
  }
  const auto count = PySequence_Size(seeds.ptr());
  PyErr_Clear();  // an array without dimensions has no size
  if (count != rigs) {
    throw py::value_error("seeds has " + std::to_string(std::max<Py_ssize_t>(count, 0)) +
                          " numbers; " + wanted);
  }
  std::vector<std::uint64_t> all;
  for (int i = 0; i < rigs; ++i) {
    const auto item = py::reinterpret_steal<py::object>(PySequence_GetItem(seeds.ptr(), i));
    if (!item) throw py::error_already_set();
    all.push_back(wholeOf(("seeds[" + std::to_string(i) + "]").c_str(), item));
  }
  return all;
}

Numbers aimsOf(py::handle aim, const Models& models, py::ssize_t rigs) {
  const py::ssize_t axes = models.device.axisCount();
  // Of a masked array NumPy would hand over the values beneath the mask.
  if (py::hasattr(aim, "mask") &&
      py::cast<bool>(py::module_::import("numpy").attr("any")(aim.attr("mask")))) {
    throw py::value_error("aim has masked values; fill them: aim.filled(...)");
  }
  const py::object given = py::array::ensure(aim);
  PyErr_Clear();
  // Numbers as texts, and complex ones, would be converted.
  const std::string kinds = "biufO";
  const bool real =
      given && kinds.find(py::cast<std::string>(given.attr("dtype").attr("kind"))) != kinds.npos;
  Numbers numbers = Numbers::ensure(real ? given : py::object());
  if (!numbers) {
    PyErr_Clear();
    throw py::type_error(named("aim", aim) + "is not an array of numbers");
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
