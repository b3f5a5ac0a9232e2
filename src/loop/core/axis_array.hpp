#pragma once

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <cstdint>
#include <type_traits>

namespace wholehand {

/// Most axes of a device.
inline constexpr int kMaxAxes = 16;
/// Most driven joints of a hand, base translations and rotations included.
inline constexpr int kMaxJoints = 32;

/// One number per axis or per joint. The tag names the quantity, so mixing two quantities does not
/// compile. Fixed capacity, no heap, trivially copyable; `vec()` is the array's Eigen view.
/// Real-time safe.
template <class Tag, int Capacity, class Number = double>
class TaggedArray {
 public:
  using Value = Number;
  using View = Eigen::Map<Eigen::VectorX<Number>>;
  using ConstView = Eigen::Map<const Eigen::VectorX<Number>>;

  TaggedArray() noexcept = default;
  /// @pre 0 <= size <= Capacity
  explicit TaggedArray(int size, Number value = {}) noexcept : size_(size) {
    for (int i = 0; i < size; ++i) values_[i] = value;
  }

  [[nodiscard]] static constexpr int capacity() noexcept { return Capacity; }
  [[nodiscard]] int size() const noexcept { return static_cast<int>(size_); }
  Number& operator[](int i) noexcept { return values_[i]; }
  Number operator[](int i) const noexcept { return values_[i]; }
  [[nodiscard]] const Number* begin() const noexcept { return values_.data(); }
  [[nodiscard]] const Number* end() const noexcept { return values_.data() + size_; }
  [[nodiscard]] Number* data() noexcept { return values_.data(); }
  [[nodiscard]] const Number* data() const noexcept { return values_.data(); }
  [[nodiscard]] View vec() noexcept { return View(values_.data(), size_); }
  [[nodiscard]] ConstView vec() const noexcept { return ConstView(values_.data(), size_); }

 private:
  std::array<Number, Capacity> values_{};
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

// One value per axis, in the axis's own unit (m or rad, and units derived from it).
using AxisPosition = TaggedArray<struct PositionTag, kMaxAxes>;    ///< [m or rad]
using AxisVelocity = TaggedArray<struct VelocityTag, kMaxAxes>;    ///< [m/s or rad/s]
using AxisEffort = TaggedArray<struct EffortTag, kMaxAxes>;        ///< [N or N·m]
using AxisStiffness = TaggedArray<struct StiffnessTag, kMaxAxes>;  ///< [N/m or N·m/rad]
using AxisDamping = TaggedArray<struct DampingTag, kMaxAxes>;      ///< [N·s/m or N·m·s/rad]
using AxisInertia = TaggedArray<struct InertiaTag, kMaxAxes>;      ///< [kg or kg·m²]
using AxisEnergy = TaggedArray<struct EnergyTag, kMaxAxes>;        ///< [J]
using AxisLength = TaggedArray<struct LengthTag, kMaxAxes>;        ///< [m]
using AxisTime = TaggedArray<struct TimeTag, kMaxAxes>;            ///< [s]
using AxisRatio = TaggedArray<struct RatioTag, kMaxAxes>;          ///< [1]
using AxisFlag = TaggedArray<struct FlagTag, kMaxAxes, bool>;

// One value per driven joint of the simulated hand.
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

[[nodiscard]] inline AxisEffort sum(const AxisEffort& a, const AxisEffort& b) noexcept {
  AxisEffort out(a.size());
  for (int i = 0; i < a.size(); ++i) out[i] = a[i] + b[i];
  return out;
}

[[nodiscard]] inline AxisEffort difference(const AxisEffort& a, const AxisEffort& b) noexcept {
  AxisEffort out(a.size());
  for (int i = 0; i < a.size(); ++i) out[i] = a[i] - b[i];
  return out;
}

}  // namespace wholehand
