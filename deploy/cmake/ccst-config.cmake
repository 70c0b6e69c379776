include(CMakeFindDependencyMacro)
find_dependency(absl)
find_dependency(Eigen3 3.4)
include("${CMAKE_CURRENT_LIST_DIR}/ccst-targets.cmake")
