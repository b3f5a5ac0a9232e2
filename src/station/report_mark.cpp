#include "station/report_mark.hpp"

#include "files/text_file.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <sys/stat.h>
#include <system_error>

namespace wholehand {
namespace {

std::string markIn(const std::string& folder) {
  return folder + "/recording.txt";
}

}  // namespace

std::string identityOf(const std::string& recording) {
  struct stat found {};
  if (::stat(recording.c_str(), &found) != 0) return {};
  return fmt::format("device {} inode {} bytes {} changed {}.{:09d}\n", found.st_dev, found.st_ino,
                     found.st_size, found.st_mtim.tv_sec, found.st_mtim.tv_nsec);
}

bool isReportOf(const std::string& folder, const std::string& identity) {
  std::error_code error;
  if (identity.empty() || !std::filesystem::exists(folder + "/index.html", error)) return false;
  std::ifstream in(markIn(folder));
  return std::string(std::istreambuf_iterator<char>(in), {}) == identity;
}

void markReport(const std::string& folder, const std::string& identity) {
  (void)writeText(markIn(folder), identity);
}

void unmarkReport(const std::string& folder) {
  std::error_code ignored;
  std::filesystem::remove(markIn(folder), ignored);
}

}  // namespace wholehand
