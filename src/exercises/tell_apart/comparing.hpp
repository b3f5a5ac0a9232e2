#pragma once

#include "loop/core/real_time.hpp"
#include "loop/psychometrics/comparison_block.hpp"

#include <cstdint>

namespace wholehand::tell_apart {

/// The lower bottle is squeezed first, the upper one second.
inline constexpr int kBottles = 2;

struct ComparingRules {
  LevelScale scale;
  int least_level = 0, most_level = 0;  ///< levels that may be offered
  int answers = 50;                     ///< at most ComparingRules::kMostAnswers
  double most_s = 600.0;                ///< the block ends then, however many answers it has
  double hold_s = 0.6;                  ///< mean time for which the asked depth is held
  int rest_every = 10;                  ///< the person rests after so many answers ...
  double rest_s = 5.0;                  ///< ... for so long
  std::uint64_t seed = 1;

  /// Answers that a place in the block can tell (Comparing::place()).
  static constexpr int kMostAnswers = 50;
};

/// Index of [[panel.instructions]].
enum class Instruction { kFirst, kSecond, kHold, kLetGo, kAnswer, kRest, kOneAtATime, kDone };

/// What the hand does in a tick.
struct HandNow {
  int at = -1;           ///< bottle that is felt completely; -1: none
  double pressed = 0.0;  ///< depth of the squeeze over the asked depth
  bool released = true;  ///< nothing is squeezed
  bool both = false;     ///< both bottles are squeezed
};

/// An answer that was said, not squeezed.
struct GivenAnswer {
  int bottle = -1;  ///< -1: none
  SaidBy by = SaidBy::kPlayer;
};

/// Changes in one tick.
struct ComparingChange {
  bool began = false;      ///< other stimuli hold from now on
  bool answered = false;   ///< Comparing::last() was answered
  int again = -1;          ///< this squeeze is repeated; it did not count
  bool too_early = false;  ///< an answer came before both squeezes and was ignored
  bool done = false;
};

/// State machine of a block: squeeze the lower bottle, the upper one, answer. Only the block's
/// answers and the program's time end it. Pure; real-time safe.
class Comparing {
 public:
  static constexpr double kAnswer_s = 60.0;  ///< later, the comparison is repeated

  /// @pre rules outlives this
  explicit Comparing(const ComparingRules& rules) noexcept : rules_(rules) { begin(0); }

  /// Begins the first comparison. @param order which of kOrders orders of the comparisons
  WHOLEHAND_RT void begin(std::uint64_t order) noexcept;
  static constexpr std::uint64_t kOrders = 4;

  /// The place in the block: its order and all answers, exact in a double. A block that begins at a
  /// place goes on alike.
  [[nodiscard]] WHOLEHAND_RT double place() const noexcept;
  /// Begins after the answers of a place; something else begins a new block.
  WHOLEHAND_RT void beginAt(double place) noexcept;

  WHOLEHAND_RT ComparingChange tick(const HandNow& hand, const GivenAnswer& said,
                                    double elapsed_s) noexcept;

  [[nodiscard]] Instruction instruction() const noexcept { return instruction_; }
  [[nodiscard]] bool done() const noexcept { return instruction_ == Instruction::kDone; }
  /// Bottle to be squeezed now; -1: none, or the person's choice.
  [[nodiscard]] int wanted() const noexcept {
    return done() || resting() || step_ >= kBottles ? -1 : step_;
  }
  [[nodiscard]] bool answering() const noexcept { return step_ == kBottles && !done(); }
  [[nodiscard]] const ComparisonBlock& block() const noexcept { return block_; }
  [[nodiscard]] int answers() const noexcept { return static_cast<int>(block_.answers().size()); }
  /// The comparison under way; when all are done, the last one.
  [[nodiscard]] WHOLEHAND_RT const Comparison& now() const noexcept {
    return block_.over() ? block_.answers().back() : block_.current();
  }
  /// ln of what a bottle has of the quantity, over the least: 0 for one of both.
  [[nodiscard]] WHOLEHAND_RT double amount(int bottle) const noexcept;
  /// A number of this comparison, evenly distributed from 0 to 1; the seed decides it.
  [[nodiscard]] WHOLEHAND_RT double varied(int which) const noexcept;
  /// Time for which the asked depth is held.
  [[nodiscard]] WHOLEHAND_RT double hold_s(int bottle) const noexcept {
    return rules_.hold_s * (0.75 + 0.5 * varied(bottle));
  }
  [[nodiscard]] double time_s() const noexcept { return time_s_; }
  [[nodiscard]] SaidBy saidBy() const noexcept { return said_by_; }

 private:
  [[nodiscard]] bool resting() const noexcept { return rest_left_s_ > 0.0; }
  void rewind() noexcept;
  void squeeze(const HandNow& hand, double elapsed_s, ComparingChange& news) noexcept;
  void listen(const HandNow& hand, double elapsed_s, ComparingChange& news) noexcept;
  void answer(int bottle, SaidBy by, ComparingChange& news) noexcept;
  void instruct(const HandNow& hand) noexcept;

  const ComparingRules& rules_;
  std::uint64_t order_ = 0;
  ComparisonBlock block_{LevelScale{}, 0, 0, 0};
  Instruction instruction_ = Instruction::kFirst;
  int step_ = 0;          ///< bottle of the squeeze; kBottles: the answer
  bool lets_go_ = false;  ///< the hand must open before the next step
  bool both_ = false;     ///< it lets go of both
  bool touched_ = false;  ///< this squeeze has begun
  int chosen_ = -1;       ///< bottle that the person squeezes as an answer
  double held_s_ = 0.0, waited_s_ = 0.0, rest_left_s_ = 0.0, time_s_ = 0.0;
  SaidBy said_by_ = SaidBy::kSqueeze;
};

}  // namespace wholehand::tell_apart
