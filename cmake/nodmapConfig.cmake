# SPDX-License-Identifier: BSD-3-Clause
# nodmap's message types for other projects: find_package(nodmap REQUIRED), then link nodmap::lcmtypes. The headers include
# <lcm/lcm_coretypes.h>, of Debian's liblcm-dev. nodmap_LCM_DIR holds the .lcm files, for other languages.
get_filename_component(nodmap_PREFIX "${CMAKE_CURRENT_LIST_DIR}" ABSOLUTE)
# lib/cmake/nodmap, or lib/ARCHITECTURE/cmake/nodmap as Debian has it
while(NOT EXISTS "${nodmap_PREFIX}/include/nodmap/scan_t.hpp" AND NOT nodmap_PREFIX STREQUAL "/")
  get_filename_component(nodmap_PREFIX "${nodmap_PREFIX}" DIRECTORY)
endwhile()
if(NOT EXISTS "${nodmap_PREFIX}/include/nodmap/scan_t.hpp")
  set(nodmap_FOUND FALSE)
  set(nodmap_NOT_FOUND_MESSAGE "no include/nodmap/scan_t.hpp above ${CMAKE_CURRENT_LIST_DIR}")
  return()
endif()
set(nodmap_LCM_DIR "${nodmap_PREFIX}/share/lcmtypes")
if(NOT TARGET nodmap::lcmtypes)
  add_library(nodmap::lcmtypes INTERFACE IMPORTED)
  set_target_properties(nodmap::lcmtypes PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${nodmap_PREFIX}/include" INTERFACE_LINK_LIBRARIES lcm)
endif()
