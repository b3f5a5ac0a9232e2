# wholehand_module(<name> SOURCES a.cpp ... [USES core model ...] [VENDOR lib ...])
#
# One folder of src/ is one static library `wholehand_<name>` (alias wholehand::<name>); a nested
# folder a/b is wholehand_a_b, and USES takes it as a/b.
# Vendor libraries are linked PRIVATE: nothing of theirs shows in our headers.
function(wholehand_module name)
  cmake_parse_arguments(arg "" "" "SOURCES;USES;VENDOR" ${ARGN})
  string(REPLACE "/" "_" target ${name})
  add_library(wholehand_${target} STATIC ${arg_SOURCES})
  add_library(wholehand::${target} ALIAS wholehand_${target})
  # Our folders and our warnings are ours: a program that finds the installed package gets neither.
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
  if(name IN_LIST arithmetic_modules)
    target_compile_options(wholehand_${target} PRIVATE $<$<CONFIG:Release>:-O3>)
  elseif(name IN_LIST tick_modules)
    wholehand_read_precompiled(wholehand_${target} wholehand_precompiled)
  else()
    wholehand_precompile(wholehand_${target})
  endif()
endfunction()

# wholehand_precompile(<target>): it reads the headers that most sources need precompiled, and the
# standard library checks what it does (not for what the tick runs).
function(wholehand_precompile target)
  wholehand_checked(${target})
  wholehand_read_precompiled(${target} wholehand_precompiled_checked)
endfunction()

# wholehand_compile_alone(<source ...>): sources that take long to compile, or that share a private
# name with a neighbour, are never compiled together with others (WHOLEHAND_UNITY).
function(wholehand_compile_alone)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

# wholehand_compile_together(<target> <source ...>): sources that read the same costly headers are one
# compilation. The target's other sources form groups as usual (WHOLEHAND_UNITY). Call it after the
# target's wholehand_compile_alone().
function(wholehand_compile_together target)
  list(GET ARGN 0 group)
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

# wholehand_test(<name> SOURCES a.cpp ... USES core ... [LABEL unit] [TIMEOUT seconds] [SHARDS count]
#                [THREADED] [COMPUTES] [COMPUTES_IN_RELEASE])
#
# SHARDS: its tests wait more than they compute; so many of them run at once.
# COMPUTES: its own sources do long arithmetic, and are optimised. COMPUTES_IN_RELEASE: they are in a
# release build, and a sanitizer's run of them is drawn shorter. So are labels that measure.
# THREADED: ./check runs it under ThreadSanitizer too. LABEL realtime: it measures in real time, nothing
# runs beside it. LABEL paced: it runs in real time and mostly sleeps; compilers of the lowest priority
# may run beside it. LABEL figure: it measures at length what other tests drive through the same code; no
# sanitizer sees it.
function(wholehand_test name)
  cmake_parse_arguments(arg "THREADED;COMPUTES;COMPUTES_IN_RELEASE" "LABEL;TIMEOUT;SHARDS" "SOURCES;USES;VENDOR" ${ARGN})
  add_executable(test_${name} ${arg_SOURCES})
  target_link_libraries(test_${name} PRIVATE wholehand_options GTest::gtest GTest::gtest_main
                                             ${arg_VENDOR})
  target_include_directories(test_${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  if(arg_COMPUTES)
    wholehand_computes(test_${name})
  elseif(CMAKE_BUILD_TYPE STREQUAL Release AND NOT arg_COMPUTES_IN_RELEASE AND NOT arg_LABEL MATCHES "realtime|paced|figure")
    wholehand_unoptimised(test_${name})
  endif()
  foreach(used IN LISTS arg_USES)
    string(REPLACE "/" "_" used ${used})
    target_link_libraries(test_${name} PRIVATE wholehand::${used})
  endforeach()
  target_compile_definitions(test_${name} PRIVATE WHOLEHAND_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                                                  WHOLEHAND_BINARY_DIR="${PROJECT_BINARY_DIR}")
  wholehand_read_precompiled(test_${name} wholehand_precompiled_tests)
  if(NOT arg_LABEL)
    set(arg_LABEL unit)
  endif()
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 300)  # ends what hangs, not what is slow on a full machine
  endif()
  if(WHOLEHAND_FULL_TESTS)
    math(EXPR arg_TIMEOUT "${arg_TIMEOUT} * 30")
  endif()
  if(CMAKE_BUILD_TYPE STREQUAL Debug AND CMAKE_CXX_FLAGS_DEBUG MATCHES "-fsanitize|--coverage")
    math(EXPR arg_TIMEOUT "${arg_TIMEOUT} * 5")
  endif()
  if(arg_SHARDS)
    add_test(NAME ${name} COMMAND ${PROJECT_SOURCE_DIR}/cmake/run_shards.sh ${arg_SHARDS}
                                  $<TARGET_FILE:test_${name}>)
  else()
    add_test(NAME ${name} COMMAND test_${name})
  endif()
  set_tests_properties(${name} PROPERTIES LABELS ${arg_LABEL} TIMEOUT ${arg_TIMEOUT})
  if(arg_LABEL STREQUAL realtime)
    set_tests_properties(${name} PROPERTIES RUN_SERIAL ON)
  endif()
  if(WHOLEHAND_FULL_TESTS)
    set_tests_properties(${name} PROPERTIES ENVIRONMENT WHOLEHAND_FULL=1)
  endif()
  if(arg_THREADED)
    set_property(TEST ${name} APPEND PROPERTY LABELS threaded)
  endif()
endfunction()
