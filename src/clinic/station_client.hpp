#pragma once

#include "clinic/station.hpp"

#include <cstdint>
#include <memory>
#include <string>

namespace wholehand::clinic {

/// A therapist client of the station on this machine, over WebSocket; connects again by itself.
class StationClient final : public Station {
 public:
  /// @param token the station's therapist token; empty: it needs none
  StationClient(std::uint16_t port, std::string token);
  ~StationClient() override;
  StationClient(const StationClient&) = delete;
  StationClient& operator=(const StationClient&) = delete;

  [[nodiscard]] StationScene scene() const override;
  [[nodiscard]] StationReply open(const VisitOrder& order) override;
  [[nodiscard]] StationReply close(std::uint64_t visit) override;

 private:
  class Link;
  std::unique_ptr<Link> link_;
};

}  // namespace wholehand::clinic
