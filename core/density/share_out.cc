#include "core/density/share_out.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "core/base/assert.h"

namespace ccst {

std::vector<std::int64_t> ShareOut(std::int64_t count, const std::vector<double>& sizes) {
  double total = 0.0;
  for (const double size : sizes) total += size;
  CCST_ASSERT(count >= 0 && total > 0.0);
  std::vector<std::int64_t> shares(sizes.size());
  std::vector<std::pair<double, std::size_t>> remainders(sizes.size());
  std::int64_t left = count;
  for (std::size_t c = 0; c < sizes.size(); ++c) {
    const double exact = static_cast<double>(count) * (sizes[c] / total);
    shares[c] = std::min(left, static_cast<std::int64_t>(exact));
    left -= shares[c];
    remainders[c] = {static_cast<double>(shares[c]) - exact, c};
  }
  std::sort(remainders.begin(), remainders.end());
  for (std::size_t k = 0; left > 0; ++k, --left) {
    ++shares[remainders[k % remainders.size()].second];
  }
  return shares;
}

}  // namespace ccst
