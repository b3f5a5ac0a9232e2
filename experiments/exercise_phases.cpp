#include "experiments/exercise_phases.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

constexpr double kTouch_n = 0.1;  // least normal force of a touch
constexpr double kNear_m = 0.05;  // the palm is near within this distance
// Share of the largest force during the flow, above which the hand squeezes.
constexpr double kSqueezeShare = 0.1;
// Shorter gaps are ignored, because contacts flicker for some ticks.
constexpr double kApart_s = 0.2;

using Samples = std::vector<ExerciseSample>;

/// Walks back from `from` while `holds` is true, ignoring gaps of at most kApart_s. Returns the
/// first index of that stretch.
template <class Holds>
std::size_t walkBack(const Samples& samples, std::size_t from, Holds holds) {
  std::size_t first = from;
  for (std::size_t i = from; i-- > 0;) {
    if (holds(samples[i])) first = i;
    if (samples[first].time_s - samples[i].time_s > kApart_s) break;
  }
  return first;
}

bool touched(const ExerciseSample& s) {
  return s.fingers_n + s.thumb_n + s.palm_n > kTouch_n;
}

}  // namespace

std::optional<std::array<ExercisePhase, 4>> findPhases(const Samples& samples) {
  const auto flows = [](const ExerciseSample& s) { return s.flow_l_s > 0.0; };
  const auto first_flow = std::find_if(samples.begin(), samples.end(), flows);
  if (first_flow == samples.end()) return std::nullopt;
  const auto last_flow = std::find_if(samples.rbegin(), samples.rend(), flows).base() - 1;
  const auto pours = static_cast<std::size_t>(first_flow - samples.begin());
  const auto poured = static_cast<std::size_t>(last_flow - samples.begin());
  double firmest_n = 0.0;
  for (std::size_t i = pours; i <= poured; ++i) {
    firmest_n = std::max(firmest_n, samples[i].fingers_n + samples[i].thumb_n);
  }
  // A finger that rests on the dispenser when the palm arrives does not squeeze yet.
  const double squeeze_n = std::max(kTouch_n, kSqueezeShare * firmest_n);
  const std::size_t squeezes = walkBack(
      samples, pours, [&](const ExerciseSample& s) { return s.fingers_n + s.thumb_n > squeeze_n; });

  // α rises from zero before the squeeze, when the palm comes near.
  std::size_t rises = squeezes;
  while (rises > 0 && samples[rises].alpha > 0.0) --rises;
  std::size_t nears = rises;
  while (nears > 0 && samples[nears].palm_m < kNear_m) --nears;
  const auto bumps = [](const ExerciseSample& s) { return s.dorsal_n > kTouch_n; };
  const auto approach = samples.begin() + static_cast<std::ptrdiff_t>(nears);
  const auto first_bump = std::find_if(samples.begin(), approach, bumps);
  if (first_bump == approach || rises == squeezes) return std::nullopt;
  auto last_bump = approach;
  while (!bumps(*--last_bump)) {
  }
  std::size_t away = samples.size() - 1;
  while (away > poured && !touched(samples[away]) && !(samples[away].alpha > 0.0)) --away;
  return std::array<ExercisePhase, 4>{
      ExercisePhase{"bump", first_bump->time_s, last_bump->time_s},
      ExercisePhase{"approach", samples[nears].time_s, samples[squeezes].time_s},
      ExercisePhase{"squeeze", samples[squeezes].time_s, samples[poured].time_s},
      ExercisePhase{"release", samples[poured].time_s, samples[away].time_s}};
}

std::vector<ExerciseBump> findBumps(const Samples& samples, const ExercisePhase& phase) {
  std::vector<ExerciseBump> bumps;
  for (const ExerciseSample& s : samples) {
    if (s.time_s < phase.start_s || s.time_s > phase.end_s || s.dorsal_n <= kTouch_n) continue;
    if (bumps.empty() || s.time_s - bumps.back().end_s > kApart_s)
      bumps.push_back({s.time_s, 0, 0});
    bumps.back().end_s = s.time_s;
    bumps.back().contact_n = std::max(bumps.back().contact_n, s.dorsal_n);
  }
  return bumps;
}

double fadingTime_s(const Samples& samples, const std::vector<ExerciseBump>& bumps, int axis) {
  const auto hardest = std::max_element(
      bumps.begin(), bumps.end(),
      [](const ExerciseBump& a, const ExerciseBump& b) { return a.contact_n < b.contact_n; });
  if (hardest == bumps.end()) return 0.0;
  // Finds the longest stretch after the bump in which Φ falls monotonically and is above zero.
  const ExerciseSample *from = nullptr, *to = nullptr;
  for (const ExerciseSample& s : samples) {
    if (s.time_s <= hardest->end_s) continue;
    const bool falls = to != nullptr && s.phi[axis] < to->phi[axis];
    if (!falls && to != nullptr && to->time_s - from->time_s > 0.1) break;
    if (!falls) from = &s;
    if (s.phi[axis] < 0.01) break;
    to = &s;
  }
  if (from == nullptr || to == nullptr || to->time_s - from->time_s < 0.1) return 0.0;
  return (to->time_s - from->time_s) / std::log(from->phi[axis] / to->phi[axis]);
}

}  // namespace wholehand
