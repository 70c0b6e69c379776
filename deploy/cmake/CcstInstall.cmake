# Installs the core library for other CMake projects: find_package(ccst), then ccst::sampling.
#   cmake --install build/release --component core --prefix DIR
include_guard(GLOBAL)
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

# Sampling and every room it may link.
set(targets)
foreach(name IN ITEMS base random parallel mesh spatial surface repair density methods quality
    sampling_types sampling_mesh sampling_input sampling_start sampling_relax sampling_output
    sampling)
  if(NOT TARGET ccst_${name})
    continue()
  endif()
  list(APPEND targets ccst_${name})
  set_target_properties(ccst_${name} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(ccst_${name} INTERFACE
    "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/ccst>")
endforeach()

set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/ccst")
install(TARGETS ${targets} EXPORT ccst-targets ARCHIVE COMPONENT core)
install(EXPORT ccst-targets NAMESPACE ccst:: DESTINATION "${package_dir}" COMPONENT core)

# The public interface and what it includes.
foreach(header IN ITEMS base/interrupt.h base/status.h density/image.h
    mesh/triangle_mesh.h parallel/parallel.h repair/repair.h repair/repair_report.h
    sampling/energy.h sampling/options.h sampling/result.h sampling/run_control.h
    sampling/sampling.h)
  get_filename_component(folder "${header}" DIRECTORY)
  install(FILES "${PROJECT_SOURCE_DIR}/core/${header}"
    DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/ccst/core/${folder}" COMPONENT core)
endforeach()

write_basic_package_version_file("${PROJECT_BINARY_DIR}/ccst-config-version.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/ccst-config-version.cmake"
  "${CMAKE_CURRENT_LIST_DIR}/ccst-config.cmake" DESTINATION "${package_dir}" COMPONENT core)
