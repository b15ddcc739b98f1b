# The headers, the CMake package and the pkg-config file. Nothing here depends on the
# architecture, so everything goes below share/, and nothing names the prefix, so an installed
# tree can be moved.
include(CMakePackageConfigHelpers)

set(slamgc_cmake_dir "${CMAKE_INSTALL_DATADIR}/cmake/slamgc")
set(slamgc_pc_dir "${CMAKE_INSTALL_DATADIR}/pkgconfig")

install(DIRECTORY include/ DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" FILES_MATCHING PATTERN "*.hpp")

install(TARGETS slamgc EXPORT slamgc)
install(EXPORT slamgc NAMESPACE slamgc:: FILE slamgc-targets.cmake DESTINATION "${slamgc_cmake_dir}")
configure_package_config_file(cmake/slamgc-config.cmake.in slamgc-config.cmake
  INSTALL_DESTINATION "${slamgc_cmake_dir}")
# While the major version is 0, a new minor version may break the interface.
write_basic_package_version_file(slamgc-config-version.cmake
  VERSION "${PROJECT_VERSION}" COMPATIBILITY SameMinorVersion ARCH_INDEPENDENT)
install(FILES
  "${CMAKE_CURRENT_BINARY_DIR}/slamgc-config.cmake"
  "${CMAKE_CURRENT_BINARY_DIR}/slamgc-config-version.cmake"
  DESTINATION "${slamgc_cmake_dir}")

# From the .pc file to the prefix, however deep CMAKE_INSTALL_DATADIR is.
file(RELATIVE_PATH slamgc_pc_to_prefix
  "${CMAKE_INSTALL_PREFIX}/${slamgc_pc_dir}" "${CMAKE_INSTALL_PREFIX}")
configure_file(cmake/slamgc.pc.in slamgc.pc @ONLY)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/slamgc.pc" DESTINATION "${slamgc_pc_dir}")
