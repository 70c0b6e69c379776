#include "client/report/figure_table.h"

namespace ccst::report {
namespace {

using analysis::SampleFigures;
using Best = FigureLine::Best;

template <double SampleFigures::*Member>
std::optional<double> Of(const Row& row) {
  if (!row.figures.has_value()) return std::nullopt;
  return (*row.figures).*Member;
}

template <double SampleFigures::Mesh::*Member, int Scale = 1>
std::optional<double> OfMesh(const Row& row) {
  if (!row.figures.has_value() || !row.figures->mesh.has_value()) return std::nullopt;
  return Scale * (*row.figures->mesh).*Member;
}

template <std::optional<double> SampleFigures::Mesh::*Member>
std::optional<double> OfDistance(const Row& row) {
  if (!row.figures.has_value() || !row.figures->mesh.has_value()) return std::nullopt;
  const std::optional<double> value = (*row.figures->mesh).*Member;
  return value.has_value() ? std::optional<double>(100.0 * *value) : std::nullopt;
}

using Mesh = SampleFigures::Mesh;

constexpr FigureLine kLines[] = {
    {"relative radius, same side", "%.3f", Best::kHighest,
     Of<&SampleFigures::relative_radius_same_side>},
    {"relative radius, all pairs", "%.3f", Best::kHighest, Of<&SampleFigures::relative_radius>},
    {"mean nearest distance", "%.3f", Best::kHighest, Of<&SampleFigures::mean_nearest_distance>},
    {"effective Nyquist", "%.3f", Best::kHighest, Of<&SampleFigures::effective_nyquist>},
    {"oscillation", "%.3f", Best::kLowest, Of<&SampleFigures::oscillation>},
    {"density error of patches", "%.4f", Best::kLowest, Of<&SampleFigures::density_fidelity>},
    {"capacity variation, triangles", "%.4f", Best::kLowest, OfMesh<&Mesh::capacity_cv>},
    {"capacity variation, Voronoi cells", "%.4f", Best::kLowest, OfMesh<&Mesh::voronoi_cv>},
    {"bond-orientational order", "%.3f", Best::kHighest, OfMesh<&Mesh::bond_order>},
    {"smallest angle [deg]", "%.1f", Best::kHighest, OfMesh<&Mesh::smallest_angle>},
    {"mean smallest angle [deg]", "%.1f", Best::kHighest, OfMesh<&Mesh::mean_smallest_angle>},
    {"angles below 30 deg [%]", "%.3f", Best::kLowest, OfMesh<&Mesh::share_below_30, 100>},
    {"angles above 90 deg [%]", "%.2f", Best::kLowest, OfMesh<&Mesh::share_above_90, 100>},
    {"Q min", "%.3f", Best::kHighest, OfMesh<&Mesh::q_min>},
    {"Q mean", "%.3f", Best::kHighest, OfMesh<&Mesh::q_mean>},
    {"valence 5 to 7 [%]", "%.2f", Best::kHighest, OfMesh<&Mesh::valence_5_7, 100>},
    {"Hausdorff distance [% diagonal]", "%.3f", Best::kLowest, OfDistance<&Mesh::hausdorff>},
    {"rms distance [% diagonal]", "%.4f", Best::kLowest, OfDistance<&Mesh::rms>},
};

}  // namespace

std::span<const FigureLine> FigureLines() { return kLines; }

bool IsBest(const FigureLine& line, const Row& row, std::span<const Row> rows) {
  const std::optional<double> own = line.value(row);
  if (!own.has_value()) return false;
  std::size_t measured = 0;
  for (const Row& other : rows) {
    const std::optional<double> value = line.value(other);
    if (!value.has_value()) continue;
    ++measured;
    if (line.best == Best::kHighest ? *value > *own : *value < *own) return false;
  }
  return measured > 1;
}

}  // namespace ccst::report
