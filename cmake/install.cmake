# What `cmake --install` puts where: the program, its documents, and the three libraries for find_package(umtet) and
# pkg-config. Three components, as Debian would pack them: program, development, python (python/CMakeLists.txt).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)  # tests and benchmarks are not packed: cpack need not build them
set(umtet_headers ${CMAKE_INSTALL_INCLUDEDIR}/umtet)  # mesh/ is no name to have in /usr/include
set(umtet_cmake ${CMAKE_INSTALL_LIBDIR}/cmake/umtet)

# An archive is linked with what its code calls, and that is all: a user need not find PCL, or VTK with its MPI and Qt,
# whose own lists have 81 libraries. By the names that -l takes, for the config file and for pkg-config.
get_directory_property(vtk_major DIRECTORY mesh DEFINITION VTK_MAJOR_VERSION)
get_directory_property(vtk_minor DIRECTORY mesh DEFINITION VTK_MINOR_VERSION)
set(vtk vtkIOXML vtkIOCore vtkCommonExecutionModel vtkCommonDataModel vtkCommonMisc vtkCommonCore)
set(vtk_filters vtkFiltersCore)
foreach(list vtk vtk_filters)
  list(TRANSFORM ${list} APPEND -${vtk_major}.${vtk_minor})
endforeach()
set(umtet_reconstruct_links pcl_io pcl_common ${vtk} flann_cpp lz4 xxhash fmt tbb)
set(umtet_mesh_links OpenMeshCore hdf5_serial ${vtk} fmt tbb)
if(UMTET_WITH_GSL)
  list(APPEND umtet_mesh_links gsl gslcblas)
endif()
set(umtet_pipeline_links ${vtk_filters} ${vtk} tomlplusplus muparser ginac cln xxhash fmt tbb)
set(umtet_private_libraries ${umtet_reconstruct_links} ${umtet_mesh_links} ${umtet_pipeline_links})
list(REMOVE_DUPLICATES umtet_private_libraries)

# Eigen aligns by the instruction set it is compiled for: what these archives allocate, a user's code has to free.
set(umtet_alignment 16)
if(UMTET_ARCH MATCHES "v3|v4|native")
  set(umtet_alignment 32)
endif()
set(umtet_definitions EIGEN_MAX_ALIGN_BYTES=${umtet_alignment} EIGEN_MAX_STATIC_ALIGN_BYTES=${umtet_alignment})

foreach(part reconstruct mesh pipeline)
  set(library umtet_${part})
  get_target_property(links ${library} INTERFACE_LINK_LIBRARIES)
  set(kept)
  foreach(link IN LISTS links)
    if(link MATCHES "^(Eigen3|umtet|nlohmann_json)::")
      list(APPEND kept ${link})
    else()
      list(APPEND kept $<BUILD_INTERFACE:${link}>)
    endif()
  endforeach()
  set_target_properties(${library} PROPERTIES
    EXPORT_NAME ${part}
    INTERFACE_LINK_LIBRARIES "${kept};$<INSTALL_INTERFACE:${${library}_links}>")
  target_compile_features(${library} INTERFACE cxx_std_20)
  foreach(definition ${umtet_definitions})
    target_compile_definitions(${library} INTERFACE $<INSTALL_INTERFACE:${definition}>)
  endforeach()
  install(TARGETS ${library} EXPORT umtet
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
    INCLUDES DESTINATION ${umtet_headers})
  install(DIRECTORY ${part} DESTINATION ${umtet_headers} COMPONENT development
    FILES_MATCHING PATTERN "*.h" PATTERN detail EXCLUDE PATTERN examples EXCLUDE PATTERN command_line.h EXCLUDE
    PATTERN version.h EXCLUDE)
endforeach()
# Those of detail/ that public headers need; a test looks that there are no others.
install(FILES mesh/detail/id_set.h mesh/detail/psi_values.h DESTINATION ${umtet_headers}/mesh/detail COMPONENT development)
install(FILES reconstruct/detail/lanes.h DESTINATION ${umtet_headers}/reconstruct/detail COMPONENT development)

install(EXPORT umtet NAMESPACE umtet:: FILE umtet-targets.cmake DESTINATION ${umtet_cmake} COMPONENT development)
configure_package_config_file(cmake/umtet-config.cmake.in ${PROJECT_BINARY_DIR}/umtet-config.cmake
  INSTALL_DESTINATION ${umtet_cmake} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/umtet-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/umtet-config.cmake ${PROJECT_BINARY_DIR}/umtet-config-version.cmake
  DESTINATION ${umtet_cmake} COMPONENT development)

# umtet-reconstruct.pc, umtet-mesh.pc, and umtet.pc for all three.
list(TRANSFORM umtet_definitions PREPEND -D OUTPUT_VARIABLE definitions)
list(JOIN definitions " " pc_definitions)
file(RELATIVE_PATH pc_up /p/${CMAKE_INSTALL_LIBDIR}/pkgconfig /p)
string(REGEX REPLACE "/$" "" pc_up ${pc_up})
foreach(part reconstruct mesh pipeline)
  set(pc_name umtet-${part})
  set(pc_requires "eigen3 tbb")
  if(part STREQUAL pipeline)
    set(pc_name umtet)
    set(pc_requires "umtet-reconstruct umtet-mesh nlohmann_json")
  endif()
  list(TRANSFORM umtet_${part}_links PREPEND -l OUTPUT_VARIABLE flags)
  list(JOIN flags " " pc_links)
  set(pc_extra)
  if(part STREQUAL mesh AND UMTET_WITH_GSL)
    set(pc_extra -DUMTET_WITH_GSL=1)
  endif()
  configure_file(cmake/umtet.pc.in ${PROJECT_BINARY_DIR}/${pc_name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${pc_name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
    COMPONENT development)
endforeach()

install(TARGETS umtet RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
install(FILES README.md CHANGELOG.md REFERENCES.bib DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
install(FILES docs/reference.md docs/promises.md DESTINATION ${CMAKE_INSTALL_DOCDIR}/docs COMPONENT program)
install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libumtet-dev COMPONENT development)
