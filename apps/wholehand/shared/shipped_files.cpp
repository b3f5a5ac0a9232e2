#include "apps/wholehand/shared/shipped_files.hpp"

#include "apps/wholehand/shared/exit_code.hpp"
#include "files/device/device_file.hpp"
#include "loop/core/printable.hpp"
#include "loop/model/device_model.hpp"

#include <filesystem>

namespace wholehand {
namespace fs = std::filesystem;

std::string shippedFile(const std::string& relative) {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  for (fs::path folder = program.parent_path(); !folder.empty(); folder = folder.parent_path()) {
    for (const fs::path& share : {folder, folder / "share" / "wholehand"}) {
      const fs::path file = share / relative;
      if (!fs::exists(file, error)) continue;
      // Both paths name the same file; the short one is easier to read.
      return fs::equivalent(relative, file, error) ? relative : file.string();
    }
    if (folder == folder.root_path()) break;
  }
  return relative;
}

ModelFiles shippedModels() {
  ModelFiles files;
  for (std::string* file :
       {&files.scene, &files.hand, &files.device, &files.rendering, &files.patient}) {
    *file = shippedFile(*file);
  }
  return files;
}

Expected<std::string> renderingFor(const std::string& device_file) {
  const fs::path device = device_file;
  const fs::path beside = device.parent_path().parent_path() / "rendering" / device.filename();
  std::error_code error;
  if (fs::exists(beside, error)) return beside.string();
  const std::string shipped =
      shippedFile((fs::path("config/rendering") / device.filename()).string());
  // Without the device file, its absence is the error to report, later.
  if (fs::exists(shipped, error) || !fs::exists(device, error)) return shipped;
  // A file that is not a valid device has other faults to report.
  if (auto described = loadDeviceFile(device_file); !described) return described.errors();
  return fileFault(
      device_file, "no gains are known for this device",
      "give --rendering FILE, or put them at " + printable(beside.lexically_normal().string()));
}

bool findGains(const std::string& device, std::string& rendering, int& code) {
  auto found = renderingFor(device);
  if (found) {
    rendering = *found;
  } else {
    code = refuse(found.errors());
  }
  return found.ok();
}

std::string exerciseFile(const std::string& exercise) {
  const bool is_path = exercise.find('/') != std::string::npos || exercise.ends_with(".toml");
  return is_path ? exercise : shippedFile("config/exercises") + "/" + exercise + ".toml";
}

}  // namespace wholehand
