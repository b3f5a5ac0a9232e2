#pragma once

#include <string>

/// The few SVG elements that the plots are made of. Texts and attributes are escaped.
namespace wholehand::svg {

inline constexpr double kFontPx = 12.0;
/// Width of an average letter as a share of the font size, for placing words side by side.
inline constexpr double kLetter = 0.56;

/// A pixel coordinate; one decimal is finer than any screen shows.
[[nodiscard]] std::string px(double value);
/// ` name="value"`
[[nodiscard]] std::string attribute(const char* name, const std::string& value);
/// A straight line.
[[nodiscard]] std::string segment(double x1, double y1, double x2, double y2,
                                  const std::string& color, double width,
                                  const std::string& dash = {});
/// A line of text; `anchor` is start, middle or end; `extra` are further attributes, as they stand.
[[nodiscard]] std::string words(double x, double y, const std::string& text, const char* anchor,
                                const std::string& color, int weight = 400, double size = kFontPx,
                                const char* extra = "");
/// The opening tag of a whole picture.
[[nodiscard]] std::string opening(int width, int height, const std::string& title);

}  // namespace wholehand::svg
