#include "server/rate_limited_log.hpp"

#include "core/printable.hpp"

#include <algorithm>

namespace wholehand {

void RateLimitedLog::write(const std::string& line, std::int64_t now_ns) {
  if (!sink_) return;
  if (last_ns_ != 0) {
    allowance_ += kPerSecond * 1e-9 * static_cast<double>(now_ns - last_ns_);
    allowance_ = std::min(allowance_, kBurst);
  }
  last_ns_ = now_ns;
  if (allowance_ < 1.0) {
    ++left_out_;
    return;
  }
  allowance_ -= 1.0;
  std::string text = printable(line, 400);
  if (left_out_ > 0) text += " (lines left out before: " + std::to_string(left_out_) + ")";
  left_out_ = 0;
  sink_(text);
}

}  // namespace wholehand
