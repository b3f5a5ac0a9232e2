// libFuzzer: test_fuzz_targets --target=NAME [--good=FOLDER] [libFuzzer's options] [corpus ...]
// --good: writes the accepted sample inputs into FOLDER first.
#include "fuzz_targets.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string_view>

namespace {

using wholehand::test::FuzzTarget;

const FuzzTarget* g_target = nullptr;

/// Value of this option; empty where it is not given.
std::string_view valueOf(std::string_view option, int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument.starts_with(option)) return argument.substr(option.size());
  }
  return {};
}

void writeGood(const FuzzTarget& target, const std::string& folder) {
  for (std::size_t i = 0; i < target.good.size(); ++i) {
    std::ofstream(folder + "/good-" + std::to_string(i), std::ios::binary) << target.good[i];
  }
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  static const std::vector<FuzzTarget> targets = wholehand::test::allTargets();
  const std::string_view name = valueOf("--target=", *argc, *argv);
  const auto found = std::find_if(targets.begin(), targets.end(),
                                  [name](const FuzzTarget& target) { return target.name == name; });
  if (found == targets.end()) {
    std::fprintf(stderr, "name a target by --target=:");
    for (const FuzzTarget& target : targets) std::fprintf(stderr, " %s", target.name.c_str());
    std::fprintf(stderr, "\n");
    std::exit(2);
  }
  g_target = &*found;
  const std::string_view good = valueOf("--good=", *argc, *argv);
  if (!good.empty()) writeGood(*g_target, std::string(good));
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string wrong = g_target->enter({reinterpret_cast<const char*>(data), size});
  if (wrong.empty()) return 0;
  std::fprintf(stderr, "%s: %s\n", g_target->name.c_str(), wrong.c_str());
  std::abort();
}
