#pragma once

#include "clinic/keys.hpp"
#include "clinic/records.hpp"
#include "clinic/request.hpp"

#include <cstdint>
#include <functional>
#include <map>
#include <string>

namespace wholehand::clinic {

/// Condition of a request: none; somebody is signed in; or somebody is signed in and names are not
/// hidden.
enum class Access { kAnyone, kSigned, kShown };

/// Accounts of the staff: tiles with PINs, sessions and failed tries. Also the pass phrase that
/// unlocks the clinic. One thread at a time.
class Accounts {
 public:
  explicit Accounts(Records& records) : records_(records) {}

  /// Fills in the call's session, or throws Refused.
  void admit(Call& call, Access access);
  [[nodiscard]] Json tiles();
  /// Logs that a patient's record was opened; repeated openings of the same record in a session are
  /// logged once.
  void logOpened(const Call& call, std::int64_t patient);

  /// True while somebody is signed in.
  [[nodiscard]] bool anybody() const { return !sessions_.empty(); }

  Json init(Call& call);
  Json unlock(Call& call);
  /// Change what unlocks the clinic; the body has the present pass phrase or recovery code.
  Json changePhrase(Call& call);
  Json changeRecoveryCode(Call& call);
  Json lockClinic(Call& call);
  Json signIn(Call& call);
  Json signOut(Call& call);
  Json hide(Call& call);
  Json show(Call& call);
  Json addAccount(Call& call);
  /// Changes the PIN of who is signed in. The present one is asked for.
  Json changePin(Call& call);
  /// A colleague works here no longer: no tile, no session. Nobody does that to themselves, so that
  /// somebody stays.
  Json leave(Call& call);

 private:
  struct Tries {
    int failed = 0;
    std::int64_t wait_until_us = 0;  ///< steady clock; no try is accepted earlier
  };
  std::int64_t insertAccount(const Json& tile, const std::string& prefix);
  /// Key that encrypts the data kept in the account's browser. Only this account receives it.
  [[nodiscard]] std::string browserKey(std::int64_t account) const;
  [[nodiscard]] Key unwrapped(const KeyFile& keys, const Json& body, Tries& tries);
  Json rewrap(Call& call, const std::function<void(KeyFile&, const Key&)>& change);
  void adoptRows(KeyFile keys, const Key& key);
  [[nodiscard]] Json sessionOf(std::int64_t account);
  std::string newSession(std::int64_t account);
  void checkPin(std::int64_t account, const Json& body);
  void refuseWhileWaiting(const Tries& tries) const;
  [[nodiscard]] Tries& triesOf(std::int64_t account);
  void clearTries(std::int64_t account, Tries& tries);
  void countFailure(std::int64_t account, Tries& tries);

  Records& records_;
  std::map<std::string, Session> sessions_;  ///< sessions by the digest of their token
  std::map<std::int64_t, Tries> tries_;      ///< failed tries by account; 0: pass phrase and
                                             ///< recovery code
};

}  // namespace wholehand::clinic
