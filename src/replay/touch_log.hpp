#pragma once

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
};

/// The hand's interaction with one body.
struct BodyStory {
  std::string name;
  std::vector<Touch> touches;
  double travelled_m = 0.0;  ///< length of its path, steps under 1 mm (solver jitter) left out

  [[nodiscard]] double longest_s() const;
  [[nodiscard]] double largestForce_n() const;
  [[nodiscard]] double held_s() const;
};

/// Follows one body through a recording.
class TouchLog {
 public:
  TouchLog(int body, std::string name) : body_(body) { story_.name = std::move(name); }

  /// Adds the contact of a tick (no contact: touching = false).
  void contact(double time_s, double period_s, bool touching, double force_n, bool held);
  /// Adds the body's position of a tick.
  void position(const Eigen::Vector3d& position_m);
  /// A slot of a game is empty: where the next body appears is no way.
  void leave() { here_ = false; }
  [[nodiscard]] bool wasThere() const { return seen_; }
  [[nodiscard]] const BodyStory& story() const { return story_; }

 private:
  int body_;
  BodyStory story_;
  bool seen_ = false, here_ = false;
  Eigen::Vector3d anchor_m_ = Eigen::Vector3d::Zero();
};

}  // namespace wholehand
