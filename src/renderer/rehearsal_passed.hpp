#pragma once

#include "core/axis_array.hpp"
#include "core/expected.hpp"

#include <string>
#include <utility>

namespace wholehand {

struct Models;
struct Rehearsal;
struct RehearsalOptions;
struct RigOptions;

/// Says that the worst contacts of a rig were rehearsed on this machine, in this process, and
/// passed: what a device that moves a person is armed with. Only rehearse() makes one.
class RehearsalPassed {
 public:
  /// Fingerprint of what was rehearsed: device, hand, gains, scene, exercise and rate.
  [[nodiscard]] const std::string& of() const noexcept { return of_; }

 private:
  friend Expected<Rehearsal> rehearse(const Models& models, const AxisPosition& start,
                                      const RigOptions& rig, const RehearsalOptions& options);
  explicit RehearsalPassed(std::string of) : of_(std::move(of)) {}

  std::string of_;
};

}  // namespace wholehand
