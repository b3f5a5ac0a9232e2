#include "station/decide_search.hpp"

#include <cstdint>
#include <ctime>
#include <deque>
#include <unordered_set>
#include <utility>

namespace wholehand::test::decisions {

std::vector<Event> eventsOf(int clients, const std::vector<Step>& steps) {
  std::vector<Event> events;
  for (int step = kOfClients; step < static_cast<int>(Step::kSteps); ++step) {
    events.push_back({static_cast<Step>(step), 0});
  }
  for (const Step step : steps) {
    for (int client = 0; client < clients; ++client) events.push_back({step, client});
  }
  return events;
}

std::vector<Event> allEvents(int clients) {
  std::vector<Event> events;
  for (int step = 0; step < static_cast<int>(Step::kSteps); ++step) {
    for (int client = 0; client < (step < kOfClients ? clients : 1); ++client) {
      events.push_back({static_cast<Step>(step), client});
    }
  }
  return events;
}

Search explore(const std::vector<Event>& events, const WorldRules& rules, const Bounds& bounds) {
  struct Node {
    World world;
    std::uint32_t path = 0;  ///< its last step in `steps`
    int depth = 0;
  };
  struct StepTaken {
    std::uint32_t before = 0;
    std::uint8_t event = 0;
  };
  Search search;
  const std::clock_t began = std::clock();
  std::vector<StepTaken> taken{{}};
  const auto pathTo = [&](std::uint32_t step) {
    std::string path;
    for (; step != 0; step = taken[step].before)
      path = nameOf(events[taken[step].event]) + ", " + path;
    return path;
  };
  std::unordered_set<std::uint64_t> seen{World(rules).key()};
  bool bounded = false;
  std::deque<Node> open;
  open.push_back({World(rules), 0, 0});
  for (; !open.empty(); open.pop_front()) {
    const Node& node = open.front();
    if (search.states >= bounds.states) break;
    if (static_cast<double>(std::clock() - began) > bounds.cpu_s * CLOCKS_PER_SEC) break;
    for (std::size_t e = 0; e < events.size(); ++e) {
      if (!node.world.possible(events[e])) continue;
      World world = node.world;
      (void)world.happens(events[e]);
      ++search.steps;
      if (!world.broken().empty()) {
        search.verdicts.insert(world.broken());
        if (search.example.empty()) {
          search.example = pathTo(node.path) + nameOf(events[e]) + ": " + world.broken();
        }
        continue;
      }
      if (bounds.hashed && !seen.insert(world.key()).second) continue;
      ++search.states;
      search.depth = node.depth + 1;
      if (node.depth + 1 == bounds.depth) {  // its events are beyond the bound
        bounded = true;
        continue;
      }
      taken.push_back({node.path, static_cast<std::uint8_t>(e)});
      open.push_back(
          {std::move(world), static_cast<std::uint32_t>(taken.size() - 1), node.depth + 1});
    }
  }
  search.complete = open.empty() && !bounded;
  return search;
}

}  // namespace wholehand::test::decisions
