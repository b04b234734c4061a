# `cmake --install`: the core as a library for others (find_package(meshfront), target meshfront::core, headers as
# include/meshfront/core/…), and the programs.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/meshfront)

install(TARGETS meshfront_core EXPORT meshfront ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT core)
set_target_properties(meshfront_core PROPERTIES EXPORT_NAME core)
install(DIRECTORY ${CMAKE_SOURCE_DIR}/core DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/meshfront COMPONENT core
  FILES_MATCHING PATTERN "*.h")
install(EXPORT meshfront NAMESPACE meshfront:: DESTINATION ${package} COMPONENT core)

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/meshfront-config.cmake.in
  ${CMAKE_CURRENT_BINARY_DIR}/meshfront-config.cmake INSTALL_DESTINATION ${package})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/meshfront-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/meshfront-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/meshfront-config-version.cmake
  DESTINATION ${package} COMPONENT core)

foreach(program meshfront meshfrontd)
  if(TARGET ${program})
    install(TARGETS ${program} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT programs)
  endif()
endforeach()
