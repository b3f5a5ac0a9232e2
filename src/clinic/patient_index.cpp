#include "clinic/patient_index.hpp"

#include "clinic/row_digests.hpp"
#include "clinic/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sqlite3.h>
#include <tuple>

namespace wholehand::clinic {

void PatientIndex::changed(void* index, int, const char*, const char* table, long long row) {
  auto& self = *static_cast<PatientIndex*>(index);
  const std::string_view name(table);
  if (name == "patient") self.changed_patients_.insert(row);
  if (name == "visit") self.changed_visits_.insert(row);
}

void PatientIndex::forget() {
  for (auto& [id, row] : rows_) {
    for (std::string* text : {&row.name, &row.words}) std::fill(text->begin(), text->end(), '\0');
  }
  rows_.clear();
  order_.clear();
  owners_.clear();
  opening_ = 0;
}

/// Reads rows. @param where condition on the patient p, with one parameter
void PatientIndex::read(const std::string& where, std::int64_t patient) {
  // SQLite takes bare columns next to MAX() from the row with the maximum: the last visit.
  Statement query = records_.db().query(
      fmt::format("SELECT p.id, p.code, p.side, p.secret, COUNT(v.id), v.id, v.state,"
                  " MAX(v.began_us), {} FROM patient p"
                  " LEFT JOIN visit v ON v.patient = p.id AND v.state <> 'no_show'"
                  " WHERE {} GROUP BY p.id",
                  soundness(records_.db(), "patient", "p"), where),
      patient);
  while (query.step()) {
    Row row;
    row.id = query.integer(0);
    if (query.integer(8) == 0) {
      row.code = fmt::format("damaged-{}", row.id);
      row.state = "damaged";
    } else {
      row.code = query.text(1);
      row.side = query.text(2);
      row.name = Json::parse(records_.unseal("patient", query.text(3))).at("name");
      row.visits = query.integer(4);
      row.last_visit_us = query.integer(7);
      const std::string state = query.text(6);
      if (state == "open" || state == "unfinished") {
        row.state = state;
        row.visit = query.integer(5);
      }
    }
    row.words = folded(row.name) + '\n' + folded(row.code);
    rows_[row.id] = std::move(row);
  }
}

void PatientIndex::refresh() {
  Database& db = records_.db();
  if (opening_ != records_.opening()) {
    forget();
    changed_patients_.clear();
    changed_visits_.clear();
    sqlite3_update_hook(db.handle(), &PatientIndex::changed, this);
    read("?1 = 0", 0);
    Statement visits = db.query("SELECT id, patient FROM visit WHERE patient IS NOT NULL");
    while (visits.step()) owners_[visits.integer(0)] = visits.integer(1);
    opening_ = records_.opening();
    return;
  }
  for (const std::int64_t visit : changed_visits_) {
    const std::int64_t now = db.number("SELECT patient FROM visit WHERE id = ?", visit);
    std::int64_t& owner = owners_[visit];
    changed_patients_.insert(owner);
    changed_patients_.insert(now);
    owner = now;
    if (now == 0) owners_.erase(visit);
  }
  if (changed_visits_.empty() && changed_patients_.empty()) return;
  order_.clear();
  for (const std::int64_t patient : changed_patients_) {
    rows_.erase(patient);
    read("p.id = ?1", patient);
  }
  changed_visits_.clear();
  changed_patients_.clear();
}

Json PatientIndex::row(std::int64_t patient) {
  refresh();
  const auto row = rows_.find(patient);
  return row == rows_.end() ? Json() : Json(row->second);
}

Json PatientIndex::page(std::string_view find, std::int64_t page) {
  refresh();
  if (order_.size() != rows_.size()) {
    order_.clear();
    for (const auto& [id, row] : rows_) order_.push_back(&row);
    std::sort(order_.begin(), order_.end(), [](const Row* a, const Row* b) {
      return std::tuple(a->last_visit_us, a->id) > std::tuple(b->last_visit_us, b->id);
    });
  }
  const std::string wanted = folded(find);
  Json rows = Json::array(), open = Json::array();
  std::int64_t count = 0;
  if (wanted.empty()) {  // the usual list looks at its own rows only
    count = std::ssize(order_);
    for (const Row* row : order_) {
      if (row->visit != 0) open.push_back(*row);
    }
    const std::int64_t first = std::clamp<std::int64_t>(page, 0, count) * kRowsOfPage;
    for (std::int64_t i = first; i < std::min(count, first + kRowsOfPage); ++i) {
      rows.push_back(*order_[static_cast<std::size_t>(i)]);
    }
    return {{"patients", rows}, {"open", open}, {"count", count}, {"page", page}};
  }
  for (const Row* row : order_) {
    if (row->words.find(wanted) == std::string::npos) continue;
    if (row->visit != 0) open.push_back(*row);
    if (count / kRowsOfPage == page) rows.push_back(*row);
    ++count;
  }
  return {{"patients", rows}, {"open", open}, {"count", count}, {"page", page}};
}

}  // namespace wholehand::clinic
