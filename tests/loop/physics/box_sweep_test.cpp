// A sweep along x must find the same pairs of boxes as comparing each with each.
#include "loop/physics/bullet/box_sweep.hpp"

#include "support/seed.hpp"

#include <gtest/gtest.h>

namespace wholehand::bullet {
namespace {

using Part = BoxSweep::Part;

/// Boxes that move a little between searches; some are long, some are empty.
struct MovingBoxes {
  std::vector<WorldBox> boxes;
  std::vector<Part> parts;
  std::vector<int> owners;
  std::mt19937_64 random;

  MovingBoxes(int count, const std::mt19937_64& random_in) : boxes(count), random(random_in) {
    std::uniform_int_distribution<int> part(0, 3), of_three(0, 2);
    std::uniform_real_distribution<double> place(0.0, 0.08), size(0.01, 0.06);
    for (int i = 0; i < count; ++i) {
      owners.push_back(i / 2);
      parts.push_back(static_cast<Part>(part(random)));
      if (i % 7 == 3) continue;  // empty
      for (int k = 0; k < 3; ++k) {
        boxes[i].low_m[k] = place(random);
        boxes[i].high_m[k] = boxes[i].low_m[k] + (i % 5 == 0 ? 10.0 : 1.0) * size(random);
      }
    }
  }

  void move() {
    std::normal_distribution<double> way(0.0, 0.01);
    for (WorldBox& box : boxes) {
      const Eigen::Vector3d by(way(random), way(random), way(random));
      box.low_m += by;
      box.high_m += by;
    }
  }

  // The pairs by definition: each box is compared with each.
  [[nodiscard]] std::vector<BoxSweep::Pair> pairs() const {
    std::vector<BoxSweep::Pair> found;
    const int count = static_cast<int>(boxes.size());
    for (int a = 0; a < count; ++a) {
      for (int b = a + 1; b < count; ++b) {
        const bool awake = parts[a] == Part::kAwake || parts[b] == Part::kAwake;
        const bool meet = parts[a] != Part::kNone && parts[b] != Part::kNone &&
                          parts[a] != Part::kRests && owners[a] != owners[b];
        if (awake && meet && overlap(boxes[a], boxes[b])) found.emplace_back(a, b);
      }
    }
    return found;
  }
};

TEST(BoxSweep, MovingBoxes_FindsThePairsOfComparingAll) {
  auto random = test::seededRandom(6701);
  std::size_t most = 0;
  for (int round = 0; round < 20; ++round) {
    MovingBoxes moving(60, random);
    random.discard(1000);
    BoxSweep sweep(moving.owners, 1000);
    for (int step = 0; step < 20; ++step) {
      sweep.find(moving.boxes, moving.parts);
      const auto expected = moving.pairs();
      ASSERT_EQ(sweep.pairs(), expected) << "round " << round << ", step " << step;
      ASSERT_EQ(sweep.dropped(), 0);
      most = std::max(most, expected.size());
      moving.move();
      moving.parts[step] = static_cast<Part>((step + round) % 4);
    }
  }
  EXPECT_GT(most, 100U);
}

TEST(BoxSweep, MorePairsThanRoom_CountsThoseLeftOut) {
  MovingBoxes moving(60, std::mt19937_64(1));
  const std::size_t pairs = moving.pairs().size();
  ASSERT_GT(pairs, 20U);
  BoxSweep sweep(moving.owners, 20);
  sweep.find(moving.boxes, moving.parts);
  EXPECT_EQ(sweep.pairs().size(), 20U);
  EXPECT_EQ(sweep.dropped(), static_cast<int>(pairs) - 20);
}

TEST(BoxSweep, AfterClear_HasNoPairs) {
  MovingBoxes moving(60, std::mt19937_64(1));
  BoxSweep sweep(moving.owners, 1000);
  sweep.find(moving.boxes, moving.parts);
  ASSERT_FALSE(sweep.pairs().empty());
  sweep.clear();
  EXPECT_TRUE(sweep.pairs().empty());
}

}  // namespace
}  // namespace wholehand::bullet
