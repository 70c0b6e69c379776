#include "core/sampling/geometry_phase.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "core/surface/frame.h"

namespace ccst {
namespace {

constexpr int kMaxRing = 96;
constexpr int kMaxHalvings = 4;
/// Least cosine between a triangle and the surface after a move, unless it was worse before.
constexpr double kLeastFacing = 0.2;
/// Longest step in units of the local spacing.
constexpr double kLongestStep = 0.5;
/// Neighbours on a boundary loop do not come nearer than this, in units of the local spacing.
constexpr double kLeastBoundarySpacing = 0.8;
/// Relative change of a triangle's density that counts as none.
constexpr double kDensityRest = 0.01;
/// Bounds a triangle's capacity away from zero in the majoriser's gradient.
constexpr double kLeastCapacity = 0.05;

/// Fewer samples are one block: they are not worth several threads.
constexpr std::int32_t kLeastForBlocks = 32768;

/// Vertices of a block: enough that few lie between blocks, few enough that there are many blocks.
/// Of the number of samples alone, for the order of the visits follows from it.
std::int32_t BlockSize(std::int32_t count) {
  return count < kLeastForBlocks ? count : std::clamp(count / 32, 1024, 8192);
}

/// Square of the cosine between `cross` and `up`, with its sign; -1 where either vanishes.
double SignedFacing(const Eigen::Vector3d& cross, const Eigen::Vector3d& up) {
  const double dot = cross.dot(up);
  const double scale = cross.squaredNorm() * up.squaredNorm();
  return scale > 0.0 ? dot * std::abs(dot) / scale : -1.0;
}

bool FacesEnough(const Eigen::Vector3d& cross, const Eigen::Vector3d& up) {
  const double dot = cross.dot(up);
  return dot > 0.0 &&
         dot * dot > kLeastFacing * kLeastFacing * cross.squaredNorm() * up.squaredNorm();
}

}  // namespace

/// The neighbours of one vertex, counter-clockwise, and what the update needs of them.
struct GeometryPhase::Ring {
  int neighbours = 0;
  int triangles = 0;   ///< As many as neighbours, or one less on the boundary.
  double scale = 0.0;  ///< c = scale * density * |cross product|.
  double energy = 0.0;
  double least_facing = 0.0;  ///< SignedFacing() of the worst triangle that does not face enough.
  double spacing = 0.0;
  std::array<std::int32_t, kMaxRing> vertex;
  std::array<std::int32_t, kMaxRing> half_edge;  ///< Towards the neighbour; -1 for the last of a
                                                 ///< boundary vertex, which has none.
  std::array<Eigen::Vector3d, kMaxRing> position;
  std::array<Eigen::Vector3d, kMaxRing> normal;
  std::array<double, kMaxRing> density;  ///< Of the triangle from this neighbour to the next.
};

GeometryPhase::GeometryPhase(const Surface* surface, const Density* density, const Plan* plan,
                             Energy energy, const SampleMesh* mesh, Samples* samples,
                             const Parallel* parallel, Interrupt* interrupt)
    : surface_(*surface),
      density_(*density),
      plan_(*plan),
      energy_(energy),
      parallel_(*parallel),
      mesh_(*mesh),
      samples_(*samples),
      block_size_(BlockSize(samples->count())),
      blocks_((samples->count() + block_size_ - 1) / std::max(1, block_size_)) {
  scale_.reserve(plan->components.size());
  for (const ComponentPlan& component : plan->components) scale_.push_back(1.0 / component.target);
  active_.assign(samples->count(), 0);
  next_.assign(samples->count(), 1);
  moved_.assign(samples->count(), 1);
  if (density->uniform()) return;
  mean_density_.assign(mesh->triangle_count(), 1.0);
  is_outdated_.assign(samples->count(), 0);
  for (std::int32_t t = 0; t < mesh->triangle_count(); ++t) {
    if (interrupt != nullptr && interrupt->RequestedAt(t)) break;
    mean_density_[t] = MeanDensity(t);
  }
}

double GeometryPhase::MeanDensity(std::int32_t t) const {
  const std::array<std::int32_t, 3> corner = {mesh_.origin[3 * t], mesh_.origin[3 * t + 1],
                                              mesh_.origin[3 * t + 2]};
  const Eigen::Vector3d& a = samples_.position[corner[0]];
  const Eigen::Vector3d& b = samples_.position[corner[1]];
  const Eigen::Vector3d& c = samples_.position[corner[2]];
  const double area = 0.5 * (b - a).cross(c - a).norm();
  // The centres of the four congruent parts, each on the surface as seen from the nearest corner.
  double sum = 0.0;
  for (int k = -1; k < 3; ++k) {
    Eigen::Vector3d weights = Eigen::Vector3d::Constant(k < 0 ? 1.0 / 3.0 : 1.0 / 6.0);
    if (k >= 0) weights[k] = 2.0 / 3.0;
    const SurfacePoint point = surface_.Follow(samples_.face[corner[std::max(k, 0)]],
                                               weights[0] * a + weights[1] * b + weights[2] * c);
    sum += density_.At(point.face, point.weights, 0.25 * area);
  }
  return 0.25 * sum;
}

void GeometryPhase::UpdateAllDensities(Interrupt* interrupt) {
  std::fill(is_outdated_.begin(), is_outdated_.end(), std::uint8_t{1});
  UpdateDensities(interrupt);
}

void GeometryPhase::UpdateDensities(Interrupt* interrupt) {
  if (density_.uniform()) return;
  for (std::int32_t t = 0; t < mesh_.triangle_count(); ++t) {
    if (interrupt->RequestedAt(t)) return;
    const std::int32_t* corner = &mesh_.origin[3 * t];
    if (!(is_outdated_[corner[0]] | is_outdated_[corner[1]] | is_outdated_[corner[2]])) continue;
    const double before = mean_density_[t];
    mean_density_[t] = MeanDensity(t);
    if (std::abs(mean_density_[t] - before) <= kDensityRest * before) continue;
    for (int k = 0; k < 3; ++k) next_[corner[k]] = 1;
  }
  std::fill(is_outdated_.begin(), is_outdated_.end(), std::uint8_t{0});
}

void GeometryPhase::Activate(std::int32_t v) {
  next_[v] = 1;
  if (!is_outdated_.empty()) is_outdated_[v] = 1;
  mesh_.ForEachOutgoing(v, [&](std::int32_t h) {
    next_[mesh_.Target(h)] = 1;
    next_[mesh_.Apex(h)] = 1;
  });
}

void GeometryPhase::DeactivateAll() { std::fill(next_.begin(), next_.end(), std::uint8_t{0}); }

void GeometryPhase::ClearMoved() { std::fill(moved_.begin(), moved_.end(), std::uint8_t{0}); }

double GeometryPhase::Capacity(std::int32_t t) const {
  const Eigen::Vector3d& a = samples_.position[mesh_.origin[3 * t]];
  const Eigen::Vector3d& b = samples_.position[mesh_.origin[3 * t + 1]];
  const Eigen::Vector3d& c = samples_.position[mesh_.origin[3 * t + 2]];
  const double rho = mean_density_.empty() ? 1.0 : mean_density_[t];
  return 0.5 * scale_[samples_.component[mesh_.origin[3 * t]]] * rho * (b - a).cross(c - a).norm();
}

GeometryPhase::Spread GeometryPhase::MeasureCapacities() const {
  if (mesh_.triangle_count() == 0) return {};
  double sum = 0.0;
  double squares = 0.0;
  for (std::int32_t t = 0; t < mesh_.triangle_count(); ++t) {
    const double c = Capacity(t);
    sum += c;
    squares += c * c;
  }
  const double mean = sum / mesh_.triangle_count();
  const double square = squares / mesh_.triangle_count();
  Spread spread;
  spread.energy = energy_ == Energy::kTarget ? square - 2.0 * mean + 1.0 : square;
  spread.cv = mean > 0.0 ? std::sqrt(std::max(0.0, square - mean * mean)) / mean : 0.0;
  return spread;
}

bool GeometryPhase::Gather(std::int32_t v, Ring* ring) const {
  int count = 0;
  const std::int32_t start = mesh_.outgoing[v];
  if (start < 0) return false;  // A point.
  std::int32_t h = start;
  const auto add = [&](std::int32_t u, std::int32_t half_edge) {
    ring->vertex[count] = u;
    ring->half_edge[count] = half_edge;
    ring->position[count] = samples_.position[u];
    ring->normal[count] = samples_.normal[u];
    ring->density[count] =
        mean_density_.empty() || half_edge < 0 ? 1.0 : mean_density_[half_edge / 3];
    ++count;
  };
  while (true) {
    if (count + 1 >= kMaxRing) return false;
    add(mesh_.Target(h), h);
    const std::int32_t previous = SampleMesh::Previous(h);
    const std::int32_t turned = mesh_.twin[previous];
    if (turned < 0) {
      add(mesh_.origin[previous], -1);
      ring->triangles = count - 1;
      break;
    }
    if (turned == start) {
      ring->triangles = count;
      break;
    }
    h = turned;
  }
  ring->neighbours = count;
  ring->scale = 0.5 * scale_[samples_.component[v]];
  return true;
}

bool GeometryPhase::Evaluate(const Ring& ring, const Eigen::Vector3d& position,
                             const Eigen::Vector3d& normal, double* energy) const {
  double sum = 0.0;
  for (int i = 0; i < ring.triangles; ++i) {
    const int j = i + 1 == ring.neighbours ? 0 : i + 1;
    const Eigen::Vector3d cross = (ring.position[i] - position).cross(ring.position[j] - position);
    const double length = cross.norm();
    const Eigen::Vector3d up = normal + ring.normal[i] + ring.normal[j];
    if (!FacesEnough(cross, up) && SignedFacing(cross, up) <= ring.least_facing) return false;
    const double c = ring.scale * ring.density[i] * length;
    sum += energy_ == Energy::kTarget ? (c - 1.0) * (c - 1.0) : c * c;
    if (sum > ring.energy) return false;
  }
  *energy = sum;
  return true;
}

template <typename F>
Eigen::Vector3d GeometryPhase::Sum(const Eigen::Vector3d& s, const Eigen::Vector3d& n, Ring* ring,
                                   F&& add_edge) const {
  // For a triangle (s, p, q) with opposite edge e = q - p and cross product x,
  // grad |x|^2 = 2 x cross e and hess |x|^2 = 2 (|e|^2 I - e e'); c^2 weighs it with density^2.
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  double area = 0.0;
  ring->energy = 0.0;
  ring->least_facing = 1.0;
  for (int i = 0; i < ring->triangles; ++i) {
    const int j = i + 1 == ring->neighbours ? 0 : i + 1;
    const Eigen::Vector3d e = ring->position[j] - ring->position[i];
    const Eigen::Vector3d cross = (ring->position[i] - s).cross(ring->position[j] - s);
    const double length = cross.norm();
    const double c = ring->scale * ring->density[i] * length;
    area += length;
    const Eigen::Vector3d up = n + ring->normal[i] + ring->normal[j];
    if (!FacesEnough(cross, up)) {
      ring->least_facing = std::min(ring->least_facing, SignedFacing(cross, up));
    }
    double pull = 1.0;
    if (energy_ == Energy::kTarget) {
      ring->energy += (c - 1.0) * (c - 1.0);
      pull = 1.0 - 1.0 / std::max(c, kLeastCapacity);
    } else {
      ring->energy += c * c;
    }
    const double weight = ring->density[i] * ring->density[i];
    gradient += weight * pull * cross.cross(e);
    add_edge(e, weight);
  }
  ring->spacing = std::sqrt(2.0 / std::sqrt(3.0) * area / ring->triangles);
  return gradient;
}

double GeometryPhase::MoveInterior(std::int32_t v, Ring* ring) {
  const Eigen::Vector3d s = samples_.position[v];
  const Eigen::Vector3d n = samples_.normal[v];
  Eigen::Vector3d t1;
  Eigen::Vector3d t2;
  TangentFrame(n, &t1, &t2);

  double h11 = 0.0;
  double h12 = 0.0;
  double h22 = 0.0;
  const Eigen::Vector3d gradient = Sum(s, n, ring, [&](const Eigen::Vector3d& e, double weight) {
    const double e1 = e.dot(t1);
    const double e2 = e.dot(t2);
    const double ee = e.squaredNorm();
    h11 += weight * (ee - e1 * e1);
    h12 -= weight * (e1 * e2);
    h22 += weight * (ee - e2 * e2);
  });
  const double g1 = gradient.dot(t1);
  const double g2 = gradient.dot(t2);
  const double bend = gradient.dot(n);
  const Eigen::Matrix<double, 6, 1> shape = surface_.ShapeAt(samples_.face[v], samples_.weights[v]);
  const double ii11 = TensorProduct(shape, t1, t1);
  const double ii12 = TensorProduct(shape, t1, t2);
  const double ii22 = TensorProduct(shape, t2, t2);
  const double m11 = h11 + bend * ii11;
  const double m12 = h12 + bend * ii12;
  const double m22 = h22 + bend * ii22;
  // Where bending makes the form indefinite, the majoriser without it is still convex.
  double determinant = m11 * m22 - m12 * m12;
  double u;
  double w;
  if (m11 > 0.0 && determinant > 1e-3 * (h11 * h22 - h12 * h12)) {
    u = (-g1 * m22 + g2 * m12) / determinant;
    w = (-g2 * m11 + g1 * m12) / determinant;
  } else {
    determinant = h11 * h22 - h12 * h12;
    if (!(determinant > 0.0)) return 0.0;
    u = (-g1 * h22 + g2 * h12) / determinant;
    w = (-g2 * h11 + g1 * h12) / determinant;
  }
  const double size = std::sqrt(u * u + w * w);
  // Far below what counts as rest, however it ended.
  if (!(size > 0.1 * rest * ring->spacing)) return 0.0;
  double factor = std::min(stretch, kLongestStep * ring->spacing / size);
  for (int attempt = 0; attempt <= kMaxHalvings; ++attempt, factor *= 0.5) {
    const double du = factor * u;
    const double dw = factor * w;
    const double rise = 0.5 * (ii11 * du * du + 2.0 * ii12 * du * dw + ii22 * dw * dw);
    const SurfacePoint point = surface_.Follow(samples_.face[v], s + du * t1 + dw * t2 + rise * n);
    const Eigen::Vector3d normal = surface_.NormalAt(point.face, point.weights);
    double energy = 0.0;
    if (!Evaluate(*ring, point.position, normal, &energy)) continue;
    samples_.position[v] = point.position;
    samples_.face[v] = point.face;
    samples_.weights[v] = point.weights;
    samples_.normal[v] = normal;
    return (point.position - s).norm();
  }
  return 0.0;
}

double GeometryPhase::MoveAlong(std::int32_t v, Ring* ring) {
  const std::int32_t loop = samples_.loop[v];
  const double length = plan_.loops[loop].length;
  const double rate = plan_.loops[loop].rate[plan_.loops[loop].Segment(samples_.arc[v])];
  const Eigen::Vector3d s = samples_.position[v];
  const Eigen::Vector3d n = samples_.normal[v];
  // The neighbours along the line.
  int ahead = 0;
  int behind = ring->neighbours - 1;
  if (samples_.kind[v] == SampleMesh::Kind::kCrease) {
    ahead = behind = -1;
    for (int i = 0; i < ring->neighbours; ++i) {
      if (mesh_.IsLocked(ring->half_edge[i])) (ahead < 0 ? ahead : behind) = i;
    }
    if (behind < 0) return 0.0;
    // The line goes on where the arc grows.
    const SurfacePoint further = PointOnLoop(
        surface_, plan_, loop,
        std::min(samples_.arc[v] + 1e-3 * length, plan_.loops[loop].open ? length : 2.0 * length));
    if ((further.position - s).dot(ring->position[ahead] - ring->position[behind]) < 0.0) {
      std::swap(ahead, behind);
    }
  }
  const Eigen::Vector3d chord = ring->position[ahead] - ring->position[behind];
  const double chord_length = chord.norm();
  if (!(chord_length > 0.0)) return 0.0;
  const Eigen::Vector3d t = chord / chord_length;
  double curvature = 0.0;
  const Eigen::Vector3d gradient = Sum(s, n, ring, [&](const Eigen::Vector3d& e, double weight) {
    curvature += weight * (e.squaredNorm() - e.dot(t) * e.dot(t));
  });
  if (!(curvature > 0.0)) return 0.0;
  const double wanted = -gradient.dot(t) / curvature;
  if (!(std::abs(wanted) > 0.1 * rest * ring->spacing)) return 0.0;
  const double nearest =
      std::min((ring->position[ahead] - s).norm(), (ring->position[behind] - s).norm());
  const double longest = std::min(kLongestStep * ring->spacing, 0.4 * nearest);
  const double least = std::min(nearest, kLeastBoundarySpacing * ring->spacing);
  double step = std::clamp(stretch * wanted, -longest, longest);
  for (int attempt = 0; attempt <= kMaxHalvings; ++attempt, step *= 0.5) {
    double arc = samples_.arc[v] + rate * step;
    if (plan_.loops[loop].open) {
      if (!(arc > 0.0 && arc < length)) continue;
    } else {
      arc = std::fmod(arc + length, length);
    }
    if (!(arc >= 0.0 && arc < length)) arc = 0.0;
    const SurfacePoint point = PointOnLoop(surface_, plan_, loop, arc);
    if ((ring->position[ahead] - point.position).norm() < least ||
        (ring->position[behind] - point.position).norm() < least) {
      continue;
    }
    const Eigen::Vector3d normal = surface_.NormalAt(point.face, point.weights);
    double energy = 0.0;
    if (!Evaluate(*ring, point.position, normal, &energy)) continue;
    samples_.position[v] = point.position;
    samples_.face[v] = point.face;
    samples_.weights[v] = point.weights;
    samples_.normal[v] = normal;
    samples_.arc[v] = arc;
    return (point.position - s).norm();
  }
  return 0.0;
}

void GeometryPhase::FindSpoiltEdges(std::int32_t v, const Ring& ring,
                                    std::vector<std::int32_t>* spoilt_edges) const {
  const Eigen::Vector3d& s = samples_.position[v];
  // Around a closed ring every spoke has a triangle on each side; on the boundary the inner ones.
  const bool closed = ring.triangles == ring.neighbours;
  const int first = closed ? 0 : 1;
  const int end = closed ? ring.neighbours : ring.neighbours - 1;
  for (int i = first; i < end; ++i) {
    const Eigen::Vector3d& q = ring.position[i];
    const Eigen::Vector3d& a = ring.position[i == 0 ? ring.neighbours - 1 : i - 1];
    const Eigen::Vector3d& b = ring.position[i + 1 == ring.neighbours ? 0 : i + 1];
    const double cos_a = (s - a).dot(q - a);
    const double cos_b = (s - b).dot(q - b);
    if (cos_a >= 0.0 && cos_b >= 0.0) continue;
    const double sin_a = (s - a).cross(q - a).norm();
    const double sin_b = (s - b).cross(q - b).norm();
    if (sin_a * cos_b + cos_a * sin_b < 0.0) spoilt_edges->push_back(ring.half_edge[i]);
  }
}

void GeometryPhase::Visit(std::int32_t v, Ring* ring, Block* block) {
  const double move =
      samples_.kind[v] == SampleMesh::Kind::kInterior ? MoveInterior(v, ring) : MoveAlong(v, ring);
  FindSpoiltEdges(v, *ring, &block->spoilt_edges);
  if (!(move > 0.0)) return;
  const double relative = move / ring->spacing;
  block->largest_move = std::max(block->largest_move, relative);
  if (relative <= rest) return;
  moved_[v] = 1;
  if (!is_outdated_.empty()) is_outdated_[v] = 1;
  next_[v] = 1;
  for (int i = 0; i < ring->neighbours; ++i) next_[ring->vertex[i]] = 1;
}

double GeometryPhase::Pass(Interrupt* interrupt) {
  active_.swap(next_);
  std::fill(next_.begin(), next_.end(), std::uint8_t{0});
  const auto wants_visit = [&](std::int32_t v) {
    return active_[v] && samples_.kind[v] != SampleMesh::Kind::kFixed;
  };
  parallel_.For(static_cast<std::int64_t>(blocks_.size()), [&, stop = *interrupt](std::int64_t b) {
    Block& block = blocks_[static_cast<std::size_t>(b)];
    block.spoilt_edges.clear();
    block.waiting.clear();
    block.largest_move = 0.0;
    if (Interrupt(stop).Requested()) return;
    const auto first = static_cast<std::int32_t>(b) * block_size_;
    const std::int32_t end = std::min(first + block_size_, samples_.count());
    Ring ring;
    for (std::int32_t v = first; v < end; ++v) {
      if (!wants_visit(v) || !Gather(v, &ring)) continue;
      const bool is_inside = std::all_of(ring.vertex.begin(), ring.vertex.begin() + ring.neighbours,
                                         [&](std::int32_t u) { return u >= first && u < end; });
      if (is_inside) {
        Visit(v, &ring, &block);
      } else {
        block.waiting.push_back(v);
      }
    }
  });
  between_.spoilt_edges.clear();
  between_.largest_move = 0.0;
  Ring ring;
  for (const Block& block : blocks_) {
    between_.spoilt_edges.insert(between_.spoilt_edges.end(), block.spoilt_edges.begin(),
                                 block.spoilt_edges.end());
    between_.largest_move = std::max(between_.largest_move, block.largest_move);
    if (interrupt->Requested()) continue;
    for (const std::int32_t v : block.waiting) {
      if (Gather(v, &ring)) Visit(v, &ring, &between_);
    }
  }
  return between_.largest_move;
}

}  // namespace ccst
