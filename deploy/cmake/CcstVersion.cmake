# Writes OUTPUT from INPUT with @CCST_VERSION@ and @CCST_REVISION@ filled in, only when the text
# changes. The environment's CCST_REVISION comes before git's answer: images are built without the
# history. Run at every build by the target ccst_revision:
#   cmake -DINPUT=... -DOUTPUT=... -DCCST_VERSION=... -DSOURCE_DIR=... -P CcstVersion.cmake
set(CCST_REVISION "unknown")
find_program(GIT git)
if(NOT "$ENV{CCST_REVISION}" STREQUAL "")
  set(CCST_REVISION "$ENV{CCST_REVISION}")
elseif(GIT AND EXISTS "${SOURCE_DIR}/.git")
  execute_process(COMMAND "${GIT}" -C "${SOURCE_DIR}" rev-parse --short=12 HEAD
    OUTPUT_VARIABLE revision OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE failed ERROR_QUIET)
  if(NOT failed)
    set(CCST_REVISION "${revision}")
    execute_process(COMMAND "${GIT}" -C "${SOURCE_DIR}" diff-index --quiet HEAD --
      RESULT_VARIABLE modified ERROR_QUIET)
    if(modified)
      string(APPEND CCST_REVISION "-modified")
    endif()
  endif()
endif()
configure_file("${INPUT}" "${OUTPUT}" @ONLY)
