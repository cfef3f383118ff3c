# The man page renders without a warning and describes every command.
find_program(groff groff REQUIRED)
execute_process(COMMAND gzip -dc ${PREFIX}/share/man/man1/umtet.1.gz
  COMMAND ${groff} -man -Tutf8 -ww -rLL=100n -P-cbou
  OUTPUT_VARIABLE page ERROR_VARIABLE warnings COMMAND_ERROR_IS_FATAL ANY)
if(NOT warnings STREQUAL "")
  message(FATAL_ERROR "${warnings}")
endif()
foreach(text run reconstruct mesh evolve batch inspect check export report view diff)
  if(NOT page MATCHES "umtet ${text}\n")
    message(FATAL_ERROR "umtet ${text} has no part of its own:\n${page}")
  endif()
endforeach()
foreach(text "--implicit" "--background" "EXIT STATUS" "0 success" "umtet - certified tetrahedral meshes")
  string(FIND "${page}" "${text}" at)
  if(at LESS 0)
    message(FATAL_ERROR "${text} is not in the man page:\n${page}")
  endif()
endforeach()
