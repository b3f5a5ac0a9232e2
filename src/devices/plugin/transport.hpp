#pragma once

#include "devices/plugin/device_driver.hpp"
#include "loop/core/expected.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

/// What stands between a loop and its drive: a host process and its rate, a line, the rate of the
/// drive's samples. Measured by sequence numbers and times, without an effort.
namespace wholehand {

/// Times that messages take between loop and drive [s].
struct Transport {
  double up_s = 0.0;    ///< from a sample's own time to the loop
  double down_s = 0.0;  ///< from the loop to the call of the driver; 0 where the loop calls it
  [[nodiscard]] double both_s() const noexcept { return up_s + down_s; }
};

/// Transport of many messages. Each way is judged for itself: the phase of a host against the loop
/// differs from session to session, so that the longest times of both ways may come together. Pure.
class TransportLog {
 public:
  /// @param period_s time between two commands; a command that the next one replaced on the way
  ///   makes that one count as older by a period
  explicit TransportLog(double period_s);

  /// Adds a sample that was read at `read_ns`, CLOCK_MONOTONIC or simulated.
  void add(const wh_sample& sample, const WayTimes& way, std::int64_t read_ns);

  [[nodiscard]] std::size_t samples() const noexcept { return sampled_s_.size(); }
  [[nodiscard]] std::size_t commands() const noexcept { return down_s_.size(); }
  /// The times that this share of the messages keeps to, each way for itself; 0 without messages. A
  /// drive that gives no new sample until it is enabled has no sample to time: the way up then
  /// begins where its driver is called. @pre 0 < share <= 1
  [[nodiscard]] Transport within(double share) const;

 private:
  std::int64_t period_ns_;
  std::vector<double> sampled_s_, handed_s_, down_s_;
  std::uint64_t sequence_ = 0, command_ = 0;
  bool newer_ = false;  ///< the drive gave a new sample
};

/// Share of the messages that the delay of a certificate covers.
inline constexpr double kTransportShare = 0.999;
/// Number of samples of measureTransport().
inline constexpr std::size_t kTransportSamples = 1000;

/// Measures the transport of a device that is not in a session, in about kTransportSamples periods
/// and with the real-time settings of a loop. Moves nothing: samples are read, and probe() messages
/// are sent. Their period is a little shorter than the loop's, so that every phase of a host
/// occurs. Refused: the device gives no sample, or a host takes no message. Not real-time safe.
[[nodiscard]] Expected<Transport> measureTransport(DeviceDriver& driver, double period_s);

}  // namespace wholehand
