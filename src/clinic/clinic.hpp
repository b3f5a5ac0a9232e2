#pragma once

#include "clinic/clock.hpp"
#include "clinic/database.hpp"
#include "clinic/keys.hpp"
#include "clinic/presets/presets.hpp"
#include "clinic/station.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

/// A clinic's patients, visits and results (docs/clinic.md).
namespace wholehand::clinic {

using Json = nlohmann::json;

/// Why a request changes nothing; thrown inside of the clinic, answered as JSON. `code` is a stable
/// word that the pages know.
struct Refused {
  int status = 400;
  std::string code, why, field;
  Json more = Json::object();  ///< further keys of the answer
};

[[nodiscard]] inline Refused badValue(std::string field, std::string why) {
  return {400, "bad_value", std::move(why), std::move(field)};
}
[[nodiscard]] inline Refused notFound(std::string what) {
  return {404, "not_found", std::move(what), {}};
}

struct ClinicOptions {
  std::string folder;      ///< of clinic.db, keys, erased, hands/
  std::string config;      ///< the shipped config/
  std::string recordings;  ///< empty: none are looked at
  std::string backups;     ///< a backup a day goes here; empty: none
  KeyCost cost;
};

struct Request {
  std::string method;  ///< "GET", "POST", "PUT", "DELETE"
  std::string path;    ///< "/api/patients/3", decoded
  std::string find;    ///< query's `find`, decoded
  std::string token;   ///< of the session; empty: none
  std::string key;     ///< Idempotency-Key
  std::string body;
};

struct Answer {
  int status = 200;
  std::string type = "application/json";
  std::string file;  ///< name under which a browser saves it; empty: it shows it
  std::string body;
};

/// Measures one recording: the JSON of `wholehand measures`, or empty with the reason.
using Measure = std::function<std::optional<Json>(const std::string& path, std::string& why)>;

/// Answers requests, one at a time but for those that wait for the station. Every answered change
/// is on the disk. Any thread. What fails is answered by name; nothing ends the process.
class Clinic {
 public:
  Clinic(ClinicOptions options, const Clock& clock, Station& station);
  ~Clinic();

  [[nodiscard]] Answer answer(const Request& request);

  /// Compares what the station has open with the database; call every second.
  void lookAtStation();
  /// Measures recordings that the database does not know as they are; call every few seconds. Stops
  /// early when `stop` returns true.
  void lookAtRecordings(const Measure& measure, const std::function<bool()>& stop);
  /// Makes a backup when the last one is a day old, and removes those of 30 days; frees what was
  /// erased and is not freed yet. Call every minute.
  void backUpIfDue();

 private:
  struct Session {
    std::int64_t account = 0;
    std::int64_t last_us = 0;  ///< steady clock
    bool hidden = false;
    std::int64_t opened_patient = 0;  ///< last one in the log
  };
  struct Tries {
    int failed = 0;
    std::int64_t wait_until_us = 0;  ///< steady clock
  };
  struct SeenFile {
    std::int64_t size = 0, modified_ns = 0;
    std::int64_t due_us = 0;  ///< steady clock: it is measured from then on
    int failed = 0;           ///< times, as it is
    bool known = false;       ///< the database has it as it is
  };
  using Lock = std::unique_lock<std::mutex>;
  struct Call {
    const Request& request;
    Lock& lock;
    Json body = Json::object();
    std::vector<std::int64_t> ids = {};  ///< numbers of the path
    Session session = {};
    std::string session_id = {};
    Answer answer = {};
    std::optional<Transaction> transaction = {};
    std::vector<std::function<void()>> after = {};  ///< once all is committed
  };
  enum class Access { kAnyone, kSigned, kShown };
  enum class Kind { kRead, kWrite, kStation, kSession };
  struct Route {
    const char* method;
    const char* path;
    Access access;
    Kind kind;
    Json (Clinic::*handler)(Call&);
  };
  static const std::vector<Route>& routes();

  // clinic.cpp: requests, sessions, keys
  void open();
  void closeLost();
  void route(Call& call);
  void admit(Call& call, Access access);
  void perform(Call& call, const Route& route);
  Json state(Call& call);
  Json init(Call& call);
  Json unlock(Call& call);
  Json lockClinic(Call& call);
  Json signIn(Call& call);
  Json signOut(Call& call);
  Json addAccount(Call& call);
  Json hide(Call& call);
  Json show(Call& call);
  Json tile(Call& call);
  std::int64_t insertAccount(const Json& tile, const std::string& prefix);
  /// Seals what an account's browser keeps; nobody else is given it.
  [[nodiscard]] std::string browserKey(std::int64_t account) const;
  [[nodiscard]] Json sessionOf(std::int64_t account);
  std::string newSession(std::int64_t account);
  void checkPin(std::int64_t account, const Json& body);
  void refuseWhileWaiting(const Tries& tries) const;
  void countFailure(Tries& tries) const;
  [[nodiscard]] std::string seal(std::string_view kind, std::string_view text) const;
  [[nodiscard]] std::string unseal(std::string_view kind, std::string_view sealed) const;
  void log(std::int64_t account, const std::string& what, std::int64_t patient = 0,
           std::int64_t visit = 0, const std::string& detail = {});
  /// Writes the log where it can: a full disk keeps nobody from reading.
  bool tryToLog(std::int64_t account, const std::string& what, std::int64_t patient = 0);
  void tryToCompact();
  void begin(Call& call) { call.transaction.emplace(*db_); }

  // Patients.
  struct PatientData;
  Json presets(Call& call);
  Json patients(Call& call);
  Json proposeCode(Call& call);
  Json addPatient(Call& call);
  Json changePatient(Call& call);
  Json patient(Call& call);
  Json deletePatient(Call& call);
  Json mergePatients(Call& call);
  Json erasePatient(Call& call);
  Json noShow(Call& call);
  Json notePatient(Call& call);
  Json exportPatient(Call& call);
  Json exportAll(Call& call);
  [[nodiscard]] PatientData readPatient(const Json& body) const;
  [[nodiscard]] Json patientJson(std::int64_t id);
  [[nodiscard]] Json patientRows(std::string_view find, std::int64_t only);
  [[nodiscard]] Json notesOf(const char* column, std::int64_t id, bool hidden);
  [[nodiscard]] std::int64_t takeVisitNumber();
  void logOpened(const Call& call, std::int64_t patient);
  void checkPatient(std::int64_t id);
  void checkNoOpenVisit(std::int64_t patient);

  // Visits.
  struct VisitRow;
  Json beginVisit(Call& call);
  Json beginGuestVisit(Call& call);
  Json openVisit(Call& call);
  Json nextItem(Call& call);
  Json finishVisit(Call& call);
  Json noteVisit(Call& call);
  Json pain(Call& call);
  Json moveVisit(Call& call);
  Json deleteVisit(Call& call);
  Json visit(Call& call);
  Json putNote(Call& call);
  Json sessions(Call& call);
  Json giveSessions(Call& call);
  Json deleteSession(Call& call);
  Json startVisit(Call& call, std::optional<std::int64_t> patient, const std::string& side,
                  const Plan& plan);
  [[nodiscard]] VisitRow visitRow(std::int64_t id);
  [[nodiscard]] VisitRow visitOf(const Call& call);
  [[nodiscard]] VisitRow visitFor(const Call& call, std::int64_t id);
  [[nodiscard]] Json visitJson(std::int64_t id, bool hidden);
  [[nodiscard]] static Json trialsIn(Statement rows, const Plan& plan);
  [[nodiscard]] Json trialsOf(std::int64_t visit, const Plan& plan);
  [[nodiscard]] VisitOrder orderOf(const VisitRow& visit, std::int64_t item);
  [[nodiscard]] Parameters limitsOf(const std::optional<std::int64_t>& patient,
                                    const Json& changed = Json::object());
  [[nodiscard]] Json inForce(const VisitOrder& order) const;
  void keepSettings(VisitRow& visit);
  void closeVisit(std::int64_t account, VisitRow visit, const std::string& state);
  void takeBackSettings(const VisitRow& visit);
  void chooseHand(VisitRow& visit);
  void refuseWhileOpen();
  void ask(Call& call, const std::function<StationReply()>& order);
  [[nodiscard]] Plan readPlan(const Json& items, const std::string& field,
                              const Parameters& limits) const;
  [[nodiscard]] Parameters readParameters(const Json& values, const std::string& field) const;
  void insertNote(Call& call, std::optional<std::int64_t> patient,
                  std::optional<std::int64_t> visit, std::optional<std::int64_t> id = {});
  std::int64_t insertVisit(std::int64_t patient, std::int64_t account, const std::string& side,
                           std::int64_t began_us, std::int64_t ended_us, const std::string& state);
  /// Removes recordings once the change is committed; those that are left stand in the answer.
  void removeRecordings(Call& call, std::vector<std::string> recordings);

  // trials.cpp
  void storeMeasures(const std::string& name, const SeenFile& file, const std::optional<Json>& json,
                     const std::string& why);
  void noteMissing(std::set<std::string> present);

  const ClinicOptions options_;
  const Clock& clock_;
  Station& station_;
  std::mutex mutex_;  ///< guards all below
  std::optional<Database> db_;
  bool was_open_ = false;   ///< the database was there once: none is made in its place
  std::optional<Key> key_;  ///< while the clinic is open
  std::optional<Presets> presets_;
  std::vector<ShippedHand> hands_;
  std::map<std::string, Session> sessions_;  ///< by the token's digest
  std::map<std::int64_t, Tries> tries_;      ///< by account; 0: pass phrase and recovery code
  bool asking_ = false;                      ///< an order to the station waits for its reply
  std::int64_t apart_since_us_ = 0;  ///< steady clock: station and database differ; 0: they agree
  std::map<std::string, SeenFile> files_;
  std::set<std::string> present_;  ///< recordings of the last look, and the one being written
  std::int64_t last_backup_us_ = 0;
  std::string backup_problem_;
  bool compact_due_ = false;  ///< rows were erased; a full disk kept their pages from being freed
};

/// Measured values, one a line, by code, without names and notes; needs no key. @param patient 0:
/// all
[[nodiscard]] std::string csvOf(Database& db, std::int64_t patient);

/// A plan as the pages have it.
[[nodiscard]] Json toJson(const Plan& plan);
[[nodiscard]] Plan planFrom(const std::string& json);
/// The plan without effort limits above those of the person.
[[nodiscard]] Plan capped(Plan plan, const Parameters& limits);

}  // namespace wholehand::clinic
