#pragma once

#include "simulated_rig.hpp"

#include <cstdint>
#include <limits>
#include <pybind11/numpy.h>
#include <string>
#include <vector>

namespace wholehand::python {

// Arguments from Python. They are read here, since pybind11 would answer one of a wrong type with
// the signature of the function. Each function raises ValueError, TypeError or IndexError with the
// name of the argument, its value and what is allowed.

/// The arguments that the constructors of Rig and VectorRig share; wholehand/_rig.pyi explains
/// them.
struct RigArguments {
  std::string device;
  std::string hand;
  std::string scene;
  std::string exercise;
  int level = 1;
  std::string patient;
  std::string rendering;
  std::string motion;
  std::string engine;  ///< empty: the default
  double rate_hz = 1000.0;
  bool uncertified = false;
  std::uint64_t seed = 0;
};

RigFiles filesOf(RigArguments arguments);

/// A whole number of Python (int, numpy's integers) in [least, most].
std::uint64_t wholeOf(const char* name, const pybind11::object& value, std::uint64_t least = 0,
                      std::uint64_t most = std::numeric_limits<std::uint64_t>::max());

double numberOf(const char* name, const pybind11::object& value);

/// True or False, of Python or numpy.
bool flagOf(const char* name, const pybind11::object& value);

std::string textOf(const char* name, const pybind11::object& value);

/// An index of a rig in 0 .. rigs - 1.
int rigOf(const pybind11::object& value, int rigs);

/// Seeds of rigs, one for each.
std::vector<std::uint64_t> seedsOf(const pybind11::object& seeds, int rigs);

using Numbers = pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;

/// The aims of rigs, a row each [m or rad]; rigs = 0: of a single rig, without leading dimension.
Numbers aimsOf(pybind11::handle aim, const Models& models, pybind11::ssize_t rigs);

/// The aim of one rig. @pre `aims` comes from aimsOf()
AxisPosition aimOf(const Numbers& aims, int rig, int axes);

std::vector<std::string> axisNames(const Models& models);

}  // namespace wholehand::python
