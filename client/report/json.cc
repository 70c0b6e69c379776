#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "client/report/report.h"

namespace ccst::report {
namespace {

using Json = nlohmann::ordered_json;

Json ToJson(const analysis::Curve& curve) { return {{"x", curve.x}, {"y", curve.y}}; }

Json OrNull(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

void AddMesh(const std::optional<analysis::SampleFigures::Mesh>& mesh, Json& json) {
  if (!mesh.has_value()) {
    for (const char* key : {"capacity_cv", "voronoi_cv", "bond_order", "angles", "quality",
                            "valence_5_7", "hausdorff", "rms"}) {
      json[key] = nullptr;
    }
    return;
  }
  json["capacity_cv"] = mesh->capacity_cv;
  json["voronoi_cv"] = mesh->voronoi_cv;
  json["bond_order"] = mesh->bond_order;
  json["angles"] = {{"min", mesh->smallest_angle},
                    {"mean", mesh->mean_smallest_angle},
                    {"share_below_30", mesh->share_below_30},
                    {"share_above_90", mesh->share_above_90}};
  json["quality"] = {{"min", mesh->q_min}, {"mean", mesh->q_mean}};
  json["valence_5_7"] = mesh->valence_5_7;
  json["hausdorff"] = OrNull(mesh->hausdorff);
  json["rms"] = OrNull(mesh->rms);
}

Json ToJson(const Row& row) {
  Json json;
  json["name"] = row.name;
  json["count"] = row.count;
  if (!row.figures.has_value()) {
    for (const char* key : {"sets", "relative_radius", "relative_radius_same_side",
                            "mean_nearest_distance", "radial_mean", "anisotropy", "power_spectrum",
                            "effective_nyquist", "oscillation", "density_fidelity", "histograms"}) {
      json[key] = nullptr;
    }
    AddMesh(std::nullopt, json);
    return json;
  }
  const analysis::SampleFigures& figures = *row.figures;
  json["sets"] = figures.sets;
  json["relative_radius"] = figures.relative_radius;
  json["relative_radius_same_side"] = figures.relative_radius_same_side;
  json["mean_nearest_distance"] = figures.mean_nearest_distance;
  AddMesh(figures.mesh, json);
  json["radial_mean"] = ToJson(figures.radial_mean);
  json["anisotropy"] = ToJson(figures.anisotropy);
  json["power_spectrum"] = ToJson(figures.power_spectrum);
  json["effective_nyquist"] = figures.effective_nyquist;
  json["oscillation"] = figures.oscillation;
  json["density_fidelity"] = figures.density_fidelity;
  Json& histograms = json["histograms"];
  histograms["nearest_distance"] = ToJson(figures.nearest_distances);
  if (figures.mesh.has_value()) {
    histograms["angle"] = ToJson(figures.mesh->angles);
    histograms["capacity"] = ToJson(figures.mesh->capacities);
    histograms["valence"] = ToJson(figures.mesh->valences);
  }
  return json;
}

}  // namespace

std::string ToJson(std::span<const Row> rows) {
  if (rows.size() == 1) return ToJson(rows.front()).dump(1) + "\n";
  Json array = Json::array();
  for (const Row& row : rows) array.push_back(ToJson(row));
  return array.dump(1) + "\n";
}

}  // namespace ccst::report
