#include "device/plugin/driver_lookup.hpp"

#include <filesystem>
#include <set>
#include <system_error>

namespace wholehand {
namespace {
namespace fs = std::filesystem;

constexpr const char* kEnding = ".so";

std::string namesIn(const std::vector<std::string>& folders) {
  std::set<std::string> names;
  for (const std::string& folder : folders) {
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
      if (entry.path().extension() == kEnding) names.insert(entry.path().stem().string());
    }
  }
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

std::vector<std::string> shippedDriverFolders() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error).parent_path();
  if (error) return {};
  return {(program / "drivers").string(),
          (program.parent_path() / "lib" / "wholehand" / "drivers").string()};
}

Expected<std::string> findDriver(const std::string& name, const std::vector<std::string>& folders) {
  if (name.find('/') != std::string::npos) return name;
  // Without a slash dlopen would search the system's library folders.
  if (name.ends_with(kEnding)) return std::string("./").append(name);
  for (const std::string& folder : folders) {
    const fs::path path = fs::path(folder) / (name + kEnding);
    std::error_code error;
    if (!name.empty() && fs::exists(path, error)) return path.string();
  }
  const std::string known = namesIn(folders);
  return Diagnostic{"",
                    0,
                    "--driver",
                    name,
                    "is no driver that ships with this program",
                    known.empty()
                        ? "give the path of a driver's shared object; none ship with this program"
                        : "give one of " + known + ", or the path of a driver's shared object"};
}

}  // namespace wholehand
