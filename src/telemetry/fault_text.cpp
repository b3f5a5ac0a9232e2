#include "telemetry/fault_text.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>

namespace wholehand {
namespace {

// E.g. " (x 10, finger_flexion 2)": the axes, if known.
std::string axesText(const TickSummary& summary, std::size_t bit,
                     const std::vector<DeviceAxis>& axes) {
  std::string text;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    const std::uint64_t count = summary.fault_axes[bit][a];
    if (count == 0) continue;
    text += fmt::format("{}{}", text.empty() ? " (" : ", ", axes[a].name);
    if (count != summary.faults[bit]) text += fmt::format(" {}", count);
  }
  return text.empty() ? text : text + ")";
}

// Text for these bits, e.g. "late tick in 2 ticks, effort limited in 1 tick (x)"; "none".
std::string countText(const TickSummary& summary, Fault bits, const std::vector<DeviceAxis>& axes) {
  std::string text;
  for (std::size_t at = 0; at < kFaultTable.size(); ++at) {
    const auto count = summary.faults[at];
    if (count == 0 || !any(bits & kFaultTable[at].bit)) continue;
    if (!text.empty()) text += ", ";
    text += fmt::format("{} in {} tick{}{}", kFaultTable[at].name, count, count == 1 ? "" : "s",
                        axesText(summary, at, axes));
  }
  return text.empty() ? "none" : text;
}

}  // namespace

std::string faultText(const TickSummary& summary, const std::vector<DeviceAxis>& axes) {
  return countText(summary, kStopping, axes);
}

std::string noticeText(const TickSummary& summary, const std::vector<DeviceAxis>& axes) {
  return countText(summary, faultsWith(FaultReaction::kCounted), axes);
}

}  // namespace wholehand
