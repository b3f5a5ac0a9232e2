#include "drivers/composite/composite_file.hpp"

#include "files/toml/toml_file.hpp"

#include <algorithm>

namespace wholehand {
namespace {

CompositePart readPart(TomlTable& table) {
  CompositePart part;
  part.driver.path = table.text("driver");
  part.driver.locator = table.text("device_at", "");
  part.driver.settings = table.text("settings", "");
  part.longest_gap_s = table.number("longest_gap_s", above(0.0, 10.0, "s"), part.longest_gap_s);
  part.axes = table.texts("axes");
  return part;
}

void readComposite(TomlTable& root, CompositeConfig& config) {
  config.longest_skew_s = root.number("longest_skew_s", above(0.0, 1.0, "s"));
  std::vector<TomlTable> parts = root.tables("parts", 2);
  if (parts.size() > 2) parts[2].fail("", "is a third part", "two devices make a whole");
  std::vector<std::string> names;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const CompositePart part = readPart(parts[i]);
    for (const std::string& name : part.axes) {
      if (std::find(names.begin(), names.end(), name) != names.end()) {
        parts[i].fail("axes", "gives " + name + " a second time", "an axis has one device");
      }
      names.push_back(name);
    }
    if (i < config.parts.size()) config.parts.at(i) = part;
  }
}

}  // namespace

Expected<CompositeConfig> loadCompositeFile(const std::string& path) {
  return readTomlFile<CompositeConfig>(path, "composite", readComposite);
}

}  // namespace wholehand
