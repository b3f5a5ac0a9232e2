// Forged black box files with correct checksums.
#include "loop/core/crc32.hpp"
#include "record/black_box/box_tools.hpp"
#include "record/black_box_layout.hpp"

#include <cstring>
#include <filesystem>

namespace wholehand::test {
namespace {

using synthetic::Folder;

/// Bytes of a small black box file.
std::string boxOfTwentyTicks(const Folder& folder) {
  auto box = armed(planFor(folder.file("whole.wbb")));
  std::mt19937_64 random(7919);
  for (std::uint64_t i = 0; i < 20; ++i) giveTick(*box, tickAt(i, random));
  EXPECT_TRUE(box->write().ok());
  return contents(folder.file("whole.wbb"));
}

/// The file with this header and an end without entries, under correct checksums.
std::string forged(std::string box, black_box::Header header) {
  black_box::End end;
  end.entries_begun = ~std::uint64_t{0};
  const auto crc = [&box](std::size_t begin, std::size_t to) {
    return crc32(0, reinterpret_cast<const std::byte*>(box.data()) + begin, to - begin);
  };
  std::memcpy(box.data(), &header, sizeof header);
  header.crc = crc(0, offsetof(black_box::Header, crc));
  std::memcpy(box.data(), &header, sizeof header);
  const std::size_t end_at = box.size() - sizeof(std::uint32_t) - sizeof end;
  std::memcpy(box.data() + end_at, &end, sizeof end);
  const std::uint32_t end_crc =
      crc(end_at - sizeof(black_box::PartHeader), box.size() - sizeof(std::uint32_t));
  std::memcpy(box.data() + box.size() - sizeof end_crc, &end_crc, sizeof end_crc);
  return box;
}

// Found by an audit: 2^61 entries of 24 bytes have, modulo 2^64, no bytes at all; reading them
// ended in SIGSEGV.
TEST(BlackBoxReader, NumberOfEntriesThatOverflows_IsRefused) {
  const Folder folder;
  const std::string whole = boxOfTwentyTicks(folder), path = folder.file("forged.wbb");
  black_box::Header header;
  std::memcpy(&header, whole.data(), sizeof header);
  overwrite(path, forged(whole, header));
  EXPECT_EQ(refusalOf(path), "opened");  // no entries and no fault
  header.end_entry += std::uint64_t{1} << 61U;
  overwrite(path, forged(whole, header));
  EXPECT_NE(refusalOf(path).find("is damaged"), std::string::npos) << refusalOf(path);
}

// The reader would load the whole file into memory; the file is sparse.
TEST(BlackBoxReader, FileLargerThanAnyBlackBox_IsRefused) {
  const Folder folder;
  const std::string path = folder.file("large.wbb");
  overwrite(path, boxOfTwentyTicks(folder));
  std::filesystem::resize_file(path, std::uintmax_t{8} << 30U);
  EXPECT_NE(refusalOf(path).find("larger than any black box"), std::string::npos)
      << refusalOf(path);
}

}  // namespace
}  // namespace wholehand::test
