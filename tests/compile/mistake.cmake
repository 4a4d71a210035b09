# A snippet that must not compile, with the message that its user must see:
#     cmake -DSOURCE=<snippet> "-DCOMPILE=<compiler;flags>" -P mistake.cmake
# With MISTAKE defined the compiler must fail, and for every line `// expect: <regular expression>` some line of its
# message must match; without, the snippet must compile, so that nothing but the mistake is what fails.
cmake_minimum_required(VERSION 3.24)

file(STRINGS ${SOURCE} expectations REGEX "^// expect: ")
if(NOT expectations)
  message(FATAL_ERROR "${SOURCE} expects no message")
endif()

execute_process(COMMAND ${COMPILE} ${SOURCE} RESULT_VARIABLE status ERROR_VARIABLE output)
if(status)
  message(FATAL_ERROR "does not compile without the mistake:\n${output}")
endif()

execute_process(COMMAND ${COMPILE} -DMISTAKE ${SOURCE} RESULT_VARIABLE status ERROR_VARIABLE output)
if(NOT status)
  message(FATAL_ERROR "compiles")
endif()
string(REGEX MATCHALL "[^\n]*(error|note):[^\n]*" diagnostics "${output}")
foreach(expectation IN LISTS expectations)
  string(REPLACE "// expect: " "" expectation "${expectation}")
  set(matching ${diagnostics})
  list(FILTER matching INCLUDE REGEX "${expectation}")
  if(NOT matching)
    message(FATAL_ERROR "no line of the message matches '${expectation}':\n${output}")
  endif()
endforeach()
