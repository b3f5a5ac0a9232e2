#pragma once

#include "loop/core/tick_record.hpp"

#include <pybind11/numpy.h>

namespace wholehand::python {

/// Records that Python sees: of one rig, or of `count` rigs one after another in memory.
struct Records {
  TickRecord* first = nullptr;
  pybind11::ssize_t count = 0;  ///< 0: of a single rig; its arrays have no leading dimension
};

/// A read-only array of `size` elements at `member` of each record, without a copy.
/// @param owner is kept alive by the array
pybind11::array viewOf(const Records& records, const pybind11::dtype& type, const void* member,
                       pybind11::ssize_t size, pybind11::handle owner);

/// The same of one element each: an array of shape (rigs,), or the number itself of a single rig,
/// which a later step does not change.
pybind11::object viewOfOne(const Records& records, const pybind11::dtype& type, const void* member,
                           pybind11::handle owner);

/// Structured types with the field names of BodyState and Contact.
pybind11::dtype bodyType();
pybind11::dtype contactType();

}  // namespace wholehand::python
