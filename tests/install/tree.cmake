# cmake --install into an empty folder has what each kind of user needs.
file(REMOVE_RECURSE ${PREFIX})
execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --prefix ${PREFIX} OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
foreach(file bin/umtet share/man/man1/umtet.1.gz share/bash-completion/completions/umtet share/doc/umtet/copyright share/doc/umtet/docs/reference.md
    ${LIBDIR}/libumtet_mesh.a ${LIBDIR}/cmake/umtet/umtet-config.cmake ${LIBDIR}/pkgconfig/umtet.pc
    include/umtet/mesh/universal_mesh.h)
  if(NOT EXISTS ${PREFIX}/${file})
    message(FATAL_ERROR "${file} is not installed")
  endif()
endforeach()
execute_process(COMMAND ${PREFIX}/bin/umtet --version OUTPUT_VARIABLE version COMMAND_ERROR_IS_FATAL ANY)
if(NOT version MATCHES "^umtet [0-9]")
  message(FATAL_ERROR "umtet --version says ${version}")
endif()
