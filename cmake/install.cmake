# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

# Installs the targets collected in the global property sunfleck_targets, the headers, and the
# CMake and pkg-config packages that find them. Both packages may be moved after installation.

get_property(sunfleck_targets GLOBAL PROPERTY sunfleck_targets)
set(sunfleck_components ${sunfleck_targets})
list(TRANSFORM sunfleck_components REPLACE "^sunfleck_" "")

# All headers, whatever was built: they need nothing but C, and sunfleck.h includes them all.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/csrc/include/sunfleck DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
        FILES_MATCHING PATTERN "*.h")

# One export per component, so that asking for core alone looks for no Embree.
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/sunfleck)
foreach(component IN LISTS sunfleck_components)
  install(TARGETS sunfleck_${component} EXPORT sunfleck-${component}-targets)
  install(EXPORT sunfleck-${component}-targets NAMESPACE sunfleck:: DESTINATION ${package_dir})
endforeach()
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/sunfleck-config.cmake.in
                              ${PROJECT_BINARY_DIR}/sunfleck-config.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/sunfleck-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/sunfleck-config.cmake ${PROJECT_BINARY_DIR}/sunfleck-config-version.cmake
        DESTINATION ${package_dir})

# Paths in .pc files, relative to the file where the install folders are.
function(sunfleck_pc_path result folder)
  if(IS_ABSOLUTE "${folder}")
    set(${result} "${folder}" PARENT_SCOPE)
  else()
    set(${result} "\${prefix}/${folder}" PARENT_SCOPE)
  endif()
endfunction()
file(RELATIVE_PATH sunfleck_pc_prefix "${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig" "${CMAKE_INSTALL_PREFIX}")
string(REGEX REPLACE "/$" "" sunfleck_pc_prefix "${sunfleck_pc_prefix}")
sunfleck_pc_path(sunfleck_pc_libdir "${CMAKE_INSTALL_LIBDIR}")
sunfleck_pc_path(sunfleck_pc_includedir "${CMAKE_INSTALL_INCLUDEDIR}")

function(sunfleck_install_pc component)
  cmake_parse_arguments(PARSE_ARGV 1 sunfleck_pc "" "DESCRIPTION;REQUIRES;REQUIRES_PRIVATE;LIBS_PRIVATE;CFLAGS" "")
  foreach(field IN ITEMS description requires requires_private libs_private cflags)
    string(TOUPPER ${field} upper)
    set(sunfleck_pc_${field} "${sunfleck_pc_${upper}}")
  endforeach()
  configure_file(${PROJECT_SOURCE_DIR}/cmake/sunfleck.pc.in ${PROJECT_BINARY_DIR}/sunfleck-${component}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/sunfleck-${component}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endfunction()

# The linker's flags for an imported shared library, as -L and -l.
function(sunfleck_library_flags result target)
  get_target_property(location ${target} LOCATION)
  get_filename_component(folder "${location}" DIRECTORY)
  get_filename_component(name "${location}" NAME)
  string(REGEX REPLACE "^lib(.*)\\.(so|dylib|a).*$" "-l\\1" flags "${name}")
  if(NOT folder IN_LIST CMAKE_C_IMPLICIT_LINK_DIRECTORIES)
    set(flags "-L${folder} ${flags}")
  endif()
  set(${result} "${flags}" PARENT_SCOPE)
endfunction()

sunfleck_install_pc(core DESCRIPTION "Random numbers, point sets, mappings and error estimates"
                    LIBS_PRIVATE "${CMAKE_THREAD_LIBS_INIT} -lm" CFLAGS " -ffp-contract=off -DSF_CONTRACT_OFF")
if(SUNFLECK_BUILD_RENDER)
  # Embree has no .pc file of its own.
  sunfleck_library_flags(embree_flags embree)
  sunfleck_install_pc(render DESCRIPTION "Adaptive path tracer with stated accuracy" REQUIRES "sunfleck-core"
                      LIBS_PRIVATE "${embree_flags} -lm")
endif()
if(SUNFLECK_BUILD_IMAGE)
  list(TRANSFORM sunfleck_cxx_runtime PREPEND "-l" OUTPUT_VARIABLE runtime_flags)
  list(JOIN runtime_flags " " runtime_flags)
  sunfleck_install_pc(image DESCRIPTION "Image files of Sunfleck's films" REQUIRES "sunfleck-render"
                      REQUIRES_PRIVATE "OpenImageIO" LIBS_PRIVATE "${runtime_flags}")
endif()
