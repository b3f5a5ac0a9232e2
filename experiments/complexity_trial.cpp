#include "experiments/complexity_trial.hpp"

#include "loop/realtime/monotonic_clock.hpp"
#include "loop/runtime/interrupt_scope.hpp"
#include "rig/rig.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

namespace wholehand {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kSettle_s = 0.5;  // time until the hand is down; its ticks are not counted
constexpr int kTurn = 20;          // consecutive ticks of a scene before the next scene's turn

const std::vector<int>& countsOf(ComplexityKind kind) {
  static const std::array<std::vector<int>, kComplexityKinds> kCounts{{
      {0, 8, 16, 32, 64, 100, 120},  // pile
      {0, 8, 16, 32, 64, 100, 120},  // stacks
      {0, 30, 100, 300, 1000},       // apart
      {0, 30, 100, 300, 1000},       // far
      {10, 34, 130, 514, 970},       // vertices
      {0, 16, 32, 64, 120},          // contacts
  }};
  return kCounts.at(static_cast<std::size_t>(kind));
}

/// One scene with the measurements of all its passes.
class Lane {
 public:
  Lane(Models models, ComplexityPoint& point, const ComplexityPlan& plan)
      : models_(std::move(models)), point_(point), plan_(plan) {
    point_.bodies = static_cast<int>(models_.scene.bodies.size());
    settle_ = static_cast<std::uint64_t>(std::llround(kSettle_s / plan.period_s));
    least_ns_.assign(static_cast<std::size_t>(plan.ticks),
                     std::numeric_limits<std::int64_t>::max());
  }

  [[nodiscard]] std::uint64_t ticks() const {
    return settle_ + static_cast<std::uint64_t>(plan_.ticks);
  }

  Expected<Done> begin() {
    RigOptions options;
    options.engine = plan_.engine;
    options.period_s = plan_.period_s;
    const double duration_s = static_cast<double>(ticks()) * plan_.period_s;
    auto rig = buildRig(models_, swayingHand(models_.device, duration_s), options);
    if (!rig) return rig.errors();
    rig_ = std::move(*rig);
    return rig_->renderer->arm();
  }

  void tick(std::uint64_t k) {
    record_->tick = k;
    record_->time_s = static_cast<double>(k) * plan_.period_s;
    const std::int64_t begin_ns = threadCpuNow_ns();
    rig_->renderer->tick(1, *record_);
    const std::int64_t took_ns = threadCpuNow_ns() - begin_ns;
    point_.contacts = std::max(point_.contacts, record_->contact_count);
    point_.dropped = std::max(point_.dropped, record_->contacts_dropped);
    point_.faulted |= any(rig_->renderer->latched());
    if (k < settle_) return;
    std::int64_t& least_ns = least_ns_[k - settle_];
    least_ns = std::min(least_ns, took_ns);
    once_ns_.push_back(took_ns);
  }

  void finish() {
    std::sort(least_ns_.begin(), least_ns_.end());
    std::sort(once_ns_.begin(), once_ns_.end());
    const auto rank_us = [](const std::vector<std::int64_t>& sorted, double share) {
      const double at = std::ceil(share * static_cast<double>(sorted.size())) - 1.0;
      return 1e-3 * static_cast<double>(sorted.at(static_cast<std::size_t>(at)));
    };
    if (once_ns_.empty()) return;
    point_.p10_us = rank_us(least_ns_, 0.1);
    point_.p50_us = rank_us(least_ns_, 0.5);
    point_.p99_us = rank_us(least_ns_, 0.99);
    point_.p999_us = rank_us(least_ns_, 0.999);
    point_.p999_once_us = rank_us(once_ns_, 0.999);
  }

 private:
  Models models_;
  ComplexityPoint& point_;
  const ComplexityPlan& plan_;
  std::unique_ptr<Rig> rig_;
  std::unique_ptr<TickRecord> record_ = std::make_unique<TickRecord>();
  std::uint64_t settle_ = 0;
  std::vector<std::int64_t> least_ns_, once_ns_;
};

Expected<Done> addLanes(const Models& models, const ComplexityPlan& plan, ComplexityCurve& curve,
                        std::vector<Lane>& lanes) {
  const std::vector<int>& counts = countsOf(curve.kind);
  curve.points.resize(counts.size());
  for (std::size_t i = 0; i < counts.size(); ++i) {
    auto scene = complexityScene(curve.kind, counts[i], models);
    if (!scene) return scene.errors();
    Models its_own = models;
    its_own.scene = std::move(*scene);
    curve.points[i].count = counts[i];
    lanes.emplace_back(std::move(its_own), curve.points[i], plan);
  }
  return Done{};
}

void runPass(std::vector<Lane>& lanes) {
  const std::uint64_t ticks = lanes.empty() ? 0 : lanes.front().ticks();
  for (std::uint64_t k = 0; k < ticks; k += kTurn) {
    for (Lane& lane : lanes) {
      const std::uint64_t end = std::min<std::uint64_t>(ticks, k + kTurn);
      for (std::uint64_t i = k; i < end && !InterruptScope::interrupted(); ++i) lane.tick(i);
    }
  }
}

}  // namespace

double ComplexityCurve::exponent(int from) const {
  double n = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  for (const ComplexityPoint& p : points) {
    const double added_us = p.p50_us - points.front().p50_us;
    if (p.count < from || !(added_us > 0.0)) continue;
    const double x = std::log(static_cast<double>(p.count));
    const double y = std::log(added_us);
    n += 1.0;
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  return n < 2.0 ? kNaN : (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

double ComplexityCurve::admitted(double limit_us, bool& all) const {
  all = false;
  const ComplexityPoint* before = nullptr;
  for (const ComplexityPoint& p : points) {
    if (p.faulted || p.p999_us > limit_us) {
      if (before == nullptr) return -1.0;
      if (p.faulted) return before->count;
      const double share = (limit_us - before->p999_us) / (p.p999_us - before->p999_us);
      return std::floor(before->count + share * (p.count - before->count));
    }
    before = &p;
  }
  all = before != nullptr;
  return before == nullptr ? -1.0 : before->count;
}

Expected<ComplexityResult> measureComplexity(const ComplexityPlan& plan) {
  auto models = loadModels(plan.files);
  if (!models) return models.errors();
  ComplexityResult result;
  for (int i = 0; i < kComplexityKinds; ++i) {
    const auto kind = static_cast<ComplexityKind>(i);
    if (std::string(complexityName(kind)).find(plan.only) == std::string::npos) continue;
    result.curves.emplace_back().kind = kind;
  }
  if (result.curves.empty()) {
    std::string names;
    for (int i = 0; i < kComplexityKinds; ++i) {
      names += (i > 0 ? ", " : "") + std::string(complexityName(static_cast<ComplexityKind>(i)));
    }
    return Diagnostic{"", 0, "--only", plan.only, "is part of no name", "use part of " + names};
  }
  std::vector<Lane> lanes;
  for (ComplexityCurve& curve : result.curves) {
    if (auto added = addLanes(*models, plan, curve, lanes); !added) return added.errors();
  }
  for (int pass = 1; pass <= plan.passes && !InterruptScope::interrupted(); ++pass) {
    if (plan.status) plan.status(pass, plan.passes);
    for (Lane& lane : lanes) {
      if (auto begun = lane.begin(); !begun) return begun.errors();
    }
    runPass(lanes);
  }
  for (Lane& lane : lanes) lane.finish();
  result.interrupted = InterruptScope::interrupted();
  return result;
}

}  // namespace wholehand
