#pragma once

#include <Eigen/Core>

#include <limits>
#include <utility>
#include <vector>

namespace wholehand::bullet {

/// An axis-aligned box in the world frame. Initially empty.
struct WorldBox {
  Eigen::Vector3d low_m = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d high_m = Eigen::Vector3d::Constant(-std::numeric_limits<double>::infinity());
};

/// Real-time safe.
[[nodiscard]] inline bool overlap(const WorldBox& a, const WorldBox& b) noexcept {
  return a.low_m.x() <= b.high_m.x() && b.low_m.x() <= a.high_m.x() &&
         a.low_m.y() <= b.high_m.y() && b.low_m.y() <= a.high_m.y() &&
         a.low_m.z() <= b.high_m.z() && b.low_m.z() <= a.high_m.z();
}

/// True when `inner` lies within `outer`; false for NaN. Real-time safe.
[[nodiscard]] inline bool contains(const WorldBox& outer, const WorldBox& inner) noexcept {
  return (outer.low_m.array() <= inner.low_m.array()).all() &&
         (inner.high_m.array() <= outer.high_m.array()).all();
}

/// Finds the pairs of boxes that overlap. The boxes' intervals along x are sorted by insertion,
/// starting from the order of the last search, which has changed little. Only boxes whose intervals
/// overlap are compared. Real-time safe except for construction.
class BoxSweep {
 public:
  enum class Part : char {
    kNone,    ///< pairs with no other box
    kStands,  ///< fixed: pairs with awake boxes
    kRests,   ///< at rest: pairs with awake boxes of lower index
    kAwake,   ///< pairs with all boxes
  };
  using Pair = std::pair<int, int>;  ///< the lower index first

  /// @param owner per box: boxes of one owner form no pair @param most_pairs largest number of
  /// pairs of a search
  BoxSweep(const std::vector<int>& owner, std::size_t most_pairs);

  /// Lists the overlapping pairs of which at least one box is awake. @param boxes, parts per box
  void find(const std::vector<WorldBox>& boxes, const std::vector<Part>& parts) noexcept;
  void clear() noexcept;
  /// Pairs of the last search, ascending.
  [[nodiscard]] const std::vector<Pair>& pairs() const noexcept { return pairs_; }
  /// Number of pairs that the last search left out.
  [[nodiscard]] int dropped() const noexcept { return dropped_; }

 private:
  /// A box with all data of a comparison in one place.
  struct Entry {
    double low_x_m = 0.0, high_x_m = 0.0, low_y_m = 0.0, high_y_m = 0.0, low_z_m = 0.0,
           high_z_m = 0.0;
    int box = -1;
    int owner = -1;
    Part part = Part::kNone;
  };

  void sortEntries(const std::vector<WorldBox>& boxes, const std::vector<Part>& parts) noexcept;
  void compare(const Entry& one, const std::vector<Entry>& others, std::size_t first) noexcept;
  template <class Key>
  void sort(const std::vector<Pair>& from, std::vector<Pair>& to, Key key) noexcept;

  std::vector<Entry> entries_;  ///< ascending by their low ends along x
  std::vector<Entry> awake_;    ///< entries of awake boxes, in the same order
  const std::size_t most_pairs_;
  std::size_t count_ = 0;
  std::vector<Pair> found_;  ///< the first count_ in the order found; room for one more
  std::vector<Pair> sorted_, pairs_;
  std::vector<int> first_;  ///< per box: index of its first pair
  int dropped_ = 0;
};

}  // namespace wholehand::bullet
