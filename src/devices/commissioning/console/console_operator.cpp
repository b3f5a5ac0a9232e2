#include "devices/commissioning/console/console_operator.hpp"

#include "devices/commissioning/commissioning.hpp"
#include "loop/core/expected.hpp"

#include <algorithm>
#include <chrono>
#include <tuple>
#include <utility>
#include <variant>

namespace wholehand {
namespace {

using Facts = CommissioningFacts;

constexpr std::chrono::milliseconds kLook{5};
constexpr std::size_t kLongestAnswer = 64;

std::vector<int> placesOf(const std::vector<int>& steps) {
  std::vector<int> places(kCommissioningSteps, -1);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    places.at(static_cast<std::size_t>(steps[i])) = static_cast<int>(i);
  }
  return places;
}

// Name of the next step by default: the first one that is not done.
std::string nextOf(const Facts& facts) {
  const auto next = std::find_if(facts.steps.begin(), facts.steps.end(),
                                 [](const Facts::Step& s) { return s.state != StepState::kDone; });
  return next == facts.steps.end() ? std::string() : next->name;
}

}  // namespace

void HoldSwitch::beat(std::uint32_t claim, std::uint32_t press, std::int64_t now_ns) noexcept {
  const auto newest = std::tie(claim_, press_);
  const auto this_one = std::tie(claim, press);
  if (this_one < newest) return;
  check(now_ns);
  if (newest < this_one) {
    std::tie(claim_, press_) = this_one;
    began_ns_ = now_ns;
    alive_ = true;
  }
  if (alive_) beat_ns_ = now_ns;
}

// A timeout is final: later heartbeats belong to a press that has ended.
void HoldSwitch::check(std::int64_t now_ns) noexcept {
  if (now_ns - beat_ns_ > kSilent_ns) alive_ = false;
}

bool HoldSwitch::held(std::int64_t now_ns) noexcept {
  check(now_ns);
  return alive_ && beat_ns_ - began_ns_ >= kClick_ns;
}

ConsoleOperator::ConsoleOperator(CommissioningFacts about, const std::vector<int>& steps,
                                 std::function<std::int64_t()> now_ns, std::function<bool()> ended)
    : places_(placesOf(steps)), now_ns_(std::move(now_ns)), ended_(std::move(ended)) {
  for (const int step : steps) {
    about.steps.push_back({stepName(static_cast<CommissioningStep>(step)), {}, {}, {}, {}});
  }
  facts_ = std::make_shared<const Facts>(std::move(about));
}

template <class Change>
void ConsoleOperator::publish(Change&& change) {
  auto changed = std::make_shared<Facts>(*facts_);
  change(*changed);
  facts_ = std::move(changed);
}

std::shared_ptr<const CommissioningFacts> ConsoleOperator::facts() const {
  const std::lock_guard lock(mutex_);
  return facts_;
}

LoopStatus ConsoleOperator::status() const {
  LoopStatus status;
  status.silent = silent_.load();
  status.device.emplace();
  return status;
}

void ConsoleOperator::finish(const std::string& file) {
  const std::lock_guard lock(mutex_);
  publish([&](Facts& f) { f.passport = file; });
}

// Publishes a line. A line without findings is an error in an answer, or the name of a written
// file.
void ConsoleOperator::reportLine(const std::string& line,
                                 const std::vector<FoundFigure>& findings) {
  const std::lock_guard lock(mutex_);
  publish([&](Facts& f) {
    if (findings.empty()) f.note = line;
    if (step_ < 0) return;
    auto& shown = f.steps[step_].findings;
    for (const FoundFigure& found : findings) {
      shown.push_back({found.axis, found.quantity, found.unit, found.lower, found.upper});
    }
  });
}

void ConsoleOperator::reportStep(const StepNews& news) {
  const std::lock_guard lock(mutex_);
  const int place = places_.at(static_cast<std::size_t>(news.step));
  if (place < 0) return;
  publish([&](Facts& f) {
    Facts::Step& step = f.steps[place];
    f.note.clear();
    if (news.state == StepState::kUnderWay) {
      step = {step.name, StepState::kUnderWay, {}, {}, {}};
      return;
    }
    step.state = news.state;
    for (const Diagnostic& d : news.why) {
      step.problem += (step.problem.empty() ? "" : "; ") +
                      (d.value.empty() ? d.problem : d.value + " " + d.problem);
      step.remedy = d.remedy;
    }
  });
  step_ = news.state == StepState::kUnderWay ? place : -1;
}

void ConsoleOperator::reportMotion(const Motion& motion, MotionState state) {
  const std::lock_guard lock(mutex_);
  publish([&](Facts& f) {
    f.motion = motion.what;
    f.motion_state = state;
    f.motion_s = motion.duration_s;
    f.axis = motion.axis;
    if (state != MotionState::kOver) f.note.clear();
  });
}

std::optional<std::string> ConsoleOperator::ask(const Question& question,
                                                const std::function<void()>& meanwhile) {
  std::unique_lock lock(mutex_);
  switch_.end();  // a key held before a question does not count for the motion after it
  answer_.reset();
  publish([&](Facts& f) {
    ++f.question;
    f.asked = question.about;
    f.axis = question.axis;
    f.unit = question.unit;
    f.lower = question.lower;
    f.upper = question.upper;
    f.next = nextOf(f);
  });
  while (!ended_() && !answer_) {
    lock.unlock();
    meanwhile();
    lock.lock();
    answered_.wait_for(lock, kLook, [this] { return answer_.has_value(); });
  }
  publish([](Facts& f) {
    f.asked = QuestionKind::kNothing;
    f.note.clear();
  });
  return std::exchange(answer_, std::nullopt);
}

bool ConsoleOperator::holdsKey() {
  if (ended_()) return false;
  const std::lock_guard lock(mutex_);
  return switch_.held(now_ns_());
}

void ConsoleOperator::order(const Order& order, std::function<void(OrderReply)> done) {
  OrderReply reply;
  {
    const std::lock_guard lock(mutex_);
    reply = apply(order);
  }
  done(std::move(reply));
}

OrderReply ConsoleOperator::apply(const Order& order) {
  const auto accept = [&](bool ends) {
    if (ends) switch_.end();
    return OrderReply{true, ""};
  };
  return std::visit(
      Overloaded{[&](const orders::Answer& answer) { return takeAnswer(answer); },
                 [&](const orders::HoldToMove& hold) { return this->hold(hold, order.claim); },
                 [&](const orders::Stop&) { return accept(true); },
                 [&](const orders::Rest&) { return accept(true); },
                 [&](const orders::EmergencyStop&) { return accept(true); },
                 // These orders arrive when the controls were released or taken over.
                 [&](const orders::Steer&) { return accept(true); },
                 [&](const orders::HolderAlive& holder) { return accept(!holder.alive); },
                 [&](const orders::UnattendedEnds&) { return accept(false); },
                 [&](const orders::Unattended&) { return accept(false); },
                 [&](const auto&) {
                   OrderReply no = notHere(order);
                   no.reason += ": a device is being commissioned here";
                   return no;
                 }},
      order.what);
}

OrderReply ConsoleOperator::takeAnswer(const orders::Answer& answer) {
  const bool asked = facts_->asked != QuestionKind::kNothing;
  if (!asked || answer.question != facts_->question || answer_) {
    return refused(Refusal::kNotAsked, "that is not what is asked now");
  }
  if (answer.text.size() > kLongestAnswer) {
    return refused(Refusal::kOutOfRange, "an answer has at most 64 characters");
  }
  answer_ = answer.text;
  answered_.notify_all();
  return {true, ""};
}

// A held key counts only while a motion waits for it. A button that is kept down after a question
// must be pressed again.
OrderReply ConsoleOperator::hold(const orders::HoldToMove& hold, std::uint32_t claim) {
  switch_.beat(claim, hold.press, now_ns_());
  if (!hold.held || facts_->asked != QuestionKind::kNothing) switch_.end();
  return {true, ""};
}

std::string ConsoleOperator::reportFolder(const std::string&, std::string& why) {
  why = "nothing is recorded for a report here";
  return {};
}

}  // namespace wholehand
