#include "assembly/kept_black_box.hpp"

#include "files/durable_file.hpp"
#include "files/text_file.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <filesystem>

namespace wholehand {
namespace fs = std::filesystem;

std::string blackBoxPath(const std::string& recording) {
  if (fs::path(recording).extension() == ".wbb") return recording + ".wbb";
  if (!recording.empty()) return fs::path(recording).replace_extension(".wbb").string();
  std::string stem = fmt::format("out/blackbox/{:%Y%m%d-%H%M%S}",
                                 fmt::localtime(std::chrono::system_clock::now()));
  std::error_code nowhere;
  if (!checkFiles({stem + ".wbb"})) stem = fs::temp_directory_path(nowhere) / stem;
  // Few boxes are ever written, so no file takes the name now; chance keeps two programs apart.
  return stem + "-" + randomName().substr(0, 8) + ".wbb";
}

Expected<std::unique_ptr<BlackBox>> armBlackBox(const Rig& rig, const RecordingMeta& meta,
                                                const std::string& path, std::uint64_t most_ticks) {
  BlackBoxPlan plan;
  plan.path = path;
  plan.most_ticks = most_ticks;
  plan.stop = [](void* renderer) noexcept {
    static_cast<HapticRenderer*>(renderer)->requestEmergencyStop();
  };
  plan.stop_whom = rig.renderer.get();
  return BlackBox::arm(meta, plan);
}

std::string writeBlackBoxIfNeeded(BlackBox& box) {
  if (!box.wanted()) return {};
  if (auto written = box.write(); !written) return format(written.errors());
  return fmt::format("the last seconds and what led to them: wholehand replay {} --resimulate",
                     box.path());
}

}  // namespace wholehand
