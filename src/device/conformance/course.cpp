#include "device/conformance/course.hpp"

#include "realtime/monotonic_clock.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

constexpr double kSpeedOver_s = 0.005;
constexpr double kGap_s = 0.01;  // between two samples

}  // namespace

Course::Course(DriverBench& bench) : bench_(bench), from_ns_(monotonicNow_ns()) {
  askNothing();
}

double Course::now_s() const {
  return static_cast<double>(monotonicNow_ns() - from_ns_) * 1e-9;
}

double Course::timeOf(const Sampled& sampled) const {
  return static_cast<double>(sampled.sample.monotonic_ns - from_ns_) * 1e-9;
}

void Course::askNothing() {
  given_.emplace_back(now_s(), Shares{});
}

void Course::push(const Shares& shares, double seconds, const std::function<bool()>& done) {
  everyMillisecond(seconds, [&] {
    const double now = now_s();
    if (written_s_ >= 0.0) longest_write_gap_s_ = std::max(longest_write_gap_s_, now - written_s_);
    written_s_ = now;
    const bool taken = bench_.writeShares(shares) >= 0;
    if (taken && shares != given_.back().second) given_.emplace_back(now_s(), shares);
    take();
    return !done || !done();
  });
}

void Course::watch(double seconds, const std::function<bool()>& done) {
  everyMillisecond(seconds, [&] {
    take();
    return !done || !done();
  });
}

void Course::take() {
  const Sampled now = bench_.read();
  const bool newer = samples_.empty() || now.sample.sequence != samples_.back().sample.sequence;
  if (now.result >= 0 && newer) samples_.push_back(now);
}

bool Course::late() const {
  return longest_write_gap_s_ > 0.5 * bench_.patience_s() || longestGap_s(0.0) > kGap_s;
}

PushTrace Course::trace(std::size_t pushed, std::size_t seen) const {
  PushTrace out;
  out.resolution = bench_.axes()[seen].resolution;
  for (const auto& [at_s, shares] : given_) out.given.push_back({at_s, shares.at(pushed)});
  for (const Sampled& s : samples_) {
    const bool valid = (s.sample.valid >> seen & 1U) != 0;
    const double at_s = timeOf(s);
    const bool later = out.seen.empty() || at_s > out.seen.back().at_s;
    if (valid && later && std::isfinite(s.sample.position[seen])) {
      out.seen.push_back({at_s, s.sample.position[seen]});
    }
  }
  return out;
}

double Course::shareAt(std::size_t axis, double at_s) const {
  double share = 0.0;
  for (const auto& [from_s, shares] : given_) {
    if (from_s <= at_s) share = shares.at(axis);
  }
  return share;
}

double Course::position(std::size_t axis) const {
  return samples_.empty() ? 0.0 : samples_.back().sample.position[axis];
}

double Course::speed(std::size_t axis) const {
  if (samples_.empty()) return 0.0;
  const double now_s = timeOf(samples_.back());
  for (auto s = samples_.rbegin(); s != samples_.rend(); ++s) {
    const double dt = now_s - timeOf(*s);
    if (dt >= kSpeedOver_s) return (position(axis) - s->sample.position[axis]) / dt;
  }
  return 0.0;
}

double Course::longestGap_s(double from_s) const {
  double longest = 0.0, last_s = from_s;
  for (const Sampled& s : samples_) {
    const double at_s = timeOf(s);
    if (at_s < from_s) continue;
    longest = std::max(longest, at_s - last_s);
    last_s = at_s;
  }
  return std::max(longest, now_s() - last_s);
}

}  // namespace wholehand
