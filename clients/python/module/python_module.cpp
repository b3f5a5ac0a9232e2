// The module wholehand._rig: rigs with a simulated device, stepped from Python. Docs of every name
// are in wholehand/_rig.pyi.
#include "record_views.hpp"
#include "simulated_rig.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <string>
#include <utility>
#include <vector>

namespace py = pybind11;

namespace wholehand::python {
namespace {

constexpr int kBetweenSignals = 1024;  // ticks between two looks at Ctrl-C

PyObject* bad_input = nullptr;  // the types of the exceptions; they live as long as the process
PyObject* run_ended = nullptr;

[[noreturn]] void refuse(const Diagnostics& why) {
  py::list items;
  for (const Diagnostic& d : why) {
    items.append(py::dict(py::arg("file") = d.file, py::arg("line") = d.line,
                          py::arg("key") = d.key, py::arg("value") = d.value,
                          py::arg("problem") = d.problem, py::arg("remedy") = d.remedy));
  }
  py::object error = py::reinterpret_borrow<py::object>(bad_input)(format(why));
  error.attr("diagnostics") = items;
  PyErr_SetObject(bad_input, error.ptr());
  throw py::error_already_set();
}

template <class T>
T valueOr(Expected<T> result) {
  if (!result) refuse(result.errors());
  return std::move(*result);
}

std::string textOf(py::handle value) {
  return py::cast<std::string>(py::str(value));
}

// One thread at a time steps a rig: while it does, Python's lock is released.
class Busy {
 public:
  explicit Busy(std::atomic<bool>& flag) : flag_(flag) {
    if (flag_.exchange(true)) {
      throw std::runtime_error("another thread is stepping or resetting this rig; wait for it");
    }
  }
  ~Busy() { flag_.store(false); }
  Busy(const Busy&) = delete;
  Busy& operator=(const Busy&) = delete;

 private:
  std::atomic<bool>& flag_;
};

// Runs `ticks` ticks by run(part) without Python's lock, and looks for Ctrl-C in between.
template <class Run>
void runTicks(int ticks, const Run& run) {
  for (int left = ticks; left > 0;) {
    const int part = std::min(left, kBetweenSignals);
    bool more = true;
    {
      const py::gil_scoped_release released;
      more = run(part);
    }
    left -= part;
    if (!more) return;
    if (left > 0 && PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
}

void checkTicks(int n) {
  if (n < 1) throw py::value_error("n = " + std::to_string(n) + ": must be at least 1 tick");
}

std::vector<std::string> axisNames(const Models& models) {
  std::vector<std::string> names;
  for (const DeviceAxis& axis : models.device.axes) names.push_back(axis.name);
  return names;
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

[[noreturn]] void refuseShape(const Numbers& aim, const Models& models, py::ssize_t rigs) {
  const std::string axes = std::to_string(models.device.axisCount());
  const std::string wanted =
      rigs == 0 ? "(" + axes + ",)" : "(" + std::to_string(rigs) + ", " + axes + ")";
  throw py::value_error("aim has the shape " + textOf(aim.attr("shape")) + "; must be " + wanted +
                        ", an axis each: " + joined(axisNames(models)));
}

// The aims of rigs, a row each; rigs = 0: of a single rig, without leading dimension.
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
  return numbers;
}

AxisPosition aimOf(const Numbers& aims, int rig, int axes) {
  AxisPosition aim(axes);
  std::copy_n(aims.data() + rig * axes, axes, aim.data());
  return aim;
}

[[noreturn]] void refuseEnded(const SimulatedRig& rig, const TickRecord& record) {
  const std::string text = any(rig.endedBy())
                               ? "the run ended at " + std::to_string(record.time_s) +
                                     " s: " + faultNames(rig.endedBy()) + "; reset() begins anew"
                               : "the rig is not armed; reset() begins anew";
  PyErr_SetString(run_ended, text.c_str());
  throw py::error_already_set();
}

// A rig and its record.
class OneRig {
 public:
  explicit OneRig(const RigFiles& from, std::uint64_t seed)
      : rig_(valueOr(SimulatedRig::load(from))) {
    reset(seed);
  }
  void reset(std::uint64_t seed) {
    const Busy busy(busy_);
    const auto done = [&] {
      const py::gil_scoped_release released;
      return rig_->reset(seed, record_);
    }();
    if (!done) refuse(done.errors());
  }
  int step(const py::object& aim, int n) {
    checkTicks(n);
    const Busy busy(busy_);
    if (!rig_->running()) refuseEnded(*rig_, record_);
    if (aim.is_none()) {
      rig_->steer(nullptr);
    } else {
      const AxisPosition wanted = aimOf(aimsOf(aim, models(), 0), 0, models().device.axisCount());
      rig_->steer(&wanted);
    }
    int ran = 0;
    runTicks(n, [&](int part) {
      const int now = rig_->run(part);
      ran += now;
      return now == part;
    });
    return ran;
  }
  [[nodiscard]] bool running() const { return rig_->running(); }
  [[nodiscard]] std::string endedBy() const { return faultNames(rig_->endedBy()); }
  [[nodiscard]] const Models& models() const { return rig_->models(); }
  [[nodiscard]] const RigOptions& options() const { return rig_->options(); }
  [[nodiscard]] Records records() { return {&record_, 0}; }
  [[nodiscard]] py::array contacts(const py::object& self) {
    return viewOf(records(), contactType(), record_.contacts.data(), record_.contact_count, self);
  }

 private:
  std::unique_ptr<SimulatedRig> rig_;
  TickRecord record_;
  std::atomic<bool> busy_{false};
};

// Several rigs and their records.
class ManyRigs {
 public:
  ManyRigs(const RigFiles& from, int count, int threads, std::uint64_t seed)
      : rigs_(valueOr(RigVector::load(from, count, threads))) {
    std::vector<std::uint64_t> seeds(count);
    for (int i = 0; i < count; ++i) seeds[i] = seed + static_cast<std::uint64_t>(i);
    reset(seeds);
  }
  void reset(const std::vector<std::uint64_t>& seeds) {
    if (static_cast<int>(seeds.size()) != rigs_->size()) {
      throw py::value_error("seeds has " + std::to_string(seeds.size()) +
                            " numbers; must have one for each of " + std::to_string(rigs_->size()) +
                            " rigs");
    }
    const Busy busy(busy_);
    const auto done = [&] {
      const py::gil_scoped_release released;
      return rigs_->reset(seeds);
    }();
    if (!done) refuse(done.errors());
  }
  void resetOne(int rig, std::uint64_t seed) {
    if (rig < 0 || rig >= rigs_->size()) {
      throw py::index_error("rig = " + std::to_string(rig) + ": must be in 0 .. " +
                            std::to_string(rigs_->size() - 1));
    }
    const Busy busy(busy_);
    const auto done = [&] {
      const py::gil_scoped_release released;
      return rigs_->resetOne(rig, seed);
    }();
    if (!done) refuse(done.errors());
  }
  void step(const py::object& aim, int n) {
    checkTicks(n);
    const Busy busy(busy_);
    if (aim.is_none()) {
      for (int i = 0; i < rigs_->size(); ++i) (*rigs_)[i].steer(nullptr);
    } else {
      const Numbers aims = aimsOf(aim, models(), rigs_->size());
      for (int i = 0; i < rigs_->size(); ++i) {
        const AxisPosition wanted = aimOf(aims, i, models().device.axisCount());
        (*rigs_)[i].steer(&wanted);
      }
    }
    runTicks(n, [&](int part) {
      rigs_->run(part);
      return true;
    });
  }
  [[nodiscard]] py::array_t<bool> running() const {
    py::array_t<bool> running(rigs_->size());
    for (int i = 0; i < rigs_->size(); ++i) running.mutable_at(i) = (*rigs_)[i].running();
    return running;
  }
  [[nodiscard]] std::vector<std::string> endedBy() const {
    std::vector<std::string> names;
    for (int i = 0; i < rigs_->size(); ++i) names.push_back(faultNames((*rigs_)[i].endedBy()));
    return names;
  }
  [[nodiscard]] const Models& models() const { return (*rigs_)[0].models(); }
  [[nodiscard]] const RigOptions& options() const { return (*rigs_)[0].options(); }
  [[nodiscard]] Records records() { return {rigs_->records(), rigs_->size()}; }
  [[nodiscard]] int size() const { return rigs_->size(); }
  [[nodiscard]] int threads() const { return rigs_->threads(); }
  [[nodiscard]] py::array contacts(const py::object& self) {
    return viewOf(records(), contactType(), rigs_->records()->contacts.data(), kMaxContacts, self);
  }

 private:
  std::unique_ptr<RigVector> rigs_;
  std::atomic<bool> busy_{false};
};

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

RigFiles filesOf(std::string device, std::string hand, std::string scene, std::string exercise,
                 int level, std::string patient, std::string rendering, std::string motion,
                 std::string engine, double rate_hz, bool uncertified) {
  if (!(rate_hz >= 100.0 && rate_hz <= 16000.0)) {
    throw py::value_error("rate_hz = " + std::to_string(rate_hz) + ": must be in [100, 16000] Hz");
  }
  if (level < 1) throw py::value_error("level = " + std::to_string(level) + ": must be at least 1");
  RigFiles from;
  from.files = {std::move(scene),   std::move(hand),   std::move(device),   std::move(rendering),
                std::move(patient), std::move(motion), std::move(exercise), level};
  from.options.period_s = 1.0 / rate_hz;
  if (!engine.empty()) from.options.engine = std::move(engine);
  from.options.uncertified = uncertified;
  return from;
}

void addRig(py::module_& module) {
  py::class_<OneRig> rig(module, "Rig");
  rig.def(py::init([](std::string device, std::string hand, std::string scene, std::string exercise,
                      int level, std::string patient, std::string rendering, std::string motion,
                      std::string engine, double rate_hz, bool uncertified, std::uint64_t seed) {
            return std::make_unique<OneRig>(
                filesOf(std::move(device), std::move(hand), std::move(scene), std::move(exercise),
                        level, std::move(patient), std::move(rendering), std::move(motion),
                        std::move(engine), rate_hz, uncertified),
                seed);
          }),
          py::kw_only(), py::arg("device"), py::arg("hand"), py::arg("scene"), py::arg("exercise"),
          py::arg("level"), py::arg("patient"), py::arg("rendering"), py::arg("motion"),
          py::arg("engine"), py::arg("rate_hz"), py::arg("uncertified"), py::arg("seed"));
  rig.def("reset", &OneRig::reset, py::arg("seed") = 0);
  rig.def("step", &OneRig::step, py::arg("aim") = py::none(), py::arg("n") = 1);
  rig.def_property_readonly("running", &OneRig::running);
  rig.def_property_readonly("ended_by", &OneRig::endedBy);
  addFacts(rig);
  addState(rig);
}

void addVector(py::module_& module) {
  py::class_<ManyRigs> rigs(module, "VectorRig");
  rigs.def(py::init([](int count, int threads, std::string device, std::string hand,
                       std::string scene, std::string exercise, int level, std::string patient,
                       std::string rendering, std::string motion, std::string engine,
                       double rate_hz, bool uncertified, std::uint64_t seed) {
             for (const auto& [name, value] : {std::pair("n", count), {"threads", threads}}) {
               if (value >= 1) continue;
               throw py::value_error(std::string(name) + " = " + std::to_string(value) +
                                     ": must be at least 1");
             }
             return std::make_unique<ManyRigs>(
                 filesOf(std::move(device), std::move(hand), std::move(scene), std::move(exercise),
                         level, std::move(patient), std::move(rendering), std::move(motion),
                         std::move(engine), rate_hz, uncertified),
                 count, threads, seed);
           }),
           py::arg("n"), py::kw_only(), py::arg("threads"), py::arg("device"), py::arg("hand"),
           py::arg("scene"), py::arg("exercise"), py::arg("level"), py::arg("patient"),
           py::arg("rendering"), py::arg("motion"), py::arg("engine"), py::arg("rate_hz"),
           py::arg("uncertified"), py::arg("seed"));
  rigs.def("reset", &ManyRigs::reset, py::arg("seeds"));
  rigs.def("reset_one", &ManyRigs::resetOne, py::arg("rig"), py::arg("seed") = 0);
  rigs.def("step", &ManyRigs::step, py::arg("aim") = py::none(), py::arg("n") = 1);
  rigs.def("__len__", &ManyRigs::size);
  rigs.def_property_readonly("threads", &ManyRigs::threads);
  rigs.def_property_readonly("running", &ManyRigs::running);
  rigs.def_property_readonly("ended_by", &ManyRigs::endedBy);
  addFacts(rigs);
  addState(rigs);
}

}  // namespace
}  // namespace wholehand::python

PYBIND11_MODULE(_rig, module) {
  namespace own = wholehand::python;
  own::bad_input = PyErr_NewException("wholehand._rig.BadInput", PyExc_ValueError, nullptr);
  own::run_ended = PyErr_NewException("wholehand._rig.RunEnded", PyExc_RuntimeError, nullptr);
  module.add_object("BadInput", py::reinterpret_borrow<py::object>(own::bad_input));
  module.add_object("RunEnded", py::reinterpret_borrow<py::object>(own::run_ended));
  own::addRig(module);
  own::addVector(module);
}
