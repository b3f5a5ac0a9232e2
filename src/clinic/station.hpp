#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>

namespace wholehand::clinic {

/// What the station says of itself.
struct StationScene {
  bool heard = false;  ///< connected, and a scene came
  std::uint64_t visit = 0;
  std::uint32_t item = 0;
  std::string exercise;
  int level = 0;
  std::string recording;                                ///< being written; empty: none
  std::map<std::string, std::array<double, 2>> bounds;  ///< of live parameters, in their own unit
  std::map<std::string, double> initial;                ///< what one has that nobody has set
  std::map<std::string, double> values;                 ///< present ones; empty: none came yet
  std::string help;                                     ///< as in VisitOrder; empty: unsaid
};

/// OpenVisit of protocol/wholehand.fbs.
struct VisitOrder {
  std::uint64_t visit = 0;
  std::uint32_t item = 0;
  std::string exercise;
  int level = 1;
  std::string hand, hand_file;
  std::string help;  ///< "full", "some", "none"
  std::map<std::string, double> parameters;
};

struct StationReply {
  enum class What { kAccepted, kRefused, kSilent };
  What what = What::kSilent;
  std::string why;  ///< for a person, in English
};

/// The station that renders. Any thread; open() and close() wait for the reply, 5 s at most, or 20
/// s while the hand is rehearsed.
class Station {
 public:
  virtual ~Station() = default;
  [[nodiscard]] virtual StationScene scene() const = 0;
  [[nodiscard]] virtual StationReply open(const VisitOrder& order) = 0;
  [[nodiscard]] virtual StationReply close(std::uint64_t visit) = 0;
};

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
