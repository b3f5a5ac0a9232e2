#pragma once

#include "loop/core/tick_record.hpp"
#include "rig/rig.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace wholehand::python {

/// What a simulated rig is built from.
struct RigFiles {
  ModelFiles files;
  RigOptions options;
};

/// What was asked of a rig since its reset: run again, it gives the same bits.
struct RigHistory {
  std::uint64_t seed = 0;
  /// Ticks of each step that was steered, and minus those of each stretch that was not.
  std::vector<std::int64_t> ticks;
  std::vector<double> aims;  ///< of the steered steps, a value for each axis [m or rad]
  bool whole = false;        ///< false: not kept, or of more than kMostSteps only the first
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
  void steer(const AxisPosition* aim);

  /// Runs up to `ticks` ticks; returns how many ran: fewer if the run ended.
  /// @pre reset() succeeded
  int run(int ticks) noexcept;

  /// Resets, and does again all that the history says.
  /// @pre the history is that of a rig with as many axes
  [[nodiscard]] Expected<Done> runAgain(const RigHistory& history, TickRecord& record);

  /// Keeps the history from the next reset() on.
  void keepHistory() noexcept { keeps_history_ = true; }

  /// Frees all but the models; the record stays as it is. Until the next reset() nothing runs.
  void close() noexcept { rig_.reset(); }
  [[nodiscard]] bool closed() const noexcept { return rig_ == nullptr; }
  [[nodiscard]] const RigHistory& history() const noexcept { return history_; }

  /// False before the first reset(), after one that failed, and once a fault has ended the run.
  [[nodiscard]] bool running() const noexcept;
  /// Faults that ended the run.
  [[nodiscard]] Fault endedBy() const noexcept;
  [[nodiscard]] const Models& models() const noexcept { return models_; }
  [[nodiscard]] const RigOptions& options() const noexcept { return options_; }

 private:
  /// Of a history: 64 MB with six axes.
  static constexpr std::size_t kMostSteps = std::size_t{1} << 20U;

  SimulatedRig(Models models, RigOptions options);
  void describeStart() noexcept;
  void keep(const AxisPosition* aim);

  Models models_;
  RigOptions options_;
  std::unique_ptr<Rig> rig_;      ///< null: nothing runs
  TickRecord* record_ = nullptr;  ///< of rig_
  std::uint64_t next_tick_ = 0;
  bool steered_ = false;
  bool keeps_history_ = false;
  RigHistory history_;
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
