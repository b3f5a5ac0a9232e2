#pragma once

#include "loop/adversarial/attack.hpp"
#include "support/seed.hpp"
#include "support/shipped.hpp"

/// Combines a device, a hand, an exercise and a patient into one test case.
namespace wholehand::test {

using Random = std::mt19937_64;

struct Case {
  std::string device, hand, exercise, patient;
  [[nodiscard]] std::string text() const {
    return patient + " in " + exercise + " with " + hand + " on " + device;
  }
};

/// A generator seeded by the seed and the case alone: a case gives the same run in any selection.
Random randomOf(const Case& c);

/// Loads the models of a case and keeps them for the next case. The world is built anew for each
/// run, since the last run has moved its bodies.
class Arena {
 public:
  /// Loads the models of a case. @return the keys that the exercise finds at fault in this device
  [[nodiscard]] std::vector<std::string> enter(const Case& c, int level);

  /// Runs the shipped patient with random times of its habits. The patient does the exercise; an
  /// exercise without a virtual patient gets a patient who grasps and fights. `change` may change
  /// the rig. @pre enter()
  /// @return nullopt where the hand starts inside a body
  std::optional<Outcome> run(const Case& c, int ticks, Random& random,
                             const std::function<void(Rig&)>& change = {});

 private:
  [[nodiscard]] PatientConfig person(const Case& c, Random& random) const;

  std::string place_;
  Models models_;
};

}  // namespace wholehand::test
