#include "tests/paper/crust/delaunay.h"

#include <cstddef>
#include <cstdio>
#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace ccst {
namespace {

constexpr std::size_t kFewest = 5;

absl::Status Refuse(const std::string& message) {
  return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kMeshDegenerate, message);
}

/// Qhull's state; its memory is given back whatever happened.
class Qhull {
 public:
  Qhull() { qh_zero(&state, nullptr); }
  ~Qhull() {
    qh_freeqhull(&state, !qh_ALL);
    int blocks = 0;
    int bytes = 0;
    qh_memfreeshort(&state, &blocks, &bytes);
  }
  Qhull(const Qhull&) = delete;
  Qhull& operator=(const Qhull&) = delete;

  qhT state;
};

}  // namespace

absl::StatusOr<std::vector<std::array<std::int32_t, 4>>> DelaunayTetrahedra(
    const std::vector<Eigen::Vector3d>& points) {
  // Qhull leaves the process over these.
  if (points.size() < kFewest) {
    return Refuse(absl::StrCat(points.size(), " points have no Delaunay tetrahedra that matter; ",
                               kFewest, " are the fewest"));
  }
  std::vector<coordT> coordinates;
  coordinates.reserve(3 * points.size());
  for (const Eigen::Vector3d& p : points) {
    if (!p.allFinite()) return Refuse("a point is not finite");
    coordinates.insert(coordinates.end(), p.data(), p.data() + 3);
  }
  // What Qhull prints goes nowhere: the exit code says enough.
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> silence(std::fopen("/dev/null", "w"),
                                                                &std::fclose);
  const auto qhull = std::make_unique<Qhull>();
  qhT* const qh = &qhull->state;
  char command[] = "qhull d QJ Qbb";
  const int code = qh_new_qhull(qh, 3, static_cast<int>(points.size()), coordinates.data(), False,
                                command, nullptr, silence.get());
  if (code != 0) {
    return Refuse(absl::StrCat("Qhull finds no Delaunay tetrahedra of ", points.size(),
                               " points (exit code ", code, ")"));
  }
  std::vector<std::array<std::int32_t, 4>> tetrahedra;
  facetT* facet = nullptr;
  FORALLfacets {
    if (facet->upperdelaunay) continue;
    std::array<std::int32_t, 4>& corners = tetrahedra.emplace_back();
    std::size_t k = 0;
    vertexT* vertex = nullptr;
    vertexT** vertexp = nullptr;
    FOREACHvertex_(facet->vertices) corners[k++] = qh_pointid(qh, vertex->point);
  }
  return tetrahedra;
}

}  // namespace ccst
