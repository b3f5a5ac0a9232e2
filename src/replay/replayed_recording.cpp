#include "replay/replayed_recording.hpp"

#include "files/mesh/convex_hull.hpp"
#include "loop/model/game_shapes.hpp"
#include "record/black_box_reader.hpp"
#include "record/disk_reserve.hpp"
#include "replay/recorded_scene.hpp"
#include "replay/recording_series.hpp"
#include "rig/registry/body_table.hpp"
#include "station/server/wire.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

constexpr int kMostChanges = 20'000;

/// Collects shapes from the recorded commands that handed them to the loop.
class ShapeGatherer {
 public:
  /// Reads a command. Returns the shapes of a set when this was its last command.
  std::optional<std::pair<int, std::shared_ptr<const GameShapes>>> take(const Command& command) {
    switch (command.type) {
      case CommandType::kShapeSet:  // from a file, so any number is possible
        set_ = command.index >= 0 && command.index < kMaxShapeSets ? command.index : kNone;
        head_ = shapeSetHeadOf(command);
        pieces_.clear();
        break;
      case CommandType::kShapePiece:
        if (command.index == set_) addPiece(shapePieceOf(command));
        break;
      case CommandType::kShapeVertices:
        if (command.index == set_) addVertices(shapeVerticesOf(command));
        break;
      default:
        return std::nullopt;
    }
    return whole() ? std::optional(finished()) : std::nullopt;
  }

 private:
  struct Piece {
    Shape shape;
    std::size_t vertices = 0;
  };

  void addPiece(const ShapePiece& in) {
    Piece& out = pieces_.emplace_back();
    static_cast<ShapeForm&>(out.shape) = in;
    // The loop has the pieces in the frame of the principal axes of inertia; pictures need the
    // frame of the body.
    out.shape.in_body = Pose{head_.from_body.toRotationMatrix(), Eigen::Vector3d::Zero()} *
                        Pose{in.orientation.toRotationMatrix(), in.position_m};
    out.vertices = std::clamp(in.vertices, 0, kMaxPieceVertices);
  }
  void addVertices(const ShapeVertices& in) {
    if (pieces_.empty()) return;
    auto& points = pieces_.back().shape.points_m;
    for (int i = 0; i < std::min(in.count, kVerticesPerCommand); ++i) {
      points.push_back(in.points_m[i]);
    }
  }
  [[nodiscard]] bool whole() const {
    if (set_ == kNone) return false;
    const bool filled = std::all_of(pieces_.begin(), pieces_.end(), [](const Piece& piece) {
      return piece.shape.points_m.size() == piece.vertices;
    });
    return filled && !pieces_.empty() && static_cast<int>(pieces_.size()) == head_.pieces;
  }
  /// Finishes the set. The commands do not contain the faces of a mesh; its convex hull has the
  /// same.
  std::pair<int, std::shared_ptr<const GameShapes>> finished() {
    std::vector<Shape> shapes;
    for (Piece& piece : pieces_) {
      const auto finite = [](const Eigen::Vector3d& p) { return p.allFinite(); };
      const auto& points = piece.shape.points_m;
      if (!std::all_of(points.begin(), points.end(), finite)) continue;
      if (!isShapeType(piece.shape.type)) continue;
      if (piece.vertices > 0) {
        const auto hull = convexHull(piece.shape.points_m);
        if (!hull) continue;
        piece.shape.points_m = hull->points;
        piece.shape.triangles = hull->triangles;
      }
      shapes.push_back(std::move(piece.shape));
    }
    pieces_.clear();
    return {set_, std::make_shared<const GameShapes>(
                      GameShapes{++last_id_, Eigen::Vector3d::Zero(), std::move(shapes)})};
  }

  static constexpr int kNone = -1;

  int set_ = kNone;
  ShapeSetHead head_{0, Eigen::Vector3d::Zero(), Eigen::Quaterniond::Identity()};
  std::vector<Piece> pieces_;
  std::uint32_t last_id_ = 0;
};

/// Writes changes one after another in the format of gameBodiesOf().
class Changes {
 public:
  void add(std::uint64_t row, const GameBodies& bodies) {
    std::vector<std::shared_ptr<const GameShapes>> fresh;
    for (const GameBody& body : bodies) {
      const auto has = [&](const auto& in) {
        return std::find(in.begin(), in.end(), body.shapes) != in.end();
      };
      if (!has(before_) && !has(fresh)) fresh.push_back(body.shapes);
    }
    before_.clear();
    for (const GameBody& body : bodies) before_.push_back(body.shapes);
    const wire::Bytes message = wire::gameBodiesMessage(kReplayedSession, bodies, fresh);
    put(static_cast<std::uint32_t>(row));
    put(static_cast<std::uint32_t>(message.size()));
    body_.append(reinterpret_cast<const char*>(message.data()), message.size());
    ++count_;
  }
  [[nodiscard]] bool full() const { return count_ >= kMostChanges; }
  [[nodiscard]] std::string take() { return std::move(body_); }

 private:
  void put(std::uint32_t number) {
    body_.append(reinterpret_cast<const char*>(&number), sizeof number);
  }
  std::vector<std::shared_ptr<const GameShapes>> before_;
  std::string body_;
  int count_ = 0;
};

}  // namespace

/// Tracks the bodies after each tick.
class SampledBodies::Follower {
 public:
  explicit Follower(const RecordingMeta& meta) { table_.follow(meta.event_names); }

  void onRecord(const TickRecord& record) {
    for (int i = 0; i < record.command_count; ++i) {
      const Command& command = record.commands[static_cast<std::size_t>(i)];
      if (auto set = shapes_.take(command)) table_.noteShapes(set->first, std::move(set->second));
      if (command.type == CommandType::kSpawn) table_.noteSpawn(spawnOrderOf(command));
    }
    table_.onRecord(record);
  }
  [[nodiscard]] std::shared_ptr<const GameBodies> bodies() const { return table_.inSlots(); }

 private:
  BodyTable table_;
  ShapeGatherer shapes_;
};

std::string gameBodiesOf(RecordingReader& recording) {
  if (recording.meta().game_slots == 0) return {};
  SampledBodies::Follower follower(recording.meta());
  Changes changes;
  std::shared_ptr<const GameBodies> shown;
  TickRecord record;
  for (std::uint64_t row = 0; row < recording.size() && !changes.full(); ++row) {
    if (!recording.read(row, record)) continue;
    follower.onRecord(record);
    const auto now = follower.bodies();
    if (now == shown) continue;
    shown = now;
    changes.add(row, *now);
  }
  return changes.take();
}

SampledBodies::SampledBodies(const RecordingMeta& meta)
    : follower_(meta.game_slots == 0 ? nullptr : std::make_unique<Follower>(meta)) {}
SampledBodies::~SampledBodies() = default;

void SampledBodies::onRecord(const TickRecord& record) {
  if (follower_) follower_->onRecord(record);
}

void SampledBodies::keep(std::uint64_t row) {
  if (!follower_) return;
  auto now = follower_->bodies();
  if (now == (changes_.empty() ? nullptr : changes_.back().bodies)) return;
  changes_.push_back({row, std::move(now)});
}

std::string SampledBodies::at(const std::vector<std::uint64_t>& rows, std::size_t step) const {
  Changes out;
  std::shared_ptr<const GameBodies> shown;
  auto next = changes_.begin();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i % step != 0 && i + 1 < rows.size()) continue;
    for (; next != changes_.end() && next->row <= rows[i]; ++next) {
    }
    if (next == changes_.begin() || std::prev(next)->bodies == shown) continue;
    shown = std::prev(next)->bodies;
    out.add(rows[i], *shown);
  }
  return out.take();
}

namespace {

constexpr const char* kBytes = "application/octet-stream";
constexpr int kCannotBeRead = 422;

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
    as =
        fileFault(path_, "is a black box, which pages do not show",
                  "take its last seconds out with: wholehand replay --extract seconds.h5 " + path_);
    return *as;
  }
  as = viewRecording(path_, left_out);
  if (*as && as->value().reader->size() == 0) {
    as = fileFault(path_, "holds no ticks", "record a run that lasts a while");
  }
  return *as;
}

ReplayAnswer ReplayedRecording::answer(const ReplayQuestion& question) {
  const bool bodies = question.what == ReplayQuestion::Kind::kBodies;
  const bool plots = bodies || question.what == ReplayQuestion::Kind::kSeries;
  const auto& viewed = plots ? open(plotted_, leftOutOfSeries()) : open(shown_, {});
  if (!viewed) return replayRefusal(kCannotBeRead, format(viewed.errors()));
  if (bodies) return {200, kBytes, gameBodiesOf(*viewed->reader)};
  if (plots) return {200, kBytes, seriesMessage(*viewed->reader, question.series)};
  prepareScene(viewed->reader->meta());
  return answerShown(*viewed, question);
}

ReplayAnswer ReplayedRecording::answerShown(const ViewedRecording& viewed,
                                            const ReplayQuestion& question) {
  if (question.what == ReplayQuestion::Kind::kAbout) return about(viewed);
  if (question.what == ReplayQuestion::Kind::kScene) return scene();
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
  // The writer may have finished or been killed since the file was opened.
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
