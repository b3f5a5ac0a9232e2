#include "assembly/text_file.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <unistd.h>

namespace wholehand {
namespace fs = std::filesystem;
namespace {

Diagnostic unwritable(const fs::path& path, const std::string& why) {
  return {path.string(),
          0,
          "",
          "",
          "cannot be written: " + why,
          "choose a folder that exists and that you may write to"};
}

}  // namespace

Expected<Done> writeText(const std::string& path, const std::string& text) {
  const fs::path temporary = path + ".tmp";
  {
    std::ofstream out(temporary, std::ios::binary);
    out << text;
    out.flush();
    if (!out) {
      std::error_code ignored;
      fs::remove(temporary, ignored);
      return unwritable(path, std::strerror(errno));
    }
  }
  std::error_code error;
  fs::rename(temporary, path, error);
  if (error) return unwritable(path, error.message());
  return Done{};
}

Expected<Done> checkWritable(const std::string& path) {
  const fs::path folder = fs::absolute(path).parent_path();
  std::error_code error;
  if (!fs::is_directory(folder, error))
    return unwritable(path, "there is no folder " + folder.string());
  if (fs::is_directory(path, error)) return unwritable(path, "it is a folder");
  if (access(folder.c_str(), W_OK) != 0) return unwritable(path, std::strerror(errno));
  return Done{};
}

}  // namespace wholehand
