# What `cmake --install` puts where: the program, its documents, and the three libraries for find_package(umtet) and
# pkg-config. Three components, as Debian would pack them: program, development, python (python/CMakeLists.txt).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)  # tests and benchmarks are not packed: cpack need not build them
set(umtet_headers ${CMAKE_INSTALL_INCLUDEDIR}/umtet)  # mesh/ is no name to have in /usr/include
set(umtet_cmake ${CMAKE_INSTALL_LIBDIR}/cmake/umtet)

# Eigen aligns by the instruction set it is compiled for: what these archives allocate, a user's code has to free.
set(umtet_alignment 16)
if(UMTET_ARCH MATCHES "v3|v4|native")
  set(umtet_alignment 32)
endif()
set(umtet_definitions EIGEN_MAX_ALIGN_BYTES=${umtet_alignment} EIGEN_MAX_STATIC_ALIGN_BYTES=${umtet_alignment})

# A component is an archive, what it links (umtet-config.cmake finds it), and its file of targets. Whoever asks for the
# mesher alone needs none of the libraries behind the files.
set(umtet_components reconstruct mesh cloud_io mesh_io pipeline)
foreach(component IN LISTS umtet_components)
  set(library umtet_${component})
  set_target_properties(${library} PROPERTIES EXPORT_NAME ${component})
  target_compile_features(${library} INTERFACE cxx_std_20)
  foreach(definition IN LISTS umtet_definitions)
    target_compile_definitions(${library} INTERFACE $<INSTALL_INTERFACE:${definition}>)
  endforeach()
  install(TARGETS ${library} EXPORT umtet-${component}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
    INCLUDES DESTINATION ${umtet_headers})
  install(EXPORT umtet-${component} NAMESPACE umtet:: FILE umtet-${component}-targets.cmake
    DESTINATION ${umtet_cmake} COMPONENT development)
endforeach()
foreach(folder common reconstruct mesh pipeline)
  install(DIRECTORY ${folder} DESTINATION ${umtet_headers} COMPONENT development
    FILES_MATCHING PATTERN "*.h" PATTERN "*.def" PATTERN detail EXCLUDE PATTERN examples EXCLUDE PATTERN cli EXCLUDE
    PATTERN version.h EXCLUDE)
endforeach()

configure_package_config_file(cmake/umtet-config.cmake.in ${PROJECT_BINARY_DIR}/umtet-config.cmake
  INSTALL_DESTINATION ${umtet_cmake} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/umtet-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/umtet-config.cmake ${PROJECT_BINARY_DIR}/umtet-config-version.cmake
  DESTINATION ${umtet_cmake} COMPONENT development)

install(TARGETS umtet RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
install(FILES README.md CHANGELOG.md REFERENCES.bib DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
install(FILES docs/reference.md docs/promises.md DESTINATION ${CMAKE_INSTALL_DOCDIR}/docs COMPONENT program)
install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libumtet-dev COMPONENT development)
