// Bounds of a TOML file against the parser that they protect: what the scanner of brackets and
// quotes lets pass is never deeper than it says. Found by an audit: four quotes at the end of a
// text of many lines hid the rest of the line from it.
#include "model/toml/toml_bounds.hpp"

#include "model/scene/scene_model.hpp"
#include "support/folder.hpp"
#include "support/says.hpp"
#include "support/seed.hpp"

#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <array>
#include <ctime>

namespace wholehand::test {
namespace {

constexpr int kBound = 32;

std::string deepKey(int parts) {
  std::string key = "k";
  for (int i = 1; i < parts; ++i) key += ".k";
  return key;
}

int depthOf(const toml::node& node) {
  int most = 0;
  if (const auto* table = node.as_table()) {
    for (const auto& [key, value] : *table) most = std::max(most, depthOf(value));
  } else if (const auto* array = node.as_array()) {
    for (const toml::node& value : *array) most = std::max(most, depthOf(value));
  } else {
    return 0;
  }
  return most + 1;
}

/// Depth of the parsed text; -1: it is no TOML.
int parsedDepth(const std::string& text) {
  try {
    return depthOf(toml::parse(text));
  } catch (const toml::parse_error&) {
    return -1;
  }
}

TEST(TomlBounds, QuotesInFrontOfADeepKey_NeverHideIt) {
  constexpr std::array<const char*, 12> kTokens = {"\"\"\"", "'''", "\"", "'", "\\", "a",
                                                   "\n",     "#",   ",",  "",  "\"", "'"};
  const std::string deep = deepKey(2 * kBound);
  auto random = seededRandom(5601);
  int refused = 0;
  for (int i = 0; i < 60'000; ++i) {
    std::string text = i % 2 == 0 ? "x = [" : "x = ";
    for (std::size_t n = random() % 10; n > 0; --n) text += kTokens[random() % kTokens.size()];
    text += i % 2 == 0 ? ", {" + deep + " = 1}]\n" : "\n" + deep + " = 1\n";
    const int depth = parsedDepth(text);
    if (depth <= kBound) continue;
    ASSERT_TRUE(beyondBounds(text, "a.toml")) << text;
    ++refused;
  }
  EXPECT_GT(refused, 200);  // of texts that the parser would have taken
}

TEST(TomlBounds, TextsThatEndInMoreQuotes_EndWhereTheParserEndsThem) {
  const std::string deep = ", {" + deepKey(100) + " = 1}]\n";
  for (const std::string text : {R"("""x"""")", R"("""x""""")", "'''x''''", "'''x'''''",
                                 R"("""""")", R"("""\"""")", R"("""\\""")"}) {
    ASSERT_GE(parsedDepth("x = [" + text + "]\n"), 0) << text;
    EXPECT_FALSE(beyondBounds("x = [" + text + "]\n", "a.toml")) << text;
    EXPECT_TRUE(beyondBounds("x = [" + text + deep, "a.toml")) << text;
  }
}

double processor_s() {
  timespec t{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

std::string repeated(const std::string& text, int times) {
  std::string out;
  for (int i = 0; i < times; ++i) out += text;
  return out;
}

// No look-up is quadratic: within a second, ten under a sanitizer. Judged in ./check --full.
TEST(TomlBounds, FileOfManyTables_IsRefusedWithinASecond) {
  const std::string head =
      "kind = \"scene\"\nversion = 1\nname = \"n\"\ngravity_m_s2 = [0, 0, -9.81]\n";
  std::string keys, long_keys;
  for (int i = 0; i < 11'900; ++i) {
    keys += "k" + std::to_string(i) + " = 1\n";
    long_keys += std::string(330, 'k') + std::to_string(i) + " = 1\n";
  }
  const Folder folder;
  for (const auto& [text, said] : std::initializer_list<std::pair<std::string, const char*>>{
           {"bodies = [" + repeated("{},", 1'000'000) + "]\n", "more than 12000 inline tables"},
           {"bodies = [" + repeated("{},", 11'000) + "]\n", "more faults"},
           {repeated("[[bodies]]\n", 1'199), "more faults"},
           {keys, "more faults"},
           {long_keys, "more faults"}}) {
    const std::string path = folder.write("many.toml", head + text);
    const double before_s = processor_s();
    const Expected<SceneModel> scene = loadSceneFile(path);
    const double took_s = processor_s() - before_s;
    if (std::getenv("WHOLEHAND_FULL") != nullptr) {
      EXPECT_LE(took_s, WHOLEHAND_SANITIZED ? 10.0 : 1.0) << text.substr(0, 40);
    }
    ASSERT_FALSE(scene.ok());
    EXPECT_LE(scene.errors().size(), 21U);
    EXPECT_TRUE(refusedWith(scene, said));
  }
}

}  // namespace
}  // namespace wholehand::test
