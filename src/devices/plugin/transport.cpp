#include "devices/plugin/transport.hpp"

#include "loop/realtime/monotonic_clock.hpp"
#include "loop/realtime/periodic_thread.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

constexpr double kOfPeriod = 0.923;  // moves the phase by a thirteenth of a period a time

double seconds(std::int64_t ns) noexcept {
  return static_cast<double>(std::max<std::int64_t>(ns, 0)) * 1e-9;
}

double within(std::vector<double> times_s, double share) {
  if (times_s.empty()) return 0.0;
  const double rank = std::ceil(share * static_cast<double>(times_s.size()) - 1e-9);
  const auto at = times_s.begin() + static_cast<std::ptrdiff_t>(std::max(rank, 1.0)) - 1;
  std::nth_element(times_s.begin(), at, times_s.end());
  return *at;
}

}  // namespace

TransportLog::TransportLog(double period_s) : period_ns_(std::llround(1e9 * period_s)) {
  for (auto* times : {&sampled_s_, &handed_s_, &down_s_}) times->reserve(2 * kTransportSamples);
}

void TransportLog::add(const wh_sample& sample, const WayTimes& way, std::int64_t read_ns) {
  newer_ = newer_ || (!sampled_s_.empty() && sample.sequence > sequence_);
  sequence_ = sample.sequence;
  sampled_s_.push_back(seconds(read_ns - sample.monotonic_ns));
  handed_s_.push_back(way.handed_ns == 0 ? 0.0 : seconds(read_ns - way.handed_ns));
  if (way.command == command_) return;
  const bool follows = command_ != 0 && way.command > command_;
  const std::uint64_t replaced = follows ? way.command - command_ - 1 : 0;
  // The first number may be of a message from before.
  if (command_ != 0 || way.command == 1) {
    down_s_.push_back(
        seconds(way.arrived_ns - way.sent_ns + static_cast<std::int64_t>(replaced) * period_ns_));
  }
  command_ = way.command;
}

Transport TransportLog::within(double share) const {
  return {wholehand::within(newer_ ? sampled_s_ : handed_s_, share),
          wholehand::within(down_s_, share)};
}

Expected<Transport> measureTransport(DeviceDriver& driver, double period_s) {
  const double probe_s = kOfPeriod * period_s;
  TransportLog log(probe_s);
  const auto no = [&driver](const char* why, const char* remedy) {
    return fileFault(driver.where(), why, remedy);
  };
  bool failed = false, between = false;
  PeriodicThreadConfig config;
  config.period_ns = std::llround(1e9 * probe_s);
  PeriodicThread thread(config, [&](std::uint32_t, std::int64_t) {
    wh_sample sample{};
    failed = driver.read(sample) < 0;
    if (failed) return false;
    const WayTimes way = driver.way();
    between = way.handed_ns != 0;
    log.add(sample, way, monotonicNow_ns());
    driver.probe();
    return log.samples() < kTransportSamples;
  });
  if (auto started = thread.start(); !started) return started.errors();
  thread.join();
  if (failed) return no("the device gives no sample", "look at its cable");
  if (between && log.commands() < kTransportSamples / 100) {
    return no("takes no messages: how long a command is on its way is unknown",
              "end it and start it again");
  }
  return log.within(kTransportShare);
}

}  // namespace wholehand
