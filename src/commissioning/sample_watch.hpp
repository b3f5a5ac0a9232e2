#pragma once

#include "core/expected.hpp"
#include "device/plugin/device_driver.hpp"
#include "model/device_model.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

namespace wholehand {

/// Checks every sample of a device that is moved under supervision, from the beginning of a move to
/// its end. Axes are in the order of the device file.
class SampleWatch {
 public:
  /// @param place axis of the file → axis of the driver
  /// @param period_s between two samples
  SampleWatch(const DeviceModel& model, std::vector<std::size_t> place, double period_s);

  /// Begins a move and clears the history.
  void begin();
  /// Positions of a sample. Refused: an axis without a finite position.
  [[nodiscard]] Expected<std::vector<double>> positions(const wh_sample& sample) const;
  /// Checks a sample and returns its positions. Refused, each with its own message: a drive in
  /// fault, a watchdog that let go, a device that is not enabled or not homed, samples that stand
  /// still for longer than longestStill_s(), are older than that and than this machine stood still,
  /// lie in the future or go back in time, an axis without a position, beyond its range, whose
  /// encoder jumps, or that is faster than its speed limit by the samples' own times.
  /// @param now_ns CLOCK_MONOTONIC, or simulated, when it was read
  [[nodiscard]] Expected<std::vector<double>> judge(const wh_sample& sample, std::int64_t now_ns);

 private:
  struct Seen {
    std::int64_t taken_ns = 0;
    std::vector<double> position;
  };

  [[nodiscard]] Diagnostic no(const std::string& axis, const std::string& problem,
                              const std::string& remedy) const;
  [[nodiscard]] Expected<Done> judgeStatus(const wh_sample& sample) const;
  [[nodiscard]] Expected<Done> judgeAge(const wh_sample& sample, std::int64_t now_ns);
  [[nodiscard]] Expected<Done> judgeMotion(std::size_t i, const Seen& now) const;

  const DeviceModel* model_;
  std::vector<std::size_t> place_;
  double period_s_;
  std::vector<double> start_;  ///< position at the beginning of the move
  std::deque<Seen> seen_;      ///< the first: the newest that is kSpeedOver_s old, if there is one
  std::size_t tick_ = 0, still_ = 0;
  std::uint64_t sequence_ = 0;
  std::int64_t taken_ns_ = 0, now_ns_ = 0, longest_gap_ns_ = 0;
};

}  // namespace wholehand
