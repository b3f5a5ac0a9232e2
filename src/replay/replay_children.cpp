#include "replay/replay_children.hpp"

#include "loop/core/printable.hpp"
#include "record/crash_guard.hpp"
#include "replay/replayed_recording.hpp"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <iostream>
#include <new>
#include <string_view>
#include <sys/stat.h>
#include <type_traits>
#include <unistd.h>
#include <utility>

namespace wholehand {

namespace {

static_assert(std::is_trivially_copyable_v<AnswerHead>);

bool writeAll(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(STDOUT_FILENO, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    bytes.remove_prefix(n);
  }
  return true;
}

bool send(const ReplayAnswer& answer) {
  AnswerHead head;
  head.status = static_cast<std::uint16_t>(answer.status);
  head.is_json = answer.content_type == "application/json" ? 1 : 0;
  head.bytes = answer.body.size();
  return writeAll({reinterpret_cast<const char*>(&head), sizeof head}) && writeAll(answer.body);
}

ReplayAnswer answerOne(ReplayedRecording& recording, const std::string& words) {
  try {
    const auto question = parseReplayQuestion(words);
    if (!question) return replayRefusal(400, format(question.errors()));
    return recording.answer(*question);
  } catch (const std::bad_alloc&) {
    return replayRefusal(422, "it claims more than there is memory for");
  }
}

/// Memory limit of a child. A malicious recording may declare texts of up to 2 GB.
constexpr std::uint64_t kMemory_bytes = 3ULL << 30;
/// Limit of an answer [bytes]; enough for a scene with many meshes.
constexpr std::uint64_t kLargest_bytes = 512ULL << 20;

/// True for signals that indicate a bad file. Ctrl-C in a terminal also reaches the children and
/// does not count.
bool isCrash(int signal) {
  return std::find(kCrashSignals.begin(), kCrashSignals.end(), signal) != kCrashSignals.end();
}

}  // namespace

void answerQuestions(const std::string& recording_path) {
  // When memory runs out, the kernel kills this process first, not the one with the loop.
  std::ofstream("/proc/self/oom_score_adj") << 1000;
  ReplayedRecording recording(recording_path);
  for (std::string words; std::getline(std::cin, words);) {
    if (!send(answerOne(recording, words))) return;
  }
}

ReplayChildren::Stamp ReplayChildren::stampOf(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return {};
  return {status.st_dev, status.st_ino, static_cast<std::uint64_t>(status.st_size),
          status.st_mtim.tv_sec * 1'000'000'000 + status.st_mtim.tv_nsec};
}

// Finds or starts the reader of a recording. The question "about" checks whether the file has
// changed; all later questions refer to that state of the file.
std::shared_ptr<ReplayChildren::Reader> ReplayChildren::readerOf(const std::string& path,
                                                                 const ReplayQuestion& question) {
  Readers gone;  // destroyed outside the lock
  const bool plots = question.what == ReplayQuestion::Kind::kSeries;
  const bool looks = question.what == ReplayQuestion::Kind::kAbout;
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
                                       {kMemory_bytes, options_.idle_disk});
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
