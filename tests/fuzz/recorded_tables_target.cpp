// Recording data that HDF5 has read, from bytes in memory: a forged description, row counts,
// numbers and packed blocks, without a file (3 ms each), up to the output computed from them.
#include "fuzz/memory_tables.hpp"
#include "fuzz_targets.hpp"
#include "record/hdf5_tables.hpp"
#include "record/recorded_tables.hpp"
#include "record/recording_meta.hpp"
#include "record/synthetic_recording.hpp"
#include "replay/recorded_scene.hpp"
#include "replay/recording_report.hpp"
#include "replay/recording_series.hpp"
#include "replay/therapy_facts.hpp"
#include "support/folder.hpp"

#include <algorithm>
#include <cstring>
#include <memory>
#include <random>
#include <zlib.h>

namespace wholehand::test {
namespace {

using namespace recording;

constexpr double kTablePeriod_s = 0.04;  // chunks of kBlockRows
constexpr std::uint64_t kTicks = 30, kMostRows = 80;

RecordingMeta goodMeta() {
  RecordingMeta meta = synthetic::meta();
  meta.period_s = kTablePeriod_s;
  meta.files.clear();
  return meta;
}

MemoryTables goodTables() {
  const Folder folder;
  const std::string path = folder.file("a.h5");
  synthetic::writeRecording(path, synthetic::noisyTicks(kTicks), goodMeta());
  const hdf5::Handle file(::H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  const RecordingMeta meta = goodMeta();
  MemoryTables all;
  RecordedTables tables(meta, {});
  CapturedTables captured(file.get(), all);
  return tables.open(captured, WriterState::kClosed).empty() && tables.size() == kTicks
             ? all
             : MemoryTables{};
}

/// An edit: kind (1 byte), dataset or field (1), position (2), the new value (8).
constexpr std::size_t kEdit = 12, kMostEdits = 16;

struct Edit {
  std::uint8_t what, which;
  std::uint16_t where;
  std::uint64_t value;
};

Edit editAt(const std::string& bytes, std::size_t at) {
  Edit e{static_cast<std::uint8_t>(bytes[at]), static_cast<std::uint8_t>(bytes[at + 1]), 0, 0};
  std::memcpy(&e.where, bytes.data() + at + 2, sizeof e.where);
  std::memcpy(&e.value, bytes.data() + at + 4, sizeof e.value);
  return e;
}

double number(const Edit& e) {
  double value = 0.0;
  std::memcpy(&value, &e.value, sizeof value);
  return value;
}

void setOne(std::vector<double>& values, const Edit& e) {
  if (!values.empty()) values[e.where % values.size()] = number(e);
}

/// Gives these lists `n` elements each.
void resize(std::vector<std::string>& names, std::size_t n,
            std::initializer_list<std::vector<double>*> numbers) {
  names.resize(n, "a");
  for (std::vector<double>* of : numbers) of->resize(n, 0.5);
}

void editSizes(RecordingMeta& m, const Edit& e) {
  const std::size_t n = e.where;
  switch (e.which % 7) {
    case 0:
      resize(m.axis_names, n % 18,
             {&m.effort_limits, &m.lever_arms_m, &m.encoder_step, &m.armed_position});
      m.axis_units.resize(n % 18, "rad");
      break;
    case 1:
      resize(m.joint_names, n % 34, {});
      break;
    case 2:
      resize(m.body_names, n % 131, {});
      break;
    case 3:
      resize(m.parameter_names, n % 70, {&m.parameter_values});
      break;
    case 4:
      resize(m.value_names, n % 50, {});
      break;
    case 5:
      resize(m.result_names, n % 5, {&m.result_factors, &m.result_decimals});
      m.result_labels.resize(n % 5, "a");
      m.result_units.resize(n % 5, "a");
      break;
    default:
      m.armed_position.resize(n % 20, number(e));
  }
}

void editMeta(RecordingMeta& m, const Edit& e) {
  switch (e.which % 8) {
    case 0:
      m.period_s = number(e);
      break;
    case 1:
      m.game_slots = e.value;
      break;
    case 2:
      for (std::vector<double>* of :
           {&m.effort_limits, &m.lever_arms_m, &m.parameter_values, &m.result_decimals}) {
        setOne(*of, e);
      }
      break;
    case 3:
      m.simulated_clock = !m.simulated_clock;
      break;
    default:
      editSizes(m, {e.what, static_cast<std::uint8_t>(e.which / 8), e.where, e.value});
  }
}

void editDataset(MemoryDataset& d, const Edit& e, const std::string& rest) {
  switch (e.what % 8) {
    case 4:
      d.rows = e.value % kMostRows;
      break;
    case 5:
      d.unreadable_chunk = e.value % 4;
      break;
    case 6: {  // a packed block for its first rows
      std::vector<std::byte> planes(kBlockRows * d.row_bytes), rows(planes.size());
      std::vector<std::byte> packed(rest.size());
      std::transform(rest.begin(), rest.end(), packed.begin(),
                     [](char c) { return static_cast<std::byte>(c); });
      if (!unpackChunk(packed, d.element_bytes, planes, rows.data())) break;
      d.bytes.resize(std::max(d.bytes.size(), rows.size()));
      std::copy(rows.begin(), rows.end(), d.bytes.begin());
      break;
    }
    default: {
      const std::size_t width = d.row_bytes % 8 == 0 ? 8 : 4;
      if (d.bytes.size() < width) break;
      std::memcpy(d.bytes.data() + e.where % (d.bytes.size() / width) * width, &e.value, width);
    }
  }
}

class MemoryRecording final : public RecordingReader {
 public:
  MemoryRecording(RecordingMeta meta, MemoryTables all)
      : meta_(std::move(meta)), all_(std::move(all)), tables_(meta_, {}) {}
  std::string open() {
    MemorySource source(all_);
    return tables_.open(source, WriterState::kClosed);
  }
  std::optional<std::uint64_t> leaveOutDamagedEnd() { return tables_.leaveOutDamagedEnd(); }
  [[nodiscard]] const RecordingMeta& meta() const override { return meta_; }
  [[nodiscard]] std::uint64_t size() const override { return tables_.size(); }
  [[nodiscard]] const RecordingOutline& outline() const override { return tables_.outline(); }
  bool read(std::uint64_t i, TickRecord& record) override { return tables_.read(i, record); }
  [[nodiscard]] std::uint64_t digest() const override { return tables_.digest(); }
  [[nodiscard]] bool isExact() const override { return false; }

 private:
  RecordingMeta meta_;
  MemoryTables all_;
  RecordedTables tables_;
};

/// The output that a page and a report compute from a recording.
std::string shown(ViewedRecording& viewed) {
  RecordingReader& reader = *viewed.reader;
  const double period_s = reader.meta().period_s;
  const double from_s = static_cast<double>(reader.outline().numbers.front()) * period_s;
  std::string out = seriesMessage(reader, {from_s, from_s + 100.0 * period_s, 30});
  out += seriesMessage(reader, {from_s, from_s, 1});  // ticks beyond 2^53
  TherapyFacts therapy(reader.meta());
  EngineeringFacts engineering(reader.meta());
  TickRecord record;
  for (std::uint64_t i = 0; i < reader.size(); ++i) {
    if (!reader.read(i, record)) continue;
    therapy.add(record, i % 2 == 0);
    engineering.add(record);
  }
  out += therapy.json().dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  out += engineering.json().dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  return out + replayAbout(viewed, "a.h5", false, {}, "");
}

std::string enter(const MemoryTables& good, const std::string& bytes) {
  if (bytes.empty()) return "";
  RecordingMeta meta = goodMeta();
  MemoryTables all = good;
  std::vector<MemoryDataset*> datasets;
  for (auto& [name, dataset] : all) datasets.push_back(&dataset);
  for (std::size_t i = 0, at = 1; i < kMostEdits && at + kEdit <= bytes.size(); ++i, at += kEdit) {
    const Edit e = editAt(bytes, at);
    if (e.what % 8 == 7) {
      editMeta(meta, e);
    } else {
      editDataset(*datasets[e.which % datasets.size()], e, bytes.substr(at + kEdit));
    }
    if (e.what % 8 == 6) break;  // the rest is the block
  }
  if (!unusable(meta).empty()) return "";
  auto reader = std::make_unique<MemoryRecording>(std::move(meta), std::move(all));
  if (!reader->open().empty()) return "";
  ViewedRecording viewed;
  viewed.unreadable_from_tick = reader->leaveOutDamagedEnd();
  viewed.reader = std::move(reader);
  std::string wrong = readTicks(*viewed.reader);
  if (wrong.empty() && viewed.reader->size() > 0 && bytes[0] % 16 == 0) {
    viewed.last_tick = viewed.reader->outline().numbers.back();
    if (shown(viewed).empty()) wrong = "shows nothing";
  }
  return wrong;
}

/// An edit that packs the first rows of a dataset as the writer does: shuffled, then deflated.
std::string packedEdit(const MemoryTables& good, std::uint8_t which) {
  const MemoryDataset& d = std::next(good.begin(), which)->second;
  const std::size_t bytes = kBlockRows * d.row_bytes, elements = bytes / d.element_bytes;
  std::string planes(bytes, '\0');
  for (std::size_t i = 0; i < std::min(bytes, d.bytes.size()); ++i) {
    planes[i % d.element_bytes * elements + i / d.element_bytes] = static_cast<char>(d.bytes[i]);
  }
  std::string packed(::compressBound(bytes), '\0');
  uLongf length = packed.size();
  ::compress(reinterpret_cast<Bytef*>(packed.data()), &length,
             reinterpret_cast<const Bytef*>(planes.data()), planes.size());
  packed.resize(length);
  std::string edit(kEdit, '\0');
  edit[0] = 6;
  edit[1] = static_cast<char>(which);
  return edit + packed;
}

}  // namespace

FuzzTarget recordedTablesTarget() {
  const auto good = std::make_shared<const MemoryTables>(goodTables());
  if (good->empty()) return {"recorded-tables", {}, {}};
  std::vector<std::string> inputs = randomTexts(24, 1 + 3 * kEdit);
  inputs.insert(inputs.end(), {std::string(1, '\0'), std::string(1, '\1')});
  for (std::size_t which = 0; which < good->size(); which += 7) {
    inputs.push_back(std::string(1, '\0') + packedEdit(*good, static_cast<std::uint8_t>(which)));
  }
  return {"recorded-tables", inputs,
          [good](const std::string& bytes) { return enter(*good, bytes); }, 1'000'000, 1'000};
}

}  // namespace wholehand::test
