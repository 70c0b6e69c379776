#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"

namespace ccst::cli {

/// A file as a command line names it; an empty path is none.
struct NamedFile {
  std::string name;  ///< For people: its flag, or what it is.
  std::string path;  ///< `-` is standard output, of an input standard input.
};

/// Checks that no output is one of the inputs and that no two outputs are one file, whichever names
/// they go by: relative, through symbolic or hard links, as /dev/stdout. The buffers beside an
/// input in glTF count as inputs. Devices and pipes may be read and written at once; /dev/null
/// takes any number of outputs.
/// @errors INVALID_ARGUMENT naming both files
absl::Status CheckDistinct(const std::vector<NamedFile>& outputs,
                           const std::vector<NamedFile>& inputs);

}  // namespace ccst::cli
