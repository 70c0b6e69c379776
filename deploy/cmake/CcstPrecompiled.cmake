# Compiles the headers that most sources include only once, which halves the time of a build that
# starts from nothing. For the programs alone, and off unless asked for: it hides that a source
# includes too little, and ccache keeps nothing of what is compiled this way.
include_guard(GLOBAL)

# ccst_targets_of_ours(DIRECTORY OUT): the libraries declared with ccst_library there and below.
function(ccst_targets_of_ours directory out)
  get_property(targets DIRECTORY "${directory}" PROPERTY BUILDSYSTEM_TARGETS)
  set(found)
  foreach(target IN LISTS targets)
    get_target_property(type ${target} TYPE)
    get_target_property(links ${target} LINK_LIBRARIES)
    if(type STREQUAL "STATIC_LIBRARY" AND links MATCHES "ccst::flags")
      list(APPEND found ${target})
    endif()
  endforeach()
  get_property(folders DIRECTORY "${directory}" PROPERTY SUBDIRECTORIES)
  foreach(folder IN LISTS folders)
    ccst_targets_of_ours("${folder}" below)
    list(APPEND found ${below})
  endforeach()
  set(${out} ${found} PARENT_SCOPE)
endfunction()

# ccst_precompile(NAME HEADERS ... LINKS ... TARGETS ...): HEADERS before every source of TARGETS.
function(ccst_precompile name)
  cmake_parse_arguments(arg "" "" "HEADERS;LINKS;TARGETS" ${ARGN})
  file(CONFIGURE OUTPUT "${PROJECT_BINARY_DIR}/${name}.cc" CONTENT "")
  add_library(${name} OBJECT "${PROJECT_BINARY_DIR}/${name}.cc")
  target_link_libraries(${name} PRIVATE ccst::flags ${arg_LINKS})
  target_precompile_headers(${name} PRIVATE ${arg_HEADERS})
  foreach(target IN LISTS arg_TARGETS)
    target_precompile_headers(${target} REUSE_FROM ${name})
  endforeach()
endfunction()

# Everywhere or nowhere: a header compiled without it does not fit a source compiled with it. One
# that does not fit is read as text.
target_compile_options(ccst_flags INTERFACE -pthread -Wno-error=invalid-pch)

ccst_targets_of_ours("${PROJECT_SOURCE_DIR}" others)
# Those that see the API's messages, whose headers are the longest.
set(api ${others})
list(FILTER api INCLUDE REGEX "^ccst_(convert|server_rpc.*|server_app|client|client_cli)$")
list(REMOVE_ITEM others ${api})
set(common <Eigen/Geometry> <absl/status/statusor.h> <absl/strings/str_cat.h> <absl/time/time.h>
  <algorithm> <chrono> <filesystem> <functional> <map> <memory> <mutex> <optional> <span>
  <stop_token> <string> <thread> <vector>)
set(links absl::statusor absl::strings absl::time Eigen3::Eigen)
ccst_precompile(ccst_common_headers HEADERS ${common} LINKS ${links} TARGETS ${others})
if(TARGET ccst_proto_grpc)
  ccst_precompile(ccst_api_headers
    HEADERS ${common} <ccst/v1/mesh_service.grpc.pb.h> <ccst/v1/sampling_service.grpc.pb.h>
      <ccst/v1/server_info_service.grpc.pb.h>
    LINKS ${links} ccst::proto_grpc TARGETS ${api})
endif()
