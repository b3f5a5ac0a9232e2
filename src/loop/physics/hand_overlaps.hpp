#pragma once

#include "loop/core/expected.hpp"
#include "loop/model/hand_model.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace wholehand {

/// Collects the overlaps of a placed hand with bodies and reports them, because an engine would
/// throw an overlapping body away. Not real-time safe.
class HandOverlaps {
 public:
  explicit HandOverlaps(std::size_t bodies) : deepest_(bodies) {}

  void add(int body, int capsule, double depth_m);
  /// Returns one error per body, for its deepest overlap; up to 0.2 mm is allowed.
  [[nodiscard]] Diagnostics refuse(const HandModel& hand, const std::string& scene_path,
                                   const std::vector<std::string>& body_names) const;

 private:
  struct Deepest {
    double depth_m = 2e-4;
    int capsule = -1;
  };
  std::vector<Deepest> deepest_;
};

}  // namespace wholehand
