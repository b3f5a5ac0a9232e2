#include "core/escape_html.hpp"
#include "report/html_text.hpp"
#include "report/plot_scale.hpp"
#include "report/svg_plot.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <regex>

namespace wholehand {
namespace {

TEST(NiceTicks, KnownRanges_AreRoundNumbers) {
  EXPECT_EQ(niceTicks(0.0, 10.0, 6), (std::vector<double>{0, 2, 4, 6, 8, 10}));
  EXPECT_EQ(niceTicks(-8.5, 3.0, 3), (std::vector<double>{-5, 0}));
  EXPECT_EQ(niceTicks(2.0, 22.0, 6), (std::vector<double>{5, 10, 15, 20}));
  EXPECT_TRUE(niceTicks(1.0, 1.0, 5).empty());
  EXPECT_TRUE(niceTicks(0.0, std::nan(""), 5).empty());
  EXPECT_EQ(tickText(-0.5, {-0.5, 0.0, 0.5}), "−0.5");
  EXPECT_EQ(tickText(0.3, niceTicks(0.0, 0.3, 4)), "0.3");
}

TEST(NiceTicks, RandomRanges_AreWithinEvenAndNotTooMany) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> exponent(-6.0, 6.0), sign(-1.0, 1.0);
  for (int i = 0; i < 2000; ++i) {
    const double low = sign(random) * std::pow(10.0, exponent(random));
    const double span = std::pow(10.0, exponent(random));
    if (span < 1e-6 * std::abs(low)) continue;
    const int most = 2 + i % 8;
    const auto ticks = niceTicks(low, low + span, most);
    ASSERT_LE(static_cast<int>(ticks.size()), most);
    ASSERT_GE(ticks.size(), most >= 5 ? 2U : 0U) << low << " " << span;
    for (std::size_t k = 0; k < ticks.size(); ++k) {
      ASSERT_GE(ticks[k], low - 1e-6 * span);
      ASSERT_LE(ticks[k], low + span * (1.0 + 1e-6));
    }
    if (ticks.size() < 2) continue;
    const double step = ticks[1] - ticks[0];
    const double lead = step / std::pow(10.0, std::floor(std::log10(step) + 1e-9));
    ASSERT_TRUE(std::abs(lead - 1) < 1e-3 || std::abs(lead - 2) < 1e-3 || std::abs(lead - 5) < 1e-3)
        << lead;
  }
}

TEST(PlotScale, LogarithmicAxis_EqualRatiosAreEqualLengths) {
  const PlotScale scale(1.0, 1e4, 100.0, 0.0, true);
  EXPECT_NEAR(scale.px(1.0), 100.0, 1e-9);
  EXPECT_NEAR(scale.px(100.0), 50.0, 1e-9);  // half way: log10(100)/log10(10000)
  EXPECT_EQ(decadeTicks(0.7, 20000.0, 9), (std::vector<double>{1, 10, 100, 1000, 10000}));
  EXPECT_EQ(decadeText(1e4), "10⁴");
  EXPECT_EQ(decadeText(1e-12), "10⁻¹²");
}

TEST(PlotScale, LogarithmicAxisOfOneDecade_IsReadableBetween) {
  // A single labelled line says nothing about the scale.
  const std::vector<double> narrow = logTicks(1.3, 60.0, 7);
  EXPECT_EQ(narrow, (std::vector<double>{2, 5, 10, 20, 50}));
  EXPECT_EQ(logTickText(5.0, narrow), "5");
  EXPECT_EQ(logTickText(10.0, narrow), "10");
  EXPECT_EQ(logTickText(0.05, logTicks(0.03, 0.3, 7)), "0.05");
  EXPECT_EQ(logTicks(370.0, 37000.0, 7), (std::vector<double>{1e3, 1e4}));
  EXPECT_EQ(logTickText(1e3, {1e3, 1e4}), "10³");
  EXPECT_EQ(logTickText(2.0, logTicks(2.0, 4.5, 7)), "2");
  EXPECT_EQ(logTicks(1.3, 60.0, 3), (std::vector<double>{10}));  // no room for more
}

TEST(Declutter, RandomLabels_NeitherOverlapNorLeaveNorSwap) {
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> place(0.0, 200.0);
  for (int i = 0; i < 2000; ++i) {
    std::vector<double> wanted(static_cast<std::size_t>(1 + i % 14));  // 14 x 14 px fit 200 px
    for (double& w : wanted) w = i % 3 == 0 ? 100.0 : place(random);
    const auto places = declutter(wanted, 14.0, 0.0, 200.0);
    for (std::size_t a = 0; a < wanted.size(); ++a) {
      ASSERT_GE(places[a], -1e-9);
      ASSERT_LE(places[a], 200.0 + 1e-9);
      for (std::size_t b = 0; b < a; ++b) {
        ASSERT_GE(std::abs(places[a] - places[b]), 14.0 - 1e-9);
        ASSERT_TRUE(wanted[a] == wanted[b] || (wanted[a] < wanted[b]) == (places[a] < places[b]));
      }
    }
  }
}

TEST(Declutter, LabelsFarApart_StayWhereTheyWant) {
  EXPECT_EQ(declutter({90.0, 10.0, 50.0}, 14.0, 0.0, 100.0),
            (std::vector<double>{90.0, 10.0, 50.0}));
  EXPECT_EQ(declutter({50.0, 50.0}, 14.0, 0.0, 100.0), (std::vector<double>{43.0, 57.0}));
}

TEST(HtmlText, Texts_AreSafeAndNumbersReadWell) {
  EXPECT_EQ(escapeHtml("<a href='x'>\"&\n"), "&lt;a href=&#39;x&#39;&gt;&quot;&amp; ");
  EXPECT_EQ(formatNumber(-3.25, 1), "−3.2");
  EXPECT_EQ(formatNumber(-0.001, 1), "0.0");
  EXPECT_EQ(formatNumber(std::nan(""), 1), "–");
}

TEST(LinePlot, EndLabels_DoNotOverlap) {
  LinePlot plot;
  for (const char* name : {"fingers", "thumb", "turn"}) {
    plot.lines.push_back({name, "#000000", "", 1.5, 1.0, {{0.0, 0.0}, {1.0, 1.0}}});
  }
  const std::string svg = linePlot(plot);
  const std::regex label("y=\"([0-9.]+)\"[^>]*font-weight=\"650\"[^>]*>(fingers|thumb|turn)<");
  std::vector<double> y;
  for (std::sregex_iterator i(svg.begin(), svg.end(), label), end; i != end; ++i) {
    y.push_back(std::stod((*i)[1]));
  }
  ASSERT_EQ(y.size(), 3U);
  std::sort(y.begin(), y.end());
  EXPECT_GE(y[1] - y[0], 12.0);  // the font is 12 px high
  EXPECT_GE(y[2] - y[1], 12.0);
}

TEST(LinePlot, NoData_IsAnEmptyFrame) {
  const std::string svg = linePlot(LinePlot{});
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
  EXPECT_NE(svg.find("</svg>"), std::string::npos);
}

TEST(HistogramPlot, Bins_OneBarEachAndASingleTickIsSeen) {
  HistogramPlot plot;
  plot.x_max = 100.0;
  plot.counts = {10000, 0, 100, 1};
  plot.deadline = 75.0;
  plot.deadline_label = "deadline <75>";
  const std::string svg = histogramPlot(plot);
  const std::regex bar("<rect[^>]*height=\"([0-9.]+)\"");
  std::vector<double> heights;
  for (std::sregex_iterator i(svg.begin(), svg.end(), bar), end; i != end; ++i) {
    heights.push_back(std::stod((*i)[1]));
  }
  ASSERT_EQ(heights.size(), 3U);
  EXPECT_GT(heights[2], 2.0);
  // On a log scale 1 -> 100 and 100 -> 10000 are the same step; coordinates have one decimal.
  EXPECT_NEAR(heights[1] - heights[2], heights[0] - heights[1], 0.21);
  EXPECT_NE(svg.find("deadline &lt;75&gt;"), std::string::npos);
}

TEST(HistogramPlot, TitleDeadlineAndPercentiles_StandOnLinesOfTheirOwn) {
  HistogramPlot plot;
  plot.x_max = 1100.0;
  plot.counts.assign(110, 1000);
  plot.deadline = 1000.0;
  plot.deadline_label = "deadline 1 ms";
  plot.marks = {{900.0, "p50 900 µs"}, {950.0, "p99 950 µs"}, {990.0, "p99.9 990 µs"}};
  for (const char* title : {"", "Time per tick on the wall clock, 100080 ticks"}) {
    plot.title = title;
    const std::string svg = histogramPlot(plot);
    std::vector<double> lines;
    const std::regex word("<text[^>]* y=\"([0-9.]+)\"[^>]*>(Time|deadline|p5|p9)");
    for (std::sregex_iterator i(svg.begin(), svg.end(), word), end; i != end; ++i) {
      lines.push_back(std::stod((*i)[1]));
    }
    ASSERT_EQ(lines.size(), plot.title.empty() ? 4U : 5U) << svg;
    std::sort(lines.begin(), lines.end());
    EXPECT_GE(lines.front(), 10.0);  // a capital letter is about 9 px high
    for (std::size_t i = 1; i < lines.size(); ++i) EXPECT_GE(lines[i] - lines[i - 1], 12.0);
  }
}

}  // namespace
}  // namespace wholehand
