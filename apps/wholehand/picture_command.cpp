#include "picture_command.hpp"

#include "dynamics/articulated_body.hpp"
#include "exit_code.hpp"
#include "picture/picture.hpp"
#include "resimulation.hpp"
#include "telemetry/recording.hpp"

#include <cmath>
#include <cstdio>
#include <numbers>

namespace wholehand {
namespace {

constexpr double kDeg = std::numbers::pi / 180.0;
constexpr double kPalmForward_m =
    0.08;  // the palm frame is at the wrist; the picture is of the hand

double contactForce(const TickRecord& r) {
  double sum_n = 0.0;
  for (int i = 0; i < r.contact_count; ++i) {
    sum_n += r.contacts[static_cast<std::size_t>(i)].force_n.eigen().norm();
  }
  return sum_n;
}

bool findMoment(RecordingReader& recording, double time_s, TickRecord& found) {
  if (time_s >= 0.0) {
    const double index = std::round(time_s / recording.meta().period_s);
    const double last = static_cast<double>(recording.size()) - 1.0;
    return recording.read(static_cast<std::uint64_t>(std::min(index, last)), found);
  }
  TickRecord record;
  double largest_n = -1.0;
  for (std::uint64_t i = 0; recording.read(i, record); ++i) {
    if (const double n = contactForce(record); n > largest_n) {
      largest_n = n;
      found = record;
    }
  }
  return largest_n >= 0.0;
}

}  // namespace

int pictureCommand(const PictureOptions& options) {
  auto recording = RecordingReader::open(options.recording);
  if (!recording) return refuse(recording.errors());
  auto models = recordedModels((*recording)->meta(), options.recording);
  if (!models) return refuse(models.errors());
  TickRecord r;
  if (!findMoment(**recording, options.time_s, r)) {
    return refuse({{options.recording, 0, "", "", "holds no tick", "record a longer run"}});
  }
  ArticulatedBody body(models->hand);
  body.updateKinematics(r.theta);
  PictureRequest request;
  request.target_m =
      body.linkPose(models->hand.palm_link) * Eigen::Vector3d(kPalmForward_m, 0.0, 0.0);
  request.distance_m = options.distance_m;
  request.azimuth_rad = options.azimuth_deg * kDeg;
  request.elevation_rad = options.elevation_deg * kDeg;
  const std::vector<BodyState> bodies(r.bodies.begin(), r.bodies.begin() + r.body_count);
  const std::vector<Contact> contacts(r.contacts.begin(), r.contacts.begin() + r.contact_count);
  if (auto done =
          drawPicture(models->hand, models->scene, r.theta, bodies, contacts, request, options.png);
      !done) {
    return refuse(done.errors());
  }
  std::printf("%s: %.3f s, %d contacts, %.2f N in all\n", options.png.c_str(), r.time_s,
              r.contact_count, contactForce(r));
  return kExitDone;
}

}  // namespace wholehand
