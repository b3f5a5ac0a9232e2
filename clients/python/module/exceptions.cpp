#include "exceptions.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

namespace py = pybind11;

namespace wholehand::python {
namespace {

PyObject* bad_input = nullptr;
PyObject* run_ended = nullptr;

/// The words of the program, with its options as arguments of Python: "--engine NAME" is
/// engine=NAME.
std::string inPython(std::string words) {
  for (std::size_t at = 0; (at = words.find("--", at)) != words.npos; ++at) {
    const std::size_t end = words.find_first_of(" =;,", at);
    words.erase(at, 2);
    if (end == words.npos) break;
    if (words[end - 2] == ' ') words[end - 2] = '=';
    std::replace(words.begin() + static_cast<std::ptrdiff_t>(at),
                 words.begin() + static_cast<std::ptrdiff_t>(end - 2), '-', '_');
  }
  return words;
}

}  // namespace

void addExceptions(py::module_& module) {
  bad_input = PyErr_NewException("wholehand._rig.BadInput", PyExc_ValueError, nullptr);
  run_ended = PyErr_NewException("wholehand._rig.RunEnded", PyExc_RuntimeError, nullptr);
  module.add_object("BadInput", py::reinterpret_borrow<py::object>(bad_input));
  module.add_object("RunEnded", py::reinterpret_borrow<py::object>(run_ended));
}

void refuse(Diagnostics why) {
  py::list items;
  for (Diagnostic& d : why) {
    d.key = inPython(std::move(d.key));
    d.problem = inPython(std::move(d.problem));
    d.remedy = inPython(std::move(d.remedy));
    items.append(py::dict(py::arg("file") = d.file, py::arg("line") = d.line,
                          py::arg("key") = d.key, py::arg("value") = d.value,
                          py::arg("problem") = d.problem, py::arg("remedy") = d.remedy));
  }
  py::object error = py::reinterpret_borrow<py::object>(bad_input)(format(why));
  error.attr("diagnostics") = items;
  PyErr_SetObject(bad_input, error.ptr());
  throw py::error_already_set();
}

void refuseEnded(const SimulatedRig& rig, const TickRecord& record) {
  const std::string text = any(rig.endedBy())
                               ? "the run ended at " + std::to_string(record.time_s) +
                                     " s: " + faultNames(rig.endedBy()) + "; reset() begins anew"
                               : "the rig is not armed; reset() begins anew";
  PyErr_SetString(run_ended, text.c_str());
  throw py::error_already_set();
}

}  // namespace wholehand::python
