#include "loop/psychometrics/own_range.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace wholehand {
namespace {

/// The outer part of the way, where the person holds an end.
constexpr double kOuter = 0.6;
/// A window is as steady as the steadiest one up to this spread over its.
constexpr double kAsSteady = 1.5;
/// A held end changes within a window by at most this share of the fastest one's change.
constexpr double kHeldSpeed = 0.25;

double quantileOf(std::span<const double> q, double share) {
  std::vector<double> values(q.begin(), q.end());
  const auto rank = std::lround(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

struct Window {
  double middle = 0.0, spread = 0.0;
  double change = 0.0;  ///< slow change, by the medians of both halves: a tremor cancels
};

Window look(std::span<const double> q) {
  const std::size_t half = q.size() / 2;
  return {quantileOf(q, 0.5), quantileOf(q, 0.9) - quantileOf(q, 0.1),
          2.0 * std::abs(quantileOf(q.subspan(half), 0.5) - quantileOf(q.first(half), 0.5))};
}

}  // namespace

RangeRules rangeRulesOf(bool translation) noexcept {
  constexpr double kDegree = 0.017453292519943295;
  return translation ? RangeRules{0.012, 0.01} : RangeRules{8.0 * kDegree, 5.0 * kDegree};
}

RangeTry judgeTry(std::span<const double> q, double period_s, int direction,
                  const RangeRules& rules) {
  const auto length = static_cast<std::size_t>(std::lround(RangeRules::kWindow_s / period_s));
  if (length < 2 || q.size() < length) return {};
  const double start = direction * q.front();
  double furthest = start;
  for (const double at : q) furthest = std::max(furthest, direction * at);
  if (!(furthest - start >= rules.least)) return {};
  const double outer = start + kOuter * (furthest - start);
  const std::size_t hop = std::max<std::size_t>(1, length / 25);
  std::vector<Window> ends;
  double least = std::numeric_limits<double>::infinity(), fastest = 0.0;
  for (std::size_t first = 0; first + length <= q.size(); first += hop) {
    const Window window = look(q.subspan(first, length));
    fastest = std::max(fastest, window.change);
    if (direction * window.middle < outer) continue;
    ends.push_back(window);
    least = std::min(least, window.spread);
  }
  if (!(least <= rules.steady)) return {TryKind::kJerk, 0.0};
  const Window* best = nullptr;
  for (const Window& end : ends) {
    if (end.spread > kAsSteady * least) continue;
    if (best == nullptr || direction * end.middle > direction * best->middle) best = &end;
  }
  return {best->change > kHeldSpeed * fastest ? TryKind::kDrift : TryKind::kHeld, best->middle};
}

OwnEnd ownEnd(std::span<const RangeTry> tries) {
  std::vector<double> held;
  for (const RangeTry& one : tries) {
    if (one.kind == TryKind::kHeld) held.push_back(one.value);
  }
  if (held.size() < 2) return {};
  std::sort(held.begin(), held.end());
  const std::size_t middle = held.size() / 2;
  if (held.size() % 2 == 1) return {true, held[middle]};
  return {true, 0.5 * (held[middle - 1] + held[middle])};
}

}  // namespace wholehand
