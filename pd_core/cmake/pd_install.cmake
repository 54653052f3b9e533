# Install rules: one component for each room (library, headers, exported target, pkg-config file) and the package
# configuration that brings them together for find_package(pdepth 0.1 COMPONENTS ...).
include(CMakePackageConfigHelpers)

set(PD_INSTALL_CMAKEDIR ${CMAKE_INSTALL_LIBDIR}/cmake/pdepth)
set(PD_CMAKE_SOURCE_DIR ${CMAKE_CURRENT_LIST_DIR})

# A shared library names everything that it needs. The exception: Clang puts the runtime of its sanitizers into programs alone.
set(pd_no_undefined LINKER:--no-undefined)
if(CMAKE_CXX_COMPILER_ID STREQUAL Clang AND CMAKE_CXX_FLAGS MATCHES "-fsanitize=")
  set(pd_no_undefined "")
endif()

# pd_add_library(<target> <sources>...): static, or with BUILD_SHARED_LIBS shared: then its file carries the version under which
# binaries stay compatible (0.x: the minor one) and exports namespace pd alone, without pd::detail. The archive
# <target>_internals holds the same objects for tests of internals; without BUILD_SHARED_LIBS it is the library itself.
# PD_STATIC_LIBRARIES names targets that stay static all the same: Debian's package of the glue holds an archive, since its
# interface is Bullet's.
function(pd_add_library target)
  if(NOT BUILD_SHARED_LIBS OR target IN_LIST PD_STATIC_LIBRARIES)
    add_library(${target} STATIC ${ARGN})
    add_library(${target}_internals ALIAS ${target})
    return()
  endif()
  add_library(${target} SHARED ${ARGN})
  set(exports ${PD_CMAKE_SOURCE_DIR}/exports.map)
  set_target_properties(${target} PROPERTIES VERSION ${PROJECT_VERSION} DEFINE_SYMBOL ""
                        SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} LINK_DEPENDS ${exports})
  target_link_options(${target} PRIVATE LINKER:--version-script=${exports} ${pd_no_undefined})
  add_library(${target}_internals STATIC $<TARGET_OBJECTS:${target}>)
  target_link_libraries(${target}_internals INTERFACE $<TARGET_PROPERTY:${target},INTERFACE_LINK_LIBRARIES>)
  target_include_directories(${target}_internals INTERFACE $<TARGET_PROPERTY:${target},INTERFACE_INCLUDE_DIRECTORIES>)
endfunction()

# pd_install_component(<target> PC_NAME <name> PC_REQUIRES <modules> DESCRIPTION <text> [LANGUAGE <text>] [PC_LIBS <flags>])
#
# Static libraries need what they use privately, too: it stands under Requires and Libs, since `pkg-config --libs` without
# --static has to be enough.
function(pd_install_component target)
  cmake_parse_arguments(arg "" "PC_NAME;PC_REQUIRES;PC_LIBS;DESCRIPTION;LANGUAGE" "" ${ARGN})
  if(NOT arg_LANGUAGE)
    set(arg_LANGUAGE "C++20: compile with -std=c++20")
  endif()
  get_target_property(component ${target} EXPORT_NAME)
  if(NOT component)
    set(component ${target})
  endif()
  get_target_property(library ${target} OUTPUT_NAME)

  install(TARGETS ${target} EXPORT pdepth-${component} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${component}
          LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${component})
  install(DIRECTORY include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT ${component} FILES_MATCHING PATTERN "*.h" PATTERN "*.hpp")
  install(EXPORT pdepth-${component} NAMESPACE pdepth:: FILE pdepth-${component}-targets.cmake
          DESTINATION ${PD_INSTALL_CMAKEDIR} COMPONENT ${component})

  pd_install_pkg_config(${arg_PC_NAME} REQUIRES "${arg_PC_REQUIRES}" LIBS "-l${library} ${arg_PC_LIBS}"
                        DESCRIPTION "${arg_DESCRIPTION} (${arg_LANGUAGE})" COMPONENT ${component})
endfunction()

# pd_install_pkg_config(<name> REQUIRES <modules> LIBS <flags> DESCRIPTION <text> COMPONENT <component>)
function(pd_install_pkg_config name)
  cmake_parse_arguments(pc "" "REQUIRES;LIBS;DESCRIPTION;COMPONENT" "" ${ARGN})
  # Relative to the file itself, so that an installed tree can be moved.
  file(RELATIVE_PATH prefix_from_pc /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
  cmake_path(IS_ABSOLUTE CMAKE_INSTALL_LIBDIR absolute_libdir)
  if(absolute_libdir)
    set(pc_prefix ${CMAKE_INSTALL_PREFIX})
  else()
    set(pc_prefix "\${pcfiledir}/${prefix_from_pc}")
  endif()
  set(pc_libdir "\${prefix}")
  cmake_path(APPEND pc_libdir ${CMAKE_INSTALL_LIBDIR})
  set(pc_includedir "\${prefix}")
  cmake_path(APPEND pc_includedir ${CMAKE_INSTALL_INCLUDEDIR})
  configure_file(${PD_CMAKE_SOURCE_DIR}/component.pc.in ${PROJECT_BINARY_DIR}/${name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT ${pc_COMPONENT})
endfunction()

# The package configuration, its version file and what they include; the command pdepth where it is built.
function(pd_install_package)
  configure_package_config_file(${PD_CMAKE_SOURCE_DIR}/pdepth-config.cmake.in ${PROJECT_BINARY_DIR}/pdepth-config.cmake
                                INSTALL_DESTINATION ${PD_INSTALL_CMAKEDIR} NO_CHECK_REQUIRED_COMPONENTS_MACRO)
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/pdepth-config-version.cmake VERSION ${PROJECT_VERSION}
                                   COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/pdepth-config.cmake ${PROJECT_BINARY_DIR}/pdepth-config-version.cmake
                ${PD_CMAKE_SOURCE_DIR}/pdepth_bullet.cmake DESTINATION ${PD_INSTALL_CMAKEDIR} COMPONENT pd_core)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT pd_core)
  if(TARGET pdepth)
    install(TARGETS pdepth RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT pdepth)
    if(NOT CMAKE_CROSSCOMPILING)
      pd_install_manual()
    endif()
  endif()
  # Programs that the command starts: it looks beside itself and in ../libexec/pdepth.
  foreach(program pdepth-pictures record_peers record_peers_double record_dart)
    if(TARGET ${program})
      install(TARGETS ${program} RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/pdepth COMPONENT ${program} OPTIONAL)
    endif()
  endforeach()
endfunction()

# Manual pages and completion, which the command writes itself. It may have been built without a path to its libraries.
function(pd_install_manual)
  set(command ${CMAKE_COMMAND} -E env LD_LIBRARY_PATH=$<TARGET_FILE_DIR:pd_core>:$ENV{LD_LIBRARY_PATH} $<TARGET_FILE:pdepth>)
  list(JOIN command "\" \"" command)
  install(CODE "set(share \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATAROOTDIR}\")
execute_process(COMMAND \"${command}\" help --man \"\${share}/man/man1\" COMMAND_ERROR_IS_FATAL ANY)
file(MAKE_DIRECTORY \"\${share}/bash-completion/completions\")
execute_process(COMMAND \"${command}\" help --completion bash OUTPUT_FILE \"\${share}/bash-completion/completions/pdepth\"
                COMMAND_ERROR_IS_FATAL ANY)" COMPONENT pdepth)
endfunction()
