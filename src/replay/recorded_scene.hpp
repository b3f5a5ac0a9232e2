#pragma once

#include "loop/core/expected.hpp"
#include "record/recording.hpp"
#include "vocabulary/backend.hpp"

#include <string>

namespace wholehand {

/// Name stated in the recorded model file of a kind ("device", "hand", "scene" ...), e.g.
/// "lambda-pride"; empty when there is none.
[[nodiscard]] std::string embeddedName(const RecordingMeta& meta, const std::string& kind);

/// Session number of all replayed states and of their scene.
inline constexpr std::uint32_t kReplayedSession = 1;

/// Scene facts of a recording, rebuilt from the model files that it contains. Refused when these
/// cannot be read, or differ from the rendered models.
[[nodiscard]] Expected<SceneFacts> recordedScene(const RecordingMeta& meta,
                                                 const std::string& recording_path);

/// How a session ended, by the last tick of its recording: "stop": somebody ended it, or its time
/// was up; "fault"; "broken_off": the recording has no end, because the program or the machine
/// failed, or the disk was full.
[[nodiscard]] const char* endedBy(const TickRecord& last);
/// What people are told about a session that was broken off.
inline constexpr const char* kBrokenOff =
    "the session was broken off: the recording has no end, because the program or the machine "
    "failed, or the disk was full";

/// Loop status at a tick, as far as it was recorded.
[[nodiscard]] LoopStatus recordedStatus(const TickRecord& record);

/// Description of a recording as JSON, which a page requests first: replay_question.hpp.
/// @param facts scene facts; unknown ones are empty
/// @param no_picture_because reason; empty: there is a picture
/// @pre the recording holds ticks
[[nodiscard]] std::string replayAbout(const ViewedRecording& viewed, const std::string& name,
                                      bool still_written, const SceneFacts& facts,
                                      const std::string& no_picture_because);

}  // namespace wholehand
