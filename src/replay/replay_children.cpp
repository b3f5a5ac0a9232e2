#include "replay/replay_children.hpp"

#include "core/printable.hpp"
#include "replay/answering.hpp"
#include "replay/replayed_recording.hpp"
#include "telemetry/crash_guard.hpp"

#include <algorithm>
#include <cstring>
#include <sys/stat.h>
#include <utility>

namespace wholehand {
namespace {

/// A recording may claim texts of up to 2 GB.
constexpr std::uint64_t kMemory_bytes = 3ULL << 30;
/// Largest answer: a scene with many meshes.
constexpr std::uint64_t kLargest_bytes = 512ULL << 20;

/// Ctrl-C in a terminal also reaches the children; it does not indicate a bad file.
bool isCrash(int signal) {
  return std::find(kCrashSignals.begin(), kCrashSignals.end(), signal) != kCrashSignals.end();
}

}  // namespace

ReplayChildren::Stamp ReplayChildren::stampOf(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return {};
  return {status.st_dev, status.st_ino, static_cast<std::uint64_t>(status.st_size),
          status.st_mtim.tv_sec * 1'000'000'000 + status.st_mtim.tv_nsec};
}

// A recording is shown in its state at the page's "about" question; only that question checks
// whether the file has changed.
std::shared_ptr<ReplayChildren::Reader> ReplayChildren::readerOf(const std::string& path,
                                                                 const ReplayQuestion& question) {
  Readers gone;  // destroyed outside the lock
  const bool plots = question.what == ReplayQuestion::What::kSeries;
  const bool looks = question.what == ReplayQuestion::What::kAbout;
  const Stamp stamp = stampOf(path);
  const std::lock_guard lock(mutex_);
  for (auto it = readers_.begin(); it != readers_.end();) {
    const auto next = std::next(it);
    if (looks && (*it)->path == path && (*it)->stamp != stamp)
      gone.splice(gone.end(), readers_, it);
    it = next;
  }
  const auto found = std::find_if(readers_.begin(), readers_.end(), [&](const auto& reader) {
    return reader->path == path && reader->plots == plots;
  });
  if (found != readers_.end()) {
    readers_.splice(readers_.begin(), readers_, found);
  } else {
    auto reader = std::make_shared<Reader>();
    reader->path = path;
    reader->plots = plots;
    reader->stamp = stamp;
    readers_.push_front(std::move(reader));
    if (readers_.size() > options_.most)
      gone.splice(gone.end(), readers_, std::prev(readers_.end()));
  }
  return readers_.front();
}

ReplayAnswer ReplayChildren::failed(Reader& reader) {
  const int signal = reader.child->signal();
  reader.child.reset();
  if (ending_) return replayRefusal(503, "the program is ending");
  const std::string path = printable(reader.path);
  if (!isCrash(signal))
    return replayRefusal(503, path + ": could not be read in time, or its reader was stopped");
  return replayRefusal(422, path + ": is damaged: it ended the program that read it (" +
                                ::strsignal(signal) +
                                "); copy it again from where it was recorded");
}

ReplayAnswer ReplayChildren::ask(Reader& reader, const std::string& question) {
  const std::lock_guard lock(reader.mutex);
  if (!reader.child) {
    reader.child = TalkingChild::start(options_.program, {"replay", reader.path, "--answer"},
                                       {kMemory_bytes, options_.idle});
  }
  if (!reader.child) return replayRefusal(503, "no process can be started to read it");
  const auto until = std::chrono::steady_clock::now() + options_.patience;
  const auto ends = [this] { return ending_.load(); };
  if (!reader.child->send(question + "\n")) return failed(reader);
  const std::string bytes = reader.child->receive(sizeof(AnswerHead), until, ends);
  AnswerHead head;
  if (bytes.size() != sizeof head) return failed(reader);
  std::memcpy(&head, bytes.data(), sizeof head);
  if (head.mark != AnswerHead::kMark || head.bytes > kLargest_bytes) return failed(reader);
  ReplayAnswer answer{head.status,
                      head.is_json != 0 ? "application/json" : "application/octet-stream",
                      reader.child->receive(head.bytes, until, ends)};
  if (answer.body.size() != head.bytes) return failed(reader);
  return answer;
}

ReplayAnswer ReplayChildren::answer(const std::string& path, const std::string& question) {
  const auto parsed = parseReplayQuestion(question);
  if (!parsed) {
    const bool unknown = parsed.errors().front().key.empty();
    return replayRefusal(unknown ? 404 : 400, format(parsed.errors()));
  }
  if (ending_) return replayRefusal(503, "the program is ending");
  const std::shared_ptr<Reader> reader = readerOf(path, *parsed);
  return ask(*reader, textOf(*parsed));
}

}  // namespace wholehand
