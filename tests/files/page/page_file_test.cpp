#include "files/page/chart_page.hpp"
#include "support/contains.hpp"
#include "support/folder.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace wholehand {
namespace {

namespace fs = std::filesystem;

class PageFile : public testing::Test {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const { return folder_.file(name); }
  [[nodiscard]] std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
    return path(name);
  }
  static std::string read(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  const test::Folder folder_;
};

constexpr const char* kTemplate =
    "<html><script type=\"application/json\">\"wholehand-page-data\"</script></html>";

TEST_F(PageFile, AnyName_StaysInsideItsElementAndIsRestored) {
  const std::string name =
      "</script><img src=x onerror=alert(1)><!-- محمد \" & \\ \x01" + std::string(10'000, 'x');
  const nlohmann::json data = {{"name", name}};
  ASSERT_TRUE(writePage(kTemplate, data, path("page.html")).ok());
  const std::string page = read(path("page.html"));
  const std::string head = "<html><script type=\"application/json\">", tail = "</script></html>";
  ASSERT_TRUE(page.starts_with(head) && page.ends_with(tail));
  const std::string json = page.substr(head.size(), page.size() - head.size() - tail.size());
  EXPECT_EQ(json.find('<'), std::string::npos) << "nothing ends the element";
  EXPECT_EQ(nlohmann::json::parse(json)["name"], name);
}

TEST_F(PageFile, InvalidUtf8_IsReplaced) {
  EXPECT_EQ(embeddedJson("\xff"), "\"\\ufffd\"");  // U+FFFD, Unicode's replacement character
}

TEST_F(PageFile, MissingTemplate_SaysHowItIsBuilt) {
  const auto missing = readPageTemplate(path("dist/report.html"));
  ASSERT_FALSE(missing.ok());
  const std::string why = format(missing.errors());
  EXPECT_TRUE(test::contains(why, path("dist/report.html")));
  EXPECT_TRUE(test::contains(why, "npm run build"));
}

TEST_F(PageFile, FileWithoutTheMarkerOrWithTwo_IsNoTemplate) {
  for (const std::string& text :
       {std::string("<html></html>"), std::string(kTemplate) + kTemplate}) {
    const auto found = readPageTemplate(write("x.html", text));
    EXPECT_TRUE(test::refusedWith(found, "no template"));
  }
  EXPECT_TRUE(readPageTemplate(write("good.html", kTemplate)).ok());
}

TEST_F(PageFile, MissingFolder_IsCreatedIfItsParentExists) {
  EXPECT_TRUE(writePage(kTemplate, 1, path("new/index.html")).ok());
  EXPECT_TRUE(fs::exists(path("new/index.html")));
  const auto refused = writePage(kTemplate, 1, path("no/such/index.html"));
  EXPECT_TRUE(test::refusedWith(refused, "cannot be written"));
  EXPECT_FALSE(fs::exists(path("no")));
}

TEST_F(PageFile, PageThatCannotBeWritten_KeepsTheOldOne) {
  fs::create_directories(path("index.html"));  // a folder has the page's name
  EXPECT_FALSE(writePage(kTemplate, 1, path("index.html")).ok());
  EXPECT_TRUE(fs::is_directory(path("index.html")));
  EXPECT_FALSE(fs::exists(path("index.html.part")));
}

// python3 -c "import zlib, base64; print(base64.b64encode(zlib.compress(b'wholehand', 9)))"
TEST(PackedBytes, Bytes_AreZlibInBase64) {
  EXPECT_EQ(packBytes("wholehand"), "eNorz8jPSc1IzEsBABMFA7s=");
  EXPECT_EQ(packBytes(""), "eNoDAAAAAAE=");
}

}  // namespace
}  // namespace wholehand
