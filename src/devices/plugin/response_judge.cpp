#include "devices/plugin/response_judge.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wholehand {
namespace {

constexpr double kHigh_hz = 15.0, kLow_hz = 40.0;
// Single poles let a tremor of 12 Hz through, at 0.15. Beyond a higher pole less of it is left than
// of a change above 16 Hz: an episode with less than this share of u² there accuses nobody.
constexpr double kHigher_hz = 22.0, kAboveTremor = 0.14;
constexpr double kSettle_s = 0.2;  // of the band, after a beginning
constexpr double kMemory_s = 0.3;  // of an episode: quiet times are forgotten
// Between changes of the effort y shows only steps of the encoder. So an axis is judged while the
// mean square of u over 20 ms is above this share of the squared effort limit, (0.3 %)².
constexpr double kChanges = 9e-6, kMeanOver_s = 0.02;
// An episode ends when ∫ u² dt has reached this share of the squared effort limit [s]: 0.53 % of
// the limit over 70 ms.
constexpr double kEnough_s = 2e-6;
constexpr double kAgainst = -0.7, kFollows = 0.3;
constexpr double kOther = 0.8;          // correlation with another axis
constexpr double kLittle = 0.25;        // share of the squared effort that the other may be sent
constexpr double kLeastOfOther = 0.05;  // share s of the other axis
constexpr double kExceeds = 0.9, kMostShare = 2.0;

double correlation(double uy, double uu, double yy) noexcept {
  const double square = uu * yy;
  return square > 0.0 ? uy / std::sqrt(square) : 0.0;
}

double poleShare(double frequency_hz, double period_s) noexcept {
  return 1.0 - std::exp(-2.0 * std::numbers::pi * frequency_hz * period_s);
}

}  // namespace

ResponseBand::ResponseBand(double high_hz, double period_s) noexcept
    : high_share_(poleShare(high_hz, period_s)), low_share_(poleShare(kLow_hz, period_s)) {}

double ResponseBand::pass(double value) noexcept {
  for (double& slow : high_) {
    slow += high_share_ * (value - slow);
    value -= slow;
  }
  for (double& smooth : low_) value = smooth += low_share_ * (value - smooth);
  return value;
}

ResponseJudge::ResponseJudge(const Models& models, int axes, double period_s) noexcept
    : axes_(axes), period_s_(period_s), kept_(std::exp(-period_s / kMemory_s)), effort_(axes) {
  for (int i = 0; i < axes_; ++i) {
    Axis& axis = at(i);
    axis.model = models[static_cast<std::size_t>(i)];
    const double periods = std::max(0.0, axis.model.delay_s / period_s);
    if (periods > kMostDelay - 4) axis.model.mass = 0.0;
    axis.whole = std::min(static_cast<int>(periods), kMostDelay - 4);
    // The second difference of positions under held efforts is a triangle of two periods.
    const double phi = std::min(periods - axis.whole, 1.0);
    axis.weights = {0.5 * (1.0 - phi) * (1.0 - phi), 0.5 + phi * (1.0 - phi), 0.5 * phi * phi};
  }
  begin();
}

void ResponseJudge::begin() noexcept {
  settles_ = static_cast<int>(kSettle_s / period_s_);
  fresh_ = true;
  for (int i = 0; i < axes_; ++i) {
    Axis& axis = at(i);
    axis.efforts = axis.responses = ResponseBand(kHigh_hz, period_s_);
    axis.faster = ResponseBand(kHigher_hz, period_s_);
    axis.uy = axis.yy = axis.uu = {};
    axis.length = 0;
    axis.above_tremor = 0.0;
  }
}

void ResponseJudge::send(const AxisEffort& effort) noexcept {
  effort_ = effort;
}

void ResponseJudge::filter(Axis& axis, double position, double effort) noexcept {
  axis.sent[static_cast<std::size_t>(newest_)] = effort;
  const double change = position - axis.before[0], last = axis.before[0] - axis.before[1];
  axis.before = {position, axis.before[0]};
  double acted = 0.0;
  for (int i = 0; i < 3; ++i) {
    const int back = (newest_ - axis.whole - i + 2 * kMostDelay) % kMostDelay;
    acted += axis.weights[static_cast<std::size_t>(i)] * axis.sent[static_cast<std::size_t>(back)];
  }
  axis.u = axis.efforts.pass(acted);
  axis.u_faster = axis.faster.pass(acted);
  axis.y = axis.responses.pass(axis.model.mass * (change - last) / (period_s_ * period_s_) +
                               axis.model.damping * (change + last) / (2.0 * period_s_));
}

void ResponseJudge::add(int axis) noexcept {
  Axis& own = at(axis);
  ++own.length;
  own.above_tremor = kept_ * own.above_tremor + own.u_faster * own.u_faster * period_s_;
  for (int j = 0; j < axes_; ++j) {
    const auto k = static_cast<std::size_t>(j);
    const Axis& other = at(j);
    own.uy[k] = kept_ * own.uy[k] + own.u * other.y * period_s_;
    own.yy[k] = kept_ * own.yy[k] + other.y * other.y * period_s_;
    own.uu[k] = kept_ * own.uu[k] + other.u * other.u * period_s_;
  }
}

bool ResponseJudge::anotherFollows(int axis) const noexcept {
  const Axis& own = at(axis);
  const auto a = static_cast<std::size_t>(axis);
  for (int j = 0; j < axes_; ++j) {
    const auto k = static_cast<std::size_t>(j);
    const ResponseModel& model = at(j).model;
    if (j == axis || model.mass <= 0.0) continue;
    // Axes of different kinds are compared by their limits.
    const double scale = model.effort_limit / own.model.effort_limit;
    if (own.uu[k] > kLittle * scale * scale * own.uu[a]) continue;
    if (own.uy[k] < kLeastOfOther * scale * own.uu[a]) continue;
    if (correlation(own.uy[k], own.uu[a], own.yy[k]) > kOther) return true;
  }
  return false;
}

void ResponseJudge::close(int axis) noexcept {
  Axis& own = at(axis);
  const auto a = static_cast<std::size_t>(axis);
  const double r = correlation(own.uy[a], own.uu[a], own.yy[a]);
  const double share = own.uy[a] / own.uu[a];
  const bool accuses = own.above_tremor > kAboveTremor * own.uu[a];
  if (accuses && (r < kAgainst || (r < kFollows && anotherFollows(axis)))) {
    own.contradictions += 2;
  } else if (accuses && r > kExceeds && share > kMostShare) {
    ++own.excesses;
  } else if (r > kFollows && share < kMostShare) {
    own.contradictions = std::max(own.contradictions - 1, 0);
    own.excesses = std::max(own.excesses - 2, 0);
  }
  own.uy = own.yy = own.uu = {};
  own.above_tremor = 0.0;
  own.length = 0;
}

bool ResponseJudge::isAstray(const AxisPosition& position) noexcept {
  if (axes_ == 0) return false;
  newest_ = (newest_ + 1) % kMostDelay;
  for (int i = 0; i < axes_; ++i) {
    if (fresh_) {
      at(i).before = {position[i], position[i]};
      at(i).sent.fill(effort_[i]);
    }
    filter(at(i), position[i], effort_[i]);
  }
  fresh_ = false;
  if (settles_ > 0) {
    --settles_;
    return false;
  }
  bool astray = false;
  for (int i = 0; i < axes_; ++i) {
    Axis& own = at(i);
    if (own.model.mass <= 0.0) continue;
    own.change += period_s_ / kMeanOver_s * (own.u * own.u - own.change);
    if (own.change < kChanges * own.model.effort_limit * own.model.effort_limit) continue;
    add(i);
    const double enough = kEnough_s * own.model.effort_limit * own.model.effort_limit;
    if (own.length * period_s_ < kLeastEpisode_s || own.uu[static_cast<std::size_t>(i)] < enough) {
      continue;
    }
    close(i);
    astray = astray || own.contradictions >= kMostContradictions || own.excesses >= kMostExcesses;
  }
  return astray;
}

}  // namespace wholehand
