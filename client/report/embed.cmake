# Writes a source with the bytes of files: cmake -DOUTPUT=… -DNAMES=a;b -DFILES=…;… -P embed.cmake
set(code "#include \"client/report/page_parts.h\"\n\nnamespace ccst::report {\n")
foreach(name file IN ZIP_LISTS NAMES FILES)
  file(READ "${file}" hex HEX)
  string(REGEX REPLACE "(..)" "'\\\\x\\1'," bytes "${hex}")
  string(APPEND code "static constexpr char ${name}Bytes[] = {${bytes}};\n"
    "const std::string_view ${name}(${name}Bytes, sizeof(${name}Bytes));\n")
endforeach()
file(WRITE "${OUTPUT}" "${code}}  // namespace ccst::report\n")
