#include "replay/moved_time.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace wholehand {

void MovedTime::add(Mover mover, Help help, std::uint32_t elapsed_periods) {
  const std::uint64_t periods = std::max<std::uint32_t>(elapsed_periods, 1);
  by[static_cast<std::size_t>(mover)] += periods;
  if (mover == Mover::kPerson) helped[static_cast<std::size_t>(help)] += periods;
}

std::uint64_t MovedTime::sum() const {
  return std::accumulate(by.begin(), by.end(), std::uint64_t{0});
}

double MovedTime::share() const {
  const std::uint64_t all = sum();
  return all > 0 ? static_cast<double>(persons()) / static_cast<double>(all) : 0.0;
}

Mover MovedTime::mostly() const {
  return static_cast<Mover>(std::max_element(by.begin(), by.end()) - by.begin());
}

Help MovedTime::mostHelp() const {
  for (const Help help : {Help::kFull, Help::kSome, Help::kNone}) {
    if (helped[static_cast<std::size_t>(help)] > 0) return help;
  }
  return Help::kUnsaid;
}

nlohmann::json MovedTime::json() const {
  const Mover named = isPersons() ? Mover::kPerson : mostly();
  return {{"by", static_cast<int>(named)},
          {"share", share()},
          {"help", static_cast<int>(mostHelp())},
          {"persons", isPersons()}};
}

MovedTime operator-(const MovedTime& end, const MovedTime& begin) {
  MovedTime out;
  for (std::size_t i = 0; i < out.by.size(); ++i) out.by[i] = end.by[i] - begin.by[i];
  for (std::size_t i = 0; i < out.helped.size(); ++i) {
    out.helped[i] = end.helped[i] - begin.helped[i];
  }
  return out;
}

}  // namespace wholehand
