#include "clinic/upkeep.hpp"

#include "clinic/backup.hpp"
#include "clinic/rows.hpp"

#include <algorithm>
#include <filesystem>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace wholehand::clinic {
namespace {
namespace fs = std::filesystem;

constexpr int kNewestEntries = 200;

/// True for a folder on another disk than `root` that this process may write to.
bool isMounted(const std::string& root, const std::string& folder) {
  struct stat above {
  }, here{};
  return ::stat(root.c_str(), &above) == 0 && ::stat(folder.c_str(), &here) == 0 &&
         S_ISDIR(here.st_mode) && here.st_dev != above.st_dev &&
         ::access(folder.c_str(), W_OK | X_OK) == 0;
}

/// Mounted disks in a folder and in the folders of its users, as in /media/anna/STICK.
void addMounted(const std::string& root, const std::string& in, int depth,
                std::vector<std::string>& out) {
  std::error_code error;
  for (fs::directory_iterator it(in, error), end; !error && it != end; it.increment(error)) {
    const std::string path = it->path().string();
    std::error_code none;
    if (!fs::is_directory(path, none)) continue;
    if (isMounted(root, path)) {
      out.push_back(path);
    } else if (depth > 1) {
      addMounted(root, path, depth - 1, out);
    }
  }
}

}  // namespace

std::vector<std::string> Upkeep::folders() const {
  const ClinicOptions& options = records_.options();
  std::vector<std::string> sticks;
  for (const std::string& root : options.sticks) addMounted(root, root, 2, sticks);
  std::sort(sticks.begin(), sticks.end());
  if (!options.backups.empty()) sticks.insert(sticks.begin(), options.backups);
  return sticks;
}

Json Upkeep::places(Call&) {
  Json out = Json::array();
  for (const std::string& folder : folders()) {
    std::error_code error;
    const fs::space_info space = fs::space(folder, error);
    out.push_back({{"folder", folder},
                   {"own", folder == records_.options().backups},
                   {"last_us", newestBackup_us(folder)},
                   {"free_bytes", error ? 0 : space.available}});
  }
  return {{"places", std::move(out)}};
}

Json Upkeep::backUpNow(Call& call) {
  const std::string folder = textOf(call.body, "folder", "folder");
  const std::vector<std::string> known = folders();
  if (std::find(known.begin(), known.end(), folder) == known.end()) {
    throw badValue("folder", "is neither the folder of backups nor a mounted disk");
  }
  const auto file = records_.backUpTo(folder);
  if (!file) throw RequestRefusal{503, "backup", format(file.errors()), {}};
  (void)records_.tryToLog(call.session.account, "backed up by hand");
  return {{"file", *file}, {"last_us", newestBackup_us(folder)}};
}

Json Upkeep::log(Call&) {
  Json out = Json::array();
  Statement rows = records_.db().query(
      "SELECT l.at_us AS at_us, l.account AS account, l.what AS what,"
      " COALESCE(p.code, '') AS code, l.visit AS visit FROM log l"
      " LEFT JOIN patient p ON p.id = l.patient ORDER BY l.n DESC LIMIT ?",
      kNewestEntries);
  while (rows.step()) out.push_back(rowJson(rows));
  return {{"log", std::move(out)}};
}

}  // namespace wholehand::clinic
