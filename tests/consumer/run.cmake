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

# A component that there is not is named where it is asked for.
file(WRITE ${work}/bogus/CMakeLists.txt "cmake_minimum_required(VERSION 3.20)
project(bogus LANGUAGES C)
find_package(sunfleck 0.1 REQUIRED COMPONENTS core bogus)
")
execute_process(COMMAND ${CMAKE_COMMAND} -S ${work}/bogus -B ${work}/bogus/build -G ${generator}
                        -D CMAKE_PREFIX_PATH=${prefix}
                RESULT_VARIABLE result OUTPUT_QUIET ERROR_VARIABLE said)
string(REGEX REPLACE "[ \n]+" " " said "${said}")
if(result EQUAL 0 OR NOT said MATCHES "no component 'bogus' here; this sunfleck was built with: core")
  message(FATAL_ERROR "a component that is not there: ${result}, ${said}")
endif()

# As a part of another project, it leaves that one's build type alone.
file(WRITE ${work}/parent/CMakeLists.txt "cmake_minimum_required(VERSION 3.20)
project(parent LANGUAGES C)
set(SUNFLECK_BUILD_RENDER OFF)
add_subdirectory(\"${source}\" sunfleck)
if(CMAKE_BUILD_TYPE OR TARGET test_rng)
  message(FATAL_ERROR \"build type '\${CMAKE_BUILD_TYPE}', or tests, in the parent\")
endif()
")
run(${CMAKE_COMMAND} -S ${work}/parent -B ${work}/parent/build -G ${generator} -D CMAKE_BUILD_TYPE=)

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
