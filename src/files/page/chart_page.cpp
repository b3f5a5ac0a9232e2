#include "files/page/chart_page.hpp"

#include "files/text/text_file.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <new>
#include <system_error>
#include <utility>
#include <zlib.h>

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

namespace {

constexpr const char* kHowToBuild =
    "build the pages, with Node 18.19, 20, or 22 and newer: cd web && npm ci && npm run build";

std::string compressed(std::string_view bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string out(size, '\0');
  const int result = compress2(reinterpret_cast<Bytef*>(out.data()), &size,
                               reinterpret_cast<const Bytef*>(bytes.data()),
                               static_cast<uLong>(bytes.size()), Z_BEST_COMPRESSION);
  if (result != Z_OK)
    throw std::bad_alloc();  // the buffer is large enough, so that only memory can run out
  out.resize(size);
  return out;
}

std::string encodeBase64(std::string_view bytes) {
  static constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8U | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      const bool used = i + k <= bytes.size();  // k digits need k bytes, rounded up
      out += used ? kDigits[group >> (18U - 6U * static_cast<unsigned>(k)) & 63U] : '=';
    }
  }
  return out;
}

}  // namespace

std::string embeddedJson(const nlohmann::json& data) {
  const std::string json = data.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  std::string out;
  out.reserve(json.size());
  for (const char c : json) {
    if (c == '<') {
      out += "\\u003c";  // data cannot end the element or begin a comment
    } else {
      out += c;
    }
  }
  return out;
}

Expected<std::string> readPageTemplate(const std::string& template_path) {
  std::ifstream in(template_path, std::ios::binary);
  if (!in.is_open()) {
    return fileFault(template_path, "is missing: the pages are not built", kHowToBuild);
  }
  std::string text(std::istreambuf_iterator<char>(in), {});
  const std::size_t at = text.find(kPageDataMark);
  if (at == std::string::npos || text.find(kPageDataMark, at + 1) != std::string::npos) {
    return fileFault(template_path, "is no template of a page", kHowToBuild);
  }
  return text;
}

Expected<Done> writePage(const std::string& page_template, const nlohmann::json& data,
                         const std::string& path) {
  std::string page = page_template;
  page.replace(page.find(kPageDataMark), kPageDataMark.size(), embeddedJson(data));

  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  std::error_code failure;
  const bool created = !folder.empty() && std::filesystem::create_directory(folder, failure);
  int error = failure.value() == EEXIST ? ENOTDIR : failure.value();
  if (error == 0) error = writeDurably(path, page);
  if (error == 0) return Done{};
  if (created) std::filesystem::remove(folder, failure);
  return fileFault(
      path, std::string("cannot be written: ") + std::strerror(error),
      "name a file in a folder that is writable, or in a new one inside such a folder");
}

std::string packBytes(std::string_view bytes) {
  return encodeBase64(compressed(bytes));
}

}  // namespace wholehand
