#include "pty_adapter.hpp"

#include "support/watched_main.hpp"

#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <poll.h>
#include <stdexcept>
#include <termios.h>
#include <unistd.h>

namespace wholehand::test {
namespace {

std::vector<std::uint8_t> bytesOfHex(const std::string& hex) {
  std::vector<std::uint8_t> out;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
    out.push_back(static_cast<std::uint8_t>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  }
  return out;
}

std::string hexOf(const std::vector<std::uint8_t>& bytes) {
  std::string out;
  for (const std::uint8_t byte : bytes) {
    char text[3];
    std::snprintf(text, sizeof text, "%02X", byte);
    out += text;
  }
  return out;
}

// CAN-FD allows only these lengths; slcan writes the index in this list.
constexpr int kLengths[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64};

int padded(std::vector<std::uint8_t>& bytes) {
  for (int code = 0;; ++code) {
    if (kLengths[code] < static_cast<int>(bytes.size())) continue;
    bytes.resize(static_cast<std::size_t>(kLengths[code]), 0x50);
    return code;
  }
}

}  // namespace

PtyAdapter::PtyAdapter(moteus::TtyBus::Protocol protocol) : protocol_(protocol) {
  seesTerminal();  // the driver waits for an answer for a limited time
  for (int id = 1; id <= 3; ++id) {
    drives_.emplace_back(id);
    drives_.back().enabling_ns = 0;
  }
  master_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  char name[64];
  if (master_ < 0 || ::grantpt(master_) != 0 || ::unlockpt(master_) != 0 ||
      ::ptsname_r(master_, name, sizeof name) != 0) {
    throw std::runtime_error("no pseudo terminal");
  }
  port_ = name;
  thread_ = std::thread([this] { run(); });
}

PtyAdapter::~PtyAdapter() {
  ends_ = true;
  thread_.join();
  if (master_ >= 0) ::close(master_);
}

void PtyAdapter::pass(std::int64_t ns) {
  const std::lock_guard lock(mutex_);
  now_ns_ += ns;
  for (FakeDrive& drive : drives_) drive.advance(now_ns_);
}

std::vector<std::string> PtyAdapter::others() {
  const std::lock_guard lock(mutex_);
  return others_;
}

void PtyAdapter::unplug() {
  ends_ = true;
  thread_.join();
  thread_ = std::thread([] {});
  write("rcv 100 2404000a00");
  ::close(master_);
  master_ = -1;
}

void PtyAdapter::write(const std::string& text) {
  const auto step = static_cast<std::size_t>(chunk.load());
  for (std::size_t at = 0; at < text.size(); at += step) {
    const std::string part = text.substr(at, step);
    if (::write(master_, part.data(), part.size()) < 0) return;
  }
}

void PtyAdapter::answer(const std::string& line) {
  const bool slcan = protocol_ == moteus::TtyBus::Protocol::kSlcan;
  unsigned id = 0;
  char hex[160] = "";
  const int read = slcan ? std::sscanf(line.c_str(), "B%8x%*1[0-9a-f]%159s", &id, hex) +
                               (line.size() == 10 ? 1 : 0)
                         : std::sscanf(line.c_str(), "can send %x %159s", &id, hex);
  // Identifiers up to 0x7ff are written in short form: text for the diagnostic channel.
  const int is_short =
      slcan && read != 2 ? std::sscanf(line.c_str(), "b%3x%*1[0-9a-f]%159s", &id, hex) : 0;
  const std::lock_guard lock(mutex_);
  if (read != 2 && is_short != 2) {
    others_.push_back(line);
    return;
  }
  write(slcan ? "z\r" : "OK\r\n");
  if (babbles) write(slcan ? "xyz\r" : "rcv 1z\r\nhello\r\nERR what\r\nrcv 900 00\r\n");
  for (FakeDrive& drive : drives_) {
    if ((id & 0x7f) != static_cast<unsigned>(drive.id())) continue;
    auto said = drive.take(bytesOfHex(hex), (id & 0x8000) != 0, now_ns_);
    if (!said) continue;
    const int code = padded(*said);
    char head[32];
    if (slcan) {
      std::snprintf(head, sizeof head, "b%03x%x", static_cast<unsigned>(drive.id()) << 8,
                    static_cast<unsigned>(code));
    } else {
      std::snprintf(head, sizeof head, "rcv %x ", static_cast<unsigned>(drive.id()) << 8);
    }
    write(head + hexOf(*said) + (slcan ? "\r" : " E B F\r\n"));
  }
}

void PtyAdapter::run() {
  std::string text;
  while (!ends_) {
    pollfd wait{master_, POLLIN, 0};
    if (::poll(&wait, 1, 20) <= 0) continue;
    char buffer[512];
    const ssize_t n = ::read(master_, buffer, sizeof buffer);
    if (n <= 0) {  // the port is not open yet, or closed again
      ::usleep(1000);
      continue;
    }
    text.append(buffer, static_cast<std::size_t>(n));
    for (std::size_t end = text.find_first_of("\r\n"); end != std::string::npos;
         end = text.find_first_of("\r\n")) {
      if (end > 0) answer(text.substr(0, end));
      text.erase(0, end + 1);
    }
  }
}

}  // namespace wholehand::test
