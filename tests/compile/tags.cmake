# Editors find names by tags: cmake -DCTAGS=<Universal Ctags> -DINCLUDE=<repository>/include -P tags.cmake
# `ctags -R include`, without options for this library, has its types, functions with bodies, and macros.
cmake_minimum_required(VERSION 3.24)

execute_process(COMMAND ${CTAGS} -R -f - ${INCLUDE} OUTPUT_VARIABLE tags RESULT_VARIABLE status ERROR_VARIABLE errors)
if(status)
  message(FATAL_ERROR "ctags ends with ${status}: ${errors}")
endif()
set(missing "")
foreach(name_and_file
        "Stmc systems/stmc.hpp" "info_nce loss/info_nce.hpp" "load_stmc weights/stmc_file.hpp"
        "Tensor tensor/tensor.hpp" "matmul tensor/ops.hpp" "Linear nn/linear.hpp" "EigenBackend backend/detail/eigen_class.hpp"
        "false_negatives loss/false_negatives.hpp" "Motion kinematics/motion.hpp" "GaussianDiffusion diffusion/gaussian.hpp"
        "SafetensorsFile file/safetensors.hpp" "MOTIONLANG_BODY version.hpp")
  string(REPLACE " " ";" name_and_file ${name_and_file})
  list(GET name_and_file 0 name)
  list(GET name_and_file 1 file)
  if(NOT tags MATCHES "(^|\n)${name}\t[^\n\t]*/motionlang/${file}\t")
    list(APPEND missing "${name} of ${file}")
  endif()
endforeach()
if(missing)
  list(JOIN missing ", " missing)
  message(FATAL_ERROR "ctags does not find ${missing}")
endif()
