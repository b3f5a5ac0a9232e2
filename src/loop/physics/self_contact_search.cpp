#include "loop/physics/self_contact_search.hpp"

#include "loop/model/capsule_gap.hpp"
#include "loop/physics/axis_closure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wholehand {
namespace {

/// An overlap smaller than this counts as a touch [m].
constexpr double kTouch_m = 2e-4;

PlacedSegment placed(const Pose* links, const Capsule& capsule) {
  const Pose& at = links[capsule.link];
  return {at * capsule.a_m, at * capsule.b_m, capsule.radius_m};
}

}  // namespace

SelfContactSearch::SelfContactSearch(const HandModel& hand)
    : fastest_(hand.axis_count), near_(hand.self_contacts.size()), q_s_(hand.axis_count) {
  for (const SelfPair& pair : hand.self_contacts) {
    pairs_.push_back({&hand.capsules[pair.capsule_a], &hand.capsules[pair.capsule_b]});
  }
  const std::vector<std::vector<ClosingChain>> chains = ClosingChain::ofAxes(hand);
  for (std::size_t axis = 0; axis < fastest_.size(); ++axis) {
    const auto speed = [&](int capsule) {
      for (const ClosingChain& chain : chains[axis]) {
        if (chain.capsule() == capsule) return chain.fastest();
      }
      return 0.0;
    };
    for (const SelfPair& pair : hand.self_contacts) {
      fastest_[axis] = std::max(fastest_[axis], speed(pair.capsule_a) + speed(pair.capsule_b));
    }
  }
}

void SelfContactSearch::reset(const Pose* links, const AxisPosition& q_s) noexcept {
  q_s_ = q_s;
  path_m_ = due_m_ = 0.0;
  for (Pair& pair : pairs_) {
    pair.due_m = 0.0;
    pair.let_go = capsuleGap(placed(links, *pair.a), placed(links, *pair.b)).distance_m < -kTouch_m;
  }
  look(links);
}

void SelfContactSearch::update(const Pose* links, const AxisPosition& q_s) noexcept {
  for (int a = 0; a < q_s.size(); ++a) {
    path_m_ += fastest_[a] * std::abs(q_s[a] - q_s_[a]);
  }
  q_s_ = q_s;
  count_ = 0;
  if (path_m_ >= due_m_) look(links);
}

void SelfContactSearch::look(const Pose* links) noexcept {
  count_ = 0;
  due_m_ = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    Pair& pair = pairs_[i];
    if (path_m_ >= pair.due_m) {
      const CapsuleGap gap = capsuleGap(placed(links, *pair.a), placed(links, *pair.b));
      pair.let_go = pair.let_go && gap.distance_m < 0.0;
      pair.due_m = path_m_ + std::max(0.0, gap.distance_m - kNear_m);
      if (gap.distance_m < kNear_m && !pair.let_go) {
        near_[count_++] = {static_cast<int>(i), gap};
      }
    }
    due_m_ = std::min(due_m_, pair.due_m);
  }
}

}  // namespace wholehand
