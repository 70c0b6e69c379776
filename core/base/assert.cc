#include "core/base/assert.h"

#include <cstdio>
#include <cstdlib>

namespace ccst::internal {

void FailAssertion(const char* file, int line, const std::string& what) {
  std::fprintf(stderr, "%s:%d: this must hold and does not: %s\n", file, line, what.c_str());
  std::abort();
}

}  // namespace ccst::internal
