#pragma once

#include <cstddef>
#include <mutex>
#include <set>
#include <string>

namespace wholehand {

/// Inputs of certificates that hold, by their fingerprints: each is computed once for the models
/// that share this. Any thread.
class PassedCertificates {
 public:
  [[nodiscard]] bool has(const std::string& input) const {
    const std::lock_guard lock(mutex_);
    return inputs_.contains(input);
  }
  void add(const std::string& input) {
    const std::lock_guard lock(mutex_);
    if (inputs_.size() < kMost) inputs_.insert(input);
  }

 private:
  static constexpr std::size_t kMost = 1000;
  mutable std::mutex mutex_;
  std::set<std::string> inputs_;
};

}  // namespace wholehand
