#include "model/toml/toml_bounds.hpp"

#include <algorithm>

namespace wholehand {
namespace {

// The largest file of the project has 140 keys; a scene of 1,024 bodies has some 7,000.
constexpr int kMostKeys = 12000, kMostTables = 1200, kMostInlineTables = 12000, kMostLevels = 32;

/// Scans TOML for brackets, dots and keys only; skips quoted text and comments (toml.io, v1.0.0).
class Counter {
 public:
  explicit Counter(std::string_view text) : text_(text) {}

  /// Continues until a bound is exceeded. False at the end.
  bool findBeyond() {
    while (at_ < text_.size()) {
      take(text_[at_]);
      if (problem_ != nullptr) return true;
      ++at_;
    }
    return false;
  }
  [[nodiscard]] int line() const { return line_; }
  [[nodiscard]] const char* problem() const { return problem_; }

 private:
  void take(char c) {
    switch (c) {
      case '"':
      case '\'':
        skipQuoted(c);
        break;
      case '#':
        at_ = std::min(text_.find('\n', at_), text_.size()) - 1;
        break;
      case '\n':
        ++line_;
        dots_ = 0;
        line_is_empty_ = true;
        return;
      case '{':
        if (++inline_tables_ > kMostInlineTables) problem_ = "has more than 12000 inline tables";
        [[fallthrough]];
      case '[':
        open();
        break;
      case ']':
      case '}':
        depth_ = std::max(0, depth_ - 1);
        break;
      case '.':
        if (++dots_ > kMostLevels) problem_ = "has a key of more than 32 parts";
        break;
      case '=':
        dots_ = 0;
        if (++keys_ > kMostKeys) problem_ = "has more than 12000 keys";
        break;
      case ',':
        dots_ = 0;
        break;
      default:
        break;
    }
    if (c != ' ' && c != '\t' && c != '\r') line_is_empty_ = false;
  }
  void open() {
    if (line_is_empty_ && depth_ == 0 && ++tables_ > kMostTables) {
      problem_ = "has more than 1200 tables";
    }
    if (++depth_ > kMostLevels) problem_ = "has more than 32 nested levels";
  }
  // Ends at the closing quote.
  void skipQuoted(char quote) {
    const std::string_view three(quote == '"' ? "\"\"\"" : "'''");
    const bool many_lines = text_.substr(at_, 3) == three;
    at_ += many_lines ? 3 : 1;
    for (; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (c == '\n') {
        ++line_;
        if (!many_lines) return;  // the parser will report the error
      }
      if (c == '\\' && quote == '"') {
        ++at_;
      } else if (c == quote && (!many_lines || text_.substr(at_, 3) == three)) {
        if (!many_lines) return;
        at_ += 2;
        // One or two more quotes belong to the text before the closing ones.
        for (int more = 0; more < 2 && text_.substr(at_ + 1, 1) == three.substr(0, 1); ++more)
          ++at_;
        return;
      }
    }
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1, depth_ = 0, dots_ = 0, keys_ = 0, tables_ = 0, inline_tables_ = 0;
  bool line_is_empty_ = true;
  const char* problem_ = nullptr;
};

}  // namespace

std::optional<Diagnostic> beyondBounds(std::string_view toml, const std::string& path) {
  Counter counter(toml);
  if (!counter.findBeyond()) return std::nullopt;
  return Diagnostic{path,
                    counter.line(),
                    "",
                    "",
                    counter.problem(),
                    "name a configuration file",
                    DiagnosticCode::kRange};
}

}  // namespace wholehand
