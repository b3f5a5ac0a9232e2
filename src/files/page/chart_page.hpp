#pragma once

#include "loop/core/expected.hpp"

#include <nlohmann/json.hpp>

#include <array>
#include <initializer_list>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Content of a page of charts. web/src/charts draws it in the reader's language.
namespace wholehand {

/// A text of the page: a literal string, or a sentence of web/src/charts/i18n.
using PageText = nlohmann::json;
/// The named sentence with values for its placeholders. "axes" may be names of device axes,
/// separated by ", ".
[[nodiscard]] PageText sentence(
    const char* name, std::initializer_list<std::pair<const char*, std::string>> with = {});
/// A table cell with a bar from one value to another, on a scale from 0 to `most` with a mark at 1.
[[nodiscard]] PageText intervalBar(double from, double to, double most);

struct ChartLine {
  PageText name = nullptr;        ///< null: no legend entry
  std::string color = "--ink";    ///< custom property of the page's style
  std::vector<int> dash_px = {};  ///< empty: solid
  double width_px = 1.5;
  std::string axis = {};  ///< device axis that gives the line its colour, its dash and, if `name`
                          ///< is null, its name
  double dot_px = 0;      ///< > 0: dots of this diameter instead of a line
  bool stepped = false;   ///< holds each value until the next
  bool filled = false;    ///< filled down to the lower end
  std::vector<std::array<double, 2>> points = {};  ///< x increasing; NaN in y is a gap
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
  std::string unit = {};  ///< unit of x, after its last number
  double from = kFromData, to = kFromData;
  bool logarithmic = false;
  std::vector<double> numbers_at = {};  ///< empty: round numbers
};

struct Chart {
  PageText title = nullptr;
  int height_px = 150;
  ChartScale x = {}, y = {};
  bool names_x = true;          ///< numbers are shown below the chart
  bool below_previous = false;  ///< in the same grid cell of the page as the previous chart
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
  std::vector<ChartLine> legend = {};  ///< common to all charts; the lines have no points
  int columns = 1;
  std::vector<Chart> charts = {};
  std::vector<ChartTable> tables = {};
};

/// JSON data of the page.
[[nodiscard]] nlohmann::json chartPageJson(const ChartPage& page);

/// Page template, in the folder of the built pages.
inline constexpr const char* kChartTemplate = "web/dist/charts.html";

/// Placeholder in a template that the page's JSON data replaces.
inline constexpr std::string_view kPageDataMark = "\"wholehand-page-data\"";

/// JSON text that is safe inside <script type="application/json">: ASCII, without "<". Invalid
/// UTF-8 is replaced.
[[nodiscard]] std::string embeddedJson(const nlohmann::json& data);

/// Reads a template. Refuses a missing file (the error says how it is built) and a file that does
/// not contain the placeholder exactly once.
[[nodiscard]] Expected<std::string> readPageTemplate(const std::string& template_path);

/// Writes the template with the data under a temporary name and renames it, so that the page
/// appears complete or not at all. Creates the folder if only it is missing.
/// @pre page_template is a result of readPageTemplate()
[[nodiscard]] Expected<Done> writePage(const std::string& page_template, const nlohmann::json& data,
                                       const std::string& path);

/// Packs bytes as text for JSON: zlib (RFC 1950), then base 64 (RFC 4648). Read by unpackBytes() of
/// web/src/embedded.
[[nodiscard]] std::string packBytes(std::string_view bytes);

}  // namespace wholehand
