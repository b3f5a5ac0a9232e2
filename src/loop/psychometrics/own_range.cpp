#include "loop/psychometrics/own_range.hpp"

#include "loop/core/geometry.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wholehand {
namespace {

/// The outer part of the way, where the person holds an end.
constexpr double kOuter = 0.6;
/// A window is as steady as the steadiest one up to this spread over its.
constexpr double kAsSteady = 1.5;
/// A held end changes within a window by at most this share of the fastest one's change.
constexpr double kHeldSpeed = 0.25;
/// A smaller way of the outermost median is no advance [share of the allowed spread].
constexpr double kAdvance = 1.0 / 16.0;

/// The value of this rank among n.
template <std::size_t Size>
double ranked(std::array<double, Size> values, int n, double share) noexcept {
  const auto rank = std::lround(share * (n - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.begin() + n);
  return values[static_cast<std::size_t>(rank)];
}

}  // namespace

RangeRules rangeRulesOf(bool translation) noexcept {
  return translation ? RangeRules{0.012, 0.01} : RangeRules{8.0 * kDeg, 5.0 * kDeg};
}

void RangeMeter::begin(const RangeRules& rules, int direction, double q) noexcept {
  rules_ = rules;
  direction_ = direction;
  samples_ = windows_ = since_advance_ = 0;
  start_ = furthest_ = advanced_to_ = direction * q;
}

RangeMeter::Window RangeMeter::closeWindow() const noexcept {
  const int first = samples_ % kWindow;  // the oldest sample
  std::array<double, kWindow> early{}, late{};
  constexpr int kHalf = kWindow / 2;
  for (int i = 0; i < kWindow; ++i) {
    const double at = last_[(first + i) % kWindow];
    (i < kHalf ? early[i] : late[i - kHalf]) = at;
  }
  return {ranked(last_, kWindow, 0.5), ranked(last_, kWindow, 0.9) - ranked(last_, kWindow, 0.1),
          2.0 * std::abs(ranked(late, kWindow - kHalf, 0.5) - ranked(early, kHalf, 0.5))};
}

void RangeMeter::add(double q) noexcept {
  if (samples_ >= kMostSamples) return;
  const double at = direction_ * q;
  last_[samples_ % kWindow] = at;
  furthest_ = std::max(furthest_, at);
  ++samples_;
  if (samples_ < kWindow) return;
  const Window window = closeWindow();
  window_[windows_++] = window;
  since_advance_ = isTry() ? since_advance_ + 1 : 0;
  if (window.middle <= advanced_to_ + kAdvance * rules_.steady) return;
  advanced_to_ = window.middle;
  since_advance_ = 0;
}

RangeTry RangeMeter::judge() const noexcept {
  if (windows_ == 0 || !isTry()) return {};
  const std::span<const Window> windows(window_.data(), static_cast<std::size_t>(windows_));
  const double outer = start_ + kOuter * (furthest_ - start_);
  double least = std::numeric_limits<double>::infinity(), fastest = 0.0;
  for (const Window& window : windows) {
    fastest = std::max(fastest, window.change);
    if (window.middle >= outer) least = std::min(least, window.spread);
  }
  if (!(least <= rules_.steady)) return {TryKind::kJerk, 0.0};
  const Window* best = nullptr;
  for (const Window& end : windows) {
    if (end.middle < outer || end.spread > kAsSteady * least) continue;
    if (best == nullptr || end.middle > best->middle) best = &end;
  }
  return {best->change > kHeldSpeed * fastest ? TryKind::kDrift : TryKind::kHeld,
          direction_ * best->middle};
}

OwnEnd ownEnd(std::span<const RangeTry> tries) noexcept {
  std::array<double, kMostTries> held{};
  int n = 0;
  for (const RangeTry& one : tries) {
    if (one.kind == TryKind::kHeld && n < kMostTries) held[n++] = one.value;
  }
  if (n < 2) return {};
  std::sort(held.begin(), held.begin() + n);
  return {true, 0.5 * (held[(n - 1) / 2] + held[n / 2])};
}

}  // namespace wholehand
