#pragma once

#include "telemetry/recording.hpp"

#include <cstddef>
#include <utility>
#include <vector>

namespace wholehand::recording {

/// The avatar's reduced inertia M_r as the polynomial of its posture in /meta. Its arithmetic is
/// part of the file format. Private to telemetry.
class PostureInertia {
 public:
  PostureInertia(const RecordedInertia& inertia, std::size_t axes);

  /// Lower triangle of M_r, row by row. @param q_s position of every axis. Valid until the next
  /// call
  const std::vector<double>& at(const std::vector<double>& q_s);
  /// Solves M_r a = f with the matrix of the last at(), where the first `known` numbers of a are
  /// given and the others in: f. By L D Lᵀ of the block behind them.
  void solve(std::vector<double>& a, std::size_t known = 0);

 private:
  [[nodiscard]] static std::size_t place(std::size_t i, std::size_t j) {
    return i * (i + 1) / 2 + j;
  }
  void fillChebyshev(const std::vector<double>& q_s);

  /// A term: its factors, places in chebyshev_, and the coefficients that are not 0.
  struct Term {
    std::vector<std::size_t> factors;
    std::vector<std::pair<std::size_t, double>> coefficients;  ///< by places in matrix_
  };

  std::size_t axes_, degrees_;  ///< degrees_: largest degree + 1
  std::vector<double> lower_, upper_;
  std::vector<Term> terms_;
  std::vector<double> chebyshev_;  ///< axes x degrees
  std::vector<double> q_s_, matrix_, factor_;
};

}  // namespace wholehand::recording
