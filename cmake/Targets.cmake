# SPDX-License-Identifier: BSD-3-Clause
# The one warnings target, and the functions that make a library, a program, a test or a benchmark.

add_library(nodmap_options INTERFACE)
target_include_directories(nodmap_options INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_definitions(nodmap_options INTERFACE NODMAP_VERSION="${PROJECT_VERSION}")
target_compile_options(nodmap_options INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual
  -Wold-style-cast -Wdouble-promotion
  # The same log gives the same bytes on every machine: no fused operations chosen by the compiler.
  -ffp-contract=off
  # g++ collects its garbage later: a tenth less time, a fifth more memory.
  $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=500000;--param=ggc-min-expand=1000>
  $<$<BOOL:${NODMAP_WERROR}>:-Werror>)
if(NODMAP_SANITIZE)
  target_compile_options(nodmap_options INTERFACE
    -fsanitize=${NODMAP_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(nodmap_options INTERFACE -fsanitize=${NODMAP_SANITIZE})
endif()
if(NODMAP_FUZZ AND NOT CMAKE_CXX_COMPILER_ID MATCHES Clang)
  message(FATAL_ERROR "NODMAP_FUZZ needs clang: -DCMAKE_CXX_COMPILER=clang++")
endif()
if(NODMAP_COVERAGE)
  target_compile_options(nodmap_options INTERFACE --coverage)
  target_link_options(nodmap_options INTERFACE --coverage)
endif()

# Most of a compilation is reading headers, so those that nearly every source includes are read once: the standard library
# and Eigen for what is shipped, CLI11 besides for programs, GoogleTest for tests. A source still includes what it uses.
# Tests are not measured and are compiled with -O1, which takes half the time of -O3.
target_link_libraries(nodmap_options INTERFACE Threads::Threads)
target_compile_options(nodmap_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
# LCM's own options say -pthread, and neither compiler takes a precompiled header that was made without it: so every target is told.
target_compile_options(nodmap_options INTERFACE -pthread)
file(WRITE ${PROJECT_BINARY_DIR}/pch.cpp "")
function(nodmap_add_precompiled_headers name)
  add_library(${name} OBJECT ${PROJECT_BINARY_DIR}/pch.cpp)
  target_link_libraries(${name} PRIVATE nodmap_options Eigen3::Eigen)
  target_precompile_headers(${name} PRIVATE <algorithm> <array> <chrono> <cmath> <cstdint> <filesystem> <functional> <map> <memory>
    <optional> <random> <span> <sstream> <stdexcept> <string> <vector> <Eigen/Core> <Eigen/Geometry> ${ARGN})
endfunction()
nodmap_add_precompiled_headers(nodmap_pch)
nodmap_add_precompiled_headers(nodmap_program_pch <CLI/CLI.hpp> <iostream>)
target_link_libraries(nodmap_program_pch PRIVATE CLI11::CLI11)
target_compile_options(nodmap_program_pch PRIVATE $<$<CONFIG:Release>:-O1>)
if(NODMAP_TESTS)
  nodmap_add_precompiled_headers(nodmap_test_pch <fstream> <gmock/gmock.h> <gtest/gtest.h>)
  target_link_libraries(nodmap_test_pch PRIVATE GTest::gmock GTest::gtest)
  target_compile_options(nodmap_test_pch PRIVATE $<$<CONFIG:Release>:-O1>)
endif()

# nodmap_join_sources(TARGET): up to sixteen of its sources are compiled as one.
function(nodmap_join_sources name)
  if(NODMAP_JOIN)
    set_target_properties(${name} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 16)
    # g++ takes a joined source for a header, in which a class with a member of an unnamed namespace would be a mistake.
    target_compile_options(${name} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  endif()
endfunction()

# nodmap_add_library(NAME SOURCES a.cpp ... DEPENDS target ... [SEPARATE] [COLD]): the library nodmap::NAME. Its sources are joined, as
# loading the same headers takes as long as most of them; what is unnamed in them must have names that differ. SEPARATE: not so.
# COLD: most of it runs once or seldom, so that it is compiled with -O1.
function(nodmap_add_library name)
  cmake_parse_arguments(ARG "SEPARATE;COLD" "" "SOURCES;DEPENDS" ${ARGN})
  add_library(nodmap_${name} STATIC ${ARG_SOURCES})
  add_library(nodmap::${name} ALIAS nodmap_${name})
  target_link_libraries(nodmap_${name} PUBLIC nodmap_options Eigen3::Eigen ${ARG_DEPENDS})
  if(ARG_COLD)
    target_precompile_headers(nodmap_${name} REUSE_FROM nodmap_program_pch)
    target_link_libraries(nodmap_${name} PRIVATE CLI11::CLI11)
    target_compile_options(nodmap_${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  else()
    target_precompile_headers(nodmap_${name} REUSE_FROM nodmap_pch)
  endif()
  if(NOT ARG_SEPARATE)
    nodmap_join_sources(nodmap_${name})
  endif()
endfunction()

# nodmap_add_program(nodmap-NAME SOURCES main.cpp DEPENDS target ...): a program in bin/.
function(nodmap_add_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE nodmap_options ${ARG_DEPENDS})
  target_precompile_headers(${name} REUSE_FROM nodmap_program_pch)
  # Its main.cpp reads the command line, once: nothing to optimise.
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  install(TARGETS ${name} RUNTIME)
  set_property(GLOBAL APPEND PROPERTY NODMAP_PROGRAMS ${name})
endfunction()

# Test programs of what runs in more than one thread, for ThreadSanitizer.
add_custom_target(threaded_tests)

# nodmap_add_test_program(NAME SOURCES x_test.cpp ... DEPENDS target ... [DEFINES NAME="value" ...]): a program with GoogleTest's main().
function(nodmap_add_test_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS;DEFINES" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  nodmap_join_sources(${name})
  target_link_libraries(${name} PRIVATE nodmap_options ${ARG_DEPENDS} GTest::gmock GTest::gtest_main)
  target_precompile_headers(${name} REUSE_FROM nodmap_test_pch)
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  target_compile_definitions(${name} PRIVATE ${ARG_DEFINES})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests)
endfunction()

# nodmap_add_test(NAME SOURCES x_test.cpp ... DEPENDS target ... [DEFINES NAME="value" ...] [DATA] [THREADS] [LONG]): a test
# program, each of whose tests is one of CTest's. DATA marks tests that read the recordings in NODMAP_DATA; they skip, and say so, where
# it is missing. THREADS marks those that also run under ThreadSanitizer. LONG marks whole drives: they begin before the short tests, so
# that no processor waits for the last of them.
function(nodmap_add_test name)
  cmake_parse_arguments(ARG "DATA;THREADS;LONG" "" "SOURCES;DEPENDS;DEFINES" ${ARGN})
  if(NOT NODMAP_TESTS)
    return()
  endif()
  nodmap_add_test_program(${name} SOURCES ${ARG_SOURCES} DEPENDS ${ARG_DEPENDS} DEFINES ${ARG_DEFINES})
  set(label unit)
  if(ARG_DATA)
    set(label data)
  endif()
  if(ARG_THREADS)
    set(label ${label}-threads)  # a list does not survive gtest_discover_tests()
    add_dependencies(threaded_tests ${name})
  endif()
  set(timeout_s 1800)  # for a test that hangs: with sanitizers on a busy machine one of a minute takes ten
  set(cost 0)
  if(ARG_LONG)
    set(cost 1500)
  endif()
  # memq:// keeps every test off the network, whatever it forgets to say.
  # Without the values of parameters, which print as bytes: they have names.
  gtest_discover_tests(${name} NO_PRETTY_VALUES DISCOVERY_TIMEOUT 60 PROPERTIES
    LABELS ${label} TIMEOUT ${timeout_s} COST ${cost} ENVIRONMENT "LCM_DEFAULT_URL=memq://")
endfunction()

# nodmap_test_starts(NAME program ...): the test program NAME, or CTest's test NAME, starts these programs. They are built before it, and
# ./nodmap test runs it again when one of them has changed.
function(nodmap_test_starts name)
  if(TARGET ${name})
    add_dependencies(${name} ${ARGN})
  endif()
  string(JOIN " " line ${name} ${ARGN})
  set_property(GLOBAL APPEND PROPERTY NODMAP_TEST_STARTS ${line})
endfunction()

# nodmap_set_process_test(NAME [LIGHT|ROBOT]): marks a test of CTest's that runs processes. It counts as three of the jobs that
# CTest runs at once, or as one if it is LIGHT: one that mostly waits. ROBOT marks a whole robot in real time. Its drivers and navigator have
# real-time priority, so that two robots at once would leave the other processes too little of two processors: robots run one after
# another, and each counts as five jobs. The robots begin first, then the heavy ones, since CTest keeps no places free for them, then the
# light ones, because they last longer than others. A test may start every program, unless nodmap_test_starts() says which.
# The time limit is for a test that hangs; on a busy machine one of a minute has lasted for more than five.
function(nodmap_set_process_test name)
  cmake_parse_arguments(ARG "LIGHT;ROBOT" "" "" ${ARGN})
  set(jobs 3)
  set(cost 2000)
  if(ARG_LIGHT)
    set(jobs 1)
    set(cost 1000)
  elseif(ARG_ROBOT)
    set(jobs 5)
    set(cost 3000)
    set_tests_properties(${name} PROPERTIES RESOURCE_LOCK robot)
  endif()
  set_tests_properties(${name} PROPERTIES LABELS integration TIMEOUT 1200 SKIP_RETURN_CODE 77 PROCESSORS ${jobs} COST ${cost})
endfunction()

# All programs that measure. The default target leaves them out: nobody who builds the programs or runs the tests waits for them.
add_custom_target(benchmarks)

# nodmap_add_bench_program(NAME SOURCES x.cpp ... DEPENDS target ... [COLD]): a program that measures, in bin/ beside the others, but not
# installed. COLD: it measures other processes, so that it is compiled with -O1.
function(nodmap_add_bench_program name)
  cmake_parse_arguments(ARG "COLD" "" "SOURCES;DEPENDS" ${ARGN})
  add_executable(${name} EXCLUDE_FROM_ALL ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE nodmap_options Eigen3::Eigen ${ARG_DEPENDS})
  if(ARG_COLD)
    target_precompile_headers(${name} REUSE_FROM nodmap_program_pch)
    target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  else()
    target_precompile_headers(${name} REUSE_FROM nodmap_pch)
  endif()
  add_dependencies(benchmarks ${name})
endfunction()

# nodmap_add_benchmark(NAME SOURCES x_bench.cpp DEPENDS target ...): a Google Benchmark program, in bench/.
function(nodmap_add_benchmark name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  nodmap_add_bench_program(${name} SOURCES ${ARG_SOURCES} DEPENDS ${ARG_DEPENDS} benchmark::benchmark_main)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bench)
endfunction()
