# LibTorch as the target mocaplm::torch. Debian's 1.13 package and the archives of 2.x (CPU or CUDA,
# found through CMAKE_PREFIX_PATH) both provide the package "Torch"; only its variables are common to all.
find_package(Torch REQUIRED)
add_library(mocaplm_torch INTERFACE)
add_library(mocaplm::torch ALIAS mocaplm_torch)
target_link_libraries(mocaplm_torch INTERFACE ${TORCH_LIBRARIES})
target_include_directories(mocaplm_torch SYSTEM INTERFACE ${TORCH_INCLUDE_DIRS})
separate_arguments(MOCAPLM_TORCH_FLAGS UNIX_COMMAND "${TORCH_CXX_FLAGS}")
target_compile_options(mocaplm_torch INTERFACE ${MOCAPLM_TORCH_FLAGS})
# LibTorch 2.1 and later compile as C++17 or newer; 2.9 may ask for C++20.
if(Torch_VERSION VERSION_GREATER_EQUAL 2.9 AND CMAKE_CXX_STANDARD LESS 20)
  set(CMAKE_CXX_STANDARD 20)
endif()
message(STATUS "LibTorch ${Torch_VERSION}")
