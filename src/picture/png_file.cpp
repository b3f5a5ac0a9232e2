#include "picture/png_file.hpp"

#include <png.h>

#include <cstdio>
#include <filesystem>
#include <system_error>
#include <unistd.h>

namespace wholehand {
namespace {

Diagnostic unwritable(const std::string& path, const std::string& reason) {
  return {path,
          0,
          "",
          "",
          "the picture cannot be written: " + reason,
          "give a file in an existing folder you may write to"};
}

}  // namespace

Expected<Done> writePng(const std::string& path, int width_px, int height_px,
                        const std::vector<std::uint8_t>& rgb) {
  // The process id keeps two programs that write the same picture apart.
  const std::string partial = path + ".partial." + std::to_string(::getpid());
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width_px);
  image.height = static_cast<png_uint_32>(height_px);
  image.format = PNG_FORMAT_RGB;
  if (png_image_write_to_file(&image, partial.c_str(), 0, rgb.data(), 0, nullptr) == 0) {
    std::remove(partial.c_str());
    return unwritable(path, image.message);
  }
  std::error_code error;
  std::filesystem::rename(partial, path, error);
  if (error) {
    std::remove(partial.c_str());
    return unwritable(path, error.message());
  }
  return Done{};
}

}  // namespace wholehand
