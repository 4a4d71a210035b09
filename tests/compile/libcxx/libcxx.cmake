# libc++, the standard library of clang, macOS and WebAssembly, where it is installed: every header, tests of core, file,
# formats and STMC, and the same bits as with the library of the compiler that builds everything else.
set(libcxx_folder ${CMAKE_CURRENT_BINARY_DIR}/libcxx)
file(WRITE ${libcxx_folder}/is_there.cpp "#include <vector>\nint main() { return std::vector<int>(2).at(1); }\n")
execute_process(COMMAND ${MOTIONLANG_CLANG} -std=c++20 -stdlib=libc++ is_there.cpp -o is_there
                WORKING_DIRECTORY ${libcxx_folder} OUTPUT_QUIET ERROR_QUIET RESULT_VARIABLE no_libcxx)
if(no_libcxx)
  message(STATUS "motionlang: no libc++ (Debian: libc++-dev libc++abi-dev), compile.libcxx_* are left out")
  return()
endif()
set(folders $<TARGET_PROPERTY:doctest::doctest,INTERFACE_INCLUDE_DIRECTORIES>)
set(doctest_folders $<FILTER:${folders},EXCLUDE,^/usr/include$>)
set(libcxx ${MOTIONLANG_CLANG} -stdlib=libc++ ${clang_options}
           "$<$<BOOL:${doctest_folders}>:-isystem$<JOIN:${doctest_folders},$<SEMICOLON>-isystem>>")

add_test(NAME compile.libcxx_headers COMMAND ${libcxx} -I${CMAKE_CURRENT_BINARY_DIR} -fsyntax-only
                                             ${CMAKE_CURRENT_SOURCE_DIR}/two_units/first.cpp
         COMMAND_EXPAND_LISTS)

# libcxx_program(<name> <options> <sources...>): sources are compiled again when something has changed that they
# include.
function(libcxx_program name options)
  set(objects)
  file(MAKE_DIRECTORY ${libcxx_folder}/${name})
  foreach(source ${ARGN})
    file(RELATIVE_PATH object ${PROJECT_SOURCE_DIR} ${source})
    string(REPLACE / . object ${object})
    set(object ${libcxx_folder}/${name}/${object}.o)
    list(APPEND objects ${object})
    add_custom_command(OUTPUT ${object} DEPENDS ${source} DEPFILE ${object}.d COMMAND_EXPAND_LISTS VERBATIM
                       COMMAND ${CMAKE_CXX_COMPILER_LAUNCHER} ${libcxx} ${options} -MD -MF ${object}.d
                               -c ${source} -o ${object})
  endforeach()
  add_custom_command(OUTPUT ${libcxx_folder}/${name}/program DEPENDS ${objects} VERBATIM
                     COMMAND ${MOTIONLANG_CLANG} -stdlib=libc++ -pthread ${objects} -o ${libcxx_folder}/${name}/program)
  add_custom_target(compile_libcxx_${name} ALL DEPENDS ${libcxx_folder}/${name}/program)
endfunction()

# Tests of what a standard library does: values as text, files and folders, sorting, threads. Most other readers make
# models, which takes long to compile and calls nothing else. Not optimised, edits and backends of STMC take a minute;
# so do the cases about memory and time, which are left out too.
file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/tests/unit/core/*.cpp)
foreach(name datasets/annotations datasets/babel datasets/humanml3d_folder datasets/motion_tokens file/file file/json
             file/npy file/options_file file/pickle file/png file/safetensors file/zip formats/amass formats/amc
             formats/bvh formats/figure_body formats/glb formats/motion_npy view/search_page view/viewer
             weights/weight_file)
  list(APPEND sources ${PROJECT_SOURCE_DIR}/tests/unit/${name}.cpp)
endforeach()
foreach(name generate keep model_file other_denoisers)
  list(APPEND sources ${PROJECT_SOURCE_DIR}/tests/systems/${name}.cpp)
endforeach()
libcxx_program(tests "-O0;-DMOTIONLANG_TESTS_FOLDER=\"${PROJECT_SOURCE_DIR}/tests\""
               ${PROJECT_SOURCE_DIR}/tests/doctest_main.cpp ${sources})
add_test(NAME compile.libcxx_tests
         COMMAND ${libcxx_folder}/tests/program "--test-case-exclude=*memory*,*twice the size*,*times as long*")

# A locale with a decimal comma, for the test of core/standard_library.hpp: programs of glibc can be given one.
find_program(MOTIONLANG_LOCALEDEF localedef)
if(MOTIONLANG_LOCALEDEF)
  execute_process(COMMAND ${MOTIONLANG_LOCALEDEF} --force --charmap=./ascii.txt --inputfile=./comma.txt
                          ${libcxx_folder}/comma
                  WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/libcxx OUTPUT_QUIET ERROR_QUIET)
endif()
if(EXISTS ${libcxx_folder}/comma/LC_NUMERIC)
  set_tests_properties(compile.libcxx_tests PROPERTIES
                       ENVIRONMENT "LOCPATH=${libcxx_folder};MOTIONLANG_TEST_LOCALE=comma")
endif()

# The README's motion, from both compilers with their libraries.
add_executable(compile_bits ${CMAKE_CURRENT_SOURCE_DIR}/libcxx/bits.cpp)
target_link_libraries(compile_bits PRIVATE motionlang::instantiated motionlang_flags)
libcxx_program(bits -O1 ${CMAKE_CURRENT_SOURCE_DIR}/libcxx/bits.cpp)
add_test(NAME compile.libcxx_bits
         COMMAND sh ${CMAKE_CURRENT_SOURCE_DIR}/libcxx/same_bits.sh $<TARGET_FILE:compile_bits>
                 ${libcxx_folder}/bits/program ${PROJECT_SOURCE_DIR}/examples/models/stmc_free.safetensors)
