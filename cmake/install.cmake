# find_package(gust) after `cmake --install`: link gust::study, gust::report or less.
include(CMakePackageConfigHelpers)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/gust)
foreach(library fmt xxhash json toml sqlite zstd xsmm onnx_proto options)
  set_target_properties(gust_${library} PROPERTIES EXPORT_NAME ${library})
endforeach()
install(TARGETS gust_options EXPORT gust)
install(EXPORT gust NAMESPACE gust:: DESTINATION ${package})
install(DIRECTORY gust ${PROJECT_BINARY_DIR}/generated/gust DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
        FILES_MATCHING PATTERN "*.h" PATTERN "*.inc" PATTERN "cli" EXCLUDE)
install(FILES LICENSE TYPE DOC)
configure_package_config_file(cmake/gustConfig.cmake.in gustConfig.cmake INSTALL_DESTINATION ${package})
write_basic_package_version_file(gustConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/gustConfig.cmake ${PROJECT_BINARY_DIR}/gustConfigVersion.cmake DESTINATION ${package})
