#include "page/chart_page.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

namespace wholehand {
namespace {

using Json = nlohmann::json;

/// Version of the data format; raised when older pages cannot read it.
constexpr int kVersion = 1;

/// The value with as many digits as a chart can show; null if not finite.
Json shown(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::strtod(fmt::format("{:.7g}", value).c_str(), nullptr);
}

Json lineJson(const ChartLine& line) {
  Json x = Json::array(), y = Json::array();
  for (const auto& [at, value] : line.points) {
    x.push_back(shown(at));
    y.push_back(shown(value));
  }
  return {{"name", line.name},         {"color", line.color},   {"dash_px", line.dash_px},
          {"width_px", line.width_px}, {"axis", line.axis},     {"dot_px", line.dot_px},
          {"stepped", line.stepped},   {"filled", line.filled}, {"x", std::move(x)},
          {"y", std::move(y)}};
}

Json scaleJson(const ChartScale& scale) {
  return {{"unit", scale.unit},
          {"from", shown(scale.from)},
          {"to", shown(scale.to)},
          {"logarithmic", scale.logarithmic},
          {"numbers_at", scale.numbers_at}};
}

Json chartJson(const Chart& chart) {
  Json json = {{"title", chart.title},     {"height_px", chart.height_px},
               {"x", scaleJson(chart.x)},  {"y", scaleJson(chart.y)},
               {"names_x", chart.names_x}, {"below_previous", chart.below_previous},
               {"lines", Json::array()},   {"bands", Json::array()},
               {"marks", Json::array()}};
  for (const ChartLine& line : chart.lines) json["lines"].push_back(lineJson(line));
  for (const ChartBand& band : chart.bands) {
    json["bands"].push_back({{"from", shown(band.from)}, {"to", shown(band.to)}});
  }
  for (const ChartMark& mark : chart.marks) {
    json["marks"].push_back({{"at", shown(mark.at)}, {"label", mark.label}, {"bad", mark.bad}});
  }
  return json;
}

}  // namespace

PageText sentence(const char* name,
                  std::initializer_list<std::pair<const char*, std::string>> with) {
  Json values = Json::object();
  for (const auto& [place, value] : with) values[place] = value;
  return {{"sentence", name}, {"with", std::move(values)}};
}

PageText intervalBar(double from, double to, double most) {
  return {{"interval", {shown(from), shown(to)}}, {"most", most}};
}

Json chartPageJson(const ChartPage& page) {
  Json json = {{"page", "charts"},        {"version", kVersion},     {"title", page.title},
               {"notes", page.notes},     {"columns", page.columns}, {"legend", Json::array()},
               {"charts", Json::array()}, {"tables", Json::array()}};
  for (const ChartLine& line : page.legend) json["legend"].push_back(lineJson(line));
  for (const Chart& chart : page.charts) json["charts"].push_back(chartJson(chart));
  for (const ChartTable& table : page.tables) {
    json["tables"].push_back(
        {{"title", table.title}, {"heads", table.heads}, {"rows", table.rows}});
  }
  return json;
}

}  // namespace wholehand
