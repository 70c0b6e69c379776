# How every target of the project is compiled, and two helpers to declare them.
include_guard(GLOBAL)

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/bin")

find_program(CCST_CCACHE ccache)
if(CCST_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_C_COMPILER_LAUNCHER "${CCST_CCACHE}")
  set(CMAKE_CXX_COMPILER_LAUNCHER "${CCST_CCACHE}")
endif()

find_package(absl REQUIRED)
find_package(Eigen3 3.4 QUIET NO_MODULE)
if(NOT TARGET Eigen3::Eigen)
  find_package(Eigen3 REQUIRED NO_MODULE)
endif()

# Flags of our own code. Floating-point contraction is off so that equal requests give
# equal bits on every build of one CPU family.
add_library(ccst_flags INTERFACE)
add_library(ccst::flags ALIAS ccst_flags)
target_include_directories(ccst_flags INTERFACE "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>")
target_compile_features(ccst_flags INTERFACE cxx_std_20)
target_compile_options(ccst_flags INTERFACE -Wall -Wextra -Wshadow -Wnon-virtual-dtor
  -Woverloaded-virtual -Wimplicit-fallthrough -ffp-contract=off -fno-math-errno
  $<$<BOOL:${CCST_WERROR}>:-Werror>)
if(CCST_ASSERTIONS)
  # Ours (core/base/assert.h) and those of the standard library, such as indices of vectors.
  target_compile_definitions(ccst_flags INTERFACE CCST_ASSERTIONS _GLIBCXX_ASSERTIONS)
endif()
if(CCST_SANITIZE)
  # GCC takes instrumented code for uses of what is not initialised.
  target_compile_options(ccst_flags INTERFACE -fsanitize=${CCST_SANITIZE}
    -fno-sanitize-recover=all -fno-omit-frame-pointer -Wno-maybe-uninitialized)
  target_link_options(ccst_flags INTERFACE -fsanitize=${CCST_SANITIZE})
endif()
if(CCST_COVERAGE)
  target_compile_options(ccst_flags INTERFACE --coverage)
  target_link_options(ccst_flags INTERFACE --coverage)
endif()

# ccst_library(NAME SOURCES ... [DEPS ...] [PRIVATE_DEPS ...]): target ccst_NAME, alias ccst::NAME.
function(ccst_library name)
  cmake_parse_arguments(arg "" "" "SOURCES;DEPS;PRIVATE_DEPS" ${ARGN})
  add_library(ccst_${name} STATIC ${arg_SOURCES})
  add_library(ccst::${name} ALIAS ccst_${name})
  target_link_libraries(ccst_${name} PUBLIC ${arg_DEPS} 
    PRIVATE "$<BUILD_INTERFACE:ccst::flags>" ${arg_PRIVATE_DEPS})
  target_include_directories(ccst_${name} PUBLIC "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>")
  target_compile_features(ccst_${name} PUBLIC cxx_std_20)
endfunction()

# ccst_test(NAME [SERIAL] SOURCES ... DEPS ... [LABELS ...]): one GoogleTest program, its cases found
# by CTest. SERIAL: no other test runs beside them.
function(ccst_test name)
  cmake_parse_arguments(arg "SERIAL" "" "SOURCES;DEPS;LABELS" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE ccst::flags ${arg_DEPS} GTest::gmock_main GTest::gtest)
  # A test's own code runs briefly; compiling it with all optimizations takes a quarter longer.
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  set(labels ${arg_LABELS})
  if(NOT labels)
    set(labels unit)
  endif()
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60
    PROPERTIES LABELS "${labels}" RUN_SERIAL ${arg_SERIAL})
endfunction()
