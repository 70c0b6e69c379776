#include "server/base/free_memory.h"

#include <cstdlib>  // Says which C library this is.

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace ccst::server {

void ReturnFreeMemory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

}  // namespace ccst::server
