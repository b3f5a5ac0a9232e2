#pragma once

#include "server/backend.hpp"

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {

/// What a server without a loop shows: some recordings. Nothing can be ordered of it.
class ReplayBackend final : public ServerBackend {
 public:
  /// @param paths of the recordings; of two with one file name the later is listed as "2-<name>"
  explicit ReplayBackend(const std::vector<std::string>& paths);

  /// As /api/recordings names it.
  [[nodiscard]] const std::string& nameOf(std::size_t i) const { return files_[i].first; }

  void order(const Order& order, std::function<void(OrderReply)> done) override;
  [[nodiscard]] std::shared_ptr<const SceneFacts> scene() const override { return nullptr; }
  [[nodiscard]] LoopStatus status() const override { return {}; }
  [[nodiscard]] bool latest(TickRecord&) const override { return false; }
  [[nodiscard]] std::vector<RecordingEntry> recordings() const override;
  [[nodiscard]] std::string recordingPath(const std::string& name) const override;
  [[nodiscard]] std::string reportFolder(const std::string& name, std::string& why) override;

 private:
  std::vector<std::pair<std::string, std::string>> files_;  ///< name, path
};

}  // namespace wholehand
