# `cmake --install build` and find_package(Stroma).
include(CMakePackageConfigHelpers)
set(STROMA_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/Stroma)
install(TARGETS stroma RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS stroma_library stroma_image EXPORT StromaTargets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY include/stroma DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY parameters DESTINATION ${CMAKE_INSTALL_DATADIR}/stroma)
install(DIRECTORY contrib/plot DESTINATION ${CMAKE_INSTALL_DATADIR}/stroma FILES_MATCHING PATTERN "*.py")
# Where the program finds them: in the source tree, or seen from the installed program.
set_source_files_properties(${PROJECT_SOURCE_DIR}/source/studies/picture.cc PROPERTIES COMPILE_DEFINITIONS
  "STROMA_PLOT_DIR=\"${PROJECT_SOURCE_DIR}/contrib/plot\";STROMA_INSTALLED_PLOT_DIR=\"../${CMAKE_INSTALL_DATADIR}/stroma/plot\"")
install(EXPORT StromaTargets NAMESPACE Stroma:: DESTINATION ${STROMA_CMAKE_DIR})
configure_package_config_file(contrib/cmake/StromaConfig.cmake.in ${CMAKE_BINARY_DIR}/StromaConfig.cmake
  INSTALL_DESTINATION ${STROMA_CMAKE_DIR})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/StromaConfigVersion.cmake COMPATIBILITY SameMajorVersion)
install(FILES ${CMAKE_BINARY_DIR}/StromaConfig.cmake ${CMAKE_BINARY_DIR}/StromaConfigVersion.cmake
  DESTINATION ${STROMA_CMAKE_DIR})
