// The chart of a passport: what is drawn is what was measured.
#include "commissioning/passport_chart.hpp"

#include "passport_file.hpp"

#include <vector>

namespace wholehand::test {
namespace {

// The bars, axis by axis: mass, damping, dry friction, delay; null where there is none.
std::vector<nlohmann::json> bars(const ChartPage& page) {
  std::vector<nlohmann::json> out;
  for (const ChartTable& table : page.tables) {
    for (const auto& row : table.rows) {
      out.push_back(row[1].is_object() ? row[1]["interval"] : nlohmann::json());
    }
  }
  return out;
}

TEST(PassportChart, OfIntervals_SpansThemAsSharesOfTheFile) {
  PassportFolder f;
  for (std::size_t i = 0; i < f.model.axes.size(); ++i) {
    const DeviceAxis& axis = f.model.axes[i];
    f.passport.axes[i].mass = {0.5 * axis.mass, 1.0 * axis.mass};
    f.passport.axes[i].damping = {1.0 * axis.damping, 1.5 * axis.damping};
    f.passport.axes[i].coulomb = {0.0, 5.0 * axis.coulomb};
  }
  const auto drawn = bars(passportChart(f.passport, f.model));
  ASSERT_EQ(drawn.size(), 4 * f.model.axes.size());
  for (std::size_t i = 0; i < f.model.axes.size(); ++i) {
    EXPECT_EQ(drawn[4 * i], nlohmann::json({0.5, 1.0}));
    EXPECT_EQ(drawn[4 * i + 1], nlohmann::json({1.0, 1.5}));
    EXPECT_EQ(drawn[4 * i + 2], nlohmann::json({0.0, 5.0}));
  }
}

TEST(PassportChart, OfAFileThatStatesZero_HasNoBarButTheWords) {
  PassportFolder f;
  f.model.axes[0].coulomb = 0.0;
  f.passport.axes[0].coulomb = {0.0125, 0.25};
  const ChartPage page = passportChart(f.passport, f.model);
  EXPECT_EQ(bars(page)[2], nullptr);
  const auto& row = page.tables[0].rows[2];
  EXPECT_EQ(row[2]["with"], nlohmann::json({{"low", "0.0125"}, {"high", "0.25"}, {"unit", "N"}}));
  EXPECT_EQ(row[3], "0");
}

}  // namespace
}  // namespace wholehand::test
