#include "tests/golden/requests.h"

#include <cmath>
#include <memory>
#include <utility>

#include "absl/status/statusor.h"
#include "core/io/samples_digest.h"
#include "tests/support/shapes.h"

namespace ccst::golden {
namespace {

// Far above the last bits in which two libraries' sines differ.
TriangleMesh Rounded(TriangleMesh mesh) {
  for (Eigen::Vector3d& position : mesh.positions) {
    position = (position * 0x1p16).array().round() * 0x1p-16;
  }
  return mesh;
}

TriangleMesh SmallTorus() { return Rounded(shapes::Torus(1.0, 0.35, 40, 16)); }

// With a scalar "rho" that grows from one end to the other.
TriangleMesh WithScalar(TriangleMesh mesh) {
  Attribute attribute;
  attribute.name = "rho";
  for (const Eigen::Vector3d& position : mesh.positions) {
    attribute.values.push_back(static_cast<float>(2.0 + position.x()));
  }
  mesh.attributes.push_back(std::move(attribute));
  return mesh;
}

// With texture coordinates that are its x and y.
TriangleMesh WithTexture(TriangleMesh mesh) {
  Attribute attribute;
  attribute.name = "uv";
  attribute.kind = AttributeKind::kTextureCoordinates;
  attribute.components = 2;
  for (const Eigen::Vector3d& position : mesh.positions) {
    attribute.values.push_back(static_cast<float>(position.x()));
    attribute.values.push_back(static_cast<float>(position.y()));
  }
  mesh.attributes.push_back(std::move(attribute));
  return mesh;
}

std::shared_ptr<const Image> Checkers() {
  auto image = std::make_shared<Image>();
  image->width = image->height = 8;
  for (int pixel = 0; pixel < 64; ++pixel) {
    image->values.push_back((pixel / 8 + pixel % 8) % 2 == 0 ? 0.25F : 0.75F);
  }
  return image;
}

SamplingOptions Options(std::int64_t count, std::uint64_t seed) {
  SamplingOptions options;
  options.sample_count = count;
  options.seed = seed;
  return options;
}

void AddCcst(std::vector<Request>* requests) {
  requests->push_back({"closed", SmallTorus(), Options(500, 0)});
  requests->push_back({"other-seed", SmallTorus(), Options(500, 123456789)});
  requests->push_back({"paper-energy", SmallTorus(), Options(300, 1)});
  requests->back().options.energy = Energy::kSquaredArea;
  requests->push_back({"initial", SmallTorus(), Options(400, 2)});
  requests->back().options.max_iterations = 0;
  requests->push_back({"open", Rounded(shapes::Saddle(12)), Options(400, 3)});
  requests->push_back({"two-loops", Rounded(shapes::Cylinder(1.0, 2.0, 24, 4)), Options(400, 4)});
  requests->push_back({"creases", shapes::Cube(), Options(600, 5)});
  requests->back().options.crease_angle = 0.7;
  const std::vector<TriangleMesh> parts = {shapes::Icosphere(3),
                                           shapes::Moved(shapes::Cube(), {4.0, 0.0, 0.0}),
                                           shapes::Moved(shapes::Tetrahedron(), {8, 0, 0}, 0.01)};
  requests->push_back({"components", Rounded(shapes::DisjointUnion(parts)), Options(400, 6)});
  TriangleMesh soup = Rounded(shapes::Unwelded(shapes::PlateWithHoles(2, 2, 2)));
  for (std::size_t i = 0; i < soup.positions.size(); i += 2) soup.positions[i].x() += 0x1p-14;
  requests->push_back({"soup", std::move(soup), Options(400, 7)});
  requests->back().options.weld_tolerance = 0x1p-10;
  // Blocks side by side, in passes and in the first triangulation.
  requests->push_back({"blocks", SmallTorus(), Options(9000, 8)});
  requests->back().options.max_iterations = 3;
  requests->back().options.thread_count = 2;
  requests->push_back({"many-faces", Rounded(shapes::Torus(1.0, 0.4, 120, 80)), Options(300, 9)});
}

void AddDensities(std::vector<Request>* requests) {
  requests->push_back({"attribute", WithScalar(SmallTorus()), Options(400, 10)});
  requests->back().options.density.source = DensitySource::kAttribute;
  requests->back().options.density.attribute = "rho";
  requests->back().options.density.exponent = 2.0;
  requests->push_back(
      {"texture", WithTexture(Rounded(shapes::PlaneGrid(1, 1, 10, 10))), Options(400, 11)});
  requests->back().options.density.source = DensitySource::kTexture;
  requests->back().options.density.image = Checkers();
  const std::pair<const char*, CurvatureMeasure> measures[] = {
      {"gaussian", CurvatureMeasure::kGaussian},
      {"mean", CurvatureMeasure::kMean},
      {"maximum", CurvatureMeasure::kMaximum}};
  for (const auto& [name, measure] : measures) {
    requests->push_back({name, SmallTorus(), Options(300, 12)});
    requests->back().options.density.source = DensitySource::kCurvature;
    requests->back().options.density.measure = measure;
  }
}

void AddMethods(std::vector<Request>* requests) {
  const std::pair<const char*, SamplingMethod> methods[] = {
      {"white-noise", SamplingMethod::kWhiteNoise},
      {"poisson-disk", SamplingMethod::kPoissonDisk},
      {"elimination", SamplingMethod::kSampleElimination},
      {"lloyd", SamplingMethod::kLloyd},
      {"ccvt", SamplingMethod::kCcvt}};
  for (const auto& [name, method] : methods) {
    requests->push_back({name, SmallTorus(), Options(200, 13)});
    requests->back().options.method = method;
    requests->back().options.max_iterations = 20;
  }
}

}  // namespace

std::vector<Request> Requests() {
  std::vector<Request> requests;
  AddCcst(&requests);
  AddDensities(&requests);
  AddMethods(&requests);
  return requests;
}

std::string DigestOf(const Request& request) {
  const absl::StatusOr<SamplingResult> result = SampleSurface(request.mesh, request.options);
  return result.ok() ? SamplesDigest(result->samples) : result.status().ToString();
}

}  // namespace ccst::golden
