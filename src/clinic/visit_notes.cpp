// Notes and pain of a visit.
#include "clinic/visits.hpp"

#include <fmt/format.h>

namespace wholehand::clinic {
namespace {

constexpr int kMostPain = 10;

}  // namespace

Json Visits::note(Call& call) {
  const VisitRow visit = visitOf(call);
  insertNote(records_, call, {}, visit.id);
  return visitJson(records_, visit.id, call.session.hidden);
}

/// Stores a note whose number the page has drawn: a new note, or the new text of an existing one.
Json Visits::putNote(Call& call) {
  const std::int64_t id = call.ids.at(0);
  const auto owner = [&](const char* key) -> std::optional<std::int64_t> {
    if (call.body.value(key, Json()).is_null()) return {};
    return integerOf(call.body, key, fmt::format("{} is no number", key));
  };
  std::optional<std::int64_t> patient = owner("patient"), visit = owner("visit");
  if (id < 1 || id > kLastDrawnNote) throw badValue("", "a note has a number of 1 to 2^48 - 1");
  if (patient && visit) throw badValue("visit", "a note is a visit's or a patient's, not both");
  records_.begin(call);
  Statement row =
      records_.db().query("SELECT patient, visit, account, at_us, kind FROM note WHERE id = ?", id);
  // An existing note keeps its visit or patient, its time and its kind; its old row is deleted.
  if (row.step()) {
    const auto other = [&](int column, const std::optional<std::int64_t>& given) {
      return given && (row.isNull(column) || row.integer(column) != *given);
    };
    if (other(0, patient) || other(1, visit) || row.integer(2) != call.session.account) {
      throw RequestRefusal{
          409, "changed", "this number is a note of another visit, patient or account", {}};
    }
    row.read(patient, visit);
    call.body.emplace("at_us", row.integer(3));
    call.body.emplace("kind", row.text(4));
    records_.db().change("DELETE FROM note WHERE id = ?", id);
  }
  // Checks that the note's visit or patient may be seen.
  if (visit) {
    (void)visitFor(call, *visit);
  } else if (!patient) {
    throw notFound(fmt::format("there is no note {}: name its visit or patient", id));
  } else if (call.session.hidden) {
    throw RequestRefusal{403, "hidden", "names are hidden; type the PIN to show them", {}};
  } else {
    patients_.check(*patient);
  }
  insertNote(records_, call, patient, visit, id);
  return notesOf(records_, "id", id, call.session.hidden).at(0);
}

Json Visits::pain(Call& call) {
  const VisitRow visit = visitOf(call);
  const Json when = call.body.value("when", Json());
  if (when != "before" && when != "after") throw badValue("when", "when must be before or after");
  const Json value = call.body.value("value", Json());
  const bool number = value.is_number_integer() && value >= 0 && value <= kMostPain;
  if (!number && !value.is_null()) throw badValue("value", "pain is a whole number of 0 to 10");
  std::optional<std::int64_t> pain;
  if (number) pain = value.get<std::int64_t>();
  records_.db().change(when == "before" ? "UPDATE visit SET pain_before = ? WHERE id = ?"
                                        : "UPDATE visit SET pain_after = ? WHERE id = ?",
                       pain, visit.id);
  return visitJson(records_, visit.id, call.session.hidden);
}

}  // namespace wholehand::clinic
