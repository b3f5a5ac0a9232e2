#pragma once

#include "core/expected.hpp"

#include <string>
#include <vector>

namespace wholehand {

struct ReportData;

/// A picture to embed into the report.
struct ReportPicture {
  std::string caption;
  std::string png_path;
};

/// Writes `out_dir`/index.html: one page that needs nothing else (no network), for the screen and
/// for A4 landscape paper. The folder is made when only it is missing. Refuses an unreadable
/// picture and a folder that cannot be written; the page appears complete or not at all.
[[nodiscard]] Expected<Done> writeReport(const ReportData& data, const std::string& out_dir,
                                         const std::vector<ReportPicture>& pictures = {});

/// The same of a recording of any length, which is read once. Refuses one that cannot be read.
[[nodiscard]] Expected<Done> writeReport(const std::string& recording_path,
                                         const std::string& out_dir,
                                         const std::vector<ReportPicture>& pictures = {});

}  // namespace wholehand
