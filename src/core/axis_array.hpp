#pragma once

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <cstdint>
#include <type_traits>

namespace wholehand {

/// The most axes a device may have.
inline constexpr int kMaxAxes = 16;
/// The most driven joints a hand may have (base translations and rotations included).
inline constexpr int kMaxJoints = 32;

/// One number per axis (or per joint), with a tag that tells positions, velocities and efforts
/// apart so that mixing them does not compile. Fixed capacity, no heap, trivially copyable; Eigen
/// sees it through `vec()`. Real-time safe.
template <class Tag, int Capacity>
class TaggedArray {
 public:
  using View = Eigen::Map<Eigen::VectorXd>;
  using ConstView = Eigen::Map<const Eigen::VectorXd>;

  TaggedArray() noexcept = default;
  /// @pre 0 <= size <= Capacity
  explicit TaggedArray(int size, double value = 0.0) noexcept : size_(size) {
    for (int i = 0; i < size; ++i) values_[i] = value;
  }

  [[nodiscard]] static constexpr int capacity() noexcept { return Capacity; }
  [[nodiscard]] int size() const noexcept { return static_cast<int>(size_); }
  double& operator[](int i) noexcept { return values_[i]; }
  double operator[](int i) const noexcept { return values_[i]; }
  [[nodiscard]] const double* begin() const noexcept { return values_.data(); }
  [[nodiscard]] const double* end() const noexcept { return values_.data() + size_; }
  [[nodiscard]] double* data() noexcept { return values_.data(); }
  [[nodiscard]] const double* data() const noexcept { return values_.data(); }
  [[nodiscard]] View vec() noexcept { return View(values_.data(), size_); }
  [[nodiscard]] ConstView vec() const noexcept { return ConstView(values_.data(), size_); }

 private:
  std::array<double, Capacity> values_{};
  std::int64_t size_ = 0;
};

/// True when every element is finite. Real-time safe.
template <class Tag, int Capacity>
[[nodiscard]] bool allFinite(const TaggedArray<Tag, Capacity>& a) noexcept {
  for (double v : a) {
    if (!std::isfinite(v)) return false;
  }
  return true;
}

// Per axis, in the axis's own unit (m or rad and what follows from it).
using AxisPosition = TaggedArray<struct PositionTag, kMaxAxes>;  ///< [m or rad]
using AxisVelocity = TaggedArray<struct VelocityTag, kMaxAxes>;  ///< [m/s or rad/s]
using AxisEffort = TaggedArray<struct EffortTag, kMaxAxes>;      ///< [N or N·m]
using AxisRatio = TaggedArray<struct RatioTag, kMaxAxes>;        ///< [1]
using AxisEnergy = TaggedArray<struct EnergyTag, kMaxAxes>;      ///< [J]

// Per driven joint of the simulated hand.
using JointPosition = TaggedArray<struct PositionTag, kMaxJoints>;  ///< [m or rad]
using JointVelocity = TaggedArray<struct VelocityTag, kMaxJoints>;  ///< [m/s or rad/s]
using JointEffort = TaggedArray<struct EffortTag, kMaxJoints>;      ///< [N or N·m]

static_assert(std::is_trivially_copyable_v<AxisPosition>);
static_assert(std::is_trivially_copyable_v<JointPosition>);

/// A small dense matrix over the axes; no heap, any size up to kMaxAxes.
using AxisMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxAxes, kMaxAxes>;
/// A small dense matrix over the joints; no heap, any size up to kMaxJoints.
using JointMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxJoints, kMaxJoints>;
/// Joints x axes: the shape of the synergy map G.
using JointAxisMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxJoints, kMaxAxes>;

}  // namespace wholehand
