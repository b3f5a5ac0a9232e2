// The module wholehand._rig: rigs with a simulated device, stepped from Python. Docs of every name
// are in wholehand/_rig.pyi.
#include "arguments.hpp"
#include "bound_rigs.hpp"
#include "exceptions.hpp"
#include "loop/core/expected.hpp"
#include "record_views.hpp"

#include <cstdint>
#include <memory>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <string>
#include <utility>
#include <vector>

namespace py = pybind11;

namespace wholehand::python {
namespace {

// A property that views an array of the record with one number for each axis or joint.
template <class Of, class Array>
void addArray(py::class_<Of>& type, const char* name, Array TickRecord::*member) {
  type.def_property_readonly(name, [member](const py::object& self) {
    Of& of = self.cast<Of&>();
    const Array& array = of.records().first->*member;
    return viewOf(of.records(), py::dtype::of<double>(), array.data(), array.size(), self);
  });
}

// A property that views one number of the record.
template <class Of, class Number>
void addNumber(py::class_<Of>& type, const char* name, Number TickRecord::*member,
               const py::dtype& number) {
  type.def_property_readonly(name, [member, number](const py::object& self) {
    Of& of = self.cast<Of&>();
    return viewOfOne(of.records(), number, &(of.records().first->*member), self);
  });
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
  const py::dtype real = py::dtype::of<double>();
  const py::dtype count = py::dtype::of<std::int32_t>();
  addNumber(type, "tick", &TickRecord::tick, py::dtype::of<std::uint64_t>());
  addNumber(type, "time_s", &TickRecord::time_s, real);
  addNumber(type, "faults", &TickRecord::faults, py::dtype::of<std::uint32_t>());
  addNumber(type, "safety_state", &TickRecord::safety_state, count);
  addNumber(type, "authority", &TickRecord::authority, real);
  addNumber(type, "palm_distance_m", &TickRecord::palm_distance_m, real);
  addNumber(type, "contact_count", &TickRecord::contact_count, count);
  addArray(type, "q_m", &TickRecord::q_m);
  addArray(type, "qd_mf", &TickRecord::qd_mf);
  addArray(type, "intention", &TickRecord::intention);
  addArray(type, "patient_effort", &TickRecord::patient_effort);
  addArray(type, "q_s", &TickRecord::q_s);
  addArray(type, "qd_s", &TickRecord::qd_s);
  addArray(type, "theta", &TickRecord::theta);
  addArray(type, "f_s", &TickRecord::f_s);
  addArray(type, "coupling", &TickRecord::coupling);
  addArray(type, "phi", &TickRecord::phi);
  addArray(type, "damping", &TickRecord::damping);
  addArray(type, "rendered", &TickRecord::rendered);
  addArray(type, "sent", &TickRecord::sent);
  type.def_property_readonly("exercise_effort", [real](const py::object& self) {
    Of& of = self.cast<Of&>();
    const AxisEffort& effort = of.records().first->exercise.effort;
    return viewOf(of.records(), real, effort.data(), effort.size(), self);
  });
  type.def_property_readonly("exercise_values", [real](const py::object& self) {
    Of& of = self.cast<Of&>();
    const ExerciseRecord& exercise = of.records().first->exercise;
    return viewOf(of.records(), real, exercise.values.data(), exercise.value_count, self);
  });
  type.def_property_readonly("bodies", [](const py::object& self) {
    Of& of = self.cast<Of&>();
    const TickRecord& record = *of.records().first;
    return viewOf(of.records(), bodyType(), record.bodies.data(), record.body_count, self);
  });
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
  type.def(py::init([](Own... values, std::string device, std::string hand, std::string scene,
                       std::string exercise, int level, std::string patient, std::string rendering,
                       std::string motion, std::string engine, double rate_hz, bool uncertified,
                       std::uint64_t seed) {
             const RigArguments arguments{std::move(device),
                                          std::move(hand),
                                          std::move(scene),
                                          std::move(exercise),
                                          level,
                                          std::move(patient),
                                          std::move(rendering),
                                          std::move(motion),
                                          std::move(engine),
                                          rate_hz,
                                          uncertified,
                                          seed};
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
  auto rigs = addRigs<ManyRigs, int, int>(module, "VectorRig", py::arg("n"), py::kw_only(),
                                          py::arg("threads"));
  rigs.def("reset", &ManyRigs::reset, py::arg("seeds"));
  rigs.def("reset_one", &ManyRigs::resetOne, py::arg("rig"), py::arg("seed") = 0);
  rigs.def("__len__", &ManyRigs::size);
  rigs.def_property_readonly("threads", &ManyRigs::threads);
}
