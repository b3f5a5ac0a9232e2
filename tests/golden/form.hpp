#pragma once

#include <cstdint>
#include <flatbuffers/reflection.h>
#include <span>
#include <string>

// The canonical form of messages, by reflection over the compiled schema (docs/protocol.md, "Golden
// messages"). It is independent of flatc's classes and of src/station/server.
namespace wholehand::golden {

/// Text as a JSON string. @pre UTF-8
[[nodiscard]] std::string quoted(const std::string& text);

/// The schema and its version as JSON, with which another language can write the form. @throws
/// std::runtime_error if the schema uses a type that the form does not have
[[nodiscard]] std::string layoutOf(const reflection::Schema& schema, int schema_version);

/// The canonical form of a message's root table. @pre verified bytes
[[nodiscard]] std::string formOf(const reflection::Schema& schema,
                                 std::span<const std::uint8_t> message);

}  // namespace wholehand::golden
