#pragma once

#include "core/expected.hpp"

#include <nlohmann/json.hpp>

#include <array>
#include <initializer_list>
#include <limits>
#include <string>
#include <utility>
#include <vector>

/// What a page of charts shows. web/src/charts draws it, in the language of who reads it.
namespace wholehand {

/// A text: a string as it is, or a sentence of web/src/charts/i18n.
using PageText = nlohmann::json;
/// The sentence of this name, with what stands in its places. "axes" may be names of device axes,
/// with ", " between them.
[[nodiscard]] PageText sentence(
    const char* name, std::initializer_list<std::pair<const char*, std::string>> with = {});
/// A cell of a table: a bar from one value to another on a scale from 0 to `most`, which has a mark
/// at 1.
[[nodiscard]] PageText intervalBar(double from, double to, double most);

struct ChartLine {
  PageText name = nullptr;        ///< null: not in the legend
  std::string color = "--ink";    ///< a custom property of the page's style
  std::vector<int> dash_px = {};  ///< empty: solid
  double width_px = 1.5;
  std::string axis =
      {};             ///< of a device: its colour, its dash and, where there is no other, its name
  double dot_px = 0;  ///< > 0: dots of this diameter, and no line
  bool stepped = false;                            ///< holds each value until the next
  bool filled = false;                             ///< down to the lower end
  std::vector<std::array<double, 2>> points = {};  ///< x rises; y of NaN is a gap
};

struct ChartMark {
  double at = 0.0;
  PageText label = nullptr;
  bool bad = false;
};

struct ChartBand {
  double from = 0.0, to = 0.0;
};

struct ChartScale {
  static constexpr double kFromData = std::numeric_limits<double>::quiet_NaN();
  std::string unit = {};  ///< of x: after its last number
  double from = kFromData, to = kFromData;
  bool logarithmic = false;
  std::vector<double> numbers_at = {};  ///< empty: round ones
};

struct Chart {
  PageText title = nullptr;
  int height_px = 150;
  ChartScale x = {}, y = {};
  bool names_x = true;          ///< numbers below it
  bool below_previous = false;  ///< in the same place of the page's grid
  std::vector<ChartLine> lines = {};
  std::vector<ChartBand> bands = {};
  std::vector<ChartMark> marks = {};
};

struct ChartTable {
  PageText title = nullptr;
  std::vector<PageText> heads = {};
  std::vector<std::vector<PageText>> rows = {};
};

struct ChartPage {
  PageText title = nullptr;
  std::vector<PageText> notes = {};
  std::vector<ChartLine> legend = {};  ///< of all charts; without points
  int columns = 1;
  std::vector<Chart> charts = {};
  std::vector<ChartTable> tables = {};
};

/// The data of the page.
[[nodiscard]] nlohmann::json chartPageJson(const ChartPage& page);

/// A template of the pages' build that stands in the folder of the built pages.
inline constexpr const char* kChartTemplate = "web/dist/charts.html";

}  // namespace wholehand
