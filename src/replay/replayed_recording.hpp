#pragma once

#include "core/expected.hpp"
#include "replay/replay_question.hpp"
#include "server/backend.hpp"
#include "server/wire.hpp"
#include "telemetry/recording.hpp"

#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace wholehand {

/// A recording that answers a page's questions. Opened at the first question and not reopened: data
/// added to the file later is not seen. One thread.
class ReplayedRecording {
 public:
  explicit ReplayedRecording(std::string path) : path_(std::move(path)) {}

  /// Answers a question. Status 422 with the reason when the file is refused: by RecordingReader,
  /// because it is a black box, or because it has no ticks. Throws only std::bad_alloc.
  [[nodiscard]] ReplayAnswer answer(const ReplayQuestion& question);

 private:
  /// Opened once, at first use.
  using Opened = std::optional<Expected<ViewedRecording>>;
  [[nodiscard]] const Expected<ViewedRecording>& open(Opened& as, const LeftOut& left_out) const;
  /// Reads the files that the recording carries, once.
  void prepareScene(const RecordingMeta& meta);
  [[nodiscard]] ReplayAnswer answerShown(const ViewedRecording& viewed,
                                         const ReplayQuestion& question);
  [[nodiscard]] ReplayAnswer about(const ViewedRecording& viewed) const;
  [[nodiscard]] ReplayAnswer scene() const;
  [[nodiscard]] ReplayAnswer states(RecordingReader& reader, const StatesQuestion& question) const;

  const std::string path_;
  Opened shown_, plotted_;                   ///< one for single states, one for plot intervals
  std::shared_ptr<const SceneFacts> facts_;  ///< null: not prepared yet
  std::string no_picture_because_;           ///< reason; empty: the facts are complete
  std::unique_ptr<wire::StateEncoder> encoder_;
};

/// An answer with an error status and its reason.
[[nodiscard]] ReplayAnswer replayRefusal(int status, const std::string& why);

}  // namespace wholehand
