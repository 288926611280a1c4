# Installation: `find_package(ricci)` gives ricci::kernels, ricci::io and ricci::engine; headers are included as in
# this tree ("kernels/surface_mesh.h"). The command line is installed as a program only.
include(CMakePackageConfigHelpers)
set(ricci_config_dir "${CMAKE_INSTALL_LIBDIR}/cmake/ricci")

install(TARGETS ricci_kernels ricci_io ricci_engine EXPORT ricciTargets
    ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}")
install(TARGETS ricci RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}")
install(DIRECTORY kernels engine io DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/ricci"
    FILES_MATCHING PATTERN "*.h" PATTERN "engine/app" EXCLUDE PATTERN "engine/python" EXCLUDE)
install(EXPORT ricciTargets NAMESPACE ricci:: DESTINATION "${ricci_config_dir}")

configure_package_config_file(cmake/ricciConfig.cmake.in "${PROJECT_BINARY_DIR}/ricciConfig.cmake"
    INSTALL_DESTINATION "${ricci_config_dir}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/ricciConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/ricciConfig.cmake" "${PROJECT_BINARY_DIR}/ricciConfigVersion.cmake"
    cmake/RicciLibraryDependencies.cmake DESTINATION "${ricci_config_dir}")

# Installs to a scratch prefix and builds a program against it. A sanitized library asks its consumers for the
# sanitizer too, which the package does not export.
if(RICCI_TESTS AND NOT RICCI_SANITIZE)
    add_test(NAME install COMMAND "${CMAKE_COMMAND}"
        "-DBUILD_DIR=${PROJECT_BINARY_DIR}" "-DCONSUMER_DIR=${PROJECT_SOURCE_DIR}/tests/install"
        "-DWORK_DIR=${PROJECT_BINARY_DIR}/tests/install" "-DGENERATOR=${CMAKE_GENERATOR}"
        "-DCXX_COMPILER=${CMAKE_CXX_COMPILER}" "-DBUILD_TYPE=${CMAKE_BUILD_TYPE}"
        -P "${PROJECT_SOURCE_DIR}/tests/install/install_test.cmake")
endif()
