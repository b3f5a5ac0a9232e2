#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace wholehand {

/// The kind of a fault, for programs and tests. The texts of a Diagnostic are for people and may
/// change.
enum class DiagnosticCode : std::uint8_t {
  kInvalid,     ///< breaks a rule that no other code covers
  kMissing,     ///< a key, a file or a part of it is not there
  kUnknown,     ///< a key or a name that the program does not know
  kType,        ///< another type, kind or shape of value is expected
  kRange,       ///< a number outside of its range, or not finite
  kSyntax,      ///< not valid in the file's format (TOML, CSV, ...)
  kUnreadable,  ///< the file cannot be opened, or is damaged
  kVersion,     ///< the file has a version that the program cannot read
};

/// One fault of one file or of the command line, with a remedy.
struct Diagnostic {
  std::string file;     ///< path as given by the user; empty when no file is concerned
  int line = 0;         ///< 1-based; 0 when unknown
  std::string key;      ///< e.g. "axes[2].effort_limit_n"; empty when no key is concerned
  std::string value;    ///< the value found; empty when there is none
  std::string problem;  ///< what is wrong: "is not finite"
  std::string remedy;   ///< allowed range or what to do: "must be in [0.1, 50] N"
  DiagnosticCode code = DiagnosticCode::kInvalid;
};
using Diagnostics = std::vector<Diagnostic>;

/// A fault of a whole file, or of the command line when `file` is empty.
[[nodiscard]] inline Diagnostic fileFault(std::string file, std::string problem, std::string remedy,
                                          DiagnosticCode code = DiagnosticCode::kInvalid) {
  return {std::move(file), 0, {}, {}, std::move(problem), std::move(remedy), code};
}
/// A fault of a key or an option.
[[nodiscard]] inline Diagnostic keyFault(std::string file, std::string key, std::string value,
                                         std::string problem, std::string remedy,
                                         DiagnosticCode code = DiagnosticCode::kInvalid) {
  Diagnostic fault = fileFault(std::move(file), std::move(problem), std::move(remedy), code);
  fault.key = std::move(key);
  fault.value = std::move(value);
  return fault;
}

/// One line of text:
///   "config/devices/a.toml:12: axes[2].effort_limit_n = nan: is not finite; must be in (0, 1000]
///   N".
[[nodiscard]] std::string format(const Diagnostic& d);
/// One line per diagnostic.
[[nodiscard]] std::string format(const Diagnostics& ds);

/// The first faults of a file (at most 20). If there are more, one last diagnostic says how many.
[[nodiscard]] Diagnostics firstFaults(Diagnostics faults, const std::string& path);

/// A value, or every reason why there is none. Not real-time safe.
template <class T>
class [[nodiscard]] Expected {
 public:
  Expected(T value) : state_(std::in_place_index<0>, std::move(value)) {}
  Expected(Diagnostics errors) : state_(std::in_place_index<1>, std::move(errors)) {}
  Expected(Diagnostic error) : state_(std::in_place_index<1>, Diagnostics{std::move(error)}) {}

  [[nodiscard]] bool ok() const noexcept { return state_.index() == 0; }
  explicit operator bool() const noexcept { return ok(); }
  [[nodiscard]] T& value() & { return std::get<0>(state_); }
  [[nodiscard]] const T& value() const& { return std::get<0>(state_); }
  [[nodiscard]] T&& value() && { return std::get<0>(std::move(state_)); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  [[nodiscard]] const Diagnostics& errors() const { return std::get<1>(state_); }

 private:
  std::variant<T, Diagnostics> state_;
};

/// The value of an operation that can fail but returns nothing.
struct Done {};

}  // namespace wholehand
