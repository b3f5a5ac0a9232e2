#include "replay/replayed_recording.hpp"

#include "replay/recorded_scene.hpp"
#include "replay/recording_series.hpp"
#include "replay/replayed_bodies.hpp"
#include "telemetry/black_box_reader.hpp"
#include "telemetry/disk_reserve.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <utility>

namespace wholehand {
namespace {

constexpr const char* kBytes = "application/octet-stream";
constexpr int kCannotBeRead = 422;

Diagnostic refusal(const std::string& path, std::string problem, std::string remedy) {
  return {path, 0, "", "", std::move(problem), std::move(remedy)};
}

}  // namespace

ReplayAnswer replayRefusal(int status, const std::string& why) {
  const nlohmann::json json = {{"error", why}};
  return {status, "application/json",
          json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n"};
}

const Expected<ViewedRecording>& ReplayedRecording::open(Opened& as,
                                                         const LeftOut& left_out) const {
  if (as) return *as;
  if (BlackBoxReader::isBox(path_)) {
    as = refusal(path_, "is a black box, which pages do not show",
                 "take its last seconds out with: wholehand replay --extract seconds.h5 " + path_);
    return *as;
  }
  as = viewRecording(path_, left_out);
  if (*as && as->value().reader->size() == 0) {
    as = refusal(path_, "holds no ticks", "record a run that lasts a while");
  }
  return *as;
}

ReplayAnswer ReplayedRecording::answer(const ReplayQuestion& question) {
  const bool bodies = question.what == ReplayQuestion::What::kBodies;
  const bool plots = bodies || question.what == ReplayQuestion::What::kSeries;
  const auto& viewed = plots ? open(plotted_, leftOutOfSeries()) : open(shown_, {});
  if (!viewed) return replayRefusal(kCannotBeRead, format(viewed.errors()));
  if (bodies) return {200, kBytes, gameBodiesOf(*viewed->reader)};
  if (plots) return {200, kBytes, seriesMessage(*viewed->reader, question.series)};
  prepareScene(viewed->reader->meta());
  return answerShown(*viewed, question);
}

ReplayAnswer ReplayedRecording::answerShown(const ViewedRecording& viewed,
                                            const ReplayQuestion& question) {
  if (question.what == ReplayQuestion::What::kAbout) return about(viewed);
  if (question.what == ReplayQuestion::What::kScene) return scene();
  return states(*viewed.reader, question.states);
}

void ReplayedRecording::prepareScene(const RecordingMeta& meta) {
  if (facts_) return;
  auto facts = recordedScene(meta, path_);
  if (!facts) no_picture_because_ = format(facts.errors());
  facts_ = std::make_shared<const SceneFacts>(facts ? std::move(*facts) : SceneFacts{});
  encoder_ = std::make_unique<wire::StateEncoder>(facts_);
}

ReplayAnswer ReplayedRecording::about(const ViewedRecording& viewed) const {
  const std::string name = std::filesystem::path(path_).filename().string();
  // Its writer may have finished or been killed since.
  const bool still_written =
      viewed.reader->outline().being_written && DiskReserve::isOpenElsewhere(path_);
  return {200, "application/json",
          replayAbout(viewed, name, still_written, *facts_, no_picture_because_)};
}

ReplayAnswer ReplayedRecording::scene() const {
  if (!no_picture_because_.empty()) return replayRefusal(kCannotBeRead, no_picture_because_);
  const wire::Bytes message = wire::sceneMessage(*facts_);
  return {200, kBytes, std::string(message.begin(), message.end())};
}

ReplayAnswer ReplayedRecording::states(RecordingReader& reader,
                                       const StatesQuestion& question) const {
  std::string body;
  TickRecord record;
  for (std::uint64_t n = 0, row = question.first; n < question.count && row < reader.size();
       ++n, row += question.step) {
    if (!reader.read(row, record)) {
      if (n > 0) break;
      return replayRefusal(kCannotBeRead, format(unreadable(path_, row, reader.size())));
    }
    const auto message =
        encoder_->encode(record, recordedStatus(record), wire::Detail::kRecorded, 0);
    const auto bytes = static_cast<std::uint32_t>(message.size());
    body.append(reinterpret_cast<const char*>(&bytes), sizeof bytes);
    body.append(reinterpret_cast<const char*>(message.data()), message.size());
  }
  return {200, kBytes, std::move(body)};
}

}  // namespace wholehand
