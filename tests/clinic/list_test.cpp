#include "clinic_bench.hpp"

namespace wholehand::clinic {
namespace {

Json page(Bench& b, std::int64_t page, const std::string& find = {}) {
  Request request{"GET", "/api/patients", find, b.token, {}, {}};
  request.page = page;
  return Json::parse(b.clinic->answer(request).body);
}

std::vector<std::string> namesOf(const Json& list) {
  std::vector<std::string> names;
  for (const Json& row : list["patients"]) names.push_back(row["name"]);
  return names;
}

TEST(PatientList, Pages_HaveFiftyRowsAndCountAll) {
  Bench b;
  for (int i = 0; i < 60; ++i)
    (void)b.addPatient(fmt::format("P-{}", i), fmt::format("Person {:02}", i));
  const std::int64_t visit = b.beginVisit(3);
  const Json first = page(b, 0), second = page(b, 1);
  EXPECT_EQ(first["patients"].size(), 50U);
  EXPECT_EQ(first["count"], 60);
  EXPECT_EQ(first["patients"][0]["name"], "Person 02");
  EXPECT_EQ(first["patients"][0]["visit"], visit);
  EXPECT_EQ(second["patients"].size(), 10U);
  EXPECT_EQ(second["patients"][9]["name"], "Person 00");
  EXPECT_EQ(second["open"].size(), 1U);  // on each page
  EXPECT_EQ(page(b, 0, "PERSON 5")["count"], 10);
  EXPECT_EQ(page(b, 7)["patients"], Json::array());
}

TEST(PatientList, Changes_AreFollowedAlsoAfterARestart) {
  Bench b;
  const std::int64_t a = b.addPatient("P-1", "Anna"), c = b.addPatient("P-2", "Berta"),
                     d = b.addPatient("P-3", "Clara");
  const auto check = [&](const std::vector<std::string>& names, const std::vector<int>& visits) {
    for (const bool restarted : {false, true}) {
      if (restarted) b.restart();
      const Json list = page(b, 0);
      EXPECT_EQ(namesOf(list), names);
      std::vector<int> counts;
      for (const Json& row : list["patients"]) counts.push_back(row["visits"]);
      EXPECT_EQ(counts, visits);
    }
  };
  check({"Clara", "Berta", "Anna"}, {0, 0, 0});
  const std::int64_t visit = b.beginVisit(a);
  b.finish(visit);
  check({"Anna", "Clara", "Berta"}, {1, 0, 0});
  Json changed = patientOf("P-2", "Bertha");
  changed["version"] = 1;
  b.ask("PUT", fmt::format("/api/patients/{}", c), changed);
  check({"Anna", "Clara", "Bertha"}, {1, 0, 0});
  b.post(fmt::format("/api/visits/{}/move", visit), {{"patient", c}});
  check({"Bertha", "Clara", "Anna"}, {1, 0, 0});
  b.post(fmt::format("/api/patients/{}/merge", d), {{"from", c}});
  check({"Clara", "Anna"}, {1, 0});
  // A refused change leaves the list as it is.
  EXPECT_EQ(b.ask("POST", "/api/patients", patientOf("P-3", "Dora"))["refused"], "code_exists");
  b.post(fmt::format("/api/patients/{}/erase", d), {{"code", "P-3"}});
  check({"Anna"}, {0});
}

TEST(PatientList, Export_RunsBesideOtherRequestsAndTellsItsProgress) {
  Bench b;
  const std::int64_t id = b.addPatient("P-1");
  b.finish(b.beginVisit(id));
  EXPECT_EQ(b.get("/api/export/progress"), (Json{{"done", 0}, {"of", 0}}));
  const std::string csv = b.raw("GET", "/api/export/all.csv", "").body;
  EXPECT_NE(csv.find("P-1,"), std::string::npos) << csv;
  EXPECT_EQ(b.get("/api/export/progress")["of"], 0);
  EXPECT_EQ(b.get("/api/export/progress")["done"], 1);
}

}  // namespace
}  // namespace wholehand::clinic
