# SPDX-License-Identifier: BSD-3-Clause
# `cmake --install build/release --prefix DIR`, and `cpack` in the build folder for a .deb. Everything lies relative to
# the prefix:
#   bin/  include/{nodmap,procman_lcm}/  lib/cmake/nodmap/  share/lcmtypes/  share/java/  share/nodmap/  share/doc/nodmap/
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(DIRECTORY ${PROJECT_BINARY_DIR}/lcmtypes/include/nodmap ${PROJECT_BINARY_DIR}/lcmtypes/include/procman_lcm
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*_t.hpp")
install(FILES procman/robot.pmd procman/replay.pmd procman/sim.pmd procman/two_hosts.pmd
  DESTINATION ${CMAKE_INSTALL_DATADIR}/nodmap/procman)
install(DIRECTORY config/ DESTINATION ${CMAKE_INSTALL_DATADIR}/nodmap/config)
install(FILES README.md LICENSE docs/frames.md docs/multi-host.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES lcmtypes/README.md DESTINATION share/lcmtypes RENAME nodmap.README.md)

# Another project: find_package(nodmap), then link nodmap::lcmtypes for the C++ types.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/nodmapConfigVersion.cmake COMPATIBILITY SameMajorVersion
  ARCH_INDEPENDENT)
install(FILES cmake/nodmapConfig.cmake ${PROJECT_BINARY_DIR}/nodmapConfigVersion.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/nodmap)

# The types for lcm-spy, where a Java compiler is: found by lcm-spy in share/java, as is the custom.
find_program(NODMAP_JAVAC javac)
find_program(NODMAP_JAR jar)
if(NODMAP_JAVAC AND NODMAP_JAR AND EXISTS /usr/share/java/lcm.jar)
  set(jar ${PROJECT_BINARY_DIR}/lcmtypes_nodmap.jar)
  get_property(type_files GLOBAL PROPERTY NODMAP_LCM_FILES)
  add_custom_command(OUTPUT ${jar}
    COMMAND ${PROJECT_SOURCE_DIR}/cmake/types_jar.sh ${NODMAP_LCM_GEN} ${NODMAP_JAVAC} ${NODMAP_JAR} ${jar} ${type_files}
    DEPENDS ${type_files} ${PROJECT_SOURCE_DIR}/cmake/types_jar.sh
    COMMENT "Compiling the message types for Java" VERBATIM)
  add_custom_target(nodmap_types_jar ALL DEPENDS ${jar})
  install(FILES ${jar} DESTINATION ${CMAKE_INSTALL_DATADIR}/java OPTIONAL)
else()
  message(STATUS "No Java compiler or no liblcm-java: the package will hold no types for lcm-spy")
endif()

install(FILES procman/systemd/nodmap-deputy.service DESTINATION lib/systemd/system)
install(FILES procman/systemd/deputy.conf DESTINATION ${CMAKE_INSTALL_DATADIR}/nodmap)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME nodmap)
set(CPACK_PACKAGE_CONTACT "nodmap maintainers <nodmap@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
# The libraries by what the programs are linked to; besides them lcm-logplayer for replay.pmd, and the account's tool.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# What no library dependency shows: an account for the service, and what the viewer's page is made of.
set(CPACK_DEBIAN_PACKAGE_DEPENDS "passwd, libjs-three, libjs-dygraphs")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "liblcm-bin, iproute2")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "liblcm-java, liblcm-dev, chrony")
set(scripts ${PROJECT_SOURCE_DIR}/procman/systemd)
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${scripts}/postinst ${scripts}/prerm ${scripts}/postrm)
include(CPack)
