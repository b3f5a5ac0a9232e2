// The chart of a passport: what is drawn is what was measured.
#include "commissioning/passport_chart.hpp"

#include "passport_file.hpp"

#include <gtest/gtest.h>

#include <array>
#include <regex>
#include <vector>

namespace wholehand::test {
namespace {

// Where the thick lines begin and end [px], in their order: axis by axis, mass, damping, dry
// friction, delay.
std::vector<std::array<double, 2>> bars(const std::string& svg) {
  static const std::regex kBar(
      R"re(<path d="M([0-9.]+) [0-9.]+L([0-9.]+) [0-9.]+" stroke="[^"]*" stroke-width="6.0"/>)re");
  std::vector<std::array<double, 2>> out;
  for (std::sregex_iterator it(svg.begin(), svg.end(), kBar), end; it != end; ++it) {
    out.push_back({std::stod((*it)[1]), std::stod((*it)[2])});
  }
  return out;
}

TEST(PassportChart, OfIntervals_SpansThemAsSharesOfTheFile) {
  PassportFolder f;
  for (std::size_t i = 0; i < f.model.axes.size(); ++i) {
    const DeviceAxis& axis = f.model.axes[i];
    f.passport.axes[i].mass = {0.5 * axis.mass, 1.0 * axis.mass};
    f.passport.axes[i].damping = {1.0 * axis.damping, 1.5 * axis.damping};
    f.passport.axes[i].coulomb = {0.0, 5.0 * axis.coulomb};  // beyond the scale: to its end
  }
  const auto drawn = bars(passportChart(f.passport, f.model));
  ASSERT_EQ(drawn.size(), 4 * f.model.axes.size());
  const double zero = drawn[2][0], two = drawn[2][1], half = (two - zero) / 4.0;
  for (std::size_t i = 0; i < f.model.axes.size(); ++i) {
    EXPECT_NEAR(drawn[4 * i][0], zero + 1 * half, 0.1);
    EXPECT_NEAR(drawn[4 * i][1], zero + 2 * half, 0.1);
    EXPECT_NEAR(drawn[4 * i + 1][0], zero + 2 * half, 0.1);
    EXPECT_NEAR(drawn[4 * i + 1][1], zero + 3 * half, 0.1);
  }
}

TEST(PassportChart, OfAFileThatStatesZero_HasNoBarButTheWords) {
  PassportFolder f;
  f.model.axes[0].coulomb = 0.0;
  f.passport.axes[0].coulomb = {0.0125, 0.25};
  const std::string svg = passportChart(f.passport, f.model);
  EXPECT_EQ(bars(svg).size(), 4 * f.model.axes.size() - 1);
  EXPECT_NE(svg.find("0.0125 to 0.25 N; file 0"), std::string::npos);
}

TEST(PassportChart, OfAnOperatorWithMarkup_IsEscaped) {
  PassportFolder f;
  f.passport.operator_name = "<script>";
  EXPECT_EQ(passportChart(f.passport, f.model).find("<script>"), std::string::npos);
}

}  // namespace
}  // namespace wholehand::test
