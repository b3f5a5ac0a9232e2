#pragma once

#include "loop/runtime/session.hpp"
#include "vocabulary/backend.hpp"

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace wholehand {

/// Judges whether the loop and the device answer, and whether they obey a stop, by their own words
/// alone. One thread at a time.
class LoopAnswers {
 public:
  /// @param robot a real device, which holds a person
  explicit LoopAnswers(bool robot) : robot_(robot) {}

  /// Notes a stop of the live session.
  /// @param now_ns CLOCK_MONOTONIC, here and below
  void noteStop(bool at_once, std::int64_t now_ns);
  void beginSession() { left_silent_ = false; }
  /// Forgets the session, and keeps whether it ended without an answer.
  void endSession(bool silent);
  /// Forgets a session that never ran.
  void dropSession();

  /// Sets the fields of the status that say what answers.
  /// @param word of the live session; empty: none
  /// @param has_record the live session has sent a record
  void describe(const std::optional<LoopWord>& word, bool has_record, std::int64_t now_ns,
                LoopStatus& status) const;

 private:
  bool robot_;
  /// When the live session was asked to stop, and whether at once; empty: not asked.
  std::optional<std::int64_t> stop_asked_ns_;
  bool stop_at_once_ = false;
  bool left_silent_ = false;  ///< the last session ended without an answer of the device
};

/// Tells the person at the terminal that the loop or the device does not answer, during its
/// lifetime. It has its own thread, because the main thread may be the one that waits for them.
class AnswerWatch {
 public:
  /// @param answers what LoopAnswers::describe() says now
  AnswerWatch(std::function<LoopStatus()> answers, std::function<void(const std::string&)> log);
  ~AnswerWatch();
  AnswerWatch(const AnswerWatch&) = delete;
  AnswerWatch& operator=(const AnswerWatch&) = delete;

 private:
  void watch();

  std::function<LoopStatus()> answers_;
  std::function<void(const std::string&)> log_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool ends_ = false;  ///< guarded by mutex_
  std::thread thread_;
};

}  // namespace wholehand
