#pragma once

#include <string>

namespace wholehand {

/// Of which file a report is. A recording that takes the name of another one has another identity:
/// its device, inode, size and time of its last change. Empty when there is no such file.
[[nodiscard]] std::string identityOf(const std::string& recording);

/// Whether a folder holds the finished report of the file with that identity.
[[nodiscard]] bool isReportOf(const std::string& folder, const std::string& identity);

/// Marks a finished report. Without a mark it is made again when it is asked for.
void markReport(const std::string& folder, const std::string& identity);

/// Removes the mark of a report that is made again.
void unmarkReport(const std::string& folder);

}  // namespace wholehand
