#include "replay/recording_marks.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace wholehand {
namespace {

constexpr std::array<std::pair<Fault, const char*>, 3> kRequests = {
    {{Fault::kStopRequested, "stop"},
     {Fault::kEmergencyStop, "emergency_stop"},
     {Fault::kOwnerSilent, "controls_lost"}}};

Fault without(Fault bits, Fault gone) {
  return static_cast<Fault>(static_cast<std::uint32_t>(bits) & ~static_cast<std::uint32_t>(gone));
}

}  // namespace

std::vector<RecordingMark> marksOf(const TickRecord& record, const TickRecord* before,
                                   const RecordingMeta& meta) {
  std::vector<RecordingMark> marks;
  const auto mark = [&](const char* kind, std::string text = {}, std::string axis = {}) {
    marks.push_back({record.time_s, kind, std::move(text), std::move(axis)});
  };
  const Fault begun = without(record.faults, before != nullptr ? before->faults : Fault::kNone);
  const SafetyState was = before != nullptr ? before->safety_state : SafetyState::kDisarmed;
  const bool is_armed =
      record.safety_state == SafetyState::kArmed || record.safety_state == SafetyState::kRendering;
  const bool was_armed = was == SafetyState::kArmed || was == SafetyState::kRendering;
  if (is_armed && !was_armed) mark("armed");
  for (const auto& [bit, kind] : kRequests) {
    if (any(begun & bit)) mark(kind);
  }
  if (const Fault stopping = begun & kStopping; any(stopping)) {
    const auto axis = static_cast<std::size_t>(record.fault_axis);
    mark("fault", faultNames(stopping),
         axis < meta.axis_names.size() ? meta.axis_names[axis] : std::string());
  }
  if (before != nullptr && before->authority > 0.0 && !(record.authority > 0.0)) mark("neutral");
  return marks;
}

}  // namespace wholehand
