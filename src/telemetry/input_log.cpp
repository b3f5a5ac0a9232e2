#include "telemetry/input_log.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace wholehand {
namespace {

// Fields after the first byte of a tick, in this order.
enum : unsigned {
  kElapsed = 1U,   // elapsed_periods, if not 1
  kFaults = 2U,    // of kInputFaults
  kCommands = 4U,  // their number, then the commands
  kRaw = 8U,       // a bit for each axis that is not at a whole count
  kMoved = 16U,    // per axis: eight bytes, or the change in counts
  kMover = 32U     // who moves and by whose help, if it is another than before
};

/// Beyond it, not every integer is a double.
constexpr double kMostCounts = 4503599627370496.0;  // 2^52

std::uint64_t zigzag(std::int64_t n) noexcept {
  return static_cast<std::uint64_t>(n) << 1U ^ static_cast<std::uint64_t>(n >> 63);
}
std::int64_t zagzig(std::uint64_t n) noexcept {
  return static_cast<std::int64_t>(n >> 1U) ^ -static_cast<std::int64_t>(n & 1U);
}

// Appends to bytes that have room.
class Out {
 public:
  explicit Out(std::byte* at) noexcept : at_(at) {}
  void number(std::uint64_t n) noexcept {
    for (; n >= 0x80; n >>= 7U) *at_++ = static_cast<std::byte>(n | 0x80U);
    *at_++ = static_cast<std::byte>(n);
  }
  void real(double value) noexcept {
    std::memcpy(at_, &value, sizeof value);
    at_ += sizeof value;
  }
  [[nodiscard]] std::byte* at() const noexcept { return at_; }

 private:
  std::byte* at_;
};

// Takes from bytes that may be damaged.
class In {
 public:
  In(const std::byte* at, std::size_t bytes) noexcept : at_(at), end_(at + bytes) {}
  std::uint64_t number() noexcept {
    std::uint64_t n = 0;
    for (unsigned shift = 0; shift < 64; shift += 7) {
      if (at_ == end_) break;
      const auto b = std::to_integer<std::uint64_t>(*at_++);
      n |= (b & 0x7FU) << shift;
      if (b < 0x80) return n;
    }
    ok_ = false;
    return 0;
  }
  double real() noexcept {
    double value = 0.0;
    if (end_ - at_ < static_cast<std::ptrdiff_t>(sizeof value)) {
      ok_ = false;
      at_ = end_;
      return value;
    }
    std::memcpy(&value, at_, sizeof value);
    at_ += sizeof value;
    return value;
  }
  std::int32_t small() noexcept { return static_cast<std::int32_t>(zagzig(number())); }
  /// A number of at most `most`.
  std::uint64_t upTo(std::uint64_t most) noexcept {
    const std::uint64_t n = number();
    ok_ = ok_ && n <= most;
    return ok_ ? n : 0;
  }
  [[nodiscard]] const std::byte* at() const noexcept { return at_; }
  [[nodiscard]] bool ok() const noexcept { return ok_; }

 private:
  const std::byte* at_;
  const std::byte* end_;
  bool ok_ = true;
};

double atCounts(std::int64_t counts, double step) noexcept {
  return step * static_cast<double>(counts);
}

/// True when the position is exactly a whole number of counts.
bool inCounts(double q, double step, std::int64_t& counts) noexcept {
  if (!(step > 0.0)) return false;
  const double n = std::round(q / step);
  if (!(std::abs(n) < kMostCounts)) return false;
  counts = static_cast<std::int64_t>(n);
  return std::bit_cast<std::uint64_t>(atCounts(counts, step)) == std::bit_cast<std::uint64_t>(q);
}

/// Numbers of an order without the zeros at their end.
int usedNumbers(const Command& c) noexcept {
  int used = kOrderNumbers;
  while (used > 0 && std::bit_cast<std::uint64_t>(c.numbers[used - 1]) == 0) --used;
  return used;
}

void logCommands(const TickRecord& record, Out& out) noexcept {
  const int count = std::min(record.command_count, kMaxCommands);
  out.number(static_cast<std::uint64_t>(count));
  for (int i = 0; i < count; ++i) {
    const Command& c = record.commands[i];
    out.number(zigzag(static_cast<std::int64_t>(c.type)));
    out.number(zigzag(c.index));
    out.real(c.value);
    out.number(static_cast<std::uint64_t>(c.aim.size()));
    for (double q : c.aim) out.real(q);
    if (!isBodyOrder(c.type)) continue;
    const int used = usedNumbers(c);
    out.number(static_cast<std::uint64_t>(used));
    for (int n = 0; n < used; ++n) out.real(c.numbers[n]);
  }
}

void readCommands(In& in, TickInput& input) {
  input.command_count = static_cast<std::int32_t>(in.upTo(kMaxCommands));
  for (int i = 0; i < input.command_count; ++i) {
    Command& c = input.commands[i];
    c.type = static_cast<CommandType>(in.small());
    c.index = in.small();
    c.value = in.real();
    c.aim = AxisPosition(static_cast<int>(in.upTo(kMaxAxes)));
    for (int a = 0; a < c.aim.size(); ++a) c.aim[a] = in.real();
    if (!isBodyOrder(c.type)) continue;
    const auto used = static_cast<int>(in.upTo(kOrderNumbers));
    for (int n = 0; n < used; ++n) c.numbers[n] = in.real();
  }
}

/// Which axes moved, by how many counts, and which are not at a whole count.
struct Motion {
  std::array<std::int64_t, kMaxAxes> delta{};
  std::uint32_t raw = 0;
  bool moved = false;
};

Motion motionOf(InputLogState& state, const AxisPosition& q_m) noexcept {
  Motion m;
  for (int i = 0; i < state.encoder_step.size(); ++i) {
    std::int64_t counts = 0;
    if (!inCounts(q_m[i], state.encoder_step[i], counts)) {
      m.raw |= 1U << static_cast<unsigned>(i);
      continue;
    }
    m.delta[i] = counts - state.counts[i];
    m.moved = m.moved || m.delta[i] != 0;
    state.counts[i] = counts;
  }
  m.moved = m.moved || m.raw != 0;
  return m;
}

}  // namespace

InputLogState inputLogOf(const RecordingMeta& meta) {
  InputLogState state;
  state.encoder_step = AxisPosition(static_cast<int>(meta.encoder_step.size()));
  std::copy(meta.encoder_step.begin(), meta.encoder_step.end(), state.encoder_step.data());
  return state;
}

std::size_t logInput(InputLogState& state, const TickRecord& record, std::byte* out) noexcept {
  const Motion motion = motionOf(state, record.q_m);
  const Fault faults = record.faults & kInputFaults;
  unsigned what = 0;
  if (record.elapsed_periods != 1) what |= kElapsed;
  if (any(faults)) what |= kFaults;
  if (record.command_count > 0) what |= kCommands;
  if (motion.raw != 0) what |= kRaw;
  if (motion.moved) what |= kMoved;
  if (record.moved_by != state.moved_by || record.help != state.help) what |= kMover;
  Out to(out);
  to.number(what);
  if ((what & kElapsed) != 0) to.number(record.elapsed_periods);
  if ((what & kFaults) != 0) to.number(static_cast<std::uint64_t>(faults));
  if ((what & kMover) != 0) {
    state.moved_by = record.moved_by;
    state.help = record.help;
    to.number(static_cast<std::uint64_t>(state.moved_by));
    to.number(static_cast<std::uint64_t>(state.help));
  }
  if ((what & kCommands) != 0) logCommands(record, to);
  if ((what & kRaw) != 0) to.number(motion.raw);
  if (motion.moved) {
    for (int i = 0; i < state.encoder_step.size(); ++i) {
      if ((motion.raw >> static_cast<unsigned>(i) & 1U) != 0) {
        to.real(record.q_m[i]);
      } else {
        to.number(zigzag(motion.delta[i]));
      }
    }
  }
  return to.at() - out;
}

std::size_t readInput(InputLogState& state, const std::byte* in, std::size_t bytes,
                      TickInput& input) {
  In from(in, bytes);
  input = TickInput{};
  const std::uint64_t what = from.upTo(kElapsed | kFaults | kCommands | kRaw | kMoved | kMover);
  if ((what & kElapsed) != 0) {
    input.elapsed_periods = static_cast<std::uint32_t>(from.upTo(UINT32_MAX));
  }
  if ((what & kFaults) != 0)
    input.faults = static_cast<Fault>(from.upTo(UINT32_MAX)) & kInputFaults;
  if ((what & kMover) != 0) {
    state.moved_by = static_cast<Mover>(from.upTo(kMovers - 1));
    state.help = static_cast<Help>(from.upTo(kHelps - 1));
  }
  input.moved_by = state.moved_by;
  input.help = state.help;
  if ((what & kCommands) != 0) readCommands(from, input);
  const std::uint64_t raw = (what & kRaw) != 0 ? from.upTo(UINT32_MAX) : 0;
  input.q_m = AxisPosition(state.encoder_step.size());
  for (int i = 0; i < input.q_m.size(); ++i) {
    std::int64_t& counts = state.counts[i];
    if ((raw >> static_cast<unsigned>(i) & 1U) != 0) {
      input.q_m[i] = from.real();
      continue;
    }
    if ((what & kMoved) != 0) {  // unsigned arithmetic: damaged counts may overflow
      counts = static_cast<std::int64_t>(static_cast<std::uint64_t>(counts) +
                                         static_cast<std::uint64_t>(zagzig(from.number())));
    }
    input.q_m[i] = atCounts(counts, state.encoder_step[i]);
  }
  return from.ok() ? from.at() - in : 0;
}

}  // namespace wholehand
