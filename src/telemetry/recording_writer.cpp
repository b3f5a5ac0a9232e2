#include "files/durable_file.hpp"
#include "telemetry/input_journal.hpp"
#include "telemetry/recording.hpp"
#include "telemetry/recording_bounds.hpp"
#include "telemetry/recording_file.hpp"
#include "telemetry/recording_parts.hpp"

#include <atomic>
#include <chrono>
#include <memory>
#include <utility>

namespace wholehand {
namespace {

using recording::RecordingFile;
using Clock = std::chrono::steady_clock;

/// Rows older than this are written although their chunk is not full: a kill costs less than 1.5 s.
constexpr auto kOldest = std::chrono::milliseconds(1200);
/// How long a disk that took nothing is left alone before writing is tried again.
constexpr auto kRetryAfter = std::chrono::milliseconds(100);

class Hdf5Writer final : public RecordingWriter {
 public:
  Hdf5Writer(std::string path, RecordingMeta meta)
      : path_(std::move(path)),
        meta_(std::move(meta)),
        most_pending_(recording::chunkRows(meta_.period_s)),
        file_(std::make_unique<RecordingFile>(meta_)) {}
  ~Hdf5Writer() override { close(); }

  /// Creates the file with everything but ticks. What went wrong, or nothing.
  std::string create();

  bool append(const TickRecord& record) override;
  void flush() override {
    hdf5::beginHdf5();
    writeOut();
  }
  void close() override;
  [[nodiscard]] std::uint64_t written() const override { return written_; }
  [[nodiscard]] std::uint64_t dropped() const override { return dropped_; }
  [[nodiscard]] std::uint64_t bytes() const override { return bytes_; }

 private:
  bool writeOut();
  bool beginPart();
  void endFile();

  const std::string path_;
  const RecordingMeta meta_;
  const std::uint64_t most_pending_;
  std::unique_ptr<RecordingFile> file_;  ///< null: closed, or never created
  std::unique_ptr<InputJournal> journal_;
  int part_ = 1;
  bool refused_ = false;                            ///< the disk refused a write to this file
  std::uint64_t ended_rows_ = 0, ended_bytes_ = 0;  ///< of the parts before this one
  Clock::time_point oldest_pending_{};
  Clock::time_point failed_at_ = Clock::time_point::min();
  bool failing_ = false;
  std::atomic<std::uint64_t> written_{0}, dropped_{0}, bytes_{0};
};

std::string Hdf5Writer::create() {
  std::string problem = InputJournal::create(InputJournal::pathOf(path_), meta_, journal_);
  if (problem.empty()) problem = file_->create(path_, meta_);
  if (problem.empty()) {
    bytes_ = file_->bytes();
  } else {
    file_.reset();
    if (journal_) journal_->remove();
  }
  return problem;
}

bool Hdf5Writer::append(const TickRecord& record) {
  hdf5::beginHdf5();
  if (journal_) journal_->append(record);
  if (file_ == nullptr || (file_->pending() >= most_pending_ && !writeOut())) {
    ++dropped_;
    return false;
  }
  if (file_->pending() == 0) oldest_pending_ = Clock::now();
  file_->push(record);
  if (file_->atChunkEnd() || Clock::now() - oldest_pending_ > kOldest) writeOut();
  return true;
}

bool Hdf5Writer::writeOut() {
  if (file_ == nullptr) return false;
  if (file_->pending() == 0) return true;
  if (failing_ && Clock::now() - failed_at_ < kRetryAfter) return false;
  failing_ = true;
  if (!refused_ || beginPart()) {
    const RecordingFile::Written done = file_->write();
    failing_ = done != RecordingFile::Written::kAll;
    refused_ = done == RecordingFile::Written::kRefused;
  }
  if (failing_) {
    failed_at_ = Clock::now();
    return false;
  }
  written_ = ended_rows_ + file_->written();
  bytes_ = ended_bytes_ + file_->bytes();
  return true;
}

// HDF5 cannot mend a file after a write that the disk refused: a file beside it goes on.
bool Hdf5Writer::beginPart() {
  if (part_ >= recording::kMostParts) return false;
  const std::string path = recording::partPath(path_, part_ + 1);
  auto part = std::make_unique<RecordingFile>(meta_);
  if (!recording::reasonNotToReplace(path).empty() || !part->create(path, meta_).empty())
    return false;
  part->takeRowsOf(*file_);
  endFile();
  file_ = std::move(part);
  ++part_;
  return true;
}

void Hdf5Writer::endFile() {
  file_->end();
  if (file_->hasName()) {
    (void)syncDurably(part_ == 1 ? path_ : recording::partPath(path_, part_));
    ended_rows_ += file_->written();
    ended_bytes_ += file_->bytes();
  } else {
    dropped_ += file_->written();
  }
  written_ = ended_rows_;
}

void Hdf5Writer::close() {
  hdf5::beginHdf5();
  if (file_ == nullptr) return;
  failing_ = false;  // a last try, whenever the one before was
  if (!writeOut() && refused_) {
    failing_ = false;
    writeOut();
  }
  dropped_ += file_->pending();
  endFile();
  file_.reset();
  if (journal_ && dropped_ > 0) journal_->flush();
  // What could not be recorded can be made again by its inputs.
  if (journal_ && dropped_ == 0) journal_->remove();
  journal_.reset();
}

}  // namespace

Expected<std::unique_ptr<RecordingWriter>> RecordingWriter::create(const std::string& path,
                                                                   const RecordingMeta& meta) {
  hdf5::beginHdf5();
  const auto refuse = [&path](std::string problem) {
    Diagnostic d;
    d.file = path;
    d.problem = std::move(problem);
    d.remedy = "name a file in a folder that exists, is writable and has room";
    return d;
  };
  if (const std::string reason = recording::unusable(meta); !reason.empty()) {
    return refuse("cannot be recorded: the description " + reason);
  }
  if (const std::string why = recording::reasonNotToReplace(path); !why.empty()) return refuse(why);
  auto writer = std::make_unique<Hdf5Writer>(path, meta);
  if (std::string problem = writer->create(); !problem.empty()) return refuse(std::move(problem));
  recording::removeParts(path);  // of the recording whose place this one has taken
  return Expected<std::unique_ptr<RecordingWriter>>(std::move(writer));
}

}  // namespace wholehand
