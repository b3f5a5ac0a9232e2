#pragma once

#include "core/expected.hpp"
#include "device/plugin/device_driver.hpp"
#include "model/device_model.hpp"

#include <cstddef>
#include <cstdint>
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
  /// fault, not enabled or not homed, a triggered watchdog, samples that stand still for longer
  /// than longestStill_s() or go back in time, an axis without a position, beyond its range or
  /// faster than its speed limit.
  [[nodiscard]] Expected<std::vector<double>> judge(const wh_sample& sample);

 private:
  [[nodiscard]] Diagnostic no(const std::string& axis, const std::string& problem,
                              const std::string& remedy) const;
  [[nodiscard]] Expected<Done> judgeStatus(const wh_sample& sample) const;
  [[nodiscard]] Expected<Done> judgeAge(const wh_sample& sample);
  [[nodiscard]] Expected<Done> judgeMotion(const std::vector<double>& now);

  const DeviceModel* model_;
  std::vector<std::size_t> place_;
  double period_s_;
  std::vector<double> start_;              ///< position at the beginning of the move
  std::vector<std::vector<double>> seen_;  ///< ring buffer: positions of the last kSpeedOver_s
  std::size_t tick_ = 0, still_ = 0;
  std::uint64_t sequence_ = 0;
  std::int64_t taken_ns_ = 0;
};

}  // namespace wholehand
