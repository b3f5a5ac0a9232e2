#include "can_lines.hpp"

#include <algorithm>
#include <cstring>

namespace wholehand::moteus {
namespace {

constexpr std::string_view kDigits = "0123456789abcdef";
constexpr std::array<std::uint8_t, 16> kSizes = {0, 1,  2,  3,  4,  5,  6,  7,
                                                 8, 12, 16, 20, 24, 32, 48, 64};
constexpr std::uint32_t kMostShortId = 0x7ff, kMostLongId = 0x1fffffff;

int digit(char c) noexcept {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

bool readNumber(std::string_view text, std::uint32_t& number) noexcept {
  if (text.empty() || text.size() > 8) return false;
  number = 0;
  for (const char c : text) {
    const int value = digit(c);
    if (value < 0) return false;
    number = number << 4U | static_cast<std::uint32_t>(value);
  }
  return true;
}

bool readBytes(std::string_view text, CanFrame& frame) noexcept {
  if (text.size() % 2 != 0 || text.size() > 2 * CanFrame::kMostBytes) return false;
  for (std::size_t i = 0; i < text.size() / 2; ++i) {
    const int high = digit(text[2 * i]), low = digit(text[2 * i + 1]);
    if (high < 0 || low < 0) return false;
    frame.data[i] = static_cast<std::uint8_t>(high << 4 | low);
  }
  frame.size = static_cast<std::uint8_t>(text.size() / 2);
  return true;
}

class LineWriter {
 public:
  explicit LineWriter(LineBuffer& line) : line_(line) {}
  void text(std::string_view text) noexcept {
    std::copy(text.begin(), text.end(), line_.begin() + static_cast<std::ptrdiff_t>(length_));
    length_ += text.size();
  }
  void number(std::uint32_t value, int digits) noexcept {
    for (int i = digits - 1; i >= 0; --i) line_[length_++] = kDigits[value >> (4 * i) & 0xfU];
  }
  // Writes all bytes of the frame, and padding up to `size`.
  void bytes(const CanFrame& frame, std::size_t size) noexcept {
    for (std::size_t i = 0; i < size; ++i) number(i < frame.size ? frame.data[i] : kPadding, 2);
  }
  [[nodiscard]] std::size_t length() const noexcept { return length_; }

 private:
  LineBuffer& line_;
  std::size_t length_ = 0;
};

// Removes the word up to the next space from the line, and returns it.
std::string_view nextWord(std::string_view& line) noexcept {
  const std::size_t begin = std::min(line.find_first_not_of(' '), line.size());
  const std::size_t end = std::min(line.find(' ', begin), line.size());
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

}  // namespace

std::size_t frameBytes(std::size_t bytes) noexcept {
  return *std::lower_bound(kSizes.begin(), kSizes.end() - 1, bytes);
}

std::size_t writeFdcanusb(const CanFrame& frame, LineBuffer& line) noexcept {
  LineWriter out(line);
  out.text("can send ");
  out.number(frame.id, frame.id > 0xffff ? 8 : 4);
  out.text(" ");
  out.bytes(frame, frameBytes(frame.size));
  out.text("\n");
  return out.length();
}

LineMeaning readFdcanusb(std::string_view line, CanFrame& frame) noexcept {
  const std::string_view verb = nextWord(line);
  if (verb == "OK") return LineMeaning::kAccepted;
  if (verb == "ERR") return LineMeaning::kRefused;
  if (verb != "rcv") return LineMeaning::kOther;
  const std::string_view id = nextWord(line), data = nextWord(line);
  if (!readNumber(id, frame.id) || frame.id > kMostLongId) return LineMeaning::kOther;
  return readBytes(data, frame) ? LineMeaning::kFrame : LineMeaning::kOther;
}

std::size_t writeSlcan(const CanFrame& frame, LineBuffer& line) noexcept {
  const bool is_long = frame.id > kMostShortId;
  const std::size_t size = frameBytes(frame.size);
  const auto code = std::find(kSizes.begin(), kSizes.end(), size) - kSizes.begin();
  LineWriter out(line);
  out.text(is_long ? "B" : "b");
  out.number(frame.id, is_long ? 8 : 3);
  out.number(static_cast<std::uint32_t>(code), 1);
  out.bytes(frame, size);
  out.text("\r");
  return out.length();
}

LineMeaning readSlcan(std::string_view line, CanFrame& frame) noexcept {
  if (line == "\a") return LineMeaning::kRefused;
  if (line.empty() || line == "z" || line == "Z") return LineMeaning::kAccepted;
  constexpr std::string_view kShort = "tdb", kLong = "TDB";
  const bool is_long = kLong.find(line.front()) != std::string_view::npos;
  if (!is_long && kShort.find(line.front()) == std::string_view::npos) return LineMeaning::kOther;
  const std::size_t digits = is_long ? 8 : 3;
  if (line.size() < 2 + digits) return LineMeaning::kOther;
  const int code = digit(line[1 + digits]);
  if (!readNumber(line.substr(1, digits), frame.id) || code < 0) return LineMeaning::kOther;
  if (frame.id > (is_long ? kMostLongId : kMostShortId)) return LineMeaning::kOther;
  const bool classic = line.front() == 't' || line.front() == 'T';
  const std::string_view data = line.substr(2 + digits);
  if ((classic && code > 8) || data.size() != 2U * kSizes[static_cast<std::size_t>(code)]) {
    return LineMeaning::kOther;
  }
  return readBytes(data, frame) ? LineMeaning::kFrame : LineMeaning::kOther;
}

bool LineSplitter::take(char byte) noexcept {
  if (ended_) {
    ended_ = false;
    length_ = 0;
  }
  if (byte == '\r' || byte == '\n') {
    const bool whole = !too_long_ && length_ > 0;
    if (too_long_) length_ = 0;
    too_long_ = false;
    ended_ = whole;
    return whole;
  }
  if (byte == '\a') {  // refuses whatever was begun
    length_ = 1;
    text_[0] = byte;
    too_long_ = false;
    ended_ = true;
    return true;
  }
  if (too_long_) return false;
  if (length_ == text_.size()) {
    too_long_ = true;
    ++dropped_;
    return false;
  }
  text_[length_++] = byte;
  return false;
}

}  // namespace wholehand::moteus
