#pragma once

#include "clinic/records.hpp"
#include "clinic/request.hpp"

#include <cstdint>
#include <map>
#include <string>

namespace wholehand::clinic {

/// What a request needs: nothing, somebody who is signed in, or whose names are not hidden either.
enum class Access { kAnyone, kSigned, kShown };

/// Who works here: tiles with PINs, sessions, wrong tries; and the pass phrase that opens the
/// clinic. One thread at a time.
class Accounts {
 public:
  explicit Accounts(Records& records) : records_(records) {}

  /// Fills in the call's session, or refuses.
  void admit(Call& call, Access access);
  [[nodiscard]] Json tiles();
  /// Logs that a patient's record was opened, once in a row.
  void logOpened(const Call& call, std::int64_t patient);

  Json init(Call& call);
  Json unlock(Call& call);
  Json lockClinic(Call& call);
  Json signIn(Call& call);
  Json signOut(Call& call);
  Json hide(Call& call);
  Json show(Call& call);
  Json addAccount(Call& call);

 private:
  struct Tries {
    int failed = 0;
    std::int64_t wait_until_us = 0;  ///< steady clock
  };
  std::int64_t insertAccount(const Json& tile, const std::string& prefix);
  /// Seals what an account's browser keeps; nobody else is given it.
  [[nodiscard]] std::string browserKey(std::int64_t account) const;
  [[nodiscard]] Json sessionOf(std::int64_t account);
  std::string newSession(std::int64_t account);
  void checkPin(std::int64_t account, const Json& body);
  void refuseWhileWaiting(const Tries& tries) const;
  void countFailure(Tries& tries) const;

  Records& records_;
  std::map<std::string, Session> sessions_;  ///< by the token's digest
  std::map<std::int64_t, Tries> tries_;      ///< by account; 0: pass phrase and recovery code
};

}  // namespace wholehand::clinic
