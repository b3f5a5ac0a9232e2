#pragma once

#include "loop/core/expected.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace wholehand::clinic {

/// Cost of argon2id, for everything that is derived from words.
struct KeyCost {
  std::uint64_t passes = 3;
  std::size_t memory_bytes = std::size_t{64} << 20U;
};

/// The clinic's key: 32 random bytes in locked memory, wiped at the end. Every name, birth date,
/// number, note and warning is sealed under it (XSalsa20-Poly1305). Any thread, one at a time.
class Key {
 public:
  [[nodiscard]] static Key random();
  /// @pre bytes.size() == 32
  [[nodiscard]] static Key from(std::string_view bytes);

  /// @param kind what is sealed ("patient"): text of one kind does not open as another
  [[nodiscard]] std::string seal(std::string_view kind, std::string_view text) const;
  /// Empty when it is not of this key and kind, or damaged.
  [[nodiscard]] std::optional<std::string> open(std::string_view kind,
                                                std::string_view sealed) const;
  [[nodiscard]] std::string_view bytes() const;
  /// Another key, for one purpose: 64 hexadecimal digits that say nothing of this one.
  [[nodiscard]] std::string derived(std::string_view purpose) const;

 private:
  Key();
  struct Free {
    void operator()(unsigned char* bytes) const;
  };
  std::unique_ptr<unsigned char, Free> bytes_;
};

/// The file `keys`: the clinic's key, wrapped by the pass phrase and by the recovery code.
struct KeyFile {
  std::string clinic;                  ///< id of the clinic that it belongs to
  std::string by_phrase, by_recovery;  ///< JSON: salt, cost, box
};
[[nodiscard]] Expected<KeyFile> readKeyFile(const std::string& path);
[[nodiscard]] Expected<Done> writeKeyFile(const std::string& path, const KeyFile& keys);

[[nodiscard]] std::string wrap(const Key& key, std::string_view words, const KeyCost& cost);
/// Empty: other words, or damaged.
[[nodiscard]] std::optional<Key> unwrap(const std::string& wrapped, std::string_view words);

/// 128 random bits and 20 bits that find a typing mistake: six groups of five characters.
[[nodiscard]] std::string newRecoveryCode();
/// The code as it was printed; empty when it was mistyped. Case, spaces, hyphens, O for 0 and I or
/// L for 1 do not matter.
[[nodiscard]] std::optional<std::string> checkedRecoveryCode(std::string_view typed);

/// A PIN's hash; cheap, as there are only 10,000 to try: what guards a PIN is the count of tries.
[[nodiscard]] std::string hashPin(const std::string& pin);
[[nodiscard]] bool pinMatches(const std::string& hash, const std::string& pin);

/// Hexadecimal digits of so many random bytes.
[[nodiscard]] std::string randomHex(std::size_t bytes);
/// Uniform below a bound.
[[nodiscard]] std::uint32_t randomBelow(std::uint32_t bound);

}  // namespace wholehand::clinic
