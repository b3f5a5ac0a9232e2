// libFuzzer at one door: fuzz_door --door=NAME [--good=FOLDER] [options of libFuzzer] [corpus ...]
// --good: writes the inputs that are taken there first.
#include "doors.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string_view>

namespace {

using wholehand::test::Door;

const Door* g_door = nullptr;

/// What follows this option; empty where it is not given.
std::string_view valueOf(std::string_view option, int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument.starts_with(option)) return argument.substr(option.size());
  }
  return {};
}

void writeGood(const Door& door, const std::string& folder) {
  for (std::size_t i = 0; i < door.good.size(); ++i) {
    std::ofstream(folder + "/good-" + std::to_string(i), std::ios::binary) << door.good[i];
  }
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  static const std::vector<Door> doors = wholehand::test::allDoors();
  const std::string_view name = valueOf("--door=", *argc, *argv);
  const auto found = std::find_if(doors.begin(), doors.end(),
                                  [name](const Door& door) { return door.name == name; });
  if (found == doors.end()) {
    std::fprintf(stderr, "name a door by --door=:");
    for (const Door& door : doors) std::fprintf(stderr, " %s", door.name.c_str());
    std::fprintf(stderr, "\n");
    std::exit(2);
  }
  g_door = &*found;
  const std::string_view good = valueOf("--good=", *argc, *argv);
  if (!good.empty()) writeGood(*g_door, std::string(good));
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string wrong = g_door->enter({reinterpret_cast<const char*>(data), size});
  if (wrong.empty()) return 0;
  std::fprintf(stderr, "%s: %s\n", g_door->name.c_str(), wrong.c_str());
  std::abort();
}
