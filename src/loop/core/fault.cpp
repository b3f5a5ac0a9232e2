#include "loop/core/fault.hpp"

#include <cstddef>

namespace wholehand {
namespace {

// Counters are indexed by bit number, so the table must be in the order of the bits.
constexpr bool areInOrder() {
  for (unsigned bit = 0; bit < kFaultBits; ++bit) {
    if (kFaultTable[bit].bit != static_cast<Fault>(1U << bit)) return false;
  }
  return true;
}
static_assert(areInOrder());

}  // namespace

const char* faultName(int bit) noexcept {
  return bit >= 0 && bit < kFaultBits ? kFaultTable[bit].name : "unknown";
}

std::string faultNames(Fault faults) {
  std::string names;
  for (const FaultFacts& fault : kFaultTable) {
    if (!any(faults & fault.bit)) continue;
    if (!names.empty()) names += ", ";
    names += fault.name;
  }
  return names;
}

}  // namespace wholehand
