#include "loop/physics/hand_overlaps.hpp"

#include <array>
#include <charconv>

namespace wholehand {
namespace {

std::string millimetres(double length_m) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), length_m * 1e3,
                                 std::chars_format::fixed, 1);
  return {text.data(), end.ptr};
}

}  // namespace

void HandOverlaps::add(int body, int capsule, double depth_m) {
  Deepest& found = deepest_[body];
  if (depth_m > found.depth_m) found = {depth_m, capsule};
}

Diagnostics HandOverlaps::refuse(const HandModel& hand, const std::string& scene_path,
                                 const std::vector<std::string>& body_names) const {
  Diagnostics errors;
  for (std::size_t i = 0; i < deepest_.size(); ++i) {
    if (deepest_[i].capsule < 0) continue;
    const Capsule& capsule = hand.capsules[deepest_[i].capsule];
    errors.push_back(keyFault(scene_path, "bodies." + body_names[i], "",
                              "starts " + millimetres(deepest_[i].depth_m) +
                                  " mm inside the hand (its " + capsule.name + ")",
                              "move the body, or let the motion start elsewhere"));
  }
  return errors;
}

}  // namespace wholehand
