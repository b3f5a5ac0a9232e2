#pragma once

#include "server/backend.hpp"

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {

/// Backend of a server without a loop: shows recordings, refuses every order.
class ReplayBackend final : public ServerBackend {
 public:
  /// @param paths of the recordings; the second of two equal file names is listed as "2-<name>"
  explicit ReplayBackend(const std::vector<std::string>& paths);

  /// Name of a recording in /api/recordings.
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
