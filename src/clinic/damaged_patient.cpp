#include "clinic/patients.hpp"
#include "clinic/row_digests.hpp"
#include "clinic/rows.hpp"

#include <fmt/format.h>

namespace wholehand::clinic {

Json Patients::showDamaged(Call& call) {
  const std::int64_t id = call.ids.at(0);
  check(id);
  if (isSound(records_.db(), "patient", id)) {
    throw changedMeanwhile("the patient's row is sound", toJson(id));
  }
  Statement row = records_.db().query(
      "SELECT code, side, hands, preset, parameters, plan, secret FROM patient WHERE id = ?", id);
  row.step();
  Json unreadable = Json::array();
  const auto read = [&](const char* name, int column, const Json& otherwise) {
    Json value = Json::parse(row.text(column), nullptr, false);
    if (value.type() == otherwise.type()) return value;
    unreadable.push_back(name);
    return otherwise;
  };
  Json secret = Json::object();
  try {
    secret = Json::parse(records_.unseal("patient", row.text(6)), nullptr, false);
  } catch (const DatabaseError&) {  // does not open with the clinic's key
  }
  if (secret.empty()) unreadable.push_back("name");
  Json out = {{"id", id},
              {"code", row.text(0)},
              {"side", ""},
              {"hands", Json::object()},
              {"preset", records_.presets().force.front().id},
              {"parameters", Json::object()},
              {"plan", read("plan", 5, Json::array())},
              {"was",
               {{"side", row.text(1)},
                {"hands", read("hands", 2, Json::object())},
                {"preset", row.text(3)},
                {"parameters", read("parameters", 4, Json::object())}}}};
  for (const char* name : {"name", "born", "number", "warnings"}) {
    out[name] = secret.value(name, "");
  }
  out["unreadable"] = std::move(unreadable);
  accounts_.logOpened(call, id);
  return out;
}

}  // namespace wholehand::clinic
