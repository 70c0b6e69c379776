#include "core/sampling/mesh/sample_mesh.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "core/base/assert.h"

namespace ccst::internal {
namespace {

/// A vertex with more edges is a hub: what is next to it is looked for from the other side.
constexpr std::int32_t kHub = 32;

}  // namespace

void SampleMesh::SetTriangles(std::int32_t vertex_count,
                              const std::vector<Eigen::Vector3i>& triangles) {
  const auto half_edges = static_cast<std::int32_t>(3 * triangles.size());
  origin.resize(half_edges);
  twin.assign(half_edges, -1);
  locked.clear();
  outgoing.assign(vertex_count, -1);
  std::vector<std::int32_t> start(vertex_count + 1, 0);
  for (std::int32_t h = 0; h < half_edges; ++h) {
    origin[h] = triangles[h / 3][0] < 0 ? -1 : triangles[h / 3][h % 3];
    ++start[origin[h] + 1];
  }
  start[0] = 0;  // Where the dead were counted.
  for (std::int32_t v = 0; v < vertex_count; ++v) start[v + 1] += start[v];
  std::vector<std::int32_t> list(half_edges);
  std::vector<std::int32_t> fill(start.begin(), start.end() - 1);
  for (std::int32_t h = 0; h < half_edges; ++h) {
    if (!IsDead(TriangleOf(h))) list[fill[origin[h]]++] = h;
  }
  for (std::int32_t h = 0; h < half_edges; ++h) {
    const std::int32_t from = origin[h];
    const std::int32_t to = Target(h);
    if (from < 0 || from > to) continue;
    // From the end with fewer edges: a hub may have very many.
    if (start[to + 1] - start[to] <= start[from + 1] - start[from]) {
      for (std::int32_t i = start[to]; i < start[to + 1]; ++i) {
        if (Target(list[i]) == from) Pair(h, list[i]);
      }
    } else {
      for (std::int32_t i = start[from]; i < start[from + 1]; ++i) {
        const std::int32_t into = Previous(list[i]);
        if (origin[into] == to) Pair(h, into);
      }
    }
  }
  for (std::int32_t h = 0; h < half_edges; ++h) {
    if (!IsDead(TriangleOf(h))) PointAt(h);
  }
}

void SampleMesh::Pair(std::int32_t a, std::int32_t b) {
  if (a >= 0) twin[a] = b;
  if (b >= 0) twin[b] = a;
  if (!locked.empty() && a >= 0) locked[a] = b >= 0 ? locked[b] : 0;
}

void SampleMesh::Lock(std::int32_t h) {
  CCST_ASSERT(!IsDead(TriangleOf(h)));
  if (locked.empty()) locked.assign(origin.size(), 0);
  locked[h] = 1;
  if (twin[h] >= 0) locked[twin[h]] = 1;
}

/// Lets the origin of `h` leave through `h`, unless it already leaves through the boundary.
void SampleMesh::PointAt(std::int32_t h) {
  std::int32_t& leave = outgoing[origin[h]];
  if (leave < 0 || twin[h] < 0) leave = h;
}

void SampleMesh::SetTriangle(TriangleIndex t, std::int32_t a, std::int32_t b, std::int32_t c) {
  origin[3 * t] = a;
  origin[3 * t + 1] = b;
  origin[3 * t + 2] = c;
  if (!locked.empty()) std::fill_n(locked.begin() + 3 * t, 3, std::uint8_t{0});
}

TriangleIndex SampleMesh::NewTriangle() {
  const TriangleIndex t(triangle_count());
  origin.insert(origin.end(), 3, -1);
  twin.insert(twin.end(), 3, -1);
  if (!locked.empty()) locked.insert(locked.end(), 3, 0);
  return t;
}

std::int32_t SampleMesh::Degree(std::int32_t v) const {
  std::int32_t degree = IsBoundary(v) ? 1 : 0;
  ForEachOutgoing(v, [&](std::int32_t) { ++degree; });
  return degree;
}

bool SampleMesh::HasMoreEdges(std::int32_t v, std::int32_t count) const {
  std::int32_t degree = IsBoundary(v) ? 1 : 0;
  const std::int32_t start = outgoing[v];
  std::int32_t h = start;
  do {
    if (++degree > count) return true;
    h = Rotate(h);
  } while (h >= 0 && h != start);
  return false;
}

std::int32_t SampleMesh::FindEdge(std::int32_t a, std::int32_t b) const {
  std::int32_t h = outgoing[a];
  std::int32_t g = outgoing[b];
  if (g < 0) return -1;
  // Around both at once.
  while (true) {
    if (Target(h) == b) return h;
    if (Apex(h) == b && twin[Previous(h)] < 0) return Previous(h);
    if (Target(g) == a) return twin[g] >= 0 ? twin[g] : g;
    if (Apex(g) == a && twin[Previous(g)] < 0) return Previous(g);
    h = Rotate(h);
    g = Rotate(g);
    if (h < 0 || h == outgoing[a] || g < 0 || g == outgoing[b]) return -1;
  }
}

std::int32_t SampleMesh::CountNeighbours(std::int32_t v,
                                         std::span<const std::int32_t> vertices) const {
  std::int32_t count = 0;
  if (HasMoreEdges(v, kHub)) {
    for (const std::int32_t u : vertices) count += u != v && FindEdge(u, v) >= 0 ? 1 : 0;
    return count;
  }
  ForEachNeighbour(v, [&](std::int32_t neighbour) {
    for (const std::int32_t u : vertices) count += u == neighbour ? 1 : 0;
  });
  return count;
}

std::int32_t SampleMesh::CountCommonNeighbours(std::int32_t v, std::int32_t w) const {
  if (HasMoreEdges(v, kHub)) std::swap(v, w);
  if (HasMoreEdges(v, kHub)) {  // Both are hubs.
    std::int32_t common = 0;
    ForEachNeighbour(v, [&](std::int32_t u) { common += u != w && FindEdge(u, w) >= 0 ? 1 : 0; });
    return common;
  }
  std::array<std::int32_t, kHub> around;
  std::size_t count = 0;
  ForEachNeighbour(v, [&](std::int32_t u) { around[count++] = u; });
  return CountNeighbours(w, {around.data(), count});
}

bool SampleMesh::CanFlip(std::int32_t h) const {
  const std::int32_t g = twin[h];
  if (g < 0 || IsLocked(h)) return false;
  const std::int32_t c = Apex(h);
  const std::int32_t d = Apex(g);
  if (c == d) return false;
  // Both ends lose an edge. An interior vertex of degree three has its three neighbours joined,
  // so the search for the new edge refuses it; a boundary vertex needs one interior edge left
  // only if it had none on the boundary.
  return FindEdge(c, d) < 0;
}

void SampleMesh::Flip(std::int32_t h) {
  CCST_ASSERT(CanFlip(h));
  const std::int32_t g = twin[h];
  const std::int32_t h1 = Next(h);
  const std::int32_t h2 = Previous(h);
  const std::int32_t g1 = Next(g);
  const std::int32_t g2 = Previous(g);
  const std::int32_t a = origin[h];
  const std::int32_t b = origin[g];
  const std::int32_t c = origin[h2];
  const std::int32_t d = origin[g2];
  const std::int32_t ca = twin[h2];
  const std::int32_t bc = twin[h1];
  const std::int32_t db = twin[g2];
  const std::int32_t ad = twin[g1];
  // (a b c) (b a d) -> (d c a) in h's triangle with h: d -> c, (c d b) in g's with g: c -> d.
  origin[h] = d;
  origin[h1] = c;
  origin[h2] = a;
  origin[g] = c;
  origin[g1] = d;
  origin[g2] = b;
  Pair(h1, ca);
  Pair(h2, ad);
  Pair(g1, db);
  Pair(g2, bc);
  if (outgoing[a] == h || outgoing[a] == g1) outgoing[a] = h2;
  if (outgoing[b] == g || outgoing[b] == h1) outgoing[b] = g2;
  if (outgoing[c] == h2) outgoing[c] = h1;
  if (outgoing[d] == g2) outgoing[d] = g1;
}

bool SampleMesh::CanCollapse(std::int32_t h) const {
  const std::int32_t v = origin[h];
  const std::int32_t w = Target(h);
  const std::int32_t g = twin[h];
  const bool on_boundary = IsBoundary(v);
  const std::int32_t edge_triangles = g >= 0 ? 2 : 1;
  if (on_boundary && g >= 0) return false;  // Must go along the boundary.
  if (!locked.empty() && !IsLocked(h)) {
    bool held = false;
    ForEachOutgoing(v, [&](std::int32_t e) { held = held || IsLocked(e); });
    if (held) return false;
  }
  // Two lines must not become one.
  const auto joins_lines = [&](std::int32_t side) {
    return IsLocked(Next(side)) && IsLocked(Previous(side));
  };
  if (joins_lines(h) || (g >= 0 && joins_lines(g))) return false;
  const auto apex_stays = [&](std::int32_t side) {
    const std::int32_t apex = Apex(side);
    return HasMoreEdges(apex, IsBoundary(apex) ? 2 : 3);
  };
  if (!apex_stays(h) || (g >= 0 && !apex_stays(g))) return false;
  if (twin[Next(h)] < 0 && twin[Previous(h)] < 0) return false;
  if (g >= 0 && twin[Next(g)] < 0 && twin[Previous(g)] < 0) return false;

  if (CountCommonNeighbours(v, w) != edge_triangles) return false;
  // A boundary loop keeps at least three vertices.
  if (on_boundary) {
    const std::int32_t after = outgoing[w];
    if (Target(after) == v || Target(outgoing[Target(after)]) == v) return false;
  }
  return true;
}

void SampleMesh::Collapse(std::int32_t h) {
  CCST_ASSERT(!IsDead(TriangleOf(h)) && outgoing[origin[h]] >= 0);
  CCST_ASSERT(!IsBoundary(origin[h]) || twin[h] < 0);
  const std::int32_t v = origin[h];
  const std::int32_t w = Target(h);
  const std::int32_t g = twin[h];
  // How a vertex left before: what was on the boundary stays there, what was not neither.
  struct Leave {
    std::int32_t vertex;
    std::int32_t half_edge;
    bool on_boundary;
  };
  const auto leave_of = [&](std::int32_t u) { return Leave{u, outgoing[u], IsBoundary(u)}; };
  const Leave from_w = leave_of(w);
  const Leave from_left = leave_of(Apex(h));
  const Leave from_right = g >= 0 ? leave_of(Apex(g)) : from_left;
  ForEachOutgoing(v, [&](std::int32_t e) { origin[e] = w; });
  outgoing[v] = -1;

  // Takes the triangle left of `e` out and joins its two neighbours. Afterwards its apex and w
  // leave through a live half-edge again.
  const auto remove_triangle = [&](std::int32_t e) {
    const std::int32_t apex = Apex(e);
    const std::int32_t into = twin[Next(e)];      // apex -> end of e
    const std::int32_t from = twin[Previous(e)];  // start of e -> apex
    const bool lock = IsLocked(Next(e)) || IsLocked(Previous(e));
    Pair(into, from);
    if (lock && into >= 0 && from >= 0) Lock(into);
    const TriangleIndex t = TriangleOf(e);
    for (std::int32_t k = 3 * t; k < 3 * t + 3; ++k) {
      origin[k] = -1;
      twin[k] = -1;
    }
    outgoing[apex] = into >= 0 ? into : Next(from);
    outgoing[w] = from >= 0 ? from : Next(into);
  };
  // Lets a vertex on the boundary leave through it: as before where that is still there, else it is
  // looked for clockwise.
  const auto settle = [&](const Leave& before) {
    const std::int32_t u = before.vertex;
    if (!before.on_boundary) return;
    std::int32_t e = origin[before.half_edge] == u ? before.half_edge : outgoing[u];
    while (twin[e] >= 0) e = Next(twin[e]);
    outgoing[u] = e;
  };
  remove_triangle(h);
  if (g >= 0) remove_triangle(g);
  settle(from_w);
  settle(from_left);
  if (g >= 0) settle(from_right);
}

void SampleMesh::InsertIntoTriangle(std::int32_t v, TriangleIndex t, TriangleIndex slot1,
                                    TriangleIndex slot2) {
  CCST_ASSERT(!IsDead(t) && IsDead(slot1) && IsDead(slot2) && slot1 != slot2);
  CCST_ASSERT(outgoing[v] < 0);
  const std::int32_t a = origin[3 * t];
  const std::int32_t b = origin[3 * t + 1];
  const std::int32_t c = origin[3 * t + 2];
  const std::int32_t bc = twin[3 * t + 1];
  const std::int32_t ca = twin[3 * t + 2];
  const bool lock = IsLocked(3 * t);
  SetTriangle(t, a, b, v);
  if (lock) Lock(3 * t);
  SetTriangle(slot1, b, c, v);
  SetTriangle(slot2, c, a, v);
  Pair(3 * slot1, bc);
  Pair(3 * slot2, ca);
  Pair(3 * t + 1, 3 * slot1 + 2);
  Pair(3 * slot1 + 1, 3 * slot2 + 2);
  Pair(3 * slot2 + 1, 3 * t + 2);
  if (outgoing[b] == 3 * t + 1) outgoing[b] = 3 * slot1;
  if (outgoing[c] == 3 * t + 2) outgoing[c] = 3 * slot2;
  outgoing[v] = 3 * t + 2;
}

void SampleMesh::InsertIntoBoundaryEdge(std::int32_t v, std::int32_t h, TriangleIndex slot) {
  CCST_ASSERT(twin[h] < 0 && !IsDead(TriangleOf(h)) && IsDead(slot) && outgoing[v] < 0);
  // (a b c) with boundary edge a -> b becomes (a v c) and (v b c).
  const std::int32_t b = Target(h);
  const std::int32_t c = Apex(h);
  const std::int32_t next = Next(h);
  const std::int32_t bc = twin[next];
  const std::int32_t before = outgoing[b];
  origin[next] = v;
  SetTriangle(slot, v, b, c);
  twin[3 * slot] = -1;
  twin[3 * slot + 1] = -1;
  Pair(3 * slot + 1, bc);
  Pair(next, 3 * slot + 2);
  if (before == next) outgoing[b] = 3 * slot + 1;
  outgoing[v] = 3 * slot;
}

void SampleMesh::InsertIntoEdge(std::int32_t v, std::int32_t h, TriangleIndex slot1,
                                TriangleIndex slot2) {
  CCST_ASSERT(twin[h] >= 0 && IsDead(slot1) && IsDead(slot2) && slot1 != slot2);
  CCST_ASSERT(outgoing[v] < 0);
  // (a b c) becomes (a v c) and (v b c), (b a d) becomes (b v d) and (v a d).
  const std::int32_t g = twin[h];
  const std::int32_t a = origin[h];
  const std::int32_t b = origin[g];
  const std::int32_t bc = twin[Next(h)];
  const std::int32_t ad = twin[Next(g)];
  const bool lock = IsLocked(h);
  SetTriangle(slot1, v, b, Apex(h));
  SetTriangle(slot2, v, a, Apex(g));
  Pair(3 * slot1 + 1, bc);
  Pair(3 * slot2 + 1, ad);
  if (outgoing[b] == Next(h)) outgoing[b] = 3 * slot1 + 1;
  if (outgoing[a] == Next(g)) outgoing[a] = 3 * slot2 + 1;
  origin[Next(h)] = v;
  origin[Next(g)] = v;
  Pair(Next(h), 3 * slot1 + 2);
  Pair(Next(g), 3 * slot2 + 2);
  Pair(h, 3 * slot2);
  Pair(g, 3 * slot1);
  outgoing[v] = 3 * slot1;
  if (!lock) return;
  Lock(h);
  Lock(g);
}

}  // namespace ccst::internal
