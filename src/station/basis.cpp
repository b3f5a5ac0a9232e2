#include "station/basis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace wholehand {

void Basis::change(std::uint32_t client, std::string what) {
  ++number_;
  changes_.push_back({client, std::move(what)});
  if (changes_.size() > kRemembered) changes_.pop_front();
}

OrderReply Basis::refuseOutdated(std::uint32_t seen, std::uint32_t client) const {
  if (seen == number_) return {true, ""};
  if (seen == 0) {
    return refused(Refusal::kOtherVersion,
                   "the order does not say which person and limits it was shown (basis_seen, "
                   "docs/protocol.md): bring client and program to the same version");
  }
  std::string changed;
  const std::uint32_t since = number_ - seen;  // above changes_.size() for a number to come, too
  if (since > changes_.size()) changed = "this client was shown something else";
  for (std::size_t i = changes_.size() - std::min<std::size_t>(since, changes_.size());
       changed.empty() && i < changes_.size(); ++i) {
    if (changes_[i].client != client) changed = changes_[i].what;
  }
  if (changed.empty()) return {true, ""};
  return refused(
      Refusal::kBasisChanged,
      fmt::format("since this was shown it has changed: {}; look, then ask again", changed));
}

std::string Basis::differences(const SceneFacts& before, const PersonLimits& limits_before,
                               const SceneFacts& now, const PersonLimits& limits_now) {
  std::string out;
  const auto add = [&out](const std::string& what) { out += (out.empty() ? "" : ", ") + what; };
  if (now.visit.number != before.visit.number || now.visit.item != before.visit.item) {
    add(now.visit.number == 0 ? "no visit is open"
                              : fmt::format("visit {}, item {}", now.visit.number, now.visit.item));
  }
  if (now.profile != before.profile) {
    add(now.profile.empty() ? "no profile" : "profile " + now.profile);
  }
  if (now.hand.name != before.hand.name || now.hand.side != before.hand.side) {
    add(fmt::format("hand {} ({})", now.hand.name,
                    now.hand.side == Side::kLeft ? "left" : "right"));
  }
  if (now.exercise_name != before.exercise_name) add("exercise " + now.exercise_name);
  if (now.level != before.level) add(fmt::format("level {}", now.level));
  for (const auto& [name, value] : limits_now) {
    if (limits_before.of(name) != value) add(fmt::format("{} = {:.6g} N", name, value));
  }
  return out;
}

}  // namespace wholehand
