# The two cores build, install and link without any library that reads or writes files: where these cannot be found,
# examples/ex4.cpp meshes a torus all the same.
set(build ${PREFIX}/../core)
set(prefix ${build}/prefix)
file(REMOVE_RECURSE ${build})
set(hidden)
foreach(package VTK HDF5 fmt nlohmann_json CLI11)
  list(APPEND hidden -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
endforeach()
set(quick -G Ninja -DCMAKE_CXX_COMPILER=${CXX} "-DCMAKE_CXX_FLAGS=${FLAGS} -O0" -DCMAKE_BUILD_TYPE=None)  # to be built soon
execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCES} -B ${build}/umtet ${quick} ${hidden} -DUMTET_CORE_ONLY=ON
  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${build}/umtet OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --install ${build}/umtet --prefix ${prefix} OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCES}/examples -B ${build}/examples ${quick} ${hidden}
    -DCMAKE_PREFIX_PATH=${prefix} OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${build}/examples --target ex4 OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${build}/examples/ex4 .2 OUTPUT_VARIABLE said COMMAND_ERROR_IS_FATAL ANY)
if(NOT said MATCHES "genus 1")
  message(FATAL_ERROR "ex4 says ${said}")
endif()
execute_process(COMMAND ldd ${build}/examples/ex4 OUTPUT_VARIABLE linked COMMAND_ERROR_IS_FATAL ANY)
if(linked MATCHES "vtk|lzf|hdf5|fmt")
  message(FATAL_ERROR "ex4 links\n${linked}")
endif()
