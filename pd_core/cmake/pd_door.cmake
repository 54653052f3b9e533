# Doors: pdepth's answers for engines other than Bullet, each in a folder of its own. They stand on the core alone.

# Looks for an engine by pkg-config, where there is one: PkgConfig::<variable>.
macro(pd_find_engine variable module)
  find_package(PkgConfig QUIET)
  if(PKG_CONFIG_FOUND)
    pkg_check_modules(${variable} QUIET IMPORTED_TARGET GLOBAL ${module})
  endif()
endmacro()

# Leaves the folder if the engine's target was not found: with a line if the door's option is AUTO, else with an error.
macro(pd_door_needs target engine option debian_package)
  if(NOT TARGET ${target})
    set(pd_door_packages ${debian_package})
    if("${target}" MATCHES "^PkgConfig::" AND NOT PKG_CONFIG_FOUND)
      string(APPEND pd_door_packages " pkgconf")
    endif()
    if("${${option}}" STREQUAL "AUTO")
      message(STATUS "${CMAKE_CURRENT_SOURCE_DIR} is left out: ${engine} was not found (Debian: ${pd_door_packages})")
      return()
    endif()
    message(FATAL_ERROR "${engine} was not found: install ${pd_door_packages}, or leave it out with -D${option}=OFF")
  endif()
endmacro()

# The library pd_<name> (pdepth::<name>) of the folder's sources, on the core and on the engine's target.
function(pd_add_door name engine_target)
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/src/*.cpp)
  pd_add_library(pd_${name} ${sources})
  add_library(pdepth::${name} ALIAS pd_${name})
  add_dependencies(pd_doors pd_${name})
  set_target_properties(pd_${name} PROPERTIES OUTPUT_NAME pdepth_${name} EXPORT_NAME ${name})
  target_include_directories(pd_${name} PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
                                               $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
                                        # All doors share code, also that which writes a contact record.
                                        PRIVATE src ${PROJECT_SOURCE_DIR}/engine_glue/doors
                                                ${PROJECT_SOURCE_DIR}/engine_glue/include)
  target_link_libraries(pd_${name} PUBLIC pd_core ${engine_target})
  pd_compile_options(pd_${name})
  pd_unity_by_folder(pd_${name})
endfunction()
