#pragma once

#include "server/backend.hpp"
#include "telemetry/recording.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace wholehand {

/// Bodies of a game in a recording, as reported to live clients: for each change the row
/// (uint32), the length (uint32) and a message with GameBodies. Empty for scenes that take none;
/// at most 20,000 changes. Ticks that cannot be read are passed over.
[[nodiscard]] std::string gameBodiesOf(RecordingReader& recording);

/// The same for a page that shows some rows only: at those rows.
class SampledBodies {
 public:
  explicit SampledBodies(const RecordingMeta& meta);
  ~SampledBodies();
  SampledBodies(const SampledBodies&) = delete;
  SampledBodies& operator=(const SampledBodies&) = delete;

  void see(const TickRecord& record);  ///< every tick that can be read, in order
  void keep(std::uint64_t row);        ///< of the tick that was seen last
  /// @param rows ascending; those that were not kept show the bodies of the row before
  /// @param step only every n-th of them, and the last: fewer bytes, and bodies come and go later
  [[nodiscard]] std::string at(const std::vector<std::uint64_t>& rows, std::size_t step) const;

 private:
  class Follower;
  friend std::string gameBodiesOf(RecordingReader& recording);
  struct Change {
    std::uint64_t row;
    std::shared_ptr<const GameBodies> bodies;
  };
  std::unique_ptr<Follower> follower_;  ///< null: the scene takes no bodies
  std::vector<Change> changes_;
};

}  // namespace wholehand
