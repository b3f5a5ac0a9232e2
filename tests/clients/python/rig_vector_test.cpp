// The rigs of Python's VectorRig on their threads, without Python, for ThreadSanitizer.
// tests/apps/test_rig.py runs them inside Python.
#include "simulated_rig.hpp"
#include "support/figure.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <string>
#include <vector>

namespace wholehand::python {
namespace {

constexpr int kRigs = 5;  // more rigs than threads, so that a thread takes a second rig

RigFiles exerciseFiles() {
  RigFiles from;
  from.files.exercise = "config/exercises/cocktail-bar.toml";
  for (std::string* file : {&from.files.scene, &from.files.hand, &from.files.device,
                            &from.files.rendering, &from.files.patient, &from.files.exercise}) {
    file->insert(0, WHOLEHAND_SOURCE_DIR "/");
  }
  return from;
}

std::unique_ptr<RigVector> makeRigs(int threads) {
  auto rigs = test::orThrow(RigVector::load(exerciseFiles(), kRigs, threads));
  std::vector<std::uint64_t> seeds;
  for (int i = 0; i < kRigs; ++i) seeds.push_back(20 + i);
  test::orThrow(rigs->reset(seeds));
  return rigs;
}

// Acts like VectorRig between resets: some steps with and without aims, and a rig that is reset
// while the others continue.
void play(RigVector& rigs) {
  rigs.run(20);
  AxisPosition aim = rigs.records()[0].q_m;
  aim[0] += 0.01;
  for (int i = 0; i < kRigs; i += 2) rigs[i].steer(&aim);
  rigs.run(40);
  test::orThrow(rigs.resetOne(1, 7));
  for (int i = 0; i < kRigs; ++i) rigs[i].steer(nullptr);
  rigs.run(30);
}

template <class Array>
void expectSameBits(const Array& a, const Array& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(double)), 0);
}

TEST(RigVector, StepsOnThreads_AreBitIdenticalToOneThread) {
  const auto alone = makeRigs(1);
  const auto many = makeRigs(3);
  ASSERT_EQ(many->threads(), 3);
  play(*alone);
  play(*many);
  for (int i = 0; i < kRigs; ++i) {
    SCOPED_TRACE(i);
    const TickRecord& expected = alone->records()[i];
    const TickRecord& record = many->records()[i];
    EXPECT_TRUE((*many)[i].running());
    EXPECT_EQ(record.tick, i == 1 ? 29U : 89U);
    EXPECT_EQ(record.tick, expected.tick);
    expectSameBits(record.q_s, expected.q_s);
    expectSameBits(record.theta, expected.theta);
    expectSameBits(record.sent, expected.sent);
  }
  EXPECT_NE(many->records()[0].q_s[0], many->records()[3].q_s[0]) << "aimed and not aimed";
}

TEST(RigVector, RigWithoutReset_DoesNotRunWhileOthersDo) {
  const auto rigs = test::orThrow(RigVector::load(exerciseFiles(), 3, 2));
  test::orThrow(rigs->resetOne(0, 1));  // the others were never reset
  test::orThrow(rigs->resetOne(2, 1));
  rigs->run(10);
  EXPECT_FALSE((*rigs)[1].running());
  EXPECT_EQ(rigs->records()[0].tick, 9U);
  EXPECT_EQ(rigs->records()[2].tick, 9U);
}

TEST(RigVector, ThreadCount_IsAtMostTheNumberOfRigs) {
  EXPECT_EQ(test::orThrow(RigVector::load(exerciseFiles(), 2, 8))->threads(), 2);
}

}  // namespace
}  // namespace wholehand::python
