#include "exercises/tell_apart/comparing.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand::tell_apart {
namespace {

/// Share of the asked depth from which on a squeeze has begun, and one that answers.
constexpr double kBegun = 0.2, kChooses = 0.5;
constexpr double kAnswerHeld_s = 0.3;

// A place is order · 2^51 + a one and then a binary digit for each answer. With fifty answers it is
// less than 2^53.
constexpr int kOrderShift = 51;
static_assert(ComparingRules::kMostAnswers < kOrderShift);
static_assert(Comparing::kOrders << kOrderShift <= std::uint64_t{1} << 53);

}  // namespace

void Comparing::begin(std::uint64_t order) noexcept {
  order_ = order % kOrders;
  block_ = ComparisonBlock(rules_.scale, std::min(rules_.answers, ComparingRules::kMostAnswers),
                           rules_.most_level, splitMix64(rules_.seed ^ order_ << 32),
                           rules_.least_level);
  said_by_ = SaidBy::kSqueeze;
  rest_left_s_ = time_s_ = 0.0;
  both_ = false;
  rewind();
  lets_go_ = false;
  instruct({});
}

double Comparing::place() const noexcept {
  std::uint64_t code = 1;
  for (const Comparison& answer : block_.answers()) code = code << 1 | (answer.said_second ? 1 : 0);
  return static_cast<double>(order_ << kOrderShift | code);
}

void Comparing::beginAt(double place) noexcept {
  const bool is_place = place >= 1.0 && place < 0x1p53 && place == std::floor(place);
  const auto whole = static_cast<std::uint64_t>(is_place ? place : 1.0);
  const std::uint64_t code = whole & ((std::uint64_t{1} << kOrderShift) - 1);
  begin(whole >> kOrderShift);
  int digits = 0;
  while (code >> digits > 1) ++digits;
  for (int i = digits - 1; i >= 0 && !block_.over(); --i) block_.answer((code >> i & 1) != 0);
  instruct({});
}

double Comparing::amount(int bottle) const noexcept {
  const double x = now().x;
  return (x > 0.0) == (bottle == 1) ? std::abs(x) : 0.0;
}

double Comparing::varied(int which) const noexcept {
  const auto number = static_cast<std::uint64_t>(answers() * 16 + which);
  return static_cast<double>(splitMix64(rules_.seed + (order_ << 32) + (number << 40)) >> 11) *
         0x1p-53;
}

// Begins the comparison under way from its first squeeze.
void Comparing::rewind() noexcept {
  step_ = 0;
  lets_go_ = true;
  touched_ = false;
  chosen_ = -1;
  held_s_ = waited_s_ = 0.0;
}

ComparingChange Comparing::tick(const HandNow& hand, const GivenAnswer& said,
                                double elapsed_s) noexcept {
  ComparingChange news;
  if (done()) return news;
  time_s_ += elapsed_s;
  if (block_.over() || time_s_ >= rules_.most_s) {
    instruction_ = Instruction::kDone;
    news.done = true;
    return news;
  }
  if (said.bottle >= 0 && !answering()) news.too_early = true;
  if (hand.both && !resting()) {
    news.again = std::min(step_, kBottles - 1);
    both_ = lets_go_ = true;
    touched_ = false;
    chosen_ = -1;
    held_s_ = 0.0;
  } else if (answering() && said.bottle >= 0) {
    answer(said.bottle, said.by, news);
  } else if (lets_go_) {
    lets_go_ = !hand.released;
    if (hand.released) both_ = false;
  } else if (resting()) {
    if (hand.released) rest_left_s_ -= elapsed_s;
  } else if (!answering()) {
    squeeze(hand, elapsed_s, news);
  } else {
    listen(hand, elapsed_s, news);
  }
  instruct(hand);
  return news;
}

void Comparing::squeeze(const HandNow& hand, double elapsed_s, ComparingChange& news) noexcept {
  const bool here = hand.at == step_;
  if (here && hand.pressed >= 1.0) held_s_ += elapsed_s;
  if (here && hand.pressed >= kBegun) touched_ = true;
  if (held_s_ >= hold_s(step_)) {
    ++step_;
    lets_go_ = true;
    touched_ = false;
    held_s_ = waited_s_ = 0.0;
  } else if (touched_ && hand.released) {
    news.again = step_;
    touched_ = false;
    held_s_ = 0.0;
  }
}

// Waits for the answer. After a minute the person does not remember the squeezes well.
void Comparing::listen(const HandNow& hand, double elapsed_s, ComparingChange& news) noexcept {
  waited_s_ += elapsed_s;
  const int pressed = hand.pressed >= kChooses ? hand.at : -1;
  held_s_ = pressed >= 0 && pressed == chosen_ ? held_s_ + elapsed_s : 0.0;
  chosen_ = pressed;
  if (held_s_ >= kAnswerHeld_s) {
    answer(chosen_, SaidBy::kSqueeze, news);
  } else if (waited_s_ > kAnswer_s) {
    news.again = 0;
    rewind();
  }
}

void Comparing::answer(int bottle, SaidBy by, ComparingChange& news) noexcept {
  block_.answer(bottle == 1);
  said_by_ = by;
  news.answered = news.began = true;
  if (!block_.over() && answers() % rules_.rest_every == 0) rest_left_s_ = rules_.rest_s;
  rewind();
}

void Comparing::instruct(const HandNow& hand) noexcept {
  if (lets_go_) {
    instruction_ = both_ ? Instruction::kOneAtATime : Instruction::kLetGo;
  } else if (resting()) {
    instruction_ = Instruction::kRest;
  } else if (answering()) {
    instruction_ = Instruction::kAnswer;
  } else if (hand.at == step_ && hand.pressed >= 1.0) {
    instruction_ = Instruction::kHold;
  } else {
    instruction_ = step_ == 0 ? Instruction::kFirst : Instruction::kSecond;
  }
}

}  // namespace wholehand::tell_apart
