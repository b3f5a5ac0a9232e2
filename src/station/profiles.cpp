#include "station/profiles.hpp"

#include "files/text/text_file.hpp"
#include "files/toml/toml_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace wholehand {

namespace fs = std::filesystem;
namespace {

constexpr std::size_t kLongestName = 60;
const std::vector<std::string> kHelpNames = {"full", "some", "none"};  // in the order of Help, from
                                                                       // Help::kFull

bool isNamePart(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
         c == '_';
}

Diagnostic notAName(const std::string& name) {
  return {"", 0, "name", name, "is no name of a profile", "1 to 60 letters, digits, - and _"};
}

std::string helpLine(Help help) {
  if (help == Help::kUnspecified) return {};
  const auto index = static_cast<std::size_t>(help) - static_cast<std::size_t>(Help::kFull);
  return "help = \"" + kHelpNames.at(index) + "\"\n";
}

// Profiles of earlier versions have no such key.
Help readHelp(TomlTable& root) {
  if (!root.has("help")) return Help::kUnspecified;
  const auto found =
      std::find(kHelpNames.begin(), kHelpNames.end(), root.choice("help", kHelpNames));
  return static_cast<Help>(static_cast<int>(Help::kFull) + (found - kHelpNames.begin()));
}

}  // namespace

bool isProfileName(const std::string& name) {
  return !name.empty() && name.size() <= kLongestName &&
         std::all_of(name.begin(), name.end(), isNamePart);
}

std::string Profiles::pathOf(const std::string& name) const {
  return folder_ + "/" + name + ".toml";
}

std::vector<std::string> Profiles::list() const {
  std::vector<std::string> names;
  std::error_code error;
  if (!kept()) return names;
  for (fs::directory_iterator it(folder_, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().stem().string();
    std::error_code gone;
    const bool file = it->is_regular_file(gone);
    if (file && it->path().extension() == ".toml" && isProfileName(name)) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

Expected<Done> Profiles::save(const Profile& profile) const {
  if (!kept()) return fileFault("", "no folder of profiles is kept", "");
  if (!isProfileName(profile.name)) return notAName(profile.name);
  const std::string path = pathOf(profile.name);
  if (auto ready = prepareFiles({path}); !ready) return ready.errors();
  std::string text = fmt::format(
      "# A patient's profile, saved by the console (docs/profiles.md).\n"
      "kind = \"profile\"\nversion = 1\nname = \"{}\"\ndevice = \"{}\"\nside = \"{}\"\nhand = "
      "\"{}\"\nexercise = \"{}\"\nlevel = {}\n",
      profile.name, profile.device, profile.side, profile.hand, profile.exercise, profile.level);
  text += helpLine(profile.help) + "\n[parameters]\n";
  for (const auto& [name, value] : profile.parameters) {
    text += fmt::format("{} = {}\n", name, formatNumber(value));
  }
  return writeText(path, text);
}

Expected<Profile> Profiles::load(const std::string& name) const {
  if (!kept() || !isProfileName(name)) return notAName(name);
  std::error_code error;
  const fs::file_status there = fs::status(pathOf(name), error);
  if (fs::exists(there) && !fs::is_regular_file(there)) {  // reading a pipe would block every order
    return fileFault(pathOf(name), "is no regular file", "move it away");
  }
  TomlFile file(pathOf(name), "profile");
  if (!file.readable()) return file.finish();
  TomlTable& root = file.root();
  Profile out;
  out.name = root.text("name");
  if (root.isGood("name") && out.name != name) {
    root.fail("name", "is not the name of its file", "write name = \"" + name + "\"");
  }
  out.device = root.text("device");
  out.side = root.choice("side", {"right", "left"});
  out.hand = root.text("hand");
  out.exercise = root.text("exercise");
  out.level = static_cast<int>(root.integer("level", 1, 1000));
  out.help = readHelp(root);
  if (std::optional<TomlTable> parameters = root.optionalTable("parameters")) {
    for (const std::string& key : parameters->keys()) {
      out.parameters[key] = parameters->number(key, NumberRule{});
    }
  }
  if (Diagnostics faults = file.finish(); !faults.empty()) return faults;
  return out;
}

}  // namespace wholehand
