#include "report/report.hpp"

#include "report/report_data.hpp"
#include "report/report_page.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace wholehand {
namespace {

Diagnostic refusal(const std::string& file, std::string problem, std::string remedy) {
  Diagnostic d;
  d.file = file;
  d.problem = std::move(problem);
  d.remedy = std::move(remedy);
  return d;
}

Expected<std::vector<EmbeddedPicture>> loadPictures(const std::vector<ReportPicture>& pictures) {
  static const std::string kSignature = "\x89PNG\r\n\x1a\n";
  std::vector<EmbeddedPicture> out;
  Diagnostics errors;
  for (const ReportPicture& p : pictures) {
    std::ifstream in(p.png_path, std::ios::binary);
    const std::string bytes(std::istreambuf_iterator<char>(in), {});
    if (bytes.compare(0, kSignature.size(), kSignature) != 0) {
      errors.push_back(refusal(p.png_path, in.is_open() ? "is no PNG picture" : "cannot be read",
                               "give the path of a .png file"));
    }
    out.push_back({p.caption, bytes});
  }
  if (!errors.empty()) return errors;
  return out;
}

/// Writes the page under a temporary name and renames it. An errno, or 0.
int writePage(const std::filesystem::path& folder, const std::string& page) {
  const std::string path = (folder / "index.html").string(), temporary = path + ".part";
  std::FILE* out = std::fopen(temporary.c_str(), "wb");
  if (out == nullptr) return errno;
  errno = 0;
  const bool written = std::fwrite(page.data(), 1, page.size(), out) == page.size();
  int error = written ? 0 : errno;
  if (std::fclose(out) != 0 && error == 0) error = errno;
  if (error == 0 && std::rename(temporary.c_str(), path.c_str()) != 0) error = errno;
  if (error != 0) std::remove(temporary.c_str());
  return error;
}

}  // namespace

Expected<Done> writeReport(const std::string& recording_path, const std::string& out_dir,
                           const std::vector<ReportPicture>& pictures) {
  const auto data = collectReport(recording_path, kReportPlotColumns);
  if (!data) return data.errors();
  return writeReport(*data, out_dir, pictures);
}

Expected<Done> writeReport(const ReportData& data, const std::string& out_dir,
                           const std::vector<ReportPicture>& pictures) {
  const auto loaded = loadPictures(pictures);
  if (!loaded) return loaded.errors();
  const std::string page = reportPage(data, *loaded);

  const std::filesystem::path folder = out_dir.empty() ? "." : out_dir;
  std::error_code failure;
  const bool created = std::filesystem::create_directory(folder, failure);
  int error = failure.value();
  if (error == EEXIST) error = ENOTDIR;
  if (error == 0) error = writePage(folder, page);
  if (error != 0) {
    if (created) std::filesystem::remove(folder, failure);
    return refusal(out_dir, std::string("cannot be written: ") + std::strerror(error),
                   "name a folder that is writable, or a new one inside such a folder");
  }
  return Done{};
}

}  // namespace wholehand
