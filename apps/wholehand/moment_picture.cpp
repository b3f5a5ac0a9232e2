#include "moment_picture.hpp"

#include "core/plural.hpp"
#include "core/units.hpp"
#include "dynamics/articulated_body.hpp"
#include "picture/picture.hpp"
#include "resimulation/recorded_files.hpp"
#include "telemetry/recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

constexpr double kPalmForward_m =
    0.08;  // the palm frame is at the wrist; the picture is of the hand

double contactForce(const TickRecord& r) {
  double sum_n = 0.0;
  for (int i = 0; i < r.contact_count; ++i) {
    sum_n += r.contacts[static_cast<std::size_t>(i)].force_n.eigen().norm();
  }
  return sum_n;
}

// The first tick that is not before `time_s`. Not time / period: skipped ticks are not in the file.
bool findTime(RecordingReader& recording, double time_s, TickRecord& found) {
  const double from_s = time_s - 0.5 * recording.meta().period_s;
  std::uint64_t low = 0, high = recording.size();
  while (low < high) {
    const std::uint64_t middle = low + (high - low) / 2;
    if (!recording.read(middle, found)) return false;
    if (found.time_s < from_s) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return recording.read(low, found);
}

bool findForce(RecordingReader& recording, TickRecord& found) {
  TickRecord record;
  double largest_n = -1.0;
  for (std::uint64_t i = 0; i < recording.size(); ++i) {
    if (!recording.read(i, record)) return false;
    if (const double n = contactForce(record); n > largest_n) {
      largest_n = n;
      found = record;
    }
  }
  return largest_n >= 0.0;
}

Expected<TickRecord> findMoment(RecordingReader& recording, const std::string& path,
                                double time_s) {
  TickRecord found;
  if (recording.size() == 0) {
    return Diagnostic{path, 0, "", "", "holds no tick", "record a longer run"};
  }
  const bool is_there =
      time_s < 0.0 ? findForce(recording, found) : findTime(recording, time_s, found);
  if (is_there) return found;
  if (time_s >= 0.0 && recording.read(recording.size() - 1, found)) {
    return Diagnostic{path,
                      0,
                      "--at",
                      fmt::format("{:g} s", time_s),
                      "is beyond the end",
                      fmt::format("the recording ends at {:.2f} s", found.time_s)};
  }
  return Diagnostic{path, 0, "", "", "cannot be read to the end", "wholehand replay says where"};
}

}  // namespace

Expected<std::string> drawMoment(const std::string& recording_path, const Moment& moment,
                                 const std::string& png_path) {
  auto recording = RecordingReader::open(recording_path);
  if (!recording) return recording.errors();
  auto found = findMoment(**recording, recording_path, moment.time_s);
  if (!found) return found.errors();
  return drawTick((*recording)->meta(), *found, recording_path, moment, png_path);
}

Expected<std::string> drawTick(const RecordingMeta& meta, const TickRecord& r,
                               const std::string& recording_path, const Moment& moment,
                               const std::string& png_path) {
  auto models = recordedModels(meta, recording_path);
  if (!models) return models.errors();
  ArticulatedBody body(models->hand);
  body.updateKinematics(r.theta);
  PictureRequest request;
  request.target_m =
      body.linkPose(models->hand.palm_link) * Eigen::Vector3d(kPalmForward_m, 0.0, 0.0);
  request.distance_m = moment.distance_m;
  request.azimuth_rad = moment.azimuth_deg * kDeg;
  request.elevation_rad = moment.elevation_deg * kDeg;
  const std::vector<BodyState> bodies(r.bodies.begin(), r.bodies.begin() + r.body_count);
  const std::vector<Contact> contacts(r.contacts.begin(), r.contacts.begin() + r.contact_count);
  auto drawn =
      drawPicture(models->hand, models->scene, r.theta, bodies, contacts, request, png_path);
  if (!drawn) return drawn.errors();
  return fmt::format("{:.2f} s: {} contact point{}, {:.1f} N in all", r.time_s, r.contact_count,
                     plural(r.contact_count), contactForce(r));
}

}  // namespace wholehand
