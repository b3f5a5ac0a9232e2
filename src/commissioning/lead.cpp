#include "commissioning/lead.hpp"

#include "core/printable.hpp"

#include <fmt/format.h>

#include <optional>

namespace wholehand {
namespace {

Question nextStep(const std::string& text) {
  return {Question::About::kNextStep, text, "", "", 0.0, 0.0};
}

// The step that the person chooses; nothing: to end.
std::optional<CommissioningStep> chooseNext(Commissioning& commissioning, Operator& person) {
  const CommissioningStep next = commissioning.next();
  for (;;) {
    const auto answer =
        person.ask(nextStep(fmt::format("Next: {}. Enter, the name of a step to repeat, or quit:",
                                        stepName(next))),
                   [] {});
    if (!answer || *answer == "quit") return std::nullopt;
    if (answer->empty()) return next;
    for (int i = 0; i < kCommissioningSteps; ++i) {
      const auto step = static_cast<CommissioningStep>(i);
      if (*answer == stepName(step)) return step;
    }
    person.tell(fmt::format("{} is no step.", printable(*answer)), {});
  }
}

}  // namespace

bool leadCommissioning(Commissioning& commissioning, Operator& person) {
  std::optional<CommissioningStep> step = commissioning.next();
  while (step) {
    const auto done = commissioning.carryOut(*step);
    if (commissioning.done(CommissioningStep::kPassport)) return true;
    // After success the next step follows automatically.
    step = done ? std::optional(commissioning.next()) : chooseNext(commissioning, person);
  }
  return false;
}

bool leadDailyCheck(Commissioning& commissioning, Operator& person) {
  while (!commissioning.checkToday()) {
    const auto answer = person.ask(nextStep("Enter to check again, or quit:"), [] {});
    if (!answer || *answer == "quit") return false;
  }
  return true;
}

}  // namespace wholehand
