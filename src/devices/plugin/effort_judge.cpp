#include "devices/plugin/effort_judge.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace wholehand {
namespace {

constexpr unsigned kLastSamples = 0b1111111;
constexpr int kBeyond = 3;  // of the last samples

}  // namespace

void RecentLeast::add(double value, std::int64_t until_ns) noexcept {
  while (count_ > 0 && at(count_ - 1).value >= value) --count_;
  if (count_ == kCapacity) {
    at(count_ - 1).until_ns = until_ns;
    return;
  }
  at(count_) = {value, until_ns};
  ++count_;
}

double RecentLeast::since(std::int64_t since_ns, double held_now) noexcept {
  while (count_ > 0 && at(0).until_ns < since_ns) {
    first_ = (first_ + 1) % kCapacity;
    --count_;
  }
  return count_ > 0 ? std::min(at(0).value, held_now) : held_now;
}

void EffortJudge::begin(double before, double effort, std::int64_t now_ns,
                        const EffortTolerance& tolerance) noexcept {
  tolerance_ = tolerance;
  beyond_ = 0;
  least_.clear();
  least_of_negative_.clear();
  effort_ = before;
  send(effort, now_ns);
}

void EffortJudge::send(double effort, std::int64_t now_ns) noexcept {
  least_.add(effort_, now_ns);
  least_of_negative_.add(-effort_, now_ns);
  effort_ = effort;
}

bool EffortJudge::allows(double measured, std::int64_t since_ns, bool may_be_less) noexcept {
  if (std::isnan(measured)) return true;
  double least = least_.since(since_ns, effort_);
  double most = -least_of_negative_.since(since_ns, -effort_);
  if (may_be_less) {
    least = std::min(least, 0.0);
    most = std::max(most, 0.0);
  }
  return measured >= least - tolerance_.share * std::abs(least) - tolerance_.effort &&
         measured <= most + tolerance_.share * std::abs(most) + tolerance_.effort;
}

bool EffortJudge::isAstray(double measured, std::int64_t since_ns, bool may_be_less) noexcept {
  const unsigned beyond = allows(measured, since_ns, may_be_less) ? 0 : 1;
  beyond_ = (beyond_ << 1U | beyond) & kLastSamples;
  return std::popcount(beyond_) >= kBeyond;
}

}  // namespace wholehand
