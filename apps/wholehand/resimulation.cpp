#include "resimulation.hpp"

#include "device/replay/replay_device.hpp"
#include "model/toml_file.hpp"
#include "runtime/session.hpp"

#include <fmt/format.h>

#include <bit>
#include <filesystem>
#include <fstream>

namespace wholehand {
namespace fs = std::filesystem;
namespace {

bool sameBits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

// Collects the first difference between two ticks.
class Comparison {
 public:
  void check(const char* name, double a, double b) {
    if (field.empty() && !sameBits(a, b))
      set(name, fmt::format("{:.17g}", a), fmt::format("{:.17g}", b));
  }
  template <class Array>
  void checkArray(const char* name, const Array& a, const Array& b) {
    if (a.size() != b.size()) {
      check((std::string(name) + ".size").c_str(), a.size(), b.size());
      return;
    }
    for (int i = 0; i < a.size(); ++i) check(fmt::format("{}[{}]", name, i).c_str(), a[i], b[i]);
  }
  void check(const std::string& name, const Vec3& a, const Vec3& b) {
    check((name + ".x").c_str(), a.x, b.x);
    check((name + ".y").c_str(), a.y, b.y);
    check((name + ".z").c_str(), a.z, b.z);
  }
  void check(const std::string& name, const BodyState& a, const BodyState& b) {
    check(name + ".position_m", a.position_m, b.position_m);
    check((name + ".orientation_xyzw.x").c_str(), a.orientation_xyzw.x, b.orientation_xyzw.x);
    check((name + ".orientation_xyzw.y").c_str(), a.orientation_xyzw.y, b.orientation_xyzw.y);
    check((name + ".orientation_xyzw.z").c_str(), a.orientation_xyzw.z, b.orientation_xyzw.z);
    check((name + ".orientation_xyzw.w").c_str(), a.orientation_xyzw.w, b.orientation_xyzw.w);
    check(name + ".velocity_m_s", a.velocity_m_s, b.velocity_m_s);
    check(name + ".angular_velocity_rad_s", a.angular_velocity_rad_s, b.angular_velocity_rad_s);
  }
  void check(const std::string& name, const Contact& a, const Contact& b) {
    check((name + ".capsule").c_str(), a.capsule, b.capsule);
    check((name + ".link").c_str(), a.link, b.link);
    check((name + ".body").c_str(), a.body, b.body);
    check(name + ".point_m", a.point_m, b.point_m);
    check(name + ".normal", a.normal, b.normal);
    check(name + ".force_n", a.force_n, b.force_n);
    check(name + ".torque_nm", a.torque_nm, b.torque_nm);
    check((name + ".distance_m").c_str(), a.distance_m, b.distance_m);
  }

  std::string field, first, second;

 private:
  void set(const char* name, std::string a, std::string b) {
    field = name;
    first = std::move(a);
    second = std::move(b);
  }
};

Comparison compareTicks(const TickRecord& a, const TickRecord& b) {
  Comparison c;
  c.check("faults", static_cast<double>(a.faults), static_cast<double>(b.faults));
  c.checkArray("q_m", a.q_m, b.q_m);
  c.checkArray("qd_mf", a.qd_mf, b.qd_mf);
  c.checkArray("q_s", a.q_s, b.q_s);
  c.checkArray("qd_s", a.qd_s, b.qd_s);
  c.checkArray("theta", a.theta, b.theta);
  c.check("coupling_error_rad", a.coupling_error_rad, b.coupling_error_rad);
  c.check("palm_distance_m", a.palm_distance_m, b.palm_distance_m);
  c.checkArray("f_s", a.f_s, b.f_s);
  c.checkArray("coupling", a.coupling, b.coupling);
  c.checkArray("phi", a.phi, b.phi);
  c.checkArray("damping", a.damping, b.damping);
  c.checkArray("rendered", a.rendered, b.rendered);
  c.check("authority", a.authority, b.authority);
  c.checkArray("sent", a.sent, b.sent);
  c.check("body_count", a.body_count, b.body_count);
  c.check("contact_count", a.contact_count, b.contact_count);
  c.check("contacts_dropped", a.contacts_dropped, b.contacts_dropped);
  if (!c.field.empty()) return c;
  for (int i = 0; i < a.body_count; ++i)
    c.check(fmt::format("bodies[{}]", i), a.bodies[i], b.bodies[i]);
  for (int i = 0; i < a.contact_count; ++i) {
    c.check(fmt::format("contacts[{}]", i), a.contacts[i], b.contacts[i]);
  }
  return c;
}

// A folder that goes away with its owner.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::error_code error;
    std::string pattern = (fs::temp_directory_path(error) / "wholehand-XXXXXX").string();
    if (!error && mkdtemp(pattern.data()) != nullptr) path_ = pattern;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }  ///< empty: there is none

 private:
  fs::path path_;
};

Expected<Done> write(const fs::path& path, const std::string& text) {
  std::error_code ignored;  // the file says whether it could be written
  fs::create_directories(path.parent_path(), ignored);
  std::ofstream out(path, std::ios::binary);
  out << text;
  out.close();
  if (out) return Done{};
  return Diagnostic{path.string(),
                    0,
                    "",
                    "",
                    "cannot be unpacked",
                    "make room in the folder for temporary files, or set TMPDIR to another"};
}

// Lays the recorded files out as they lay when they were recorded; which is which their kind says.
Expected<ModelFiles> unpack(const RecordingMeta& meta, const fs::path& folder) {
  ModelFiles files{"", "", "", "", "", ""};
  for (const auto& [name, text] : meta.files) {
    const fs::path path = (folder / name).lexically_normal();
    const fs::path inside = path.lexically_relative(folder);
    if (inside.empty() || *inside.begin() == "..") {
      return Diagnostic{name,
                        0,
                        "",
                        "",
                        "a file of the recording lies outside its folder",
                        "the recording was tampered with"};
    }
    if (auto written = write(path, text); !written) return written.errors();
    if (path.extension() == ".csv") files.motion = path.string();
    if (path.extension() != ".toml") continue;
    auto kind = fileKind(path.string());
    if (!kind) return kind.errors();
    if (*kind == "scene") files.scene = path.string();
    if (*kind == "hand") files.hand = path.string();
    if (*kind == "device") files.device = path.string();
    if (*kind == "rendering") files.rendering = path.string();
    if (*kind == "patient") files.patient = path.string();
  }
  const std::pair<const char*, const std::string*> needed[] = {{"scene", &files.scene},
                                                               {"hand", &files.hand},
                                                               {"device", &files.device},
                                                               {"rendering", &files.rendering},
                                                               {"patient", &files.patient}};
  Diagnostics missing;
  for (const auto& [kind, file] : needed) {
    if (!file->empty()) continue;
    missing.push_back({"", 0, "", "", fmt::format("the recording carries no {} file", kind),
                       "copy it again from where it was recorded"});
  }
  if (!missing.empty()) return missing;
  return files;
}

// Names faults as the person knows the files: not by a temporary folder, but by the recording.
Diagnostics named(Diagnostics errors, const fs::path& folder, const std::string& recording) {
  for (Diagnostic& error : errors) {
    const std::string prefix = folder.string() + "/";
    const bool unpacked = error.file.rfind(prefix, 0) == 0;
    const std::string inside = unpacked ? error.file.substr(prefix.size()) : error.file;
    error.file = inside.empty() ? recording : recording + ": " + inside;
  }
  return errors;
}

std::vector<RecordedReading> readInputs(RecordingReader& recording) {
  const RecordingMeta& meta = recording.meta();
  std::vector<RecordedReading> inputs;
  RecordedReading armed;
  armed.reading.q_m = AxisPosition(static_cast<int>(meta.armed_position.size()));
  std::copy(meta.armed_position.begin(), meta.armed_position.end(), armed.reading.q_m.data());
  inputs.push_back(armed);
  TickRecord record;
  for (std::uint64_t i = 0; recording.read(i, record); ++i) {
    inputs.push_back({{record.q_m, record.intention, record.patient_effort},
                      record.elapsed_periods,
                      record.faults});
  }
  return inputs;
}

}  // namespace

std::string firstDifference(const TickRecord& recorded, const TickRecord& again) {
  return compareTicks(recorded, again).field;
}

Expected<Models> recordedModels(const RecordingMeta& meta, const std::string& recording) {
  const TemporaryFolder folder;
  if (folder.path().empty()) {
    return Diagnostic{recording,
                      0,
                      "",
                      "",
                      "there is no folder to unpack it into",
                      "set TMPDIR to a folder that you may write to"};
  }
  auto files = unpack(meta, folder.path());
  if (!files) return named(files.errors(), folder.path(), recording);
  auto models = loadModels(*files);
  if (!models) return named(models.errors(), folder.path(), recording);
  for (std::string* file : {&models->files.scene, &models->files.hand, &models->files.device,
                            &models->files.rendering, &models->files.patient}) {
    *file = recording + ": " + fs::path(*file).lexically_relative(folder.path()).string();
  }
  return models;
}

Expected<Resimulation> resimulate(RecordingReader& recording, const std::string& path) {
  auto models = recordedModels(recording.meta(), path);
  if (!models) return models.errors();
  RigOptions options;
  options.period_s = recording.meta().period_s;
  options.engine = recording.meta().engine;
  options.uncertified = recording.meta().uncertified;
  auto rig =
      buildRig(std::move(*models), std::make_unique<ReplayDevice>(readInputs(recording)), options);
  if (!rig) return rig.errors();
  flushDenormals();  // as the recorded thread did
  if (auto armed = (*rig)->renderer->arm(); !armed) return armed.errors();

  Resimulation result;
  TickRecord recorded, again;
  for (std::uint64_t i = 0; recording.read(i, recorded); ++i) {
    if (any(recorded.faults & Fault::kStopRequested)) (*rig)->renderer->requestStop();
    (*rig)->renderer->tick(recorded.elapsed_periods, again);
    ++result.ticks;
    const Comparison c = compareTicks(recorded, again);
    if (!c.field.empty()) {
      result.different_tick = recorded.tick;
      result.field = c.field;
      result.recorded = c.first;
      result.again = c.second;
      return result;
    }
  }
  return result;
}

}  // namespace wholehand
