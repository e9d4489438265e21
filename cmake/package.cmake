include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/impactrig)
configure_package_config_file(cmake/impactrig-config.cmake.in
  ${PROJECT_BINARY_DIR}/impactrig-config.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/impactrig-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(EXPORT impactrig-targets NAMESPACE impactrig:: DESTINATION ${package_dir})
install(FILES
  ${PROJECT_BINARY_DIR}/impactrig-config.cmake
  ${PROJECT_BINARY_DIR}/impactrig-config-version.cmake
  cmake/dependencies.cmake
  cmake/FindLibZip.cmake
  cmake/FindSndFile.cmake
  cmake/FindUDUNITS2.cmake
  DESTINATION ${package_dir})
install(DIRECTORY datasets/samples DESTINATION ${CMAKE_INSTALL_DATADIR}/impactrig)
