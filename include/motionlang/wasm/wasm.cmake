# motionlang_wasm: the functions of motionlang_c.h, compiled to WebAssembly by emscripten (target motionlang_wasm). The target
# `studio` writes studio.html into the build folder: one page in which motion is made. Without em++ (Debian: emscripten) there are no
# such targets, and nothing builds them unless it is asked to.
include_guard(GLOBAL)
find_program(MOTIONLANG_EMXX em++)

# The packages alone: the folder that has them may be /usr/include, with the system's headers beside them.
#     motionlang_wasm_packages(<folder for links> <target> <folder of headers> ...)
function(motionlang_wasm_packages links)
  file(MAKE_DIRECTORY ${links})
  while(ARGN)
    list(POP_FRONT ARGN target folder)
    get_target_property(places ${target} INTERFACE_INCLUDE_DIRECTORIES)
    foreach(place ${places})
      if(IS_DIRECTORY ${place}/${folder})
        file(CREATE_LINK ${place}/${folder} ${links}/${folder} SYMBOLIC)
      endif()
    endforeach()
  endwhile()
endfunction()

#     motionlang_wasm(<folder include/motionlang> <folder of the models>)
function(motionlang_wasm source models)
  set(wasm ${CMAKE_CURRENT_BINARY_DIR}/wasm)
  motionlang_wasm_packages(${wasm}/packages Eigen3::Eigen Eigen Eigen3::Eigen unsupported nlohmann_json::nlohmann_json nlohmann)
  # Debian's optimiser of JavaScript finds its package acorn only there.
  set(emxx ${CMAKE_COMMAND} -E env NODE_PATH=/usr/share/nodejs ${MOTIONLANG_EMXX} -O2 -msimd128 -fwasm-exceptions)
  foreach(unit c/motionlang_c wasm/motionlang_wasm)
    get_filename_component(name ${unit} NAME)
    add_custom_command(OUTPUT ${wasm}/${name}.o
                       COMMAND ${emxx} -std=c++20 -I ${source}/.. -isystem ${wasm}/packages
                               -MMD -MF ${wasm}/${name}.d -MT ${wasm}/${name}.o -c ${source}/${unit}.cpp -o ${wasm}/${name}.o
                       DEPENDS ${source}/${unit}.cpp DEPFILE ${wasm}/${name}.d
                       COMMENT "Compiling ${unit}.cpp to WebAssembly" VERBATIM)
    list(APPEND objects ${wasm}/${name}.o)
  endforeach()

  # motionlang_wasm has all functions, and the module of the page only those that the page calls.
  file(STRINGS ${source}/c/motionlang_c.h declared REGEX "^MOTIONLANG_C_API .*motionlang_[a-z_]+\\(")
  list(TRANSFORM declared REPLACE ".*(motionlang_[a-z_]+)\\(.*" "_\\1")
  set(page_source ${source}/view/detail/studio_page_source.hpp)
  file(READ ${page_source} called)
  string(REGEX MATCHALL "_motionlang_[a-z_]+" called "${called}")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${page_source} ${source}/c/motionlang_c.h)
  set(used)
  foreach(name ${declared})
    if(name IN_LIST called)
      list(APPEND used ${name})
    endif()
  endforeach()
  foreach(module motionlang_wasm studio_wasm)
    set(exports ${declared})
    if(module STREQUAL studio_wasm)
      set(exports ${used})
    endif()
    list(JOIN exports "," exports)
    add_custom_command(OUTPUT ${wasm}/${module}.js ${wasm}/${module}.wasm
                       COMMAND ${emxx} ${objects} -o ${wasm}/${module}.js --no-entry -sMODULARIZE -sEXPORT_NAME=motionlangModule
                               -sENVIRONMENT=worker,node -sDYNAMIC_EXECUTION=0 -sALLOW_MEMORY_GROWTH -sINITIAL_MEMORY=64MB
                               -sFORCE_FILESYSTEM -sEXPORTED_FUNCTIONS=_malloc,_free,${exports}
                               -sEXPORTED_RUNTIME_METHODS=FS,UTF8ToString,lengthBytesUTF8,stringToUTF8
                       DEPENDS ${objects} COMMENT "Linking ${module}.wasm" VERBATIM)
  endforeach()
  add_custom_target(motionlang_wasm DEPENDS ${wasm}/motionlang_wasm.js)

  add_executable(motionlang_write_studio EXCLUDE_FROM_ALL ${source}/wasm/write_studio.cpp)
  target_link_libraries(motionlang_write_studio PRIVATE motionlang::instantiated)
  set(page ${CMAKE_CURRENT_BINARY_DIR}/studio.html)
  set(model ${models}/stmc_free.safetensors)
  set(search ${models}/tmr_free)
  # The matrices of the model become whole numbers of 8 bits (weights/int8_matrix.hpp).
  add_custom_command(OUTPUT ${wasm}/model.safetensors COMMAND motionlang_write_studio int8 ${model} ${wasm}/model.safetensors
                     DEPENDS motionlang_write_studio ${model} COMMENT "Packing the model of the studio" VERBATIM)
  foreach(part studio_wasm.wasm model.safetensors config.json weights.safetensors)
    list(APPEND packing COMMAND ${CMAKE_COMMAND} -D FILE=${part} -P ${source}/wasm/gzip.cmake)
  endforeach()
  add_custom_command(OUTPUT ${page}
                     COMMAND ${CMAKE_COMMAND} -E copy ${search}/config.json ${search}/weights.safetensors .
                     ${packing}
                     COMMAND motionlang_write_studio page studio_wasm.js studio_wasm.wasm.gz model.safetensors.gz config.json.gz
                             weights.safetensors.gz ${models}/gallery.txt ${page}
                     DEPENDS ${wasm}/studio_wasm.js ${wasm}/model.safetensors motionlang_write_studio ${search}/config.json
                             ${search}/weights.safetensors ${models}/gallery.txt ${source}/wasm/gzip.cmake
                     WORKING_DIRECTORY ${wasm} COMMENT "Writing studio.html" VERBATIM)
  add_custom_target(studio DEPENDS ${page})
  set_target_properties(studio PROPERTIES PAGE ${page} MODEL ${wasm}/model.safetensors)
endfunction()

if(MOTIONLANG_EMXX AND TARGET Eigen3::Eigen AND TARGET nlohmann_json::nlohmann_json)
  get_filename_component(repository ${CMAKE_CURRENT_LIST_DIR}/../../.. ABSOLUTE)
  motionlang_wasm(${repository}/include/motionlang ${repository}/examples/models)
  unset(repository)
endif()
