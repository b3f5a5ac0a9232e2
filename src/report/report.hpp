#pragma once

#include "core/expected.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// A picture to embed into the report.
struct ReportPicture {
  std::string caption;
  std::string png_path;
};

/// Reads a recording of any length and writes `out_dir`/index.html: one page that needs nothing
/// else (no network), for the screen and for A4 landscape paper. The folder is made when
/// only it is missing. Refuses an unreadable recording or picture and a folder that cannot be
/// written; the page appears complete or not at all.
[[nodiscard]] Expected<Done> writeReport(const std::string& recording_path,
                                         const std::string& out_dir,
                                         const std::vector<ReportPicture>& pictures = {});

}  // namespace wholehand
