#pragma once

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace wholehand {

/// Runs `work(row)` once for every row in 0 .. rows - 1, on every core; returns when all are done.
/// `work` must not throw.
template <class Work>
void forEachRow(int rows, const Work& work) {
  std::atomic<int> next{0};
  const auto loop = [&] {
    for (int y = next++; y < rows; y = next++) work(y);
  };
  std::vector<std::thread> others;
  const unsigned cores = std::clamp(std::thread::hardware_concurrency(), 1U, 16U);
  for (unsigned i = 1; i < cores; ++i) others.emplace_back(loop);
  loop();
  for (std::thread& t : others) t.join();
}

}  // namespace wholehand
