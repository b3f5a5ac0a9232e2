#pragma once

#include "loop/core/expected.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace wholehand::clinic {

/// Cost of argon2id, for all keys derived from a pass phrase or a recovery code.
struct KeyCost {
  std::uint64_t passes = 3;
  std::size_t memory_bytes = std::size_t{64} << 20U;
};

/// The clinic's key: 32 random bytes in locked memory, wiped on destruction. Every name, birth
/// date, number, note and warning is encrypted under it (XSalsa20-Poly1305). Any thread, one at a
/// time.
class Key {
 public:
  [[nodiscard]] static Key random();
  /// @pre bytes.size() == 32
  [[nodiscard]] static Key from(std::string_view bytes);

  /// Encrypts a text.
  /// @param kind type of the text ("patient"): a text of one kind cannot be opened as another
  [[nodiscard]] std::string seal(std::string_view kind, std::string_view text) const;
  /// Decrypts a text; empty when the key or kind differs, or the data are damaged.
  [[nodiscard]] std::optional<std::string> open(std::string_view kind,
                                                std::string_view sealed) const;
  [[nodiscard]] std::string_view bytes() const;
  /// A derived key for one purpose: 64 hexadecimal digits that reveal nothing about this key.
  [[nodiscard]] std::string derived(std::string_view purpose) const;

 private:
  Key();
  struct Free {
    void operator()(unsigned char* bytes) const;
  };
  std::unique_ptr<unsigned char, Free> bytes_;
};

/// The file `keys`: the clinic's key, encrypted under the pass phrase and under the recovery code.
struct KeyFile {
  std::string clinic;                  ///< id of the clinic that the key belongs to
  std::string by_phrase, by_recovery;  ///< JSON with the keys salt, cost, box
  std::string rows;  ///< key of the rows' digests (row_digests.hpp), derived from the clinic's; not
                     ///< wrapped, so that programs without the pass phrase keep digests right;
                     ///< empty: of an earlier version
};
[[nodiscard]] Expected<KeyFile> readKeyFile(const std::string& path);
[[nodiscard]] Expected<Done> writeKeyFile(const std::string& path, const KeyFile& keys);

[[nodiscard]] std::string wrap(const Key& key, std::string_view words, const KeyCost& cost);
/// Decrypts the clinic's key; empty when the words are wrong or the data are damaged.
[[nodiscard]] std::optional<Key> unwrap(const std::string& wrapped, std::string_view words);

/// A new recovery code: 128 random bits and 20 check bits that detect a typing error, as six groups
/// of five characters.
[[nodiscard]] std::string newRecoveryCode();
/// The code in its printed form; empty when it was mistyped. Case, spaces, hyphens, O for 0 and I
/// or L for 1 do not matter.
[[nodiscard]] std::optional<std::string> checkedRecoveryCode(std::string_view typed);

/// Hash of a PIN. The hash is cheap, because there are only 10,000 PINs to try; the limit of failed
/// tries protects a PIN.
[[nodiscard]] std::string hashPin(const std::string& pin);
[[nodiscard]] bool pinMatches(const std::string& hash, const std::string& pin);

/// Random bytes as hexadecimal digits.
/// @param bytes number of random bytes
[[nodiscard]] std::string randomHex(std::size_t bytes);
/// Uniformly distributed random number below a bound.
[[nodiscard]] std::uint32_t randomBelow(std::uint32_t bound);

}  // namespace wholehand::clinic
