#pragma once

#include "loop/adversarial/attack.hpp"
#include "support/seed.hpp"
#include "support/shipped.hpp"

/// Which device, hand, exercise and patient meet, and how.
namespace wholehand::test {

using Random = std::mt19937_64;

struct Case {
  std::string device, hand, exercise, patient;
  [[nodiscard]] std::string text() const {
    return patient + " in " + exercise + " with " + hand + " on " + device;
  }
};

/// Draws by the seed and the case alone: a case does the same among all and among few.
Random randomOf(const Case& c);

/// Loads what a case is made of, and keeps it for the next case; the world is built anew each time,
/// as the bodies of the last one lie about.
class Arena {
 public:
  /// Where the exercise is refused for this device: which keys are at fault.
  [[nodiscard]] std::vector<std::string> enter(const Case& c, int level);

  /// The patient, as shipped but for when it happens, who does the exercise, or grasps and fights
  /// where it has no virtual patient. `change` may change the rig. @pre enter()
  /// @return nothing where the hand starts inside a body
  std::optional<Outcome> run(const Case& c, int ticks, Random& random,
                             const std::function<void(Rig&)>& change = {});

 private:
  [[nodiscard]] PatientConfig person(const Case& c, Random& random) const;

  std::string place_;
  Models models_;
};

}  // namespace wholehand::test
