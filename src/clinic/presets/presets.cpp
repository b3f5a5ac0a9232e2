#include "clinic/presets/presets.hpp"

#include "files/hand/hand_file.hpp"
#include "files/text/text_file.hpp"
#include "files/toml/toml_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace wholehand::clinic {
namespace {
namespace fs = std::filesystem;

constexpr double kSameHand_m = 0.0005;

Parameters readParameters(TomlTable& table, const Presets& presets) {
  Parameters out;
  auto parameters = table.optionalTable("parameters");
  if (!parameters) return out;
  for (const std::string& name : parameters->keys()) {
    const auto bounds = presets.bounds.find(name);
    if (bounds == presets.bounds.end()) {
      parameters->number(name, NumberRule{});
      parameters->fail(name, "has no bounds", "name it in [bounds]");
    } else {
      out[name] = parameters->number(name, between(bounds->second[0], bounds->second[1]));
    }
  }
  return out;
}

void readExercises(TomlTable& root, Presets& presets) {
  for (TomlTable& table : root.tables("exercises", 1)) {
    ExerciseFacts facts;
    facts.id = table.text("id");
    facts.levels = static_cast<int>(table.integer("levels", 1, 1000));
    if (table.has("parameters")) facts.parameters = table.texts("parameters");
    presets.exercises.push_back(std::move(facts));
  }
}

/// @param key table of plans or goals
void readPlans(TomlTable& root, const char* key, Presets& presets, std::vector<PlanPreset>& out) {
  for (TomlTable& table : root.tables(key, 1)) {
    PlanPreset plan;
    plan.id = table.text("id");
    for (TomlTable& row : table.tables("items", 1)) {
      PlanItem item;
      item.exercise = row.text("exercise");
      const ExerciseFacts* facts = presets.exercise(item.exercise);
      if (facts == nullptr) row.fail("exercise", "is not in [[exercises]]", "name it there");
      item.level = static_cast<int>(row.integer("level", 1, facts == nullptr ? 1 : facts->levels));
      item.minutes = row.number("minutes", between(1.0, 120.0, "min"));
      item.help = row.choice("help", {"full", "some", "none"});
      item.parameters = readParameters(row, presets);
      plan.items.push_back(std::move(item));
    }
    out.push_back(std::move(plan));
  }
}

std::string replaced(std::string text, const std::string& key, const std::string& value) {
  const std::size_t at = text.find("\n" + key + " = ");
  if (at == std::string::npos) return {};
  const std::size_t end = text.find('\n', at + 1);
  return text.replace(at, end - at, "\n" + key + " = " + value);
}

}  // namespace

const ForcePreset* Presets::forceOf(const std::string& id) const {
  const auto found =
      std::find_if(force.begin(), force.end(), [&](const ForcePreset& p) { return p.id == id; });
  return found == force.end() ? nullptr : &*found;
}
const ExerciseFacts* Presets::exercise(const std::string& id) const {
  const auto found = std::find_if(exercises.begin(), exercises.end(),
                                  [&](const ExerciseFacts& e) { return e.id == id; });
  return found == exercises.end() ? nullptr : &*found;
}

Expected<Presets> loadPresets(const std::string& path) {
  return readTomlFile<Presets>(path, "clinic-presets", [](TomlTable& root, Presets& presets) {
    TomlTable bounds = root.table("bounds");
    for (const std::string& name : bounds.keys()) {
      presets.bounds[name] = bounds.interval(name, NumberRule{});
    }
    presets.device = root.texts("device");
    presets.limits = root.texts("limits");
    for (const std::string& name : presets.limits) {
      const auto& device = presets.device;
      if (std::find(device.begin(), device.end(), name) == device.end()) {
        root.fail("limits", fmt::format("names {}, which is not in device", name), "name it there");
      }
    }
    readExercises(root, presets);
    for (TomlTable& table : root.tables("force", 1)) {
      ForcePreset force;
      force.id = table.text("id");
      force.parameters = readParameters(table, presets);
      presets.force.push_back(std::move(force));
    }
    readPlans(root, "plans", presets, presets.plans);
    readPlans(root, "goals", presets, presets.goals);
    TomlTable course = root.table("course");
    presets.course_weeks = static_cast<int>(course.integer("weeks", 1, 52));
    presets.course_visits_a_week = static_cast<int>(course.integer("visits_a_week", 1, 14));
  });
}

Expected<std::vector<ShippedHand>> loadShippedHands(const std::string& folder) {
  std::vector<ShippedHand> hands;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (it->path().extension() != ".toml") continue;
    const auto hand = loadHandFile(it->path().string());
    if (!hand) return hand.errors();
    hands.push_back({it->path().stem().string(), hand->side == Side::kRight ? "right" : "left",
                     hand->length_m, hand->breadth_m});
  }
  if (hands.empty()) {
    return fileFault(folder, "has no hand files", "give the folder config/hands",
                     DiagnosticCode::kMissing);
  }
  std::sort(hands.begin(), hands.end(),
            [](const ShippedHand& a, const ShippedHand& b) { return a.name < b.name; });
  return hands;
}

std::string shippedHand(const std::vector<ShippedHand>& hands, const std::string& side,
                        double length_m, double breadth_m) {
  for (const ShippedHand& hand : hands) {
    if (hand.side == side && std::abs(hand.length_m - length_m) <= kSameHand_m &&
        std::abs(hand.breadth_m - breadth_m) <= kSameHand_m) {
      return hand.name;
    }
  }
  return {};
}

Expected<Done> writeHandFile(const std::string& folder, const std::string& path,
                             const std::string& name, const std::string& side, double length_m,
                             double breadth_m) {
  const std::string median = folder + "/adult-median-right.toml";
  std::ifstream in(median, std::ios::binary);
  std::stringstream read;
  read << in.rdbuf();
  std::string text = read.str();
  const std::size_t kind = text.find("kind = ");
  text = "# The hand of one visit: joints, couplings and self contacts of the median hand.\n" +
         (kind == std::string::npos ? std::string{} : text.substr(kind));
  text = replaced(text, "name", "\"" + name + "\"");
  text = replaced(text, "side", "\"" + side + "\"");
  text = replaced(text, "length_m", formatNumber(length_m));
  text = replaced(text, "breadth_m", formatNumber(breadth_m));
  if (text.empty()) {
    return fileFault(median, "is not the median hand", "put the shipped file back",
                     DiagnosticCode::kUnreadable);
  }
  if (auto ready = prepareFiles({path}); !ready) return ready.errors();
  if (auto written = writeText(path, text); !written) return written.errors();
  if (const auto hand = loadHandFile(path); !hand) return hand.errors();
  return Done{};
}

}  // namespace wholehand::clinic
