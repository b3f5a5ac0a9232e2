#include "report/svg_text.hpp"

#include "core/escape_html.hpp"
#include "report/html_text.hpp"
#include "report/svg_plot.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

namespace wholehand::svg {

std::string px(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f", std::clamp(value, -1e5, 1e5));
  return text.data();
}

std::string attribute(const char* name, const std::string& value) {
  return std::string(" ") + name + "=\"" + escapeHtml(value) + "\"";
}

std::string segment(double x1, double y1, double x2, double y2, const std::string& color,
                    double width, const std::string& dash) {
  return "<path d=\"M" + px(x1) + " " + px(y1) + "L" + px(x2) + " " + px(y2) + "\"" +
         attribute("stroke", color) + " stroke-width=\"" + px(width) + "\"" +
         (dash.empty() ? "" : attribute("stroke-dasharray", dash)) + "/>";
}

std::string words(double x, double y, const std::string& text, const char* anchor,
                  const std::string& color, int weight, double size, const char* extra) {
  return "<text x=\"" + px(x) + "\" y=\"" + px(y) + "\" text-anchor=\"" + anchor + "\"" +
         attribute("fill", color) + " font-weight=\"" + std::to_string(weight) + "\" font-size=\"" +
         px(size) + "\"" + extra + ">" + escapeHtml(text) + "</text>";
}

std::string opening(int width, int height, const std::string& title) {
  const std::string w = std::to_string(width), h = std::to_string(height);
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + w + "\" height=\"" + h +
         "\" viewBox=\"0 0 " + w + " " + h + "\" role=\"img\"" + attribute("aria-label", title) +
         attribute("font-family", kPlotFont) + ">";
}

}  // namespace wholehand::svg
