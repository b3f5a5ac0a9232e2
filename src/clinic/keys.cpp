#include "clinic/keys.hpp"

#include "clinic/request.hpp"
#include "files/text/text_file.hpp"
#include "loop/core/sha256.hpp"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <new>
#include <sodium.h>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace wholehand::clinic {
namespace {

constexpr std::size_t kKey_bytes = crypto_secretbox_KEYBYTES;
constexpr std::size_t kNonce_bytes = crypto_secretbox_NONCEBYTES;
constexpr std::size_t kTag_bytes = crypto_secretbox_MACBYTES;
constexpr std::size_t kSalt_bytes = crypto_pwhash_SALTBYTES;
constexpr std::string_view kSymbols = "0123456789ABCDEFGHJKMNPQRSTVWXYZ";  // Crockford's base 32
constexpr std::size_t kRandomSymbols = 26, kCheckSymbols = 4, kGroup = 5;

void begin() {
  if (sodium_init() < 0) throw std::runtime_error("libsodium does not start");
}

const unsigned char* bytesOf(std::string_view text) {
  return reinterpret_cast<const unsigned char*>(text.data());
}
unsigned char* bytesOf(std::string& text) {
  return reinterpret_cast<unsigned char*>(text.data());
}

std::string toHex(std::string_view bytes) {
  std::string out(bytes.size() * 2 + 1, '\0');
  sodium_bin2hex(out.data(), out.size(), bytesOf(bytes), bytes.size());
  out.pop_back();
  return out;
}

std::string fromHex(const std::string& hex) {
  std::string out(hex.size() / 2, '\0');
  std::size_t got = 0;
  if (sodium_hex2bin(bytesOf(out), out.size(), hex.data(), hex.size(), nullptr, &got, nullptr) !=
      0) {
    return {};
  }
  out.resize(got);
  return out;
}

std::optional<Key> stretched(std::string_view words, std::string_view salt, std::uint64_t passes,
                             std::size_t memory_bytes) {
  constexpr std::size_t kMost_bytes = std::size_t{1} << 30U;
  if (salt.size() != kSalt_bytes || passes > 100 || memory_bytes > kMost_bytes) return {};
  std::string out(kKey_bytes, '\0');
  if (crypto_pwhash(bytesOf(out), out.size(), words.data(), words.size(), bytesOf(salt), passes,
                    memory_bytes, crypto_pwhash_ALG_ARGON2ID13) != 0) {
    throw std::bad_alloc();
  }
  Key key = Key::from(out);
  sodium_memzero(out.data(), out.size());
  return key;
}

// Check symbols: the first 20 bits of the SHA-256 of the other symbols.
std::string checkSymbols(std::string_view symbols) {
  const std::string digits = sha256(symbols).substr(0, kCheckSymbols * 2);
  std::string out;
  for (std::size_t i = 0; i < kCheckSymbols; ++i) {
    out += kSymbols[std::stoul(digits.substr(i * 2, 2), nullptr, 16) % kSymbols.size()];
  }
  return out;
}

}  // namespace

Key::Key() {
  begin();
  bytes_.reset(
      static_cast<unsigned char*>(sodium_malloc(kKey_bytes)));  // locked memory with guard pages
  if (!bytes_) throw std::bad_alloc();
}
void Key::Free::operator()(unsigned char* bytes) const {
  sodium_free(bytes);
}
Key Key::random() {
  Key key;
  randombytes_buf(key.bytes_.get(), kKey_bytes);
  return key;
}
Key Key::from(std::string_view bytes) {
  Key key;
  std::memcpy(key.bytes_.get(), bytes.data(), std::min(bytes.size(), kKey_bytes));
  return key;
}
std::string_view Key::bytes() const {
  return {reinterpret_cast<const char*>(bytes_.get()), kKey_bytes};
}

std::string Key::derived(std::string_view purpose) const {
  std::string out(kKey_bytes, '\0');
  crypto_generichash(bytesOf(out), out.size(), bytesOf(purpose), purpose.size(), bytes_.get(),
                     kKey_bytes);
  return toHex(out);
}

std::string Key::seal(std::string_view kind, std::string_view text) const {
  std::string plain(kind);
  plain += '\0';
  plain += text;
  std::string out(kNonce_bytes + kTag_bytes + plain.size(), '\0');
  randombytes_buf(out.data(), kNonce_bytes);
  crypto_secretbox_easy(bytesOf(out) + kNonce_bytes, bytesOf(plain), plain.size(), bytesOf(out),
                        bytes_.get());
  sodium_memzero(plain.data(), plain.size());
  return out;
}

std::optional<std::string> Key::open(std::string_view kind, std::string_view sealed) const {
  if (sealed.size() < kNonce_bytes + kTag_bytes) return {};
  const std::string_view box = sealed.substr(kNonce_bytes);
  std::string plain(box.size() - kTag_bytes, '\0');
  if (crypto_secretbox_open_easy(bytesOf(plain), bytesOf(box), box.size(), bytesOf(sealed),
                                 bytes_.get()) != 0) {
    return {};
  }
  if (plain.size() <= kind.size() || !plain.starts_with(kind) || plain[kind.size()] != '\0') {
    return {};
  }
  return plain.substr(kind.size() + 1);
}

namespace {

constexpr int kNoDigest = 1;  // version of files without a digest

std::string digestOf(const Json& file) {
  Json parts = file;
  parts.erase("sha256");
  return sha256(parts.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace

Expected<KeyFile> readKeyFile(const std::string& path) {
  const Diagnostic missing{path,
                           0,
                           "",
                           "",
                           "is missing: it wraps the clinic's key",
                           "copy it from beside a backup; nobody reads the database without it",
                           DiagnosticCode::kMissing};
  std::ifstream in(path, std::ios::binary);
  if (!in) return missing;
  std::stringstream text;
  text << in.rdbuf();
  const Json file = Json::parse(text.str(), nullptr, false);
  if (!file.is_object() || !file.contains("clinic") || !file["clinic"].is_string() ||
      !file.contains("phrase") || !file.contains("recovery")) {
    return fileFault(path, "is damaged", "copy it from beside a backup", DiagnosticCode::kSyntax);
  }
  // Without the digest, damage would look like a wrong pass phrase.
  if (file.value("version", Json()) != kNoDigest &&
      file.value("sha256", Json()) != digestOf(file)) {
    return fileFault(path, "is damaged: its digest does not fit", "copy it from beside a backup",
                     DiagnosticCode::kSyntax);
  }
  const Json rows = file.value("rows", Json());
  return KeyFile{file["clinic"], file["phrase"].dump(), file["recovery"].dump(),
                 rows.is_string() ? rows.get<std::string>() : std::string{}};
}

Expected<Done> writeKeyFile(const std::string& path, const KeyFile& keys) {
  Json file = {{"kind", "clinic-keys"},
               {"version", 2},
               {"clinic", keys.clinic},
               {"phrase", Json::parse(keys.by_phrase)},
               {"recovery", Json::parse(keys.by_recovery)}};
  if (!keys.rows.empty()) file["rows"] = keys.rows;
  file["sha256"] = digestOf(file);
  if (const int error = writeDurably(path, file.dump(1) + "\n"); error != 0) {
    return fileFault(path, std::string("cannot be written: ") + std::strerror(error),
                     "make room, or give another folder", DiagnosticCode::kUnreadable);
  }
  return Done{};
}

std::string wrap(const Key& key, std::string_view words, const KeyCost& cost) {
  begin();
  std::string salt(kSalt_bytes, '\0');
  randombytes_buf(salt.data(), salt.size());
  const auto by = stretched(words, salt, cost.passes, cost.memory_bytes);
  const Json out = {{"salt", toHex(salt)},
                    {"passes", cost.passes},
                    {"memory_bytes", cost.memory_bytes},
                    {"box", toHex(by->seal("key", key.bytes()))}};
  return out.dump();
}

std::optional<Key> unwrap(const std::string& wrapped, std::string_view words) {
  begin();
  const Json in = Json::parse(wrapped, nullptr, false);
  try {
    const auto by =
        stretched(words, fromHex(in.at("salt")), in.at("passes"), in.at("memory_bytes"));
    if (!by) return {};
    auto bytes = by->open("key", fromHex(in.at("box")));
    if (!bytes || bytes->size() != kKey_bytes) return {};
    Key key = Key::from(*bytes);
    sodium_memzero(bytes->data(), bytes->size());
    return key;
  } catch (const Json::exception&) {
    return {};
  }
}

std::string newRecoveryCode() {
  begin();
  std::string symbols;
  for (std::size_t i = 0; i < kRandomSymbols; ++i) {
    symbols += kSymbols[randombytes_uniform(kSymbols.size())];
  }
  symbols += checkSymbols(symbols);
  std::string out;
  for (std::size_t i = 0; i < symbols.size(); ++i) {
    if (i > 0 && i % kGroup == 0) out += '-';
    out += symbols[i];
  }
  return out;
}

std::optional<std::string> checkedRecoveryCode(std::string_view typed) {
  std::string symbols;
  for (char c : typed) {
    if (c == ' ' || c == '-') continue;
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
    if (c == 'O') c = '0';
    if (c == 'I' || c == 'L') c = '1';
    if (kSymbols.find(c) == std::string_view::npos) return {};
    symbols += c;
  }
  if (symbols.size() != kRandomSymbols + kCheckSymbols) return {};
  if (checkSymbols(symbols.substr(0, kRandomSymbols)) != symbols.substr(kRandomSymbols)) return {};
  return symbols;
}

std::string hashPin(const std::string& pin) {
  begin();
  constexpr std::size_t kMemory_bytes = std::size_t{8} << 20U;
  std::string out(crypto_pwhash_STRBYTES, '\0');
  if (crypto_pwhash_str(out.data(), pin.data(), pin.size(), 1, kMemory_bytes) != 0) {
    throw std::bad_alloc();
  }
  return out;
}

bool pinMatches(const std::string& hash, const std::string& pin) {
  begin();
  return hash.size() == crypto_pwhash_STRBYTES &&
         crypto_pwhash_str_verify(hash.c_str(), pin.data(), pin.size()) == 0;
}

std::string randomHex(std::size_t bytes) {
  begin();
  std::string out(bytes, '\0');
  randombytes_buf(out.data(), out.size());
  return toHex(out);
}

std::uint32_t randomBelow(std::uint32_t bound) {
  begin();
  return randombytes_uniform(bound);
}

}  // namespace wholehand::clinic
