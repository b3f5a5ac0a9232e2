# wholehand_module(<name> SOURCES a.cpp ... [USES core model ...] [VENDOR lib ...])
#
# A folder of src/ is a static library `wholehand_<name>` (alias wholehand::<name>). A nested folder a/b is
# wholehand_a_b; USES takes it as a/b. Vendor libraries are linked PRIVATE: none of their types appears in our headers.
function(wholehand_module name)
  cmake_parse_arguments(arg "" "" "SOURCES;USES;VENDOR" ${ARGN})
  string(REPLACE "/" "_" target ${name})
  add_library(wholehand_${target} STATIC ${arg_SOURCES})
  add_library(wholehand::${target} ALIAS wholehand_${target})
  # Include folders and warnings are for this build only; users of the installed package get neither.
  target_include_directories(wholehand_${target} PUBLIC
                             $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>)
  target_link_libraries(wholehand_${target} PUBLIC $<BUILD_INTERFACE:wholehand_options>
                                                   Eigen3::Eigen)
  foreach(used IN LISTS arg_USES)
    string(REPLACE "/" "_" used ${used})
    target_link_libraries(wholehand_${target} PUBLIC wholehand::${used})
  endforeach()
  target_link_libraries(wholehand_${target} PRIVATE ${arg_VENDOR})
  if(name IN_LIST computing_modules)
    wholehand_computes(wholehand_${target})
  endif()
  if(name MATCHES ${cold_modules})
    wholehand_cold(wholehand_${target})
  endif()
  wholehand_is_unoptimised(wholehand_${target} unoptimised)
  if(NOT unoptimised)
    set_property(GLOBAL APPEND PROPERTY wholehand_optimised ${name})
  endif()
  if(name IN_LIST arithmetic_modules)
    target_compile_options(wholehand_${target} PRIVATE $<$<CONFIG:Release>:-O3>)
  elseif(name MATCHES ${tick_modules})
    wholehand_read_precompiled(wholehand_${target} wholehand_precompiled)
  else()
    wholehand_precompile(wholehand_${target})
  endif()
endfunction()

# wholehand_headers(<name> USES ...): a module that consists only of headers.
function(wholehand_headers name)
  cmake_parse_arguments(arg "" "" "USES" ${ARGN})
  string(REPLACE "/" "_" target ${name})
  add_library(wholehand_${target} INTERFACE)
  add_library(wholehand::${target} ALIAS wholehand_${target})
  foreach(used IN LISTS arg_USES)
    string(REPLACE "/" "_" used ${used})
    target_link_libraries(wholehand_${target} INTERFACE wholehand::${used})
  endforeach()
endfunction()

# wholehand_precompile(<target>): uses precompiled headers, with the checks of the standard library (not for code of the
# tick).
function(wholehand_precompile target)
  wholehand_checked(${target})
  wholehand_read_precompiled(${target} wholehand_precompiled_checked)
endfunction()

# wholehand_compile_alone(<source ...>): for sources that take long to compile, or that share a private name with a
# neighbour. They are never compiled together with others (WHOLEHAND_UNITY).
function(wholehand_compile_alone)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

# wholehand_compile_together(<target> <source ...>): compiles sources that read the same costly headers together. The
# target's other sources form groups as usual (WHOLEHAND_UNITY). Call it after the target's wholehand_compile_alone().
function(wholehand_compile_together target)
  list(GET ARGN 0 group)
  string(REPLACE / _ group ${group})  # it becomes a file name
  set_source_files_properties(${ARGN} PROPERTIES UNITY_GROUP ${group})
  get_target_property(sources ${target} SOURCES)
  set(others "")
  foreach(source IN LISTS sources)
    get_source_file_property(grouped ${source} UNITY_GROUP)
    get_source_file_property(alone ${source} SKIP_UNITY_BUILD_INCLUSION)
    if(NOT source IN_LIST ARGN AND NOT alone AND (NOT grouped OR grouped MATCHES "^batch_"))
      list(LENGTH others before)
      math(EXPR batch "${before} / ${CMAKE_UNITY_BUILD_BATCH_SIZE}")
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP batch_${batch})
      list(APPEND others ${source})
    endif()
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
endfunction()

# wholehand_test_program(<name> [LABEL unit] [SHARDS 2] [WATCHED]): the gtest program test_<name>. Folders of tests/ add
# their sources with wholehand_tests(<name> ...).
#
# LABEL: when it runs.
#   unit      with the program's objects, and under AddressSanitizer and UndefinedBehaviorSanitizer; with reduced
#             counts but for WHOLEHAND_FULL_TESTS
#   figure    release; long measurements of code that other tests also run
#   sessions  release, on the real clock; sleeps most of the time
#   realtime  release, on the real clock, with nothing else running
# SHARDS: number of processes that share its tests.
# WATCHED: uses the real clock. A failure while the machine delayed even a sleeping process is not judged
# (tests/support/watched_main.cpp).
function(wholehand_test_program name)
  cmake_parse_arguments(arg "WATCHED" "LABEL;SHARDS" "" ${ARGN})
  set(target test_${name})
  add_executable(${target})
  target_link_libraries(${target} PRIVATE wholehand_options GTest::gtest)
  if(arg_WATCHED)
    target_sources(${target} PRIVATE ${PROJECT_SOURCE_DIR}/tests/support/watched_main.cpp)
  else()
    target_link_libraries(${target} PRIVATE GTest::gtest_main)
  endif()
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  target_compile_definitions(${target} PRIVATE WHOLEHAND_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                                               WHOLEHAND_BINARY_DIR="${PROJECT_BINARY_DIR}")
  if(arg_LABEL STREQUAL unit)
    wholehand_cold(${target})
  endif()
  wholehand_read_precompiled(${target} wholehand_precompiled_tests)
  if(arg_LABEL STREQUAL unit AND CMAKE_BUILD_TYPE STREQUAL Release AND NOT WHOLEHAND_FULL_TESTS)
    set_target_properties(${target} PROPERTIES EXCLUDE_FROM_ALL ON)  # built by `./check`, part unit
  endif()
  set(filter "-*_slow*")
  if(WHOLEHAND_FULL_TESTS)
    set(filter "*")
  endif()
  set(counts "")
  if(arg_LABEL STREQUAL unit AND NOT WHOLEHAND_FULL_TESTS)
    set(counts WHOLEHAND_REDUCED_COUNTS=1)
  endif()
  math(EXPR last "${arg_SHARDS} - 1")
  foreach(shard RANGE ${last})
    set(test ${name})
    if(arg_SHARDS GREATER 1)
      math(EXPR number "${shard} + 1")
      set(test ${name}/${number})
    endif()
    add_test(NAME ${test} COMMAND ${target} --gtest_filter=${filter})
    # The timeout ends hanging tests; it leaves room for a busy machine.
    set_tests_properties(${test} PROPERTIES LABELS ${arg_LABEL} TIMEOUT ${WHOLEHAND_TEST_TIMEOUT_S}
      ENVIRONMENT "GTEST_TOTAL_SHARDS=${arg_SHARDS};GTEST_SHARD_INDEX=${shard};${counts};${WHOLEHAND_TEST_ENVIRONMENT}")
    if(arg_LABEL STREQUAL realtime)
      set_tests_properties(${test} PROPERTIES RUN_SERIAL ON)
    endif()
  endforeach()
endfunction()

# wholehand_link_first(<target> <module ...>): of an inline function that an unoptimised target and an optimised
# module have, the linker takes the one that it meets first. Sixty times as fast (docs/adr/0072). `rig` stands for
# all that a rig is made of.
function(wholehand_link_first target)
  wholehand_is_unoptimised(${target} unoptimised)
  if(NOT unoptimised)
    return()
  endif()
  get_property(optimised GLOBAL PROPERTY wholehand_optimised)
  set(modules ${ARGN})
  if(rig IN_LIST modules)
    set(below ${optimised})
    list(FILTER below INCLUDE REGEX "^(loop|lab|files|certify|exercises)(/|$)")
    list(FILTER below EXCLUDE REGEX "_counter$|^loop/(physics/analytic|psychometrics)$|^files/p")
    list(APPEND modules ${below})
  endif()
  foreach(module IN LISTS modules)
    if(module IN_LIST optimised)
      string(REPLACE "/" "_" module ${module})
      target_link_options(${target} PRIVATE
        "SHELL:-Wl,--whole-archive $<TARGET_FILE:wholehand_${module}> -Wl,--no-whole-archive")
    endif()
  endforeach()
endfunction()

# wholehand_tests(<program> SOURCES a.cpp ... [USES core ...] [VENDOR lib ...]): adds sources of this folder and the
# modules that they use.
function(wholehand_tests program)
  cmake_parse_arguments(arg "" "" "SOURCES;USES;VENDOR" ${ARGN})
  target_sources(test_${program} PRIVATE ${arg_SOURCES})
  foreach(used IN LISTS arg_USES)
    string(REPLACE "/" "_" target ${used})
    target_link_libraries(test_${program} PRIVATE wholehand::${target})
  endforeach()
  if(NOT program STREQUAL third_exercise)  # it has a function of its own in place of ours
    wholehand_link_first(test_${program} ${arg_USES})
  endif()
  target_link_libraries(test_${program} PRIVATE ${arg_VENDOR})
endfunction()

# wholehand_script_test(<name> LABEL <label> COMMAND ... [TIMEOUT seconds] [ENVIRONMENT ...] [SERIAL]): a test that is a
# script. Exit code 77 means that a tool is not installed.
function(wholehand_script_test name)
  cmake_parse_arguments(arg "SERIAL" "" "LABEL;COMMAND;ENVIRONMENT" ${ARGN})
  add_test(NAME ${name} COMMAND ${arg_COMMAND} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
  set_tests_properties(${name} PROPERTIES LABELS "${arg_LABEL}" TIMEOUT ${WHOLEHAND_TEST_TIMEOUT_S}
    SKIP_RETURN_CODE 77 ENVIRONMENT "${arg_ENVIRONMENT};${WHOLEHAND_TEST_ENVIRONMENT}")
  if(arg_SERIAL)
    set_tests_properties(${name} PROPERTIES RUN_SERIAL ON)
  endif()
endfunction()
