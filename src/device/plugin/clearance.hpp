#pragma once

#include <string>
#include <utility>

namespace wholehand {

struct Cleared;

/// Proof that a real device has a passport and was checked today: clearToArm() gives one. Without
/// it a device behind a driver is not armed where it may move a person.
class Clearance {
 public:
  /// For an experiment: nobody is attached to the device, and the recording says so.
  [[nodiscard]] static Clearance withoutPassport() { return Clearance(""); }

  /// Digest of the passport; empty: without one.
  [[nodiscard]] const std::string& passport() const noexcept { return passport_; }

 private:
  friend Cleared;
  explicit Clearance(std::string passport) : passport_(std::move(passport)) {}

  std::string passport_;
};

}  // namespace wholehand
