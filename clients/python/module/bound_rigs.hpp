#pragma once

#include "arguments.hpp"
#include "record_views.hpp"
#include "simulated_rig.hpp"

#include <atomic>
#include <cstdint>
#include <memory>
#include <pybind11/numpy.h>
#include <string>
#include <vector>

namespace wholehand::python {

/// Lets one Python thread at a time step or reset the rigs of one object: while it does, Python's
/// lock is released.
class StepGuard {
 public:
  /// Raises RuntimeError where another thread holds the guard.
  explicit StepGuard(std::atomic<bool>& busy);
  ~StepGuard() { busy_.store(false); }
  StepGuard(const StepGuard&) = delete;
  StepGuard& operator=(const StepGuard&) = delete;

 private:
  std::atomic<bool>& busy_;
};

/// wholehand.Rig: a rig and its record.
class OneRig {
 public:
  /// Raises BadInput.
  explicit OneRig(const RigArguments& arguments);

  void reset(const pybind11::object& asked);
  /// Returns how many ticks ran: fewer than `n` if the run ended.
  int step(const pybind11::object& aim, const pybind11::object& asked);
  void close();
  /// Seed, ticks and aims of a RigHistory. Raises RunEnded once closed, and RuntimeError where the
  /// history is not whole.
  [[nodiscard]] pybind11::tuple history();
  /// Resets, and does again what history() said.
  void runAgain(std::uint64_t seed, const std::vector<std::int64_t>& ticks, const Numbers& aims);

  [[nodiscard]] bool running() const { return rig_->running(); }
  [[nodiscard]] std::string endedBy() const;
  [[nodiscard]] const Models& models() const { return rig_->models(); }
  [[nodiscard]] const RigOptions& options() const { return rig_->options(); }
  [[nodiscard]] Records records() { return {&record_, 0}; }
  [[nodiscard]] pybind11::array contacts(const pybind11::object& self);

 private:
  std::unique_ptr<SimulatedRig> rig_;
  TickRecord record_;
  std::atomic<bool> busy_{false};
};

/// wholehand.VectorRig: several rigs and their records.
class ManyRigs {
 public:
  /// Raises BadInput. Rig i begins with the seed arguments.seed + i.
  ManyRigs(const RigArguments& arguments, const pybind11::object& count,
           const pybind11::object& threads);

  void reset(const pybind11::object& asked);
  void resetOne(const pybind11::object& index, const pybind11::object& asked);
  void step(const pybind11::object& aim, const pybind11::object& asked);

  [[nodiscard]] pybind11::array_t<bool> running() const;
  [[nodiscard]] std::vector<std::string> endedBy() const;
  [[nodiscard]] const Models& models() const { return (*rigs_)[0].models(); }
  [[nodiscard]] const RigOptions& options() const { return (*rigs_)[0].options(); }
  [[nodiscard]] Records records() { return {rigs_->records(), rigs_->size()}; }
  [[nodiscard]] int size() const { return rigs_->size(); }
  [[nodiscard]] int threads() const { return rigs_->threads(); }
  [[nodiscard]] pybind11::array contacts(const pybind11::object& self);

 private:
  std::unique_ptr<RigVector> rigs_;
  std::atomic<bool> busy_{false};
};

}  // namespace wholehand::python
