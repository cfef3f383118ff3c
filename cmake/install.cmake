# What `cmake --install` puts where: the program, its documents, and the libraries for find_package(umtet) and
# pkg-config. Packed as Debian would: program, development, python (python/CMakeLists.txt), pcl (pcl/CMakeLists.txt).
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

# umtet-mesh.pc and the like; umtet.pc is the pipeline's, with all the others.
set(mesh_requires "eigen3 tbb")
set(mesh_extra)
if(UMTET_WITH_GSL)
  string(APPEND mesh_requires " gsl")
  set(mesh_extra -DUMTET_WITH_GSL=1)
endif()
set(body_requires "umtet-reconstruct umtet-mesh tbb")
set(reconstruct_requires "eigen3 tbb")
set(reconstruct_libs "-lflann_cpp -llz4")  # flann.pc names HDF5, which only its own files use
set(vtk_xml_requires "tbb fmt zlib liblz4")
set(mesh_io_requires "umtet-mesh umtet-vtk_xml fmt")
set(mesh_io_libs "-lhdf5_serial")  # hdf5-serial.pc names a folder that the linker does not search
set(cloud_io_requires "umtet-reconstruct umtet-vtk_xml fmt libxxhash liblzf")
set(pipeline_requires "umtet-body umtet-mesh_io umtet-cloud_io nlohmann_json tomlplusplus")
list(JOIN umtet_definitions " -D" pc_definitions)
file(RELATIVE_PATH pc_up /p/${CMAKE_INSTALL_LIBDIR}/pkgconfig /p)
string(REGEX REPLACE "/$" "" pc_up ${pc_up})
foreach(component IN LISTS umtet_components)
  set(pc_name umtet-${component})
  if(component STREQUAL pipeline)
    set(pc_name umtet)
  endif()
  set(pc_requires ${${component}_requires})
  set(pc_libs ${${component}_libs})
  set(pc_extra ${${component}_extra})
  configure_file(cmake/umtet.pc.in ${PROJECT_BINARY_DIR}/${pc_name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${pc_name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
endforeach()

foreach(folder common reconstruct mesh body umtet pipeline)
  install(DIRECTORY ${folder} DESTINATION ${umtet_headers} COMPONENT development
    FILES_MATCHING PATTERN "*.h" PATTERN "*.def" PATTERN detail EXCLUDE PATTERN examples EXCLUDE PATTERN cli EXCLUDE)
endforeach()

configure_package_config_file(cmake/umtet-config.cmake.in ${PROJECT_BINARY_DIR}/umtet-config.cmake
  INSTALL_DESTINATION ${umtet_cmake} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/umtet-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/umtet-config.cmake ${PROJECT_BINARY_DIR}/umtet-config-version.cmake
  DESTINATION ${umtet_cmake} COMPONENT development)

install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libumtet-dev COMPONENT development
  PATTERN pcl EXCLUDE)
if(UMTET_CORE_ONLY)
  return()
endif()

install(TARGETS umtet RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
install(FILES README.md CHANGELOG.md REFERENCES.bib DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program FILES_MATCHING PATTERN "*.md")
