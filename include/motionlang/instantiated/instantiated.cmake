# motionlang::instantiated: the usual types compiled once. Link it instead of motionlang::motionlang to build much faster;
# same headers, same results. Included by the repository's CMakeLists.txt and by the installed package.
include_guard(GLOBAL)
add_library(motionlang_instantiated STATIC EXCLUDE_FROM_ALL)
add_library(motionlang::instantiated ALIAS motionlang_instantiated)
file(GLOB motionlang_instantiated_sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/*.cpp)
if(NOT TARGET Eigen3::Eigen)  # a component that the user left out
  list(FILTER motionlang_instantiated_sources EXCLUDE REGEX "/(eigen|autodiff_eigen|stmc)\\.cpp$")
endif()
if(NOT TARGET xtensor)
  list(FILTER motionlang_instantiated_sources EXCLUDE REGEX "/(xtensor|autodiff_xtensor)\\.cpp$")
endif()
if(NOT TARGET nlohmann_json::nlohmann_json)
  list(FILTER motionlang_instantiated_sources EXCLUDE REGEX "_json\\.cpp$")
endif()
target_sources(motionlang_instantiated PRIVATE ${motionlang_instantiated_sources})
target_link_libraries(motionlang_instantiated PUBLIC motionlang::motionlang)
target_compile_definitions(motionlang_instantiated PUBLIC MOTIONLANG_INSTANTIATED)
target_compile_options(motionlang_instantiated PRIVATE -O3)
