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

/// Proof that a rig's worst contacts were rehearsed on this machine, in this process, and passed.
/// Arming a device that moves a person requires it. Only rehearse() creates one.
class RehearsalPassed {
 public:
  /// Fingerprint of the rehearsed rig: device, hand, gains, scene, exercise and rate.
  [[nodiscard]] const std::string& of() const noexcept { return of_; }

 private:
  friend Expected<Rehearsal> rehearse(const Models& models, const AxisPosition& start,
                                      const RigOptions& rig, const RehearsalOptions& options);
  explicit RehearsalPassed(std::string of) : of_(std::move(of)) {}

  std::string of_;
};

}  // namespace wholehand
