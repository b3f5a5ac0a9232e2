#include "loop/physics/bullet/box_sweep.hpp"

#include <algorithm>
#include <utility>

namespace wholehand::bullet {

BoxSweep::BoxSweep(const std::vector<int>& owner, std::size_t most_pairs)
    : entries_(owner.size()),
      most_pairs_(most_pairs),
      found_(most_pairs + 1),
      sorted_(most_pairs),
      first_(owner.size() + 1) {
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    entries_[i].box = static_cast<int>(i);
    entries_[i].owner = owner[i];
  }
  awake_.reserve(owner.size());
  pairs_.reserve(most_pairs);
}

void BoxSweep::sortEntries(const std::vector<WorldBox>& boxes,
                           const std::vector<Part>& parts) noexcept {
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    Entry entry = entries_[i];
    const WorldBox& box = boxes[entry.box];
    entry.low_x_m = box.low_m.x(), entry.high_x_m = box.high_m.x();
    entry.low_y_m = box.low_m.y(), entry.high_y_m = box.high_m.y();
    entry.low_z_m = box.low_m.z(), entry.high_z_m = box.high_m.z();
    entry.part = parts[entry.box];
    std::size_t at = i;
    for (; at > 0 && entries_[at - 1].low_x_m > entry.low_x_m; --at) {
      entries_[at] = entries_[at - 1];
    }
    entries_[at] = entry;
  }
}

/// Compares a box with other boxes, sorted by their begin, that begin after it. A pair is always
/// written, and kept only if the boxes overlap: this avoids a branch that a processor cannot
/// predict.
void BoxSweep::compare(const Entry& one, const std::vector<Entry>& others,
                       std::size_t first) noexcept {
  for (std::size_t k = first; k < others.size() && others[k].low_x_m <= one.high_x_m; ++k) {
    const Entry& other = others[k];
    const bool overlap = (one.low_y_m <= other.high_y_m) & (other.low_y_m <= one.high_y_m) &
                         (one.low_z_m <= other.high_z_m) & (other.low_z_m <= one.high_z_m);
    const bool one_first = one.box < other.box;
    const Part lower = one_first ? one.part : other.part;
    const bool meet =
        (one.owner != other.owner) & (lower != Part::kRests) & (other.part != Part::kNone);
    const Pair pair = one_first ? Pair(one.box, other.box) : Pair(other.box, one.box);
    found_[count_] = pair;
    count_ += (overlap & meet) ? 1 : 0;
    if (count_ <= most_pairs_) continue;
    --count_;
    ++dropped_;
  }
}

/// A counting sort, which keeps the order of equal keys.
template <class Key>
void BoxSweep::sort(const std::vector<Pair>& from, std::vector<Pair>& to, Key key) noexcept {
  std::fill(first_.begin(), first_.end(), 0);
  for (std::size_t i = 0; i < count_; ++i) ++first_[key(from[i]) + 1];
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  for (std::size_t i = 0; i < count_; ++i) to[first_[key(from[i])]++] = from[i];
}

void BoxSweep::clear() noexcept {
  dropped_ = 0;
  pairs_.clear();
}

void BoxSweep::find(const std::vector<WorldBox>& boxes, const std::vector<Part>& parts) noexcept {
  sortEntries(boxes, parts);
  awake_.clear();
  for (const Entry& entry : entries_) {
    if (entry.part == Part::kAwake) awake_.push_back(entry);
  }
  dropped_ = 0;
  count_ = 0;
  std::size_t later = 0;  // the first awake box that begins after this one
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const Entry& entry = entries_[i];
    if (entry.part == Part::kAwake) {
      ++later;
      compare(entry, entries_, i + 1);
    } else if (entry.part != Part::kNone) {
      compare(entry, awake_, later);
    }
  }
  pairs_.resize(count_);
  sort(found_, sorted_, [](const Pair& pair) { return pair.second; });
  sort(sorted_, pairs_, [](const Pair& pair) { return pair.first; });
}

}  // namespace wholehand::bullet
