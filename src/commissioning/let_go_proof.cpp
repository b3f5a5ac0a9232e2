#include "commissioning/let_go_proof.hpp"

#include <Eigen/QR>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

constexpr double kOfSpeed = 0.5, kOfRange = 0.25;
constexpr double kOverFriction = 2.5;          // dry friction, times
constexpr double kActing = 0.5, kMoves = 0.3;  // of the push
constexpr std::size_t kLeastPlaces = 8;
constexpr double kStepsMoved = 15.0;

}  // namespace

LetGoProof::LetGoProof(const DeviceModel& model, double lasts_s, double share)
    : model_(&model), lasts_s_(lasts_s), share_(share) {}

const std::vector<double>& LetGoProof::push(const std::vector<double>& position) {
  if (!effort_.empty()) return effort_;
  for (std::size_t i = 0; i < position.size(); ++i) {
    const DeviceAxis& a = model_->axes[i];
    const bool has_weight = std::abs(a.neutral_effort) > 0.01 * a.effort_limit;
    const double towards = has_weight ? a.neutral_effort : 0.5 * (a.lower + a.upper) - position[i];
    const double slow = a.mass * kOfSpeed * a.speed_limit / lasts_s_;
    const double near = a.mass * kOfRange * (a.upper - a.lower) * 2.0 / (lasts_s_ * lasts_s_);
    const double room = share_ * a.effort_limit - std::abs(a.neutral_effort);
    const double most = std::min(std::max(kOverFriction * a.coulomb, std::min(slow, near)), room);
    push_.push_back(std::copysign(most, towards));
    effort_.push_back(a.neutral_effort + push_.back());
  }
  return effort_;
}

void LetGoProof::see(double at_s, const std::vector<double>& position) {
  if (seen_.empty() || at_s > seen_.back().at_s) seen_.push_back({at_s, position});
}

bool LetGoProof::moved() const {
  for (std::size_t i = 0; i < push_.size(); ++i) {
    if (seen_.empty()) return false;
    const double gone = seen_.back().position[i] - seen_.front().position[i];
    if (std::abs(gone) < kStepsMoved * model_->axes[i].encoder_step) return false;
  }
  return true;
}

// By a parabola through all places.
double LetGoProof::shareActing(std::size_t axis) const {
  const DeviceAxis& a = model_->axes[axis];
  const double middle_s = 0.5 * (seen_.front().at_s + seen_.back().at_s);
  Eigen::MatrixX3d m(static_cast<Eigen::Index>(seen_.size()), 3);
  Eigen::VectorXd q(m.rows());
  for (Eigen::Index k = 0; k < m.rows(); ++k) {
    const Seen& seen = seen_[static_cast<std::size_t>(k)];
    const double t = seen.at_s - middle_s;
    m.row(k) << 1.0, t, 0.5 * t * t;
    q[k] = seen.position[axis] - seen_.front().position[axis];
  }
  const Eigen::Vector3d found = m.colPivHouseholderQr().solve(q);
  const double moved = std::abs(q[q.size() - 1]);
  const double rubs = moved > a.encoder_step ? std::copysign(a.coulomb, found[1]) : 0.0;
  return (a.mass * found[2] + a.damping * found[1] + rubs) / push_[axis];
}

Diagnostics LetGoProof::still() const {
  Diagnostics out;
  for (std::size_t i = 0; i < push_.size(); ++i) {
    if (seen_.size() >= kLeastPlaces && shareActing(i) > kMoves) continue;
    const DeviceAxis& a = model_->axes[i];
    out.push_back({model_->path, 0, "axes", a.name,
                   fmt::format("was pushed with {:.3g} {} and did not move with it: nothing would "
                               "show whether that ends",
                               push_[i], a.effortUnit()),
                   "bring it between its ends, look for a brake, and repeat the step"});
  }
  return out;
}

Diagnostics LetGoProof::acting(const std::string& when) const {
  Diagnostics out;
  for (std::size_t i = 0; i < push_.size(); ++i) {
    const DeviceAxis& a = model_->axes[i];
    if (seen_.size() < kLeastPlaces) {
      out.push_back(keyFault(model_->path, "axes", a.name, "gave no samples " + when,
                             "let the controller run on, and repeat the step"));
      continue;
    }
    const double share = shareActing(i);
    if (share <= kActing) continue;
    out.push_back(
        keyFault(model_->path, "axes", a.name,
                 fmt::format("is still pushed with about {:.2g} {} {}: only its bits say that its "
                             "motor is off",
                             share * std::abs(push_[i]), a.effortUnit(), when),
                 "let the drive itself take the effort away, and repeat the step"));
  }
  return out;
}

}  // namespace wholehand
