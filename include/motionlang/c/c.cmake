# motionlang::c: motionlang_c.h as a shared library, for programs in other languages. Built when something links it, or as target
# motionlang_c. Included by the repository's CMakeLists.txt and by the installed package.
include_guard(GLOBAL)
if(TARGET Eigen3::Eigen AND TARGET nlohmann_json::nlohmann_json)  # not components that the user left out
  add_library(motionlang_c SHARED EXCLUDE_FROM_ALL ${CMAKE_CURRENT_LIST_DIR}/motionlang_c.cpp)
  add_library(motionlang::c ALIAS motionlang_c)
  set_target_properties(motionlang_c PROPERTIES CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  # It turns exceptions into ids. A project that compiles motionlang::instantiated without them pays for one large unit.
  get_target_property(options motionlang_instantiated COMPILE_OPTIONS)
  if("${CMAKE_CXX_FLAGS} ${options}" MATCHES "-fno-exceptions")
    target_link_libraries(motionlang_c PRIVATE motionlang::motionlang)
  else()
    target_link_libraries(motionlang_c PRIVATE motionlang_instantiated)
    set_target_properties(motionlang_instantiated PROPERTIES POSITION_INDEPENDENT_CODE ON)
    # As fast as without: GCC may inline what a program could replace.
    target_compile_options(motionlang_instantiated PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fno-semantic-interposition>)
  endif()
  target_include_directories(motionlang_c INTERFACE
                             $<TARGET_PROPERTY:motionlang::motionlang,INTERFACE_INCLUDE_DIRECTORIES>)
  target_compile_options(motionlang_c PRIVATE -O3 -fexceptions)
  if(CMAKE_SYSTEM_NAME STREQUAL "Linux")
    target_link_options(motionlang_c PRIVATE LINKER:--version-script=${CMAKE_CURRENT_LIST_DIR}/exports.map)
  endif()
endif()
