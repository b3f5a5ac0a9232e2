#include "model/urdf/urdf_xml.hpp"

#include "model/rotation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

namespace wholehand {
namespace {

using tinyxml2::XMLElement;

constexpr const char* kBlanks = " \t\r\n";

/// Independent of the locale, unlike tinyxml2's queries; empty when a word is not a number.
std::optional<std::vector<double>> parseNumbers(const std::string& text) {
  std::vector<double> numbers;
  std::size_t begin = text.find_first_not_of(kBlanks);
  while (begin != std::string::npos) {
    const std::size_t end = std::min(text.find_first_of(kBlanks, begin), text.size());
    const char* first = text.data() + begin + (text[begin] == '+' ? 1 : 0);
    const char* last = text.data() + end;
    double value = 0.0;
    const auto [stop, error] = std::from_chars(first, last, value);
    if (error != std::errc{} || stop != last || !std::isfinite(value)) return std::nullopt;
    numbers.push_back(value);
    begin = text.find_first_not_of(kBlanks, end);
  }
  return numbers;
}

}  // namespace

void UrdfFaults::add(const XMLElement* at, std::string key, std::string value, std::string problem,
                     std::string remedy) {
  Diagnostic d;
  d.file = file_;
  d.line = at != nullptr ? at->GetLineNum() : 0;
  d.key = std::move(key);
  d.value = std::move(value);
  d.problem = std::move(problem);
  d.remedy = std::move(remedy);
  all_.push_back(std::move(d));
}

void UrdfFaults::note(const XMLElement* at, std::string key, std::string value, Diagnostic notice) {
  notice.file = file_;
  notice.line = at->GetLineNum();
  notice.key = std::move(key);
  notice.value = std::move(value);
  notices_.push_back(std::move(notice));
}

void UrdfFaults::addAtLine(int line, std::string problem, std::string remedy) {
  add(nullptr, "", "", std::move(problem), std::move(remedy));
  all_.back().line = line;
}

std::string UrdfFaults::text(const XMLElement& e, const char* attribute, const std::string& key) {
  const char* found = e.Attribute(attribute);
  if (found != nullptr && *found != '\0') return found;
  add(&e, key + "." + attribute, "", "is missing",
      fmt::format("give <{} {}=\"...\">", e.Name(), attribute));
  return {};
}

std::vector<double> UrdfFaults::numbers(const XMLElement& e, const char* attribute,
                                        const std::string& key, std::size_t count) {
  std::vector<double> zeros(count, 0.0);
  const char* found = e.Attribute(attribute);
  const std::string remedy =
      count == 1 ? "must be a finite number"
                 : fmt::format("must be {} finite numbers, with blanks between", count);
  if (found == nullptr) {
    add(&e, key + "." + attribute, "", "is missing", remedy);
    return zeros;
  }
  if (auto parsed = parseNumbers(found); parsed && parsed->size() == count) return *parsed;
  add(&e, key + "." + attribute, found, "cannot be read", remedy);
  return zeros;
}

double UrdfFaults::positive(const XMLElement& e, const char* attribute, const std::string& key) {
  const std::size_t before = all_.size();
  const double value = numbers(e, attribute, key, 1).front();
  if (all_.size() > before) return 1.0;
  if (value > 0.0) return value;
  add(&e, key + "." + attribute, e.Attribute(attribute), "is not positive", "must be > 0");
  return 1.0;
}

double UrdfFaults::length_m(const XMLElement& e, const char* attribute, const std::string& key) {
  const std::size_t before = all_.size();
  const double value = numbers(e, attribute, key, 1).front();
  if (all_.size() > before) return 1.0;
  if (value >= 1e-3 && value <= 10.0) return value;
  add(&e, key + "." + attribute, e.Attribute(attribute), "is out of range",
      "must be in [0.001, 10] m");
  return 1.0;
}

Pose UrdfFaults::origin(const XMLElement& parent, const std::string& key) {
  Pose pose;
  const XMLElement* e = parent.FirstChildElement("origin");
  if (e == nullptr) return pose;
  if (e->Attribute("xyz") != nullptr) {
    const std::vector<double> xyz = numbers(*e, "xyz", key + ".origin", 3);
    pose.translation_m = {xyz[0], xyz[1], xyz[2]};
  }
  if (e->Attribute("rpy") != nullptr) {
    const std::vector<double> rpy = numbers(*e, "rpy", key + ".origin", 3);
    pose.rotation = rotationFromRpy(rpy[0], rpy[1], rpy[2]);
  }
  return pose;
}

}  // namespace wholehand
