#pragma once

#include "loop/core/expected.hpp"
#include "loop/core/tick_record.hpp"
#include "simulated_rig.hpp"

#include <pybind11/pybind11.h>
#include <utility>

namespace wholehand::python {

/// Adds the exception types BadInput and RunEnded to the module. Call it before any other function
/// here; the types live as long as the process.
void addExceptions(pybind11::module_& module);

/// Raises BadInput with every diagnostic as text and in its attribute `diagnostics`.
[[noreturn]] void refuse(Diagnostics why);

/// Raises RunEnded: `rig` does not run, and `record` is its last tick.
[[noreturn]] void refuseEnded(const SimulatedRig& rig, const TickRecord& record);

/// The value of `result`; raises BadInput where it has none.
template <class T>
T valueOr(Expected<T> result) {
  if (!result) refuse(result.errors());
  return std::move(*result);
}

}  // namespace wholehand::python
