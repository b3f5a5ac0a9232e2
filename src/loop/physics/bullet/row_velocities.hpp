#pragma once

#include "loop/physics/bullet/row_arithmetic.hpp"

#include <array>

/// The velocities that the hand's contacts with one body have changed so far: those of the axes,
/// and the body's. Rows read and change them, in memory or in registers, with the same bits.
/// @tparam Width as of iterate()
namespace wholehand::bullet {

/// Velocities in memory, for contacts with several bodies.
template <int Width>
class MemoryVelocities {
 public:
  /// @pre all outlive this: Width numbers, and twice four @param ends impulses of the coupled joint
  /// ends; null: none is coupled
  MemoryVelocities(double* axes, double* linear, double* angular, double* ends)
      : axes_(axes), linear_(linear), angular_(angular), ends_(ends) {}

  template <class Row>
  [[gnu::always_inline]] double along(const Row& row) const {
    return alongRow<Width>(row.jacobian.data(), axes_, row.linear.m_floats, linear_,
                           row.angular.m_floats, angular_);
  }
  template <class Row>
  [[gnu::always_inline]] void add(const Row& row, double impulse) {
    addScaled<4>(linear_, impulse, row.linear_response.m_floats);
    addScaled<4>(angular_, impulse, row.angular_response.m_floats);
    addScaled<Width>(axes_, impulse, row.response.data());
    if (ends_ != nullptr) addScaled<4>(ends_, impulse, row.end_shares.data());
  }

 private:
  double *axes_, *linear_, *angular_, *ends_;
};

/// Velocities in registers, for contacts with one body of which no joint end is coupled.
template <int Width>
class RegisterVelocities {
 public:
  [[gnu::always_inline]] RegisterVelocities(const double* axes, const double* linear,
                                            const double* angular) {
    for (int i = 0; i < Width / 4; ++i) load(axes_[i], axes + 4 * i);
    load(linear_, linear), load(angular_, angular);
  }
  [[gnu::always_inline]] void write(double* axes, double* linear, double* angular) const {
    for (int i = 0; i < Width / 4; ++i) store(axes_[i], axes + 4 * i);
    store(linear_, linear), store(angular_, angular);
  }

  template <class Row>
  [[gnu::always_inline]] double along(const Row& row) const {
    FourNumbers a, b;
    load(a, row.linear.m_floats), load(b, row.angular.m_floats);
    FourNumbers sum = a * linear_ + b * angular_;
    for (int i = 0; i < Width / 4; ++i) {
      load(a, row.jacobian.data() + 4 * i);
      sum += a * axes_[i];
    }
    return (sum[0] + sum[2]) + (sum[1] + sum[3]);
  }
  template <class Row>
  [[gnu::always_inline]] void add(const Row& row, double impulse) {
    FourNumbers more;
    load(more, row.linear_response.m_floats);
    linear_ += impulse * more;
    load(more, row.angular_response.m_floats);
    angular_ += impulse * more;
    for (int i = 0; i < Width / 4; ++i) {
      load(more, row.response.data() + 4 * i);
      axes_[i] += impulse * more;
    }
  }

 private:
  std::array<FourNumbers, Width / 4> axes_;
  FourNumbers linear_, angular_;
};

}  // namespace wholehand::bullet
