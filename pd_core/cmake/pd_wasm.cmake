# pdepth.wasm, the C interface as a WebAssembly module without glue of JavaScript; pdepth-convex.wasm, which makes no compounds and
# is smaller; and pdepth-lines.wasm, which answers lines of the protocol. packaging/wasm.sh builds them and the npm package around them.
# They export what packaging/npm/bridge.cpp or line_bridge.cpp adds, malloc and free, and the first two the functions of pdepth.h.
file(GLOB pd_c_interface_sources CONFIGURE_DEPENDS src/c_interface/*.cpp)
file(STRINGS include/pdepth/pdepth.h lines REGEX "^[a-z].*[ *]pdepth_[a-z_]+\\(")
set(exports _malloc,_free,_pdepth_web_layout)
foreach(line ${lines})
  string(REGEX MATCH "(pdepth_[a-z_]+)\\(" found "${line}")
  string(APPEND exports ",_${CMAKE_MATCH_1}")
endforeach()

set(pd_wasm_linking -sSTANDALONE_WASM=1 --no-entry -sALLOW_MEMORY_GROWTH=1 -sMAXIMUM_MEMORY=2GB -sTOTAL_STACK=1MB -sSUPPORT_LONGJMP=0 -Oz)

function(pd_add_module target name)
  add_executable(${target} ${pd_c_interface_sources} ${PROJECT_SOURCE_DIR}/packaging/npm/bridge.cpp)
  target_include_directories(${target} PRIVATE include src)
  target_link_libraries(${target} PRIVATE pd_core_internals Boost::headers)
  pd_compile_options(${target})
  pd_unity_by_folder(${target})
  target_link_options(${target} PRIVATE ${pd_wasm_linking} -sEXPORTED_FUNCTIONS=${exports})
  set_target_properties(${target} PROPERTIES OUTPUT_NAME ${name} SUFFIX .wasm)
endfunction()
pd_add_module(pdepth_wasm pdepth)
pd_add_module(pdepth_wasm_convex pdepth-convex)
target_compile_definitions(pdepth_wasm_convex PRIVATE PD_CONVEX_ALONE)

# The reader of lines needs all of the core. Neither is asked in a hot loop, so both are compiled for the least size.
set(demos ${PROJECT_SOURCE_DIR}/demos)
file(GLOB pd_line_sources CONFIGURE_DEPENDS ${demos}/protocol/*.cpp ${demos}/protocol/line/*.cpp ${demos}/mesh/*.cpp ${demos}/files/*.cpp)
list(FILTER pd_line_sources EXCLUDE REGEX "/line_source.cpp")  # reads a stream of the system
add_executable(pdepth_wasm_lines EXCLUDE_FROM_ALL ${pd_beyond_sources} ${pd_line_sources} ${PROJECT_SOURCE_DIR}/packaging/npm/line_bridge.cpp)
target_include_directories(pdepth_wasm_lines PRIVATE include src ${demos})
target_link_libraries(pdepth_wasm_lines PRIVATE pd_core_internals Boost::headers)
pd_compile_options(pdepth_wasm_lines)
target_compile_options(pdepth_wasm_lines PRIVATE -Oz -finline-functions)
pd_unity_by_folder(pdepth_wasm_lines)
target_link_options(pdepth_wasm_lines PRIVATE ${pd_wasm_linking} -sEXPORTED_FUNCTIONS=_malloc,_free,_pdepth_web_answer_line)
set_target_properties(pdepth_wasm_lines PROPERTIES OUTPUT_NAME pdepth-lines SUFFIX .wasm)
# Folders that most questions never enter, or only when a body is made, are compiled for the least size. Properties of a source would
# take it out of its folder's unity, so they are given to the file that CMake generates for the folder.
foreach(folder shape_hull shape_mesh structure structure_bipartite structure_hierarchy structure_overlay depth depth_rays depth_certificate numeric
        compound)
  set_source_files_properties(${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/pd_core.dir/Unity/unity_src_${folder}_cxx.cxx
                              PROPERTIES COMPILE_OPTIONS "-Oz;-finline-functions")
endforeach()
foreach(target pd_core pdepth_wasm pdepth_wasm_convex pdepth_wasm_lines)
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
  target_compile_options(${target} PRIVATE "SHELL:-include ${PROJECT_SOURCE_DIR}/packaging/npm/libcxx_13.hpp")
endforeach()
