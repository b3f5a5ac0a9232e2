#pragma once

#include "core/expected.hpp"
#include "replay/replay_question.hpp"
#include "server/backend.hpp"
#include "server/replay_service.hpp"
#include "server/wire.hpp"
#include "telemetry/recording_view.hpp"

#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace wholehand {

/// A recording that answers what a page asks of it. Opened with the first question, and again no
/// more: what is added to the file later it does not see. One thread.
class ReplayedRecording {
 public:
  explicit ReplayedRecording(std::string path) : path_(std::move(path)) {}

  /// 422 with the reason where the file is refused: by RecordingReader, as a black box, or for want
  /// of ticks. Does not throw but for want of memory.
  [[nodiscard]] ReplayAnswer answer(const ReplayQuestion& question);

 private:
  /// Opened once, when it is needed first.
  using Opened = std::optional<Expected<ViewedRecording>>;
  [[nodiscard]] const Expected<ViewedRecording>& open(Opened& as, std::uint64_t chunks_at_once,
                                                      const LeftOut& left_out) const;
  /// Reads the files that the recording carries, once.
  void prepareScene(const RecordingMeta& meta);
  [[nodiscard]] ReplayAnswer answerShown(const ViewedRecording& viewed,
                                         const ReplayQuestion& question);
  [[nodiscard]] ReplayAnswer about(const ViewedRecording& viewed) const;
  [[nodiscard]] ReplayAnswer scene() const;
  [[nodiscard]] ReplayAnswer states(RecordingReader& reader, const StatesQuestion& question) const;

  const std::string path_;
  Opened shown_, plotted_;                   ///< for moments, and for stretches of plots
  std::shared_ptr<const SceneFacts> facts_;  ///< null: not prepared
  std::string no_picture_because_;           ///< empty: the facts are whole
  std::unique_ptr<wire::StateEncoder> encoder_;
};

/// The answer that says what is wrong.
[[nodiscard]] ReplayAnswer replayRefusal(int status, const std::string& why);

}  // namespace wholehand
