# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

# cmake -D build=… -D source=… -D config=… -D generator=… -D embree_DIR=… -P run.cmake: installs the
# build to a folder below it, then builds and runs users of it that have nothing but that folder:
# a CMake project by find_package, and the example by the compile line in its own comment.
set(work ${build}/consumer)
set(prefix ${work}/prefix)
file(REMOVE_RECURSE ${work})

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    string(JOIN " " command ${ARGN})
    message(FATAL_ERROR "${command}: ${result}")
  endif()
endfunction()

run(${CMAKE_COMMAND} --install ${build} --prefix ${prefix} --config ${config})
run(${CMAKE_COMMAND} -S ${source}/tests/consumer -B ${work}/build -G ${generator} -D CMAKE_BUILD_TYPE=${config}
    -D CMAKE_PREFIX_PATH=${prefix} -D embed_source=${source}/examples/embed.c
    -D embree_DIR=${embree_DIR})
run(${CMAKE_COMMAND} --build ${work}/build --config ${config})
run(${work}/build/sample)
run(${work}/build/render ${work}/cmake.exr)

file(STRINGS ${source}/examples/embed.c line REGEX "cc -std=c99 embed.c")
string(REGEX REPLACE "^.*(cc -std=c99 embed.c.*)$" "\\1" line "${line}")
file(COPY ${source}/examples/embed.c DESTINATION ${work})
file(GLOB_RECURSE pc_file ${prefix}/*/sunfleck-image.pc)
get_filename_component(pc_folder ${pc_file} DIRECTORY)
set(ENV{PKG_CONFIG_PATH} "${pc_folder}:$ENV{PKG_CONFIG_PATH}")
execute_process(COMMAND pkg-config --static --libs-only-L sunfleck-image OUTPUT_VARIABLE library_folders)
string(REGEX REPLACE " *-L" ":" library_folders "${library_folders}")
string(STRIP "${library_folders}" library_folders)
set(ENV{LD_LIBRARY_PATH} "$ENV{LD_LIBRARY_PATH}${library_folders}")
run(sh -c "cd '${work}' && ${line}")
run(${work}/embed ${work}/pkg_config.exr)
foreach(name IN ITEMS cmake pkg_config)
  if(NOT EXISTS ${work}/${name}.exr)
    message(FATAL_ERROR "${work}/${name}.exr was not written")
  endif()
endforeach()
