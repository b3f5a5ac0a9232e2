// libFuzzer at one door: fuzz_door --door=NAME [options of libFuzzer] [corpus ...]
#include "doors.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace {

const wholehand::test::Door* g_door = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  static const auto doors = wholehand::test::allDoors();
  constexpr std::string_view kOption = "--door=";
  for (int i = 1; i < *argc; ++i) {
    const std::string_view argument = (*argv)[i];
    if (!argument.starts_with(kOption)) continue;
    const auto named = [&](const auto& door) {
      return door.name == argument.substr(kOption.size());
    };
    const auto found = std::find_if(doors.begin(), doors.end(), named);
    if (found != doors.end()) g_door = &*found;
  }
  if (g_door != nullptr) return 0;
  std::fprintf(stderr, "name a door by --door=:");
  for (const auto& door : doors) std::fprintf(stderr, " %s", door.name.c_str());
  std::fprintf(stderr, "\n");
  std::exit(2);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string wrong = g_door->enter({reinterpret_cast<const char*>(data), size});
  if (wrong.empty()) return 0;
  std::fprintf(stderr, "%s: %s\n", g_door->name.c_str(), wrong.c_str());
  std::abort();
}
