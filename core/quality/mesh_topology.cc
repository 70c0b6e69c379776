#include "core/quality/mesh_topology.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/mesh/faces.h"

namespace ccst::quality {
namespace {

// Disjoint sets with path halving.
class UnionFind {
 public:
  explicit UnionFind(std::size_t size) : parent_(size) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  std::size_t Find(std::size_t x) {
    while (parent_[x] != x) x = parent_[x] = parent_[parent_[x]];
    return x;
  }
  void Merge(std::size_t a, std::size_t b) { parent_[Find(a)] = Find(b); }

 private:
  std::vector<std::size_t> parent_;
};

// One side of a face, from corner `corner` (3 * face + slot) to the next.
struct Side {
  std::int32_t low, high;  // Its end points, sorted.
  std::int64_t corner;
  bool forward;  // Runs from low to high.
};

std::vector<std::vector<std::int32_t>> TraceLoops(
    std::vector<std::pair<std::int32_t, std::int32_t>> open_sides) {
  std::sort(open_sides.begin(), open_sides.end());
  std::vector<bool> walked(open_sides.size(), false);
  std::vector<std::vector<std::int32_t>> loops;
  for (std::size_t start = 0; start < open_sides.size(); ++start) {
    if (walked[start]) continue;
    std::vector<std::int32_t>& loop = loops.emplace_back();
    std::size_t side = start;
    while (side < open_sides.size() && !walked[side]) {
      walked[side] = true;
      loop.push_back(open_sides[side].first);
      const std::int32_t to = open_sides[side].second;
      side = std::lower_bound(open_sides.begin(), open_sides.end(), std::pair(to, INT32_MIN)) -
             open_sides.begin();
      // A defective vertex may have several ways on; any pairing gives closed walks.
      while (side < open_sides.size() && open_sides[side].first == to && walked[side]) ++side;
      if (side < open_sides.size() && open_sides[side].first != to) break;
    }
  }
  return loops;
}

}  // namespace

MeshTopology MeasureTopology(std::int64_t vertex_count,
                             std::span<const Eigen::Vector3i> triangles) {
  MeshTopology result;
  const auto note = [&result](auto&&... parts) {
    if (result.first_defect.empty()) result.first_defect = absl::StrCat(parts...);
  };

  std::vector<Eigen::Vector3i> faces;  // The usable ones.
  faces.reserve(triangles.size());
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    const Eigen::Vector3i& t = triangles[f];
    const bool in_range = t.minCoeff() >= 0 && t.maxCoeff() < vertex_count;
    if (in_range && t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) {
      faces.push_back(t);
      continue;
    }
    ++result.bad_faces;
    note("face ", f, " (", t[0], ", ", t[1], ", ", t[2], ") has ",
         in_range ? "a repeated index" : "an index out of range");
  }
  result.faces = static_cast<std::int64_t>(faces.size());

  std::vector<std::array<std::int32_t, 3>> keys(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    keys[f] = {faces[f][0], faces[f][1], faces[f][2]};
    std::sort(keys[f].begin(), keys[f].end());
  }
  std::sort(keys.begin(), keys.end());
  for (std::size_t f = 1; f < keys.size(); ++f) {
    if (keys[f] != keys[f - 1]) continue;
    ++result.duplicate_faces;
    note("vertices ", keys[f][0], ", ", keys[f][1], ", ", keys[f][2], " carry two faces");
  }

  std::vector<Side> sides;
  sides.reserve(3 * faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (int slot = 0; slot < 3; ++slot) {
      const std::int32_t from = faces[f][slot];
      const std::int32_t to = faces[f][(slot + 1) % 3];
      sides.push_back({std::min(from, to), std::max(from, to),
                       static_cast<std::int64_t>(3 * f + slot), from < to});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.corner) < std::tie(b.low, b.high, b.corner);
  });

  // Corners at one vertex belong to one fan when their faces share an edge of two faces.
  UnionFind fans(3 * faces.size());
  UnionFind components(faces.size());
  std::vector<std::pair<std::int32_t, std::int32_t>> open_sides;
  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    while (end < sides.size() && sides[end].low == sides[begin].low &&
           sides[end].high == sides[begin].high) {
      ++end;
    }
    ++result.edges;
    for (std::size_t s = begin + 1; s < end; ++s) {
      components.Merge(sides[begin].corner / 3, sides[s].corner / 3);
    }
    const Side& a = sides[begin];
    if (end - begin == 1) {
      open_sides.emplace_back(a.forward ? a.low : a.high, a.forward ? a.high : a.low);
    } else if (end - begin == 2) {
      const Side& b = sides[begin + 1];
      const bool opposite = a.forward != b.forward;
      if (!opposite) {
        ++result.inconsistent_edges;
        note("the two faces of edge (", a.low, ", ", a.high, ") have opposite orientations");
      }
      fans.Merge(a.corner, opposite ? NextHalfEdge(b.corner) : b.corner);
      fans.Merge(NextHalfEdge(a.corner), opposite ? b.corner : NextHalfEdge(b.corner));
    } else {
      ++result.crowded_edges;
      note("edge (", a.low, ", ", a.high, ") has ", end - begin, " faces");
    }
  }
  result.boundary_loops = TraceLoops(std::move(open_sides));

  std::vector<std::int32_t> fan_count(vertex_count, 0);
  for (std::size_t corner = 0; corner < 3 * faces.size(); ++corner) {
    if (fans.Find(corner) == corner) ++fan_count[faces[corner / 3][corner % 3]];
    if (corner % 3 == 0 && components.Find(corner / 3) == corner / 3) ++result.components;
  }
  for (std::int64_t v = 0; v < vertex_count; ++v) {
    if (fan_count[v] == 0) {
      ++result.unused_vertices;
      note("vertex ", v, " has no face");
    } else {
      ++result.vertices;
      if (fan_count[v] > 1) {
        ++result.split_vertices;
        note("the faces of vertex ", v, " form ", fan_count[v], " fans");
      }
    }
  }
  result.euler = result.vertices - result.edges + result.faces;
  return result;
}

double LoopLength(std::span<const Eigen::Vector3d> positions, std::span<const std::int32_t> loop) {
  double length = 0.0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    length += (positions[loop[(i + 1) % loop.size()]] - positions[loop[i]]).norm();
  }
  return length;
}

}  // namespace ccst::quality
