# bash offers commands, the flags of a command, and the words that a flag takes.
execute_process(COMMAND bash ${CHECK}/completions.bash ${PREFIX}/share/bash-completion/completions/umtet
  COMMAND_ERROR_IS_FATAL ANY)
foreach(shell zsh fish)
  find_program(${shell} ${shell})
endforeach()
if(zsh)
  execute_process(COMMAND ${zsh} -n ${PREFIX}/share/zsh/vendor-completions/_umtet COMMAND_ERROR_IS_FATAL ANY)
endif()
if(fish)
  execute_process(COMMAND ${fish} -n ${PREFIX}/share/fish/vendor_completions.d/umtet.fish COMMAND_ERROR_IS_FATAL ANY)
endif()
