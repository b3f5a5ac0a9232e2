#pragma once

#include <string>
#include <string_view>

struct evp_md_ctx_st;

namespace wholehand {

/// SHA-256 (FIPS 180-4, computed by OpenSSL) of bytes that are added piece by piece.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;

  void add(std::string_view bytes);
  /// The hash as 64 hexadecimal digits. Call once, after the last piece.
  [[nodiscard]] std::string digits();

 private:
  evp_md_ctx_st* context_;
};

/// SHA-256 of one piece, as 64 hexadecimal digits.
[[nodiscard]] std::string sha256(std::string_view bytes);

}  // namespace wholehand
