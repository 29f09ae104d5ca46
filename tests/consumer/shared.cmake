# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

# cmake -D build=… -D source=… -D config=… -D generator=… -D embree_DIR=… -D image=… -D python=… -P shared.cmake: builds
# shared libraries, which must export what the public headers declare and nothing else, have the version in their
# names, and do for a user of the installed package.
set(work ${build}/shared)
set(prefix ${work}/prefix)
file(REMOVE_RECURSE ${prefix})

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_QUIET)
  if(NOT result EQUAL 0)
    string(JOIN " " command ${ARGN})
    message(FATAL_ERROR "${command}: ${result}")
  endif()
endfunction()

run(${CMAKE_COMMAND} -S ${source} -B ${work}/build -G ${generator} -D CMAKE_BUILD_TYPE=${config} -D BUILD_SHARED_LIBS=ON
    -D SUNFLECK_BUILD_IMAGE=${image} -D SUNFLECK_BUILD_TESTS=OFF -D SUNFLECK_OPTIMIZE=-O1 -D CMAKE_INSTALL_PREFIX=${prefix} -D embree_DIR=${embree_DIR})
run(${CMAKE_COMMAND} --build ${work}/build --config ${config})
file(GLOB libraries ${work}/build/csrc/libsunfleck_*.so)
list(LENGTH libraries count)
if(count LESS 2 OR (image AND count LESS 3))
  message(FATAL_ERROR "shared libraries: ${libraries}")
endif()
run(${python} ${source}/scripts/check-exports.py ${libraries})

run(${CMAKE_COMMAND} --install ${work}/build --config ${config})
file(GLOB_RECURSE versioned ${prefix}/*/libsunfleck_core.so.0.*)
list(LENGTH versioned count)
if(count LESS 2) # libsunfleck_core.so.0.1 and .so.0.1.0
  message(FATAL_ERROR "no version and soversion in the names of shared libraries: ${versioned}")
endif()
if(image)
  run(${CMAKE_COMMAND} -S ${source}/tests/consumer -B ${work}/consumer -G ${generator} -D CMAKE_BUILD_TYPE=${config}
      -D CMAKE_PREFIX_PATH=${prefix} -D embed_source=${source}/examples/embed.c -D embree_DIR=${embree_DIR})
  run(${CMAKE_COMMAND} --build ${work}/consumer --config ${config})
  run(${work}/consumer/sample)
  run(${work}/consumer/render ${work}/shared.exr)
endif()
