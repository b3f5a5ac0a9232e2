// The reference reader for golden messages, and the program's own reading of them (run.py runs it).
//
//   golden_judge layout SCHEMA.bfbs     the schema as JSON
//   golden_judge messages SCHEMA.bfbs   a line for each path on stdin: the contents of that file
//   golden_judge datagrams              a line for each line on stdin: key and paths of a
//                                       conversation; judges the last one
//   golden_judge say FOLDER             messages from the program's encoders
#include "golden/form.hpp"
#include "golden/program_messages.hpp"
#include "station/server/udp_host.hpp"
#include "station/server/wire.hpp"
#include "wholehand_generated.h"

#include <fmt/format.h>

#include <cstring>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>
#include <vector>

namespace wholehand::golden {
namespace {

namespace fb = wholehand::protocol;
using Bytes = std::vector<std::uint8_t>;

/// Reads a file into memory of exactly its size that begins at a multiple of 16 bytes.
Bytes readFile(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error(path + ": cannot be read");
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// The program's reading of a client's message.
std::string asTheProgramReads(const Bytes& bytes) {
  const auto message = wire::decode(bytes);
  if (!message) return fmt::format(R"({{"refused":{}}})", quoted(message.errors().front().key));
  return fmt::format(R"({{"order":"{}","id":{}}})", message->row().name, message->id);
}

std::string refused(const char* reason) {
  return fmt::format(R"({{"refused":"{}")", reason);
}

std::string messageForm(const reflection::Schema& schema, const Bytes& bytes) {
  constexpr std::size_t kSmallest = 8;  // root offset and identifier
  if (bytes.size() < kSmallest || !fb::MessageBufferHasIdentifier(bytes.data())) {
    return refused("identifier");
  }
  flatbuffers::Verifier verifier(bytes.data(), bytes.size());
  if (!fb::VerifyMessageBuffer(verifier)) return refused("damaged");
  const auto* message = fb::GetMessage(bytes.data());
  if (message->schema_version() != wire::kSchemaVersion) return refused("version");
  if (message->payload() == nullptr || message->payload_type() > fb::Payload::MAX) {
    return refused("payload");
  }
  // The given schema may differ from the one compiled into this program.
  if (!flatbuffers::Verify(schema, *schema.root_table(), bytes.data(), bytes.size())) {
    return refused("damaged");
  }
  return "{\"form\":" + formOf(schema, bytes);
}

std::string headerOf(const udp::Header& h) {
  return fmt::format(
      R"({{"kind":{},"holds_controls":{},"key":"{:016x}","sequence":{},"rate_or_stop":{},)"
      R"("sent_ns":"{:016x}","echo_ns":"{:016x}","echo_age_us":{}}})",
      static_cast<int>(h.kind), h.holds_controls, h.key, h.sequence, h.rate_or_stop,
      static_cast<std::uint64_t>(h.sent_ns), static_cast<std::uint64_t>(h.echo_ns), h.echo_age_us);
}

const char* nameOf(udp::Flaw flaw) {
  static const std::map<udp::Flaw, const char*> kNames = {{udp::Flaw::kNone, "none"},
                                                          {udp::Flaw::kTooShort, "too_short"},
                                                          {udp::Flaw::kTooLong, "too_long"},
                                                          {udp::Flaw::kWrongMagic, "magic"},
                                                          {udp::Flaw::kWrongVersion, "version"},
                                                          {udp::Flaw::kWrongChecksum, "checksum"},
                                                          {udp::Flaw::kBadHeader, "header"}};
  return kNames.at(flaw);
}

/// The reason why the program ignores the last datagram of a game with that key; empty if it does
/// not.
std::string ignoredFor(std::uint64_t key, const std::vector<Bytes>& datagrams) {
  ControlHolder controls;
  UdpCounters counters;
  udp::Host host(controls, counters, [](const auto&, auto) { return UdpSent::kSent; });
  host.admit(key, controls.newClient(), false);
  std::array<std::uint64_t, static_cast<std::size_t>(UdpIgnored::kCount)> before{};
  for (const Bytes& datagram : datagrams) {
    std::copy(counters.ignored.begin(), counters.ignored.end(), before.begin());
    host.receive({}, datagram, 0);
  }
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (counters.ignored[i] != before[i]) return udpIgnoredName(static_cast<UdpIgnored>(i));
  }
  return "";
}

std::string datagramForms(std::uint64_t key, const std::vector<Bytes>& datagrams) {
  const Bytes& last = datagrams.back();
  const udp::Received got = udp::read(last);
  std::string out = "{\"ignored\":" + quoted(ignoredFor(key, datagrams));
  if (got.flaw != udp::Flaw::kNone)
    return fmt::format(R"({},"flaw":"{}"}})", out, nameOf(got.flaw));
  udp::Datagram again{};
  const std::size_t size = udp::write(again, got.header, got.payload);
  const bool same = size == last.size() && std::memcmp(again.data(), last.data(), size) == 0;
  return fmt::format(R"({},"header":{},"payload_bytes":{},"written_the_same":{}}})", out,
                     headerOf(got.header), got.payload.size(), same);
}

void printMessages(const reflection::Schema& schema) {
  for (std::string path; std::getline(std::cin, path);) {
    const Bytes bytes = readFile(path);
    std::cout << messageForm(schema, bytes) << ",\"program\":" << asTheProgramReads(bytes) << "}\n";
  }
}

void printDatagrams() {
  for (std::string line; std::getline(std::cin, line);) {
    std::istringstream words(line);
    std::string key, path;
    words >> key;
    std::vector<Bytes> datagrams;
    while (words >> path) datagrams.push_back(readFile(path));
    if (datagrams.empty()) throw std::runtime_error(line + ": names no datagram");
    std::cout << datagramForms(std::stoull(key, nullptr, 16), datagrams) << "\n";
  }
}

void writeMessages(const std::string& folder) {
  for (const auto& [name, bytes] : programMessages()) {
    std::ofstream out(folder + "/" + name + ".bin", std::ios::binary);
    out.write(reinterpret_cast<const char*>(bytes.data()),
              static_cast<std::streamsize>(bytes.size()));
    if (!out) throw std::runtime_error(folder + "/" + name + ".bin: cannot be written");
  }
}

int run(const std::vector<std::string>& arguments) {
  const std::string what = arguments.empty() ? "" : arguments[0];
  if (what == "datagrams") return printDatagrams(), 0;
  if (what == "say" && arguments.size() == 2) return writeMessages(arguments[1]), 0;
  if ((what != "layout" && what != "messages") || arguments.size() != 2) {
    std::cerr << "golden_judge layout|messages SCHEMA.bfbs | datagrams | say FOLDER\n";
    return 2;
  }
  const Bytes compiled = readFile(arguments[1]);
  flatbuffers::Verifier verifier(compiled.data(), compiled.size());
  if (!reflection::VerifySchemaBuffer(verifier)) {
    throw std::runtime_error(arguments[1] +
                             ": is not a compiled schema; make it: flatc --binary --schema");
  }
  const reflection::Schema& schema = *reflection::GetSchema(compiled.data());
  if (what == "layout") std::cout << layoutOf(schema, wire::kSchemaVersion);
  if (what == "messages") printMessages(schema);
  return 0;
}

}  // namespace
}  // namespace wholehand::golden

int main(int argc, char** argv) {
  try {
    return wholehand::golden::run({argv + 1, argv + argc});
  } catch (const std::exception& e) {
    std::cerr << "golden_judge: " << e.what() << "\n";
    return 1;
  }
}
