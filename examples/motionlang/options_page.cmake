# Writes OPTIONS.md from the --help of the program, or compares it:
#     cmake -D PROGRAM=<motionlang> -D ROOT=<repository> [-D COMPARE=1] -P options_page.cmake
function(help_of output)
  execute_process(COMMAND ${PROGRAM} ${ARGN} --help OUTPUT_VARIABLE text COMMAND_ERROR_IS_FATAL ANY)
  set(${output} "${text}" PARENT_SCOPE)
endfunction()

help_of(all)
string(REGEX REPLACE "^motionlang [0-9.]+:" "motionlang:" all "${all}")  # the same page for each version
set(page "# Options of the program\n\nThe target `options_page` writes this page from `motionlang --help`; a test compares it.\n")
string(APPEND page "[README.md](README.md) shows what the commands are for.\n\n```text\n${all}```\n")
string(REGEX REPLACE ".*\nCommands:\n" "" commands "${all}")
string(REGEX MATCHALL "(^|\n)  [a-z][a-z0-9-]+" commands "${commands}")
foreach(command ${commands})
  string(STRIP "${command}" command)
  help_of(text ${command})
  string(APPEND page "\n## ${command}\n\n```text\n${text}```\n")
endforeach()

set(file ${ROOT}/examples/motionlang/OPTIONS.md)
if(NOT COMPARE)
  file(WRITE ${file} "${page}")
  return()
endif()
file(READ ${file} old)
if(NOT old STREQUAL page)
  message(FATAL_ERROR "${file} differs from --help: cmake --build <build> --target options_page")
endif()
