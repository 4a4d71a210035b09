# A gate finds what is wrong: cmake -DCOMMAND=<command;...> -DEXPECTED=<expression> -P finds.cmake
execute_process(COMMAND ${COMMAND} RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(code EQUAL 0)
  message(FATAL_ERROR "nothing was found:\n${output}")
endif()
if(NOT output MATCHES "${EXPECTED}")
  message(FATAL_ERROR "exit code ${code}, but not for '${EXPECTED}':\n${output}")
endif()
