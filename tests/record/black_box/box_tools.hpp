#pragma once

#include "record/black_box.hpp"
#include "record/black_box_reader.hpp"
#include "record/synthetic_recording.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <random>
#include <string>

namespace wholehand::test {

/// Encoder steps of the six axes of synthetic::meta(); the fourth has none.
inline std::vector<double> encoderSteps() {
  return synthetic::meta().encoder_step;
}

inline BlackBoxPlan planFor(const std::string& path) {
  BlackBoxPlan plan;
  plan.path = path;
  plan.most_ticks = 100'000;
  return plan;
}

/// A tick with every field set and its position on encoder counts, except on the fourth axis.
inline TickRecord tickAt(std::uint64_t tick, std::mt19937_64& random) {
  TickRecord r = synthetic::noisy(tick, random);
  r.faults = Fault::kNone;
  r.elapsed_periods = 1;
  const std::vector<double> steps = encoderSteps();
  for (int i = 0; i < 6; ++i) {
    const double step = steps[i];
    if (step > 0.0) r.q_m[i] = step * std::round(r.q_m[i] / step);
  }
  r.placements.count = static_cast<std::int32_t>(tick % 3);
  for (std::int32_t i = 0; i < r.placements.count; ++i) {
    BodyPlacement& p = r.placements.items[i];
    p.body = i;
    p.position_m = {0.1 * static_cast<double>(tick), 2.0, -3.0};
  }
  return r;
}

/// Bytes of a tick that the black box file keeps: all except padding and unused array elements.
[[nodiscard]] std::string bytesOf(const TickRecord& record);

inline std::unique_ptr<BlackBox> armed(const BlackBoxPlan& plan) {
  auto box = BlackBox::arm(synthetic::meta(), plan);
  EXPECT_TRUE(box.ok()) << (box.ok() ? "" : format(box.errors()));
  return box.ok() ? std::move(box).value() : nullptr;
}

inline void giveTick(BlackBox& box, const TickRecord& record) {
  box.beforeTick(record);
  box.afterTick(record);
}

inline std::unique_ptr<BlackBoxReader> opened(const std::string& path) {
  auto box = BlackBoxReader::openBox(path);
  EXPECT_TRUE(box.ok()) << (box.ok() ? "" : format(box.errors()));
  return box.ok() ? std::move(box).value() : nullptr;
}

inline std::string refusalOf(const std::string& path) {
  const auto box = BlackBoxReader::openBox(path);
  return box.ok() ? "opened" : format(box.errors());
}

inline std::string contents(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(in), {});
}

inline void overwrite(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

}  // namespace wholehand::test
