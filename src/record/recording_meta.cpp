#include "record/recording_meta.hpp"

#include "loop/core/printable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace wholehand::recording {
namespace {

using hdf5::Handle;

/// Calls archive(name, value), which reads or writes one field, for every field of a description
/// except its files. Stops with false at the first failure.
template <class Archive, class Meta>
bool visitMeta(Archive&& a, Meta& m) {
  return a("created_utc", m.created_utc) && a("git_version", m.git_version) &&
         a("title", m.title) && a("profile", m.profile) && a("seed", m.seed) &&
         a("period_s", m.period_s) && a("engine", m.engine) &&
         a("simulated_clock", m.simulated_clock) && a("uncertified", m.uncertified) &&
         a("paper", m.paper) && a("models_changed", m.models_changed) &&
         a("simulated_device", m.simulated_device) && a("passport", m.passport) &&
         a("axis_names", m.axis_names) && a("axis_units", m.axis_units) &&
         a("effort_limits", m.effort_limits) && a("lever_arms_m", m.lever_arms_m) &&
         a("encoder_step", m.encoder_step) && a("armed_position", m.armed_position) &&
         a("joint_names", m.joint_names) && a("body_names", m.body_names) &&
         a("capsule_names", m.capsule_names) &&
         (m.schema < 10 || (a("body_joint_names", m.body_joint_names) &&
                            a("body_joint_units", m.body_joint_units))) &&
         a("game_slots", m.game_slots) && a("exercise", m.exercise) && a("level", m.level) &&
         a("parameter_names", m.parameter_names) && a("parameter_values", m.parameter_values) &&
         a("value_names", m.value_names) && a("event_names", m.event_names) &&
         a("result_names", m.result_names) && a("result_labels", m.result_labels) &&
         a("result_units", m.result_units) && a("result_factors", m.result_factors) &&
         a("result_decimals", m.result_decimals);
}

class Writer {
 public:
  explicit Writer(hid_t id) : id_(id) {}
  bool operator()(const char* name, bool value) const {
    return hdf5::writeAttribute(id_, name, std::uint64_t{value ? 1U : 0U});
  }
  bool operator()(const char* name, int value) const {
    return hdf5::writeAttribute(id_, name, static_cast<std::uint64_t>(std::max(value, 0)));
  }
  template <class T>
  bool operator()(const char* name, const T& value) const {
    return hdf5::writeAttribute(id_, name, value);
  }

 private:
  hid_t id_;
};

class Reader {
 public:
  Reader(hid_t id, std::string& missing) : id_(id), missing_(missing) {}
  bool operator()(const char* name, bool& value) const {
    std::uint64_t number = 0;
    const bool ok = (*this)(name, number);
    value = number != 0;
    return ok;
  }
  bool operator()(const char* name, int& value) const {
    constexpr std::uint64_t kMost = 1000;  // limit for the numbers of a damaged file
    std::uint64_t number = 0;
    const bool ok = (*this)(name, number);
    value = static_cast<int>(std::min(number, kMost));
    return ok;
  }
  template <class T>
  bool operator()(const char* name, T& value) const {
    const bool ok = hdf5::readAttribute(id_, name, value);
    if (!ok) missing_ = name;
    return ok;
  }

 private:
  hid_t id_;
  std::string& missing_;
};

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

constexpr const char *kVisit = "clinic_visit", *kItem = "clinic_item";

// Limits far beyond any loop's period; a file with a period outside them is damaged.
constexpr double kLeastPeriod_s = 1e-6, kMostPeriod_s = 1.0;
constexpr std::int32_t kMostContactsDropped = 1'000'000;

/// True when a line of a TOML text is `kind = "prescription"`.
bool statesPrescription(const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::erase_if(line, [](char c) { return c == ' ' || c == '\t' || c == '\'' || c == '"'; });
    if (line.starts_with("kind=prescription")) return true;
  }
  return false;
}

/// True when a file of the recording is a prescription.
bool isPrescribed(const RecordingMeta& meta) {
  return std::any_of(meta.files.begin(), meta.files.end(), [](const auto& file) {
    return file.first.ends_with(".toml") && statesPrescription(file.second);
  });
}

}  // namespace

bool writeMeta(hid_t file, const RecordingMeta& meta) {
  const Handle group(H5Gcreate2(file, "meta", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  const hid_t id = group.get();
  bool ok = group.ok() && hdf5::writeAttribute(id, "format", std::string(kFormat)) &&
            hdf5::writeAttribute(id, "schema_version",
                                 isPrescribed(meta) ? kPrescribedSchema : kRecordingSchema) &&
            visitMeta(Writer(id), meta);
  if (meta.clinic_visit != 0) {
    ok = ok && hdf5::writeAttribute(id, kVisit, meta.clinic_visit) &&
         hdf5::writeAttribute(id, kItem, meta.clinic_item);
  }
  const Handle files(H5Gcreate2(file, "meta/files", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                     H5Gclose);
  for (std::size_t i = 0; ok && i < meta.files.size(); ++i) {
    const auto& [name, text] = meta.files[i];
    ok = hdf5::writeText(files.get(), std::to_string(i).c_str(), name, text);
  }
  return ok && files.ok();
}

bool hasVariableText(hid_t file) {
  const Handle meta(H5Gopen2(file, "meta", H5P_DEFAULT), H5Gclose);
  if (!meta.ok()) return false;
  if (hdf5::hasVariableText(meta.get())) return true;
  const Handle files(H5Gopen2(file, "meta/files", H5P_DEFAULT), H5Gclose);
  H5G_info_t info{};
  if (!files.ok() || H5Gget_info(files.get(), &info) < 0) return false;
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    const Handle text(H5Dopen2(files.get(), std::to_string(i).c_str(), H5P_DEFAULT), H5Dclose);
    if (text.ok() && (hdf5::isVariableText(text.get()) || hdf5::hasVariableText(text.get()))) {
      return true;
    }
  }
  return false;
}

std::string readMeta(hid_t file, hid_t id, RecordingMeta& meta) {
  std::string missing;
  if (!visitMeta(Reader(id, missing), meta)) return "'" + missing + "' of /meta";
  // Only the recording of a visit has these attributes.
  if (H5Aexists(id, kVisit) > 0 && !(hdf5::readAttribute(id, kVisit, meta.clinic_visit) &&
                                     hdf5::readAttribute(id, kItem, meta.clinic_item))) {
    return fmt::format("'{}' or '{}' of /meta", kVisit, kItem);
  }
  return readFiles(file, meta) ? "" : "the texts in /meta/files";
}

std::string unusable(const RecordingMeta& meta) {
  const auto within = [](std::size_t n, int most) { return std::cmp_less_equal(n, most); };
  const std::size_t axes = meta.axis_names.size();
  if (axes == 0 || !within(axes, kMaxAxes)) {
    return "names " + std::to_string(axes) + " axes; 1 to " + std::to_string(kMaxAxes) +
           " are possible";
  }
  if (meta.axis_units.size() != axes || meta.effort_limits.size() != axes ||
      meta.lever_arms_m.size() != axes || meta.encoder_step.size() != axes ||
      meta.armed_position.size() != axes) {
    return "has not one unit, effort limit, lever arm, encoder step and armed position for each "
           "axis";
  }
  for (const std::vector<std::string>* texts :
       {&meta.axis_names, &meta.axis_units, &meta.joint_names, &meta.body_names,
        &meta.body_joint_names, &meta.body_joint_units, &meta.capsule_names, &meta.parameter_names,
        &meta.value_names, &meta.event_names, &meta.result_names, &meta.result_labels,
        &meta.result_units}) {
    if (!std::all_of(texts->begin(), texts->end(), [](const auto& t) { return isPrintable(t); })) {
      return "holds names that cannot be shown";
    }
  }
  for (const std::string& text :
       {meta.title, meta.profile, meta.created_utc, meta.git_version, meta.engine, meta.exercise}) {
    if (!isPrintable(text, 500)) return "holds texts that cannot be shown";
  }
  if (!within(meta.joint_names.size(), kMaxJoints)) return "names too many joints";
  if (!within(meta.body_names.size(), kMaxBodies)) return "names too many bodies";
  if (meta.body_joint_names.size() > meta.body_names.size() ||
      meta.body_joint_units.size() != meta.body_joint_names.size()) {
    return "has more bodies on joints than bodies, or not one unit for each";
  }
  if (!within(meta.parameter_names.size(), kMaxLiveParameters)) return "names too many parameters";
  if (meta.parameter_values.size() != meta.parameter_names.size()) {
    return "has not one value for each parameter";
  }
  if (!within(meta.value_names.size(), kMaxExerciseValues)) return "names too many values";
  const std::size_t results = meta.result_names.size();
  if (meta.result_labels.size() != results || meta.result_units.size() != results ||
      meta.result_factors.size() != results || meta.result_decimals.size() != results) {
    return "has not one label, unit, factor and number of decimals for each result";
  }
  if (!(meta.period_s >= kLeastPeriod_s && meta.period_s <= kMostPeriod_s)) {
    return fmt::format("has a period of {} s; {} to {} are possible", meta.period_s, kLeastPeriod_s,
                       kMostPeriod_s);
  }
  return {};
}

bool isPlausible(const TickRecord& record) {
  return std::isfinite(record.time_s) && record.contacts_dropped >= 0 &&
         record.contacts_dropped <= kMostContactsDropped;
}

const std::vector<std::string>& labelsOf(const RecordingMeta& meta, FieldLabels labels) {
  static const std::vector<std::string> kNone;
  static const std::vector<std::string> kStageNames = [] {
    std::vector<std::string> names;
    for (int i = 0; i < kStages; ++i) names.emplace_back(stageName(static_cast<Stage>(i)));
    return names;
  }();
  switch (labels) {
    case FieldLabels::kStages:
      return kStageNames;
    case FieldLabels::kAxes:
      return meta.axis_names;
    case FieldLabels::kJoints:
      return meta.joint_names;
    case FieldLabels::kBodies:
      return meta.body_names;
    case FieldLabels::kBodyJoints:
      return meta.body_joint_names;
    case FieldLabels::kParameters:
      return meta.parameter_names;
    case FieldLabels::kValues:
      return meta.value_names;
    case FieldLabels::kNone:
      break;
  }
  return kNone;
}

bool fits(const TickRecord& record, const RecordingMeta& meta) {
  const auto axes = static_cast<int>(meta.axis_names.size());
  bool all = isPlausible(record) && record.q_m.size() == axes && record.sent.size() == axes;
  const auto or_none = [axes](const auto& array) {
    return array.size() == 0 || array.size() == axes;
  };
  visitFields(kRecordFields, [&](const auto& field) {
    const auto& value = field.of(record);
    using Value = std::remove_cvref_t<decltype(value)>;
    if constexpr (kIsItems<Value>) {
      const auto most = field.labels == FieldLabels::kNone
                            ? static_cast<std::size_t>(value.capacity)
                            : labelsOf(meta, field.labels).size();
      all = all && value.count >= 0 && static_cast<std::size_t>(value.count) <= most;
    } else if constexpr (std::is_same_v<Value, JointPosition>) {
      all = all && value.size() <= static_cast<int>(meta.joint_names.size());
    } else if constexpr (kIsTaggedArray<Value>) {
      all = all && or_none(value);
    }
  });
  for (std::int32_t i = 0; all && i < record.command_count; ++i) {
    all = or_none(record.commands[i].aim);
  }
  return all;
}

}  // namespace wholehand::recording

namespace wholehand::black_box {
namespace {

/// Appends values to a byte array.
class Packer {
 public:
  bool operator()(const std::string& text) {
    number(text.size());
    append(text.data(), text.size());
    return true;
  }
  template <class T>
  bool operator()(const T& value) {
    static_assert(std::is_arithmetic_v<T>);
    append(&value, sizeof value);
    return true;
  }
  template <class A, class B>
  bool operator()(const std::pair<A, B>& pair) {
    return (*this)(pair.first) && (*this)(pair.second);
  }
  template <class T>
  bool operator()(const std::vector<T>& list) {
    number(list.size());
    for (const T& item : list) (*this)(item);
    return true;
  }
  std::vector<std::byte> bytes;

 private:
  void number(std::uint64_t n) { (*this)(n); }
  void append(const void* from, std::size_t count) {
    const auto* first = static_cast<const std::byte*>(from);
    bytes.insert(bytes.end(), first, first + count);
  }
};

/// Reads the values back; each call returns whether the value was present.
class Unpacker {
 public:
  Unpacker(const std::byte* at, std::size_t bytes) : at_(at), left_(bytes) {}

  bool operator()(std::string& text) {
    std::uint64_t size = 0;
    if (!(*this)(size) || size > left_) return false;
    text.assign(reinterpret_cast<const char*>(at_), size);
    skip(size);
    return true;
  }
  template <class T>
  bool operator()(T& value) {
    static_assert(std::is_arithmetic_v<T>);
    if (left_ < sizeof value) return false;
    std::memcpy(&value, at_, sizeof value);
    skip(sizeof value);
    return true;
  }
  bool operator()(bool& value) {
    std::uint8_t byte = 0;
    if (!(*this)(byte)) return false;
    value = byte != 0;
    return true;
  }
  template <class A, class B>
  bool operator()(std::pair<A, B>& pair) {
    return (*this)(pair.first) && (*this)(pair.second);
  }
  template <class T>
  bool operator()(std::vector<T>& list) {
    std::uint64_t size = 0;
    if (!(*this)(size) || size > left_) return false;  // an item has at least one byte
    list.clear();
    for (std::uint64_t i = 0; i < size; ++i) {
      if (!(*this)(list.emplace_back())) return false;
    }
    return true;
  }
  [[nodiscard]] bool atEnd() const { return left_ == 0; }

 private:
  void skip(std::size_t count) {
    at_ += count;
    left_ -= count;
  }
  const std::byte* at_;
  std::size_t left_;
};

}  // namespace

std::vector<std::byte> packMeta(const RecordingMeta& meta) {
  Packer packer;
  recording::visitMeta([&packer](const char*, const auto& value) { return packer(value); }, meta);
  packer(meta.clinic_visit);
  packer(meta.clinic_item);
  packer(meta.files);
  return std::move(packer.bytes);
}

bool unpackMeta(const std::byte* in, std::size_t bytes, RecordingMeta& meta) {
  Unpacker unpacker(in, bytes);
  return recording::visitMeta([&unpacker](const char*, auto& value) { return unpacker(value); },
                              meta) &&
         unpacker(meta.clinic_visit) && unpacker(meta.clinic_item) && unpacker(meta.files) &&
         unpacker.atEnd();
}

}  // namespace wholehand::black_box
