#pragma once

#include "core/expected.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <sys/types.h>
#include <vector>

namespace wholehand {

/// A process of our own that is asked again and again: its standard input and output are one socket
/// to this process, and it ends where that closes. Otherwise as runChild(). One thread at a time.
class TalkingChild {
 public:
  struct Limits {
    std::uint64_t memory_bytes = 1ULL << 30;  ///< of address space; not under a sanitizer
    bool idle = false;                        ///< lowest priority of CPU and disk
  };

  /// Null where it cannot be started; errno says why.
  [[nodiscard]] static std::unique_ptr<TalkingChild> start(
      const std::string& program, const std::vector<std::string>& arguments, const Limits& limits);
  /// Kills it.
  ~TalkingChild();
  TalkingChild(const TalkingChild&) = delete;
  TalkingChild& operator=(const TalkingChild&) = delete;

  /// Sends all of a text; false where the child has ended.
  [[nodiscard]] bool send(std::string_view text);
  /// So many bytes that it says; fewer where it ended, said nothing in time, or `stop` is true.
  /// @param stop asked every 20 ms; empty: never
  [[nodiscard]] std::string receive(std::size_t bytes, std::chrono::steady_clock::time_point until,
                                    const std::function<bool()>& stop = {});
  /// The signal that ended it, after send() or receive() failed; 0: none did.
  [[nodiscard]] int signal();

 private:
  TalkingChild(pid_t child, int socket) : child_(child), socket_(socket) {}

  pid_t child_;
  int socket_;
  bool hung_up_ = false;  ///< its end of the socket is closed
  bool over_ = false;     ///< its status has been taken
  int status_ = 0;
};

}  // namespace wholehand
