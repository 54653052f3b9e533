# Bullet as one imported target, `pdepth::bullet`, with its scalar type: for this project's build and, installed beside the
# package configuration, for whoever links an installed engine_glue.
#
# Debian ships both precisions, told apart by pkg-config (`bullet`, `bullet-float64`). Bullet's own CMake configuration names
# libraries by paths that are not there, so it is not used; where pkg-config is missing, CMake's FindBullet serves the float
# build and a search by name the double one.
#
#   pdepth_find_bullet(DOUBLE <bool> [GLOBAL] [QUIET])
# sets pdepth_bullet_FOUND in the caller's scope; without QUIET a missing Bullet stops the configuration.

function(pdepth_find_bullet)
  cmake_parse_arguments(arg "GLOBAL;QUIET" "DOUBLE" "" ${ARGN})
  set(pdepth_bullet_FOUND TRUE PARENT_SCOPE)
  if(TARGET pdepth::bullet)
    return()
  endif()
  set(global "")
  if(arg_GLOBAL)
    set(global GLOBAL)
  endif()
  if(arg_DOUBLE)
    set(module bullet-float64)
    set(prefix PDEPTH_BULLET_FLOAT64)
  else()
    set(module bullet)
    set(prefix PDEPTH_BULLET)
  endif()

  find_package(PkgConfig QUIET)
  if(PKG_CONFIG_FOUND)
    pkg_check_modules(${prefix} QUIET IMPORTED_TARGET ${global} ${module})
  endif()
  if(TARGET PkgConfig::${prefix})
    add_library(pdepth::bullet INTERFACE IMPORTED ${global})
    target_link_libraries(pdepth::bullet INTERFACE PkgConfig::${prefix})
    return()
  endif()

  set(libraries "")
  if(arg_DOUBLE)
    find_path(PDEPTH_BULLET_INCLUDE_DIR btBulletDynamicsCommon.h PATH_SUFFIXES bullet)
    set(include_dirs ${PDEPTH_BULLET_INCLUDE_DIR})
    foreach(name BulletDynamics BulletCollision LinearMath)
      find_library(PDEPTH_${name}_FLOAT64_LIBRARY ${name}-float64)
      list(APPEND libraries ${PDEPTH_${name}_FLOAT64_LIBRARY})
    endforeach()
  else()
    find_package(Bullet QUIET MODULE)
    if(BULLET_FOUND)
      # FindBullet names the folder that holds btBulletDynamicsCommon.h; all headers include each other from there.
      set(include_dirs ${BULLET_INCLUDE_DIRS})
      set(libraries ${BULLET_LIBRARIES})
    endif()
  endif()
  if(NOT libraries OR NOT include_dirs OR "${libraries};${include_dirs}" MATCHES "NOTFOUND")
    set(pdepth_bullet_FOUND FALSE PARENT_SCOPE)
    if(NOT arg_QUIET)
      message(FATAL_ERROR "Bullet (${module}) was not found: install libbullet-dev, or leave engine_glue out with "
                          "-DPD_WITH_BULLET=OFF")
    endif()
    return()
  endif()
  add_library(pdepth::bullet INTERFACE IMPORTED ${global})
  target_include_directories(pdepth::bullet SYSTEM INTERFACE ${include_dirs})
  target_link_libraries(pdepth::bullet INTERFACE ${libraries})
  if(arg_DOUBLE)
    target_compile_definitions(pdepth::bullet INTERFACE BT_USE_DOUBLE_PRECISION)
  endif()
endfunction()
