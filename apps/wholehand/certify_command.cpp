#include "certify_command.hpp"

#include "assembly/sampled_inertia.hpp"
#include "certificate_chart.hpp"
#include "certification/certificate_text.hpp"
#include "chart_file.hpp"
#include "commissioning/passport.hpp"
#include "core/printable.hpp"
#include "exercise/load_exercise.hpp"
#include "exit_code.hpp"
#include "files/text_file.hpp"
#include "impedance_command.hpp"
#include "json_text.hpp"
#include "model/hand/hand_assembly.hpp"
#include "model/hand/hand_file.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

template <class T>
void collect(const Expected<T>& loaded, Diagnostics& errors) {
  if (!loaded) errors.insert(errors.end(), loaded.errors().begin(), loaded.errors().end());
}

void takeWalls(LoadedExercise loaded, Models& models) {
  models.exercise = std::move(loaded.exercise);
  models.exercise_walls = std::move(loaded.walls);
}

/// Loads device, gains, hand and exercise; reports every fault of every file. Unstable gains are
/// not a fault of the file.
Expected<Models> loadFiles(const CertifyOptions& o) {
  Diagnostics errors;
  Models models;
  const auto device = loadDeviceFile(o.device);
  const auto hand_file = loadHandFile(o.hand);
  collect(device, errors);
  collect(hand_file, errors);
  if (device) {
    models.device = *device;
    const auto rendering = loadRenderingFile(o.rendering, *device);
    collect(rendering, errors);
    if (rendering) models.rendering = *rendering;
  }
  if (device && hand_file) {
    const auto hand = assembleHand(*hand_file, *device);
    collect(hand, errors);
    if (hand) models.hand = *hand;
    if (hand && !o.exercise.empty()) {
      auto exercise = loadExercise(o.exercise, o.level, *device, *hand);
      collect(exercise, errors);
      if (exercise) takeWalls(std::move(*exercise), models);
    }
  }
  if (!errors.empty()) return errors;
  return models;
}

AdvisedCertificate judge(CertificateInput input) {
  AdvisedCertificate out;
  out.input = std::move(input);
  out.certificate = certify(out.input);
  for (std::size_t i = 0; i < out.certificate.axes.size(); ++i) {
    const AxisCase& c = out.certificate.axes[i].axis_case;
    std::size_t twin = 0;  // x, y and z are often equal
    while (twin < i && !sameCase(out.certificate.axes[twin].axis_case, c)) ++twin;
    out.advice.push_back(twin < i ? out.advice[twin] : advise(c));
  }
  if (!out.certificate.certified) out.nearest = nearestGains(out.input, out.certificate);
  return out;
}

// Devices to judge: the one of the file, or the passport's at both ends of its mass intervals.
Expected<std::vector<DeviceModel>> judgedDevices(const CertifyOptions& o,
                                                 const DeviceModel& device) {
  if (o.passport.empty()) return std::vector<DeviceModel>{device};
  const auto passport = readPassport(o.passport);
  if (!passport) return passport.errors();
  // The connected device is unknown here: `run` checks it.
  if (auto fits = checkPassport(*passport, passport->identity, device, placeTimeNow()); !fits) {
    return fits.errors();
  }
  return worstCorners(device, *passport, 1.0 / o.rate_hz);
}

// The corner with the least margin.
AdvisedCertificate judgeWorst(const Models& models, const std::vector<DeviceModel>& devices,
                              const CertifyOptions& o) {
  AdvisedCertificate worst;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    CertificateInput input = certificateInput(models, 1.0 / o.rate_hz);
    input.device = devices[i];
    if (!o.passport.empty()) input.persons = Persons::kAny;
    AdvisedCertificate judged = judge(std::move(input));
    if (!o.passport.empty()) {
      judged.corner = fmt::format("the worst corner of the passport {}: masses at their {} ends",
                                  printable(o.passport), i == 0 ? "lower" : "upper");
    }
    const bool worse = judged.certificate.certified == worst.certificate.certified
                           ? judged.certificate.margin() < worst.certificate.margin()
                           : !judged.certificate.certified;
    if (i == 0 || worse) worst = std::move(judged);
  }
  return worst;
}

}  // namespace

int certifyCommand(const CertifyOptions& options) {
  const auto models = loadFiles(options);
  if (!models) return refuse(models.errors());
  if (options.impedance) {
    return impedanceCommand(*models,
                            {1.0 / options.rate_hz, options.contact_stiffness_n_m, options.engine},
                            options.json, options.charts);
  }
  if (auto ready = prepareCharts(options.charts, {options.json}); !ready) {
    return refuse(ready.errors());
  }
  const auto devices = judgedDevices(options, models->device);
  if (!devices) return refuse(devices.errors());
  const AdvisedCertificate judged = judgeWorst(*models, *devices, options);
  std::fputs(certificateText(judged).c_str(), stdout);
  if (!options.json.empty()) {
    const auto done = writeText(options.json, jsonText(certificateJson(judged)));
    if (!done) return refuse(done.errors());
  }
  if (!options.charts.empty()) {
    const auto done = writeCharts(certificateChart(judged), options.charts);
    if (!done) return refuse(done.errors());
  }
  return judged.certificate.certified ? kExitDone : kExitNotCertified;
}

}  // namespace wholehand
