#include "bound_rigs.hpp"

#include "exceptions.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>

namespace py = pybind11;

namespace wholehand::python {
namespace {

constexpr int kBetweenSignals = 1024;  // ticks between two looks at Ctrl-C

// Runs reset() without Python's lock; raises BadInput where it fails.
template <class Reset>
void resetAlone(std::atomic<bool>& busy, const Reset& reset) {
  const StepGuard guard(busy);
  const auto done = [&] {
    const py::gil_scoped_release released;
    return reset();
  }();
  if (!done) refuse(done.errors());
}

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

int ticksOf(const py::object& n) {
  return static_cast<int>(wholeOf("n", n, 1, std::numeric_limits<int>::max()));
}

std::unique_ptr<RigVector> loadVector(const RigArguments& arguments, const py::object& count,
                                      const py::object& threads) {
  constexpr std::uint64_t kMost = 100'000;  // their records alone have some GB
  const auto rigs = static_cast<int>(wholeOf("n", count, 1, kMost));
  const auto workers = static_cast<int>(wholeOf("threads", threads, 1, kMost));
  return valueOr(RigVector::load(filesOf(arguments), rigs, workers));
}

}  // namespace

StepGuard::StepGuard(std::atomic<bool>& busy) : busy_(busy) {
  if (busy_.exchange(true)) {
    throw std::runtime_error("another thread is stepping or resetting this rig; wait for it");
  }
}

OneRig::OneRig(const RigArguments& arguments)
    : rig_(valueOr(SimulatedRig::load(filesOf(arguments)))) {
  rig_->keepHistory();
  reset(py::int_(arguments.seed));
}

void OneRig::reset(const py::object& asked) {
  const std::uint64_t seed = wholeOf("seed", asked);
  resetAlone(busy_, [&] { return rig_->reset(seed, record_); });
}

int OneRig::step(const py::object& aim, const py::object& asked) {
  const int n = ticksOf(asked);
  const StepGuard guard(busy_);
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

void OneRig::close() {
  const StepGuard guard(busy_);
  rig_->close();
}

py::tuple OneRig::history() {
  const StepGuard guard(busy_);
  if (rig_->closed()) refuseEnded(*rig_, record_);
  const RigHistory& history = rig_->history();
  if (!history.whole) {
    throw std::runtime_error("the run has more steps than a rig keeps (" +
                             std::to_string(history.ticks.size()) + "); reset() begins anew");
  }
  const auto ticks = static_cast<py::ssize_t>(history.ticks.size());
  const auto aims = static_cast<py::ssize_t>(history.aims.size());
  return py::make_tuple(history.seed, py::array_t<std::int64_t>(ticks, history.ticks.data()),
                        Numbers(aims, history.aims.data()));
}

void OneRig::runAgain(std::uint64_t seed, const std::vector<std::int64_t>& ticks,
                      const Numbers& aims) {
  const auto steered = std::count_if(ticks.begin(), ticks.end(), [](auto n) { return n > 0; });
  if (aims.size() != steered * models().device.axisCount()) {
    throw py::value_error("the state is of a rig with other axes");
  }
  RigHistory history;
  history.seed = seed;
  history.ticks = ticks;
  history.aims.assign(aims.data(), aims.data() + aims.size());
  resetAlone(busy_, [&] { return rig_->runAgain(history, record_); });
}

std::string OneRig::endedBy() const {
  return faultNames(rig_->endedBy());
}

py::array OneRig::contacts(const py::object& self) {
  return viewOf(records(), contactType(), record_.contacts.data(), record_.contact_count, self);
}

ManyRigs::ManyRigs(const RigArguments& arguments, const py::object& count,
                   const py::object& threads)
    : rigs_(loadVector(arguments, count, threads)) {
  std::vector<std::uint64_t> seeds(rigs_->size());
  for (std::size_t i = 0; i < seeds.size(); ++i) seeds[i] = arguments.seed + i;
  resetAlone(busy_, [&] { return rigs_->reset(seeds); });
}

void ManyRigs::reset(const py::object& asked) {
  const std::vector<std::uint64_t> seeds = seedsOf(asked, rigs_->size());
  resetAlone(busy_, [&] { return rigs_->reset(seeds); });
}

void ManyRigs::resetOne(const py::object& index, const py::object& asked) {
  const std::uint64_t seed = wholeOf("seed", asked);
  const int rig = rigOf(index, rigs_->size());
  resetAlone(busy_, [&] { return rigs_->resetOne(rig, seed); });
}

void ManyRigs::step(const py::object& aim, const py::object& asked) {
  const int n = ticksOf(asked);
  const StepGuard guard(busy_);
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

py::array_t<bool> ManyRigs::running() const {
  py::array_t<bool> running(rigs_->size());
  for (int i = 0; i < rigs_->size(); ++i) running.mutable_at(i) = (*rigs_)[i].running();
  return running;
}

std::vector<std::string> ManyRigs::endedBy() const {
  std::vector<std::string> names;
  for (int i = 0; i < rigs_->size(); ++i) names.push_back(faultNames((*rigs_)[i].endedBy()));
  return names;
}

py::array ManyRigs::contacts(const py::object& self) {
  return viewOf(records(), contactType(), rigs_->records()->contacts.data(), kMaxContacts, self);
}

}  // namespace wholehand::python
