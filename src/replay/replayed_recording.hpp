#pragma once

#include "loop/core/expected.hpp"
#include "record/recording.hpp"
#include "replay/replay_question.hpp"
#include "station/server/wire.hpp"
#include "vocabulary/backend.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {

/// Bodies of a game in a recording, in the form that live clients receive: for each change the row
/// (uint32), the length (uint32) and a message with GameBodies. Empty for scenes that take none; at
/// most 20,000 changes. Ticks that cannot be read are skipped.
[[nodiscard]] std::string gameBodiesOf(RecordingReader& recording);

/// Bodies for a page that shows some rows only; the same format as gameBodiesOf().
class SampledBodies {
 public:
  explicit SampledBodies(const RecordingMeta& meta);
  ~SampledBodies();
  SampledBodies(const SampledBodies&) = delete;
  SampledBodies& operator=(const SampledBodies&) = delete;

  void onRecord(const TickRecord& record);  ///< receives every readable tick in order
  void keep(std::uint64_t row);             ///< keeps the bodies of the last tick received
  /// Encodes the bodies at some rows.
  /// @param rows ascending; a row that was not kept shows the bodies of the kept row before it
  /// @param step uses only every n-th row and the last one: fewer bytes, but bodies appear and
  /// vanish later
  [[nodiscard]] std::string at(const std::vector<std::uint64_t>& rows, std::size_t step) const;

 private:
  class Follower;
  friend std::string gameBodiesOf(RecordingReader& recording);
  struct Change {
    std::uint64_t row;
    std::shared_ptr<const GameBodies> bodies;
  };
  std::unique_ptr<Follower> follower_;  ///< null: the scene takes no bodies
  std::vector<Change> changes_;
};

/// A recording that answers a page's questions. Opened at the first question and not reopened: data
/// added to the file later is not seen. One thread.
class ReplayedRecording {
 public:
  explicit ReplayedRecording(std::string path) : path_(std::move(path)) {}

  /// Answers a question. Status 422 with the reason when the file is refused: by RecordingReader,
  /// because it is a black box, or because it has no ticks. Throws only std::bad_alloc.
  [[nodiscard]] ReplayAnswer answer(const ReplayQuestion& question);

 private:
  /// Opens the recording at first use.
  using Opened = std::optional<Expected<ViewedRecording>>;
  [[nodiscard]] const Expected<ViewedRecording>& open(Opened& as, const LeftOut& left_out) const;
  /// Reads the model files in the recording, once.
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
