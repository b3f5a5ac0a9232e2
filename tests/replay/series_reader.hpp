#pragma once

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace wholehand::test {

/// A section of plot data, read as specified in docs/protocol.md.
struct Series {
  nlohmann::json header;
  std::vector<float> values;

  explicit Series(const std::string& message) {
    std::uint32_t bytes = 0;
    std::memcpy(&bytes, message.data(), sizeof bytes);
    EXPECT_EQ(bytes % 4U, 0U);  // padded with spaces, so that the numbers are aligned
    header = nlohmann::json::parse(message.substr(4, bytes));
    const std::size_t begin = 4 + bytes;
    values.resize((message.size() - begin) / sizeof(float));
    std::memcpy(values.data(), message.data() + begin, values.size() * sizeof(float));
    EXPECT_EQ((message.size() - begin) % sizeof(float), 0U);
    EXPECT_EQ(values.size(), 2 * header["channels"].size() * columns());
  }
  [[nodiscard]] std::size_t columns() const { return header["columns"].get<std::size_t>(); }
  [[nodiscard]] std::size_t channel(const std::string& name, int axis = 0) const {
    for (std::size_t c = 0; c < header["channels"].size(); ++c) {
      const auto& channel = header["channels"][c];
      if (channel["name"] == name && channel["axis"] == axis) return c;
    }
    ADD_FAILURE() << "no channel " << name << " " << axis;
    return 0;
  }
  [[nodiscard]] float low(std::size_t channel, std::size_t column) const {
    return values[2 * channel * columns() + column];
  }
  [[nodiscard]] float high(std::size_t channel, std::size_t column) const {
    return values[(2 * channel + 1) * columns() + column];
  }
};

}  // namespace wholehand::test
