#include "loop/runtime/statistics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace wholehand {
namespace {

constexpr double kSmallestNs = 10.0, kLargestNs = 1e12;
/// Ratio of a bin's ends: bins are 1 % wide. A bin is reported as its geometric middle, hence at
/// most 0.5 % off.
constexpr double kRatio = 1.01;

const double kLogRatio = std::log(kRatio);

void keepLargest(AxisEffort& largest, const AxisEffort& effort) {
  if (largest.size() < effort.size()) {
    AxisEffort grown(effort.size());
    std::copy(largest.begin(), largest.end(), grown.data());
    largest = grown;
  }
  for (int i = 0; i < effort.size(); ++i) largest[i] = std::max(largest[i], std::abs(effort[i]));
}

// The faults that have an axis, in the order in which a tick finds them: fault_axis belongs to the
// first of several faults. An effort that is not finite is found late, but is listed first because
// it overrides the axis of the others.
constexpr std::array kOfAnAxis{
    Fault::kNonFiniteEffort, Fault::kNonFinitePosition, Fault::kWorkspace,
    Fault::kEncoderJump,     Fault::kSpeedLimit,        Fault::kEncoderStuck,
    Fault::kEffortLimit,     Fault::kPowerLimit,        Fault::kEffortSlew};

void countAxis(TickSummary& totals, const TickRecord& r) {
  if (r.fault_axis < 0 || r.fault_axis >= kMaxAxes) return;
  const auto* const first = std::find_if(kOfAnAxis.begin(), kOfAnAxis.end(),
                                         [&r](Fault fault) { return any(r.faults & fault); });
  if (first == kOfAnAxis.end()) return;
  const int bit = std::countr_zero(static_cast<std::uint32_t>(*first));
  ++totals.fault_axes[bit][r.fault_axis];
}

// The known axes of a fault as text, e.g. " (x 10, finger_flexion 2)".
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

// The counts of these faults as text, e.g. "late tick in 2 ticks, effort limited in 1 tick (x)";
// "none".
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

DurationHistogram::DurationHistogram()
    : bins_(static_cast<std::size_t>(std::log(kLargestNs / kSmallestNs) / kLogRatio) + 2, 0) {}

void DurationHistogram::add(std::int64_t duration_ns) {
  const double ns = std::clamp(static_cast<double>(duration_ns), kSmallestNs, kLargestNs);
  const auto bin = static_cast<std::size_t>(std::log(ns / kSmallestNs) / kLogRatio);
  ++bins_[std::min(bin, bins_.size() - 1)];
  ++count_;
  max_ns_ = std::max(max_ns_, duration_ns);
  min_ns_ = std::min(min_ns_, duration_ns);
}

double DurationHistogram::quantile(double share) const {
  if (count_ == 0) return 0.0;
  const auto wanted =
      static_cast<std::uint64_t>(std::max(1.0, std::ceil(share * static_cast<double>(count_))));
  std::uint64_t seen = 0;
  for (std::size_t i = 0; i < bins_.size(); ++i) {
    seen += bins_[i];
    if (seen < wanted) continue;
    const double middle = kSmallestNs * std::exp((static_cast<double>(i) + 0.5) * kLogRatio);
    return std::clamp(middle, static_cast<double>(min_ns_), static_cast<double>(max_ns_));
  }
  return static_cast<double>(max_ns_);
}

Percentiles DurationHistogram::percentiles() const {
  return {quantile(0.5), quantile(0.99), quantile(0.999), static_cast<double>(max_ns_)};
}

void TickStatistics::add(const TickRecord& r) {
  const std::lock_guard lock(mutex_);
  TickSummary& t = totals_;
  t.ticks += r.elapsed_periods;
  ++t.records;
  t.missed_deadlines += std::max<std::uint32_t>(r.elapsed_periods, 1) - 1;
  for (int bit = 0; bit < kFaultBits; ++bit) {
    const bool set = (static_cast<std::uint32_t>(r.faults) >> static_cast<unsigned>(bit) & 1U) != 0;
    t.faults[bit] += set ? 1 : 0;
  }
  countAxis(t, r);
  if (any(r.faults & kStoppingFaults)) ++t.stopping_faults;
  keepLargest(t.max_effort, r.sent);
  t.contacts_max = std::max(t.contacts_max, r.contact_count + r.contacts_dropped);
  t.max_coupling_error_rad = std::max(t.max_coupling_error_rad, std::abs(r.coupling_error_rad));
  // The effort of a record is in force until the position of the next one.
  for (int a = 0; a < r.q_m.size() && q_before_.size() == r.q_m.size(); ++a) {
    const double work_j = a < t.sent.size() ? t.sent[a] * (r.q_m[a] - q_before_[a]) : 0.0;
    if (std::isfinite(work_j)) t.work_j += work_j;
  }
  q_before_ = r.q_m;
  t.time_s = r.time_s;
  t.contacts = r.contact_count;
  t.sent = r.sent;
  if (r.exercise.value_count > 0) {
    t.value_count = r.exercise.value_count;
    t.values = r.exercise.values;
  }
  cpu_.add(r.cpu_ns);
  wall_.add(r.wall_ns);
  lateness_.add(r.lateness_ns);
  for (std::size_t i = 0; i < kStages; ++i) stages_[i].add(r.stage_cpu_ns[i]);
}

TickSummary TickStatistics::snapshot() const {
  const std::lock_guard lock(mutex_);
  TickSummary out = totals_;
  out.cpu = cpu_.percentiles();
  out.wall = wall_.percentiles();
  out.lateness = lateness_.percentiles();
  for (std::size_t i = 0; i < kStages; ++i) out.stage_cpu[i] = stages_[i].percentiles();
  return out;
}

std::string faultText(const TickSummary& summary, const std::vector<DeviceAxis>& axes) {
  return countText(summary, kStoppingFaults, axes);
}

std::string noticeText(const TickSummary& summary, const std::vector<DeviceAxis>& axes) {
  return countText(summary, faultsWith(FaultReaction::kCounted), axes);
}

}  // namespace wholehand
