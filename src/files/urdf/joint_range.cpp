#include "files/urdf/joint_range.hpp"

#include "files/mesh/mesh_readers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

/// An end that no joint reaches, in whatever unit: a placeholder for "no end" [rad or degrees;
/// millimetres].
constexpr double kNoEnd_rad = 1e3, kNoEnd_m = 1e4;

/// The range of a joint without ends.
JointRange endless(bool slides, const std::string& why) {
  JointRange range;
  if (slides) range.least = -kMostSlide_m, range.most = kMostSlide_m;
  range.problem = why + (slides ? fmt::format(": it slides {:g} m both ways", kMostSlide_m)
                                : ": it turns without end");
  range.remedy = "give <limit lower=\"...\" upper=\"...\"/> if it shall stop";
  return range;
}

JointRange refused(const char* end, std::string problem, std::string remedy) {
  JointRange range;
  range.refused = true;
  range.end = end;
  range.problem = std::move(problem);
  range.remedy = std::move(remedy);
  return range;
}

}  // namespace

JointRange jointRange(bool slides, std::optional<double> lower, std::optional<double> upper) {
  if (!lower && !upper) return endless(slides, "has no ends");
  const double least = lower.value_or(0.0), most = upper.value_or(0.0);  // the default of URDF
  if (least == 1.0 && (most == 0.0 || most == -1.0)) {
    return endless(slides, fmt::format("has no ends: {:g} .. {:g} says so to Bullet", least, most));
  }
  const double allowed = slides ? kMostSlide_m : kMostHinge_rad;
  const double no_end = slides ? kNoEnd_m : kNoEnd_rad;
  // A slide is never given in millimetres to both sides of 10 m.
  const bool both = slides && least < -allowed && most > allowed;
  const auto is_none = [&](double end) { return std::abs(end) >= no_end || both; };
  for (const auto& [name, end] : {std::pair{"lower", least}, std::pair{"upper", most}}) {
    if (std::abs(end) <= allowed || is_none(end)) continue;
    if (!slides) {
      return refused(name, "is beyond two turns (4π rad)",
                     "must be in rad: multiply degrees by π / 180; if it turns without end, make "
                     "the joint continuous");
    }
    return refused(name, "is out of range",
                   "must be in [-10, 10] m: divide millimetres by 1000, or write 10 if it has no "
                   "end there");
  }
  if (!(least <= most)) {
    return refused(nullptr, "is reversed",
                   "give lower < upper, or no ends if it shall move without end");
  }
  JointRange range;
  if (least == most) {
    range.moves = false;
    range.problem = "is one place: the joint does not move";
    range.remedy = "give lower < upper if it shall move";
    return range;
  }
  range.least = least, range.most = most;
  if (!is_none(least) && !is_none(most)) return range;
  const double end = slides ? allowed : std::numeric_limits<double>::infinity();
  if (is_none(least)) range.least = -end;
  if (is_none(most)) range.most = end;
  range.problem =
      slides ? fmt::format("is no limit where it is beyond {:g} m: it ends there", end)
             : fmt::format("is no limit where it is beyond {:g} rad: it turns on", kNoEnd_rad);
  range.remedy = "give the ends that it shall have";
  return range;
}

std::optional<double> limitEnd(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == text.npos) return std::nullopt;
  text = text.substr(begin, text.find_last_not_of(kBlanks) + 1 - begin);
  std::string word(text.substr(text.starts_with('-') || text.starts_with('+') ? 1 : 0));
  std::transform(word.begin(), word.end(), word.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (word == "inf" || word == "infinity") {
    const double infinity = std::numeric_limits<double>::infinity();
    return text.starts_with('-') ? -infinity : infinity;
  }
  const auto value = meshNumber(text);
  if (!value || !std::isfinite(*value)) return std::nullopt;
  return value;
}

}  // namespace wholehand
