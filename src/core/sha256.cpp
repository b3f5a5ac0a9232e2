#include "core/sha256.hpp"

#include <array>
#include <cstddef>
#include <openssl/evp.h>
#include <stdexcept>

namespace wholehand {

std::string sha256(std::string_view bytes) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int length = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), &length, EVP_sha256(), nullptr) != 1) {
    throw std::runtime_error("OpenSSL offers no SHA-256");
  }
  constexpr std::string_view kHexadecimal = "0123456789abcdef";
  std::string out;
  for (std::size_t i = 0; i < length; ++i) {
    out += kHexadecimal[digest.at(i) >> 4U];
    out += kHexadecimal[digest.at(i) & 15U];
  }
  return out;
}

}  // namespace wholehand
