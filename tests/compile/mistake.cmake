# A snippet that must not compile, with the message that its user must see:
#     cmake -DSOURCE=<snippet> "-DCOMPILE=<compiler;flags>" -P mistake.cmake
# With MISTAKE defined the compiler must fail, and for every line `// expect: <regular expression>` some line of its
# message must match, for `// first: <regular expression>` the first error; without, the snippet must compile, so that
# nothing but the mistake is what fails. `// flags: <flags>` are added with MISTAKE only. A warning is a mistake, too.
cmake_minimum_required(VERSION 3.24)

file(STRINGS ${SOURCE} expectations REGEX "^// (expect|first): ")
if(NOT expectations)
  message(FATAL_ERROR "${SOURCE} expects no message")
endif()
file(STRINGS ${SOURCE} flags REGEX "^// flags: ")
string(REPLACE "// flags: " "" flags "${flags}")
list(APPEND COMPILE -Werror)

execute_process(COMMAND ${COMPILE} ${SOURCE} RESULT_VARIABLE status ERROR_VARIABLE output)
if(status)
  message(FATAL_ERROR "does not compile without the mistake:\n${output}")
endif()

execute_process(COMMAND ${COMPILE} -DMISTAKE ${flags} ${SOURCE} RESULT_VARIABLE status ERROR_VARIABLE output)
if(NOT status)
  message(FATAL_ERROR "compiles")
endif()
string(REGEX MATCHALL "[^\n]*(error|note):[^\n]*" diagnostics "${output}")
string(REGEX MATCH "[^\n]*error:[^\n]*" first "${output}")
foreach(expectation IN LISTS expectations)
  if(expectation MATCHES "^// first: (.*)")
    set(matching "${first}")
  else()
    set(matching ${diagnostics})
  endif()
  string(REGEX REPLACE "^// [a-z]+: " "" expectation "${expectation}")
  list(FILTER matching INCLUDE REGEX "${expectation}")
  if(NOT matching)
    message(FATAL_ERROR "no line of the message matches '${expectation}':\n${output}")
  endif()
endforeach()
