# pdepth.wasm, the C interface as a WebAssembly module without glue of JavaScript; packaging/wasm.sh builds it and the npm package
# around it. It exports the functions of pdepth.h, what packaging/npm/bridge.c adds, and malloc and free.
file(GLOB pd_c_interface_sources CONFIGURE_DEPENDS src/c_interface/*.cpp)
add_executable(pdepth_wasm ${pd_c_interface_sources} ${PROJECT_SOURCE_DIR}/packaging/npm/bridge.cpp)
target_include_directories(pdepth_wasm PRIVATE include src)
target_link_libraries(pdepth_wasm PRIVATE pd_core_internals)
pd_compile_options(pdepth_wasm)
foreach(target pd_core pdepth_wasm)
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
  target_compile_options(${target} PRIVATE "SHELL:-include ${PROJECT_SOURCE_DIR}/packaging/npm/libcxx_13.hpp")
endforeach()
pd_unity_by_folder(pdepth_wasm)

file(STRINGS include/pdepth/pdepth.h lines REGEX "^[a-z].*[ *]pdepth_[a-z_]+\\(")
set(exports _malloc,_free,_pdepth_web_layout)
foreach(line ${lines})
  string(REGEX MATCH "(pdepth_[a-z_]+)\\(" found "${line}")
  string(APPEND exports ",_${CMAKE_MATCH_1}")
endforeach()
target_link_options(pdepth_wasm PRIVATE -sSTANDALONE_WASM=1 --no-entry -sALLOW_MEMORY_GROWTH=1 -sMAXIMUM_MEMORY=2GB -sTOTAL_STACK=1MB
                    -sSUPPORT_LONGJMP=0 -sEXPORTED_FUNCTIONS=${exports})
set_target_properties(pdepth_wasm PROPERTIES OUTPUT_NAME pdepth SUFFIX .wasm)
