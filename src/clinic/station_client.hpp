#pragma once

#include "vocabulary/person_limits.hpp"

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>

namespace wholehand::clinic {

/// State of the station as it reports it.
struct StationScene {
  bool received = false;  ///< connected, and a scene has arrived
  std::uint64_t visit = 0;
  std::uint32_t item = 0;
  std::string exercise;
  int level = 0;
  std::string recording;                                ///< recording in progress; empty: none
  std::map<std::string, std::array<double, 2>> bounds;  ///< of live parameters, in their own unit
  std::map<std::string, double> initial;                ///< values of parameters that nobody has
                                                        ///< set
  std::map<std::string, double> values;                 ///< present values; empty: none received
                                                        ///< yet
  PersonLimits limits;                                  ///< those of the values that bound efforts
  std::string help;                                     ///< as in VisitOrder; empty: not reported
};

/// The order OpenVisit of protocol/wholehand.fbs.
struct VisitOrder {
  std::uint64_t visit = 0;
  std::uint32_t item = 0;
  std::string exercise;
  int level = 1;
  std::string hand, hand_file;
  std::string help;  ///< "full", "some", "none"
  std::map<std::string, double> parameters;
  std::string prescription_file = {};
};

struct StationReply {
  enum class Status { kAccepted, kRefused, kSilent };
  Status what = Status::kSilent;
  std::string why;  ///< reason in English, for a person
};

/// The station that renders. Any thread. open() and close() wait for the reply: at most 5 s, or 20
/// s while the hand is rehearsed.
class Station {
 public:
  virtual ~Station() = default;
  [[nodiscard]] virtual StationScene scene() const = 0;
  [[nodiscard]] virtual StationReply open(const VisitOrder& order) = 0;
  [[nodiscard]] virtual StationReply close(std::uint64_t visit) = 0;
};

/// Where no station is needed.
class NoStation final : public Station {
 public:
  [[nodiscard]] StationScene scene() const override { return {}; }
  [[nodiscard]] StationReply open(const VisitOrder&) override { return {}; }
  [[nodiscard]] StationReply close(std::uint64_t) override { return {}; }
};

/// A therapist client of the station on this machine, over WebSocket. It reconnects by itself.
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
