#pragma once

#include "assembly/rig.hpp"
#include "core/tick_record.hpp"

#include <cstdint>
#include <memory>
#include <vector>

namespace wholehand::python {

/// What a simulated rig is built from.
struct RigFiles {
  ModelFiles files;
  RigOptions options;
};

/// A rig with a simulated device that is stepped by its caller, on the simulated clock. Its virtual
/// patient does the exercise or plays the motion until the caller aims.
class SimulatedRig {
 public:
  /// Loads the files; reset() must follow. Every rig loads its own: an exercise has a state.
  [[nodiscard]] static Expected<std::unique_ptr<SimulatedRig>> load(const RigFiles& from);

  /// Builds everything anew, arms, and writes the state before the first tick into `record`.
  /// @param seed of the virtual patient who does the exercise
  /// @param record is written by run(); outlives this
  [[nodiscard]] Expected<Done> reset(std::uint64_t seed, TickRecord& record);

  /// Sets the pose that the hand is steered to from the next tick on, as the order Aim of a client
  /// does; null returns the steering to the virtual patient.
  /// @pre finite, one value for each axis
  void steer(const AxisPosition* aim) noexcept;

  /// Runs up to `ticks` ticks; returns how many ran: fewer if the run ended.
  /// @pre reset() succeeded
  int run(int ticks) noexcept;

  /// False before the first reset(), after one that failed, and once a fault has ended the run.
  [[nodiscard]] bool running() const noexcept;
  /// Faults that ended the run.
  [[nodiscard]] Fault endedBy() const noexcept;
  [[nodiscard]] const Models& models() const noexcept { return models_; }
  [[nodiscard]] const RigOptions& options() const noexcept { return options_; }

 private:
  SimulatedRig(Models models, RigOptions options);
  void describeStart() noexcept;

  Models models_;
  RigOptions options_;
  std::unique_ptr<Rig> rig_;      ///< null: nothing runs
  TickRecord* record_ = nullptr;  ///< of rig_
  std::uint64_t next_tick_ = 0;
  bool steered_ = false;
  int command_count_ = 0;  ///< commands for the next tick
  Command commands_[2];
};

/// Several rigs of the same files, which run side by side.
class RigVector {
 public:
  [[nodiscard]] static Expected<std::unique_ptr<RigVector>> load(const RigFiles& from, int count,
                                                                 int threads);

  /// Resets every rig. @pre one seed for each rig
  [[nodiscard]] Expected<Done> reset(const std::vector<std::uint64_t>& seeds);
  [[nodiscard]] Expected<Done> resetOne(int rig, std::uint64_t seed);

  /// Runs every rig that still runs, on all threads; the results do not depend on their number.
  void run(int ticks);

  [[nodiscard]] int size() const noexcept { return static_cast<int>(rigs_.size()); }
  [[nodiscard]] int threads() const noexcept { return threads_; }
  [[nodiscard]] SimulatedRig& operator[](int rig) { return *rigs_[rig]; }
  [[nodiscard]] const SimulatedRig& operator[](int rig) const { return *rigs_[rig]; }
  /// The records of all rigs, at a fixed address.
  [[nodiscard]] TickRecord* records() noexcept { return records_.data(); }

 private:
  RigVector() = default;
  template <class Work>
  void onThreads(const Work& work);

  int threads_ = 1;
  std::vector<std::unique_ptr<SimulatedRig>> rigs_;
  std::vector<TickRecord> records_;
};

}  // namespace wholehand::python
