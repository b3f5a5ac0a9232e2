#include "assembly/inertia_polynomial.hpp"

#include "dynamics/articulated_body.hpp"
#include "dynamics/synergy.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

constexpr int kNodes = 18;          // per axis: the next term is below rounding over 180°
constexpr double kBeyond = 0.15;    // of the range, on either side: the avatar leaves it a little
constexpr double kLeast = 0x1p-54;  // share of the inertias below which a coefficient is left out
constexpr std::size_t kMostTerms = 400;  // more take the recorder too long

using Matrix = Eigen::ArrayXXd;
using Degrees = std::vector<double>;  // per axis

// Chebyshev nodes, and the matrix that makes coefficients of the values there.
struct Nodes {
  std::vector<double> at;
  Eigen::MatrixXd transform;
};

Nodes chebyshevNodes() {
  Nodes nodes{std::vector<double>(kNodes), Eigen::MatrixXd(kNodes, kNodes)};
  for (int n = 0; n < kNodes; ++n) {
    const double angle = std::numbers::pi * (n + 0.5) / kNodes;
    nodes.at[n] = std::cos(angle);
    for (int k = 0; k < kNodes; ++k) {
      nodes.transform(k, n) = (k == 0 ? 1.0 : 2.0) / kNodes * std::cos(k * angle);
    }
  }
  return nodes;
}

/// What the inertia has beyond that of the middle posture, by one axis and by two at once.
class Fit {
 public:
  Fit(const HandModel& hand, const DeviceModel& device, const AxisInertia& armature)
      : hand_(hand), synergy_(hand), body_(hand, armature), nodes_(chebyshevNodes()) {
    const auto axes = static_cast<std::size_t>(device.axisCount());
    out_.lower.assign(axes, 0.0);
    out_.upper.assign(axes, 0.0);
    for (std::size_t a = 0; a < axes; ++a) {
      const DeviceAxis& axis = device.axes[a];
      if (axis.kind != AxisKind::kRotation) continue;
      const double beyond = kBeyond * (axis.upper - axis.lower);
      out_.lower[a] = axis.lower - beyond;
      out_.upper[a] = axis.upper + beyond;
      moving_.push_back(a);
    }
    middle_ = AxisPosition(device.axisCount());
    for (const std::size_t a : moving_) middle_[static_cast<int>(a)] = place(a, 0.0);
    base_ = at(middle_);
  }

  RecordedInertia terms() {
    std::vector<std::vector<Matrix>> alone;
    for (const std::size_t a : moving_) alone.push_back(addAxis(a));
    for (std::size_t i = 0; i < moving_.size(); ++i) {
      for (std::size_t j = i + 1; j < moving_.size(); ++j) {
        addPair(moving_[i], moving_[j], alone[i], alone[j]);
      }
    }
    add(Degrees(out_.lower.size(), 0.0), base_);
    return collected();
  }

 private:
  [[nodiscard]] double place(std::size_t axis, double x) const {
    return 0.5 * (out_.lower[axis] + out_.upper[axis]) +
           0.5 * x * (out_.upper[axis] - out_.lower[axis]);
  }
  Matrix at(const AxisPosition& q_s) {
    JointPosition theta;
    synergy_.expand(q_s, theta);
    [[maybe_unused]] const bool definite =
        body_.update(theta, JointVelocity(hand_.joint_count), Eigen::Vector3d::Zero());
    return body_.reducedInertia().array();
  }
  void add(const Degrees& degrees, const Matrix& coefficients) {
    const auto [term, is_new] = all_.try_emplace(degrees, coefficients);
    if (!is_new) term->second += coefficients;
  }

  std::vector<Matrix> addAxis(std::size_t a) {
    std::vector<Matrix> beyond;
    for (const double x : nodes_.at) {
      AxisPosition q = middle_;
      q[static_cast<int>(a)] = place(a, x);
      beyond.push_back(at(q) - base_);
    }
    for (int k = 0; k < kNodes; ++k) {
      Matrix sum = Matrix::Zero(base_.rows(), base_.cols());
      for (int n = 0; n < kNodes; ++n) sum += nodes_.transform(k, n) * beyond[n];
      Degrees degrees(out_.lower.size(), 0.0);
      degrees[a] = k;
      add(degrees, sum);
    }
    return beyond;
  }

  void addPair(std::size_t a, std::size_t b, const std::vector<Matrix>& by_a,
               const std::vector<Matrix>& by_b) {
    const Matrix zero = Matrix::Zero(base_.rows(), base_.cols());
    std::vector<Matrix> half(kNodes * kNodes, zero);  // transformed along b
    for (int n = 0; n < kNodes; ++n) {
      for (int m = 0; m < kNodes; ++m) {
        AxisPosition q = middle_;
        q[static_cast<int>(a)] = place(a, nodes_.at[n]);
        q[static_cast<int>(b)] = place(b, nodes_.at[m]);
        const Matrix beyond = at(q) - base_ - by_a[n] - by_b[m];
        for (int l = 0; l < kNodes; ++l) half[n * kNodes + l] += nodes_.transform(l, m) * beyond;
      }
    }
    for (int k = 0; k < kNodes; ++k) {
      for (int l = 0; l < kNodes; ++l) {
        Matrix sum = zero;
        for (int n = 0; n < kNodes; ++n) sum += nodes_.transform(k, n) * half[n * kNodes + l];
        Degrees degrees(out_.lower.size(), 0.0);
        degrees[a] = k;
        degrees[b] = l;
        add(degrees, sum);
      }
    }
  }

  // Small terms first: the sum then has the rounding of the last.
  RecordedInertia collected() {
    const Eigen::VectorXd root = base_.matrix().diagonal().cwiseSqrt();
    const Matrix scale = (root * root.transpose()).array();
    std::vector<std::pair<double, const Degrees*>> order;
    for (auto& [degrees, coefficients] : all_) {
      const Matrix share = (coefficients / scale).abs();
      coefficients = (share > kLeast).select(coefficients, 0.0);
      if (share.maxCoeff() > kLeast) order.emplace_back(share.maxCoeff(), &degrees);
    }
    if (order.size() > kMostTerms) return {};
    std::sort(order.begin(), order.end(), [](const auto& x, const auto& y) {
      return std::tie(x.first, *x.second) < std::tie(y.first, *y.second);
    });
    for (const auto& [share, degrees] : order) {
      out_.degrees.insert(out_.degrees.end(), degrees->begin(), degrees->end());
      const Matrix& m = all_.at(*degrees);
      for (Eigen::Index i = 0; i < m.rows(); ++i) {
        for (Eigen::Index j = 0; j <= i; ++j) out_.coefficients.push_back(m(i, j));
      }
    }
    return out_;
  }

  const HandModel& hand_;
  Synergy synergy_;
  ArticulatedBody body_;
  Nodes nodes_;
  std::vector<std::size_t> moving_;  ///< axes
  AxisPosition middle_;
  Matrix base_;
  std::map<Degrees, Matrix> all_;
  RecordedInertia out_;
};

}  // namespace

RecordedInertia inertiaPolynomial(const HandModel& hand, const DeviceModel& device,
                                  const AxisInertia& armature) {
  return Fit(hand, device, armature).terms();
}

}  // namespace wholehand
