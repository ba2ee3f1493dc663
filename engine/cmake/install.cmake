# cmake --install, the library's part (component development): lib/liblucerna_*.a, include/lucerna and what
# find_package(lucerna) reads.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/lucerna)
install(TARGETS ${lucerna_layers} EXPORT lucerna-targets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
        INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/lucerna)
set_target_properties(lucerna_engine PROPERTIES EXPORT_NAME engine)
install(EXPORT lucerna-targets NAMESPACE lucerna:: DESTINATION ${package_dir} COMPONENT development)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/engine/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/lucerna COMPONENT development
        FILES_MATCHING PATTERN "*.hpp" PATTERN cmake EXCLUDE)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/shaders/shared
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/lucerna COMPONENT development FILES_MATCHING PATTERN "*.h")

# The configuration finds its prefix from where it lies, so that a prefix may be moved.
set(LUCERNA_INSTALL_DATA_DIR ${CMAKE_INSTALL_DATADIR}/lucerna)
set(config ${CMAKE_CURRENT_BINARY_DIR}/lucerna-config.cmake)
set(config_version ${CMAKE_CURRENT_BINARY_DIR}/lucerna-config-version.cmake)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/lucerna-config.cmake.in ${config}
                              INSTALL_DESTINATION ${package_dir} PATH_VARS LUCERNA_INSTALL_DATA_DIR)
write_basic_package_version_file(${config_version} COMPATIBILITY SameMinorVersion)
install(FILES ${config} ${config_version} DESTINATION ${package_dir} COMPONENT development)
