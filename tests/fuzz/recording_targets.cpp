#include "fuzz_targets.hpp"
#include "record/black_box.hpp"
#include "record/black_box_layout.hpp"
#include "record/black_box_reader.hpp"
#include "record/synthetic_recording.hpp"
#include "support/file_bytes.hpp"
#include "support/folder.hpp"

#include <hdf5.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <memory>
#include <random>
#include <zlib.h>

namespace wholehand::test {
namespace {

std::string wrongWithRefusal(const Diagnostics& refusal) {
  const Diagnostic& why = refusal.front();
  return why.problem.empty() || why.remedy.empty() ? "refused without problem or remedy" : "";
}

std::string withRightChecksums(std::string box) {
  const auto put = [&box](std::size_t begin, std::size_t end) {
    const auto crc = static_cast<std::uint32_t>(::crc32(
        0, reinterpret_cast<const Bytef*>(box.data()) + begin, static_cast<uInt>(end - begin)));
    std::memcpy(box.data() + end, &crc, sizeof crc);
  };
  if (box.size() < sizeof(black_box::Header)) return box;
  put(0, offsetof(black_box::Header, crc));
  for (std::size_t at = sizeof(black_box::Header);
       at + sizeof(black_box::PartHeader) + sizeof(std::uint32_t) <= box.size();) {
    black_box::PartHeader head;
    std::memcpy(&head, box.data() + at, sizeof head);
    const std::size_t room = box.size() - at - sizeof head - sizeof(std::uint32_t);
    const std::size_t end = at + sizeof head + std::min<std::size_t>(head.bytes, room);
    put(at, end);
    at = end + sizeof(std::uint32_t);
  }
  return box;
}

/// A forged black box file with correct checksums.
FuzzTarget blackBoxTarget() {
  const auto folder = std::make_shared<Folder>();
  BlackBoxPlan plan;
  plan.path = folder->file("a.wbb");
  plan.most_ticks = 100;
  {
    auto box = BlackBox::arm(synthetic::meta(), plan).value();
    for (const TickRecord& record : synthetic::noisyTicks(40)) {
      box->beforeTick(record);
      box->afterTick(record);
    }
    if (!box->write()) return {};
  }
  const std::string path = folder->file("forged.wbb");
  return {"black-box",
          {bytesOfFile(plan.path)},
          [folder, path](const std::string& bytes) -> std::string {
            writeBytes(path, withRightChecksums(bytes));
            const auto opened = BlackBoxReader::openBox(path);
            if (!opened) return wrongWithRefusal(opened.errors());
            TickInput input;
            for (int k = 0; k < 1000 && opened.value()->nextInput(input); ++k) {
              if (input.command_count < 0 || input.command_count > kMaxCommands) {
                return "too many commands";
              }
            }
            return readTicks(*opened.value());
          }};
}

struct Dataset {
  std::string path;
  std::vector<hsize_t> extent;
};

/// Everything in a file that holds numbers or texts.
struct Contents {
  std::vector<Dataset> datasets;
  std::vector<std::string> meta_attributes;
};

Contents contentsOf(const std::string& path) {
  Contents contents;
  const hid_t file = ::H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  ::H5Ovisit(
      file, H5_INDEX_NAME, H5_ITER_INC,
      [](hid_t at, const char* name, const H5O_info_t* info, void* to) -> herr_t {
        if (info->type != H5O_TYPE_DATASET) return 0;
        const hid_t set = ::H5Dopen2(at, name, H5P_DEFAULT), space = ::H5Dget_space(set);
        std::vector<hsize_t> extent(static_cast<std::size_t>(::H5Sget_simple_extent_ndims(space)));
        ::H5Sget_simple_extent_dims(space, extent.data(), nullptr);
        static_cast<Contents*>(to)->datasets.push_back({name, extent});
        ::H5Sclose(space);
        ::H5Dclose(set);
        return 0;
      },
      &contents);
  const hid_t meta = ::H5Gopen2(file, "meta", H5P_DEFAULT);
  ::H5Aiterate2(
      meta, H5_INDEX_NAME, H5_ITER_INC, nullptr,
      [](hid_t, const char* name, const H5A_info_t*, void* to) -> herr_t {
        static_cast<Contents*>(to)->meta_attributes.emplace_back(name);
        return 0;
      },
      &contents);
  ::H5Gclose(meta);
  ::H5Fclose(file);
  return contents;
}

void setElement(hid_t file, const Dataset& dataset, std::uint8_t place, const char* value) {
  const hid_t set = ::H5Dopen2(file, dataset.path.c_str(), H5P_DEFAULT);
  const hid_t space = ::H5Dget_space(set), type = ::H5Dget_type(set);
  std::vector<hsize_t> at, one;
  for (const hsize_t n : dataset.extent) {
    at.push_back(n == 0 ? 0 : place % n);
    one.push_back(1);
  }
  const bool empty = std::count(dataset.extent.begin(), dataset.extent.end(), 0U) > 0;
  if (!empty && ::H5Tget_size(type) <= 8) {
    const hid_t memory = ::H5Screate(H5S_SCALAR);
    if (!at.empty()) {
      ::H5Sselect_hyperslab(space, H5S_SELECT_SET, at.data(), nullptr, one.data(), nullptr);
    }
    ::H5Dwrite(set, type, memory, space, H5P_DEFAULT, value);
    ::H5Sclose(memory);
  }
  ::H5Tclose(type);
  ::H5Sclose(space);
  ::H5Dclose(set);
}

void setAttribute(hid_t file, const std::string& name, std::uint8_t place, const char* value) {
  const hid_t attribute = ::H5Aopen_by_name(file, "meta", name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
  const hid_t type = ::H5Aget_type(attribute), space = ::H5Aget_space(attribute);
  const std::size_t size = ::H5Tget_size(type);
  std::string all(size * static_cast<std::size_t>(::H5Sget_simple_extent_npoints(space)), '\0');
  if (!all.empty() && ::H5Aread(attribute, type, all.data()) >= 0) {
    const std::size_t at = place * size % all.size();
    all.replace(at, std::min<std::size_t>({8, size, all.size() - at}), value,
                std::min<std::size_t>({8, size, all.size() - at}));
    ::H5Awrite(attribute, type, all.data());
  }
  ::H5Sclose(space);
  ::H5Tclose(type);
  ::H5Aclose(attribute);
}

/// Edits of a recording's values, as by h5py, with correct checksums. Each has 10 bytes: dataset or
/// attribute, element, the element's new bytes.
constexpr std::size_t kBoxEdit = 10;

void edit(const std::string& path, const Contents& contents, const std::string& edits) {
  const hid_t file = ::H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const std::size_t sets = contents.datasets.size();
  const std::size_t all = sets + contents.meta_attributes.size();
  for (std::size_t at = 0; at + kBoxEdit <= edits.size(); at += kBoxEdit) {
    const std::size_t which = static_cast<std::uint8_t>(edits[at]) % all;
    const auto place = static_cast<std::uint8_t>(edits[at + 1]);
    const char* const value = edits.data() + at + 2;
    if (which < sets) {
      setElement(file, contents.datasets[which], place, value);
    } else {
      setAttribute(file, contents.meta_attributes[which - sets], place, value);
    }
  }
  ::H5Fclose(file);
}

FuzzTarget recordingValuesTarget() {
  const auto folder = std::make_shared<Folder>();
  const std::string whole = folder->file("whole.h5"), edited = folder->file("edited.h5");
  synthetic::writeRecording(whole, synthetic::noisyTicks(20));
  const Contents contents = contentsOf(whole);
  std::vector<std::string> good = randomTexts(8, 4 * kBoxEdit);
  good.emplace_back(kBoxEdit, '\0');
  return {"recording-values", good,
          [folder, whole, edited, contents](const std::string& bytes) -> std::string {
            std::filesystem::copy_file(whole, edited,
                                       std::filesystem::copy_options::overwrite_existing);
            edit(edited, contents, bytes.substr(0, 16 * kBoxEdit));
            const auto opened = RecordingReader::open(edited);
            if (!opened) return wrongWithRefusal(opened.errors());
            return readTicks(*opened.value());
          },
          5'000, 40};
}

}  // namespace

std::string readTicks(RecordingReader& recording) {
  TickRecord record;
  for (std::uint64_t i = 0; i < recording.size(); ++i) {
    if (!recording.read(i, record)) continue;  // its chunk is damaged
    if (record.contact_count < 0 || record.contact_count > kMaxContacts) return "too many contacts";
    if (record.body_count < 0 || record.body_count > static_cast<int>(record.bodies.size())) {
      return "too many bodies";
    }
    if (record.q_m.size() > kMaxAxes || record.sent.size() > kMaxAxes) return "too many axes";
  }
  return "";
}

std::vector<FuzzTarget> recordingTargets() {
  return {blackBoxTarget(), recordingValuesTarget(), recordedTablesTarget()};
}

}  // namespace wholehand::test
