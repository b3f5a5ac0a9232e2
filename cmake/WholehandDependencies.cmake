# Every dependency comes from Debian 12 (scripts/packages.txt is the one list).
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(PkgConfig REQUIRED)

# Bullet is used in double precision: in float the articulated-body algorithm freezes light links. Its CMake config has
# relative include paths, hence pkg-config.
pkg_check_modules(bullet REQUIRED IMPORTED_TARGET bullet-float64)
# Modules that contain a physics engine (docs/engines.md).
set(engine_modules loop/physics/bullet)
if(WHOLEHAND_LAB)
  list(APPEND engine_modules lab)
endif()
pkg_check_modules(hdf5 REQUIRED IMPORTED_TARGET hdf5-serial)
pkg_check_modules(qhull REQUIRED IMPORTED_TARGET qhull_r)
pkg_check_modules(tinyxml2 REQUIRED IMPORTED_TARGET tinyxml2)
pkg_check_modules(tomlplusplus REQUIRED IMPORTED_TARGET tomlplusplus)
pkg_check_modules(zlib REQUIRED IMPORTED_TARGET zlib)
# Used only by the clinic's process.
pkg_check_modules(sqlite3 REQUIRED IMPORTED_TARGET sqlite3)
pkg_check_modules(sodium REQUIRED IMPORTED_TARGET libsodium)
find_package(OpenSSL REQUIRED COMPONENTS Crypto)  # SHA-256 of passports
find_package(fmt REQUIRED)
find_package(CLI11 REQUIRED)
find_package(nlohmann_json REQUIRED)
# Only the headers of both are used; nothing of them is linked. FlatBuffers brings flatc.
find_package(FlatBuffers CONFIG REQUIRED)
find_package(Boost 1.81 CONFIG REQUIRED COMPONENTS headers)

if(WHOLEHAND_BUILD_TESTS)
  find_package(GTest REQUIRED)
endif()

add_library(wholehand_options INTERFACE)
target_compile_features(wholehand_options INTERFACE cxx_std_20)
target_include_directories(wholehand_options INTERFACE ${PROJECT_BINARY_DIR}/protocol/inside)
if(PROJECT_IS_TOP_LEVEL)  # an enclosing project chooses its own warnings
  target_compile_options(wholehand_options INTERFACE
    -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor
    -Woverloaded-virtual -Wdouble-promotion)
endif()
target_compile_options(wholehand_options INTERFACE
  # The Python module is a shared library made of the same objects as the program. Their functions are never replaced at
  # run time, so calls between them stay direct and inline.
  -fPIC -fno-semantic-interposition
  # No fused multiply-add: the same inputs give the same bits, whatever the compiler chooses to fuse.
  -ffp-contract=off)
target_link_libraries(wholehand_options INTERFACE Threads::Threads)

# Hardening of release builds: a write past a buffer ends the program before the buffer is used (the black box file
# records it), and tables of the linker are read-only. Addresses are randomised by Debian's default (PIE). The test
# `hardening` checks the program, and scripts/hardening_cost.py measures the cost.
option(WHOLEHAND_HARDENED "Harden release builds; off only to measure what that costs" ON)
if(WHOLEHAND_HARDENED)
  target_compile_options(wholehand_options INTERFACE
    $<$<CONFIG:Release>:-U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=2 -fstack-protector-strong>)
  target_link_options(wholehand_options INTERFACE
    $<$<CONFIG:Release>:-Wl,-z,relro,-z,now>)
else()
  target_compile_options(wholehand_options INTERFACE -U_FORTIFY_SOURCE -fno-stack-protector)
endif()

# The standard library checks indices and iterators, except in code of the tick: there an error must not end the program
# while a device holds its last effort.
set(tick_modules "^(loop|exercises|lab|devices/plugin|devices/host)(/|$)")
# These modules mostly multiply small matrices: at -O3 the products are inlined, with the same bits. They do not use
# precompiled headers, which would require -O2.
set(arithmetic_modules loop/dynamics)
option(WHOLEHAND_FUZZ "For libFuzzer, under AddressSanitizer: count which branches of the readers of untrusted bytes an input takes" OFF)
# The compiler takes half as long without optimisation. Two kinds of builds use that (docs/adr/0072):
# - under a sanitizer only these modules and the targets of wholehand_computes() are optimised;
# - with WHOLEHAND_QUICK, as ./start and ./check build, the targets of wholehand_cold() are not.
option(WHOLEHAND_QUICK "Compile without optimisation what is not hot: programs' commands, the clinic, unit tests" OFF)
set(computing_modules loop/core loop/model loop/dynamics loop/control loop/patient loop/psychometrics loop/exercise loop/safety
    loop/physics loop/physics/analytic loop/device/simulated loop/renderer ${engine_modules} files certify
    exercises rig/registry record devices/commissioning devices/commissioning/identification station/server)
set(cold_modules "^(clinic|devices/conformance|station/server)(/|$)")
if(CMAKE_BUILD_TYPE STREQUAL Debug AND CMAKE_CXX_FLAGS_DEBUG MATCHES "-fsanitize=(address|thread)")
  set(WHOLEHAND_SANITIZED ON)
  target_compile_options(wholehand_options INTERFACE
                         $<$<NOT:$<BOOL:$<TARGET_PROPERTY:WHOLEHAND_COMPUTES>>>:-O0>)
elseif(WHOLEHAND_QUICK)  # fortified functions of the C library need an optimising compiler
  target_compile_options(wholehand_options INTERFACE
                         "$<$<BOOL:$<TARGET_PROPERTY:WHOLEHAND_COLD>>:-O0;SHELL:-U _FORTIFY_SOURCE>")
endif()
function(wholehand_computes)
  set_target_properties(${ARGN} PROPERTIES WHOLEHAND_COMPUTES ON)
endfunction()
function(wholehand_cold)
  set_target_properties(${ARGN} PROPERTIES WHOLEHAND_COLD ON)
endfunction()
# wholehand_is_unoptimised(<target> <variable>)
function(wholehand_is_unoptimised target variable)
  get_target_property(computes ${target} WHOLEHAND_COMPUTES)
  get_target_property(cold ${target} WHOLEHAND_COLD)
  set(${variable} OFF PARENT_SCOPE)
  if((WHOLEHAND_SANITIZED AND NOT computes) OR (WHOLEHAND_QUICK AND NOT WHOLEHAND_SANITIZED AND cold))
    set(${variable} ON PARENT_SCOPE)
  endif()
endfunction()
function(wholehand_checked target)
  if(WHOLEHAND_FUZZ)
    target_compile_options(${target} PRIVATE -fsanitize-coverage=inline-8bit-counters,indirect-calls,trace-cmp,pc-table)
  endif()
  if(WHOLEHAND_HARDENED)
    target_compile_definitions(${target} PRIVATE $<$<CONFIG:Release>:_GLIBCXX_ASSERTIONS>)
  endif()
endfunction()

# Headers that most sources read (WHOLEHAND_PRECOMPILED).
set(often_read <Eigen/Core> <Eigen/Geometry> <algorithm> <array> <atomic> <chrono> <cmath>
    <condition_variable> <cstdint> <deque> <filesystem> <fstream> <functional> <limits> <map> <memory>
    <mutex> <numeric> <optional> <random> <set> <sstream> <string> <string_view> <thread>
    <unordered_map> <utility> <variant> <vector>)
set(often_read_own loop/core/axis_array.hpp loop/core/expected.hpp loop/core/geometry.hpp loop/core/tick_record.hpp)
function(wholehand_precompiled_headers target)
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/${target}.cpp CONTENT "// Precompiled headers.\n")
  add_library(${target} OBJECT EXCLUDE_FROM_ALL ${PROJECT_BINARY_DIR}/${target}.cpp)
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(${target} PRIVATE wholehand_options Eigen3::Eigen ${ARGN})
  list(TRANSFORM often_read_own PREPEND ${PROJECT_SOURCE_DIR}/src/ OUTPUT_VARIABLE own)
  target_precompile_headers(${target} PRIVATE ${often_read} ${own})
endfunction()
function(wholehand_precompiled_tests suffix)
  wholehand_precompiled_headers(wholehand_precompiled_tests${suffix} GTest::gtest)
  target_precompile_headers(wholehand_precompiled_tests${suffix} PRIVATE <gtest/gtest.h>)
endfunction()
function(wholehand_all_precompiled_headers suffix)
  set(all wholehand_precompiled${suffix} wholehand_precompiled_checked${suffix})
  wholehand_precompiled_headers(wholehand_precompiled${suffix})
  wholehand_precompiled_headers(wholehand_precompiled_checked${suffix})
  wholehand_checked(wholehand_precompiled_checked${suffix})
  if(WHOLEHAND_BUILD_TESTS)
    wholehand_precompiled_tests("${suffix}")
    list(APPEND all wholehand_precompiled_tests${suffix})
  endif()
  if(suffix)
    wholehand_cold(${all})
  else()
    wholehand_computes(${all})
  endif()
endfunction()
if(WHOLEHAND_PRECOMPILED)
  wholehand_all_precompiled_headers("")
  if(WHOLEHAND_SANITIZED OR WHOLEHAND_QUICK)
    wholehand_all_precompiled_headers(_unoptimised)
  endif()
endif()

# wholehand_read_precompiled(<target> <headers>): of its own optimisation. After wholehand_computes() and wholehand_cold().
function(wholehand_read_precompiled target headers)
  wholehand_is_unoptimised(${target} unoptimised)
  if(unoptimised)
    string(APPEND headers _unoptimised)
  endif()
  if(WHOLEHAND_PRECOMPILED)
    target_precompile_headers(${target} REUSE_FROM ${headers})
  endif()
endfunction()
