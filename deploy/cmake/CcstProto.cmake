# ccst_proto_library(TARGET ROOT dir PROTOS a.proto ... [GRPC] [DEPS ...]): C++ code generated into
# the build tree. Generated code is compiled without our warnings and included as a system header.
include_guard(GLOBAL)

find_program(CCST_GRPC_CPP_PLUGIN grpc_cpp_plugin REQUIRED)

function(ccst_proto_library target)
  cmake_parse_arguments(arg "GRPC" "ROOT" "PROTOS;DEPS" ${ARGN})
  set(out "${CMAKE_CURRENT_BINARY_DIR}/gen")
  file(MAKE_DIRECTORY "${out}")
  set(generated)
  foreach(proto IN LISTS arg_PROTOS)
    string(REGEX REPLACE "\\.proto$" "" stem "${proto}")
    if(arg_GRPC)
      set(files "${out}/${stem}.grpc.pb.h" "${out}/${stem}.grpc.pb.cc")
      set(flags "--grpc_out=${out}" "--plugin=protoc-gen-grpc=${CCST_GRPC_CPP_PLUGIN}")
    else()
      set(files "${out}/${stem}.pb.h" "${out}/${stem}.pb.cc")
      set(flags "--cpp_out=${out}")
    endif()
    add_custom_command(
      OUTPUT ${files}
      COMMAND protobuf::protoc "--proto_path=${arg_ROOT}" ${flags} "${arg_ROOT}/${proto}"
      DEPENDS "${arg_ROOT}/${proto}" protobuf::protoc
      COMMENT "Generating ${stem}"
      VERBATIM)
    list(APPEND generated ${files})
  endforeach()
  add_library(${target} STATIC ${generated})
  target_include_directories(${target} SYSTEM PUBLIC "${out}")
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_link_libraries(${target} PUBLIC ${arg_DEPS})
  if(CCST_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${CCST_SANITIZE} -fno-omit-frame-pointer)
  endif()
endfunction()
