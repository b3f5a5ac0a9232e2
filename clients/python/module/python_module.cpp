// The module wholehand._rig: rigs with a simulated device, stepped from Python. Docs of every name
// are in wholehand/_rig.pyi.
#include "arguments.hpp"
#include "bound_rigs.hpp"
#include "exceptions.hpp"
#include "loop/core/expected.hpp"
#include "loop/core/record_fields.hpp"
#include "record_views.hpp"

#include <cstdint>
#include <memory>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace py = pybind11;

namespace wholehand::python {
namespace {

// A property that views a field of the record, if Python sees such fields.
template <class Of, class Path>
void addField(py::class_<Of>& type, const Field<Path>& field) {
  using Value = std::remove_cvref_t<std::invoke_result_t<Path, const TickRecord&>>;
  // Clocks and lengths tell nothing; effort_limit is the device's, as the axes' other limits.
  const bool seen = field.role == FieldRole::kInput || field.role == FieldRole::kComputed;
  if (!seen || std::string_view(field.name) == "effort_limit") return;
  const auto add = [&](auto view) {
    type.def_property_readonly(field.name, [view, of = field.of](const py::object& self) {
      Of& rigs = self.cast<Of&>();
      const TickRecord& first = *rigs.records().first;
      return view(rigs.records(), of(first), self);
    });
  };
  if constexpr (kIsItems<Value>) {
    using Item = std::remove_cvref_t<decltype(*std::declval<Value>().data)>;
    constexpr bool kReals = std::is_same_v<Item, double>;
    if constexpr (kReals || std::is_same_v<Item, BodyState>) {
      add([](const Records& records, const Value& items, const py::object& self) {
        const py::dtype item = kReals ? py::dtype::of<double>() : bodyType();
        return viewOf(records, item, items.data, items.count, self);
      });
    }
  } else if constexpr (kIsTaggedArray<Value>) {
    add([](const Records& records, const Value& array, const py::object& self) {
      return viewOf(records, py::dtype::of<typename Value::Value>(), array.data(), array.size(),
                    self);
    });
  } else if constexpr (std::is_enum_v<Value> || std::is_arithmetic_v<Value>) {
    add([](const Records& records, const Value& number, const py::object& self) {
      if constexpr (std::is_enum_v<Value>) {
        return viewOfOne(records, py::dtype::of<std::underlying_type_t<Value>>(), &number, self);
      } else {
        return viewOfOne(records, py::dtype::of<Value>(), &number, self);
      }
    });
  }
}

template <class Of, class Value>
void addAxisFacts(py::class_<Of>& type, const char* name, Value DeviceAxis::*member) {
  type.def_property_readonly(name, [member](const Of& of) {
    py::array_t<double> values(of.models().device.axisCount());
    for (int a = 0; a < of.models().device.axisCount(); ++a) {
      values.mutable_at(a) = of.models().device.axes[a].*member;
    }
    return values;
  });
}

template <class Of>
void addFacts(py::class_<Of>& type) {
  type.def_property_readonly("axis_names", [](const Of& of) { return axisNames(of.models()); });
  type.def_property_readonly("axis_units", [](const Of& of) {
    std::vector<std::string> units;
    for (const DeviceAxis& axis : of.models().device.axes) units.emplace_back(axis.positionUnit());
    return units;
  });
  addAxisFacts(type, "lower", &DeviceAxis::lower);
  addAxisFacts(type, "upper", &DeviceAxis::upper);
  addAxisFacts(type, "speed_limit", &DeviceAxis::speed_limit);
  addAxisFacts(type, "effort_limit", &DeviceAxis::effort_limit);
  type.def_property_readonly("joint_names",
                             [](const Of& of) { return of.models().hand.joint_names; });
  type.def_property_readonly("body_names", [](const Of& of) {
    std::vector<std::string> names;
    for (const SceneBody& body : of.models().scene.bodies) names.push_back(body.name);
    return names;
  });
  type.def_property_readonly("value_names", [](const Of& of) {
    return of.models().exercise ? of.models().exercise->description().value_names
                                : std::vector<std::string>{};
  });
  type.def_property_readonly("period_s", [](const Of& of) { return of.options().period_s; });
  type.def_property_readonly("engine", [](const Of& of) { return of.options().engine; });
}

template <class Of>
void addState(py::class_<Of>& type) {
  visitFields(kRecordFields, [&type](const auto& field) { addField(type, field); });
  type.def_property_readonly(
      "contacts", [](const py::object& self) { return self.cast<Of&>().contacts(self); });
}

// Binds what Rig and VectorRig share: the arguments of the constructor, facts and state.
// What differs from the files of a scene, or is not applied, as a warning at the caller's line.
void warn(const Diagnostics& notices) {
  constexpr int kCallerOfRig = 2;  // beyond wholehand/rig.py
  for (const Diagnostic& notice : notices) {
    if (PyErr_WarnEx(PyExc_UserWarning, format(notice).c_str(), kCallerOfRig) != 0) {
      throw py::error_already_set();
    }
  }
}

// @tparam Own arguments of Of's constructor after RigArguments, first in Python
// @param own pybind11's names of them, and where keyword-only arguments begin
template <class Of, class... Own, class... Extra>
py::class_<Of> addRigs(py::module_& module, const char* name, const Extra&... own) {
  py::class_<Of> type(module, name);
  using Given = const py::object&;
  type.def(py::init([](Own... values, Given device, Given hand, Given scene, Given exercise,
                       Given level, Given patient, Given rendering, Given motion, Given engine,
                       Given rate_hz, Given uncertified, Given seed) {
             constexpr std::uint64_t kMostLevel = 1000;  // as of the program
             const RigArguments arguments{textOf("device", device),
                                          textOf("hand", hand),
                                          textOf("scene", scene),
                                          textOf("exercise", exercise),
                                          static_cast<int>(wholeOf("level", level, 1, kMostLevel)),
                                          textOf("patient", patient),
                                          textOf("rendering", rendering),
                                          textOf("motion", motion),
                                          textOf("engine", engine),
                                          numberOf("rate_hz", rate_hz),
                                          flagOf("uncertified", uncertified),
                                          wholeOf("seed", seed)};
             auto made = std::make_unique<Of>(arguments, values...);
             warn(made->models().scene.notices);
             return made;
           }),
           own..., py::arg("device"), py::arg("hand"), py::arg("scene"), py::arg("exercise"),
           py::arg("level"), py::arg("patient"), py::arg("rendering"), py::arg("motion"),
           py::arg("engine"), py::arg("rate_hz"), py::arg("uncertified"), py::arg("seed"));
  type.def("step", &Of::step, py::arg("aim") = py::none(), py::arg("n") = 1);
  type.def_property_readonly("running", &Of::running);
  type.def_property_readonly("ended_by", &Of::endedBy);
  addFacts(type);
  addState(type);
  return type;
}

}  // namespace
}  // namespace wholehand::python

PYBIND11_MODULE(_rig, module) {
  using namespace wholehand::python;
  addExceptions(module);
  auto rig = addRigs<OneRig>(module, "Rig", py::kw_only());
  rig.def("reset", &OneRig::reset, py::arg("seed") = 0);
  rig.def("close", &OneRig::close);
  rig.def("_history", &OneRig::history);
  rig.def("_run_again", &OneRig::runAgain, py::arg("seed"), py::arg("ticks"), py::arg("aims"));
  auto rigs = addRigs<ManyRigs, const py::object&, const py::object&>(
      module, "VectorRig", py::arg("n"), py::kw_only(), py::arg("threads"));
  rigs.def("reset", &ManyRigs::reset, py::arg("seeds"));
  rigs.def("reset_one", &ManyRigs::resetOne, py::arg("rig"), py::arg("seed") = 0);
  rigs.def("__len__", &ManyRigs::size);
  rigs.def_property_readonly("threads", &ManyRigs::threads);
}
