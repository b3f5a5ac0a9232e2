#include "telemetry/recording_meta.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

namespace wholehand::recording {
namespace {

using hdf5::Handle;
using hdf5::readAttribute;
using hdf5::writeAttribute;

bool readFiles(hid_t file, RecordingMeta& meta) {
  const Handle group(H5Gopen2(file, "meta/files", H5P_DEFAULT), H5Gclose);
  H5G_info_t info{};
  if (!group.ok() || H5Gget_info(group.get(), &info) < 0) return false;
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    std::string name, text;
    if (!hdf5::readText(group.get(), std::to_string(i).c_str(), name, text)) return false;
    meta.files.emplace_back(std::move(name), std::move(text));
  }
  return true;
}

/// The terms of the inertia: a row each, degrees and then coefficients.
constexpr const char* kInertia = "inertia";

bool writeInertia(hid_t id, const RecordedInertia& inertia, std::size_t axes) {
  const std::size_t terms = inertia.degrees.size() / axes, size = axes * (axes + 1) / 2;
  std::vector<double> rows;
  for (std::size_t t = 0; t < terms; ++t) {
    const double* degrees = inertia.degrees.data() + t * axes;
    const double* coefficients = inertia.coefficients.data() + t * size;
    rows.insert(rows.end(), degrees, degrees + axes);
    rows.insert(rows.end(), coefficients, coefficients + size);
  }
  return writeAttribute(id, "inertia_lower", inertia.lower) &&
         writeAttribute(id, "inertia_upper", inertia.upper) &&
         hdf5::writeNumbers(id, kInertia, rows, axes + size);
}

bool readInertia(hid_t id, RecordedInertia& inertia, std::size_t axes) {
  std::vector<double> rows;
  const std::size_t width = axes + axes * (axes + 1) / 2;
  if (!readAttribute(id, "inertia_lower", inertia.lower) ||
      !readAttribute(id, "inertia_upper", inertia.upper) ||
      !hdf5::readNumbers(id, kInertia, rows, width)) {
    return false;
  }
  for (auto row = rows.begin(); row != rows.end(); row += static_cast<std::ptrdiff_t>(width)) {
    const auto split = row + static_cast<std::ptrdiff_t>(axes);
    inertia.degrees.insert(inertia.degrees.end(), row, split);
    inertia.coefficients.insert(inertia.coefficients.end(), split,
                                row + static_cast<std::ptrdiff_t>(width));
  }
  return true;
}

/// Numbers per axis or joint, by the names of their attributes.
using Numbers = std::pair<const char*, std::vector<double> RecordedLaw::*>;
constexpr std::array<Numbers, 7> kLaw = {{{"k_pm", &RecordedLaw::k_pm},
                                          {"k_dm", &RecordedLaw::k_dm},
                                          {"gamma", &RecordedLaw::gamma},
                                          {"filter_tau_s", &RecordedLaw::filter_tau_s},
                                          {"theta0", &RecordedLaw::theta0},
                                          {"synergy", &RecordedLaw::synergy},
                                          {"encoder_step", &RecordedLaw::encoder_step}}};
constexpr std::array<Numbers, 7> kLaterLaw = {{{"device_damping", &RecordedLaw::device_damping},
                                               {"tank_capacity", &RecordedLaw::tank_capacity},
                                               {"effort_dead", &RecordedLaw::effort_dead},
                                               {"effort_full", &RecordedLaw::effort_full},
                                               {"phi_kept", &RecordedLaw::phi_kept},
                                               {"hand_axis", &RecordedLaw::hand_axis},
                                               {"palm_contact", &RecordedLaw::palm_contact}}};

bool writeLaw(hid_t id, const RecordingMeta& meta) {
  const RecordedLaw& law = meta.law;
  const auto write = [id, &law](const Numbers& n) {
    return writeAttribute(id, n.first, law.*n.second);
  };
  const bool ok = std::all_of(kLaw.begin(), kLaw.end(), write) &&
                  writeAttribute(id, "output_delay_ticks", law.output_delay_ticks);
  if (!ok || meta.schema < kStepSchema) return ok;
  return std::all_of(kLaterLaw.begin(), kLaterLaw.end(), write) &&
         writeInertia(id, law.inertia, meta.axis_names.size());
}

bool readLaw(hid_t id, RecordingMeta& meta) {
  RecordedLaw& law = meta.law;
  const auto read = [id, &law](const Numbers& n) {
    return readAttribute(id, n.first, law.*n.second);
  };
  const bool ok = std::all_of(kLaw.begin(), kLaw.end(), read) &&
                  readAttribute(id, "output_delay_ticks", law.output_delay_ticks);
  if (!ok || meta.schema < kStepSchema) return ok;
  return std::all_of(kLaterLaw.begin(), kLaterLaw.end(), read) &&
         readInertia(id, law.inertia, meta.axis_names.size());
}

}  // namespace

bool writeMeta(hid_t file, const RecordingMeta& meta) {
  const Handle group(H5Gcreate2(file, "meta", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  const hid_t id = group.get();
  const auto flag = [](bool b) { return std::uint64_t{b ? 1U : 0U}; };
  bool ok = group.ok() && writeAttribute(id, "format", std::string(kFormat)) &&
            writeAttribute(id, "schema_version", meta.schema) &&
            writeAttribute(id, "created_utc", meta.created_utc) &&
            writeAttribute(id, "git_version", meta.git_version) &&
            writeAttribute(id, "title", meta.title) && writeAttribute(id, "seed", meta.seed) &&
            writeAttribute(id, "period_s", meta.period_s) &&
            writeAttribute(id, "engine", meta.engine) &&
            writeAttribute(id, "simulated_clock", flag(meta.simulated_clock)) &&
            writeAttribute(id, "uncertified", flag(meta.uncertified)) &&
            writeAttribute(id, "paper", flag(meta.paper)) &&
            writeAttribute(id, "models_changed", flag(meta.models_changed)) &&
            writeAttribute(id, "simulated_device", flag(meta.simulated_device)) &&
            writeAttribute(id, "passport", meta.passport) &&
            writeAttribute(id, "axis_names", meta.axis_names) &&
            writeAttribute(id, "axis_units", meta.axis_units) &&
            writeAttribute(id, "effort_limits", meta.effort_limits) &&
            writeAttribute(id, "lever_arms_m", meta.lever_arms_m) &&
            writeAttribute(id, "armed_position", meta.armed_position) &&
            writeAttribute(id, "joint_names", meta.joint_names) &&
            writeAttribute(id, "body_names", meta.body_names) &&
            writeAttribute(id, "capsule_names", meta.capsule_names) &&
            writeAttribute(id, "game_slots", meta.game_slots) &&
            writeAttribute(id, "exercise", meta.exercise) &&
            writeAttribute(id, "level", static_cast<std::uint64_t>(std::max(meta.level, 0))) &&
            writeAttribute(id, "parameter_names", meta.parameter_names) &&
            writeAttribute(id, "parameter_values", meta.parameter_values) &&
            writeAttribute(id, "value_names", meta.value_names) &&
            (meta.schema < kStepSchema || writeAttribute(id, "value_steps", meta.value_steps)) &&
            writeAttribute(id, "event_names", meta.event_names) &&
            writeAttribute(id, "result_names", meta.result_names) &&
            writeAttribute(id, "result_labels", meta.result_labels) &&
            writeAttribute(id, "result_units", meta.result_units) &&
            writeAttribute(id, "result_factors", meta.result_factors) &&
            writeAttribute(id, "result_decimals", meta.result_decimals) &&
            (meta.schema < kPackedSchema || writeLaw(id, meta));
  const Handle files(H5Gcreate2(file, "meta/files", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                     H5Gclose);
  for (std::size_t i = 0; ok && i < meta.files.size(); ++i) {
    const auto& [name, text] = meta.files[i];
    ok = hdf5::writeText(files.get(), std::to_string(i).c_str(), name, text);
  }
  return ok && files.ok();
}

bool readMeta(hid_t file, hid_t id, RecordingMeta& meta) {
  std::uint64_t clock = 0, uncertified = 0, paper = 0, simulated = 1;
  const bool ok =
      readAttribute(id, "created_utc", meta.created_utc) &&
      readAttribute(id, "git_version", meta.git_version) &&
      readAttribute(id, "title", meta.title) && readAttribute(id, "seed", meta.seed) &&
      readAttribute(id, "period_s", meta.period_s) && readAttribute(id, "engine", meta.engine) &&
      readAttribute(id, "simulated_clock", clock) &&
      readAttribute(id, "uncertified", uncertified) && readAttribute(id, "paper", paper) &&
      readAttribute(id, "axis_names", meta.axis_names) &&
      readAttribute(id, "axis_units", meta.axis_units) &&
      readAttribute(id, "effort_limits", meta.effort_limits) &&
      readAttribute(id, "lever_arms_m", meta.lever_arms_m) &&
      readAttribute(id, "armed_position", meta.armed_position) &&
      readAttribute(id, "joint_names", meta.joint_names) &&
      readAttribute(id, "body_names", meta.body_names) &&
      readAttribute(id, "capsule_names", meta.capsule_names);
  std::uint64_t level = 0;
  const bool exercise =
      readAttribute(id, "exercise", meta.exercise) && readAttribute(id, "level", level) &&
      readAttribute(id, "parameter_names", meta.parameter_names) &&
      readAttribute(id, "parameter_values", meta.parameter_values) &&
      readAttribute(id, "value_names", meta.value_names) &&
      (meta.schema < kStepSchema || readAttribute(id, "value_steps", meta.value_steps)) &&
      readAttribute(id, "event_names", meta.event_names);
  // Before schema 3 no device was watched for lateness: to a re-simulation all were simulated.
  const bool watched = meta.schema < 3 || readAttribute(id, "simulated_device", simulated);
  std::uint64_t changed = 0;  // not said in older ones
  meta.models_changed = readAttribute(id, "models_changed", changed) && changed != 0;
  if (!readAttribute(id, "passport", meta.passport)) meta.passport.clear();    // the same
  if (!readAttribute(id, "game_slots", meta.game_slots)) meta.game_slots = 0;  // the same
  const bool results = readAttribute(id, "result_names", meta.result_names) &&
                       readAttribute(id, "result_labels", meta.result_labels) &&
                       readAttribute(id, "result_units", meta.result_units) &&
                       readAttribute(id, "result_factors", meta.result_factors) &&
                       readAttribute(id, "result_decimals", meta.result_decimals);
  const std::size_t told = meta.result_names.size();
  if (!results || meta.result_labels.size() != told || meta.result_units.size() != told ||
      meta.result_factors.size() != told || meta.result_decimals.size() != told) {
    meta.result_names.clear();  // from before results
  }
  meta.simulated_device = simulated != 0;
  meta.level = static_cast<int>(std::min<std::uint64_t>(level, 1000));
  meta.simulated_clock = clock != 0;
  meta.uncertified = uncertified != 0;
  meta.paper = paper != 0;
  const bool law = meta.schema < kPackedSchema || readLaw(id, meta);
  return ok && exercise && watched && law && readFiles(file, meta);
}

}  // namespace wholehand::recording
