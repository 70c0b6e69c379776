#include "core/sampling/relax/geometry_phase.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "core/sampling/relax/ring.h"
#include "core/surface/frame.h"

namespace ccst::internal {
namespace {

constexpr int kMaxHalvings = 4;
/// Neighbours on a boundary loop do not come nearer than this, in units of the local spacing.
constexpr double kLeastBoundarySpacing = 0.8;
/// Relative change of a triangle's density that counts as none.
constexpr double kDensityRest = 0.01;
/// Units of work, for an Interrupt, of measuring a triangle's density: four walks over the surface.
constexpr std::int64_t kDensityWork = 16;
/// Triangles or vertices of the surface that one thread takes in one go.
constexpr std::int32_t kPiece = 8192;

double SpacingOf(const Ring& ring, const RingSums& sums) {
  return std::sqrt(2.0 / std::sqrt(3.0) * sums.area / ring.triangles);
}

std::vector<HostVertex> HostVertices(const Surface& surface, const Parallel& parallel) {
  std::vector<HostVertex> hosts(surface.vertex_count());
  parallel.ForRanges(surface.vertex_count(), kPiece, [&](std::int64_t first, std::int64_t end) {
    for (std::int64_t i = first; i < end; ++i) {
      const auto v = static_cast<std::size_t>(i);
      HostVertex& host = hosts[v];
      Eigen::Vector3d::Map(host.position) = surface.positions()[v];
      const std::int32_t h = surface.outgoing()[v];
      const auto shape = surface.ShapeAt(h / 3, Eigen::Vector3d::Unit(h % 3)).cast<float>().eval();
      host.shape[0] = shape[0];
      host.shape[1] = 1.0F;
      std::copy_n(shape.data() + 1, 5, host.shape + 2);
      Eigen::Vector3f::Map(host.normal) = surface.normals()[v].cast<float>();
    }
  });
  return hosts;
}

}  // namespace

GeometryPhase::GeometryPhase(const Surface* surface, const Density* density, const Plan* plan,
                             Energy energy, SampleMesh* mesh, Samples* samples,
                             const Parallel* parallel, Interrupt* interrupt)
    : surface_(*surface),
      density_(*density),
      plan_(*plan),
      energy_(energy),
      parallel_(*parallel),
      packed_(surface, /*with_triangles=*/!density->uniform(), mesh, samples),
      mesh_(packed_.mesh()),
      samples_(packed_.samples()),
      hosts_(HostVertices(*surface, *parallel)),
      levels_{MakeLevels(false), MakeLevels(true)} {
  scale_.reserve(plan->components.size());
  for (const ComponentPlan& component : plan->components) scale_.push_back(1.0 / component.target);
  active_.assign(samples->count(), 1);
  moved_.assign(samples->count(), 1);
  if (density->uniform()) return;
  mean_density_.assign(mesh->triangle_count(), 1.0F);
  is_outdated_.assign(samples->count(), 1);
  Interrupt never;
  UpdateDensities(interrupt != nullptr ? interrupt : &never);
}

double GeometryPhase::MeanDensity(TriangleIndex t) const {
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

void GeometryPhase::Restore(Snapshot* snapshot, Interrupt* interrupt) {
  packed_.Restore(snapshot, parallel_);
  std::fill(is_outdated_.begin(), is_outdated_.end(), std::uint8_t{1});
  UpdateDensities(interrupt);
}

void GeometryPhase::UpdateDensities(Interrupt* interrupt) {
  if (density_.uniform()) return;
  const std::int32_t count = mesh_.triangle_count();
  std::vector<std::vector<std::int32_t>> changed((count + kPiece - 1) / kPiece);
  parallel_.For(static_cast<std::int64_t>(changed.size()), [&, stop = *interrupt](std::int64_t p) {
    Interrupt own(stop);
    const auto first = static_cast<std::int32_t>(p) * kPiece;
    for (std::int32_t t = first; t < std::min(first + kPiece, count); ++t) {
      if (own.RequestedAfter(1)) return;
      const std::int32_t* corner = &mesh_.origin[3 * t];
      if (!(is_outdated_[corner[0]] | is_outdated_[corner[1]] | is_outdated_[corner[2]])) continue;
      if (own.RequestedAfter(kDensityWork)) return;
      const double before = mean_density_[t];
      mean_density_[t] = static_cast<float>(MeanDensity(TriangleIndex(t)));
      if (std::abs(mean_density_[t] - before) > kDensityRest * before) {
        changed[static_cast<std::size_t>(p)].push_back(t);
      }
    }
  });
  if (interrupt->Requested()) return;
  for (const std::vector<std::int32_t>& piece : changed) {
    for (const std::int32_t t : piece) {
      for (int k = 0; k < 3; ++k) active_[mesh_.origin[3 * t + k]] = 1;
    }
  }
  std::fill(is_outdated_.begin(), is_outdated_.end(), std::uint8_t{0});
}

void GeometryPhase::Activate(std::int32_t v) {
  if (!is_outdated_.empty()) is_outdated_[v] = 1;
  active_[v] = 1;
  mesh_.ForEachOutgoing(v, [&](std::int32_t h) {
    active_[mesh_.Target(h)] = 1;
    active_[mesh_.Apex(h)] = 1;
  });
}

void GeometryPhase::ActivateFlipped(std::int32_t v) {
  if (!is_outdated_.empty()) is_outdated_[v] = 1;
  active_[v] = 1;
}

void GeometryPhase::DeactivateAll() { std::fill(active_.begin(), active_.end(), std::uint8_t{0}); }

void GeometryPhase::ClearMoved() { std::fill(moved_.begin(), moved_.end(), std::uint8_t{0}); }

double GeometryPhase::Capacity(TriangleIndex t) const {
  const Eigen::Vector3d& a = samples_.position[mesh_.origin[3 * t]];
  const Eigen::Vector3d& b = samples_.position[mesh_.origin[3 * t + 1]];
  const Eigen::Vector3d& c = samples_.position[mesh_.origin[3 * t + 2]];
  const double rho = mean_density_.empty() ? 1.0 : mean_density_[t];
  return 0.5 * scale_[samples_.component[mesh_.origin[3 * t]]] * rho * (b - a).cross(c - a).norm();
}

GeometryPhase::Spread GeometryPhase::SpreadOf(
    const std::function<CapacitySums(std::int32_t, std::int32_t)>& sum) const {
  const std::int32_t count = mesh_.triangle_count();
  if (count == 0) return {};
  // Sums of pieces, put together in their order: the same bits on any number of threads.
  std::vector<CapacitySums> pieces((count + kPiece - 1) / kPiece);
  parallel_.For(static_cast<std::int64_t>(pieces.size()), [&](std::int64_t p) {
    const auto first = static_cast<std::int32_t>(p) * kPiece;
    pieces[static_cast<std::size_t>(p)] = sum(first, first + std::min(kPiece, count - first));
  });
  CapacitySums sums;
  for (const CapacitySums& piece : pieces) {
    sums.apart += piece.apart;
    sums.square += piece.square;
  }
  const double apart = sums.apart / count;
  const double square = sums.square / count;
  Spread spread;
  spread.energy = energy_ == Energy::kTarget ? square : square + 2.0 * apart + 1.0;
  spread.cv = apart > -1.0 ? std::sqrt(std::max(0.0, square - apart * apart)) / (1.0 + apart) : 0.0;
  return spread;
}

GeometryPhase::Spread GeometryPhase::MeasureCapacities() const {
  return SpreadOf([&](std::int32_t first, std::int32_t end) {
    CapacitySums sums;
    for (std::int32_t t = first; t < end; ++t) {
      const double apart = Capacity(TriangleIndex(t)) - 1.0;
      sums.apart += apart;
      sums.square += apart * apart;
    }
    return sums;
  });
}

GeometryPhase::Spread GeometryPhase::EstimateCapacities() const {
  const CapacitySources sources = {
      .places = packed_.places().data(),
      .origins = mesh_.origin.data(),
      .components = samples_.component.data(),
      .scales = scale_.data(),
      .densities = mean_density_.empty() ? nullptr : mean_density_.data()};
  return SpreadOf([&](std::int32_t first, std::int32_t end) {
    return SumCapacities(sources, registers_, first, end);
  });
}

bool GeometryPhase::Gather(std::int32_t v, Ring* ring) const {
  ring->neighbours = 0;
  ring->scale = 0.5 * scale_[samples_.component[v]];
  ring->uniform = mean_density_.empty();
  const std::int32_t start = mesh_.outgoing[v];
  if (start < 0) return false;  // A point.
  std::int32_t h = start;
  const auto add = [&](std::int32_t u, std::int32_t half_edge) {
    ring->vertex[ring->neighbours] = u;
    ring->half_edge[ring->neighbours] = half_edge;
    if (!ring->uniform && half_edge >= 0) {
      ring->density[ring->neighbours] = mean_density_[half_edge / 3];
    }
    ++ring->neighbours;
  };
  ring->closed = false;
  while (!ring->closed) {
    if (ring->neighbours + 1 >= Ring::kMost) return false;
    add(mesh_.Target(h), h);
    const std::int32_t turned = mesh_.Rotate(h);
    if (turned < 0) {
      add(mesh_.Apex(h), -1);
      break;
    }
    ring->closed = turned == start;
    h = turned;
  }
  return true;
}

bool GeometryPhase::Improves(const Ring& ring, const RingSums& before, const Eigen::Vector3d& step,
                             const Eigen::Vector3d& normal, RingAngles* angles) const {
  double energy = 0.0;
  return Evaluate(ring, energy_, step, normal, before.least_facing, registers_, &energy, angles) &&
         energy <= before.energy * (1.0 - kRelativeEnergyRounding) - kEnergyRounding;
}

double GeometryPhase::MoveInterior(std::int32_t v, Ring* ring, RingAngles* angles) {
  const Eigen::Vector3d s = samples_.position[v];
  const Eigen::Vector3d n = samples_.normal[v];
  Eigen::Vector3d t1;
  Eigen::Vector3d t2;
  TangentFrame(n, &t1, &t2);

  const RingSums sums = Sum(*ring, energy_, n, t1, t2, registers_);
  ring->spacing = SpacingOf(*ring, sums);
  const double h11 = sums.h11;
  const double h12 = sums.h12;
  const double h22 = sums.h22;
  const double g1 = sums.gradient.dot(t1);
  const double g2 = sums.gradient.dot(t2);
  const double bend = sums.gradient.dot(n);
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
  if (!(size > kLeastStep * rest * ring->spacing)) return 0.0;
  double factor = std::min(stretch, kLongestStep * ring->spacing / size);
  for (int attempt = 0; attempt <= kMaxHalvings; ++attempt, factor *= 0.5) {
    const double du = factor * u;
    const double dw = factor * w;
    const double rise = 0.5 * (ii11 * du * du + 2.0 * ii12 * du * dw + ii22 * dw * dw);
    const SurfacePoint point = surface_.Follow(samples_.face[v], s + du * t1 + dw * t2 + rise * n);
    const Eigen::Vector3d normal = surface_.NormalAt(point.face, point.weights);
    if (!Improves(*ring, sums, point.position - s, normal, angles)) continue;
    packed_.Move(v, point, normal);
    return (point.position - s).norm();
  }
  return 0.0;
}

double GeometryPhase::RegularSpacing(std::int32_t component) const {
  return std::sqrt(4.0 / (std::sqrt(3.0) * scale_[component]));
}

double GeometryPhase::MoveAlong(std::int32_t v, Ring* ring, RingAngles* angles) {
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
    const Eigen::Vector3d chord =
        samples_.position[ring->vertex[ahead]] - samples_.position[ring->vertex[behind]];
    if ((further.position - s).dot(chord) < 0.0) std::swap(ahead, behind);
  }
  const Eigen::Vector3d& position_ahead = samples_.position[ring->vertex[ahead]];
  const Eigen::Vector3d& position_behind = samples_.position[ring->vertex[behind]];
  const Eigen::Vector3d chord = position_ahead - position_behind;
  const double chord_length = chord.norm();
  if (!(chord_length > 0.0)) return 0.0;
  const Eigen::Vector3d t = chord / chord_length;
  const RingSums sums = Sum(*ring, energy_, n, t, t, registers_);
  ring->spacing = SpacingOf(*ring, sums);
  const double curvature = sums.h11;
  if (!(curvature > 0.0)) return 0.0;
  const double wanted = -sums.gradient.dot(t) / curvature;
  if (!(std::abs(wanted) > kLeastStep * rest * ring->spacing)) return 0.0;
  const double nearest = std::min((position_ahead - s).norm(), (position_behind - s).norm());
  const double longest = std::min(kLongestStep * ring->spacing, 0.4 * nearest);
  // Where triangles are small for now samples are to come apart again.
  const double regular = mean_density_.empty() ? RegularSpacing(samples_.component[v]) : 0.0;
  const double least = std::min(nearest, kLeastBoundarySpacing * std::max(ring->spacing, regular));
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
    if ((position_ahead - point.position).norm() < least ||
        (position_behind - point.position).norm() < least) {
      continue;
    }
    const Eigen::Vector3d normal = surface_.NormalAt(point.face, point.weights);
    if (!Improves(*ring, sums, point.position - s, normal, angles)) continue;
    packed_.MoveAlong(v, arc, point, normal);
    return (point.position - s).norm();
  }
  return 0.0;
}

void GeometryPhase::AddSpokes(std::int32_t v, const int* spokes, int count,
                              std::vector<std::int32_t>* half_edges) const {
  std::int32_t h = mesh_.outgoing[v];
  int at = 0;
  for (int k = 0; k < count; ++k) {
    for (; at < spokes[k]; ++at) h = mesh_.Rotate(h);
    half_edges->push_back(h);
  }
}

void GeometryPhase::NoteMove(std::int32_t v, double relative, const std::int32_t* neighbours,
                             int count, Block* block) {
  block->change.largest_move = std::max(block->change.largest_move, relative);
  if (relative <= rest) return;
  moved_[v] = 1;
  if (!is_outdated_.empty()) is_outdated_[v] = 1;
  active_[v] = 1;
  for (int i = 0; i < count; ++i) active_[neighbours[i]] = 1;
}

void GeometryPhase::Visit(std::int32_t v, Ring* ring, Block* block) {
  Finish(packed_.places().data(), packed_.normals().data(), v, registers_, ring);
  RingAngles angles;
  const double move = samples_.kind[v] == SampleMesh::Kind::kInterior
                          ? MoveInterior(v, ring, &angles)
                          : MoveAlong(v, ring, &angles);
  if (!(move > 0.0)) MeasureAngles(*ring, registers_, &angles);
  std::array<int, Ring::kMost> spokes;
  const int spoilt = FindSpoilt(*ring, angles, registers_, &spokes);
  AddSpokes(v, spokes.data(), spoilt, &block->spoilt_edges);
  if (!(move > 0.0)) return;
  NoteMove(v, move / ring->spacing, ring->vertex.data(), ring->neighbours, block);
}

void GeometryPhase::VisitAlone(std::int32_t v, Ring* ring, Block* block) {
  if (Gather(v, ring)) Visit(v, ring, block);
}

}  // namespace ccst::internal
