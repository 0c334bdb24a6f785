# SPDX-License-Identifier: BSD-3-Clause
# Every package from outside, found once. The Debian names are in the list `packages` of the script ./nodmap.

find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(CLI11 REQUIRED)
find_package(spdlog REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(PNG REQUIRED)
# Beast (HTTP, WebSocket) and Asio, which are headers only.
find_package(Boost 1.74 REQUIRED)
find_package(octomap 1.9 REQUIRED)
find_package(tsl-robin-map REQUIRED)
find_package(Python3 REQUIRED COMPONENTS Interpreter)
pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET libzstd)
pkg_check_modules(LIBSERIALPORT REQUIRED IMPORTED_TARGET libserialport)

# LCM 1.4 and newer bring a CMake package, Debian's 1.3.1 only a pkg-config file. A mere build folder of LCM registers itself with
# CMake for the user: it is not looked for, because it holds no whole LCM.
find_package(lcm CONFIG QUIET NO_CMAKE_PACKAGE_REGISTRY)
if(TARGET lcm)
  set(lcm_prefix ${lcm_DIR}/../../..)  # its package lies in lib/lcm/cmake
else()
  pkg_check_modules(LCM REQUIRED IMPORTED_TARGET lcm)
  add_library(lcm ALIAS PkgConfig::LCM)
  set(lcm_VERSION ${LCM_VERSION})
  set(lcm_prefix ${LCM_PREFIX})
endif()
find_program(NODMAP_LCM_GEN lcm-gen HINTS ${lcm_prefix}/bin REQUIRED)
# A generator of another installation writes code that these headers do not compile, with errors that do not say why.
execute_process(COMMAND ${NODMAP_LCM_GEN} --version OUTPUT_VARIABLE lcm_gen_version ERROR_QUIET)
string(REGEX MATCH "[0-9]+\\.[0-9]+" lcm_gen_version "${lcm_gen_version}")
string(REGEX MATCH "[0-9]+\\.[0-9]+" lcm_headers_version "${lcm_VERSION}")
if(lcm_gen_version AND lcm_headers_version AND NOT lcm_gen_version STREQUAL lcm_headers_version)
  message(FATAL_ERROR "LCM's headers are of version ${lcm_VERSION}, but the generator ${NODMAP_LCM_GEN} is of ${lcm_gen_version}: "
    "two installations of LCM are mixed. Name one of them: -DCMAKE_PREFIX_PATH=DIR -DNODMAP_LCM_GEN=DIR/bin/lcm-gen")
endif()

# OctoMap's package sets variables only.
add_library(nodmap_octomap INTERFACE)
target_include_directories(nodmap_octomap SYSTEM INTERFACE ${OCTOMAP_INCLUDE_DIRS})
target_link_libraries(nodmap_octomap INTERFACE ${OCTOMAP_LIBRARIES})

if(NODMAP_TESTS)
  find_package(GTest REQUIRED)
endif()
if(NODMAP_BENCH)
  find_package(benchmark REQUIRED)
endif()
