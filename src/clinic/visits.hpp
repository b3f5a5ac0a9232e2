#pragma once

#include "clinic/accounts.hpp"
#include "clinic/patients.hpp"
#include "clinic/plans.hpp"
#include "clinic/records.hpp"
#include "clinic/rows.hpp"
#include "clinic/station_client.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace wholehand::clinic {

/// Visits: opening and closing on the station, notes, moving to another patient; also recordings
/// made outside a visit. One thread at a time.
class Visits {
 public:
  Visits(Records& records, Accounts& accounts, Plans& plans, Patients& patients, Station& station)
      : records_(records),
        accounts_(accounts),
        plans_(plans),
        patients_(patients),
        station_(station) {}

  /// Compares the visit that is open on the station with the database.
  /// @return visit that the station must close; 0: none
  [[nodiscard]] std::uint64_t compareWithStation(const StationScene& scene);

  [[nodiscard]] std::int64_t openOne();  ///< number of the open visit; 0: none
  void refuseWhileAsking() const;        ///< refuses while an order to the station waits for its
                                         ///< reply

  Json begin(Call& call);
  Json beginGuest(Call& call);
  Json open(Call& call);
  Json nextItem(Call& call);
  Json finish(Call& call);
  Json note(Call& call);
  Json putNote(Call& call);
  Json pain(Call& call);
  Json move(Call& call);
  Json remove(Call& call);
  Json show(Call& call);
  Json sessions(Call& call);
  Json giveSessions(Call& call);
  Json deleteSession(Call& call);

 private:
  Json start(Call& call, std::optional<std::int64_t> patient, const std::string& side,
             const Plan& plan);
  /// The visit that the request names. While names are hidden, only the open visit is accepted.
  [[nodiscard]] VisitRow visitOf(const Call& call) { return visitFor(call, call.ids.at(0)); }
  [[nodiscard]] VisitRow visitFor(const Call& call, std::int64_t id);
  [[nodiscard]] VisitOrder orderOf(const VisitRow& visit, std::int64_t item);
  [[nodiscard]] Json inForce(const VisitOrder& order) const;
  void keepSettings(VisitRow& visit);
  void close(std::int64_t account, VisitRow visit, const std::string& state);
  [[nodiscard]] bool isDamaged(std::int64_t visit);
  Json finishDamaged(Call& call, std::int64_t visit);
  void setAside(std::int64_t account, std::int64_t visit);
  void chooseHand(VisitRow& visit);
  void fitToPerson(VisitRow& visit);
  [[nodiscard]] std::string writeLimits(const VisitRow& visit);
  void removeHandFile(const std::string& name) const;
  void refuseOtherSide(std::int64_t patient, const std::string& side);
  void refuseWhileOpen();
  void refuseWhileLost();
  void ask(Call& call, const std::function<StationReply()>& order);
  void erase(Call& call, const Erasure& erasure);

  Records& records_;
  Accounts& accounts_;
  Plans& plans_;
  Patients& patients_;
  Station& station_;
  bool asking_ = false;              ///< an order to the station waits for its reply
  std::int64_t apart_since_us_ = 0;  ///< steady clock: time since which station and database
                                     ///< differ; 0: they agree
};

}  // namespace wholehand::clinic
