# Example 1, as a project of its own that knows nothing but the prefix.
set(build ${PREFIX}/../example)
file(REMOVE_RECURSE ${build})
file(MAKE_DIRECTORY ${build})
execute_process(COMMAND ${CMAKE_COMMAND} -S ${EXAMPLES} -B ${build} -DCMAKE_PREFIX_PATH=${PREFIX}
    -DCMAKE_CXX_COMPILER=${CXX} "-DCMAKE_CXX_FLAGS=${FLAGS}" OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${build} --target ex1 OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${build}/ex1 0.2 WORKING_DIRECTORY ${build} OUTPUT_VARIABLE said COMMAND_ERROR_IS_FATAL ANY)
if(NOT said MATCHES "tets, min Q 0\\.[89]" OR NOT EXISTS ${build}/ball.vtu)
  message(FATAL_ERROR "ex1 says ${said}")
endif()
