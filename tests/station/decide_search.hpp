#pragma once

#include "station/decide_world.hpp"

#include <cstddef>
#include <set>
#include <string>
#include <vector>

namespace wholehand::test::decisions {

/// The program's events, and these of the clients.
[[nodiscard]] std::vector<Event> eventsOf(int clients, const std::vector<Step>& steps);
/// Every event that may be tried.
[[nodiscard]] std::vector<Event> allEvents(int clients);

struct Search {
  std::size_t states = 0, steps = 0;
  int depth = 0;                   ///< of the last state that was found
  std::set<std::string> verdicts;  ///< laws that were broken
  std::string example;             ///< shortest list of events that breaks one
  bool complete = false;           ///< no state is left unexplored
};

/// Bounds of a search. Where nothing is stated, it goes on until no new state is found.
struct Bounds {
  int depth = 1'000'000;
  std::size_t states = 100'000'000;
  double cpu_s = 1e9;
  bool hashed = true;  ///< false: no two states are taken as equal
};

/// Explores breadth first, from a world of these rules.
[[nodiscard]] Search explore(const std::vector<Event>& events, const WorldRules& rules,
                             const Bounds& bounds);

}  // namespace wholehand::test::decisions
