#pragma once

#include "replay/moved_time.hpp"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace wholehand {

/// An interval in which the hand touched a body; gaps shorter than 0.2 s are bridged.
struct Touch {
  int body = 0;
  double from_s = 0.0, to_s = 0.0;
  double largest_force_n = 0.0;  ///< sum of the contact forces' magnitudes
  double held_s = 0.0;           ///< time with fingers on one side and thumb or palm on the other
  MovedTime moved;
};

/// One tick of a hand and a body.
struct BodyContact {
  double time_s = 0.0, duration_s = 0.0;
  double force_n = 0.0;  ///< sum of the contact forces' magnitudes
  bool held = false;
};

/// The hand's interaction with one body.
struct BodyStory {
  std::string name;
  std::vector<Touch> touches;
  /// Length of its path while the person moved the hand, steps under 1 mm (solver jitter) left out.
  double travelled_m = 0.0;

  /// The person's touches (moved_time.hpp).
  [[nodiscard]] std::vector<Touch> persons() const;
};

/// Follows one body through a recording.
class TouchLog {
 public:
  TouchLog(int body, std::string name) : body_(body) { story_.name = std::move(name); }

  /// Adds a tick in which the hand touches the body. @param before time moved before it @param now
  /// the same with it
  void contact(const BodyContact& contact, const MovedTime& before, const MovedTime& now);
  /// Adds the body's position of a tick. @param person the person moves the hand in it
  void position(const Eigen::Vector3d& position_m, bool person);
  /// A slot of a game is empty: where the next body appears is no way.
  void leave() { here_ = false; }
  [[nodiscard]] bool wasThere() const { return seen_; }
  [[nodiscard]] const BodyStory& story() const { return story_; }

 private:
  int body_;
  BodyStory story_;
  MovedTime begin_;  ///< of the last touch
  bool seen_ = false, here_ = false;
  Eigen::Vector3d anchor_m_ = Eigen::Vector3d::Zero();
};

}  // namespace wholehand
