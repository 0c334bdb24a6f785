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
install(DIRECTORY config/ DESTINATION ${CMAKE_INSTALL_DATADIR}/nodmap/config PATTERN *.rules EXCLUDE)
install(FILES config/kurt3d/nodmap.rules DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples)
# With procman/sim.pmd: the simulated robot without the sources.
install(DIRECTORY sim/worlds DESTINATION ${CMAKE_INSTALL_DATADIR}/nodmap/sim)
# What who uses the robot reads, in the folders of the repository, so that the links lead from one to the other.
install(FILES README.md SAFETY.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES docs/frames.md docs/glossary.md docs/multi-host.md docs/own-robot.md docs/quickstart.md DESTINATION ${CMAKE_INSTALL_DOCDIR}/docs)
foreach(folder procman lcmtypes tools drivers/laser3d)
  install(FILES ${folder}/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR}/${folder})
endforeach()
# As Debian wants them: the licence as "copyright", the changes in its own format.
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright)
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)  # of $SOURCE_DATE_EPOCH where that is set
configure_file(cmake/debian_changelog.in ${PROJECT_BINARY_DIR}/packaging/changelog @ONLY)

# Man pages and bash completions, from what each program says of itself.
find_program(NODMAP_GZIP gzip REQUIRED)
set(manuals ${PROJECT_BINARY_DIR}/packaging/manuals)
add_custom_command(OUTPUT ${manuals}/made
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${manuals}
  COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/scripts/make_man_pages.py ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${manuals} ${NODMAP_PROGRAMS}
  COMMAND ${NODMAP_GZIP} -9n -r ${manuals}/man1
  COMMAND sh -c "${NODMAP_GZIP} -9nc ${PROJECT_BINARY_DIR}/packaging/changelog > ${manuals}/changelog.gz"
  COMMAND ${CMAKE_COMMAND} -E touch ${manuals}/made
  DEPENDS ${NODMAP_PROGRAMS} ${PROJECT_SOURCE_DIR}/scripts/make_man_pages.py ${PROJECT_BINARY_DIR}/packaging/changelog
  COMMENT "Writing man pages and completions" VERBATIM)
add_custom_target(manuals ALL DEPENDS ${manuals}/made)
add_dependencies(programs manuals)
install(DIRECTORY ${manuals}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} OPTIONAL)
install(DIRECTORY ${manuals}/completions DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion OPTIONAL)
install(FILES ${manuals}/changelog.gz DESTINATION ${CMAKE_INSTALL_DOCDIR} OPTIONAL)
install(FILES lcmtypes/README.md DESTINATION share/lcmtypes RENAME nodmap.README.md)

# Another project: find_package(nodmap), then link nodmap::lcmtypes for the C++ types.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/nodmapConfigVersion.cmake COMPATIBILITY SameMajorVersion
  ARCH_INDEPENDENT)
configure_file(cmake/nodmapConfig.cmake.in ${PROJECT_BINARY_DIR}/nodmapConfig.cmake @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/nodmapConfig.cmake ${PROJECT_BINARY_DIR}/nodmapConfigVersion.cmake
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
  # Debian wants another name for a jar, but lcmtypes_*.jar is the one that tools of LCM look for.
  install(FILES cmake/lintian_overrides DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides RENAME nodmap)
else()
  message(STATUS "No Java compiler or no liblcm-java: the package will hold no types for lcm-spy")
endif()

install(FILES procman/systemd/nodmap-deputy.service procman/systemd/nodmap-robot.service DESTINATION lib/systemd/system)
install(FILES procman/systemd/deputy.conf DESTINATION ${CMAKE_INSTALL_DATADIR}/nodmap)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME nodmap)
set(CPACK_PACKAGE_CONTACT "nodmap maintainers <maintainers@nodmap.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "3D sensing, navigation and SLAM with one nodding 2D laser")
set(CPACK_PACKAGE_DESCRIPTION
  "Independent processes that exchange LCM messages: drivers for a SICK laser\non a nodding mount and a KURT2 base, obstacle and structure maps,\nnavigation, SLAM in 2D and 3D, a logger, a page for the browser, a\nsimulator, and a process manager for one host or several.")
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
