#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace wholehand {

/// Log that a hostile client cannot flood: kBurst lines at once, kPerSecond in the long run.
/// Suppressed lines are counted and reported. One thread.
class RateLimitedLog {
 public:
  static constexpr double kBurst = 20.0, kPerSecond = 2.0;

  explicit RateLimitedLog(std::function<void(const std::string&)> sink) : sink_(std::move(sink)) {}

  void write(const std::string& line, std::int64_t now_ns);

 private:
  std::function<void(const std::string&)> sink_;
  double allowance_ = kBurst;
  std::int64_t last_ns_ = 0;
  std::uint64_t left_out_ = 0;
};

}  // namespace wholehand
