# libpdepth.so, the C interface: the core's objects behind pdepth.h. It exports the functions of that header alone. The C++ runtime is
# inside, so that none crosses the border: neither operator new, which the library has of its own, nor an exception.
find_package(Threads REQUIRED)
file(GLOB pd_c_interface_sources CONFIGURE_DEPENDS src/c_interface/*.cpp)
add_library(pdepth_c SHARED ${pd_c_interface_sources})
add_library(pdepth::pdepth_c ALIAS pdepth_c)
set(pd_c_exports ${CMAKE_CURRENT_SOURCE_DIR}/src/c_interface/exports.map)
set_target_properties(
  pdepth_c PROPERTIES OUTPUT_NAME pdepth VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR} DEFINE_SYMBOL "" LINK_DEPENDS ${pd_c_exports})
target_include_directories(pdepth_c PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
                                           $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}> PRIVATE src)
target_link_libraries(pdepth_c PRIVATE pd_core_internals Threads::Threads)
target_link_options(pdepth_c PRIVATE LINKER:--version-script=${pd_c_exports} ${pd_no_undefined} LINKER:--gc-sections
                                     -static-libstdc++ -static-libgcc)
pd_compile_options(pdepth_c)
pd_unity_by_folder(pdepth_c)

if(PD_INSTALL)
  install(TARGETS pdepth_c EXPORT pdepth-pdepth_c LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT pdepth_c)
  install(DIRECTORY include/pdepth DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT pdepth_c)
  install(EXPORT pdepth-pdepth_c NAMESPACE pdepth:: FILE pdepth-pdepth_c-targets.cmake DESTINATION ${PD_INSTALL_CMAKEDIR}
          COMPONENT pdepth_c)
  pd_install_pkg_config(pdepth LIBS -lpdepth DESCRIPTION "Exact and certified penetration depth of bodies, for C"
                        COMPONENT pdepth_c)
endif()
