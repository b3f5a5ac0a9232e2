#pragma once

#include <string>
#include <string_view>

struct evp_md_ctx_st;

namespace wholehand {

/// SHA-256 (FIPS 180-4, by OpenSSL) of bytes that come in pieces.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;

  void add(std::string_view bytes);
  /// 64 hexadecimal digits. Once, after the last piece.
  [[nodiscard]] std::string digits();

 private:
  evp_md_ctx_st* context_;
};

/// Of one piece.
[[nodiscard]] std::string sha256(std::string_view bytes);

}  // namespace wholehand
